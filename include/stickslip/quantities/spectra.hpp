#pragma once
/// Power spectral density of the velocity.

#include <functional>
#include <vector>

#include "stickslip/generator/resolvents.hpp"
#include "stickslip/model/observable.hpp"
#include "stickslip/quantities/engines/excursions.hpp"
#include "stickslip/quantities/engines/propagator.hpp"
#include "stickslip/quantities/results.hpp"

namespace stickslip::quantities {

/// S_v(omega) = int E[(V_0 - m)(V_t - m)] exp(-i omega t) dt = 2 Re c (i omega - L)^-1 b, with b
/// and c of StationaryDistribution::velocity(). By symmetry they are odd, and omega = 0 is no
/// special case; without it both are orthogonal to the null vectors of L, and all that is made from
/// them.
///
/// Far out S_v falls as omega^-4, and the formula above subtracts terms of order omega^-2 that
/// cancel because E[V dV/dt] = 0. There, with a = L v the acceleration,
///   S_v(omega) = -(2/omega^2) Re (c L) (i omega - L)^-1 a
///              = -(2/omega^3) Im (c L^2) (i omega - L)^-1 a
/// is used, which has dropped the vanishing term and keeps its relative accuracy; small models take
/// the second form.
struct Spectrum {
  Uncertain at_zero;             ///< S_v(0)
  std::vector<Uncertain> value;  ///< S_v at the frequencies asked for [velocity^2 time]
};

/// What a reduced model knows besides: it is cheap at every frequency.
struct SpectrumShape {
  Uncertain full_width;  ///< at half of S_v(0) [1/time]; not a number if S_v never falls so far
  Uncertain variance;    ///< (1/2 pi) int S_v d omega, which is E[V^2]
};

/// Of an even spectrum S(omega) that falls as omega^-4 beyond 1e5/tau and has relative errors
/// `bulk_error` at 0 and at half width, `error` everywhere. Local.
[[nodiscard]] SpectrumShape shape_of(const std::function<double(double)>& s, double tau,
                                     double bulk_error, double error);

struct ReducedSpectrum {
  Spectrum spectrum;
  SpectrumShape shape;
  int pairs = 0;               ///< of vectors of the reduced model
  std::vector<double> shifts;  ///< real shifts used [1/time]
};

/// By two-sided rational Krylov projection: a few real factorisations for all frequencies, and true
/// solutions by complex ones where ask() compares them. Collective.
[[nodiscard]] ReducedSpectrum reduced_spectrum(generator::Systems& systems,
                                               const StationaryDistribution& distribution,
                                               const std::vector<double>& omega,
                                               const ModelTolerance& tolerance);

/// S_v by complex factors of i omega - L, new ones for each frequency. Collective. Throws NoMemory
/// or NotReached.
[[nodiscard]] std::vector<Uncertain> direct_spectrum(generator::Systems& systems,
                                                     const StationaryDistribution& distribution,
                                                     const std::vector<double>& omega);

// Discounted integrals over an excursion, and the resolvent through the representation formula.

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
  /// Of excursions from s+ and s-, the most frequent ones; of nodes their means.
  ExitTransforms from_plus, from_minus;
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
/// With `shares` of starts, as those that are nodes have, s+ and s- stand for all on their side.
/// O(starts^3). Collective. lambda >= 0 [1/time].
[[nodiscard]] Resolvent resolvent(generator::Systems& systems, double lambda,
                                  const std::vector<model::Observable>& observables,
                                  const std::vector<double>& shares = {});

/// h_plus, h_minus, w_one and, for each observable f, w_plus(f), w_minus(f), pi(f), mu(f) and,
/// where no lambda is 0, u(f): arrays over lambda. Without symmetry also h_plus_from_minus,
/// h_minus_from_minus, w_one_from_minus, u_minus(f), mu_minus(f) of the start at s-.
void append_resolvent(const std::vector<double>& lambda,
                      const std::vector<model::Observable>& observables,
                      const std::vector<Resolvent>& resolvents, bool symmetric, Results& results);

}  // namespace stickslip::quantities
