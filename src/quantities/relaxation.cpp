#include "stickslip/quantities/relaxation.hpp"

#include <algorithm>

#include "stickslip/case/spectrum_rows.hpp"
#include "stickslip/generator/resolvents.hpp"
#include "stickslip/generator/solver_policy.hpp"
#include "stickslip/linalg/eigensolver.hpp"
#include "stickslip/linalg/vectors.hpp"
#include "stickslip/quantities/plan.hpp"

namespace stickslip::quantities {
namespace {

using generator::Branch;
using generator::State;
using generator::StateKind;
using generator::Symmetry;
using linalg::Eigenpair;

constexpr int kAskedFor = 8;
// Perturbing a matrix by eps moves a defective double eigenvalue by about sqrt(eps). Rounding,
// amplified as it is in a matrix far from normal, comes to 1e-6 |rate| and more; nothing below this
// part of the rate is taken for a frequency.
constexpr double kLeastFrequency = 1e-5;

std::complex<double> entry(const linalg::ReadView& real, const linalg::ReadView& imaginary,
                           PetscInt n) {
  if (linalg::kComplex) return {PetscRealPart(real[n]), PetscImaginaryPart(real[n])};
  return {PetscRealPart(real[n]), PetscRealPart(imaginary[n])};
}

// Factor that turns the entry of largest modulus into 1, so that modes look alike on every run.
std::complex<double> scale_of(MPI_Comm comm, const linalg::ReadView& real,
                              const linalg::ReadView& imaginary) {
  struct {
    double size = -1;
    int rank = 0;
  } largest;
  std::complex<double> value = 1;
  for (PetscInt n = 0; n < real.size(); ++n) {
    const auto here = entry(real, imaginary, n);
    // A clear winner, so that rounding does not choose between equals.
    if (std::abs(here) <= largest.size * (1 + 1e-6)) continue;
    largest.size = std::abs(here);
    value = here;
  }
  MPI_Comm_rank(comm, &largest.rank);
  MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPI_DOUBLE_INT, MPI_MAXLOC, comm);
  MPI_Bcast(&value, 1, MPI_C_DOUBLE_COMPLEX, largest.rank, comm);
  return 1.0 / value;
}

bool oscillates(std::complex<double> rate) {
  return std::abs(rate.imag()) > kLeastFrequency * std::abs(rate);
}

// Largest distance to a rate so close that rounding may have split the two.
double spread_of(std::complex<double> rate, const std::vector<Eigenpair>& pairs) {
  double spread = 0;
  for (const auto& other : pairs) {
    const double distance = std::abs(other.value - rate);
    if (distance <= 2 * kLeastFrequency * std::abs(rate)) spread = std::max(spread, distance);
  }
  return spread;
}

RelaxationMode mode_of(const generator::Systems& systems, const generator::StateSpace& states,
                       const Eigenpair& pair) {
  const bool real_rate = !oscillates(pair.value);
  const double sign = states.symmetry() == Symmetry::odd ? -1 : 1;
  const int lowest = systems.process().lowest_static();
  const PhaseField empty(systems.discretisation(), states, PhaseField::Kind::function);
  RelaxationMode mode{pair.value, pair.residual, 0, empty, empty, {}};
  if (real_rate) mode.rate = pair.value.real();
  mode.at_rest.resize(systems.process().highest_static() - lowest + 1);
  const linalg::ReadView real(pair.real), imaginary(pair.imaginary);
  const auto scale = scale_of(systems.comm(), real, imaginary);
  PetscInt at = 0;
  states.for_each_local([&](const State& state) {
    auto value = scale * entry(real, imaginary, at++);
    if (real_rate) value = value.real();
    if (state.kind == StateKind::node) {
      const auto add = [&](Branch branch, double factor) {
        mode.real.add(branch, state.noise, state.node, factor * value.real());
        mode.imaginary.add(branch, state.noise, state.node, factor * value.imag());
      };
      add(state.branch, 1);
      if (states.symmetry_reduced()) add(generator::opposite(state.branch), sign);
    } else if (state.kind == StateKind::static_phase) {
      mode.at_rest[state.noise - lowest] = value;
      if (states.symmetry_reduced()) mode.at_rest[-state.noise - lowest] = sign * value;
    }
  });
  linalg::sum_over_ranks(systems.comm(), mode.at_rest);
  return mode;
}

// Slowest first, the constant left out, and of conjugates those that turn backwards.
std::vector<const Eigenpair*> chosen(const std::vector<Eigenpair>& pairs, Symmetry symmetry) {
  std::vector<const Eigenpair*> kept;
  for (const auto& pair : pairs) kept.push_back(&pair);
  if (symmetry != Symmetry::odd) {
    kept.erase(
        std::ranges::min_element(kept, {}, [](const auto* pair) { return std::abs(pair->value); }));
  }
  std::erase_if(kept,
                [](const auto* pair) { return oscillates(pair->value) && pair->value.imag() < 0; });
  std::ranges::sort(kept, {}, [](const auto* pair) { return pair->value.real(); });
  if (2 * kept.size() > pairs.size()) kept.resize(pairs.size() / 2);
  return kept;
}

}  // namespace

