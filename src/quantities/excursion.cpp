#include "stickslip/quantities/excursion.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "stickslip/operators/static_chain.hpp"

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

SideChain side_chain(const model::Process& process, const std::vector<double>& entry_plus,
                     const std::vector<double>& entry_minus) {
  const auto chain = operators::StaticChain::of(process);
  const auto mean = [](const std::vector<double>& entry, const std::vector<double>& h) {
    return std::inner_product(entry.begin(), entry.end(), h.begin(), 0.0);
  };
  return {mean(entry_plus, chain.downward_exit_transform()),
          mean(entry_minus, chain.upward_exit_transform())};
}

Excursion joined(const SideChain& sides, const Excursion& plus, const Excursion& minus) {
  Excursion all = plus;
  for (auto member : {&Excursion::slide_time, &Excursion::slide_distance, &Excursion::slide_square,
                      &Excursion::slide_drift, &Excursion::entry, &Excursion::stick_time}) {
    for (std::size_t n = 0; n < (all.*member).size(); ++n) {
      (all.*member)[n] =
          sides.share_of_plus() * (plus.*member)[n] + sides.share_of_minus() * (minus.*member)[n];
    }
  }
  all.entry_plus = plus.entry;
  all.entry_minus = minus.entry;
  all.lost_probability =
      std::max(std::abs(plus.lost_probability), std::abs(minus.lost_probability));
  return all;
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
  std::vector<double> levels;
  for (int i = process.lowest_static(); i <= process.static_index(); ++i) levels.push_back(i);
  const auto append = [&](const char* key, const std::vector<double>& entry) {
    Result distribution = array(key, "", "k", levels);
    distribution.value = entry;
    distribution.error.assign(entry.size(), 0.0);
    results.push_back(std::move(distribution));
  };
  append("entry_law", excursion.entry_plus);
  if (!excursion.entry_minus.empty()) append("entry_law_minus", excursion.entry_minus);
  results.push_back(
      scalar(kFStick0,
             stick_density_at_zero(process, excursion.entry.front(), excursion.entry.back()), 0));
}

double stick_density_at_zero(const model::Process& process, double lowest, double highest) {
  const auto& noise = process.noise;
  return noise.rate() * (noise.up(process.static_index()) * highest +
                         noise.down(process.lowest_static()) * lowest);
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
  auto time = discretisation.noise->spread(excursion.slide_time);
  const int lowest = process.noise.levels + process.lowest_static();
  for (std::size_t k = 0; k < excursion.stick_time.size(); ++k) {
    time[lowest + k] += excursion.stick_time[k];
  }
  const std::vector<double> mirrored(time.rbegin(), time.rend());
  for (std::size_t i = 0; i < time.size(); ++i) {
    time[i] = (time[i] + mirrored[i]) / (2 * excursion.mean_excursion());
  }
  return time;
}

}  // namespace stickslip::quantities
