#pragma once
/// Discounted integrals over an excursion, and the resolvent through the representation formula.

#include <vector>

#include "stickslip/model/observable.hpp"
#include "stickslip/operators/systems.hpp"
#include "stickslip/quantities/uncertain.hpp"

namespace stickslip::quantities {

/// What excursions give whatever the observable (Prop. 3.1 of the paper).
struct ExitTransforms {
  Uncertain h_plus;   ///< h^+ = E[exp(-lambda tau_1); the next excursion starts upwards]
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
  ExitTransforms from_plus, from_minus;  ///< of excursions from s+ and s-, the most frequent ones
  std::vector<ObservableTransforms> of;  ///< one for each observable
};

/// w and h of Prop. 3.1 by discounted occupations: nu_t (lambda - L') = the value at start t, one
/// transposed solve for each of the levels t from which excursions start, whatever the observables.
/// With symmetry by parity, from systems.at(lambda, even) and, when that is done with and released,
/// systems.at(lambda, odd); otherwise from systems.at(lambda, none).
///
/// With f = f_e + f_o, w_e = w(s+; f_e), w_o = w(s+; f_o) and h_o = h^+(s+) - h^-(s+):
/// w(s+-; f) = w_e +- w_o, pi_lambda = w_e / w(s+; 1), mu_lambda = w_o/(1 - h_o). Without symmetry
/// u = w + h u on all starts, h_tu = E_t[exp(-lambda tau_1); the next excursion starts at u], and
/// 1 - h has the row sums lambda w(1). With the shares p of the chain that goes from t to u at the
/// rate h_tu,
///
///   pi_lambda = p w(f)/p w(1),
///   lambda w(t; 1) mu_t + sum_u h_tu (mu_t - mu_u) = w(t; f) - pi_lambda w(t; 1),
///
/// where p w(1) mu = 0 takes the place of the equation at one of the starts, so that lambda = 0 is
/// no special case. Differences of w and of mu are taken pair by pair, with positive weights; all
/// else is without subtraction. h_plus and h_minus are sums over the starts on their side.
/// O(starts^3). Collective. lambda >= 0 [1/time].
[[nodiscard]] Resolvent resolvent(operators::Systems& systems, double lambda,
                                  const std::vector<model::Observable>& observables);

/// h_plus, h_minus, w_one and, for each observable f, w_plus(f), w_minus(f), pi(f), mu(f) and,
/// where no lambda is 0, u(f): arrays over lambda. Without symmetry also h_plus_from_minus,
/// h_minus_from_minus, w_one_from_minus, u_minus(f), mu_minus(f) of the start at s-.
void append_resolvent(const std::vector<double>& lambda,
                      const std::vector<model::Observable>& observables,
                      const std::vector<Resolvent>& resolvents, bool symmetric, Results& results);

}  // namespace stickslip::quantities
