#include <cmath>
#include <complex>
#include <numeric>

#include "../common/catch.hpp"
#include "../common/full_grid.hpp"
#include "../common/near.hpp"
#include "../common/solved.hpp"
#include "stickslip/generator/velocity_methods.hpp"
#include "stickslip/linalg/session.hpp"
#include "stickslip/quantities/spectra.hpp"

using namespace stickslip;
using quantities::ReducedSpectrum;
using quantities::Uncertain;
using test::relative_difference;
using test::scene;
using test::Solved;

namespace {

ReducedSpectrum reduced(Solved& s, const std::vector<double>& omega, double tolerance) {
  return quantities::reduced_spectrum(s.systems, s.distribution, omega, tolerance);
}

// Digits as printed: off by no more than half a unit of the last one, and a little.
struct Known {
  double omega, value, unit;
};

bool is(double value, const Known& known) {
  return std::abs(value - known.value) < 0.51 * known.unit;
}

struct Table {
  double delta;
  std::vector<Known> values;  // S_v
};

// b = -v, mu_s = 1, mu_d = 1/4, tau = 1.
const std::vector<Table>& known_values() {
  static const std::vector<Table> tables{{0.5,
                                          {{0, 1.05184088, 1e-8},
                                           {0.1, 1.03401702, 1e-8},
                                           {1, 0.310095661, 1e-9},
                                           {10, 1.85013e-4, 1e-9}}},
                                         {0.25,
                                          {{0, 1.08314710, 1e-8},
                                           {0.1, 1.06555462, 1e-8},
                                           {1, 0.330747341, 1e-9},
                                           {10, 1.91001e-4, 1e-9}}}};
  return tables;
}

std::vector<double> frequencies(const Table& table) {
  std::vector<double> omega;
  for (const auto& known : table.values) omega.push_back(known.omega);
  return omega;
}

struct Sample {
  const char* name;
  test::Discrete d;
};

// Degrees for which the grid itself is right to 1e-8 up to omega = 50: what only the grid has, the
// two methods see differently.
std::vector<Sample> samples() {
  return {{"linear drag", test::on_hp(scene(1, 0.25, 1, 0.25, {1, 0}), 8)},
          {"mu_d = mu_s", test::on_hp(scene(1, 1, 1, 0.25, {1, 0}), 8)},
          {"tau = 1/4", test::on_hp(scene(1, 0.25, 0.25, 0.5, {1, 0}), 8)},
          {"tau = 4, cubic drag", test::on_hp(scene(0.7, 0.4, 4, 0.25, {2, 1}), 24)},
          {"no drag", test::on_hp(scene(1, 1, 1, 0.5, {0, 0}), 20)},
          {"upwind", test::on_upwind(scene(1, 0.25, 1, 0.5, {1, 0}), 4)}};
}

// Smaller ones, for the errors that each model states.
std::vector<Sample> small_samples() {
  return {{"linear drag", test::on_hp(scene(1, 0.25, 1, 0.5, {1, 0}), 8)},
          {"mu_d = mu_s", test::on_hp(scene(1, 1, 1, 0.5, {1, 0}), 8)},
          {"tau = 1/4", test::on_hp(scene(1, 0.25, 0.25, 1, {1, 0}), 8)},
          {"cubic drag", test::on_hp(scene(0.7, 0.4, 1, 0.5, {2, 1}), 8)},
          {"no drag", test::on_hp(scene(1, 1, 1, 0.5, {0, 0}), 12)}};
}

/// Small dense chains without any symmetry reduction, 2 Re c (i omega - M)^-1 v.
class DenseSpectrum {
 public:
  DenseSpectrum(const model::Process& process, double spacing, int nodes)
      : grid_(process, spacing, nodes), v_(grid_.size()), c_(grid_.stationary()) {
    grid_.for_each([&](int, int, double v, int s) {
      v_[s] = v;
      c_[s] *= v;
    });
  }

  [[nodiscard]] double operator()(double omega) const {
    using Complex = std::complex<double>;
    const int n = grid_.size();
    auto a = linalg::Matrix<Complex>::identity(n, {0, omega});
    for (int c = 0; c < n; ++c) {
      for (int r = 0; r < n; ++r) a(r, c) -= grid_.generator()(r, c);
    }
    std::vector<Complex> x(v_.begin(), v_.end());
    linalg::LuFactors(std::move(a)).solve(x, false);
    return 2 * std::inner_product(c_.begin(), c_.end(), x.begin(), Complex(0)).real();
  }

  /// E[V L V]: 0 for the process, the diffusion of the scheme on a grid.
  [[nodiscard]] double power() const {
    const auto lv = grid_.generator() * v_;
    return std::inner_product(c_.begin(), c_.end(), lv.begin(), 0.0);
  }

