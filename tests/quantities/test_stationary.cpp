#include <cmath>
#include <numeric>

#include "../common/catch.hpp"
#include "../common/full_grid.hpp"
#include "../common/near.hpp"
#include "stickslip/generator/velocity_methods.hpp"
#include "stickslip/quantities/density.hpp"
#include "stickslip/quantities/engines/excursions.hpp"
#include "stickslip/run/discretise.hpp"

using namespace stickslip;
using generator::Systems;
using quantities::StationaryDistribution;
using test::relative_difference;

namespace {

model::Scene scene(double mu_s, double mu_d, double tau, double delta, model::Drag drag) {
  model::Scene s;
  s.friction = {mu_s, mu_d};
  s.tau = tau;
  s.delta = delta;
  s.drag = drag;
  return s;
}

double sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

double moment(const StationaryDistribution& distribution, const char* key) {
  quantities::Results results;
  quantities::append_sticking(distribution.excursion(), results);
  quantities::append_moments(distribution.discretisation(), distribution.excursion(), results);
  for (const auto& r : results) {
    if (r.key == key) return r.value[0];
  }
  throw std::invalid_argument(key);
}

StationaryDistribution solve(const model::Scene& s, const run::Resolution& resolution) {
  linalg::SolverStatistics statistics;
  Systems systems(PETSC_COMM_WORLD, run::discretise(s, resolution), statistics);
  StationaryDistribution distribution(systems);
  distribution.orient(systems);
  return distribution;
}

const std::vector<model::Scene>& sample_scenes() {
  static const std::vector<model::Scene> scenes{
      scene(1, 0.25, 1, 0.25, {1, 0}),  scene(1, 1, 1, 0.5, {1, 0}),
      scene(1, 1, 1, 0.5, {0, 0}),      scene(0.3, 0.3, 1, 0.1, {1, 0}),
      scene(0.7, 0.4, 4, 0.25, {2, 1}), scene(0.2, 0.1, 0.25, 0.5, {0.1, 0})};
  return scenes;
}

std::vector<run::Resolution> sample_resolutions(const model::Scene& s) {
  return {run::hp_resolution(s, 2, 0, 1e-6),
          run::hp_resolution(s, 7, 0, 1e-10),
          run::hp_resolution(s, 7, 0, 1e-10, {}, {2, 6}),
          run::hp_resolution(s, 7, 0, 1e-10, {}, {5}),
          run::upwind_resolution(s, 1, 1e-6),
          run::upwind_resolution(s, 8, 1e-8)};
}

}  // namespace

// The symmetry-reduced excursion against the whole grid of the paper: no symmetry reduction, no
// excursions, no PETSc.
TEST_CASE(
    "stationary distribution: upwind equals the null vector of the generator on both branches") {
  struct Case {
    double mu_s, mu_d, delta;
    int levels, points;
    model::Drag drag;
  };
  for (const auto& c : {Case{1, 0.25, 0.5, 5, 3, {1, 0}}, Case{0.4, 0.4, 0.5, 4, 5, {1, 0}},
                        Case{1, 1, 0.5, 5, 2, {1, 0.5}}, Case{0.9, 0.6, 0.5, 4, 2, {3, 0}}}) {
    const model::Process process{{1, c.delta, c.levels}, {c.mu_s, c.mu_d}, c.drag};
    const double spacing = c.delta / c.points;
    const double end = process.drag.terminal_velocity(process.net_force(c.levels));
    const int nodes = static_cast<int>(std::ceil(end / spacing * (1 - 1e-12)));
    const test::FullGrid grid(process, spacing, nodes);
    const auto pi = grid.stationary();
    double stick = 0, square = 0;
    grid.for_each([&](int i, int j, double v, std::size_t state) {
      if (grid.is_static(i, j)) stick += pi[state];
      square += pi[state] * v * v;
    });

    linalg::SolverStatistics statistics;
    const auto velocities =
        std::make_shared<generator::UpwindDiscretisation>(spacing, nodes, process.drag);
    Systems systems(PETSC_COMM_WORLD, {process, velocities}, statistics);
    StationaryDistribution distribution(systems);
    distribution.orient(systems);
    CHECK(relative_difference(moment(distribution, "P_stick"), stick) < 1e-11);
    CHECK(relative_difference(moment(distribution, "E_V2"), square) < 1e-11);

    quantities::Results entry;
    quantities::append_hitting_distribution(process, distribution.excursion(), entry);
    const int k = process.highest_static();
    for (int i = -k; i <= k; ++i) {
      const double expected = grid.mean_at_rest([&](int at) { return at == i ? 1.0 : 0.0; });
      CHECK(entry[0].value[i + k] == Approx(expected).epsilon(1e-10).margin(1e-14));
    }
  }
}

