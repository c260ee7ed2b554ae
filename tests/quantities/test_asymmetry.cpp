#include <cmath>
#include <map>

#include "../common/catch.hpp"
#include "../common/near.hpp"
#include "../common/solved.hpp"
#include "stickslip/model/noise_chain.hpp"
#include "stickslip/quantities/density.hpp"
#include "stickslip/quantities/engines/excursions.hpp"
#include "stickslip/run/routes.hpp"

using namespace stickslip;
using cases::Quantity;
using test::biased;
using test::relative_difference;
using test::scene;
using test::Solved;

namespace {

// Results by key; errors of what is rough by key and kError.
using Values = std::map<std::string, std::vector<double>>;
constexpr const char* kError = " +-";

bool is_rough(const std::string& key) {
  return key.starts_with("f_") || key.starts_with("cdf_") || key.starts_with("E(");
}

// So small that it moves nothing, and yet no symmetry is made use of.
constexpr double kNothing = 1e-300;

const std::set<Quantity> kAll{
    Quantity::sticking,        Quantity::moments,     Quantity::averages,
    Quantity::entry_law,       Quantity::laplace,     Quantity::resolvent,
    Quantity::spectrum,        Quantity::relaxation,  Quantity::duration_density,
    Quantity::autocorrelation, Quantity::expectation, Quantity::sensitivity};

// In pairs of mirror images.
constexpr const char* kObservables[][2] = {
    {"v^2", "v^2"}, {"x*v + v", "x*v - v"}, {"y == 0 ? x + 1 : v*v*v", "y == 0 ? 1 - x : -v*v*v"}};

cases::Case everything(const model::Scene& s, bool mirrored = false) {
  cases::Case c;
  c.scene = s;
  c.question.quantities = kAll;
  c.question.lambda = {0.3, 3};
  c.question.omega = {0, 0.5, 4};
  c.question.time = {0.5, 2};
  c.question.start.level = mirrored ? -1 : 1;
  for (const auto& [f, image] : kObservables) {
    auto observable = model::parse_observable(mirrored ? image : f, s.friction);
    observable.name = f;
    c.question.observables.push_back(observable);
  }
  c.question.accuracy = 1e-8;
  return c;
}

Values evaluated(const cases::Case& c, const test::Discrete& d) {
  linalg::SolverStatistics statistics;
  Values values;
  for (const auto& r : run::evaluate({PETSC_COMM_WORLD, c, d, statistics}).results) {
    values[r.key] = r.value;
    if (is_rough(r.key)) values[r.key + kError] = r.error;
  }
  return values;
}

Values everything_on_hp(const model::Scene& s, bool mirrored = false) {
  return evaluated(everything(s, mirrored), test::on_hp(test::on_full_noise(s), 7));
}

// Reduced models of what is rough agree within their errors, and to five digits of the largest
// value at least; all others leave ten digits or more.
void check_alike(const Values& found, const Values& expected, double tolerance) {
  for (const auto& [key, values] : expected) {
    REQUIRE(found.count(key) == 1);
    double size = 0;
    for (double value : values) size = std::max(size, std::abs(value));
    if (key.ends_with(kError)) {
      CHECK(size <= 1e-3);
      continue;
    }
    // How many of the faster modes are found depends on the scalar type.
    const std::size_t count = key.starts_with("relaxation") ? 3 : values.size();
    REQUIRE(found.at(key).size() >= count);
    for (std::size_t n = 0; n < count; ++n) {
      INFO(key << " " << n << " " << found.at(key)[n] << " " << values[n]);
      double allowed = tolerance * size + 1e-13;
      if (is_rough(key)) {
        allowed += std::min(found.at(key + kError)[n] + expected.at(key + kError)[n], 1e-5 * size);
      }
      CHECK(std::abs(found.at(key)[n] - values[n]) <= allowed);
    }
  }
}

model::Scene asymmetric() {
  auto s = scene(1, 0.4, 1, 0.5, {1, 0});
  s.friction.mu_s_minus = 1.3;
  s.friction.mu_d_minus = 0.7;
  s.bias = 0.2;
  return s;
}

std::map<std::string, double> scalars(const Solved& solved) {
  quantities::Results results;
  quantities::append_sticking(solved.distribution.excursion(), results);
  quantities::append_moments(solved.distribution.discretisation(), solved.distribution.excursion(),
                             results);
  std::map<std::string, double> values;
  for (const auto& r : results) values[r.key] = r.value[0];
  return values;
}

model::Scene mirrored(model::Scene s) {
  s.friction = s.friction.mirrored();
  s.drag = s.drag.mirrored();
  s.bias = -s.bias;
  return s;
}

}  // namespace

