#include "stickslip/quantities/passage_time.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "stickslip/catalogue/first_passage_keys.hpp"
#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/vectors.hpp"
#include "stickslip/quantities/plan.hpp"
#include "stickslip/quantities/stationary.hpp"
#include "stickslip/quantities/until_passage.hpp"

namespace stickslip::quantities {
namespace {

using operators::KolmogorovOperator;
using petsc::check;
using petsc::dot;

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

}  // namespace

StartingPoint starting_point(operators::Systems& systems, double speed, const model::Start& start,
                             const KolmogorovOperator& a, const StickingPhases& sticking) {
  using enum model::Start::Kind;
  const auto& process = a.discretisation().process;
  const int lowest = process.lowest_static(), highest = process.highest_static();
  if (start.kind == stationary) return stationary_start(systems, speed, a);
  if (start.kind == rest) {
    return {a.mean_at_zero(model::stationary_distribution(process.noise)), sticking.stationary()};
  }
  ByLevel at_rest = sticking.each(0);
  const bool rests = start.v == 0 && lowest <= start.level && start.level <= highest;
  if (rests) at_rest[start.level - lowest] = 1;
  return {a.value_at(start.level, start.v), std::move(at_rest)};
}

StickingPhases sticking_phases(const model::Process& process, operators::Symmetry symmetry,
                               double lambda) {
  const bool reduced = symmetry != operators::Symmetry::none;
  return {process, reduced ? Starts::upwards(process).levels : process.starts(), reduced, lambda};
}

petsc::VecHandle inside(const KolmogorovOperator& a, const operators::SystemKey& key) {
  return a.values([&](double, double, double v) {
    return model::has_passed(*key.passage, v, key.speed_limit) ? 0.0 : 1.0;
  });
}

namespace {

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
  const StickingPhases sticking = sticking_phases(systems.process(), key.symmetry);
  const StartingPoint first = starting_point(systems, key.speed_limit, start, a, sticking);
  const petsc::VecHandle before = inside(a, key);
  const auto nu = occupations_from(system, sticking.starts, petsc::product(first.sliding, before));
  const UntilPassage until(a, sticking, first.at_rest, nu, &petsc::Solution::x),
      roughly(a, sticking, first.at_rest, nu, &petsc::Solution::correction);
  double reached = 0, rounding = 0;
  for (std::size_t t = 0; t < nu.size(); ++t) {
    reached += until.reached()[t];
    rounding += std::abs(until.reached()[t] - roughly.reached()[t]);
  }
  if (!(reached > 2 * rounding)) return {kNoValue, kNoValue};
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
    const petsc::VecHandle to_come = petsc::product(on, before);
    return paths + spread(first, to_come, time.at_rest, time.overall);
  };
  const double var = variance(until, m.x);
  return {{time.overall, std::abs(time.overall - roughly.integral(one, sticking.each(1)).overall)},
          {var, std::abs(var - variance(roughly, m.correction))}};
}

namespace {

void append_passage_times(const Computation& computation, const std::vector<PassageTime>& times) {
  append_by_speed(computation, catalogue::kPassageMean, times, &PassageTime::mean);
  append_by_speed(computation, catalogue::kPassageVariance, times, &PassageTime::variance);
}

}  // namespace

operators::SystemKey passage_system(const Planner& planner, double speed) {
  auto key = planner.system();
  key.speed_limit = speed;
  key.passage = planner.question().passage;
  if (key.passage != model::Passage::both) key.symmetry = operators::Symmetry::none;
  return key;
}

int starts_in(const Planner& planner, const operators::SystemKey& key) {
  if (key.symmetry != operators::Symmetry::none) return planner.starts();
  return static_cast<int>(planner.given().scene.meant().starts().size());
}

Task passage_task(const Planner& planner, const char* name, const operators::SystemKey& key) {
  Task task{fmt::format("{} to w = {:g}", name, key.speed_limit)};
  task.adaptive = planner.question().start.kind == model::Start::Kind::stationary;
  if (task.adaptive) task.usual_factorizations = 1, task.usual_solves = planner.starts();
  return task;
}

void first_passage_tasks(Planner& planner) {
  planner.resolve_speeds();
  const auto& start = planner.question().start;
  const auto found = planner.collect<PassageTime>(append_passage_times);
  for (double speed : planner.question().velocity) {
    const auto key = passage_system(planner, speed);
    const auto find = [=, start = start](Computation& computation) {
      found->push_back(computation.value_or(PassageTime{kNoValue, kNoValue}, [&] {
        return passage_time(computation.systems, key, start);
      }));
    };
    Task task = passage_task(planner, "passage time", key);
    task.uses = {{key, 0, starts_in(planner, key) + 1}, {key, 1, 0}};
    task.carry_out = find;
    planner.add(std::move(task));
  }
}

}  // namespace stickslip::quantities
