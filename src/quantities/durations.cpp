#include "stickslip/quantities/durations.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "stickslip/case/duration_rows.hpp"
#include "stickslip/case/sticking_rows.hpp"

namespace stickslip::quantities {
namespace {

using generator::Clock;
using generator::StaticPhase;
using generator::Symmetry;
using linalg::check;

void find_distributions_of_phases(Computation& computation) {
  using namespace cases;
  const auto& time = computation.question().time;
  const auto& distribution = computation.distribution();
  auto& results = computation.results();
  const auto slide =
      slide_distribution(computation.systems, distribution, time, computation.tolerance());
  append_distribution(kDensitySlide, kCdfSlide, time, slide, results);
  append_distribution(kDensityStick, kCdfStick, time,
                      stick_distribution(computation.process(), distribution.entry(), time),
                      results);
  computation.report("slide_pairs", slide.pairs,
                     "pairs of Krylov vectors in the reduced model of sliding durations");
}

void find_distribution_of_excursions(Computation& computation) {
  using namespace cases;
  const auto& time = computation.question().time;
  const auto excursion = excursion_distribution(computation.systems, computation.distribution(),
                                                time, computation.tolerance());
  append_distribution(kDensityExcursion, kCdfExcursion, time, excursion, computation.results());
  computation.report("excursion_pairs", excursion.pairs,
                     "pairs of Krylov vectors in the reduced model of excursion durations");
}

void add_phases(Planner& planner) {
  planner.need_distribution();
  planner.resolve_times();
  planner.add_adaptive("distributions of phases", 7, 80, find_distributions_of_phases);
}

// Those that are not there already.
void find_duration_moments(Computation& computation) {
  const auto& distribution = computation.distribution();
  const auto entry = distribution.entry();
  const auto moments = duration_moments(computation.systems, distribution, entry);
  const auto& process = computation.process();
  auto& results = computation.results();
  const auto append = [&](const Row& row, Uncertain value) {
    const bool there = std::ranges::find(results, row.key, &Result::key) != results.end();
    if (!there) results.push_back(scalar(row, value));
  };
  append(cases::kMeanSlide, moments.mean_slide);
  append(cases::kMeanStick, moments.mean_stick);
  append(cases::kMeanExcursion, moments.mean_excursion);
  append(cases::kVarSlide, moments.var_slide);
  append(cases::kVarStick, moments.var_stick);
  append(cases::kVarExcursion, moments.var_excursion);
  std::vector<double> value, error;
  for (const auto& p : entry) {
    value.push_back(p.value);
    error.push_back(p.error);
  }
  append(cases::kFSlide0, {slide_density_at_zero(process, distribution.starts()), 0});
  append(cases::kFStick0,
         {stick_density_at_zero(process, value), stick_density_at_zero(process, error)});
}

double mean_path(const Excursion& excursion) {
  const auto& distance = excursion.slide_distance;
  return std::accumulate(distance.begin(), distance.end(), 0.0);
}

double speed(double, double, double v) { return std::abs(v); }

void find_slip_moments(Computation& computation) {
  const auto moments = slip_moments(computation.systems, computation.distribution());
  const Uncertain net = computation.process().drifts() ? moments.net_mean : Uncertain{};
  auto& results = computation.results();
  results.push_back(scalar(cases::kVarSlip, moments.variance));
  results.push_back(scalar(cases::kMeanSlipNet, net));
  results.push_back(scalar(cases::kVarSlipNet, moments.net_variance));
}

void find_slip_distribution(Computation& computation) {
  const auto& distance = computation.question().distance;
  const auto slips = slip_distribution(computation.systems, computation.distribution(), distance,
                                       computation.tolerance());
  append_distribution(cases::kDensitySlip, cases::kCdfSlip, distance, slips, computation.results());
  computation.report("slip_pairs", slips.pairs,
                     "pairs of Krylov vectors in the reduced model of slips");
}

// Slips of the length d begin and end in layers at v = 0. Of bodies with the acceleration a these
// are resolved five times finer than sqrt(a d/12).
void resolve_lengths(Planner& planner) {
  const auto process = planner.given().scene.meant(), mirrored = process.mirrored();
  const double force = std::max(process.net_force(process.noise.highest()),
                                mirrored.net_force(mirrored.noise.highest()));
  planner.resolve_rate(
      5 * std::sqrt(kFastestOnContour * force / least_positive(planner.question().distance)));
}

}  // namespace

// f(t) = g exp(L t) r, g where excursions start, r = -L 1 the rate of ending where `static_phase`
// kills.
DurationDistribution distribution_until_killed(const std::string& name, generator::Systems& systems,
                                               StaticPhase static_phase, generator::Clock clock,
                                               const StationaryDistribution& stationary,
                                               const std::vector<double>& time, double mean,
                                               const TimeScales& scales, double at_zero,
                                               const ModelTolerance& tolerance) {
  std::vector<double> later;
  for (double t : time) {
    if (t > 0) later.push_back(t);
  }
  DurationDistribution result;
  TimeCurve curve{{{}, {}}};
  if (!later.empty()) {
    ProcessPencil pencil(systems, generator::symmetry_of(systems.process()), static_phase, clock);
    const auto& a = pencil.a();
    const linalg::VecHandle one = a.values([](double, double, double) { return 1.0; }),
                            b = a.zeros(), c = stationary.starts_on(a), d = stationary.weight_on(a);
    check(MatMult(a.matrix(), one, b));
    for (Vec end : {Vec(b), Vec(c)}) pencil.by_clock(-1, end);
    curve = time_curve(pencil, {b, c, d}, ReducedModel::Nature::rough, {{0, 1 / mean}, {1, 1}},
                       later, scales, tolerance.value, tolerance.recipe(name));
  }
  result.pairs = curve.pairs;
  std::size_t next = 0;
  for (double t : time) {
    result.density.push_back(t > 0 ? curve.value[0][next] : Uncertain{at_zero, 0});
    result.distribution.push_back(t > 0 ? curve.value[1][next++] : Uncertain{});
  }
  return result;
}

DurationDistribution slide_distribution(generator::Systems& systems,
                                        const StationaryDistribution& stationary,
                                        const std::vector<double>& time,
                                        const ModelTolerance& tolerance) {
  return distribution_until_killed(
      "slide", systems, StaticPhase::killing, generator::Clock::time, stationary, time,
      stationary.excursion().mean_slide(), time_scales(systems.process()),
      slide_density_at_zero(systems.process(), stationary.starts()), tolerance);
}

// No excursion ends at once: a sliding phase would have to, and then a sticking phase.
DurationDistribution excursion_distribution(generator::Systems& systems,
                                            const StationaryDistribution& stationary,
                                            const std::vector<double>& time,
                                            const ModelTolerance& tolerance) {
  return distribution_until_killed(
      "excursion", systems, StaticPhase::killed_on_exit, generator::Clock::time, stationary, time,
      stationary.excursion().mean_excursion(), time_scales(systems.process()), 0, tolerance);
}

// A body that has just left turns round where the noise jumps at once to a level that sticks and
// slows it.
double slide_density_at_zero(const model::Process& process, const Starts& starts) {
  const auto upwards_from = [](const model::Process& seen, int level) {
    const double up = seen.net_force(level);
    double density = 0;
    seen.noise.for_each_jump(level, [&](int to, double rate) {
      const double down = -seen.net_force(to);
      if (seen.sticks(to) && down > 0) density += rate * down / (up + down);
    });
    return density;
  };
  const model::Process mirrored = process.mirrored();
  double density = 0;
  for (std::size_t t = 0; t < starts.size(); ++t) {
    const int level = starts.levels[t];
    density +=
        starts.shares[t] * (level > process.highest_static() ? upwards_from(process, level)
                                                             : upwards_from(mirrored, -level));
  }
  return density;
}

DurationMoments duration_moments(generator::Systems& systems,
                                 const StationaryDistribution& distribution,
                                 const std::vector<Uncertain>& entry) {
  const auto& process = systems.process();
  const auto chain = generator::StaticChain::of(process);
  const auto once = chain.integral(std::vector<double>(entry.size(), 1.0));
  const auto twice = chain.integral(once);
  Uncertain stick, stick_square;
  for (std::size_t n = 0; n < entry.size(); ++n) {
    stick = stick + once[n] * entry[n];
    stick_square = stick_square + 2 * twice[n] * entry[n];
  }
  auto& system = systems.at(0, generator::symmetry_of(process));
  const linalg::VecHandle starts = distribution.starts_on(system.a());
  const linalg::VecHandle ones = system.a().values([](double, double, double) { return 1.0; });
  const auto slide = system.factors().solve(ones);
  const auto square = system.factors().solve(slide.x);
  const auto sticking = system.factors().solve(
      system.a().from_static(std::vector<PetscScalar>(once.begin(), once.end())));
  const Uncertain s = value_of(starts, slide), s2 = 2.0 * value_of(starts, square);
  const Uncertain st = value_of(starts, system.factors().solve(sticking.x));
  const Uncertain excursion = s + stick;
  return {s,
          stick,
          excursion,
          s2 - s * s,
          stick_square - stick * stick,
          s2 + 2.0 * st + stick_square - excursion * excursion};
}

void append_distribution(const Row& density_row, const Row& distribution_row,
                         const std::vector<double>& abscissa, const DurationDistribution& durations,
                         Results& results) {
  append_array(array(density_row, abscissa), durations.density, results);
  append_array(array(distribution_row, abscissa), durations.distribution, results);
}

void duration_density_tasks(Planner& planner) {
  add_phases(planner);
  planner.add_adaptive("distribution of excursions", 7, 80, find_distribution_of_excursions);
}

void phase_durations_tasks(Planner& planner) {
  if (!planner.question().wants(cases::Quantity::duration_density)) add_phases(planner);
}

Uncertain stick_transform(const model::Process& process, double lambda,
                          const std::vector<Uncertain>& entry) {
  const auto sticking = generator::StaticChain::of(process, lambda).exit_transform();
  Uncertain sum;
  for (std::size_t n = 0; n < sticking.size(); ++n) sum = sum + sticking[n] * entry[n];
  return sum;
}

void append_stick_transform(const model::Process& process, const std::vector<double>& lambda,
                            const std::vector<Uncertain>& entry, Results& results) {
  Result result = array(cases::kTransformStick, lambda);
  for (double value : lambda) append_value(result, stick_transform(process, value, entry));
  results.push_back(std::move(result));
}

void stick_transform_tasks(Planner& planner) {
  if (planner.question().wants(cases::Quantity::laplace)) return;  // which has it, too
  planner.need_distribution();
  planner.add({"Laplace transforms of sticking phases", {}, [](Computation& computation) {
                 append_stick_transform(computation.process(), computation.question().lambda,
                                        computation.distribution().entry(), computation.results());
               }});
}

DurationTransforms duration_transforms(generator::Systems& systems,
                                       const StationaryDistribution& distribution, double lambda) {
  const auto sticking = generator::StaticChain::of(systems.process(), lambda).exit_transform();
  auto& system = systems.at(lambda, generator::symmetry_of(systems.process()));
  const linalg::VecHandle starts = distribution.starts_on(system.a());
  const auto transform = [&](const std::vector<double>& values) {
    const std::vector<PetscScalar> s(values.begin(), values.end());
    return value_of(starts, system.factors().solve(system.a().from_static(s)));
  };
  return {transform(std::vector<double>(sticking.size(), 1.0)),
          stick_transform(systems.process(), lambda, distribution.entry()), transform(sticking)};
}

void append_laplace(const std::vector<double>& lambda,
                    const std::vector<DurationTransforms>& transforms, Results& results) {
  const auto append = [&](const Row& row, Uncertain DurationTransforms::*member) {
    Result result = array(row, lambda);
    for (const auto& t : transforms) append_value(result, t.*member);
    results.push_back(std::move(result));
  };
  append(cases::kTransformSlide, &DurationTransforms::slide);
  append(cases::kTransformStick, &DurationTransforms::stick);
  append(cases::kTransformExcursion, &DurationTransforms::excursion);
}

void laplace_tasks(Planner& planner) {
  planner.need_distribution();
  planner.add({"moments of durations", {{planner.system(), 4, 0}}, find_duration_moments});
  const auto found =
      planner.collect<DurationTransforms>([](const auto& computation, const auto& all) {
        append_laplace(computation.question().lambda, all, computation.results());
      });
  planner.add_at_each_lambda([&](double lambda) -> Task {
    const auto find = [=](Computation& computation) {
      const DurationTransforms none{kNoValue, kNoValue, kNoValue};
      found->push_back(computation.value_or(none, [&] {
        return duration_transforms(computation.systems, computation.distribution(), lambda);
      }));
    };
    return {fmt::format("Laplace transforms at lambda = {:g}", lambda),
            {{planner.system(lambda), 2, 0}},
            find};
  });
}

SlipMoments slip_moments(generator::Systems& systems, const StationaryDistribution& distribution) {
  const Symmetry symmetry = generator::symmetry_of(systems.process());
  auto& system = systems.at(0, symmetry);
  // Of the other symmetry, if there is one; its sliding states come in the same order.
  auto& other = symmetry == Symmetry::even ? systems.at(0, Symmetry::odd) : system;
  const linalg::VecHandle starts = distribution.starts_on(system.a());
  const auto mean_square = [&](auto& inner, const generator::KolmogorovOperator::Observable& f) {
    const linalg::VecHandle weight = inner.a().values(f);
    auto once = inner.factors().solve(weight);
    const Uncertain mean = value_of(starts, once);
    check(VecPointwiseMult(once.x, once.x, weight));
    const auto twice = system.factors().solve(once.x);
    return std::pair{mean, 2.0 * value_of(starts, twice)};
  };
  const auto [mean, square] = mean_square(system, speed);
  auto [net, net_square] = mean_square(other, [](double, double, double v) { return v; });
  if (symmetry == Symmetry::even) net = {};
  return {square - mean * mean, net, net_square - net * net};
}

Uncertain slip_transform(generator::Systems& systems, const StationaryDistribution& distribution,
                         double s) {
  const auto& process = systems.process();
  auto& system =
      systems.at({s, generator::symmetry_of(process), StaticPhase::killing, Clock::path_length});
  const int levels = process.highest_static() - process.lowest_static() + 1;
  const auto ended =
      system.a().from_static(std::vector<PetscScalar>(static_cast<std::size_t>(levels), 1.0));
  return value_of(distribution.starts_on(system.a()), system.factors().solve(ended));
}

DurationDistribution slip_distribution(generator::Systems& systems,
                                       const StationaryDistribution& distribution,
                                       const std::vector<double>& distance,
                                       const ModelTolerance& tolerance) {
  const Excursion& excursion = distribution.excursion();
  const double mean = mean_path(excursion), typical = mean / excursion.mean_slide();
  const auto [correlation, rate, stopping] = time_scales(systems.process());
  return distribution_until_killed(
      "slip", systems, StaticPhase::killing, Clock::path_length, distribution, distance, mean,
      {correlation * typical, rate / typical, stopping * typical}, 0, tolerance);
}

void append_mean_slip(const Excursion& excursion, Results& results) {
  results.push_back(scalar(cases::kMeanSlip, mean_path(excursion), 0));
}

void mean_slip_tasks(Planner& planner) {
  planner.append_from([](const auto&, const Excursion& excursion, Results& results) {
    append_mean_slip(excursion, results);
  });
}

void slip_tasks(Planner& planner) {
  Task moments{
      "moments of slips", {{planner.system(), planner.symmetric() ? 3 : 4, 0}}, find_slip_moments};
  if (planner.symmetric()) moments.uses.push_back({{0, Symmetry::odd}, 1, 0});
  planner.add(std::move(moments));
  const auto& question = planner.question();
  planner.needs().rates.lengths = !question.distance.empty() || !question.inverse_distance.empty();
  const auto found =
      planner.collect<Uncertain>([](const Computation& computation, const auto& all) {
        append_array(array(cases::kTransformSlip, computation.question().inverse_distance), all,
                     computation.results());
      });
  for (double s : question.inverse_distance) {
    auto system = planner.system(s);
    system.clock = Clock::path_length;
    planner.add({fmt::format("transform of slips at s = {:g}", s),
                 {{system, 1, 0}},
                 [=](Computation& computation) {
                   found->push_back(computation.value_or(kNoValue, [&] {
                     return slip_transform(computation.systems, computation.distribution(), s);
                   }));
                 }});
  }
  if (question.distance.empty()) return;
  resolve_lengths(planner);
  planner.add_adaptive("distribution of slips", 6, 80, find_slip_distribution);
}

}  // namespace stickslip::quantities
