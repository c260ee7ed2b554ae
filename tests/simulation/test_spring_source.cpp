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
using simulation::Sampler;
using simulation::Tally;
using test::estimate;

namespace {

const cases::Question kQuestion{.quantities = {Quantity::sticking, Quantity::moments}};

using Values = std::map<std::string, double>;

model::Process on_spring(model::NoiseChain noise, double mu_s, double mu_d, double drag,
                         double stiffness, double bias = 0) {
  return {std::move(noise), {mu_s, mu_d}, {drag, 0}, bias, stiffness};
}

model::NoiseChain of_levels(const std::vector<model::Level>& levels) {
  model::NoiseChain noise;
  noise.table = std::make_shared<const model::LevelTable>(levels);
  return noise;
}

Tally simulated(const model::Process& process, int batches) {
  Tally all(kQuestion, process);
  Sampler sampler(kQuestion, process);
  for (int n = 0; n < batches; ++n)
    all.merge(sampler.batch(5, static_cast<std::uint64_t>(n), 64).pack());
  return all;
}

/// The largest of all, in standard deviations, beside what steps leave.
double deviations(const Tally& tally, const Values& values) {
  double most = 0;
  for (const auto& [key, value] : values) {
    const auto e = estimate(tally, key);
    const double by_steps =
        tally.process().noise.gaussian ? simulation::kStepError * std::abs(e.value) : 0;
    const double half = e.high - e.value - by_steps, off = std::abs(e.value - value) - by_steps;
    most = std::max(most, 1.96 * off / half);
    UNSCOPED_INFO(key << " " << e.value << " +- " << half << ", not " << value);
  }
  return most;
}

model::NoiseChain telegraph(double amplitude, double rate) {
  return of_levels({{-amplitude, rate, 0}, {amplitude, 0, rate}});
}

}  // namespace

// By the program's solution for states of force, position and velocity on finer meshes, and by
// another simulation.
TEST_CASE("spring source: values of noise on levels", "[simulation]") {
  const Values two{{"P_stick", .249885}, {"mean_stick", 2},   {"mean_slide", 6.0037},
                   {"E_V2", .337178},    {"E_absV", .427981}, {"E_P2", .752678},
                   {"E_XP", .551169}};
  const auto process = on_spring(telegraph(1.5, 0.5), 1, 0.5, 1, 1);
  const auto tally = simulated(process, 20);
  CHECK(deviations(tally, two) < 4);
  CHECK(deviations(simulated(on_spring(telegraph(1.5, 0.55), 1, 0.5, 1, 1), 20), two) > 4);

  CHECK(deviations(simulated(on_spring(telegraph(1.2, 1), 1, 0.8, 0.2, 1), 8),
                   {{"P_stick", .21002},
                    {"mean_stick", 1},
                    {"mean_slide", 3.7614},
                    {"E_V2", .181014},
                    {"E_absV", .298955},
                    {"E_P2", .275659},
                    {"E_XP", .137683}}) < 4);
  CHECK(deviations(simulated(on_spring(of_levels({{-1.5, 1, 0}, {0, 0.5, 0.5}, {1.5, 0, 1}}), 1,
                                       0.5, 0.5, 1),
                             10),
                   {{"P_stick", .350535},
                    {"mean_stick", 1.81273},
                    {"mean_slide", 3.3586},
                    {"E_V2", .2829587},
                    {"E_absV", .347532},
                    {"E_P2", .651836},
                    {"E_XP", .315246}}) < 4);
  CHECK(deviations(simulated(on_spring({1, 0.5, 8}, 1, 0.5, 1, 1), 10), {{"P_stick", .31024},
                                                                         {"mean_stick", .82513},
                                                                         {"mean_slide", 1.8345},
                                                                         {"E_V2", .115713},
                                                                         {"E_absV", .217044},
                                                                         {"E_P2", .371981},
                                                                         {"E_XP", .224235}}) < 4);
}

TEST_CASE("spring source: identities", "[simulation]") {
  // The spring does no work in the mean, and E_XV = E_XP/tau; a bias shifts positions.
  const auto process = on_spring(telegraph(1.5, 0.5), 1, 0.5, 1, 4, 0.6);
  const auto tally = simulated(process, 10);
  const double power = estimate(tally, "E_XV").value;
  CHECK(
      power ==
      Approx(0.5 * estimate(tally, "E_absV").value + estimate(tally, "E_V2").value).epsilon(3e-3));
  CHECK(deviations(tally, {{"E_P", 0.15}, {"E_V", 0}}) < 4);
  const auto mirrored = simulated(process.mirrored(), 10);
  CHECK(deviations(mirrored, {{"E_P", -0.15}, {"E_P2", estimate(tally, "E_P2").value}}) < 6);
}

TEST_CASE("spring source: any drag", "[simulation]") {
  auto process = on_spring(telegraph(1.5, 0.5), 1, 0.5, 0, 1);
  process.drag = {0, 0, [](double v) { return -v; }, 4};
  CHECK(deviations(simulated(process, 2), {{"P_stick", .249885},
                                           {"mean_slide", 6.0037},
                                           {"E_V2", .337178},
                                           {"E_P2", .752678},
                                           {"E_XP", .551169}}) < 4);
}

TEST_CASE("spring source: values of continuous noise", "[simulation]") {
  const auto continuous = [](double mu_d, double drag, double stiffness, double tau) {
    auto process = on_spring({}, 1, mu_d, drag, stiffness);
    process.noise.gaussian = std::make_shared<const model::GaussianNoise>(
        std::vector<model::CovarianceTerm>{{1, 1 / tau}});
    process.noise.table = process.noise.gaussian->projected({{-1, 1}, {-mu_d, mu_d}}, 2);
    return process;
  };
  CHECK(deviations(simulated(continuous(0.5, 1, 1, 1), 4), {{"P_stick", .238315},
                                                            {"mean_stick", .476246},
                                                            {"mean_slide", 1.52215},
                                                            {"E_V2", .1171895},
                                                            {"E_absV", .222021},
                                                            {"E_P2", .373925},
                                                            {"E_XP", .2282}}) < 4);
  CHECK(deviations(simulated(continuous(0.5, 1, 25, 1), 4), {{"P_stick", .42924},
                                                             {"mean_stick", .44505},
                                                             {"mean_slide", .59177},
                                                             {"E_V2", .0067225},
                                                             {"E_absV", .047785},
                                                             {"E_P2", .0016074},
                                                             {"E_XP", .030615}}) < 4);
  CHECK(deviations(simulated(continuous(0.1, 1, 1, 1), 4), {{"P_stick", .07772},
                                                            {"mean_stick", .32902},
                                                            {"mean_slide", 3.9043},
                                                            {"E_V2", .273625},
                                                            {"E_absV", .401381},
                                                            {"E_P2", .593992},
                                                            {"E_XP", .313763}}) < 4);
}