RelaxationSector relaxation_modes(generator::Systems& systems, Symmetry symmetry) {
  const auto& process = systems.process();
  const auto a = generator::assemble(systems.comm(), systems.discretisation(), 0, symmetry,
                                     generator::StaticPhase::kept, systems.statistics());
  // All rates have real parts >= 0; a target left of them, on the scale of the noise.
  const double target = -0.1 / process.noise.correlation_time();
  const linalg::Eigensolver solver(a.matrix(), kRelaxPrefix, target, kAskedFor,
                                   systems.statistics(),
                                   {[&a](PetscScalar at) { return a.shifted(-at); },
                                    generator::default_pc_type(systems.discretisation())});
  std::vector<RelaxationMode> modes;
  for (const auto* pair : chosen(solver.pairs(), symmetry)) {
    modes.push_back(mode_of(systems, a.states(), *pair));
    modes.back().spread = spread_of(pair->value, solver.pairs());
  }
  return {symmetry, std::move(modes)};
}

RelaxationRows relaxation_rows(Symmetry symmetry) {
  using namespace cases;
  switch (symmetry) {
  case Symmetry::even: return {kRelaxationEven, kRelaxationEvenFrequency};
  case Symmetry::odd: return {kRelaxationOdd, kRelaxationOddFrequency};
  case Symmetry::none: break;
  }
  return {kRelaxationAll, kRelaxationAllFrequency};
}

void append_relaxation(const RelaxationSector& sector, Results& results) {
  const auto& modes = sector.modes;
  std::vector<double> number;
  for (std::size_t n = 0; n < modes.size(); ++n) number.push_back(static_cast<double>(n + 1));
  const auto rows = relaxation_rows(sector.symmetry);
  Result decay = array(rows.rate, number), frequency = array(rows.frequency, number);
  for (const auto& mode : modes) {
    decay.value.push_back(mode.rate.real());
    const double error = mode.residual + mode.spread;
    decay.error.push_back(error);
    frequency.value.push_back(mode.rate.imag());
    frequency.error.push_back(mode.rate.imag() == 0 ? 0 : error);
  }
  results.push_back(std::move(decay));
  results.push_back(std::move(frequency));
}

void relaxation_tasks(Planner& planner) {
  planner.needs().modes = true;
  const int sectors = planner.symmetric() ? 2 : 1;
  planner.add_adaptive("relaxation modes", sectors, 28 * sectors, [](Computation& computation) {
    for (Symmetry symmetry : generator::sectors_of(computation.process())) {
      auto& modes = computation.found.modes;
      modes.push_back(relaxation_modes(computation.systems, symmetry));
      append_relaxation(modes.back(), computation.results());
    }
  });
}

}  // namespace stickslip::quantities
