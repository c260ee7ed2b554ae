#include "stickslip/quantities/density.hpp"

#include "stickslip/petsc/vectors.hpp"

namespace stickslip::quantities {
namespace {

std::vector<double> atoms(const StationaryLaw& law) {
  const int n = law.process().noise.levels, k = law.process().static_index();
  const auto& stick = law.excursion().stick_time;
  std::vector<double> atom(2 * static_cast<std::size_t>(n) + 1, 0.0);
  for (int i = -k; i <= k; ++i) {
    atom[n + i] = (stick[k + i] + stick[k - i]) / (2 * law.excursion().mean_excursion());
  }
  return atom;
}

// V < 0 on level -i mirrors V > 0 on level i, of which half the folded mass is.
PhaseField pdf_of(const StationaryLaw& law) {
  PhaseField pdf(law.process(), law.axis(), law.states());
  const double scale = 1 / (2 * law.excursion().mean_excursion());
  const petsc::ReadView local(law.occupation());
  PetscInt at = 0;
  law.states().for_each_local([&](const operators::State& state) {
    const double mass = PetscRealPart(local[at++]) * scale;
    if (state.kind == operators::StateKind::holding) return;
    // The node of a state at the origin is 0.
    pdf.add(state.level, state.node, mass / law.axis().weights()[state.node], 1);
  });
  return pdf;
}

}  // namespace

DensityField density_field(const StationaryLaw& law) {
  const auto& axis = law.axis();
  const std::size_t nodes = axis.size();
  DensityField field{
      pdf_of(law), atoms(law), marginal_of_noise(law.process(), law.excursion()), {}, 0};
  const auto speed = law.speed_law();
  field.cut_mass = speed.at_top;
  field.velocity_marginal.resize(2 * nodes);
  for (std::size_t j = 0; j < nodes; ++j) {
    const double density = speed.mass[j] / (2 * axis.weights()[j]);
    field.velocity_marginal[nodes + j] = field.velocity_marginal[nodes - 1 - j] = density;
  }
  return field;
}

}  // namespace stickslip::quantities
