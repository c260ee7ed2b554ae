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

/// Assembles the system of a key and has its solver analyse it; nothing is factored. Sizes and
/// times go to the statistics. Collective. Throws NoMemory.
[[nodiscard]] linalg::Analysis analyse(const Problem& problem, const generator::SystemKey& key);

}  // namespace stickslip::run
