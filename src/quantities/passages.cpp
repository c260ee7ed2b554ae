#include "stickslip/quantities/passages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include "stickslip/case/passage_rows.hpp"
#include "stickslip/simulation/flow.hpp"

namespace stickslip::quantities {
namespace {

using generator::KolmogorovOperator;
using generator::StaticPhase;
using linalg::check;
using linalg::dot;
using linalg::product;

// When a body on one level reaches the speed, up to the time `longest`; infinite if it does not.
double arrival(const model::Process& process, const generator::SystemKey& key, int level, double v,
               double longest) {
  const double w = key.speed_limit;
  const auto mirrored = process.mirrored();
  const bool rests = process.sticks(level);
  bool upwards = v != 0 ? v > 0 : level > process.highest_static();
  double speed = std::abs(v), now = 0;
  for (bool turned = false; speed > 0 || !rests; turned = true, upwards = !upwards, speed = 0) {
    const auto& seen = upwards ? process : mirrored;
    const double force = seen.net_force(upwards ? level : -level);
    const simulation::GeneralFlow flow(seen.drag);
    if (model::has_passed(*key.passage, upwards ? w : -w, w)) {
      // Soon, as a rule: long motions take long to follow.
      for (double until = 1 / process.noise.rate(level);; until *= 4) {
        const double rise = simulation::rise_time(flow, speed, force, std::min(until, longest), w);
        if (std::isfinite(rise)) return now + rise;
        if (until >= longest) break;
      }
    }
    const auto piece = flow.move(speed, force, longest, false);
    if (turned || !piece.stopped) break;
    now += piece.time;
  }
  return kInfinity;
}

/// Transport by one force on elements, without a way back once it has changed, at a rate: u' = M u,
/// where the last state is that of having passed, and u -> start u.
struct Transport {
  linalg::Matrix<double> m;
  std::vector<double> start;
};

// Without elements beyond the speed, which nobody reaches who starts below, and without the other
// branch, unless the body may turn round.
Transport transport(const generator::Discretisation& killed, int level, double v, double w,
                    double rate) {
  const auto& process = killed.process;
  const auto& axis = *killed.velocities;
  const auto nodes = axis.nodes();
  const int size = static_cast<int>(
      std::abs(v) < w ? std::ranges::lower_bound(nodes, w) - nodes.begin() : axis.size());
  const bool rests = process.sticks(level);
  const bool pushed_up = level > process.highest_static(), starts_up = v != 0 ? v > 0 : pushed_up;
  const int branches = v == 0 || rests || starts_up == pushed_up ? 1 : 2, last = branches * size;
  Transport t{linalg::Matrix<double>(last + 1, last + 1),
              std::vector<double>(static_cast<std::size_t>(last) + 1)};
  // The branch on which the body starts is first; at v = 0 the level pushes it onto the last.
  const auto at_zero = [&](const auto& add) {
    if (rests) return;
    for (const auto& e : axis.trace_at_zero()) add(last - size + e.node, e.value);
  };
  for (int branch = 0; branch < branches; ++branch) {
    const bool up = starts_up != (branch > 0);
    const auto& along = up ? axis : axis.mirrored();
    const double force = up ? process.net_force(level) : process.mirrored().net_force(-level);
    for (int j = 0; j < size; ++j) {
      generator::TransportRow row;
      along.transport(force, j, row);
      const int at = branch * size + j;
      double leaving = rate + row.inflow + row.outflow + row.killed;
      for (const auto& e : row.entries) {
        if (e.node < size) t.m(at, branch * size + e.node) += e.value;
        leaving += e.value;
      }
      t.m(at, at) -= leaving;
      t.m(at, last) = row.killed;
      at_zero([&](int to, double share) { t.m(at, to) += row.inflow * share; });
    }
  }
  if (v == 0) {
    at_zero([&](int to, double share) { t.start[to] += share; });
  } else {
    for (const auto& e : axis.value_at(std::abs(v))) t.start[e.node] = e.value;
  }
  return t;
}

// The time before which nobody arrives from a start that is not stationary, as forces between those
// of the lowest and the highest level make nobody faster than these two; infinite beyond `longest`.
// 0 on grids and on springs.
double earliest_arrival(const generator::Discretisation& killed, const generator::SystemKey& key,
                        const model::Start& start, double longest) {
  if (killed.velocities->keeps_origin() || start.p) return 0;
  const auto& process = killed.process;
  return std::min(arrival(process, key, process.noise.lowest(), start.v, longest),
                  arrival(process, key, process.noise.highest(), start.v, longest));
}

// What bodies that reach the speed before the force first changes, all at one time, add to density
// and distribution function at one time.
struct Unturned {
  double exact = 0;                      // P(T <= t) by their path, a step
  double distribution = 0, density = 0;  // by the elements, which smear the step out
};

// By time > 0, from a start that is not stationary. On level i with the probability p_i such a body
// arrives after t_i, and with the probability p_i exp(-rate_i t_i), rate_i the largest one at which
// levels of its force are left for others, as if all were left at that rate: of those left more
// slowly a part. On the elements it is transported by the matrix of its force alone. What has less
// than `least` of the probability is left out. Zero on grids, which are chains of their own, and on
// springs, whose noise has continuous paths.
// `killed` kills at the speed of `key`. O(size^3) for each level, size that of the elements below
// the speed.
std::vector<Unturned> before_first_jump(const generator::Discretisation& killed,
                                        const generator::SystemKey& key, const model::Start& start,
                                        const std::vector<double>& time, double least) {
  const auto& process = killed.process;
  const double longest = 10 * *std::ranges::max_element(time);
  std::vector<Unturned> all(time.size());
  if (killed.velocities->keeps_origin() || start.p) return all;
  const auto levels = model::levels_at(process.noise, start);
  for (int i = process.noise.lowest(); i <= process.noise.highest(); ++i) {
    const double p = levels[static_cast<std::size_t>(i - process.noise.lowest())], v = start.v;
    if (p < least) continue;
    constexpr double most = 40;  // jumps that do not happen
    const double rate = model::change_rates(process.noise, i).most,
                 arrives = arrival(process, key, i, v, std::min(longest, most / rate)),
                 jump = p * std::exp(-rate * arrives);
    if (jump < least) continue;
    const Transport moved = transport(killed, i, v, key.speed_limit, rate);
    for (std::size_t n = 0; n < time.size(); ++n) {
      const auto states = moved.start * linalg::exponential(moved.m, time[n]);
      all[n].exact += time[n] >= arrives ? jump : 0;
      all[n].distribution += p * states.back();
      all[n].density += p * (states * moved.m).back();
    }
  }
  return all;
}

// u -> sliding . u + at_rest . u over the states of a start.
struct StartingPoint {
  linalg::VecHandle sliding;
  ByLevel at_rest;
};

// The stationary distribution, with what is beyond the speed; it is found on the same elements
// without killing.
StartingPoint stationary_start(generator::Systems& systems, double speed,
                               const KolmogorovOperator& a) {
  generator::Systems whole(systems.comm(),
                           systems.discretisation().cut_at(speed, true, std::nullopt),
                           systems.statistics());
  const StationaryDistribution law(whole);
  const auto& states = law.states();
  const linalg::ReadView nu(law.occupation());
  const bool halved = states.symmetry_reduced() && !a.states().symmetry_reduced();
  const double total = law.excursion().mean_excursion() * (halved ? 2 : 1);
  StartingPoint start{a.by_state([&](generator::State state) {
                        if (halved) state.branch = generator::Branch::positive;
                        return nu[states.index(state) - states.local_begin()] / total;
                      }),
                      law.excursion().stick_time};
  if (halved) {
    const ByLevel stick = start.at_rest;
    for (std::size_t n = 0; n < stick.size(); ++n) start.at_rest[n] += stick[stick.size() - 1 - n];
  }
  for (double& share : start.at_rest) share /= total;
  return start;
}

// On sliding states alone, those of `a`, which ends elements at `speed`.
StartingPoint starting_point(generator::Systems& systems, double speed, const model::Start& start,
                             const KolmogorovOperator& a, const StickingPhases& sticking) {
  if (start.kind == model::Start::Kind::stationary) return stationary_start(systems, speed, a);
  const auto shares = model::levels_at(a.discretisation().process.noise, start);
  return {a.mean_at(shares, start.v),
          start.v == 0 ? sticking.static_part(shares) : sticking.each(0)};
}

// Where excursions start, by the states that a system of that symmetry keeps.
StickingPhases sticking_phases(const model::Process& process, generator::Symmetry symmetry,
                               double lambda = 0) {
  const bool reduced = symmetry != generator::Symmetry::none;
  return {process, reduced ? Starts::upwards(process).levels : process.starts(), reduced, lambda};
}

// 1 in the states of `a` that are not beyond the speed of a passage, 0 in others.
linalg::VecHandle inside(const KolmogorovOperator& a, const generator::SystemKey& key) {
  return a.values([&](double, double, double v) {
    return model::has_passed(*key.passage, v, key.speed_limit) ? 0.0 : 1.0;
  });
}

// Of starts about their mean.
double spread(const StartingPoint& start, Vec m, const ByLevel& at_rest, double mean) {
  const linalg::VecHandle square = linalg::copy_of(m);
  check(VecShift(square, -mean));
  check(VecPointwiseMult(square, square, square));
  double sum = dot(start.sliding, square);
  for (std::size_t n = 0; n < at_rest.size(); ++n) {
    sum += start.at_rest[n] * (at_rest[n] - mean) * (at_rest[n] - mean);
  }
  return sum;
}

// The reason of entries without a value: speeds that are reached so rarely that rounding is all
// there is.
void name_too_rare(Result& result) {
  if (!all_numbers(result)) {
    result.unreached = "is beyond double precision, being too rare; leave that entry out";
  }
}

// Appends one of the numbers of each speed of -velocity as an array.
template <class Passage>
void append_by_speed(const Computation& computation, const Row& row,
                     const std::vector<Passage>& passages, Uncertain Passage::*member) {
  Result result = array(row, computation.question().velocity);
  for (const auto& passage : passages) append_value(result, passage.*member);
  name_too_rare(result);
  computation.results().push_back(std::move(result));
}

// The systems of a passage of `speed` as asked for: with symmetry |V| has that of one branch;
// passages of V itself need both.
generator::SystemKey passage_system(const Planner& planner, double speed) {
  auto key = planner.system();
  key.speed_limit = speed;
  key.passage = planner.question().passage;
  if (key.passage != model::Passage::both) key.symmetry = generator::Symmetry::none;
  return key;
}

// From how many levels excursions start in these.
int starts_in(const Planner& planner, const generator::SystemKey& key) {
  if (key.symmetry != generator::Symmetry::none) return planner.starts();
  return static_cast<int>(planner.given().scene.meant().starts().size());
}

// One about that passage, still without uses: a stationary start takes a factorisation of its own.
Task passage_task(const Planner& planner, const char* name, const generator::SystemKey& key) {
  Task task{fmt::format("{} to w = {:g}", name, key.speed_limit)};
  task.adaptive = planner.question().start.kind == model::Start::Kind::stationary;
  if (task.adaptive) task.usual_factorizations = 1, task.usual_solves = planner.starts();
  return task;
}

// The probability that a start is beyond the speed.
double passed(const StartingPoint& first, const KolmogorovOperator& a,
              const generator::SystemKey& key) {
  const linalg::VecHandle beyond = inside(a, key);
  check(VecScale(beyond, -1));
  check(VecShift(beyond, 1));
  return dot(first.sliding, beyond);
}

// E[exp(-lambda T)] with the lambda of `key`, from a start below the speed or a stationary one.
Uncertain transform_from(const StartingPoint& first, bool stationary, generator::Systems& systems,
                         const generator::SystemKey& key) {
  auto& system = systems.at(key);
  const KolmogorovOperator& a = system.a();
  const StickingPhases sticking = sticking_phases(systems.process(), key.symmetry, key.lambda);
  const auto nu = occupations_from(system, sticking.starts, product(first.sliding, inside(a, key)));
  const auto one = a.values([](double, double, double) { return 1.0; });
  const auto by = [&](linalg::VecHandle linalg::Solution::*which) {
    return UntilPassage(a, sticking, first.at_rest, nu, which).transform(key.lambda, one);
  };
  const double later = by(&linalg::Solution::x),
               value = later + (stationary ? passed(first, a, key) : 0),
               rounding = std::abs(later - by(&linalg::Solution::correction));
  return value > 2 * rounding ? Uncertain{value, rounding} : kNoValue;
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

Result of_speed(const Row& row, const std::vector<double>& abscissa, double speed,
                const std::vector<Uncertain>& values) {
  Result result = array_at(row, speed, abscissa);
  for (const Uncertain& value : values) append_value(result, value);
  name_too_rare(result);
  return result;
}

}  // namespace

PassageTime passage_time(generator::Systems& systems, const generator::SystemKey& key,
                         const model::Start& start) {
  auto& system = systems.at(key);
  const KolmogorovOperator& a = system.a();
  const StickingPhases sticking = sticking_phases(systems.process(), key.symmetry);
  const StartingPoint first = starting_point(systems, key.speed_limit, start, a, sticking);
  const linalg::VecHandle before = inside(a, key);
  const auto nu = occupations_from(system, sticking.starts, linalg::product(first.sliding, before));
  const UntilPassage until(a, sticking, first.at_rest, nu, &linalg::Solution::x),
      roughly(a, sticking, first.at_rest, nu, &linalg::Solution::correction);
  double reached = 0, rounding = 0;
  for (std::size_t t = 0; t < nu.size(); ++t) {
    reached += until.reached()[t];
    rounding += std::abs(until.reached()[t] - roughly.reached()[t]);
  }
  if (!(reached > 2 * rounding)) return {kNoValue, kNoValue};
  const auto one = a.values([](double, double, double) { return 1.0; });
  const auto time = until.integral(one, sticking.each(1));
  const linalg::VecHandle source = a.from_static({time.at_rest.begin(), time.at_rest.end()});
  check(VecAXPY(source, 1, one));
  const linalg::Solution m = system.factors().solve(source);
  check(VecAYPX(m.correction, -1, m.x));
  const auto variance = [&](const UntilPassage& by, Vec on) {
    const auto field = a.square_field(on, time.at_rest);
    const auto paths =
        by.integral(field, sticking.square_field(time.at_rest, time.at_starts)).overall;
    if (start.kind == model::Start::Kind::state) return paths;
    const linalg::VecHandle to_come = linalg::product(on, before);
    return paths + spread(first, to_come, time.at_rest, time.overall);
  };
  return {changed_from(roughly.integral(one, sticking.each(1)).overall, time.overall),
          changed_from(variance(roughly, m.correction), variance(until, m.x))};
}

void first_passage_tasks(Planner& planner) {
  planner.resolve_speeds();
  const auto& start = planner.question().start;
  const auto found =
      planner.collect<PassageTime>([](const Computation& computation, const auto& all) {
        append_by_speed(computation, cases::kPassageMean, all, &PassageTime::mean);
        append_by_speed(computation, cases::kPassageVariance, all, &PassageTime::variance);
      });
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

std::vector<Uncertain> passage_transform(generator::Systems& systems, generator::SystemKey key,
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

DurationDistribution passage_distribution(generator::Systems& systems,
                                          const generator::SystemKey& key,
                                          const model::Start& start,
                                          const std::vector<double>& time,
                                          const ModelTolerance& tolerance) {
  const bool stationary = start.kind == model::Start::Kind::stationary;
  const double mean = passage_time(systems, key, start).mean.value, w = key.speed_limit;
  const std::vector<Uncertain> too_rare(time.size(), kNoValue);
  if (!(mean > 0)) return {too_rare, too_rare};
  generator::Systems killed(systems.comm(), systems.discretisation().cut_at(w, true, key.passage),
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
  const auto of = [&a](const StartingPoint& start_at) {
    return on_states_of(a, start_at.sliding, start_at.at_rest);
  };
  const linalg::VecHandle b = a.rates_to_top(), c = product(of(first), inside(a, key)),
                          d = positive_weight(of(law ? *law : first));
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
    const linalg::VecHandle x = a.zeros();
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
      computation.results().push_back(of_speed(cases::kPassageTransform, lambda, speed, values));
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
      results.push_back(of_speed(cases::kPassageDensity, question.time, speed, found.density));
      results.back().diagnostic = true;  // the derivative of the other one, which decides
      results.push_back(of_speed(cases::kPassageCdf, question.time, speed, found.distribution));
      computation.report("passage_pairs", found.pairs,
                         "pairs of Krylov vectors in the reduced model of passage times");
    };
    planner.add(std::move(task));
  }
}

FirstPassage first_passage(generator::Systems& systems, const Starts& starts, double speed) {
  const auto& process = systems.process();
  generator::SystemKey key{0, generator::symmetry_of(process)};
  key.speed_limit = speed;
  auto& system = systems.at(key);
  const generator::KolmogorovOperator& a = system.a();
  const StickingPhases sticking(process, starts.levels, process.symmetric());
  const auto noise = model::stationary_distribution(process.noise);
  const ByLevel at_rest = sticking.static_part(noise);
  const auto nu = occupations_from(system, starts.levels, a.mean_at(noise));
  const UntilPassage until(a, sticking, at_rest, nu, &linalg::Solution::x),
      roughly(a, sticking, at_rest, nu, &linalg::Solution::correction);
  const auto mean = [&starts](const std::vector<double>& by_start) {
    return std::inner_product(starts.shares.begin(), starts.shares.end(), by_start.begin(), 0.0);
  };
  const auto [exceeded, rounding] = changed_from(mean(roughly.reached()), mean(until.reached()));
  if (!(exceeded > 2 * rounding)) return {kNoValue, kNoValue, kNoValue};
  const auto one = a.values([](double, double, double) { return 1.0; });
  const auto times = [&](const UntilPassage& by) {
    const auto time = by.integral(one, sticking.each(1));
    return std::pair{mean(time.at_starts), time.overall};
  };
  const auto [from_slide, from_rest] = times(until);
  const auto [roughly_from_slide, roughly_from_rest] = times(roughly);
  return {{exceeded, rounding},
          changed_from(roughly_from_slide, from_slide),
          changed_from(roughly_from_rest, from_rest)};
}

// From each start, and from rest.
void peak_tasks(Planner& planner) {
  planner.resolve_speeds();
  const bool symmetric = planner.symmetric();
  if (!symmetric) planner.need_distribution();  // which has the shares of starts
  const auto found =
      planner.collect<FirstPassage>([](const Computation& computation, const auto& all) {
        append_by_speed(computation, cases::kPPeak, all, &FirstPassage::exceeded);
        append_by_speed(computation, cases::kFirstPassage, all, &FirstPassage::from_slide);
        append_by_speed(computation, cases::kFirstPassageRest, all, &FirstPassage::from_rest);
      });
  for (double speed : planner.question().velocity) {
    auto system = planner.system();
    system.speed_limit = speed;
    const auto find = [=](Computation& computation) {
      const Starts starts =
          symmetric ? Starts::upwards(computation.process()) : computation.distribution().starts();
      found->push_back(computation.value_or(FirstPassage{kNoValue, kNoValue, kNoValue}, [&] {
        return first_passage(computation.systems, starts, speed);
      }));
    };
    planner.add({fmt::format("first passage to |v| = {:g}", speed),
                 {{system, 0, planner.starts() + 1}},
                 find});
  }
}

}  // namespace stickslip::quantities
