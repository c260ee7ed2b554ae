#pragma once
/// Stationary averages pi(f) behind sticking, moments, noise_law and averages, for solution methods
/// that compute pi(f) for one f after the other.

#include <vector>

#include "stickslip/model/observable.hpp"
#include "stickslip/quantities/uncertain.hpp"
#include "stickslip/routes/evaluation.hpp"

namespace stickslip::routes {

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

}  // namespace stickslip::routes
