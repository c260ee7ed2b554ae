#include <cmath>

#include "../common/catch.hpp"
#include "../common/full_grid.hpp"
#include "../common/near.hpp"
#include "../common/quadrature.hpp"
#include "../common/solved.hpp"
#include "stickslip/generator/velocity_methods.hpp"
#include "stickslip/linalg/dense.hpp"
#include "stickslip/quantities/correlations.hpp"
#include "stickslip/quantities/spectra.hpp"

using namespace stickslip;
using model::Start;
using quantities::Uncertain;
using test::relative_difference;
using test::scene;
using test::Solved;

namespace {

// At rest, at s+ and s-, beyond mu_s at v = 0, and in motion: mu_s = 1, delta = 1/2.
const std::vector<Start>& starts() {
  static const std::vector<Start> all{{1, 0},  {-2, 0},  {3, 0},     {-3, 0}, {4, 0},
                                      {-4, 0}, {1, 0.5}, {-2, -0.5}, {4, -1}, {-1, 0.75}};
  return all;
}

model::Observable observable(const std::string& text) {
  return model::parse_observable(text, {1, 0.25});
}

// Linear in |v| on each branch, so that both schemes have its values; of no symmetry.
model::Observable sample_observable() {
  return {"sample", [](double x, double y, double v) { return 1 + x - x * x + 2 * v + y * v * x; }};
}

double at_start(const model::Process& process, const model::Observable& f, const Start& s) {
  const bool rest = s.v == 0 && std::abs(s.level) <= process.highest_static();
  const double y = s.v > 0 || (s.v == 0 && s.level > 0) ? 1 : -1;
  return f(process.noise.level(s.level), rest ? 0 : y, s.v);
}

std::vector<Uncertain> expectation(Solved& s, const model::Observable& f, const Start& start,
                                   const std::vector<double>& time, double tolerance) {
  return quantities::expectation(s.systems, s.distribution, f, start, time, tolerance).value;
}

test::Discrete small_hp(double mu_d = 0.25) {
  return test::on_hp(scene(1, mu_d, 1, 0.5, {1, 0}), 6, 1e-9);
}
test::Discrete small_upwind() { return test::on_upwind(scene(1, 0.25, 1, 0.5, {1, 0}), 2); }
test::Discrete on_all_levels(const model::Scene& s) {
  return test::on_hp(test::on_full_noise(s), 6, 1e-9);
}

}  // namespace

// S_v(omega) = 2 int_0^inf C_vv cos(omega t) dt.
TEST_CASE("transient: the cosine transform of the autocorrelation is the spectrum") {
  const std::vector<double> omega{0, 0.1, 1, 10};
  for (const auto& d :
       {small_hp(), small_hp(1), test::on_hp(scene(1, 1, 1, 0.5, {0, 0}), 8, 1e-9)}) {
    Solved s(d);
    const double end = d.process.drag.bounds_velocity() ? 30 : 80;
    const auto q = test::panels(0, end, static_cast<int>(2 * end));
    const auto c = quantities::autocorrelation(s.systems, s.distribution, q.node, 1e-9);
    const auto known =
        quantities::reduced_spectrum(s.systems, s.distribution, omega, 1e-9).spectrum;
    for (std::size_t w = 0; w < omega.size(); ++w) {
      const double transform =
          2 * q.sum([&](std::size_t n) { return c[n].value * std::cos(omega[w] * q.node[n]); });
      INFO("mu_d " << d.process.friction.mu_d << " omega " << omega[w]);
      CHECK(std::abs(transform - known.value[w].value) < 1e-8 * known.at_zero.value);
      CHECK(relative_difference(transform, known.value[w].value) < 1e-6);
    }
  }
}

TEST_CASE("transient: at time 0 expectations are the values at the start", "[parallel]") {
  const auto f = sample_observable();
  for (const auto& d : {small_hp(), small_upwind()}) {
    Solved s(d);
    for (const auto& start : starts()) {
      const auto u = expectation(s, f, start, {0, 0.5}, 1e-7);
      INFO("level " << start.level << " v " << start.v);
      CHECK(u[0].value == Approx(at_start(d.process, f, start)).margin(1e-6));
    }
  }
}

TEST_CASE("transient: late expectations are the stationary ones") {
  for (const auto& d : {small_hp(), small_upwind()}) {
    Solved s(d);
    const auto& e = s.distribution.excursion();
    const auto late = [&](const char* name, const Start& start) {
      return quantities::expectation(s.systems, s.distribution, observable(name), start, {60},
                                     1e-6);
    };
    for (const auto& start : {Start{-2, 0}, {3, 0}, {-2, -0.5}}) {
      const auto square = late("v^2", start);
      const auto stick = late("stick", start);
      const auto mean = late("v", start);
      CHECK(relative_difference(square.stationary, s.mean_square_velocity()) < 1e-12);
      CHECK(relative_difference(stick.stationary, e.mean_stick() / e.mean_excursion()) < 1e-12);
      CHECK(mean.stationary == 0);
      CHECK(relative_difference(square.value[0].value, square.stationary) < 1e-6);
      CHECK(relative_difference(stick.value[0].value, stick.stationary) < 1e-6);
      CHECK(std::abs(mean.value[0].value) < 1e-6);
    }
  }
}

