#include "stickslip/quantities/density.hpp"

#include <algorithm>
#include <cstdlib>

#include "stickslip/petsc/vectors.hpp"

namespace stickslip::quantities {
namespace {

std::vector<double> both_signs(std::span<const double> nodes) {
  std::vector<double> v(nodes.begin(), nodes.end());
  std::transform(nodes.begin(), nodes.end(), v.begin(), [](double node) { return -node; });
  std::reverse(v.begin(), v.end());
  v.insert(v.end(), nodes.begin(), nodes.end());
  return v;
}

std::vector<double> atoms(const StationaryLaw& law) {
  const int n = law.process().noise.levels, k = law.process().static_index();
  const auto& stick = law.excursion().stick_time;
  std::vector<double> atom(2 * static_cast<std::size_t>(n) + 1, 0.0);
  for (int i = -k; i <= k; ++i) {
    atom[n + i] = (stick[k + i] + stick[k - i]) / (2 * law.excursion().mean_excursion());
  }
  return atom;
}

// Rows of the levels of this rank. V < 0 on level -i mirrors V > 0 on level i, of which half the
// folded mass is.
void fill_rows(const StationaryLaw& law, DensityField& field) {
  field.local_levels = law.states().local_levels();
  const std::size_t nodes = law.axis().size(), width = 2 * nodes;
  const std::size_t count = field.local_levels.size();
  field.local_rows.assign(count * width, 0.0);
  const double scale = 1 / (2 * law.excursion().mean_excursion());
  const auto row_of = [&](int level) {
    const auto& levels = field.local_levels;
    return static_cast<std::size_t>(std::lower_bound(levels.begin(), levels.end(), level) -
                                    levels.begin());
  };
  const petsc::ReadView local(law.occupation());
  PetscInt at = 0;
  law.states().for_each_local([&](const operators::State& state) {
    const double mass = PetscRealPart(local[at++]) * scale;
    if (state.kind == operators::StateKind::holding) return;
    const auto j = static_cast<std::size_t>(state.node);  // 0 for a state at the origin
    const double density = mass / law.axis().weights()[j];
    field.local_rows[row_of(state.level) * width + nodes + j] += density;
    field.local_rows[row_of(-state.level) * width + nodes - 1 - j] += density;
  });
}

}  // namespace

DensityField density_field(const StationaryLaw& law) {
  const auto& axis = law.axis();
  const int n = law.process().noise.levels;
  const std::size_t nodes = axis.size();
  DensityField field;
  for (int i = -n; i <= n; ++i) field.x.push_back(law.process().noise.level(i));
  field.v = both_signs(axis.nodes());
  field.atom = atoms(law);
  field.noise_marginal = marginal_of_noise(law.process(), law.excursion());
  const auto speed = law.speed_law();
  field.cut_mass = speed.at_top;
  field.velocity_marginal.resize(2 * nodes);
  for (std::size_t j = 0; j < nodes; ++j) {
    const double density = speed.mass[j] / (2 * axis.weights()[j]);
    field.velocity_marginal[nodes + j] = field.velocity_marginal[nodes - 1 - j] = density;
  }

  fill_rows(law, field);
  return field;
}

}  // namespace stickslip::quantities
