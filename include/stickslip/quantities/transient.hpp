#pragma once
/// How the process forgets: autocorrelation, and expectations given the start.

#include <string>
#include <vector>

#include "stickslip/model/observable.hpp"
#include "stickslip/operators/systems.hpp"
#include "stickslip/quantities/results.hpp"
#include "stickslip/quantities/stationary.hpp"
#include "stickslip/quantities/uncertain.hpp"

namespace stickslip::quantities {

/// Prefix of the PETSc options of the time stepper.
inline const std::string kBackwardPrefix = "backward_";

/// Reduced models for all times at once, or the backward Kolmogorov equation step by step (PETSc's
/// TS), which shares nothing with them but L.
enum class TransientMethod { krylov, stepping };

/// The state (x_level, v) at time 0; v = 0 is rest for |level| <= k, and s+- and beyond otherwise.
struct StartState {
  int level = 0;
  double v = 0;
};

/// C_vv(t) = E[V_0 V_t] = c exp(L t) v with c = pi v, odd functions only. Errors are relative to
/// C_vv(0). Collective.
[[nodiscard]] std::vector<Uncertain> autocorrelation(operators::Systems& systems,
                                                     const StationaryDistribution& distribution,
                                                     const std::vector<double>& time,
                                                     TransientMethod method, double tolerance);

/// E[f(Z_t) | Z_0 = start] = (exp(L t) f)(start), its even and odd parts apart, and pi(f), to which
/// it tends. Errors are relative to the root of pi(f^2), part by part. Collective.
struct Expectation {
  std::vector<Uncertain> value;
  double stationary = 0;
  double unseen = 0;  ///< error of pi(f) and, at large times, of all: see overlooked()
};
[[nodiscard]] Expectation expectation(operators::Systems& systems,
                                      const StationaryDistribution& distribution,
                                      const model::Observable& f, const StartState& start,
                                      const std::vector<double>& time, TransientMethod method,
                                      double tolerance);

}  // namespace stickslip::quantities