 private:
  test::FullGrid grid_;
  std::vector<double> v_, c_;
};

}  // namespace

TEST_CASE("spectrum: known values by the reduced model", "[parallel]") {
  for (const auto& table : known_values()) {
    Solved s(test::on_hp(scene(1, 0.25, 1, table.delta, {1, 0}), 9));
    const auto r = reduced(s, frequencies(table), 1e-10);
    for (std::size_t n = 0; n < table.values.size(); ++n) {
      INFO("delta " << table.delta << " omega " << table.values[n].omega);
      CHECK(is(r.spectrum.value[n].value, table.values[n]));
    }
    CHECK(is(r.spectrum.at_zero.value, table.values[0]));
  }
}

TEST_CASE("spectrum: the reduced model agrees with complex solves, within its errors", "[slow]") {
  const std::vector<double> omega{0, 1e-3, 0.01, 0.05, 0.1, 0.3, 0.7, 1, 2, 5, 10, 25, 50};
  for (const auto& [name, d] : samples()) {
    Solved s(d);
    const auto r = reduced(s, omega, 1e-9);
    const auto direct = quantities::direct_spectrum(s.systems, s.distribution, omega);
    for (std::size_t n = 0; n < omega.size(); ++n) {
      const Uncertain one = r.spectrum.value[n], other = direct[n];
      INFO(name << " omega " << omega[n] << " error " << one.error / one.value);
      CHECK(relative_difference(one.value, other.value) < 1e-8);
      CHECK(one.error < 1e-8 * one.value);
      // What the last vectors changed is no bound, but shows the size; the grid has errors too.
      const double slack = omega[n] < 25 ? 1e-12 : 3e-9;
      CHECK(std::abs(one.value - other.value) < 10 * (one.error + other.error) + slack * one.value);
    }
    CHECK(relative_difference(r.spectrum.at_zero.value, direct[0].value) < 1e-8);
    CHECK(r.shifts.size() < 10);
    CHECK(r.pairs <= 80);
  }
}

// On one rank or distributed: the same numbers.
TEST_CASE("spectrum: complex solves on several ranks give what one gives", "[parallel]") {
  const std::vector<double> omega{0.03, 0.5, 2, 7, 20};
  const auto d = test::on_hp(scene(1, 0.25, 1, 0.5, {1, 0}), 6, 1e-9);
  Solved alone(d, PETSC_COMM_SELF), together(d);
  const auto shared = quantities::direct_spectrum(together.systems, together.distribution, omega);
  const auto own = quantities::direct_spectrum(alone.systems, alone.distribution, omega);
  const auto r = reduced(together, omega, 1e-9);
  REQUIRE(shared.size() == omega.size());
  for (std::size_t n = 0; n < omega.size(); ++n) {
    CHECK(relative_difference(shared[n].value, own[n].value) < 1e-13);
    CHECK(relative_difference(shared[n].value, r.spectrum.value[n].value) < 1e-7);
  }
}

// No symmetry reduction, no excursions, no PETSc. Beyond 1/tau what the scheme makes of E[V dV/dt]
// = 0 is left out.
TEST_CASE("spectrum: upwind equals dense solves on the whole grid") {
  struct Case {
    double mu_s, mu_d, tau;
    int levels, nodes;
    model::Drag drag;
  };
  for (const auto& c : {Case{1, 0.25, 1, 4, 7, {1, 0}}, Case{0.4, 0.4, 0.5, 3, 9, {1, 0.5}}}) {
    const model::Process process{{c.tau, 0.5, c.levels}, {c.mu_s, c.mu_d}, c.drag};
    const double spacing = 0.25;
    const DenseSpectrum dense(process, spacing, c.nodes);
    Solved s(
        {process, std::make_shared<generator::UpwindDiscretisation>(spacing, c.nodes, c.drag)});
    const std::vector<double> omega{0.05, 0.9 / c.tau, 1.1 / c.tau, 8};
    const auto r = reduced(s, omega, 1e-11);
    for (std::size_t n = 0; n < omega.size(); ++n) {
      const double left_out = omega[n] * c.tau > 1 ? 2 * dense.power() / (omega[n] * omega[n]) : 0;
      INFO("tau " << c.tau << " omega " << omega[n]);
      CHECK(relative_difference(r.spectrum.value[n].value, dense(omega[n]) + left_out) < 1e-9);
    }
  }
}