TEST_CASE("stationary distribution: sliding ends somewhere, and X keeps its own", "[parallel]") {
  for (const auto& s : sample_scenes()) {
    for (const auto& resolution : sample_resolutions(s)) {
      const auto distribution = solve(s, resolution);
      INFO("mu_d " << s.friction.mu_d << " degree " << resolution.degree << " p "
                   << resolution.points);
      CHECK(std::abs(sum(distribution.excursion().entry) - 1) < 1e-11);
      CHECK(distribution.excursion().conservation_defect(distribution.discretisation()) < 1e-11);
      const auto marginal =
          marginal_of_noise(distribution.discretisation(), distribution.excursion());
      const auto noise = model::stationary_distribution(distribution.process().noise);
      for (std::size_t n = 0; n < noise.size(); ++n) {
        CHECK(marginal[n] == Approx(noise[n]).epsilon(1e-10).margin(1e-14));
      }
    }
  }
}

// pi(L f) = 0 for f = v on the sliding states: E[XV] = mu_d E|V| - E[b(V) V].
TEST_CASE("stationary distribution: power put in by the noise equals power dissipated",
          "[parallel]") {
  for (const auto& s : sample_scenes()) {
    if (s.drag.cubic > 0) continue;  // would need E[V^4]
    const auto distribution = solve(s, run::hp_resolution(s, 13, 0, 1e-15));
    const double dissipated = s.friction.mu_d * moment(distribution, "E_absV") +
                              s.drag.linear * moment(distribution, "E_V2");
    CHECK(relative_difference(moment(distribution, "E_XV"), dissipated) < 1e-11);
  }
}

TEST_CASE("density: integrates to the distribution it came from", "[parallel][long]") {
  const auto s = scene(1, 0.25, 1, 0.25, {1, 0});
  for (const auto& resolution : sample_resolutions(s)) {
    const auto distribution = solve(s, resolution);
    const auto field = quantities::density_field(distribution);
    const auto& weights = field.weights;
    REQUIRE(weights.size() == field.pdf.v().size());
    CHECK(std::is_sorted(field.pdf.v().begin(), field.pdf.v().end()));
    double sliding = 0;
    for (std::size_t j = 0; j < field.pdf.v().size(); ++j) {
      sliding += weights[j] * field.velocity_marginal[j];
    }
    const auto& velocities = *distribution.discretisation().velocities;
    CHECK(field.cells.size() == 2 * velocities.cells().size() - 1);
    CHECK(std::is_sorted(field.cells.begin(), field.cells.end()));
    CHECK(field.cells.front() == -field.cells.back());
    CHECK_FALSE(std::signbit(field.cells[field.cells.size() / 2]));
    // No value is below the one reported.
    for (double value : field.pdf.local_rows()) CHECK(value >= field.least);
    CHECK(field.least <= 0);
    const double stick = sum(field.atom);
    CHECK(stick == Approx(moment(distribution, "P_stick")).epsilon(1e-12));
    if (distribution.discretisation().velocities->keeps_origin())
      continue;  // its states at v = 0 are no density
    CHECK(sliding + stick + field.truncated_mass == Approx(1).epsilon(1e-11));
    // Each row integrates to P(X = x_i) less its atom, from both branches.
    for (std::size_t r = 0; r < field.pdf.local_levels().size(); ++r) {
      const std::size_t level = field.pdf.local_levels()[r];
      double mass = field.atom[level];
      for (std::size_t j = 0; j < field.pdf.v().size(); ++j) {
        mass += weights[j] * field.pdf.local_rows()[r * field.pdf.v().size() + j];
      }
      CHECK(mass == Approx(field.noise_marginal[level]).epsilon(1e-10).margin(1e-13));
    }
  }
}
