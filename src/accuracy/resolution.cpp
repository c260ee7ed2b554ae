#include "stickslip/accuracy/resolution.hpp"

#include <fmt/format.h>
#include <petscsys.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "stickslip/petsc/memory.hpp"
#include "stickslip/petsc/session.hpp"
#include "stickslip/support/errors.hpp"
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

bool by_elements(const Resolution& r) {
  if (r.scheme != options::Scheme::hp) return false;
  const bool own = r.factors == options::Factors::own &&
                   operators::suits_elements(r.noise_nodes(), r.noise == nullptr) &&
                   petsc::ranks(PETSC_COMM_WORLD) == 1;
  return own || r.factors == options::Factors::elements;
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

// Groups keep what stands for each of their levels.
std::shared_ptr<const noise::Nodes> grouped(const model::Process& process,
                                            const noise::Grouping& grouping) {
  if (grouping.degree == 0) return nullptr;
  const double levels = 2.0 * process.noise.levels + 1;
  const double need = 24 * levels * (grouping.degree + 2);
  if (need > petsc::available_bytes(PETSC_COMM_SELF, need)) {
    throw NoMemory(fmt::format("{:.3g} noise levels would need {:.2g} GB of memory; take fewer "
                               "-noise_levels or a larger -delta",
                               levels, need / 1e9));
  }
  return std::make_shared<noise::Nodes>(process, grouping);
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
                         const velocity::Rates& rates, const noise::Grouping& grouping) {
  Resolution r;
  r.scheme = options::Scheme::hp;
  r.degree = degree;
  r.rates = rates;
  r.levels = scene.noise_levels.value_or(levels_for(scene, tolerance));
  r.v_max = velocity_end(scene, r.levels, tolerance);
  r.layers = layers > 0 ? layers : velocity::natural_layers(scene.process(r.levels), mesh_rule(r));
  r.grouping = grouping;
  r.noise = grouped(scene.process(r.levels), grouping);
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

operators::Discretisation discretise(const model::Scene& scene, const Resolution& resolution) {
  std::shared_ptr<velocity::Axis> axis;
  if (resolution.scheme != options::Scheme::none) {
    axis = axis_of(scene, resolution, scene.drag);
    if (!scene.drag.odd()) axis->set_mirrored(axis_of(scene, resolution, scene.drag.mirrored()));
  }
  return {scene.process(resolution.levels), std::move(axis), resolution.noise};
}

std::int64_t unknowns(const model::Scene& scene, const Resolution& resolution) {
  double nodes = 1;
  if (resolution.scheme == options::Scheme::hp) {
    const auto degrees = hp_degrees(scene, resolution);
    nodes = std::accumulate(degrees.begin(), degrees.end(), static_cast<double>(degrees.size()));
  } else if (resolution.scheme == options::Scheme::upwind) {
    nodes = upwind_nodes(scene, resolution);
  }
  const double total = static_cast<double>(resolution.noise_nodes()) * nodes * resolution.halves;
  constexpr double most = 9e18;
  return static_cast<std::int64_t>(std::min(total, most));
}

// Entries of the factors: by elements what ElementElimination counts, about; by MUMPS 2.7 to 3.2 n
// n_v (n unknowns, n_v of them on a noise node) on hp axes with all levels. The upwind matrix is a
// two-dimensional grid to MUMPS, where the shorter side m decides: 4.5 n m^0.52 entries were
// counted for m = 65 ... 257. MUMPS takes 9 to 12 bytes a real entry; the matrix, its magnitudes
// and MUMPS's copy come on top.
double predicted_bytes(const model::Scene& scene, const Resolution& resolution) {
  const auto n = static_cast<double>(unknowns(scene, resolution));
  const auto noise = static_cast<double>(resolution.noise_nodes());
  const double nodes = n / noise;
  const double scalars = petsc::complex_scalars() ? 2 : 1;
  if (resolution.scheme == options::Scheme::none) {
    constexpr double dense_matrices = 30;
    return 8 * dense_matrices * n * n;
  }
  const bool upwind = resolution.scheme == options::Scheme::upwind;
  const double degree = resolution.degree;
  const double row = upwind ? 4 : degree + 2.0 * resolution.grouping.degree + 6;
  const double factors =
      upwind ? 12 * 4.5 * n * std::pow(std::min(noise, nodes), 0.52) : 10 * 3.0 * n * nodes;
  if (by_elements(resolution)) {
    const double elements = nodes / std::max(1.0, degree - 1);
    const double inside = (resolution.grouping.degree + 4) * degree * n;
    return scalars * (8 * (1.4 * elements * noise * noise + inside) + 40 * row * n);
  }
  switch (resolution.factors) {
  case options::Factors::own:
  case options::Factors::elements:
  case options::Factors::in_memory: return scalars * (factors + 60 * row * n);
  case options::Factors::on_disk: return scalars * (0.3 * factors + 60 * row * n);
  case options::Factors::incomplete: break;
  }
  return scalars * 120 * row * n;
}

double relative_work(const model::Scene& scene, const Resolution& resolution) {
  const auto n = static_cast<double>(unknowns(scene, resolution));
  const auto noise = static_cast<double>(resolution.noise_nodes());
  if (resolution.scheme == options::Scheme::none) return n * n * n;
  const double nodes = n / noise, band = std::min(noise, nodes);
  if (resolution.scheme == options::Scheme::upwind) return n * band;
  return by_elements(resolution) ? n * noise * noise / resolution.degree : n * nodes * band;
}

}  // namespace stickslip::accuracy
