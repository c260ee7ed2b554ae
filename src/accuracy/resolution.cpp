#include "stickslip/accuracy/resolution.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "stickslip/petsc/session.hpp"
#include "stickslip/velocity/hp_axis.hpp"
#include "stickslip/velocity/mesh.hpp"
#include "stickslip/velocity/upwind_axis.hpp"

namespace stickslip::accuracy {
namespace {

velocity::MeshRule mesh_rule(const Resolution& resolution) {
  velocity::MeshRule rule;
  rule.v_max = resolution.v_max;
  rule.layers = resolution.layers;
  rule.rates = resolution.rates;
  return rule;
}

// Number of nodes of the upwind axis: the first at or beyond v_max is its last.
double upwind_nodes(const model::Scene& scene, const Resolution& resolution) {
  const double ratio = resolution.v_max * resolution.points / scene.delta;
  return std::max(1.0, std::ceil(ratio * (1 - 1e-12)));
}

std::vector<int> hp_degrees(const model::Scene& scene, const Resolution& resolution) {
  return velocity::element_degrees(scene.process(resolution.levels), mesh_rule(resolution),
                                   resolution.degree);
}

// Exponential tilt of the law of X, per unit of x, that comes with large velocities: without drag
// the velocity decays at the rate mu_d and X conditioned on it is shifted by up to twice mu_d
// (less where mu_d exceeds the noise, of standard deviation 1/sqrt(tau)). Drag that saturates adds
// to mu_d.
double tilt(const model::Scene& scene) {
  const double mu_d = scene.friction.mu_d;
  const double drag_time = -scene.drag.slope_at_rest() / (mu_d * mu_d);
  const double most = 1 / std::sqrt(scene.tau);
  if (scene.drag.law && !scene.drag.bounds_velocity()) return 2 * scene.tau * most;
  if (drag_time > 1) return 0;
  return 2 * scene.tau * std::min(mu_d, most);
}

std::shared_ptr<velocity::Axis> axis_of(const model::Scene& scene, const Resolution& resolution,
                                        const model::Drag& drag) {
  if (resolution.scheme == options::Scheme::upwind) {
    const double spacing = scene.delta / resolution.points;
    const auto count = static_cast<int>(upwind_nodes(scene, resolution));
    return std::make_shared<velocity::UpwindAxis>(spacing, count, drag);
  }
  const auto ends = velocity::element_ends(scene.process(resolution.levels), mesh_rule(resolution));
  return std::make_shared<velocity::HpAxis>(ends, hp_degrees(scene, resolution), drag);
}

}  // namespace

int levels_for(const model::Scene& scene, double tolerance) {
  const int full = scene.full_levels();
  const model::NoiseChain chain{scene.tau, scene.delta, full};
  const int first = scene.friction.static_index(scene.delta, -std::abs(scene.bias)) + 1;
  const double shift = tilt(scene) * scene.delta;
  double log_weight = 0;  // of level i against level `first`
  int i = first;
  while (i < full && log_weight > std::log(tolerance)) {
    ++i;
    log_weight += std::log(model::weight_ratio(chain, i)) + shift + 2 * std::log1p(1.0 / (i - 1));
  }
  return i;
}

double velocity_end(const model::Scene& scene, int levels, double tolerance) {
  const auto process = scene.process(levels), mirrored = process.mirrored();
  const double terminal = std::max(process.drag.terminal_velocity(process.excess(levels)),
                                   mirrored.drag.terminal_velocity(mirrored.excess(levels)));
  if (scene.v_max) return std::min(*scene.v_max, terminal);
  const double tail = velocity::tail_velocity(process, tolerance);
  // Holding states cost a little: a cut must save something.
  return tail < 0.8 * terminal ? tail : terminal;
}

Resolution hp_resolution(const model::Scene& scene, int degree, int layers, double tolerance,
                         const velocity::Rates& rates) {
  Resolution r;
  r.scheme = options::Scheme::hp;
  r.degree = degree;
  r.rates = rates;
  r.levels = scene.noise_levels.value_or(levels_for(scene, tolerance));
  r.v_max = velocity_end(scene, r.levels, tolerance);
  r.layers = layers > 0 ? layers : velocity::natural_layers(scene.process(r.levels), mesh_rule(r));
  return r;
}

Resolution upwind_resolution(const model::Scene& scene, int points, double tolerance) {
  Resolution r;
  r.scheme = options::Scheme::upwind;
  r.points = points;
  r.levels = scene.noise_levels.value_or(levels_for(scene, tolerance));
  r.v_max = velocity_end(scene, r.levels, tolerance);
  return r;
}

Resolution exact_resolution(const model::Scene& scene, double tolerance) {
  Resolution r;
  r.scheme = options::Scheme::none;
  r.levels = scene.noise_levels.value_or(levels_for(scene, tolerance));
  return r;
}

std::shared_ptr<const velocity::Axis> make_axis(const model::Scene& scene,
                                                const Resolution& resolution) {
  if (resolution.scheme == options::Scheme::none) return nullptr;
  auto axis = axis_of(scene, resolution, scene.drag);
  if (!scene.drag.odd()) {
    axis->set_mirrored(axis_of(scene, resolution, scene.drag.mirrored()));
  }
  return axis;
}

std::int64_t unknowns(const model::Scene& scene, const Resolution& resolution) {
  double nodes = 1;
  if (resolution.scheme == options::Scheme::hp) {
    const auto degrees = hp_degrees(scene, resolution);
    nodes = std::accumulate(degrees.begin(), degrees.end(), static_cast<double>(degrees.size()));
  } else if (resolution.scheme == options::Scheme::upwind) {
    nodes = upwind_nodes(scene, resolution);
  }
  const double total = (2.0 * resolution.levels + 1) * nodes * resolution.halves;
  constexpr double most = 9e18;
  return static_cast<std::int64_t>(std::min(total, most));
}

// Entries of the factors: by levels, 1.05 to 1.08 n n_v were counted on hp axes for delta = 1/4 ...
// 1/256 (n unknowns, n_v of them on a level), 0.6 to 0.8 where both halves are kept, and 2 on other
// axes, where nothing is triangular; by MUMPS 2.7 to 3.2 n n_v. The upwind matrix is a
// two-dimensional grid to MUMPS, where the shorter side m decides: 4.5 n m^0.52 entries were
// counted for m = 65 ... 257. MUMPS takes 9 to 12 bytes a real entry; the matrix, its magnitudes
// and MUMPS's copy come on top.
double predicted_bytes(const model::Scene& scene, const Resolution& resolution) {
  const auto n = static_cast<double>(unknowns(scene, resolution));
  const double levels = 2.0 * resolution.levels + 1;
  const double nodes = n / levels;
  const double scalars = petsc::complex_scalars() ? 2 : 1;
  if (resolution.scheme == options::Scheme::none) {
    constexpr double dense_matrices = 30;
    return 8 * dense_matrices * n * n;
  }
  const bool upwind = resolution.scheme == options::Scheme::upwind;
  const double row = upwind ? 4 : 2.0 * resolution.degree + 4;  // entries of a row of the matrix
  if (resolution.shares_factors()) {
    Resolution base = resolution;
    base.nested = false;
    --base.degree;
    return predicted_bytes(scene, base) + scalars * 200 * n;
  }
  const double factors =
      upwind ? 12 * 4.5 * n * std::pow(std::min(levels, nodes), 0.52) : 10 * 3.0 * n * nodes;
  const bool by_levels = resolution.factors == options::Factors::levels ||
                         (resolution.factors == options::Factors::own && !upwind);
  if (by_levels) {
    const double entries = upwind ? 2.0 : (resolution.halves == 2 ? 0.8 : 1.1);
    return scalars * (8 * entries * n * nodes + 40 * row * n);
  }
  switch (resolution.factors) {
  case options::Factors::p_multigrid: return scalars * 500 * n;
  case options::Factors::own:
  case options::Factors::levels:
  case options::Factors::in_memory: return scalars * (factors + 60 * row * n);
  case options::Factors::on_disk: return scalars * (0.3 * factors + 60 * row * n);
  case options::Factors::incomplete: break;
  }
  return scalars * 120 * row * n;
}

double relative_work(const model::Scene& scene, const Resolution& resolution) {
  const auto n = static_cast<double>(unknowns(scene, resolution));
  const double levels = 2.0 * resolution.levels + 1;
  if (resolution.scheme == options::Scheme::none) return n * n * n;
  const double band = std::min(levels, n / levels);
  if (resolution.scheme == options::Scheme::upwind) return n * band;
  constexpr double share_of_nested = 0.4;
  return n * (n / levels) * band * (resolution.shares_factors() ? share_of_nested : 1);
}

}  // namespace stickslip::accuracy
