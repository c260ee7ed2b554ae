#include <cmath>

#include "../common/catch.hpp"
#include "../common/chains.hpp"
#include "../common/scenes.hpp"
#include "../common/values.hpp"
#include "stickslip/case/displacement_rows.hpp"
#include "stickslip/run/carry_out.hpp"

using namespace stickslip;
using cases::Quantity;
using test::values;

namespace {

cases::Case asking(const model::Scene& s, const std::vector<double>& tilts, double accuracy) {
  cases::Case c;
  c.scene = s;
  c.question.quantities = {cases::kLargeDeviation.quantity};
  c.question.arguments["tilt"] = tilts;
  c.question.accuracy = accuracy;
  return c;
}

void require_near(const quantities::Result& found, const std::vector<double>& known,
                  double tolerance, double rounding = 1e-13) {
  REQUIRE(found.value.size() == known.size());
  for (std::size_t n = 0; n < known.size(); ++n) {
    INFO(found.key << " " << n << ": " << found.value[n] << " for " << known[n]);
    CHECK(std::abs(found.value[n] - known[n]) <= found.error[n] + rounding);
    CHECK(found.error[n] < tolerance * std::max(1e-2, std::abs(known[n])));
  }
}

// 2 N + 1 levels of an Ornstein-Uhlenbeck process that only lack the jumps beyond the outermost.
model::LevelTable cut_levels(double delta, int n) {
  std::vector<double> x;
  std::vector<model::Transition> transitions;
  const double rate = 2 / (delta * delta);
  for (int i = -n; i <= n; ++i) {
    const auto here = static_cast<std::size_t>(i + n);
    x.push_back(i * delta);
    const double tilt = delta * x.back() / 2;
    if (i < n) transitions.push_back({here, here + 1, rate * (1 - tilt) / 2});
    if (i > -n) transitions.push_back({here, here - 1, rate * (1 + tilt) / 2});
  }
  return {x, transitions};
}

// Without friction x(t) is a linear functional of the noise, which is a sum of switches of
// +-delta/2, 4/delta^2 of them, that turn at the rate 1/(2 tau).
void require_that_of_the_noise(double delta, double bias, const std::vector<double>& tilts,
                               double accuracy, double tolerance) {
  auto s = test::scene(1e-3, 0, 1, delta, {1, 0});
  s.bias = bias;
  const double count = 4 / (delta * delta);
  std::vector<double> theta, velocity, rate;
  for (double a : tilts) {
    const double half = a * delta / 2, root = std::sqrt(0.25 + half * half);
    theta.push_back(count * half * half / (root + 0.5) + bias * a);
    velocity.push_back(count * delta / 2 * half / root + bias);
    rate.push_back(a * velocity.back() - theta.back());
  }
  const auto found = values(asking(s, tilts, accuracy));
  require_near(found.at("theta"), theta, tolerance);
  require_near(found.at("tilted_velocity"), velocity, tolerance);
  require_near(found.at("rate_function"), rate, tolerance);
}

}  // namespace

TEST_CASE("large deviations: without friction that of the noise", "[parallel]") {
  require_that_of_the_noise(0.5, 0.1, {-1, 0.3, 1}, 1e-7, 1e-6);
}

TEST_CASE("large deviations: steep weights", "[real][long]") {
  require_that_of_the_noise(0.25, 0, {3}, 1e-4, 1e-3);
  require_that_of_the_noise(0.5, 0.1, {-300}, 1e-4, 1e-3);
}

