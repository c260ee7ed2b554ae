#pragma once
/// Derivatives of stationary scalars with respect to parameters of the process, by adjoints.

#include <string>
#include <vector>

#include "stickslip/generator/resolvents.hpp"
#include "stickslip/model/process.hpp"
#include "stickslip/quantities/engines/excursions.hpp"
#include "stickslip/quantities/results.hpp"

namespace stickslip::quantities {

/// Derivatives of means over an excursion, M = nu f + entry . s, for a function f of the sliding
/// states and static values s. With the adjoint h, A h = f - A_us s,
///
///   dM = nu dL (h, s) + entry . ds,
///
/// where dL is the derivative of the generator on functions with the static values s: the flow
/// changes by dB, the jumps by d(Lambda alpha). One forward solve with systems.at(0, even) for each
/// M, whatever the number of parameters; one assembly for each parameter. Elements and upwind
/// directions are kept: what that leaves out is an error of the discretisation, and falls with it.
///
/// Without symmetry the shares of excursions by the level from which they start change as well. The
/// level from which the next one starts then counts like a static value: h and s get the mean of z
/// there, where (1 - P) z = h - M for the chain P of the starts (DiscountedStarts::apart). One more
/// forward solve for each M. With a single static level mean_stick takes no solve, and has no
/// derivative but that by tau.
class Sensitivity {
 public:
  /// Solves for the durations; effects::derivatives_of has the parameters of a scene. Collective.
  Sensitivity(generator::Systems& systems, const StationaryDistribution& distribution,
              std::vector<model::Derivative> parameters);

  /// dKEY_dPARAMETER for each KEY of the functions of excursion.hpp with these names. Collective.
  void append_sticking(Results& results) const;
  /// Three more solves.
  void append_moments(Results& results) const;

 private:
  /// Of one mean, by parameter.
  using Gradient = std::vector<Uncertain>;

  [[nodiscard]] Gradient sliding_mean(const generator::KolmogorovOperator::Observable& f) const;
  [[nodiscard]] Gradient sticking_mean() const;
  [[nodiscard]] std::vector<double> worth_of_starts(const linalg::Solution& h) const;
  // nu dL (h, s) by parameter, and what the starts change.
  [[nodiscard]] Gradient through(linalg::Solution h, const std::vector<double>& s) const;
  // value and mean of an integral over an excursion: the derivative of its ratio to mean_excursion.
  [[nodiscard]] Gradient ratio(double mean, const Gradient& of_mean) const;
  void append(const Row& row, const Gradient& gradient, Results& results) const;

  generator::System& system_;
  const StationaryDistribution& distribution_;
  std::vector<model::Derivative> parameters_;
  std::vector<std::vector<double>> exits_;  // of leaving for each start, by static level
  std::vector<generator::KolmogorovOperator> changes_;  // dA, by parameter
  Gradient slide_, stick_;
};

}  // namespace stickslip::quantities
