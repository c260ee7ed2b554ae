#include "stickslip/quantities/passage_time.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

#include "stickslip/algebra/rate_elimination.hpp"
#include "stickslip/catalogue/first_passage_keys.hpp"
#include "stickslip/operators/static_chain.hpp"
#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/vectors.hpp"
#include "stickslip/quantities/plan.hpp"
#include "stickslip/quantities/stationary.hpp"

namespace stickslip::quantities {
namespace {

using operators::KolmogorovOperator;
using petsc::check;
using petsc::dot;
using ByLevel = std::vector<double>;  // of static levels, from the lowest up

double sum_of_products(const ByLevel& a, const ByLevel& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

/// Where sticking phases lead; nothing of a body that never rests.
struct StickingPhases {
  StickingPhases(const model::Process& of, bool reduced) : process(of), symmetric(reduced) {
    if (!process.sticks()) return;
    chain.emplace(operators::StaticChain::of(process));
    starts = symmetric ? Starts::upwards(process).levels : process.starts();
    // With symmetry all starts are alike.
    for (int level : starts) {
      exits.push_back(symmetric ? chain->exit_transform() : chain->exit_transform_to(level));
    }
  }
  [[nodiscard]] ByLevel each(double value) const {
    return ByLevel(chain ? static_cast<std::size_t>(chain->size()) : 0, value);
  }
  /// KolmogorovOperator::square_field() at rest.
  [[nodiscard]] ByLevel square_field(const ByLevel& at_rest, const ByLevel& at_starts) const {
    ByLevel f = each(0);
    const int lowest = process.lowest_static();
    for (std::size_t n = 0; n < f.size(); ++n) {
      process.noise.for_each_jump(lowest + static_cast<int>(n), [&](int to, double rate) {
        const bool rests = lowest <= to && to <= process.highest_static();
        const auto start = std::ranges::find(starts, symmetric ? std::abs(to) : to);
        const double change =
            (rests ? at_rest[to - lowest] : at_starts[start - starts.begin()]) - at_rest[n];
        f[n] += rate * change * change;
      });
    }
    return f;
  }

  const model::Process& process;
  bool symmetric;
  std::optional<operators::StaticChain> chain;
  std::vector<int> starts;
  std::vector<ByLevel> exits;  // by start: probabilities of leaving for it
};

/// u -> sliding . u + at_rest . u over the states of a start.
struct StartingPoint {
  petsc::VecHandle sliding;
  ByLevel at_rest;
};

/// What is gathered until a passage, from the sliding phases from each start and, last, the first
/// one.
class UntilPassage {
 public:
  UntilPassage(const KolmogorovOperator& a, const StickingPhases& sticking, const ByLevel& at_rest,
               std::vector<Vec> nu)
      : sticking_(sticking), at_rest_(at_rest), nu_(std::move(nu)) {
    for (Vec of : nu_) {
      entry_.emplace_back();
      for (const auto& rate : a.entry_rates(of)) entry_.back().push_back(PetscRealPart(rate));
      reached_.push_back(a.rate_at_top(of));
    }
  }

  /// Probabilities of reaching the speed in a sliding phase.
  [[nodiscard]] const std::vector<double>& reached() const { return reached_; }

  /// The mean integral of f, given on sliding and static states.
  struct Integral {
    double overall;
    ByLevel at_rest, at_starts;
  };
  [[nodiscard]] Integral integral(Vec f, const ByLevel& f_at_rest) const {
    Integral sum{dot(nu_.back(), f), {}, {}};
    if (!sticking_.chain) return sum;
    sum.at_rest = sticking_.chain->integral(f_at_rest);
    const std::size_t count = sticking_.starts.size();
    std::vector<algebra::RateElimination::Rate> steps;
    for (std::size_t t = 0; t < count; ++t) {
      sum.at_starts.push_back(dot(nu_[t], f) + sum_of_products(entry_[t], sum.at_rest));
      for (std::size_t u = 0; u < count; ++u) {
        if (u == t) continue;
        steps.push_back({static_cast<int>(t), static_cast<int>(u),
                         sum_of_products(entry_[t], sticking_.exits[u])});
      }
    }
    const std::vector<double> killing(reached_.begin(), reached_.end() - 1);
    sum.at_starts = algebra::RateElimination(killing, steps).integral(std::move(sum.at_starts));
    for (std::size_t u = 0; u < count; ++u) {
      for (std::size_t i = 0; i < sum.at_rest.size(); ++i) {
        sum.at_rest[i] += sticking_.exits[u][i] * sum.at_starts[u];
      }
    }
    sum.overall +=
        sum_of_products(entry_.back(), sum.at_rest) + sum_of_products(at_rest_, sum.at_rest);
    return sum;
  }

 private:
  const StickingPhases& sticking_;
  const ByLevel& at_rest_;
  std::vector<Vec> nu_;
  std::vector<ByLevel> entry_;
  std::vector<double> reached_;
};

// The stationary distribution, with what is beyond the speed.
StartingPoint stationary_start(operators::Systems& systems, double speed,
                               const KolmogorovOperator& a) {
  operators::Systems whole(systems.comm(), systems.discretisation().passing(speed, std::nullopt),
                           systems.statistics());
  const StationaryDistribution law(whole);
  const auto& states = law.states();
  const petsc::ReadView nu(law.occupation());
  const bool halved = states.symmetry_reduced() && !a.states().symmetry_reduced();
  const double total = law.excursion().mean_excursion() * (halved ? 2 : 1);
  StartingPoint start{a.zeros(), law.excursion().stick_time};
  {
    petsc::WriteView local(start.sliding);
    PetscInt at = 0;
    a.states().for_each_local([&](operators::State state) {
      if (halved) state.branch = operators::Branch::positive;
      local[at++] = nu[states.index(state) - states.local_begin()] / total;
    });
  }
  if (halved) {
    const ByLevel stick = start.at_rest;
    for (std::size_t n = 0; n < stick.size(); ++n) start.at_rest[n] += stick[stick.size() - 1 - n];
  }
  for (double& share : start.at_rest) share /= total;
  return start;
}

StartingPoint starting_point(operators::Systems& systems, double speed, const model::Start& start,
                             const KolmogorovOperator& a, ByLevel at_rest) {
  using enum model::Start::Kind;
  const auto& process = a.discretisation().process;
  const int lowest = process.lowest_static(), highest = process.highest_static();
  if (start.kind == stationary) return stationary_start(systems, speed, a);
  if (start.kind == rest) {
    const auto p = model::stationary_distribution(process.noise);
    std::copy_n(p.begin() + (lowest - process.noise.lowest()), at_rest.size(), at_rest.begin());
    return {a.mean_at_zero(p), std::move(at_rest)};
  }
  const bool rests = start.v == 0 && lowest <= start.level && start.level <= highest;
  if (rests) at_rest[start.level - lowest] = 1;
  return {a.value_at(start.level, start.v), std::move(at_rest)};
}

// Of starts about their mean.
double spread(const StartingPoint& start, Vec m, const ByLevel& at_rest, double mean) {
  const petsc::VecHandle square = petsc::copy_of(m);
  check(VecShift(square, -mean));
  check(VecPointwiseMult(square, square, square));
  double sum = dot(start.sliding, square);
  for (std::size_t n = 0; n < at_rest.size(); ++n) {
    sum += start.at_rest[n] * (at_rest[n] - mean) * (at_rest[n] - mean);
  }
  return sum;
}

}  // namespace

PassageTime passage_time(operators::Systems& systems, const operators::SystemKey& key,
                         const model::Start& start) {
  auto& system = systems.at(key);
  const KolmogorovOperator& a = system.a();
  const StickingPhases sticking(systems.process(), a.states().symmetry_reduced());
  const StartingPoint first = starting_point(systems, key.speed_limit, start, a, sticking.each(0));
  const auto inside = a.values([&](double, double, double v) {
    return model::has_passed(*key.passage, v, key.speed_limit) ? 0.0 : 1.0;
  });
  std::vector<petsc::VecHandle> from;
  for (int level : sticking.starts) from.push_back(a.trace_at_start(level));
  from.push_back(petsc::copy_of(first.sliding));
  check(VecPointwiseMult(from.back(), from.back(), inside));
  // Also before iterative refinement, whose step shows rounding.
  const auto solutions = system.factors().solve_transposed(from);
  std::vector<Vec> refined, plain;
  for (const petsc::Solution& nu : solutions) {
    check(VecAYPX(nu.correction, -1, nu.x));
    refined.push_back(nu.x);
    plain.push_back(nu.correction);
  }
  const UntilPassage until(a, sticking, first.at_rest, refined),
      roughly(a, sticking, first.at_rest, plain);
  double reached = 0, rounding = 0;
  for (std::size_t t = 0; t < solutions.size(); ++t) {
    reached += until.reached()[t];
    rounding += std::abs(until.reached()[t] - roughly.reached()[t]);
  }
  if (!(reached > 2 * rounding)) {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    return {{none, none}, {none, none}};
  }
  const auto one = a.values([](double, double, double) { return 1.0; });
  const auto time = until.integral(one, sticking.each(1));
  const petsc::VecHandle source = a.from_static({time.at_rest.begin(), time.at_rest.end()});
  check(VecAXPY(source, 1, one));
  const petsc::Solution m = system.factors().solve(source);
  check(VecAYPX(m.correction, -1, m.x));
  const auto variance = [&](const UntilPassage& by, Vec on) {
    const auto field = a.square_field(on, time.at_rest);
    const auto paths =
        by.integral(field, sticking.square_field(time.at_rest, time.at_starts)).overall;
    if (start.kind == model::Start::Kind::state) return paths;
    const petsc::VecHandle to_come = petsc::copy_of(on);
    check(VecPointwiseMult(to_come, to_come, inside));
    return paths + spread(first, to_come, time.at_rest, time.overall);
  };
  const double var = variance(until, m.x);
  return {{time.overall, std::abs(time.overall - roughly.integral(one, sticking.each(1)).overall)},
          {var, std::abs(var - variance(roughly, m.correction))}};
}

namespace {

void append_passage_times(const Computation& computation, const std::vector<PassageTime>& times) {
  const auto append = [&](const Row& row, Uncertain PassageTime::*member) {
    Result result = array(row, computation.question().velocity);
    for (const auto& time : times) append_value(result, time.*member);
    result.partial = std::ranges::any_of(result.value, [](double v) { return std::isnan(v); });
    computation.results().push_back(std::move(result));
  };
  append(catalogue::kPassageMean, &PassageTime::mean);
  append(catalogue::kPassageVariance, &PassageTime::variance);
}

}  // namespace

// With symmetry |V| has that of one branch; passages of V itself need both.
void first_passage_tasks(Planner& planner) {
  const auto& [start, passage] = std::pair{planner.question().start, planner.question().passage};
  const bool stationary = start.kind == model::Start::Kind::stationary;
  const auto found = planner.collect<PassageTime>(append_passage_times);
  for (double speed : planner.question().velocity) {
    auto key = planner.system();
    key.speed_limit = speed;
    key.passage = passage;
    if (passage != model::Passage::both) key.symmetry = operators::Symmetry::none;
    const auto scene = planner.given().scene.meant();
    const int starts = key.symmetry == operators::Symmetry::none
                           ? static_cast<int>(scene.starts().size())
                           : planner.starts();
    const auto find = [=, start = start](Computation& computation) {
      found->push_back(passage_time(computation.systems, key, start));
    };
    Task task{fmt::format("passage time to w = {:g}", speed), {{key, 0, starts + 1}, {key, 1, 0}}};
    task.carry_out = find;
    task.adaptive = stationary;
    if (stationary) task.usual_factorizations = 1, task.usual_solves = planner.starts();
    planner.add(std::move(task));
  }
}

}  // namespace stickslip::quantities
