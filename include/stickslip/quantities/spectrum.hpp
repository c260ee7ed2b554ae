#pragma once
/// Power spectral density of the velocity.

#include <functional>
#include <vector>

#include "stickslip/operators/systems.hpp"
#include "stickslip/quantities/model_search.hpp"
#include "stickslip/quantities/results.hpp"
#include "stickslip/quantities/stationary.hpp"
#include "stickslip/quantities/uncertain.hpp"

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
[[nodiscard]] ReducedSpectrum reduced_spectrum(operators::Systems& systems,
                                               const StationaryDistribution& distribution,
                                               const std::vector<double>& omega,
                                               const ModelTolerance& tolerance);

/// S_v by complex factors of i omega - L, new ones for each frequency. Collective. Throws NoMemory
/// or NotReached.
[[nodiscard]] std::vector<Uncertain> direct_spectrum(operators::Systems& systems,
                                                     const StationaryDistribution& distribution,
                                                     const std::vector<double>& omega);

/// S_v by omega and at 0, and the diffusivity, half of the latter.
void append_spectrum(const std::vector<double>& omega, const Spectrum& spectrum, Results& results);
/// The full width at half maximum, its inverse, and the variance from the spectrum.
void append_shape(const SpectrumShape& shape, Results& results);

}  // namespace stickslip::quantities
