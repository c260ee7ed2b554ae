#pragma once
/// Densities and distribution functions of the durations of sliding phases, sticking phases and
/// excursions, and of the lengths of slips.

#include <string>
#include <vector>

#include "stickslip/generator/resolvents.hpp"
#include "stickslip/quantities/engines/excursions.hpp"
#include "stickslip/quantities/engines/propagator.hpp"
#include "stickslip/quantities/results.hpp"

namespace stickslip::quantities {

/// Of one duration, by time.
struct DurationDistribution {
  std::vector<Uncertain> density;       ///< [1/time]
  std::vector<Uncertain> distribution;  ///< P(duration <= t)
  int pairs = 0;                        ///< of vectors of the reduced model, 0 if there is none
};

/// Sticking phases, from the hitting distribution at their onset by exp(Q t) of the static chain.
/// Where the noise jumps to neighbours: inverse Laplace transforms, with resolvents that are found
/// without subtraction, by as many equal steps as keep the relative accuracy of small values; O(k)
/// a step. Other chains and nodes of continuous noise: squares of exp(Q h), O(k^3 log(Lambda t)).
/// Few jumps one by one.
[[nodiscard]] DurationDistribution stick_distribution(const model::Process& process,
                                                      const std::vector<Uncertain>& entry,
                                                      const std::vector<double>& time);

/// Sliding phases: f(t) = g exp(-A t) r with A = A(0, even or none), r = A 1 = -A_us 1 the rate of
/// coming to rest, g the value where excursions start; by a reduced model, to about 1e-8 to 2e-7 of
/// 1/mean. Errors of densities are relative to 1/mean. Collective.
[[nodiscard]] DurationDistribution slide_distribution(generator::Systems& systems,
                                                      const StationaryDistribution& stationary,
                                                      const std::vector<double>& time,
                                                      const ModelTolerance& tolerance);

/// Excursions: the same with the static states kept and killed when they are left.
[[nodiscard]] DurationDistribution excursion_distribution(generator::Systems& systems,
                                                          const StationaryDistribution& stationary,
                                                          const std::vector<double>& time,
                                                          const ModelTolerance& tolerance);

/// Of what a clock shows when the process is killed, started as excursions start; `mean` of that,
/// and its density `at_zero`. Both of the above are this, by their names. Collective.
[[nodiscard]] DurationDistribution
distribution_until_killed(const std::string& name, generator::Systems& systems,
                          generator::StaticPhase static_phase, generator::Clock clock,
                          const StationaryDistribution& stationary, const std::vector<double>& time,
                          double mean, const TimeScales& scales, double at_zero,
                          const ModelTolerance& tolerance);

/// f_slide(0+): a sliding phase can only end at once if one jump back from the level of its start
/// reverses it.
[[nodiscard]] double slide_density_at_zero(const model::Process& process, const Starts& starts);

/// Means and variances of the durations: the limits of their transforms as lambda -> 0.
struct DurationMoments {
  Uncertain mean_slide, mean_stick, mean_excursion;  ///< [time]
  Uncertain var_slide, var_stick, var_excursion;     ///< [time^2]
};
/// E[S^2] = 2 g A^-2 1 for sliding phases S, E[T^2] = 2 P R^2 1 for sticking phases T with R =
/// (-Q)^-1, and E[S T] = g A^-2 (-A_us R 1), since where a sliding phase ends depends on how long
/// it took. Three solves with systems.at(0, even or none). Collective.
[[nodiscard]] DurationMoments duration_moments(generator::Systems& systems,
                                               const StationaryDistribution& distribution,
                                               const std::vector<Uncertain>& entry);

/// A density and its distribution function, of the given rows, at the values of their abscissa.
void append_distribution(const Row& density_row, const Row& distribution_row,
                         const std::vector<double>& abscissa, const DurationDistribution& durations,
                         Results& results);

// Laplace transforms of the durations of sliding phases, sticking phases and excursions.

/// At one lambda, for excursions as they follow one another; with symmetry all are alike.
struct DurationTransforms {
  Uncertain slide;      ///< F_slide = E[exp(-lambda tau_hat_1)]
  Uncertain stick;      ///< F_stick = sum_i P_i F_lambda(x_i) (Prop. 4.2)
  Uncertain excursion;  ///< E[exp(-lambda tau_1)]
};

/// F_stick from the hitting distribution at the onset of sticking, by the static chain alone.
/// Relative error that of `entry`.
[[nodiscard]] Uncertain stick_transform(const model::Process& process, double lambda,
                                        const std::vector<Uncertain>& entry);

/// F_stick as an array over lambda.
void append_stick_transform(const model::Process& process, const std::vector<double>& lambda,
                            const std::vector<Uncertain>& entry, Results& results);

/// F_slide and F_excursion: A u = -A_us s with s = 1 (Prop. 4.3) or s = F_lambda, read where
/// excursions start; F_stick as above. Two solves with systems.at(lambda, even or none).
/// Collective. lambda >= 0 [1/time].
[[nodiscard]] DurationTransforms duration_transforms(generator::Systems& systems,
                                                     const StationaryDistribution& distribution,
                                                     double lambda);

/// F_slide, F_stick and F_excursion as arrays over lambda; each value counts by its own size.
void append_laplace(const std::vector<double>& lambda,
                    const std::vector<DurationTransforms>& transforms, Results& results);

// How far bodies slide from one sticking phase to the next.

/// Mean and variance of the path length int |V| dt and of the net displacement int V dt of a
/// sliding phase, over sliding phases as they follow one another.
struct SlipMoments {
  Uncertain variance;                ///< of the path length [velocity^2 time^2]
  Uncertain net_mean, net_variance;  ///< of the displacement
};

/// A path length is a duration by a clock that runs at the speed |v|: with A = -L killed at rest,
///
///   E[S] = nu |v|,   E[S^2] = 2 g A^-1 |v| A^-1 |v|,   E[D^2] = 2 g A^-1 v A^-1 v,
///
/// where v A^-1 v is even with symmetry and A^-1 v odd. Four solves, one of them with
/// systems.at(0, odd) if there is symmetry. Collective.
[[nodiscard]] SlipMoments slip_moments(generator::Systems& systems,
                                       const StationaryDistribution& distribution);

/// E[exp(-s S)]: a solve with s |v| - L. Collective. s >= 0 [1/(velocity time)].
[[nodiscard]] Uncertain slip_transform(generator::Systems& systems,
                                       const StationaryDistribution& distribution, double s);

/// Density and distribution function of S at distances > 0, from the same reduced models as
/// durations, by the other clock. Collective.
[[nodiscard]] DurationDistribution slip_distribution(generator::Systems& systems,
                                                     const StationaryDistribution& distribution,
                                                     const std::vector<double>& distance,
                                                     const ModelTolerance& tolerance);

/// E[S] = E|V| mean_excursion.
void append_mean_slip(const Excursion& excursion, Results& results);

}  // namespace stickslip::quantities
