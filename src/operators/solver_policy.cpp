#include "stickslip/operators/solver_policy.hpp"

#include <petscsys.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

#include "stickslip/operators/systems.hpp"
#include "stickslip/petsc/session.hpp"
#include "stickslip/petsc/solver_choice.hpp"
#include "stickslip/petsc/solver_options.hpp"

namespace stickslip::operators {
namespace {

using cases::Factors;
using cases::Scheme;

double scalar_bytes() { return petsc::complex_scalars() ? 16 : 8; }

// How many noise nodes do not rise where drag adds `drag` to their speeds.
double falling_nodes(const model::Process& process, const noise::Nodes* noise, double drag) {
  const int lowest = noise == nullptr ? process.noise.lowest() : noise->first();
  const int count = noise == nullptr ? process.noise.count() : noise->count();
  int below = lowest, above = lowest + count;  // the first that rises is in [below, above]
  while (below < above) {
    const int n = below + (above - below) / 2;
    const double x = noise == nullptr ? process.noise.level(n) : noise->x(n);
    if (process.net_force_at(x) + drag > 0) {
      above = n;
    } else {
      below = n + 1;
    }
  }
  return static_cast<double>(below) - lowest;
}

// Nodes of a group, and levels through which others jump to it.
using GroupSize = std::pair<int, int>;

// How many groups have which size.
std::map<GroupSize, double> group_sizes(const model::Process& process, const noise::Nodes* noise) {
  if (noise == nullptr && process.noise.neighbours_only()) {
    return {{{1, 1}, static_cast<double>(process.noise.count())}};
  }
  if (noise == nullptr) return group_sizes(process, std::make_unique<noise::Nodes>(process).get());
  std::map<GroupSize, double> sizes;
  for (const auto& group : noise->groups()) {
    const std::size_t border = std::max(group.at_first().size(), group.at_last().size());
    sizes[{group.count, static_cast<int>(border) / group.count}] += 1;
  }
  return sizes;
}

}  // namespace

Factors given_factors() {
  const std::string implied = petsc::implied_pc_type(kSlidePrefix);
  if (implied.empty()) return Factors::own;
  const auto value = [](const char* name) {
    return petsc::option_value(kSlidePrefix + name).value_or("");
  };
  const std::string given = value("pc_type"), pc = given.empty() ? implied : given;
  if (pc == petsc::kElementsPc) return Factors::elements;
  if (pc != "lu" && pc != "cholesky") return Factors::incomplete;
  return value("mat_mumps_icntl_22") == "1" ? Factors::on_disk : Factors::in_memory;
}

Factors chosen_factors(Factors asked, Scheme scheme, std::int64_t noise_nodes, bool all_levels,
                       bool neighbours_only) {
  if (asked != Factors::own) return asked;
  if (!neighbours_only) return scheme == Scheme::hp ? Factors::elements : Factors::in_memory;
  constexpr std::int64_t most_levels = 700;
  const bool few = !all_levels || noise_nodes <= most_levels;
  return scheme == Scheme::hp && few ? Factors::elements : Factors::in_memory;
}

const char* default_pc_type(const Discretisation& discretisation) {
  const auto& [process, noise, velocities] = discretisation;
  const bool hp = dynamic_cast<const velocity::HpDiscretisation*>(velocities.get()) != nullptr;
  const Factors factors =
      chosen_factors(Factors::own, hp ? Scheme::hp : Scheme::upwind, noise->count(),
                     noise->all_levels(), process.noise.neighbours_only());
  return factors == Factors::elements ? petsc::kElementsPc : "lu";
}

// Groups of levels begin at level 0, which need not be its own mirror.
bool branches_share_factors(const model::Process& process, bool all_levels,
                            const velocity::VelocityDiscretisation& velocities) {
  return !process.drifts() && process.noise.even_in_order() &&
         (all_levels || process.noise.symmetric()) && &velocities.mirrored() == &velocities;
}

// The blocks and couplings of groups inside of the elements, and those between elements.
FactorCost elimination_cost(const model::Process& process,
                            const velocity::HpDiscretisation& velocities, const noise::Nodes* noise,
                            int ranks) {
  const auto sizes = group_sizes(process, noise);
  const double all = noise == nullptr ? process.noise.count() : noise->count();
  double inside = 0, between = 0, operations = 0;
  double inner = falling_nodes(process, noise, velocities.drag_at_end(0));
  for (int e = 0; e < velocities.elements(); ++e) {
    const double q = velocities.element(e).reference->size;
    const double outer = falling_nodes(process, noise, velocities.drag_at_end(e + 1));
    for (const auto& [size, groups] : sizes) {
      const auto& [nodes, border] = size;
      const double n = nodes * q, b = border * q;
      inside += groups * (n * n + n * b);
      operations +=
          groups * (n * n * (2 * n / 3 + 4 * b + 2 * nodes) + (nodes == 1 ? 4 : 8) * b * b * all);
    }
    const double up = all - outer, up_inner = all - inner;
    between += up_inner * up + 2 * outer * up + outer * outer + (outer + up) * inner;
    operations += 2 * outer * (outer * up + outer * outer / 3 + outer * inner + up * inner) +
                  2 * up_inner * up * inner + 4 * q * all * all;
    inner = outer;
  }
  const double entries = inside + ranks * between;
  return {entries, scalar_bytes() * entries, operations};
}

FactorCost elimination_cost(const Discretisation& discretisation, bool symmetry_reduced,
                            int ranks) {
  const auto of = [&](const model::Process& along, const noise::Nodes& nodes,
                      const velocity::VelocityDiscretisation& side) {
    return elimination_cost(along, dynamic_cast<const velocity::HpDiscretisation&>(side), &nodes,
                            ranks);
  };
  const auto& [process, noise, velocities] = discretisation;
  FactorCost cost = of(process, *noise, *velocities);
  const bool alike = branches_share_factors(process, noise->all_levels(), *velocities);
  if (symmetry_reduced || alike) return cost;
  const FactorCost other = of(process.mirrored(), noise->mirrored(), velocities->mirrored());
  return {cost.entries + other.entries, cost.bytes + other.bytes,
          cost.operations + other.operations};
}

FactorCost sparse_cost(Factors factors, Scheme scheme, double unknowns, double noise_nodes) {
  const double nodes = unknowns / noise_nodes, shorter = std::min(noise_nodes, nodes);
  const bool upwind = scheme == Scheme::upwind;
  const double operations = unknowns * (upwind ? 1 : nodes) * shorter;
  if (factors == Factors::incomplete) return {0, 0, operations};
  const double entries = unknowns * (upwind ? 4.5 * std::pow(shorter, 0.52) : 3.0 * nodes);
  const double bytes_an_entry = (upwind ? 12 : 10) * (factors == Factors::on_disk ? 0.3 : 1);
  return {entries, scalar_bytes() / 8 * bytes_an_entry * entries, operations};
}

}  // namespace stickslip::operators
