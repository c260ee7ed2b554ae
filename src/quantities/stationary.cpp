#include "stickslip/quantities/stationary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "stickslip/operators/generator_checks.hpp"
#include "stickslip/operators/static_chain.hpp"
#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/session.hpp"
#include "stickslip/petsc/vectors.hpp"
#include "stickslip/support/errors.hpp"

namespace stickslip::quantities {
namespace {

using operators::Branch;
using operators::KolmogorovOperator;
using operators::State;
using operators::StateKind;
using operators::Symmetry;
using operators::Systems;

std::vector<double> real_parts(const std::vector<PetscScalar>& values) {
  std::vector<double> parts;
  for (const auto& value : values) parts.push_back(PetscRealPart(value));
  return parts;
}

double speed(const State& state, const velocity::VelocityDiscretisation& velocities) {
  if (state.kind == StateKind::node) return velocities.nodes()[state.node];
  return state.kind == StateKind::holding ? velocities.v_max() : 0;
}

// Scales nu such that sliding ends somewhere: sum_i P_i = 1 holds on every discretisation. Where
// slides last long against the time steps of the noise, nu is nearly a null vector of A, and
// rounding (of the entries of A too) changes little but its length; this sets it right.
double normalise(const KolmogorovOperator& a, Vec nu) {
  const auto entry = real_parts(a.entry_rates(nu));
  const double total = std::accumulate(entry.begin(), entry.end(), 0.0);
  if (!(std::abs(total - 1) < 0.1)) {
    throw NotReached(fmt::format("rounding leaves {:.2g} for the probability that a slide ends; "
                                 "slides last too long against "
                                 "the noise for double precision",
                                 total));
  }
  petsc::check(VecScale(nu, 1 / total));
  return total - 1;
}

// Means over excursions of which nu is the occupation, normalised.
Excursion excursion_of(const KolmogorovOperator& a, Vec nu, double lost) {
  const auto& [process, noise, velocities] = a.discretisation();
  const auto nodes = static_cast<std::size_t>(noise->count());
  const bool symmetry_reduced = a.states().symmetry_reduced();
  Excursion e;
  for (auto* sums : {&e.slide_time, &e.slide_distance, &e.slide_square}) sums->resize(nodes);
  if (!symmetry_reduced) e.slide_drift.resize(nodes);
  const petsc::ReadView local(nu);
  PetscInt at = 0;
  a.states().for_each_local(
      [&, &velocities_of_v = *velocities, half = noise->half()](const State& state) {
        const double mass = PetscRealPart(local[at++]), v = speed(state, velocities_of_v);
        const int node = half + state.noise;
        e.slide_time[node] += mass;
        e.slide_distance[node] += mass * v;
        e.slide_square[node] += mass * v * v;
        if (!symmetry_reduced)
          e.slide_drift[node] += state.half == Branch::positive ? mass * v : -mass * v;
      });
  // The nodes n and -n live on one rank, so that the sums do not depend on the distribution.
  for (auto* sums : {&e.slide_time, &e.slide_distance, &e.slide_square, &e.slide_drift}) {
    petsc::sum_over_ranks(a.states().comm(), *sums);
  }
  e.entry = real_parts(a.entry_rates(nu));
  e.lost_probability = lost;
  e.stick_time = operators::StaticChain::of(process).occupation(e.entry);
  return e;
}

/// Occupations over the slides of excursions from one side, and without the last correction.
struct Occupation {
  petsc::VecHandle nu, uncorrected;
  double lost = 0, uncorrected_lost = 0;
};

Occupation normalised(const KolmogorovOperator& a, petsc::Solution s) {
  petsc::check(VecAYPX(s.correction, -1, s.x));
  Occupation o{std::move(s.x), std::move(s.correction)};
  o.lost = normalise(a, o.nu);
  o.uncorrected_lost = normalise(a, o.uncorrected);
  return o;
}

/// Chances that an excursion ends on the other side.
struct Turns {
  double falling, rising;  ///< from s+ to s-, from s- to s+
  /// Share of excursions that start at s+.
  [[nodiscard]] double share_of_upper() const { return rising / (rising + falling); }
  [[nodiscard]] double share_of_lower() const { return falling / (rising + falling); }
};

Turns turns(const model::Process& process, const KolmogorovOperator& a, Vec from_upper,
            Vec from_lower) {
  const auto chain = operators::StaticChain::of(process);
  const auto up = chain.upward_exit_transform(), down = chain.downward_exit_transform();
  const auto mean = [&](Vec nu, const std::vector<double>& h) {
    const auto entry = real_parts(a.entry_rates(nu));
    return std::inner_product(entry.begin(), entry.end(), h.begin(), 0.0);
  };
  return {mean(from_upper, down), mean(from_lower, up)};
}

// upper <- share_of_upper upper + share_of_lower lower.
void mix(const Turns& turns, Vec upper, Vec lower) {
  petsc::check(VecAXPBY(upper, turns.share_of_lower(), turns.share_of_upper(), lower));
}

}  // namespace

StationaryDistribution::StationaryDistribution(Systems& systems)
    : discretisation_(systems.discretisation()),
      states_(systems.at(0, operators::symmetry_of(systems.process())).a().states()) {
  auto& system = systems.at(0, operators::symmetry_of(process()));
  const KolmogorovOperator& a = system.a();
  const auto from = [&](Branch side) {
    auto s = system.factors().solve_transposed(a.trace_at_exit(side));
    const bool monotone = discretisation_.velocities->keeps_origin();
    if (monotone) operators::require_occupation(s.x, process());
    return normalised(a, std::move(s));
  };
  Occupation o = from(Branch::positive);
  if (!process().symmetric()) {
    const Occupation lower = from(Branch::negative);
    const Turns now = turns(process(), a, o.nu, lower.nu);
    reversal_probability_ = now.falling;
    mix(now, o.nu, lower.nu);
    mix(turns(process(), a, o.uncorrected, lower.uncorrected), o.uncorrected, lower.uncorrected);
    o.lost = std::max(std::abs(o.lost), std::abs(lower.lost));
  }
  excursion_ = excursion_of(a, o.nu, o.lost);
  uncorrected_ = excursion_of(a, o.uncorrected, o.uncorrected_lost);
  occupation_ = std::move(o.nu);
}

void StationaryDistribution::orient(Systems& systems) {
  auto& system = systems.at(0, Symmetry::odd);
  const petsc::Solution nu = system.factors().solve_transposed(system.a().trace_at_exit());
  excursion_.entry_orientation = real_parts(system.a().entry_rates(nu.x));
  petsc::check(VecAYPX(nu.correction, -1, nu.x));
  uncorrected_.entry_orientation = real_parts(system.a().entry_rates(nu.correction));
}

// All symmetry-reduced operators list the sliding states of a rank in the same order.
petsc::VecHandle StationaryDistribution::occupation_on(const KolmogorovOperator& a) const {
  petsc::VecHandle all = a.zeros();
  petsc::WriteView local(all);
  const petsc::ReadView nu(occupation_);
  const auto& stick = excursion_.stick_time;
  const std::size_t k = stick.size() / 2;
  PetscInt at = 0, sliding = 0;
  a.states().for_each_local([&](const State& state) {
    if (state.kind != StateKind::rest) {
      local[at++] = nu[sliding++];
    } else {
      const double here = stick[k + state.noise];
      local[at++] = state.noise == 0 ? here : here + stick[k - state.noise];
    }
  });
  return all;
}

petsc::VecHandle StationaryDistribution::weighted_velocity(const KolmogorovOperator& a) const {
  petsc::VecHandle c = a.values([](double, double, double v) { return v; });
  petsc::check(VecPointwiseMult(c, c, occupation_on(a)));
  petsc::check(VecScale(c, 1 / excursion_.mean_excursion()));
  return c;
}

// High order leaves far tails with signs of their own.
petsc::VecHandle StationaryDistribution::weight_on(const KolmogorovOperator& a) const {
  petsc::VecHandle weight = occupation_on(a);
  PetscReal largest = 0;
  petsc::check(VecAbs(weight));
  petsc::check(VecNorm(weight, NORM_INFINITY, &largest));
  petsc::check(VecShift(weight, 1e-12 * largest));
  return weight;
}

}  // namespace stickslip::quantities
