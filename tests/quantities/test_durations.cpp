#include <cmath>

#include "../common/catch.hpp"
#include "../common/full_grid.hpp"
#include "../common/near.hpp"
#include "../common/quadrature.hpp"
#include "../common/solved.hpp"
#include "stickslip/generator/velocity_methods.hpp"
#include "stickslip/linalg/dense.hpp"
#include "stickslip/quantities/durations.hpp"

using namespace stickslip;
using quantities::DurationDistribution;
using quantities::Uncertain;
using Matrix = linalg::Matrix<double>;
using test::relative_difference;
using test::scene;
using test::Solved;

namespace {

struct Sample {
  const char* name;
  test::Discrete d;
};

// mu_d and mu_s on the grid of the noise, between its levels, and apart.
std::vector<Sample> samples() {
  return {{"linear drag", test::on_hp(scene(1, 0.25, 1, 0.5, {1, 0}), 12)},
          {"mu_d = mu_s", test::on_hp(scene(1, 1, 1, 0.5, {1, 0}), 12)},
          {"no drag", test::on_hp(scene(1, 1, 1, 0.5, {0, 0}), 12)},
          {"off the grid", test::on_hp(scene(1.1, 1.1, 1, 0.5, {1, 0}), 16)},
          {"cubic drag", test::on_hp(scene(0.7, 0.4, 1, 0.5, {2, 1}), 12)},
          {"tau = 4", test::on_hp(scene(0.7, 0.4, 4, 0.25, {2, 1}), 16)}};
}

/// The distributions of all durations at the same times.
struct Distributions {
  DurationDistribution slide, stick, excursion;
};

Distributions distributions(Solved& s, const std::vector<double>& time, double tolerance) {
  return {quantities::slide_distribution(s.systems, s.distribution, time, tolerance),
          quantities::stick_distribution(s.systems.process(), s.entry(), time),
          quantities::excursion_distribution(s.systems, s.distribution, time, tolerance)};
}

constexpr DurationDistribution Distributions::*kAll[] = {
    &Distributions::slide, &Distributions::stick, &Distributions::excursion};
constexpr const char* kNames[] = {"slide", "stick", "excursion"};

constexpr double kFirstTime = 1e-9;  // densities are constant before

test::Quadrature all_times(double last) { return test::logarithmic_panels(kFirstTime, last, 24); }

/// int weight f over all times, and the errors that the density states.
template <class Weight>
Uncertain integral(const test::Quadrature& q, const DurationDistribution& duration, Weight weight) {
  const auto sum_of = [&](double Uncertain::*part) {
    return q.sum([&](std::size_t n) { return weight(q.node[n]) * duration.density[n].*part; });
  };
  const double start = kFirstTime * weight(0.0) * duration.density.front().value;
  return {start + sum_of(&Uncertain::value), sum_of(&Uncertain::error)};
}

// Far out densities are absolutely right only; weighted with t or t^2 it shows.
void check_moment(Uncertain found, double known, double relative) {
  INFO("off by " << found.value / known - 1 << ", stated " << found.error / known);
  CHECK(std::abs(found.value - known) < relative * known + found.error);
}

/// Durations on the whole grid of the paper: a dense chain, killed where a sliding phase ends, or
/// where an excursion does.
class DenseDurations {
 public:
  enum class Ends { at_rest, after_rest };

  DenseDurations(const test::FullGrid& grid, int k, Ends ends)
      : m_(grid.generator()), rates_(grid.size()), start_(grid.index(k + 1, 0)) {
    std::vector<bool> rests(grid.size());
    grid.for_each([&](int i, int j, double, int s) { rests[s] = grid.is_static(i, j); });
    for (int r = 0; r < grid.size(); ++r) {
      for (int c = 0; c < grid.size(); ++c) {
        const bool ending = ends == Ends::at_rest ? !rests[r] && rests[c] : rests[r] && !rests[c];
        if (!ending) continue;
        rates_[r] += m_(r, c);
        m_(r, c) = 0;
      }
    }
  }

  [[nodiscard]] double density(double time) const {
    return (linalg::exponential(m_, time) * rates_)[start_];
  }
  [[nodiscard]] double distribution(double time) const {
    // What has ended is no state here; at rest, the static states still are.
    const int n = m_.rows();
    Matrix all(n + 1, n + 1);
    for (int r = 0; r < n; ++r) {
      for (int c = 0; c < n; ++c) all(r, c) = m_(r, c);
      all(r, n) = rates_[r];
    }
    return linalg::exponential(all, time)(start_, n);
  }

 private:
  Matrix m_;
  std::vector<double> rates_;  // of ending
  int start_;
};

double f_slide_at(const model::Process& process) {
  return quantities::slide_density_at_zero(process, quantities::Starts::upwards(process));
}

model::Process process_with(double mu_s, double mu_d, int levels = 8) {
  return {{1, 0.5, levels}, {mu_s, mu_d}, {1, 0}};
}

}  // namespace

