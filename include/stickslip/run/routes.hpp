#pragma once
/// All that is asked for, on one discretisation, by the solution method asked for.

#include <map>

#include "stickslip/generator/system_key.hpp"
#include "stickslip/linalg/solver_options.hpp"
#include "stickslip/model/process.hpp"
#include "stickslip/quantities/excursion.hpp"
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

// b = 0: the process as a Markov-modulated fluid queue, solved without any grid in v.

/// Means over one sliding phase, discounted by exp(-lambda t), nothing being known of what follows.
/// `entry` has the sum F_slide.
struct SlidingMeans : quantities::Excursion {
  double turns = 0;  ///< changes of the sign of V
};

/// Without drag, |V| changes at the constant rate x_i + g - mu_d on each noise level (v > 0): a
/// fluid queue with the noise as its phase, whose boundary v = 0 is sticky on the static levels and
/// hands a phase below them on to the queue of the other velocity branch, the one of the mirrored
/// process. The distribution of each queue follows from its first-return matrix
///
///   Psi(i, j) = E[exp(-lambda T); phase j at the return to 0 | start at 0 in phase i],
///
/// i rising, j falling: the minimal non-negative solution of a Riccati equation, found by the
/// alternating-directional doubling algorithm (Wang, Wang and Li, SIAM J. Matrix Anal. Appl. 33,
/// 2012), quadratically convergent. Nothing of it is shared with the discretisations in v.
/// O(N^3) time, O(N^2) space; with symmetry both queues are the same one.
class FluidQueue {
 public:
  /// `process` without drag; lambda >= 0 [1/time]. Throws std::invalid_argument when there is drag,
  /// std::runtime_error when the doubling does not converge.
  explicit FluidQueue(const model::Process& process, double lambda = 0);

  /// Sliding phases from a level from which excursions start; with symmetry from one above the
  /// static ones.
  [[nodiscard]] const SlidingMeans& from(int level) const { return from_.at(level); }
  [[nodiscard]] const SlidingMeans& plus() const { return from(plus_); }  ///< from s+

  /// Largest residual of the Riccati equations against their terms.
  [[nodiscard]] double residual() const { return residual_; }

 private:
  int plus_ = 0;
  std::map<int, SlidingMeans> from_;
  double residual_ = 0;
};

/// The solution method of b = 0 without a grid in v.
[[nodiscard]] Evaluation by_fluid_queue(const Problem& problem);

}  // namespace stickslip::run
