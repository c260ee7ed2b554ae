#include "stickslip/quantities/first_passage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "stickslip/catalogue/peak_keys.hpp"
#include "stickslip/operators/static_chain.hpp"
#include "stickslip/petsc/check.hpp"
#include "stickslip/quantities/plan.hpp"
#include "stickslip/quantities/stationary.hpp"

namespace stickslip::quantities {
namespace {

using operators::Branch;
using operators::KolmogorovOperator;
using operators::StaticPhase;

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

/// The static phase of a process by level, from the lowest up.
struct Sticking {
  explicit Sticking(const model::Process& process) {
    const auto chain = operators::StaticChain::of(process);
    time = chain.integral(std::vector<double>(static_cast<std::size_t>(chain.size()), 1.0));
    up = chain.upward_exit_transform();
    down = chain.downward_exit_transform();
    const auto all = model::stationary_distribution(process.noise);
    const auto first = all.begin() + (process.lowest_static() - process.noise.lowest());
    stationary.assign(first, first + chain.size());
  }
  std::vector<double> time;        ///< mean, until it is left
  std::vector<double> up, down;    ///< probabilities of leaving upwards, downwards
  std::vector<double> stationary;  ///< probabilities of the levels
};

/// What becomes of a sliding phase until it reaches the speed or the excursion ends.
struct SlidingPhase {
  double time = 0;          // sliding and sticking
  double up = 0, down = 0;  // probabilities of the side from which the next one starts
  double reached = 0;
};

SlidingPhase sliding_phase_of(const KolmogorovOperator& a, Vec nu, const Sticking& sticking) {
  PetscScalar time = 0;
  petsc::check(VecSum(nu, &time));
  std::vector<double> entry;
  for (const auto& p : a.entry_rates(nu)) entry.push_back(PetscRealPart(p));
  return {PetscRealPart(time) + dot(entry, sticking.time), dot(entry, sticking.up),
          dot(entry, sticking.down), a.rate_at_top(nu)};
}

/// The numbers of a speed, by side.
struct Passage {
  double exceeded, from_slide, from_rest;
};

Passage passage(const SideChain& sides, const Sticking& sticking, const SlidingPhase& plus,
                const SlidingPhase& minus, SlidingPhase rest) {
  const double across =
      plus.down * minus.reached + plus.reached * minus.up + plus.reached * minus.reached;
  const double from_plus =
                   (plus.time * (minus.up + minus.reached) + plus.down * minus.time) / across,
               from_minus =
                   (minus.time * (plus.down + plus.reached) + minus.up * plus.time) / across;
  const double up = sides.share_of_plus(), down = sides.share_of_minus();
  rest.time += dot(sticking.stationary, sticking.time);
  rest.up += dot(sticking.stationary, sticking.up);
  rest.down += dot(sticking.stationary, sticking.down);
  return {up * plus.reached + down * minus.reached, up * from_plus + down * from_minus,
          rest.time + rest.up * from_plus + rest.down * from_minus};
}

// With symmetry where all sliding phases are alike, whichever side comes next.
SlidingPhase mirrored(SlidingPhase slide) {
  std::swap(slide.up, slide.down);
  return slide;
}

}  // namespace

FirstPassage first_passage(operators::Systems& systems, const SideChain& sides, double speed) {
  const auto& process = systems.process();
  operators::SystemKey key{0, operators::symmetry_of(process)};
  key.speed_limit = speed;
  auto& system = systems.at(key);
  const KolmogorovOperator& a = system.a();
  const Sticking sticking(process);
  // Also before iterative refinement, whose step shows rounding.
  const auto follow = [&](Vec start) {
    const petsc::Solution nu = system.factors().solve_transposed(start);
    petsc::check(VecAYPX(nu.correction, -1, nu.x));
    return std::pair{sliding_phase_of(a, nu.x, sticking),
                     sliding_phase_of(a, nu.correction, sticking)};
  };
  const auto plus = follow(a.trace_at_exit(Branch::positive));
  const auto minus = process.symmetric() ? std::pair{mirrored(plus.first), mirrored(plus.second)}
                                         : follow(a.trace_at_exit(Branch::negative));
  const auto rest = follow(a.mean_at_zero(model::stationary_distribution(process.noise)));
  const Passage p = passage(sides, sticking, plus.first, minus.first, rest.first),
                q = passage(sides, sticking, plus.second, minus.second, rest.second);
  // Reached so rarely that rounding is all there is.
  const double rounding = std::abs(p.exceeded - q.exceeded);
  if (!(p.exceeded > 2 * rounding)) {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    return {{none, none}, {none, none}, {none, none}};
  }
  return {{p.exceeded, rounding},
          {p.from_slide, std::abs(p.from_slide - q.from_slide)},
          {p.from_rest, std::abs(p.from_rest - q.from_rest)}};
}

namespace {

void append_first_passages(const Computation& computation,
                           const std::vector<FirstPassage>& passages) {
  const auto append = [&](const Row& row, Uncertain FirstPassage::*member) {
    Result result = array(row, computation.question().velocity);
    for (const auto& passage : passages) append_value(result, passage.*member);
    result.partial = std::any_of(result.value.begin(), result.value.end(),
                                 [](double value) { return std::isnan(value); });
    computation.results().push_back(std::move(result));
  };
  append(catalogue::kPPeak, &FirstPassage::exceeded);
  append(catalogue::kFirstPassage, &FirstPassage::from_slide);
  append(catalogue::kFirstPassageRest, &FirstPassage::from_rest);
}

}  // namespace

// From each side, and from rest.
void peak_tasks(Planner& planner) {
  const bool symmetric = planner.symmetric();
  if (!symmetric) planner.need_distribution();  // which has the shares of both sides
  const auto found = planner.collect<FirstPassage>(append_first_passages);
  for (double speed : planner.question().velocity) {
    auto system = planner.system();
    system.speed_limit = speed;
    const auto find = [=](Computation& computation) {
      const SideChain sides = symmetric ? SideChain{} : computation.distribution().sides();
      found->push_back(first_passage(computation.systems, sides, speed));
    };
    planner.add({fmt::format("first passage to |v| = {:g}", speed),
                 {{system, 0, symmetric ? 2 : 3}},
                 find});
  }
}

}  // namespace stickslip::quantities
