#include <numeric>

#include "../common/catch.hpp"
#include "../common/near.hpp"
#include "../common/scenes.hpp"
#include "stickslip/generator/static_chain.hpp"
#include "stickslip/quantities/durations.hpp"
#include "stickslip/quantities/engines/excursions.hpp"
#include "stickslip/run/fluid_queue.hpp"

using namespace stickslip;
using generator::Systems;
using quantities::DurationTransforms;
using quantities::Uncertain;
using test::relative_difference;
using test::scene;

namespace {

/// The transforms of one discretisation.
class Durations {
 public:
  explicit Durations(const test::Discrete& d)
      : systems_(PETSC_COMM_WORLD, d, statistics_), distribution_(systems_) {}

  [[nodiscard]] DurationTransforms at(double lambda) {
    std::vector<Uncertain> entry;
    for (double p : distribution_.excursion().entry) entry.push_back({p, 0});
    const auto t = quantities::sliding_transforms(systems_, distribution_, lambda);
    systems_.release({lambda, generator::Symmetry::even});
    return {t.slide, quantities::stick_transform(systems_.process(), lambda, entry), t.excursion};
  }
  [[nodiscard]] const quantities::Excursion& means() const { return distribution_.excursion(); }

 private:
  linalg::SolverStatistics statistics_;
  Systems systems_;
  quantities::StationaryDistribution distribution_;
};

const std::vector<model::Scene>& sample_scenes() {
  static const std::vector<model::Scene> scenes{
      scene(1, 0.25, 1, 0.25, {1, 0}), scene(1, 1, 1, 0.5, {0, 0}),
      scene(0.7, 0.4, 4, 0.25, {2, 1}), scene(0.2, 0.1, 0.25, 0.5, {0.1, 0})};
  return scenes;
}

std::vector<test::Discrete> sample_discretisations() {
  std::vector<test::Discrete> all;
  for (const auto& s : sample_scenes()) {
    all.push_back(test::on_hp(s, 7, 1e-10));
    all.push_back(test::on_upwind(s, 3));
  }
  return all;
}

// Durations without drag, with nothing of the discretisations in v.
DurationTransforms exact_transforms(const model::Process& process, double lambda) {
  const run::FluidQueue queue(process), killed(process, lambda);
  const auto sticking =
      generator::StaticChain(process.noise, process.highest_static(), lambda).exit_transform();
  const auto dot = [&](const std::vector<double>& p) {
    return Uncertain{std::inner_product(p.begin(), p.end(), sticking.begin(), 0.0), 0};
  };
  const auto& ends = killed.plus().entry;
  return {{std::accumulate(ends.begin(), ends.end(), 0.0), 0}, dot(queue.plus().entry), dot(ends)};
}

constexpr Uncertain DurationTransforms::*kAll[] = {
    &DurationTransforms::slide, &DurationTransforms::stick, &DurationTransforms::excursion};

}  // namespace

TEST_CASE("laplace: every sliding phase, sticking phase and excursion ends", "[parallel]") {
  for (const auto& d : sample_discretisations()) {
    const auto at_zero = Durations(d).at(0);
    for (const auto member : kAll) CHECK(std::abs((at_zero.*member).value - 1) < 1e-11);
  }
}

// Two differences (1 - F(h))/h, extrapolated to h = 0: the error is of the order of h^2.
TEST_CASE("laplace: the slope at 0 is the mean", "[parallel]") {
  for (const auto& d : sample_discretisations()) {
    Durations durations(d);
    const auto& means = durations.means();
    const std::vector<double> known{means.mean_slide(), means.mean_stick(), means.mean_excursion()};
    const double h = 1e-4 / means.mean_excursion();
    const auto coarse = durations.at(h), fine = durations.at(h / 2);
    for (std::size_t n = 0; n < known.size(); ++n) {
      const double slope = (1 - (coarse.*kAll[n]).value) / h;
      const double closer = (1 - (fine.*kAll[n]).value) / (h / 2);
      CHECK(relative_difference(2 * closer - slope, known[n]) < 1e-5);
    }
  }
}

TEST_CASE("laplace: transforms fall with lambda and stay positive") {
  for (const auto& d : sample_discretisations()) {
    Durations durations(d);
    auto before = durations.at(0);
    for (double lambda : {0.01, 1.0, 30.0}) {
      const auto now = durations.at(lambda);
      for (const auto member : kAll) {
        CHECK((now.*member).value < (before.*member).value);
        CHECK((now.*member).value > 0);
      }
      before = now;
    }
  }
}

// Only excursions much shorter than usual count: values of 1e-30, right relative to their size. The
// layer of thickness |B|/lambda at v = 0 takes more elements than the mesh has by itself.
TEST_CASE("laplace: transforms of large lambda have the accuracy of their own size") {
  const double lambda = 1e4;
  for (const auto& s : {scene(1, 0.25, 1, 0.25, {0, 0}), scene(1, 1, 1, 0.5, {1, 0})}) {
    const auto on_layers = [&](int degree) {
      return run::discretise(s, run::hp_resolution(s, degree, 16, 1e-12, {lambda, 0}));
    };
    const auto fine = on_layers(12);
    const auto found = Durations(on_layers(10)).at(lambda), finer = Durations(fine).at(lambda);
    for (const auto member : kAll) {
      CHECK((finer.*member).value < 1e-3);
      CHECK(relative_difference((found.*member).value, (finer.*member).value) < 1e-9);
      if (s.drag.bounds_velocity()) continue;
      const double known = (exact_transforms(fine.process, lambda).*member).value;
      CHECK(relative_difference((finer.*member).value, known) < 1e-9);
    }
  }
}