TEST_CASE("spectrum: omega = 0 is no special case, and both formulas meet at 1/tau") {
  for (const auto& [name, d] : small_samples()) {
    Solved s(d);
    const double turn = 1 / d.process.noise.tau;
    const auto r = reduced(s, {0, 1e-9, turn * (1 - 1e-10), turn * (1 + 1e-10)}, 1e-9);
    const auto& value = r.spectrum.value;
    INFO(name);
    CHECK(value[0].value == r.spectrum.at_zero.value);
    CHECK(relative_difference(value[1].value, value[0].value) < 1e-12);
    CHECK(relative_difference(value[2].value, value[3].value) < 1e-8);
  }
}

TEST_CASE("spectrum: its integral is the variance, and half of S_v(0) is met at half its width") {
  for (const auto& [name, d] : small_samples()) {
    Solved s(d);
    const auto shape = reduced(s, {}, 1e-9).shape;
    const auto r = reduced(s, {shape.full_width.value / 2}, 1e-10);
    INFO(name << " errors " << shape.variance.error << " " << shape.full_width.error);
    CHECK(relative_difference(shape.variance.value, s.mean_square_velocity()) < 1e-8);
    CHECK(std::abs(shape.variance.value - s.mean_square_velocity()) < shape.variance.error);
    CHECK(relative_difference(2 * r.spectrum.value[0].value, r.spectrum.at_zero.value) < 1e-8);
  }
}

TEST_CASE("spectrum: errors of values, width and variance cover those of better models") {
  const auto all = small_samples();
  for (std::size_t sample : {0, 3}) {
    const auto& [name, d] = all[sample];
    Solved s(d);
    const std::vector<double> omega{0.3, 4};
    const auto rough = reduced(s, omega, 1e-2), fine = reduced(s, omega, 1e-9);
    const auto covers = [](Uncertain one, Uncertain better) {
      CHECK(one.error > 1e-16 * one.value);  // rounding alone where a true solution was compared
      CHECK(one.error < 0.1 * one.value);
      CHECK(std::abs(one.value - better.value) < 10 * one.error);
    };
    INFO(name);
    covers(rough.shape.full_width, fine.shape.full_width);
    covers(rough.shape.variance, fine.shape.variance);
    covers(rough.spectrum.at_zero, fine.spectrum.at_zero);
    for (std::size_t n = 0; n < omega.size(); ++n) {
      covers(rough.spectrum.value[n], fine.spectrum.value[n]);
    }
  }
}

// S = a/(1 + (omega/w)^4): half of S(0) at w, where S falls at the rate a/w; the variance is
// (1/pi) a w pi/(2 sqrt 2). The wide one has a part of 1e-5 beyond the last panel.
TEST_CASE("spectrum: width and variance of a known one, with the errors of its values") {
  constexpr double a = 3, tau = 0.5;
  for (const double width : {0.7 / tau, 1e4 / tau}) {
    const auto s = [=](double omega) { return a / (1 + std::pow(omega / width, 4)); };
    const auto shape = quantities::shape_of(s, tau, 1e-4, 1e-3);
    INFO("width " << width);
    CHECK(shape.full_width.value == Approx(2 * width).epsilon(1e-12));
    // Two values with a relative error of 1e-4 each move the half width by 1e-4 w.
    CHECK(shape.full_width.error == Approx(2e-4 * width).epsilon(1e-6));
    const double variance = a * width / (2 * std::sqrt(2));
    CHECK(shape.variance.value == Approx(variance).epsilon(1e-10));
    CHECK(shape.variance.error >= 1e-3 * variance);
    CHECK(shape.variance.error < 1.01e-3 * variance);
  }
}

// S = 1/((w^2 - omega^2)^2 + (g omega)^2), whose variance is 1/(2 g w^2), has a narrow peak.
TEST_CASE("spectrum: the variance of a narrow peak is found in any unit of time") {
  std::vector<double> in_units;
  for (const double unit : {1.0, std::pow(2.0, -30), std::pow(2.0, 20)}) {
    const double w = 0.7 / unit, g = 0.01 / unit;
    const auto s = [=](double omega) {
      return 1 / (std::pow((w - omega) * (w + omega), 2) + std::pow(g * omega, 2));
    };
    const auto variance = quantities::shape_of(s, unit, 0, 1e-5).variance;
    const double known = 1 / (2 * g * w * w);
    INFO("unit " << unit << " error " << variance.error / known);
    CHECK(variance.value == Approx(known).epsilon(1e-9));
    CHECK(variance.error < 1e-4 * known);
    in_units.push_back(variance.value / std::pow(unit, 3));
  }
  CHECK(in_units[1] == Approx(in_units[0]).epsilon(1e-14));
  CHECK(in_units[2] == Approx(in_units[0]).epsilon(1e-14));
}

TEST_CASE("spectrum: one that never falls to half has no width") {
  const auto shape = quantities::shape_of([](double) { return 1.0; }, 1, 0, 0);
  CHECK(std::isnan(shape.full_width.value));
}
