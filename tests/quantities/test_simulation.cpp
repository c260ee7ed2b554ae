#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <numeric>

#include "../common/catch.hpp"
#include "../common/simulation.hpp"
#include "../common/solved.hpp"
#include "stickslip/quantities/durations.hpp"
#include "stickslip/quantities/spectra.hpp"

using namespace stickslip;
using quantities::DurationDistribution;
using test::Excursions;
using test::scene;
using test::SimulatedProcess;
using test::Simulation;
using test::Solved;

namespace {

constexpr int kCount = 1000000;
constexpr double kTooUnlikely = 1e-4;

struct Case {
  const char* name;
  SimulatedProcess process;
  std::uint64_t seed;
};

std::vector<Case> samples() {
  return {{"linear drag", {1, 0.25, 1, 0.5, 1}, 1},
          {"no drag", {1, 1, 1, 0.5, 0}, 2},
          {"off the grid", {1.1, 1.1, 1, 0.5, 1}, 3}};
}

test::Discrete discrete(const SimulatedProcess& p, int degree = 14) {
  const auto s = scene(p.mu_s, p.mu_d, p.tau, p.delta, {p.drag, 0});
  return test::on_hp(test::on_full_noise(s), degree, 1e-11);
}

/// Ends of 40 bins that hold about as many values each.
std::vector<double> bin_ends(std::vector<double> values) {
  constexpr std::size_t bins = 40;
  std::sort(values.begin(), values.end());
  std::vector<double> ends;
  for (std::size_t n = 1; n < bins; ++n) ends.push_back(values[n * values.size() / bins]);
  return ends;
}

/// Probability of a chi-square as large as that of `values` in the bins between `ends`, under the
/// distribution function at the ends.
double p_value(const std::vector<double>& values, const std::vector<double>& ends,
               const std::vector<quantities::Uncertain>& distribution) {
  std::vector<double> count(ends.size() + 1);
  for (double v : values) ++count[std::upper_bound(ends.begin(), ends.end(), v) - ends.begin()];
  double chi = 0, below = 0;
  for (std::size_t n = 0; n < count.size(); ++n) {
    const double up_to = n < ends.size() ? distribution[n].value : 1;
    const double expected = (up_to - below) * static_cast<double>(values.size());
    chi += (count[n] - expected) * (count[n] - expected) / expected;
    below = up_to;
  }
  const boost::math::chi_squared expected(static_cast<double>(ends.size()));
  return boost::math::cdf(boost::math::complement(expected, chi));
}

/// p-values of sliding phases, sticking phases and excursions, the bins from other values than
/// those judged.
std::vector<double> p_values(Solved& s, const Excursions& pilot, const Excursions& judged) {
  const auto slide = bin_ends(pilot.slide), stick = bin_ends(pilot.stick),
             excursion = bin_ends(pilot.excursion);
  const auto of_slide = quantities::slide_distribution(s.systems, s.distribution, slide, 1e-7);
  const auto of_stick = quantities::stick_distribution(s.systems.process(), s.entry(), stick);
  const auto of_excursion =
      quantities::excursion_distribution(s.systems, s.distribution, excursion, 1e-7);
  return {p_value(judged.slide, slide, of_slide.distribution),
          p_value(judged.stick, stick, of_stick.distribution),
          p_value(judged.excursion, excursion, of_excursion.distribution)};
}

struct Estimate {
  double value, sigma;
};

/// E[a]/E[b] over excursions, which are independent.
Estimate ratio(const std::vector<double>& a, const std::vector<double>& b) {
  const auto n = static_cast<double>(a.size());
  const double mean_a = std::accumulate(a.begin(), a.end(), 0.0) / n;
  const double mean_b = std::accumulate(b.begin(), b.end(), 0.0) / n;
  const double value = mean_a / mean_b;
  double square = 0;
  for (std::size_t m = 0; m < a.size(); ++m) square += std::pow(a[m] - value * b[m], 2);
  return {value, std::sqrt(square / n / n) / mean_b};
}

double deviation(const Estimate& found, double known) {
  return std::abs(found.value - known) / found.sigma;
}

}  // namespace

TEST_CASE(
    "simulation: sliding phases, sticking phases and excursions have the distributions computed",
    "[slow][real]") {
  for (const auto& c : samples()) {
    Solved s(discrete(c.process));
    const auto pilot = Simulation(c.process, 100 + c.seed).run(kCount / 20);
    for (double p : p_values(s, pilot, Simulation(c.process, c.seed).run(kCount))) {
      INFO(c.name << " p " << p);
      CHECK(p > kTooUnlikely);
      CHECK(p < 1 - kTooUnlikely);
    }
  }
}

TEST_CASE("simulation: a jump rate off by two per cent is seen", "[slow][real]") {
  auto c = samples()[0];
  Solved s(discrete(c.process));
  const auto pilot = Simulation(c.process, 100 + c.seed).run(kCount / 20);
  c.process.hurry = 1.02;
  for (double p : p_values(s, pilot, Simulation(c.process, c.seed).run(kCount))) {
    INFO("p " << p);
    CHECK(p < kTooUnlikely);
  }
}

// After a sliding and a sticking phase the next excursion is independent of all before.
TEST_CASE("simulation: time at rest, means, and the tail of the spectrum within 4 sigma",
          "[slow][real]") {
  for (const auto& c : samples()) {
    Solved s(discrete(c.process, 10));
    const auto found = Simulation(c.process, 10 + c.seed).run(kCount / 2);
    const std::vector<double> ones(found.slide.size(), 1.0);
    const auto& e = s.distribution.excursion();
    INFO(c.name);
    CHECK(deviation(ratio(found.stick, found.excursion), e.mean_stick() / e.mean_excursion()) < 4);
    CHECK(deviation(ratio(found.slide, ones), e.mean_slide()) < 4);
    CHECK(deviation(ratio(found.stick, ones), e.mean_stick()) < 4);
    // omega^4 S_v far out: squared jumps of the acceleration by time.
    const double omega = 1e7;
    const auto r = quantities::reduced_spectrum(s.systems, s.distribution, {omega}, 1e-7);
    const double tail = r.spectrum.value[0].value * std::pow(omega, 4);
    CHECK(deviation(ratio(found.square_of_jumps, found.excursion), tail) < 4);
  }
}

// The waiting times, the noise alone: sticking phases do not depend on how fast the body was.
TEST_CASE("simulation: without drag and with, a handful of excursions ends") {
  for (const auto& c : samples()) {
    const auto all = Simulation(c.process, c.seed).run(1000);
    REQUIRE(all.excursion.size() == 1000);
    for (std::size_t n = 0; n < all.slide.size(); ++n) {
      CHECK(all.slide[n] > 0);
      CHECK(all.stick[n] > 0);
      CHECK(all.excursion[n] == all.slide[n] + all.stick[n]);
    }
  }
}