TEST_CASE("durations: densities integrate to 1, with the means and variances of the moments",
          "[slow][real]") {
  for (const auto& [name, d] : samples()) {
    Solved s(d);
    const auto m = quantities::duration_moments(s.systems, s.distribution, s.entry());
    const std::vector<Uncertain> mean{m.mean_slide, m.mean_stick, m.mean_excursion},
        variance{m.var_slide, m.var_stick, m.var_excursion};
    const auto q = all_times(100 * d.process.noise.tau);
    const auto all = distributions(s, q.node, 1e-9);
    for (std::size_t n = 0; n < std::size(kAll); ++n) {
      const auto& duration = all.*kAll[n];
      const double square = variance[n].value + mean[n].value * mean[n].value;
      INFO(name << ", " << kNames[n]);
      check_moment(integral(q, duration, [](double) { return 1.0; }), 1, 1e-8);
      check_moment(integral(q, duration, [](double t) { return t; }), mean[n].value, 1e-8);
      check_moment(integral(q, duration, [](double t) { return t * t; }), square, 1e-7);
    }
  }
}

TEST_CASE("durations: errors of distributions and densities cover finer models", "[slow][real]") {
  const auto all_samples = samples();
  for (std::size_t sample : {0, 2, 4}) {
    const auto& [name, d] = all_samples[sample];
    Solved s(d);
    const std::vector<double> time{0.1, 0.5, 2, 8};
    const auto rough = distributions(s, time, 1e-3), fine = distributions(s, time, 1e-10);
    for (std::size_t which = 0; which < std::size(kAll); ++which) {
      for (std::size_t n = 0; n < time.size(); ++n) {
        const auto change = [&](auto member) {
          const Uncertain one = ((rough.*kAll[which]).*member)[n];
          const Uncertain other = ((fine.*kAll[which]).*member)[n];
          return std::abs(one.value - other.value) / (one.error + other.error + 1e-12);
        };
        INFO(name << ", " << kNames[which] << " at " << time[n]);
        CHECK(change(&DurationDistribution::density) < 10);
        CHECK(change(&DurationDistribution::distribution) < 10);
      }
    }
  }
}

// No symmetry reduction, no excursions, no reduced models, no PETSc.
TEST_CASE("durations: upwind equals dense exponentials on the whole grid", "[parallel]") {
  struct Case {
    double mu_s, mu_d;
    int levels, nodes;
    model::Drag drag;
  };
  const std::vector<double> time{0.05, 0.4, 2.5};
  for (const auto& c : {Case{1, 0.25, 4, 6, {1, 0}}, Case{0.7, 0.7, 3, 7, {1, 0.5}}}) {
    const model::Process process{{1, 0.5, c.levels}, {c.mu_s, c.mu_d}, c.drag};
    const double spacing = 0.25;
    const test::FullGrid grid(process, spacing, c.nodes);
    const int k = process.highest_static();
    const DenseDurations slide(grid, k, DenseDurations::Ends::at_rest);
    const DenseDurations excursion(grid, k, DenseDurations::Ends::after_rest);
    Solved s(
        {process, std::make_shared<generator::UpwindDiscretisation>(spacing, c.nodes, c.drag)});
    const auto all = distributions(s, time, 1e-10);
    for (std::size_t n = 0; n < time.size(); ++n) {
      INFO("mu_d " << c.mu_d << " time " << time[n]);
      CHECK(std::abs(all.slide.density[n].value - slide.density(time[n])) < 1e-8);
      CHECK(std::abs(all.slide.distribution[n].value - slide.distribution(time[n])) < 1e-8);
      CHECK(std::abs(all.excursion.density[n].value - excursion.density(time[n])) < 1e-8);
      CHECK(std::abs(all.excursion.distribution[n].value - excursion.distribution(time[n])) < 1e-8);
    }
  }
}

// From level 0 of the chain: the shortest sticking phases take k + 1 jumps. Shifted by the jump
// rate the chain has no negative entries, so that the exponential is right to the size of each of
// its entries.
TEST_CASE("durations: sticking phases by dense exponentials, right relative to their size") {
  for (double mu_s : {0.3, 1.0, 1.7}) {
    const auto process = process_with(mu_s, 0.25);
    const int k = process.highest_static();
    const double rate = process.noise.rate();
    const int middle = k, left = 2 * k + 1;
    Matrix q(left + 1, left + 1);
    for (int i = -k; i <= k; ++i) {
      const int at = middle + i;
      q(at, i < k ? at + 1 : left) += rate * process.noise.up(i);
      q(at, i > -k ? at - 1 : left) += rate * process.noise.down(i);
    }
    q(left, left) = rate;
    std::vector<Uncertain> entry(static_cast<std::size_t>(left), Uncertain{0, 0});
    entry[middle] = {1, 0};
    const std::vector<double> time{20, 0.5, 3, 1e-3, 0.02};  // in any order
    const auto duration = quantities::stick_distribution(process, entry, time);
    for (std::size_t n = 0; n < time.size(); ++n) {
      const auto flow = linalg::exponential(q, time[n]);
      const double shift = std::exp(-rate * time[n]);
      double density = 0;
      for (int c = 0; c < left; ++c) density += flow(middle, c) * q(c, left);
      INFO("k " << k << " time " << time[n]);
      const double expected = shift * density;
      CHECK(relative_difference(duration.density[n].value, expected) < 1e-11);
      CHECK(duration.density[n].error < 1e-11 * expected);
      const double gone = shift * flow(middle, left);
      CHECK(relative_difference(duration.distribution[n].value, gone) < 1e-11);
    }
  }
}

