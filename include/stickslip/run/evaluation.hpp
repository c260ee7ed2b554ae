#pragma once
/// All that is asked for, on one discretisation, by the solution method asked for.

#include "stickslip/generator/system_key.hpp"
#include "stickslip/linalg/solver_options.hpp"
#include "stickslip/quantities/plan.hpp"

namespace stickslip::run {

using quantities::Evaluation;
using quantities::Problem;

/// Assembles, factors and solves what the question needs and nothing else. Collective. Throws
/// NotReached or NoMemory.
[[nodiscard]] Evaluation evaluate(const Problem& problem);

/// Turns values of pi(f) into results, for solution methods that compute it for one f after the
/// other: P(|X| > mu_s) of levels on which a body always moves, and what is asked for behind
/// sticking, moments, noise_law and averages.
///
/// P(|X| > mu_s) is known in closed form; its relative error is rounding in pi itself, which the
/// residuals of solves do not see, and is added to all errors (for P_stick as a share of P_slide).
void append_averages(const Problem& problem, const std::vector<quantities::Uncertain>& values,
                     quantities::Results& results);

/// Assembles the system of a key and has its solver analyse it; nothing is factored. Sizes and
/// times go to the statistics. Collective. Throws NoMemory.
[[nodiscard]] linalg::Analysis analyse(const Problem& problem, const generator::SystemKey& key);

}  // namespace stickslip::run
