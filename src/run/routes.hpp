#pragma once
/// The solution methods behind evaluate(), and what they share.

#include <vector>

#include "stickslip/model/observable.hpp"
#include "stickslip/run/evaluation.hpp"

namespace stickslip::run {

/// Everything from the sliding operator and the static chain, task by task; see quantities::Plan
/// and quantities::StationaryDistribution.
[[nodiscard]] Evaluation by_excursion(const Problem& problem);

/// pi(f) = lambda u_lambda(s+; f) + O(lambda) with (lambda - M) u_lambda = f on the full grid; one
/// factorisation for all f.
///
/// With R = (lambda - M)^-1 a single solve loses rounding/lambda. Since lambda R 1 = 1, the number
/// lambda R f at s+ also is the c for which R(f - c) = 0 there; found by c <- c + lambda R(f - c),
/// whose solutions stay of order one, it keeps all digits for any lambda well above the rounding of
/// the diagonal of M. The bias is measured: (lambda R)^2 f differs from pi(f) by O(lambda^2) only,
/// so that lambda R f - (lambda R)^2 f is the bias up to O(lambda^2). Unless -lambda fixes it,
/// lambda starts at accuracy/100 (of 1/tau) and is lowered until the bias is below a quarter of the
/// accuracy, or as far as rounding lets the whole error fall.
[[nodiscard]] Evaluation by_lambda(const Problem& problem);

/// P_slide = R^(s+)/(R-check(s+) + R(x_k)) of Prop. 4.1: mean times to rest, to the edge of rest,
/// and from there to the exit, on the full grid and by the static chain.
[[nodiscard]] Evaluation by_hitting(const Problem& problem);

/// pi M = 0 by SLEPc on the full grid.
[[nodiscard]] Evaluation by_null_vector(const Problem& problem);

/// b = 0 without a grid in v; see FluidQueue.
[[nodiscard]] Evaluation by_fluid_queue(const Problem& problem);

// Stationary averages pi(f) behind sticking, moments, noise_law and averages, for solution methods
// that compute pi(f) for one f after the other.

struct Average {
  quantities::Result result;  ///< blank
  model::Observable::Function f;
  int given = -1;  ///< number of the average that it is divided by, of a phase; -1: none
};

/// Those that are asked for, after the probability of the levels on which a body always moves,
/// which append_averages needs.
[[nodiscard]] std::vector<Average> averages(const Problem& problem);

/// Turns pi(f) of averages(problem) into results.
///
/// P(|X| > mu_s) is known in closed form; its relative error is rounding in pi itself, which the
/// residuals of solves do not see, and is added to all errors (for P_stick as a share of P_slide).
void append_averages(const Problem& problem, const std::vector<quantities::Uncertain>& values,
                     quantities::Results& results);

}  // namespace stickslip::run