TEST_CASE("durations: sticking phases end, and errors of the hitting distribution propagate") {
  const model::Process process{{1, 0.25, 32}, {2.5, 0.25}, {1, 0}};
  const auto k = static_cast<std::size_t>(process.highest_static());
  const double even = 1 / (2 * static_cast<double>(k) + 1);
  const std::vector<Uncertain> entry(2 * k + 1, Uncertain{even, 1e-9 * even});
  const auto duration = quantities::stick_distribution(process, entry, {1e4, 1, 10});
  CHECK(duration.distribution[0].value == Approx(1).epsilon(1e-11));
  CHECK(duration.distribution[1].value < duration.distribution[2].value);
  CHECK(duration.distribution[2].value < duration.distribution[0].value);
  for (const auto& value : duration.density) CHECK(value.error >= 1e-9 * value.value);
}

// One jump down at time t and the way back: T = t (1 + up/down).
TEST_CASE("durations: sliding can end at once only where one jump down reverses it") {
  CHECK(f_slide_at(process_with(1, 0.25)) == 0);
  CHECK(f_slide_at(process_with(1, 1)) == 0);  // mu_d = x_k
  CHECK(f_slide_at(process_with(1.2, 1)) == 0);
  CHECK(f_slide_at(process_with(1.2, 0.9)) == 0);
  for (double mu : {1.1, 1.25, 1.4}) {
    const auto process = process_with(mu, mu);
    const double up = 1.5 - mu, down = mu - 1;
    const double rate = process.noise.rate() * process.noise.down(3);
    CHECK(f_slide_at(process) == Approx(rate * down / (up + down)).epsilon(1e-13));
  }
  CHECK(f_slide_at(process_with(1.4, 1.2)) == f_slide_at(process_with(1.2, 1.2)));
}

// Three small times give the limit.
TEST_CASE("durations: the density of sliding phases tends to its value at 0") {
  for (double mu : {1.1, 1.25}) {
    Solved s(test::on_hp(scene(mu, mu, 1, 0.5, {1, 0}), 16));
    const double t = 1e-3;
    const auto f =
        quantities::slide_distribution(s.systems, s.distribution, {t, 2 * t, 4 * t, 0.1, 1}, 1e-8)
            .density;
    const double limit = (8 * f[0].value - 6 * f[1].value + f[2].value) / 3;
    CHECK(relative_difference(limit, f_slide_at(s.systems.process())) < 1e-5);
  }
  // With mu_d on a level of the noise nothing ends at once.
  Solved s(test::on_hp(scene(1, 1, 1, 0.5, {1, 0}), 12));
  const auto f =
      quantities::slide_distribution(s.systems, s.distribution, {1e-5, 1e-3, 0.1, 1}, 1e-8).density;
  CHECK(std::abs(f[0].value) < 1e-3);
  CHECK(f[1].value > 50 * f[0].value);
}

TEST_CASE("durations: means are those of the stationary distribution, and moments are positive",
          "[parallel]") {
  for (const auto& d : {test::on_hp(scene(1, 0.25, 1, 0.25, {1, 0}), 6, 1e-9),
                        test::on_upwind(scene(1, 1, 1, 0.5, {0, 0}), 2)}) {
    Solved s(d);
    const auto m = quantities::duration_moments(s.systems, s.distribution, s.entry());
    const auto& e = s.distribution.excursion();
    CHECK(relative_difference(m.mean_slide.value, e.mean_slide()) < 1e-12);
    CHECK(relative_difference(m.mean_stick.value, e.mean_stick()) < 1e-12);
    CHECK(relative_difference(m.mean_excursion.value, e.mean_excursion()) < 1e-12);
    CHECK(m.var_slide.value > 0);
    CHECK(m.var_stick.value > 0);
    // Where a sliding phase ends depends on its duration; the parts are not independent.
    CHECK(m.var_excursion.value != Approx(m.var_slide.value + m.var_stick.value).epsilon(1e-3));
  }
}
