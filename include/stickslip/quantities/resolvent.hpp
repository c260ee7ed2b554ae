#pragma once
/// Discounted integrals over an excursion, and the resolvent through the representation formula.

#include <vector>

#include "stickslip/model/observable.hpp"
#include "stickslip/operators/systems.hpp"
#include "stickslip/quantities/uncertain.hpp"

namespace stickslip::quantities {

/// What the first excursion from s+ tells whatever the observable (Prop. 3.1 of the paper).
struct ExitTransforms {
  Uncertain h_plus;   ///< h^+(s+) = E[exp(-lambda tau_1); the excursion ends at s+]
  Uncertain h_minus;  ///< h^-(s+)
  Uncertain w_one;    ///< w(s+; 1) = E int_0^tau_1 exp(-lambda s) ds [time]
};

/// What it tells about f.
struct ObservableTransforms {
  Uncertain w_plus, w_minus;  ///< w(s+; f), w(s-; f)
  Uncertain pi_lambda;        ///< (w(s+; f) + w(s-; f))/(2 w(s+; 1)) -> pi(f)
  Uncertain mu_lambda;        ///< (w(s+; f) - w(s-; f))/(2 (1 - h^+(s+) + h^-(s+)))
  Uncertain u;                ///< u(s+; f) by (3.11); not set at lambda = 0
};

struct Resolvent {
  ExitTransforms exits;
  std::vector<ObservableTransforms> of;  ///< one for each observable
};

/// Solves (lambda - L') w = f and (lambda - L') h = 0 of Prop. 3.1 by parity: the static values
/// come first, from the static chain alone, then the sliding ones from systems.at(lambda, even)
/// and, when these are done with and released, systems.at(lambda, odd).
///
/// With even and odd parts f = f_e + f_o, w_e = w(s+; f_e), w_o = w(s+; f_o) and
/// h_o = h^+(s+) - h^-(s+): w(s+-; f) = w_e +- w_o, pi_lambda = w_e / w(s+; 1),
/// mu_lambda = w_o/(1 - h_o) and u(s+; f) = pi_lambda/lambda + mu_lambda.
///
/// Three solves, and one for each part of an observable that does not vanish. Collective.
/// lambda >= 0 [1/time].
[[nodiscard]] Resolvent resolvent(operators::Systems& systems, double lambda,
                                  const std::vector<model::Observable>& observables);

/// h_plus, h_minus, w_one and, for each observable f, w_plus(f), w_minus(f), pi(f), mu(f) and,
/// where no lambda is 0, u(f): arrays over lambda.
void append_resolvent(const std::vector<double>& lambda,
                      const std::vector<model::Observable>& observables,
                      const std::vector<Resolvent>& resolvents, Results& results);

}  // namespace stickslip::quantities
