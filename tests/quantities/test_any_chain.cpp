#include <cmath>

#include "../common/catch.hpp"
#include "../common/chains.hpp"
#include "../common/near.hpp"
#include "../common/scenes.hpp"
#include "../common/values.hpp"
#include "stickslip/run/refine.hpp"

using namespace stickslip;
using cases::Quantity;
using cases::Route;
using test::relative_difference;
using test::Values;
using test::values;

namespace {

cases::Case asking(const model::Scene& s, const std::set<Quantity>& quantities, double accuracy) {
  cases::Case c;
  c.scene = s;
  c.question.quantities = quantities;
  c.question.accuracy = accuracy;
  c.question.lambda = {0.5};
  c.question.omega = {0, 1};
  c.question.time = {0.2, 1};
  c.question.velocity = {0.2, 0.5};
  c.question.observables = {model::parse_observable("v^3", s.friction)};
  return c;
}

const model::Scene kPlain = test::scene(1, 0.5, 1, 1, {1, 0});
const std::set<Quantity> kMeans{Quantity::sticking, Quantity::moments};

struct Known {
  std::string key;
  double value;
};

void require_known(const Values& found, const std::vector<Known>& known, double tolerance) {
  for (const auto& [key, value] : known) {
    INFO(key);
    REQUIRE(found.contains(key));
    CHECK(relative_difference(found.at(key).value[0], value) < tolerance);
  }
}

}  // namespace

// Known from a discretisation of another kind, by another program, at degrees 8, 12 and 16.
TEST_CASE("any chain: five states with jumps of any length, known to twelve digits", "[parallel]") {
  auto s = test::with_table(kPlain, test::five_states());
  auto quantities = kMeans;
  quantities.insert({Quantity::spectrum, Quantity::laplace});
  const auto found = values(asking(s, quantities, 1e-9));
  require_known(found,
                {{"P_stick", 0.655906541398},
                 {"mean_slide", 1.52852376164},
                 {"mean_stick", 2.91365240716},
                 {"E_V2", 0.0492006321314},
                 {"E_absV", 0.0996893782982},
                 {"E_XV", 0.0990453212805},
                 {"S_v", 0.0953941983442},
                 {"F_slide", 0.536560984452}},
                1e-11);
  CHECK(relative_difference(found.at("S_v").value[1], 0.0609539138929) < 1e-11);
  CHECK(found.at("E_V").value[0] == 0);
  s.bias = 0.15;
  require_known(values(asking(s, kMeans, 1e-10)),
                {{"P_stick", 0.657128239846},
                 {"mean_slide", 1.52311534816},
                 {"E_V2", 0.052607244296},
                 {"E_V", 0.0299054738533}},
                1e-11);
}

// The chain keeps states of both signs, which are known to balance.
TEST_CASE("any chain: what its mirror image makes vanish is exactly zero") {
  const auto s = test::with_table(test::scene(0.8, 0.4, 1, 1, {1, 0}),
                                  test::sine_and_levels(1.1, 4, 4, 0.6, 1, 0.7, 2));
  REQUIRE_FALSE(s.process(1).symmetric());
  for (const auto kind : {model::Start::Kind::rest, model::Start::Kind::stationary}) {
    auto c = asking(s, {Quantity::displacement, Quantity::expectation}, 1e-3);
    c.question.start.kind = kind;
    const auto found = values(c);
    for (const auto* key : {"displacement_mean", "E(v^3)"}) {
      INFO(key);
      CHECK(found.at(key).value == std::vector<double>{0, 0});
      CHECK(found.at(key).error == std::vector<double>{0, 0});
    }
    CHECK(found.at("displacement_variance").value[1] > 0);
  }
  // A state has no mirror image of its own, but what it tends to has.
  const auto from_state = values(asking(s, {Quantity::expectation}, 1e-3));
  CHECK(std::abs(from_state.at("E(v^3)").value[0]) > from_state.at("E(v^3)").error[0]);
  CHECK(from_state.at("stationary(v^3)").value == std::vector<double>{0});
  CHECK(from_state.at("stationary(v^3)").error == std::vector<double>{0});
}

TEST_CASE("any chain: simulated cycles give the same, within 4.5 sigma", "[real]") {
  auto s = test::with_table(test::scene(1, 0.5, 1, 1, {1, 0}),
                            test::sine_and_levels(1.2, 4, 6, 0.5, 1, 0.7, 2));
  s.bias = 0.1;
  auto c = asking(s,
                  {Quantity::sticking, Quantity::moments, Quantity::averages, Quantity::noise_law,
                   Quantity::entry_law, Quantity::laplace, Quantity::spectrum, Quantity::slip,
                   Quantity::autocorrelation, Quantity::displacement, Quantity::expectation,
                   Quantity::duration_density, Quantity::peak, Quantity::resolvent},
                  1e-4);
  c.question.omega = {0, 1, 1.6};
  c.question.start.kind = model::Start::Kind::stationary;
  c.question.inverse_distance = {1};
  const auto found = values(c);
  c.method.route = Route::monte_carlo;
  c.method.excursions = 20000;
  int compared = 0;
  for (const auto& [key, r] : values(c)) {
    const bool by_cells = key.starts_with("f_s") || key.starts_with("f_e");
    if (by_cells || !found.contains(key) || r.ci95.empty()) continue;
    for (std::size_t n = 0; n < r.value.size(); ++n) {
      const double sigma = test::sigma(r, n);
      INFO(key << " " << n << ": " << r.value[n] << " +- " << sigma << " for "
               << found.at(key).value[n]);
      CHECK(std::abs(r.value[n] - found.at(key).value[n]) <=
            4.5 * sigma + 1e-4 * std::abs(r.value[n]) + 1e-12);
      ++compared;
    }
  }
  CHECK(compared > 60);
}

// By no sample, as by ten thousands of them without doubt.
TEST_CASE("any chain: simulated cycles that reach no speed leave its intervals open", "[real]") {
  auto c = asking(test::with_table(kPlain, test::five_states()),
                  {Quantity::peak, Quantity::duration_density}, 1e-4);
  c.method.route = Route::monte_carlo;
  c.method.excursions = 100;
  c.question.velocity = {0.1, 1.4999};
  c.question.time = {1e-3, 200};
  const auto found = values(c);
  const auto& peak = found.at("P_peak");
  CHECK(peak.value[1] == 0);
  CHECK(peak.ci95[1].first == 0);
  CHECK(peak.ci95[1].second > 0.005);
  CHECK(peak.ci95[1].second < 0.1);
  for (const char* key : {"mean_first_passage", "mean_first_passage_rest"}) {
    INFO(key);
    CHECK(std::isfinite(found.at(key).ci95[0].second));
    CHECK(found.at(key).value[1] > 5 * found.at(key).value[0]);
    CHECK(std::isinf(found.at(key).ci95[1].second));
  }
  CHECK(found.at("cdf_slide").value[1] == 1);
  CHECK(found.at("cdf_slide").ci95[1].first < 0.999);
}