// L x = -x/tau and L x^2 = 2/tau^2 - 2 x^2/tau on the whole noise range, at rest and in motion.
TEST_CASE("transient: the noise forgets its start in closed form", "[parallel]") {
  const std::vector<double> time{0, 0.01, 0.3, 1, 4};
  for (double tau : {1.0, 2.0}) {
    const auto d = on_all_levels(scene(1, 0.25, tau, 0.5, {1, 0}));
    Solved s(d);
    for (const auto& start : {Start{1, 0}, {-3, 0}, {-2, 0.5}}) {
      const double x = d.process.noise.level(start.level);
      const auto first = expectation(s, observable("x"), start, time, 1e-9);
      const auto second = expectation(s, observable("x^2"), start, time, 1e-9);
      for (std::size_t n = 0; n < time.size(); ++n) {
        const double left = std::exp(-time[n] / tau);
        INFO("tau " << tau << " level " << start.level << " time " << time[n]);
        CHECK(std::abs(first[n].value - x * left) < 1e-11);
        CHECK(std::abs(second[n].value - 1 / tau - (x * x - 1 / tau) * left * left) < 1e-11);
      }
    }
  }
}

// Seen from x = 0 at rest, up and down are the same.
// x^2 - 1 decays as a whole: the model needs one direction, which x = 1 does not see.
TEST_CASE("transient: an eigenfunction stays 0 where it is 0", "[parallel]") {
  const model::Observable f{"variance", [](double x, double, double) { return x * x - 1; }};
  for (const auto& d : {on_all_levels(scene(1, 0.25, 1, 0.5, {1, 0})), small_upwind()}) {
    Solved s(d);
    for (const auto& u : expectation(s, f, {-2, 0}, {0, 1}, 1e-8)) {
      CHECK(std::abs(u.value) < 1e-12);
    }
  }
}

TEST_CASE("transient: odd functions vanish from rest at 0") {
  for (const auto& d : {small_hp(), small_upwind()}) {
    Solved s(d);
    const auto odd = expectation(s, observable("v"), {0, 0}, {0, 1, 5}, 1e-6);
    for (const auto& value : odd) CHECK(std::abs(value.value) < 1e-12);
    const auto both = expectation(s, observable("x+v^2"), {0, 0}, {2}, 1e-6);
    const auto even = expectation(s, observable("v^2"), {0, 0}, {2}, 1e-6);
    CHECK(both[0].value == Approx(even[0].value).epsilon(1e-6));
  }
}

TEST_CASE("transient: what is expected of f scales with f") {
  const std::vector<double> time{0.3, 2};
  for (const auto& d : {small_hp(), small_upwind()}) {
    Solved s(d);
    const auto one = expectation(s, observable("v^2"), {3, 0}, time, 1e-6);
    for (const char* text : {"1000000*v^2", "0.000001*v^2"}) {
      const double factor = std::stod(text);
      const auto other = expectation(s, observable(text), {3, 0}, time, 1e-6);
      for (std::size_t n = 0; n < time.size(); ++n) {
        INFO(text << " time " << time[n]);
        CHECK(relative_difference(other[n].value, factor * one[n].value) < 1e-6);
        // Of the size of 1e-6 of f, and not of rounding.
        CHECK(other[n].error < 1e-3 * factor);
        CHECK(other[n].error > 1e-17 * factor);
      }
    }
  }
}

// No symmetry reduction, no reduced models, no PETSc: all starts of the whole grid of the paper at
// once.
TEST_CASE("transient: upwind equals dense exponentials on the whole grid", "[parallel]") {
  const int levels = 4, nodes = 6;
  const double spacing = 0.25;
  for (double mu_d : {0.25, 0.7}) {
    const model::Process process{{1, 0.5, levels}, {mu_d == 0.25 ? 1 : mu_d, mu_d}, {1, 0.3}};
    const test::FullGrid grid(process, spacing, nodes);
    const auto f = sample_observable();
    std::vector<double> values(grid.size());
    grid.for_each([&](int i, int j, double v, int s) {
      values[s] = at_start(process, f, {i, j * spacing});
      CHECK(v == j * spacing);
    });
    Solved s(
        {process, std::make_shared<generator::UpwindDiscretisation>(spacing, nodes, process.drag)});
    const std::vector<double> time{0.05, 0.6, 3};
    std::vector<std::vector<double>> known;
    for (double t : time) {
      known.push_back(linalg::exponential(grid.generator(), t) * values);
    }
    for (int i : {-4, -3, -1, 0, 1, 2, 3}) {
      for (int j : {-5, 0, 2}) {
        if (i == 0 && j == 0) continue;
        const auto u = expectation(s, f, {i, j * spacing}, time, 1e-9);
        for (std::size_t n = 0; n < time.size(); ++n) {
          INFO("mu_d " << mu_d << " level " << i << " node " << j << " time " << time[n]);
          CHECK(std::abs(u[n].value - known[n][grid.index(i, j)]) < 1e-7);
        }
      }
    }
  }
}