TEST_CASE("asymmetry: as it vanishes everything has its symmetric value", "[slow]") {
  for (const auto& s : {scene(1, 0.4, 1, 0.5, {1, 0}), scene(0.7, 0.7, 1, 0.5, {0.5, 0.2})}) {
    auto expected = everything_on_hp(s);
    auto nearly = s;
    nearly.bias = kNothing;
    auto found = everything_on_hp(nearly);
    // Even and odd modes, in one list.
    std::vector<double> rates = expected["relaxation_even"];
    for (double rate : expected["relaxation_odd"]) rates.push_back(rate);
    std::sort(rates.begin(), rates.end());
    rates.resize(3);
    found["relaxation"].resize(3);
    CHECK(found["relaxation"][0] == Approx(rates[0]).epsilon(1e-9));
    CHECK(found["relaxation"][1] == Approx(rates[1]).epsilon(1e-9));
    for (const char* parity : {"even", "odd"}) {
      expected.erase(std::string("relaxation_") + parity);
      expected.erase(std::string("relaxation_") + parity + "_frequency");
    }
    check_alike(found, expected, 1e-10);
  }
}

TEST_CASE("asymmetry: mirror images mirror", "[slow][real]") {
  auto lopsided = asymmetric();
  lopsided.drag = {};
  lopsided.drag.law = [](double v) { return v > 0 ? -v - 0.5 * v * v : -0.7 * v; };
  lopsided.drag.law_is_odd = false;
  for (const auto& s : {asymmetric(), lopsided}) {
    const auto here = everything_on_hp(s);
    auto there = everything_on_hp(mirrored(s), true);
    // The sides exchange their names.
    const auto exchange = [&](const std::string& a, const std::string& b) {
      std::swap(there.at(a), there.at(b));
    };
    exchange("h_plus", "h_minus_from_minus");
    exchange("h_minus", "h_plus_from_minus");
    exchange("w_one", "w_one_from_minus");
    exchange("entry_law", "entry_law_minus");
    for (const char* key : {"entry_law", "entry_law_minus"}) {
      std::reverse(there.at(key).begin(), there.at(key).end());
    }
    for (const auto& pair : kObservables) {
      const std::string f = std::string("(") + pair[0] + ")";
      exchange("w_plus" + f, "w_minus" + f);
      exchange("u" + f, "u_minus" + f);
      exchange("mu" + f, "mu_minus" + f);
    }
    for (auto& [key, values] : there) {
      if (!key.starts_with("E_V") && !key.starts_with("dE_V_")) continue;
      if (key == "E_V2") continue;
      for (double& value : values) value = -value;
    }
    // Derivatives by thresholds of the directions.
    for (auto& [key, values] : there) {
      const std::string minus = key + "_minus";
      if (key.ends_with("_dmu_d")) std::swap(values, there.at(minus));
    }
    check_alike(here, there, 1e-9);
  }
}

// If mu_s+ - mu_s- = mu_d+ - mu_d- = d, the mean thresholds with the bias -d/2 are the same
// process.
TEST_CASE("asymmetry: thresholds that differ alike are a bias", "[parallel]") {
  auto by_direction = scene(1, 0.4, 1, 0.5, {1, 0});
  by_direction.friction.mu_s_minus = 1.3;
  by_direction.friction.mu_d_minus = 0.7;
  auto by_bias = scene(1.15, 0.55, 1, 0.5, {1, 0});
  by_bias.bias = 0.15;
  auto c = everything(by_direction), b = everything(by_bias);
  for (auto* one : {&c, &b}) {
    one->question.quantities = {Quantity::sticking,  Quantity::moments, Quantity::entry_law,
                                Quantity::resolvent, Quantity::laplace, Quantity::spectrum};
  }
  const auto found = evaluated(c, test::on_hp(by_direction, 7)),
             expected = evaluated(b, test::on_hp(by_bias, 7));
  check_alike(found, expected, 1e-12);
}

