#pragma once
/// Discounted integrals over an excursion, and the resolvent through the representation formula.

#include <vector>

#include "stickslip/model/observable.hpp"
#include "stickslip/operators/systems.hpp"
#include "stickslip/quantities/uncertain.hpp"

namespace stickslip::quantities {

/// What excursions give whatever the observable (Prop. 3.1 of the paper).
struct ExitTransforms {
  Uncertain h_plus;   ///< h^+ = E[exp(-lambda tau_1); the excursion ends at s+]
  Uncertain h_minus;  ///< h^-
  Uncertain w_one;    ///< w(1) = E int_0^tau_1 exp(-lambda s) ds [time]
};

/// What excursions give of f.
struct ObservableTransforms {
  Uncertain w_plus, w_minus;  ///< w(s+; f), w(s-; f)
  Uncertain pi_lambda;        ///< -> pi(f)
  Uncertain mu_lambda;        ///< u(s+; f) - pi_lambda/lambda
  Uncertain mu_from_minus;    ///< u(s-; f) - pi_lambda/lambda
  Uncertain u, u_from_minus;  ///< u(s+; f), u(s-; f) by (3.11); not set at lambda = 0
};

struct Resolvent {
  ExitTransforms from_plus, from_minus;  ///< of excursions from s+ and from s-
  std::vector<ObservableTransforms> of;  ///< one for each observable
};

/// Solves (lambda - L') w = f and (lambda - L') h = 0 of Prop. 3.1: the static values come first,
/// from the static chain alone, then the sliding ones. With symmetry by parity, from
/// systems.at(lambda, even) and, when these are done with and released, systems.at(lambda, odd);
/// otherwise from systems.at(lambda, none).
///
/// With f = f_e + f_o, w_e = w(s+; f_e), w_o = w(s+; f_o) and h_o = h^+(s+) - h^-(s+):
/// w(s+-; f) = w_e +- w_o, pi_lambda = w_e / w(s+; 1), mu_lambda = w_o/(1 - h_o). Without symmetry,
/// with a = h^-(s+), b = h^+(s-), w^+- = w(s+-; f), w_1^+- = w(s+-; 1), S = b w_1^+ + a w_1^-,
///
///   pi_lambda = (b w^+ + a w^-)/S,
///   mu_lambda = a w_1^- (w_1^- w^+ - w_1^+ w^-)/(S (S + lambda w_1^+ w_1^-)),
///
/// from u = w + h u at both sides, whose determinant is lambda (S + lambda w_1^+ w_1^-).
///
/// Three solves, and one for each part of an observable that does not vanish. Collective.
/// lambda >= 0 [1/time].
[[nodiscard]] Resolvent resolvent(operators::Systems& systems, double lambda,
                                  const std::vector<model::Observable>& observables);

/// h_plus, h_minus, w_one and, for each observable f, w_plus(f), w_minus(f), pi(f), mu(f) and,
/// where no lambda is 0, u(f): arrays over lambda. Without symmetry also h_plus_from_minus,
/// h_minus_from_minus, w_one_from_minus, u_minus(f), mu_minus(f) of the start at s-.
void append_resolvent(const std::vector<double>& lambda,
                      const std::vector<model::Observable>& observables,
                      const std::vector<Resolvent>& resolvents, bool symmetric, Results& results);

}  // namespace stickslip::quantities
