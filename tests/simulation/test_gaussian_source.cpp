#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "../common/catch.hpp"
#include "../common/tallies.hpp"
#include "stickslip/simulation/tally.hpp"

using namespace stickslip;
using cases::Quantity;
using model::CovarianceTerm;
using simulation::Sampler;
using simulation::Tally;
using test::estimate;

namespace {

const cases::Question kQuestion{
    .quantities = {Quantity::sticking, Quantity::moments, Quantity::noise_law}};

model::Process process(const std::vector<CovarianceTerm>& terms, const model::Friction& friction,
                       const model::Drag& drag = {}, double bias = 0) {
  model::Scene scene;
  scene.noise.gaussian = std::make_shared<const model::GaussianNoise>(terms);
  scene.friction = friction;
  scene.drag = drag;
  scene.bias = bias;
  return scene.process(2);
}

Tally simulated(const model::Process& process, int batches) {
  Tally all(kQuestion, process);
  Sampler sampler(kQuestion, process);
  for (int n = 0; n < batches; ++n)
    all.merge(sampler.batch(11, static_cast<std::uint64_t>(n), 256).pack());
  return all;
}

/// In standard deviations, beside what steps leave.
double deviations(const Tally& tally, const std::string& key, double value) {
  const auto e = estimate(tally, key);
  const double half = e.high - e.value - simulation::kStepError * std::abs(e.value);
  return 1.96 * (e.value - value) / half;
}

void require_values(const Tally& tally, const std::map<std::string, double>& values) {
  for (const auto& [key, value] : values) {
    INFO(key << " " << estimate(tally, key).value << ", not " << value);
    CHECK(std::abs(deviations(tally, key, value)) < 4);
  }
}

}  // namespace

// From the solution by functions of the force and Hermite polynomials across, with six digits.
TEST_CASE("Gaussian source: values of continuous noise", "[simulation]") {
  const auto ou = simulated(process({{1, 1}}, {1, 0.25}), 12);
  require_values(ou, {{"P_stick", 0.120597042},
                      {"mean_slide", 3.08129985},
                      {"mean_stick", 0.42255446},
                      {"E_V2", 0.309715092},
                      {"E_absV", 0.403834491},
                      {"E_XV", 0.41067371}});
  CHECK(std::abs(deviations(simulated(process({{1, 1.3}}, {1, 0.25}), 12), "E_V2", 0.309715)) > 4);
  require_values(simulated(process({{1, 0.5, 2}}, {1, 0.5}), 8), {{"P_stick", 0.265795},
                                                                  {"mean_slide", 1.62506},
                                                                  {"mean_stick", 0.5883},
                                                                  {"E_absV", 0.2063539}});
  require_values(simulated(process({{0.5, 0.5}, {0.3, 2}, {0.2, 6}}, {1, 0.5}), 4),
                 {{"P_stick", 0.19252}, {"mean_slide", 1.15306}, {"E_V2", 0.154493}});
  // In these coordinates the covariance of Z is not 1.
  require_values(simulated(process({{1, 0.5, 3}, {0.49, 1}}, {1, 0.5}), 6),
                 {{"E_V2", 0.16303}, {"E_absV", 0.27915}, {"E_XV", 0.30261}, {"E_X2", 1.49}});
}

TEST_CASE("Gaussian source: where friction balances the force", "[simulation]") {
  require_values(simulated(process({{1, 1}}, {1, 1}), 5),
                 {{"P_stick", 0.516134}, {"E_V2", 0.0496223}, {"E_absV", 0.09979207}});
}

TEST_CASE("Gaussian source: a bias is a shift of the thresholds", "[simulation]") {
  model::Friction friction{1, 0.4};
  friction.mu_s_minus = 1.3;
  friction.mu_d_minus = 0.6;
  const auto found = simulated(process({{1, 1}}, friction, {1, 0.3}, 0.2), 8);
  model::Friction shifted{0.8, 0.2};
  shifted.mu_s_minus = 1.5;
  shifted.mu_d_minus = 0.8;
  const auto same = simulated(process({{1, 1}}, shifted, {1, 0.3}), 8);
  for (const char* key : {"P_stick", "E_V2", "E_V", "mean_slide"}) {
    INFO(key);
    CHECK(estimate(found, key).value == Approx(estimate(same, key).value).epsilon(1e-6));
  }
}

TEST_CASE("Gaussian source: a batch does not depend on those before", "[simulation]") {
  const auto p = process({{1, 0.5, 2}}, {1, 0.5});
  Sampler one(kQuestion, p), other(kQuestion, p);
  static_cast<void>(one.batch(3, 0, 7));
  CHECK(one.batch(3, 5, 9).pack() == other.batch(3, 5, 9).pack());
}
