#pragma once
/// What is gathered until a speed is first passed.

#include <optional>
#include <vector>

#include "stickslip/operators/static_chain.hpp"
#include "stickslip/operators/systems.hpp"
#include "stickslip/quantities/plan.hpp"
#include "stickslip/quantities/uncertain.hpp"

namespace stickslip::quantities {

using ByLevel = std::vector<double>;  ///< of static levels, from the lowest up

/// Where sticking phases lead; nothing of a body that never rests.
struct StickingPhases {
  /// With `reduced`, by the half of the states that symmetry leaves, where all starts are alike.
  /// With a discount lambda, `exits` are transforms and integrals discounted ones.
  StickingPhases(const model::Process& process, std::vector<int> starts, bool reduced,
                 double lambda = 0);

  [[nodiscard]] ByLevel each(double value) const;
  /// The part that the noise has on static levels in its stationary distribution.
  [[nodiscard]] ByLevel stationary() const;
  /// KolmogorovOperator::square_field() at rest.
  [[nodiscard]] ByLevel square_field(const ByLevel& at_rest, const ByLevel& at_starts) const;

  const model::Process& process;
  bool symmetric;
  std::vector<int> starts;
  std::optional<operators::StaticChain> chain;
  std::vector<ByLevel> exits;  ///< by start: probabilities of leaving for it
};

/// nu with nu A = g, from each start and, last, for g = `first`: `x` after iterative refinement,
/// `correction` before it, so that what follows from both shows rounding. A transposed solve for
/// each. Collective. Throws NotReached or NoMemory.
[[nodiscard]] std::vector<petsc::Solution>
occupations_from(operators::System& system, const std::vector<int>& starts, petsc::VecHandle first);

/// Where bodies are killed at the speed, the occupation nu of a sliding phase flows to rest at the
/// rates `entry`, by level, and over the speed with the probability P; both add up to 1. With the
/// integral a = nu f + entry . s over sliding and the sticking that follows, s by level, renewal
/// gives the mean integrals m by start:
///
///   P_t m_t + sum_u q_tu (m_t - m_u) = a_t,
///
/// q_tu = entry_t . h_u the probability that the speed was not reached and the next sliding phase
/// starts at u; solved without subtraction, right however rare the passage is.
class UntilPassage {
 public:
  /// `at_rest`: probabilities of static levels at first. `solutions` are those of
  /// occupations_from(), of which `which` is taken. All have to live as long. Collective.
  UntilPassage(const operators::KolmogorovOperator& a, const StickingPhases& sticking,
               const ByLevel& at_rest, const std::vector<petsc::Solution>& solutions,
               petsc::VecHandle petsc::Solution::*which);

  /// By start, and of the first one: probabilities of reaching the speed in a sliding phase.
  [[nodiscard]] const std::vector<double>& reached() const { return reached_; }

  /// The mean integral of f, given on sliding and static states: overall, from rest by level, and
  /// from the starts. Collective.
  struct Integral {
    double overall;
    ByLevel at_rest, at_starts;
  };
  [[nodiscard]] Integral integral(Vec f, const ByLevel& f_at_rest) const;

  /// E[exp(-lambda T)], where the occupations and the sticking phases are those of lambda: with the
  /// discounted time c_t of both phases from a start,
  ///
  ///   (P_t + lambda c_t) m_t + sum_u q_tu (m_t - m_u) = P_t.
  ///
  /// `one`: 1 in all sliding states. Collective.
  [[nodiscard]] double transform(double lambda, Vec one) const;

 private:
  [[nodiscard]] Integral renewed(Integral sum, std::vector<double> killing) const;

  const StickingPhases& sticking_;
  const ByLevel& at_rest_;
  std::vector<Vec> nu_;
  std::vector<ByLevel> entry_;
  std::vector<double> reached_;
};

/// The reason of entries without a value: speeds that are reached so rarely that rounding is all
/// there is.
inline void name_too_rare(Result& result) {
  if (!all_numbers(result)) {
    result.unreached = "is beyond double precision, being too rare; leave that entry out";
  }
}

/// Appends one of the numbers of each speed of -velocity as an array.
template <class Passage>
void append_by_speed(const Computation& computation, const Row& row,
                     const std::vector<Passage>& passages, Uncertain Passage::*member) {
  Result result = array(row, computation.question().velocity);
  for (const auto& passage : passages) append_value(result, passage.*member);
  name_too_rare(result);
  computation.results().push_back(std::move(result));
}

}  // namespace stickslip::quantities