// Bodies that hardly ever come to rest slide as without friction, pushed back by mu_d.
TEST_CASE("large deviations: weights under which bodies slide throughout", "[real]") {
  constexpr double delta = 0.5, mu = 1, tilt = 30, count = 4 / (delta * delta);
  const double half = tilt * delta / 2, root = std::hypot(0.5, half),
               theta = count * half * half / (root + 0.5) - mu * tilt,
               velocity = count * delta / 2 * half / root - mu;
  const auto found =
      values(asking(test::scene(mu, mu, 1, delta, {1, 0}), {-tilt, 0.5, tilt}, 1e-4));
  for (std::size_t n : {0, 2}) {
    const double sign = n == 0 ? -1 : 1;
    CHECK(found.at("theta").value[n] == Approx(theta).epsilon(1e-6));
    CHECK(found.at("tilted_velocity").value[n] == Approx(sign * velocity).epsilon(1e-6));
    CHECK(found.at("rate_function").value[n] == Approx(tilt * velocity - theta).epsilon(1e-4));
  }
}

TEST_CASE("large deviations: what is not resolved is named, and takes nothing along", "[real]") {
  auto c = asking(test::scene(1, 1, 1, 0.25, {1, 0}), {1.5, 0.5, -1.5}, 1e-4);
  c.question.quantities.insert(Quantity::moments);
  c.method.degree = 6;
  c.method.noise_degree = 3;
  auto outcome = run::carry_out(PETSC_COMM_WORLD, c, {});
  CHECK(!outcome.reached);
  for (const auto& result : outcome.results) {
    INFO(result.key);
    const bool tilted = result.value.size() == 3;
    if (tilted) CHECK_THAT(result.unreached, Catch::Contains("-noise_degree 0"));
    CHECK(std::isfinite(result.value[tilted ? 1 : 0]));
    CHECK((!tilted || (std::isnan(result.value[0]) && std::isnan(result.value[2]))));
  }
  c.method.noise_degree = 0;
  outcome = run::carry_out(PETSC_COMM_WORLD, c, {});
  for (const auto& result : outcome.results) CHECK(std::isfinite(result.value[0]));
}

// The mean velocity is E_V; with symmetry both vanish but for rounding.
TEST_CASE("large deviations: at s = 0 and next to it", "[real]") {
  for (double bias : {0.0, 0.2}) {
    auto c = asking(test::biased(test::scene(1, 0.5, 1, 0.5, {1, 0}), bias),
                    {-0.2, -1e-8, 0, 1e-8, 0.2}, 1e-2);
    c.question.quantities.insert(Quantity::moments);
    const auto found = values(c);
    const double mean = found.at("E_V").value[0];
    CHECK(found.at("theta").value[2] == 0);
    for (std::size_t n : {1, 2, 3})
      CHECK(std::abs(found.at("tilted_velocity").value[n] - mean) < 1e-2 * bias + 1e-6);
    for (const auto& [key, result] : found) {
      INFO(key);
      for (double value : result.value) CHECK(std::isfinite(value));
    }
  }
}

// By inverse iteration with a sparse matrix of another discretisation, in another program.
TEST_CASE("large deviations: known to ten digits", "[real][long]") {
  auto s = test::with_table(test::scene(1, 0.25, 1, 0.25, {1, 0}), cut_levels(0.25, 24));
  require_near(values(asking(s, {0.2, 0.5, 1}, 1e-8)).at("theta"),
               {0.02211727946855, 0.1524575775802, 0.7372996400406}, 1e-8);
  s.friction.mu_d = 0.5;
  s.bias = 0.3;
  require_near(values(asking(s, {-0.5, -0.2, 0.2, 0.5}, 1e-8)).at("theta"),
               {-0.0065763195, -0.0203817764, 0.0465924983, 0.1915162390}, 1e-8, 6e-11);
}

TEST_CASE("large deviations: what a truncation velocity leaves out is in the error", "[real]") {
  auto s = test::scene(1, 0.5, 1, 0.5, {1, 0});
  const double whole = values(asking(s, {0.8}, 1e-8)).at("theta").value[0];
  for (double v_max : {1.5, 2.0, 2.5}) {
    s.v_max = v_max;
    const auto theta = values(asking(s, {0.8}, 1e-6)).at("theta");
    INFO(v_max << ": " << theta.value[0] << " +- " << theta.error[0] << " for " << whole);
    CHECK(std::abs(theta.value[0] - whole) <= theta.error[0]);
    CHECK(theta.error[0] < 0.5 * whole);
  }
}

