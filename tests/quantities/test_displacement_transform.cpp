#include <cmath>
#include <complex>
#include <map>

#include "../common/catch.hpp"
#include "../common/scenes.hpp"
#include "../common/values.hpp"
#include "stickslip/case/displacement_rows.hpp"
#include "stickslip/run/refine.hpp"

using namespace stickslip;
using test::Values;
using test::values_at_the_time;
using Complex = std::complex<double>;
using Kind = model::Start::Kind;

namespace {

cases::Case asking(const model::Scene& s, const std::vector<double>& wavenumbers, double time,
                   double accuracy, model::Start start = {0, 0, Kind::stationary}) {
  cases::Case c;
  c.scene = s;
  c.question.quantities = {cases::kDisplacementTransform.quantity};
  c.question.arguments["wavenumber"] = wavenumbers;
  c.question.time = {time};
  c.question.start = start;
  c.question.accuracy = accuracy;
  return c;
}

struct Transform {
  Complex value;
  double error;
};

Transform transform(const Values& found, std::size_t n) {
  const auto &cosine = found.at("displacement_cosine"), &sine = found.at("displacement_sine");
  return {{cosine.value[n], sine.value[n]}, std::hypot(cosine.error[n], sine.error[n])};
}

Values check_simulated(cases::Case c) {
  auto found = values_at_the_time(c);
  c.method = {};
  c.method.route = cases::Route::monte_carlo;
  c.method.excursions = 20000;
  const auto sampled = values_at_the_time(c);
  for (const char* key : {"displacement_cosine", "displacement_sine"}) {
    const auto& r = sampled.at(key);
    for (std::size_t n = 0; n < r.value.size(); ++n) {
      const double sigma = test::sigma(r, n);
      INFO(key << " " << n << ": " << r.value[n] << " +- " << sigma);
      CHECK(std::abs(r.value[n] - found.at(key).value[n]) <= 4.5 * sigma + 1e-12);
    }
  }
  return found;
}

}  // namespace

// By a dense exponential, in another program, of another discretisation.
TEST_CASE("displacement transform: known to ten digits", "[real]") {
  const std::map<double, std::vector<Complex>> known{
      {1, {{0.9451321283, 0.2233078967}, {0.4430876961, 0.4358273658}}},
      {5, {{0.3417255365, 0.6107381189}, {-0.0235127963, 0.1270820303}}}};
  for (const auto& [time, phi] : known) {
    const auto found =
        values_at_the_time(asking(test::pushed_by_telegraph(), {0.5, 2}, time, 1e-8));
    for (std::size_t n = 0; n < phi.size(); ++n) {
      const auto [value, error] = transform(found, n);
      INFO(time << " " << n << ": " << value << " +- " << error << " for " << phi[n]);
      CHECK(std::abs(value - phi[n]) <= error + 1e-10);
      CHECK(error < 3e-8);
    }
  }
}

TEST_CASE("displacement transform: conjugate in the mirror, and even with symmetry",
          "[real][long]") {
  auto s = test::scene(1, 0.5, 1, 0.5, {1, 0.3});
  const auto even = values_at_the_time(asking(s, {-1, 0, 1}, 2, 1e-6));
  CHECK(even.at("displacement_sine").value == std::vector<double>{0, 0, 0});
  CHECK(even.at("displacement_cosine").value[1] == 1);
  CHECK(std::abs(transform(even, 0).value - transform(even, 2).value) <
        transform(even, 0).error + transform(even, 2).error);
  s.bias = 0.3;
  const auto up = transform(values_at_the_time(asking(s, {1}, 2, 1e-6)), 0);
  s.bias = -0.3;
  const auto down = transform(values_at_the_time(asking(s, {1}, 2, 1e-6)), 0);
  CHECK(std::abs(up.value - std::conj(down.value)) < up.error + down.error);
}

TEST_CASE("displacement transform: simulated, within 4.5 sigma", "[real]") {
  check_simulated(asking(test::pushed_by_telegraph(), {0.5, 2, 6}, 1.5, 1e-6));
  check_simulated(
      asking(test::scene(1, 0.5, 1, 0.5, {1, 0}), {0.5, 2, 6}, 1.5, 1e-6, {0, 0, Kind::rest}));
}

// Spaces with few vectors hold waves that have died out already, and stand still at 0.
TEST_CASE("displacement transform: what is left at large wavenumbers is found", "[real]") {
  auto c = asking(test::scene(1, 0.5, 1, 0.5, {1, 0}), {91}, 2, 1e-2);
  c.method.degree = 3;
  const auto found = check_simulated(c);
  CHECK(transform(found, 0).value.real() > 0.1);
  CHECK(transform(found, 0).error < 1e-3);
}
