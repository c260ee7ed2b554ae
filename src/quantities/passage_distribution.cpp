#include "stickslip/quantities/passage_distribution.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include "stickslip/catalogue/passage_distribution_keys.hpp"
#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/vectors.hpp"
#include "stickslip/quantities/passage_time.hpp"
#include "stickslip/quantities/plan.hpp"
#include "stickslip/quantities/time_functions.hpp"
#include "stickslip/quantities/unturned.hpp"

namespace stickslip::quantities {
namespace {

using operators::KolmogorovOperator;
using operators::StaticPhase;
using petsc::check;
using petsc::dot;
using petsc::product;

// The probability that a start is beyond the speed.
double passed(const StartingPoint& first, const KolmogorovOperator& a,
              const operators::SystemKey& key) {
  const petsc::VecHandle beyond = inside(a, key);
  check(VecScale(beyond, -1));
  check(VecShift(beyond, 1));
  return dot(first.sliding, beyond);
}

// E[exp(-lambda T)] with the lambda of `key`, from a start below the speed or a stationary one.
Uncertain transform_from(const StartingPoint& first, bool stationary, operators::Systems& systems,
                         const operators::SystemKey& key) {
  auto& system = systems.at(key);
  const KolmogorovOperator& a = system.a();
  const StickingPhases sticking = sticking_phases(systems.process(), key.symmetry, key.lambda);
  const auto nu = occupations_from(system, sticking.starts, product(first.sliding, inside(a, key)));
  const auto one = a.values([](double, double, double) { return 1.0; });
  const auto by = [&](petsc::VecHandle petsc::Solution::*which) {
    return UntilPassage(a, sticking, first.at_rest, nu, which).transform(key.lambda, one);
  };
  const double later = by(&petsc::Solution::x),
               value = later + (stationary ? passed(first, a, key) : 0),
               rounding = std::abs(later - by(&petsc::Solution::correction));
  return value > 2 * rounding ? Uncertain{value, rounding} : kNoValue;
}

// A start on an operator that keeps static states, which lists sliding states in the same order;
// symmetry-reduced, levels i and -i at rest are one state.
petsc::VecHandle on_all_states(const KolmogorovOperator& whole, const StartingPoint& first) {
  petsc::VecHandle all = whole.zeros();
  petsc::WriteView local(all);
  const petsc::ReadView sliding(first.sliding);
  const int lowest = whole.discretisation().process.lowest_static();
  PetscInt at = 0, next = 0;
  whole.states().for_each_local([&](const operators::State& state) {
    if (state.kind != operators::StateKind::static_phase) {
      local[at++] = sliding[next++];
      return;
    }
    const bool pair = whole.states().symmetry_reduced() && state.noise != 0;
    local[at++] =
        first.at_rest[state.noise - lowest] + (pair ? first.at_rest[-state.noise - lowest] : 0);
  });
  return all;
}

/// Density and distribution function at positive times.
class Curves {
 public:
  struct Values {
    Uncertain density, below;
  };
  Curves(ProcessPencil& pencil, const Ends& ends, double speed, double mean,
         const ModelTolerance& tolerance)
      : pencil_(pencil), ends_(ends), speed_(speed), mean_(mean), tolerance_(tolerance) {}

  // Of rising times. Bodies that the noise does not turn arrive all at once, which is hard to
  // model: where the tolerance is not met, the earlier and the later half of the times have models
  // of their own, and what a single time still misses is taken for three times as much.
  void find(const std::vector<double>& time) {
    auto& recipe =
        tolerance_.recipe(fmt::format("passage {} {} {}", speed_, time.front(), time.back()));
    const auto process = pencil_.a().discretisation().process;
    const auto curve =
        time_curve(pencil_, ends_, ReducedModel::Nature::rough, {{0, 1 / mean_}, {1, 1}}, time,
                   time_scales(process), tolerance_.value, recipe);
    pairs_ = std::max(pairs_, curve.pairs);
    double error = 0;
    for (std::size_t n = 0; n < time.size(); ++n) {
      const Values values{curve.value[0][n], curve.value[1][n]};
      found_[time[n]] = values;
      error = std::max({error, values.density.error * mean_, values.below.error});
    }
    if (error <= tolerance_.value) return;
    if (time.size() == 1) {
      found_[time[0]].density.error *= 3;
      found_[time[0]].below.error *= 3;
      return;
    }
    const auto middle = time.begin() + static_cast<std::ptrdiff_t>(time.size() / 2);
    find({time.begin(), middle});
    find({middle, time.end()});
  }