TEST_CASE("large deviations: chosen ends reach as far as the weight does", "[real][long]") {
  const auto s = test::scene(1, 0.5, 1, 0.2, {1, 0});  // 47 levels of 50
  auto full = s;
  full.noise_levels = s.full_levels();
  const auto chosen = values(asking(s, {1.2}, 1e-6)), known = values(asking(full, {1.2}, 1e-8));
  for (const char* key : {"theta", "tilted_velocity", "rate_function"}) {
    INFO(key);
    CHECK(std::abs(chosen.at(key).value[0] - known.at(key).value[0]) <= chosen.at(key).error[0]);
  }
}

namespace {

// Levels with rates of jumps to neighbours.
model::Scene on_levels(double mu_s, double mu_d, double drag, std::vector<model::Level> levels) {
  return test::with_table(test::scene(mu_s, mu_d, 1, 1, {drag, 0}),
                          model::LevelTable(std::move(levels)));
}

}  // namespace

// Against the motion theta is hardly more than the rate of leaving rest, where no sliding body has
// its eigenvalues. By collocation on two meshes.
TEST_CASE("large deviations: bodies that start on one side, against the motion", "[real]") {
  const auto few = on_levels(
      1, 0.5, 0.597,
      {{-1.769, 2.754, 0}, {-0.0735, 0.4514, 0.6054}, {0, 2.915, 2.915}, {0.0735, 0, 0.4514}});
  const std::vector<double> known{-0.1293396469, -0.13717218915};
  require_near(values(asking(few, {60, 400}, 1e-4)).at("theta"), known, 1e-4, 1e-9);
  const auto more = on_levels(1.53, 0.765, 0.854,
                              {{-3.416, 0.2027, 0},
                               {-1.249, 1.432, 0.7982},
                               {-1.072, 8.69, 2.054},
                               {-0.7683, 0.2754, 1.154},
                               {-0.2841, 0.3471, 0.3077},
                               {-0.206, 0, 9.466}});
  require_near(values(asking(more, {3.922}, 1e-4)).at("theta"), {-0.0397721740}, 1e-4, 1e-9);
}

// On the level 0.9 a body that slides upwards would go on to slide, but none does.
TEST_CASE("large deviations: states that no body reaches are left out", "[real]") {
  const auto s = on_levels(1, 0.25, 0.3, {{-2, 1, 0}, {0, 0.5, 0.5}, {0.9, 0, 1}});
  const auto found = values(asking(s, {0.5, 5, 50}, 1e-4));
  // Among the levels that stick: jumps 0 to 0.9 and back, out of 0 at 0.5.
  const double leaving = 1 - std::sqrt(0.5);
  for (double theta : found.at("theta").value) {
    CHECK(theta < 0);
    CHECK(theta >= -leaving);
  }
}

// Two speeds v = -1 and 1, between which the noise jumps at the rate r: theta = sqrt(r^2 + (s v)^2)
// - r, but for the time that a body takes to turn. Vectors begin alike in both directions.
TEST_CASE("large deviations: bodies that rarely turn", "[real]") {
  constexpr double r = 1e-4;
  const auto s = on_levels(1, 0.5, 1, {{-1.5, r, 0}, {1.5, 0, r}});
  for (double tilt : {1e-6, 1e-5, 1e-4, 1e-3}) {
    const double root = std::hypot(r, tilt);
    const auto found = values(asking(s, {tilt}, 1e-4));
    const auto &theta = found.at("theta"), &velocity = found.at("tilted_velocity");
    INFO("tilt " << tilt << ": " << theta.value[0] << " +- " << theta.error[0] << ", "
                 << velocity.value[0] << " +- " << velocity.error[0]);
    CHECK(theta.value[0] == Approx(tilt * tilt / (root + r)).epsilon(1e-3));
    CHECK(velocity.value[0] == Approx(tilt / root).epsilon(1e-3));
    CHECK(velocity.error[0] < 1e-4 * velocity.value[0]);
  }
}
