#pragma once
/// How the process forgets: autocorrelation, and expectations and displacements given the start.

#include <vector>

#include "stickslip/generator/resolvents.hpp"
#include "stickslip/model/observable.hpp"
#include "stickslip/model/process.hpp"
#include "stickslip/quantities/engines/excursions.hpp"
#include "stickslip/quantities/engines/propagator.hpp"
#include "stickslip/quantities/results.hpp"

namespace stickslip::quantities {

/// That of functionals which this start makes: from one state, the path without jumps has kinks.
[[nodiscard]] ReducedModel::Nature nature_of(const model::Start& start);
/// u -> E[u(Z_0)] for functions on an operator that keeps the static states. Collective.
[[nodiscard]] linalg::VecHandle start_on(const generator::KolmogorovOperator& a,
                                         const model::Start& start);
/// Whether it is more than the rounding of the probabilities of mirror images, which add up to 0 on
/// odd functions. Collective.
[[nodiscard]] bool counts(Vec functional);

/// C(t) = E[(V_0 - m)(V_t - m)], m = E[V], as c exp(L t) b with the vectors of
/// StationaryDistribution::velocity(). Errors are relative to C(0). Collective.
[[nodiscard]] std::vector<Uncertain> autocorrelation(generator::Systems& systems,
                                                     const StationaryDistribution& distribution,
                                                     const std::vector<double>& time,
                                                     const ModelTolerance& tolerance);

/// E[f(Z_t)] = mean of exp(L t) f over the start, with symmetry by its even and odd parts, and
/// pi(f), to which it tends. Errors are relative to the root of pi(f^2), part by part. Collective.
struct Expectation {
  std::vector<Uncertain> value;
  double stationary = 0;
  double unseen = 0;  ///< error of pi(f) and, at large times, of all: see overlooked()
};
[[nodiscard]] Expectation expectation(generator::Systems& systems,
                                      const StationaryDistribution& distribution,
                                      const model::Observable& f, const model::Start& start,
                                      const std::vector<double>& time,
                                      const ModelTolerance& tolerance);

// Where a body is after a time.

/// By time.
struct Displacement {
  std::vector<Uncertain> mean;      ///< E[x(t)], x(t) = int_0^t V [velocity time]
  std::vector<Uncertain> variance;  ///< of x(t)
};

/// With V = m + V', m = E[V], x(t) = m t + y(t). From the stationary distribution y has mean 0 and
/// the variance 2 int_0^t (t - s) C(s) ds, C the autocovariance of the velocity. From any other
/// start its moments follow the backward equations
///
///   dm1/dt = L m1 + v',   dm2/dt = L m2 + 2 v' m1,
///
/// which one reduced model of both together solves for all times: up to ten correlation times by
/// themselves, for longer times what the start adds to the second moment from the stationary
/// distribution, which stays bounded. Errors are relative to the variance at the largest time.
/// Collective. Throws NotReached or NoMemory.
[[nodiscard]] Displacement displacement(generator::Systems& systems,
                                        const StationaryDistribution& distribution,
                                        const model::Start& start, const std::vector<double>& time,
                                        const ModelTolerance& tolerance);

}  // namespace stickslip::quantities