  // With a step in the place of what elements make of it, which is as doubtful as it is wrong.
  void sharpen(const std::vector<double>& time, const std::vector<Unturned>& steps) {
    for (std::size_t n = 0; n < time.size(); ++n) {
      const auto& [exact, distribution, density] = steps[n];
      auto& values = found_[time[n]];
      values.density = values.density + Uncertain{-density, std::abs(density)};
      values.below = values.below + Uncertain{exact - distribution, std::abs(exact - distribution)};
    }
  }

  [[nodiscard]] Values at(double time) const { return found_.at(time); }
  [[nodiscard]] int pairs() const { return pairs_; }

 private:
  ProcessPencil& pencil_;
  const Ends& ends_;
  double speed_, mean_;
  const ModelTolerance& tolerance_;
  std::map<double, Values> found_;
  int pairs_ = 0;
};

}  // namespace

std::vector<Uncertain> passage_transform(operators::Systems& systems, operators::SystemKey key,
                                         const model::Start& start,
                                         const std::vector<double>& lambda) {
  std::vector<Uncertain> values;
  std::optional<StartingPoint> first;
  for (double s : lambda) {
    key.lambda = s;
    if (!first) {
      first = starting_point(systems, key.speed_limit, start, systems.at(key).a(),
                             sticking_phases(systems.process(), key.symmetry));
    }
    const bool stationary = start.kind == model::Start::Kind::stationary;
    values.push_back(transform_from(*first, stationary, systems, key));
    systems.release(key);
  }
  return values;
}

DurationDistribution passage_distribution(operators::Systems& systems,
                                          const operators::SystemKey& key,
                                          const model::Start& start,
                                          const std::vector<double>& time,
                                          const ModelTolerance& tolerance) {
  const bool stationary = start.kind == model::Start::Kind::stationary;
  const double mean = passage_time(systems, key, start).mean.value, w = key.speed_limit;
  const std::vector<Uncertain> too_rare(time.size(), kNoValue);
  if (!(mean > 0)) return {too_rare, too_rare};
  operators::Systems killed(systems.comm(), systems.discretisation().passing(w, key.passage),
                            systems.statistics());
  ProcessPencil pencil(killed, key.symmetry, StaticPhase::kept);
  const KolmogorovOperator &a = pencil.a(), &moving = systems.at(key).a();
  const StickingPhases sticking = sticking_phases(systems.process(), key.symmetry);
  const StartingPoint first = starting_point(systems, w, start, moving, sticking);
  std::optional<StartingPoint> law;
  if (!stationary) {
    const model::Start of_law{.kind = model::Start::Kind::stationary};
    law = starting_point(systems, w, of_law, moving, sticking);
  }
  const petsc::VecHandle b = a.rates_to_top(), c = product(on_all_states(a, first), inside(a, key)),
                         d = positive_weight(on_all_states(a, law ? *law : first));
  const Ends ends{b, c, d};
  Curves curves(pencil, ends, w, mean, tolerance);
  const double longest = 10 * *std::ranges::max_element(time),
               earliest =
                   stationary ? 0 : earliest_arrival(killed.discretisation(), key, start, longest);
  std::vector<double> later;
  std::ranges::copy_if(time, std::back_inserter(later),
                       [earliest](double t) { return t > 0 && t >= earliest; });
  std::ranges::sort(later);
  later.erase(std::unique(later.begin(), later.end()), later.end());
  const double at_once = stationary ? passed(first, moving, key) : 0;
  double missed = 0;
  if (!later.empty()) {
    curves.find(later);
    if (!stationary) {
      const double least = 1e-2 * tolerance.value;
      curves.sharpen(later, before_first_jump(killed.discretisation(), key, start, later, least));
    }
    auto at_the_end = key;
    at_the_end.lambda = 1 / later.back();
    const petsc::VecHandle x = a.zeros();
    pencil.solve(at_the_end.lambda, b, x, false, true);
    const Uncertain known = transform_from(first, stationary, systems, at_the_end);
    systems.release(at_the_end);
    missed = std::numbers::e * std::abs(dot(c, x) + at_once - known.value);
  }
  DurationDistribution found{{}, {}, curves.pairs()};
  for (double t : time) {
    const bool known = t == 0 || t < earliest;
    const auto [density, below] = known ? Curves::Values{} : curves.at(t);
    found.density.push_back(density + Uncertain{0, known ? 0 : missed / t});
    found.distribution.push_back(below + Uncertain{at_once, known ? 0 : missed});
    if (t == 0 && stationary) found.density.back().value = dot(c, b);
  }
  return found;
}

namespace {

Result of_speed(const Row& row, const std::vector<double>& abscissa, double speed,
                const std::vector<Uncertain>& values) {
  Result result = array(row, abscissa);
  result.key = row.key_of(fmt::format("{}", speed));
  for (const Uncertain& value : values) append_value(result, value);
  name_too_rare(result);
  return result;
}

}  // namespace

void passage_transform_tasks(Planner& planner) {
  const auto& question = planner.question();
  planner.resolve_lambda();
  planner.resolve_speeds();
  for (double speed : question.velocity) {
    const auto key = passage_system(planner, speed);
    Task task = passage_task(planner, "transform of the passage time", key);
    for (double s : question.lambda) {
      task.uses.push_back({key, 0, starts_in(planner, key) + 1});
      task.uses.back().system.lambda = s;
    }
    task.carry_out = [=](Computation& computation) {
      const auto lambda = computation.question().lambda;
      const auto start = computation.question().start;
      const std::vector<Uncertain> none(lambda.size(), kNoValue);
      const auto values = computation.value_or(
          none, [&] { return passage_transform(computation.systems, key, start, lambda); });
      computation.results().push_back(
          of_speed(catalogue::kPassageTransform, lambda, speed, values));
    };
    planner.add(std::move(task));
  }
}

void passage_distribution_tasks(Planner& planner) {
  planner.resolve_speeds();
  for (double speed : planner.question().velocity) {
    const auto key = passage_system(planner, speed);
    const int starts = starts_in(planner, key);
    Task task = passage_task(planner, "distribution of the passage time", key);
    task.uses = {{key, 0, starts + 1}, {key, 1, 0}};
    task.adaptive = true;
    task.usual_factorizations += 28;
    task.usual_solves += 480;
    task.carry_out = [=](Computation& computation) {
      const auto& question = computation.question();
      const std::vector<Uncertain> none(question.time.size(), kNoValue);
      const auto found = computation.value_or(DurationDistribution{none, none}, [&] {
        return passage_distribution(computation.systems, key, question.start, question.time,
                                    computation.tolerance());
      });
      auto& results = computation.results();
      results.push_back(of_speed(catalogue::kPassageDensity, question.time, speed, found.density));
      results.back().diagnostic = true;  // the derivative of the other one, which decides
      results.push_back(of_speed(catalogue::kPassageCdf, question.time, speed, found.distribution));
      computation.report("passage_pairs", found.pairs,
                         "pairs of Krylov vectors in the reduced model of passage times");
    };
    planner.add(std::move(task));
  }
}

}  // namespace stickslip::quantities
