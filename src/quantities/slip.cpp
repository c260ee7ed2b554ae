#include "stickslip/quantities/slip.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numeric>

#include "stickslip/case/slip_rows.hpp"

namespace stickslip::quantities {
namespace {

using generator::Clock;
using generator::StaticPhase;
using generator::Symmetry;
using linalg::check;

double mean_path(const Excursion& excursion) {
  const auto& distance = excursion.slide_distance;
  return std::accumulate(distance.begin(), distance.end(), 0.0);
}

double speed(double, double, double v) { return std::abs(v); }

void find_moments(Computation& computation) {
  const auto moments = slip_moments(computation.systems, computation.distribution());
  const Uncertain net = computation.process().drifts() ? moments.net_mean : Uncertain{};
  auto& results = computation.results();
  results.push_back(scalar(cases::kVarSlip, moments.variance));
  results.push_back(scalar(cases::kMeanSlipNet, net));
  results.push_back(scalar(cases::kVarSlipNet, moments.net_variance));
}

void find_distribution(Computation& computation) {
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
      "moments of slips", {{planner.system(), planner.symmetric() ? 3 : 4, 0}}, find_moments};
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
  planner.add_adaptive("distribution of slips", 6, 80, find_distribution);
}

}  // namespace stickslip::quantities
