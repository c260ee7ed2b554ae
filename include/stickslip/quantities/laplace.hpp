#pragma once
/// Laplace transforms of the durations of sliding phases, sticking phases and excursions.

#include <vector>

#include "stickslip/operators/systems.hpp"
#include "stickslip/quantities/results.hpp"
#include "stickslip/quantities/stationary.hpp"
#include "stickslip/quantities/uncertain.hpp"

namespace stickslip::quantities {

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
/// excursions start. Two solves with systems.at(lambda, even or none). Collective. lambda >= 0
/// [1/time].
struct SlidingTransforms {
  Uncertain slide, excursion;
};
[[nodiscard]] SlidingTransforms sliding_transforms(operators::Systems& systems,
                                                   const StationaryDistribution& distribution,
                                                   double lambda);

/// F_slide, F_stick and F_excursion as arrays over lambda; each value counts by its own size.
void append_laplace(const std::vector<double>& lambda,
                    const std::vector<DurationTransforms>& transforms, Results& results);

}  // namespace stickslip::quantities