TEST_CASE("averages: of the phases, and what symmetry makes zero", "[parallel]") {
  const auto s = scene(1, 0.4, 1, 0.5, {1, 0});
  auto c = everything(s);
  c.question.quantities = {Quantity::sticking, Quantity::moments, Quantity::averages};
  c.question.observables.clear();
  for (const char* f : {"v^2", "x", "y == 0 ? 2 : 3", "x*x"}) {
    c.question.observables.push_back(model::parse_observable(f, s.friction));
  }
  const auto v = evaluated(c, test::on_hp(s, 8));
  CHECK(relative_difference(v.at("pi(v^2)")[0], v.at("E_V2")[0]) < 1e-13);
  CHECK(v.at("pi(v^2|stick)")[0] == 0);
  CHECK(relative_difference(v.at("pi(v^2|slide)")[0] * v.at("P_slide")[0], v.at("E_V2")[0]) <
        1e-13);
  CHECK(v.at("pi(x)")[0] == 0);
  CHECK(v.at("pi(y == 0 ? 2 : 3|stick)")[0] == Approx(2).epsilon(1e-13));
  CHECK(v.at("pi(y == 0 ? 2 : 3|slide)")[0] == Approx(3).epsilon(1e-12));
  CHECK(v.at("pi(x*x)")[0] == Approx(1 / s.tau).epsilon(1e-9));
}

// A start is a measure: in the stationary one nothing changes, and rest is a mixture of starts.
TEST_CASE("expectation: from rest and from the stationary distribution", "[parallel]") {
  for (double bias : {0.0, 0.2}) {
    auto s = test::on_full_noise(scene(1, 0.4, 1, 1, {1, 0}));
    s.bias = bias;
    const auto d = test::on_hp(s, 6);
    auto c = everything(s);
    c.question.quantities = {Quantity::expectation};
    c.question.time = {0, 0.7, 30};
    c.question.observables.resize(2);
    const auto from = [&](model::Start start) {
      c.question.start = start;
      return evaluated(c, d);
    };
    const auto stationary = from({0, 0, model::Start::Kind::stationary}),
               rest = from({0, 0, model::Start::Kind::rest});
    const auto weights = model::stationary_distribution(d.process.noise);
    std::vector<std::map<std::string, std::vector<double>>> at_level;
    for (int i = -s.full_levels(); i <= s.full_levels(); ++i) at_level.push_back(from({i, 0}));
    for (const auto& f : c.question.observables) {
      const std::string key = "E(" + f.name + ")", limit = "stationary(" + f.name + ")";
      std::vector<double> mixed(3, 0.0);
      for (std::size_t i = 0; i < weights.size(); ++i) {
        for (std::size_t n = 0; n < 3; ++n) mixed[n] += weights[i] * at_level[i].at(key)[n];
      }
      for (std::size_t n = 0; n < 3; ++n) {
        INFO(key << " " << n);
        CHECK(stationary.at(key)[n] == rest.at(limit)[0]);
        CHECK(rest.at(key)[n] == Approx(mixed[n]).margin(1e-7));
      }
      CHECK(rest.at(key)[2] == Approx(rest.at(limit)[0]).margin(1e-7));
    }
  }
}

TEST_CASE("bias: the density integrates to the distribution and to its drift") {
  for (double bias : {0.2, -1.4}) {
    const auto s = biased(scene(1, 0.6, 1, 0.25, {1, 0}), bias);
    const Solved solved(test::on_hp(s, 8));
    const auto field = quantities::density_field(solved.distribution);
    const auto values = scalars(solved);
    const auto weights = solved.distribution.discretisation().velocities->weights();
    const std::size_t half = field.pdf.v().size() / 2;
    double sliding = 0, drift = 0, noise = 0, stick = 0;
    for (std::size_t j = 0; j < half; ++j) {
      const double above = weights[j] * field.velocity_marginal[half + j];
      const double below = weights[j] * field.velocity_marginal[half - 1 - j];
      sliding += above + below;
      drift += field.pdf.v()[half + j] * (above - below);
    }
    for (std::size_t i = 0; i < field.atom.size(); ++i) {
      stick += field.atom[i];
      noise += field.noise_marginal[i];
    }
    CHECK(stick == Approx(values.at("P_stick")).epsilon(1e-12));
    CHECK(sliding + stick + field.truncated_mass == Approx(1).epsilon(1e-11));
    CHECK(drift == Approx(values.at("E_V")).epsilon(1e-9));
    CHECK(noise == Approx(1).epsilon(1e-11));
    // The distribution of the noise, level by level.
    const auto distribution = model::stationary_distribution(solved.distribution.process().noise);
    for (std::size_t i = 0; i < distribution.size(); ++i) {
      CHECK(field.noise_marginal[i] == Approx(distribution[i]).epsilon(1e-7).margin(1e-12));
    }
  }
}
