#pragma once
/// The law of the time T until V first reaches a speed, from any start: its Laplace transform,
/// density and distribution function.

#include <vector>

#include "stickslip/model/start.hpp"
#include "stickslip/operators/systems.hpp"
#include "stickslip/quantities/durations.hpp"
#include "stickslip/quantities/recipe.hpp"
#include "stickslip/quantities/uncertain.hpp"

namespace stickslip::quantities {

/// E[exp(-lambda T)] for each lambda >= 0 [1/time], by UntilPassage with the systems lambda - L
/// killed at the speed of `key`, whose lambda does not count: sums of positive terms, with the
/// effect of iterative refinement for error. Starts beyond the speed have T = 0. A factorisation
/// for each lambda, a transposed solve for each level from which excursions start and one for the
/// start, and what starting_point() takes. NaN where rounding is all there is. Collective. Throws
/// NotReached or NoMemory.
[[nodiscard]] std::vector<Uncertain> passage_transform(operators::Systems& systems,
                                                       operators::SystemKey key,
                                                       const model::Start& start,
                                                       const std::vector<double>& lambda);

/// f(t) = c exp(-A t) r and P(T <= t) = p_0 + int_0^t f, with A the operator -L with the static
/// states that kills at the speed of `key`, r the rate of killing, c the start and p_0 what it has
/// beyond the speed; by reduced models, of all times or, where these miss the tolerance, of fewer.
/// passage_transform() at the end of the times checks A: the difference from what it gives there is
/// part of the errors. Steps of the distribution function are those of before_first_jump(), whose
/// difference from what elements make of them is part of the errors, too; the density is without
/// them. Both are 0 before earliest_arrival(). NaN where the speed is too rarely reached.
/// Collective. Throws NotReached or NoMemory.
[[nodiscard]] DurationDistribution passage_distribution(operators::Systems& systems,
                                                        const operators::SystemKey& key,
                                                        const model::Start& start,
                                                        const std::vector<double>& time,
                                                        const ModelTolerance& tolerance);

}  // namespace stickslip::quantities
