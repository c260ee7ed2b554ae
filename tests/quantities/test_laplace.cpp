#include <numeric>

#include "../common/catch.hpp"
#include "../common/near.hpp"
#include "../common/scenes.hpp"
#include "stickslip/generator/static_chain.hpp"
#include "stickslip/quantities/durations.hpp"
#include "stickslip/quantities/engines/excursions.hpp"
#include "stickslip/run/routes.hpp"

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
    const auto t = quantities::duration_transforms(systems_, distribution_, lambda);
    systems_.release({lambda, generator::Symmetry::even});
    return {t.slide, quantities::stick_transform(systems_.process(), lambda, entry), t.excursion};
  }
  [[nodiscard]] const quantities::Excursion& means() const { return distribution_.excursion(); }

 private:
  linalg::SolverStatistics statistics_;
  Systems systems_;
  quantities::StationaryDistribution distribution_;
};

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
