#include "stickslip/quantities/excursion.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace stickslip::quantities {
namespace {

double sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

}  // namespace

double Excursion::mean_slide() const { return sum(slide_time); }
double Excursion::mean_stick() const { return sum(stick_time); }
double Excursion::mean_excursion() const { return mean_slide() + mean_stick(); }

double Excursion::conservation_defect(const operators::Discretisation& discretisation) const {
  const auto& process = discretisation.process;
  const int k = process.threshold_index(), half = discretisation.noise->half();
  double beyond = 0;
  for (int n = discretisation.noise->last_up_to(k) + 1; n <= half; ++n) {
    beyond += slide_time[half + n] + slide_time[half - n];
  }
  // A bias holds levels beyond mu_s, too.
  const int lowest = process.lowest_static(), highest = process.static_index();
  for (int i = lowest; i <= highest; ++i) {
    if (std::abs(i) > k) beyond += stick_time[i - lowest];
  }
  const double expected = model::noise_moments(process.noise, k).beyond * mean_excursion();
  return std::abs(beyond / expected - 1) + lost_probability * lost_probability;
}

void append_sticking(const Excursion& excursion, Results& results) {
  const double slide = excursion.mean_slide(), stick = excursion.mean_stick();
  const double total = excursion.mean_excursion();
  results.push_back(scalar(kPStick, stick / total, 0));
  results.push_back(scalar(kPSlide, slide / total, 0));
  results.push_back(scalar(kMeanStick, stick, 0));
  results.push_back(scalar(kMeanSlide, slide, 0));
  results.push_back(scalar(kMeanExcursion, total, 0));
}

void append_moments(const operators::Discretisation& discretisation, const Excursion& excursion,
                    Results& results) {
  const double total = excursion.mean_excursion();
  const int half = discretisation.noise->half();
  double force_times_velocity = 0;
  for (int n = -half; n <= half; ++n) {
    force_times_velocity += discretisation.noise->x(n) * excursion.slide_distance[half + n];
  }
  results.push_back(scalar(kEV2, sum(excursion.slide_square) / total, 0));
  results.push_back(scalar(kEAbsV, sum(excursion.slide_distance) / total, 0));
  results.push_back(scalar(kEXV, force_times_velocity / total, 0));
  const auto& drift = excursion.slide_drift;
  // A difference of what the two half lines give: exact to the size of E|V|.
  const double rounding =
      excursion.conservation_defect(discretisation) * sum(excursion.slide_distance);
  results.push_back(scalar(kEV, sum(drift) / total, drift.empty() ? 0 : rounding / total));
}

void append_hitting_distribution(const model::Process& process, const Excursion& excursion,
                                 Results& results) {
  const auto& symmetry_reduced = excursion.entry;
  const auto& oriented = excursion.entry_orientation;
  const int k = process.static_index();
  Result distribution{"entry_law", "", "k", {}, {}, {}};
  for (int i = -k; i <= k; ++i) {
    // Slides that end with V > 0 on level i, and with V < 0 on level -i in symmetry-reduced
    // coordinates.
    const double same = (symmetry_reduced[k + i] + oriented[k + i]) / 2;
    const double mirrored = (symmetry_reduced[k - i] - oriented[k - i]) / 2;
    distribution.abscissa.push_back(i);
    distribution.value.push_back(same + mirrored);
    distribution.error.push_back(0);
  }
  results.push_back(distribution);
  const double rate = process.noise.rate() * process.noise.up(k);
  results.push_back(
      scalar(kFStick0, rate * (symmetry_reduced.back() + symmetry_reduced.front()), 0));
}

void append_noise_distribution(const model::Process& process, Results& results) {
  const auto moments = model::noise_moments(process.noise, process.threshold_index());
  const double rounding = model::rounding_of_sums(process.noise);
  results.push_back(scalar(kPWithin, moments.within, rounding * moments.within));
  results.push_back(scalar(kEX2, moments.variance, rounding * moments.variance));
}

std::vector<double> marginal_of_noise(const operators::Discretisation& discretisation,
                                      const Excursion& excursion) {
  const auto& process = discretisation.process;
  const int n = process.noise.levels, k = process.static_index();
  const double total = excursion.mean_excursion();
  const auto slide_time = discretisation.noise->spread(excursion.slide_time);
  std::vector<double> distribution(slide_time.size());
  for (int i = -n; i <= n; ++i) {
    distribution[n + i] = (slide_time[n + i] + slide_time[n - i]) / (2 * total);
    if (std::abs(i) <= k) {
      distribution[n + i] +=
          (excursion.stick_time[k + i] + excursion.stick_time[k - i]) / (2 * total);
    }
  }
  return distribution;
}

}  // namespace stickslip::quantities
