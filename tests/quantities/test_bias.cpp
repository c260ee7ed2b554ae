#include <cmath>
#include <map>

#include "../common/catch.hpp"
#include "../common/near.hpp"
#include "../common/solved.hpp"
#include "stickslip/model/noise_chain.hpp"
#include "stickslip/quantities/density.hpp"
#include "stickslip/quantities/spectra.hpp"
#include "stickslip/run/evaluation.hpp"

using namespace stickslip;
using quantities::Results;
using test::biased;
using test::relative_difference;
using test::scene;
using test::Solved;

namespace {

// So small that it moves nothing, and yet no symmetry is made use of.
constexpr double kNothing = 1e-300;

const std::vector<model::Scene>& sample_scenes() {
  static const std::vector<model::Scene> scenes{
      scene(1, 0.25, 1, 0.25, {1, 0}), scene(1, 1, 1, 0.5, {1, 0}),
      scene(0.2, 0.15, 1, 0.5, {1, 0}),  // k = 0
      scene(0.7, 0.4, 2, 0.5, {0.5, 1}), scene(1, 0.5, 1, 0.5, {0, 0})};
  return scenes;
}

std::map<std::string, double> scalars(const Solved& solved) {
  Results results;
  quantities::append_sticking(solved.distribution.excursion(), results);
  quantities::append_moments(solved.distribution.discretisation(), solved.distribution.excursion(),
                             results);
  std::map<std::string, double> values;
  for (const auto& r : results) values[r.key] = r.value[0];
  return values;
}

double spectrum_at_zero(Solved& solved) {
  return quantities::reduced_spectrum(solved.systems, solved.distribution, {}, 1e-12)
      .spectrum.at_zero.value;
}

}  // namespace

TEST_CASE("bias: without one both velocity branches give what one of them gives", "[parallel]") {
  for (const auto& s : sample_scenes()) {
    for (bool hp : {true, false}) {
      const auto on = [&](const model::Scene& any) {
        return hp ? test::on_hp(any, 8) : test::on_upwind(any, 4);
      };
      const Solved symmetry_reduced(on(s));
      Solved whole(on(biased(s, kNothing)));
      REQUIRE_FALSE(whole.distribution.process().symmetric());
      const auto one = scalars(symmetry_reduced), both = scalars(whole);
      INFO("mu_s " << s.friction.mu_s << " delta " << s.delta << " hp " << hp);
      for (const auto& [key, value] : one) {
        INFO(key);
        if (key != "E_V") CHECK(relative_difference(both.at(key), value) < 1e-11);
      }
      CHECK(std::abs(both.at("E_V")) < 1e-12 * one.at("E_absV"));
      const double falling = whole.distribution.starts().next[2];  // of s-, s+
      CHECK(falling > 0);
      CHECK(falling < 1);
      CHECK(whole.distribution.excursion().conservation_defect(
                whole.distribution.discretisation()) < 1e-10);
    }
  }
}

TEST_CASE("bias: the spectrum at 0 is that of odd functions where there is symmetry") {
  for (const auto& s : sample_scenes()) {
    Solved symmetry_reduced(test::on_hp(s, 8)), whole(test::on_hp(biased(s, kNothing), 8));
    const auto reduced = quantities::reduced_spectrum(symmetry_reduced.systems,
                                                      symmetry_reduced.distribution, {}, 1e-12)
                             .spectrum.at_zero;
    CHECK(relative_difference(spectrum_at_zero(whole), reduced.value) < 1e-10);
  }
}

TEST_CASE("bias: mirror images mirror", "[long]") {
  for (double bias : {0.1, 0.7, 1.6}) {
    const auto s = scene(1, 0.7, 1, 0.25, {1, 0});
    Solved up(test::on_hp(biased(s, bias), 7)), down(test::on_hp(biased(s, -bias), 7));
    const auto rising = scalars(up), falling = scalars(down);
    for (const auto& [key, value] : rising) {
      INFO(key);
      CHECK(relative_difference(falling.at(key), key == "E_V" ? -value : value) < 1e-11);
    }
    CHECK(rising.at("E_V") > 0);
    CHECK(relative_difference(spectrum_at_zero(up), spectrum_at_zero(down)) < 1e-10);
  }
}

// d/dt V^2/2 has mean 0.
TEST_CASE("bias: the power put in is dissipated") {
  for (double bias : {0.1, 0.5, 1.5}) {
    const auto s = scene(1, 0.6, 1, 0.25, {0.8, 0});
    const Solved solved(test::on_hp(biased(s, bias), 10));
    const auto v = scalars(solved);
    const double in = v.at("E_XV") + bias * v.at("E_V");
    const double out = 0.6 * v.at("E_absV") + 0.8 * v.at("E_V2");
    CHECK(relative_difference(in, out) < 1e-9);
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

// The null vector of the whole generator shares only the rates with the excursions.
TEST_CASE("bias: the excursions agree with the null vector") {
  for (const auto& base : sample_scenes()) {
    for (double bias : {0.1, -0.3}) {
      const auto s = biased(base, bias);
      const auto d = test::on_upwind(s, 3);
      cases::Case r;
      r.scene = s;
      r.question.quantities = {cases::Quantity::sticking, cases::Quantity::moments};
      linalg::SolverStatistics statistics;
      const auto evaluate = [&](cases::Route route) {
        r.method.route = route;
        return run::evaluate({PETSC_COMM_WORLD, r, d, statistics}).results;
      };
      const auto excursions = evaluate(cases::Route::excursion);
      std::map<std::string, double> found;
      for (const auto& result : evaluate(cases::Route::null_vector)) {
        found[result.key] = result.value[0];
      }
      for (const auto& result : excursions) {
        INFO(result.key << " bias " << bias);
        CHECK(relative_difference(found.at(result.key), result.value[0]) < 1e-7);
      }
    }
  }
}

// White noise and no drag: the density is proportional to exp(g v - mu |v|), and E[V] tends to
// 2 g/(mu^2 - g^2) as tau falls, with an error of the first order.
TEST_CASE("bias: the drift in white noise") {
  const double mu = 1, bias = 0.5, limit = 2 * bias / (mu * mu - bias * bias);
  std::vector<double> gap;
  for (double tau : {0.1, 0.05, 0.025}) {
    const auto s = biased(scene(mu, mu, tau, 1, {0, 0}), bias);
    gap.push_back(limit - scalars(Solved(test::on_hp(s, 8)))["E_V"]);
  }
  CHECK(gap[0] > gap[1]);
  CHECK(std::abs(2 * gap[2] - gap[1]) < 0.05 * gap[1]);
  CHECK(gap[2] < 0.02 * limit);
}
