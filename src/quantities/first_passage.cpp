#include "stickslip/quantities/first_passage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "stickslip/algebra/rate_elimination.hpp"
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
  Sticking(const model::Process& process, const Starts& starts) {
    const auto chain = operators::StaticChain::of(process);
    time = chain.integral(std::vector<double>(static_cast<std::size_t>(chain.size()), 1.0));
    // With symmetry all starts are alike.
    for (int level : starts.levels) {
      exits.push_back(process.symmetric() ? chain.exit_transform()
                                          : chain.exit_transform_to(level));
    }
    const auto all = model::stationary_distribution(process.noise);
    const auto first = all.begin() + (process.lowest_static() - process.noise.lowest());
    stationary.assign(first, first + chain.size());
  }
  std::vector<double> time;                ///< mean, until it is left
  std::vector<std::vector<double>> exits;  ///< by start: probabilities of leaving for it
  std::vector<double> stationary;          ///< probabilities of the levels
};

/// What becomes of a sliding phase until it reaches the speed or the excursion ends.
struct SlidingPhase {
  double time = 0;           // sliding and sticking
  std::vector<double> next;  // by start: probability that the next one begins there
  double reached = 0;
};

SlidingPhase sliding_phase_of(const KolmogorovOperator& a, Vec nu, const Sticking& sticking) {
  PetscScalar time = 0;
  petsc::check(VecSum(nu, &time));
  std::vector<double> entry;
  for (const auto& p : a.entry_rates(nu)) entry.push_back(PetscRealPart(p));
  SlidingPhase phase{PetscRealPart(time) + dot(entry, sticking.time), {}, a.rate_at_top(nu)};
  for (const auto& exit : sticking.exits) phase.next.push_back(dot(entry, exit));
  return phase;
}

/// The numbers of a speed.
struct Passage {
  double exceeded = 0, from_slide = 0, from_rest = 0;
};

Passage passage(const Starts& starts, const Sticking& sticking,
                const std::vector<SlidingPhase>& from, const SlidingPhase& rest) {
  Passage p;
  std::vector<double> killing, time;
  for (std::size_t t = 0; t < from.size(); ++t) {
    p.exceeded += starts.shares[t] * from[t].reached;
    killing.push_back(from[t].reached);
    time.push_back(from[t].time);
  }
  if (!(p.exceeded > 0)) return p;
  std::vector<algebra::RateElimination::Rate> steps;
  const int count = static_cast<int>(from.size());
  for (int t = 0; t < count; ++t) {
    for (int u = 0; u < count; ++u) {
      if (u != t) steps.push_back({t, u, from[t].next[u]});
    }
  }
  const auto until = algebra::RateElimination(killing, steps).integral(time);
  p.from_slide = dot(starts.shares, until);
  p.from_rest = rest.time + dot(sticking.stationary, sticking.time);
  for (std::size_t t = 0; t < from.size(); ++t) {
    p.from_rest += (rest.next[t] + dot(sticking.stationary, sticking.exits[t])) * until[t];
  }
  return p;
}

}  // namespace

FirstPassage first_passage(operators::Systems& systems, const Starts& starts, double speed) {
  const auto& process = systems.process();
  operators::SystemKey key{0, operators::symmetry_of(process)};
  key.speed_limit = speed;
  auto& system = systems.at(key);
  const KolmogorovOperator& a = system.a();
  const Sticking sticking(process, starts);
  // Also before iterative refinement, whose step shows rounding.
  std::vector<petsc::VecHandle> from;
  for (int level : starts.levels) from.push_back(a.trace_at_start(level));
  from.push_back(a.mean_at_zero(model::stationary_distribution(process.noise)));
  std::vector<SlidingPhase> corrected, uncorrected;
  for (const petsc::Solution& nu : system.factors().solve_transposed(from)) {
    petsc::check(VecAYPX(nu.correction, -1, nu.x));
    corrected.push_back(sliding_phase_of(a, nu.x, sticking));
    uncorrected.push_back(sliding_phase_of(a, nu.correction, sticking));
  }
  const auto passage_of = [&](std::vector<SlidingPhase>& phases) {
    const SlidingPhase rest = std::move(phases.back());
    phases.pop_back();
    return passage(starts, sticking, phases, rest);
  };
  const Passage p = passage_of(corrected), q = passage_of(uncorrected);
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

// From each start, and from rest.
void peak_tasks(Planner& planner) {
  const bool symmetric = planner.symmetric();
  if (!symmetric) planner.need_distribution();  // which has the shares of starts
  const auto found = planner.collect<FirstPassage>(append_first_passages);
  for (double speed : planner.question().velocity) {
    auto system = planner.system();
    system.speed_limit = speed;
    const auto find = [=](Computation& computation) {
      const Starts starts =
          symmetric ? Starts::upwards(computation.process()) : computation.distribution().starts();
      found->push_back(first_passage(computation.systems, starts, speed));
    };
    planner.add({fmt::format("first passage to |v| = {:g}", speed),
                 {{system, 0, planner.starts() + 1}},
                 find});
  }
}

}  // namespace stickslip::quantities
