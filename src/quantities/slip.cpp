#include "stickslip/quantities/slip.hpp"

#include <cmath>
#include <numeric>

#include "stickslip/catalogue/slip_keys.hpp"
#include "stickslip/petsc/check.hpp"

namespace stickslip::quantities {
namespace {

using operators::Clock;
using operators::StaticPhase;
using operators::Symmetry;
using petsc::check;

double mean_path(const Excursion& excursion) {
  const auto& distance = excursion.slide_distance;
  return std::accumulate(distance.begin(), distance.end(), 0.0);
}

double speed(double, double, double v) { return std::abs(v); }

}  // namespace

SlipMoments slip_moments(operators::Systems& systems, const StationaryDistribution& distribution) {
  const Symmetry symmetry = operators::symmetry_of(systems.process());
  auto& system = systems.at(0, symmetry);
  // Of the other symmetry, if there is one; its sliding states come in the same order.
  auto& other = symmetry == Symmetry::even ? systems.at(0, Symmetry::odd) : system;
  const petsc::VecHandle starts = distribution.starts(system.a());
  const auto mean_square = [&](auto& inner, const operators::KolmogorovOperator::Observable& f) {
    const petsc::VecHandle weight = inner.a().values(f);
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

Uncertain slip_transform(operators::Systems& systems, const StationaryDistribution& distribution,
                         double s) {
  const auto& process = systems.process();
  auto& system =
      systems.at({s, operators::symmetry_of(process), StaticPhase::killing, Clock::path_length});
  const int levels = process.highest_static() - process.lowest_static() + 1;
  const auto ended =
      system.a().from_static(std::vector<PetscScalar>(static_cast<std::size_t>(levels), 1.0));
  return value_of(distribution.starts(system.a()), system.factors().solve(ended));
}

DurationDistribution slip_distribution(operators::Systems& systems,
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
  results.push_back(scalar(catalogue::kMeanSlip, mean_path(excursion), 0));
}

void append_slip_moments(const model::Process& process, const SlipMoments& moments,
                         Results& results) {
  results.push_back(scalar(catalogue::kVarSlip, moments.variance));
  results.push_back(
      scalar(catalogue::kMeanSlipNet, process.drifts() ? moments.net_mean : Uncertain{}));
  results.push_back(scalar(catalogue::kVarSlipNet, moments.net_variance));
}

void append_slip_transform(const std::vector<double>& inverse_distance,
                           const std::vector<Uncertain>& transform, Results& results) {
  Result result = array(catalogue::kTransformSlip, inverse_distance);
  for (const auto& value : transform) append_value(result, value);
  results.push_back(std::move(result));
}

void append_slip(const std::vector<double>& distance, const DurationDistribution& slips,
                 Results& results) {
  append_distribution(catalogue::kDensitySlip, catalogue::kCdfSlip, distance, slips, results);
}

}  // namespace stickslip::quantities
