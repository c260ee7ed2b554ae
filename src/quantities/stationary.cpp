#include "stickslip/quantities/stationary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

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

}  // namespace

double normalise(const KolmogorovOperator& a, Vec nu, double lambda) {
  const auto entry = real_parts(a.entry_rates(nu));
  PetscScalar time = 0;
  petsc::check(VecSum(nu, &time));
  const double total =
      std::accumulate(entry.begin(), entry.end(), 0.0) + lambda * PetscRealPart(time);
  if (!(std::abs(total - 1) < 0.1)) {
    throw NotReached(
        fmt::format("rounding leaves {:.2g} for the probability that a sliding phase ends; sliding "
                    "phases last too long against the noise for double precision",
                    total));
  }
  petsc::check(VecScale(nu, 1 / total));
  return total - 1;
}

namespace {

// Means over excursions of which nu is the occupation, normalised.
Excursion excursion_of(const KolmogorovOperator& a, Vec nu, double lost) {
  const auto& [process, noise, velocities] = a.discretisation();
  const auto nodes = static_cast<std::size_t>(noise->count());
  const bool symmetry_reduced = a.states().symmetry_reduced();
  Excursion e;
  for (auto* sums : {&e.slide_time, &e.slide_distance, &e.slide_square}) {
    sums->resize((symmetry_reduced ? 1 : 2) * nodes);
  }
  const petsc::ReadView local(nu);
  PetscInt at = 0;
  a.states().for_each_local([&, &velocities_of_v = *velocities,
                             &nodes_of_x = *noise](const State& state) {
    const double mass = PetscRealPart(local[at++]), v = operators::speed_of(state, velocities_of_v);
    const int node = state.branch == Branch::positive
                         ? state.noise - nodes_of_x.first()
                         : nodes_of_x.count() + state.noise + nodes_of_x.last();
    e.slide_time[node] += mass;
    e.slide_distance[node] += mass * v;
    e.slide_square[node] += mass * v * v;
  });
  // A node lives on one rank, so that the sums do not depend on the distribution.
  for (auto* sums : {&e.slide_time, &e.slide_distance, &e.slide_square}) {
    petsc::sum_over_ranks(a.states().comm(), *sums);
  }
  e.entry = real_parts(a.entry_rates(nu));
  e.lost_probability = lost;
  e.stick_time = operators::StaticChain::of(process).occupation(e.entry);
  return e;
}

/// Occupations over the sliding phases of excursions from one side, and before iterative
/// refinement.
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

}  // namespace

StationaryDistribution::StationaryDistribution(Systems& systems)
    : discretisation_(systems.discretisation()),
      states_(systems.at(0, operators::symmetry_of(systems.process())).a().states()) {
  auto& system = systems.at(0, operators::symmetry_of(process()));
  const KolmogorovOperator& a = system.a();
  const auto from = [&](const std::vector<int>& starts) {
    std::vector<petsc::VecHandle> traces;
    for (int start : starts) traces.push_back(a.trace_at_start(start));
    std::vector<Occupation> all;
    for (auto& s : system.factors().solve_transposed(traces)) {
      const bool monotone = discretisation_.velocities->keeps_origin();
      if (monotone) operators::require_occupation(s.x, process());
      all.push_back(normalised(a, std::move(s)));
    }
    return all;
  };
  if (!process().sticks()) {
    // The null vector of L, over a time that is as good as any other.
    auto s = system.factors().solve_transposed(a.value_in_that_state());
    petsc::check(VecAYPX(s.correction, -1, s.x));
    for (const auto& nu : {&s.x, &s.correction}) {
      PetscScalar time = 0;
      petsc::check(VecSum(*nu, &time));
      petsc::check(VecScale(*nu, 1.0 / time));
    }
    excursion_ = excursion_of(a, s.x, 0);
    uncorrected_ = excursion_of(a, s.correction, 0);
    occupation_ = std::move(s.x);
    uncorrected_occupation_ = std::move(s.correction);
    return;
  }
  if (process().symmetric()) {
    starts_ = Starts::upwards(process());
    Occupation all = std::move(from(starts_.levels)[0]);
    excursion_ = excursion_of(a, all.nu, all.lost);
    uncorrected_ = excursion_of(a, all.uncorrected, all.uncorrected_lost);
    occupation_ = std::move(all.nu);
    uncorrected_occupation_ = std::move(all.uncorrected);
    return;
  }
  const std::vector<int> levels = process().starts();
  const std::vector<Occupation> occupations = from(levels);
  std::vector<Excursion> corrected, uncorrected;
  for (const Occupation& o : occupations) {
    corrected.push_back(excursion_of(a, o.nu, o.lost));
    uncorrected.push_back(excursion_of(a, o.uncorrected, o.uncorrected_lost));
  }
  const auto mean = [&](const Starts& starts, petsc::VecHandle Occupation::*nu) {
    petsc::VecHandle sum = a.zeros();
    for (std::size_t t = 0; t < starts.size(); ++t) {
      petsc::check(VecAXPY(sum, starts.shares[t], occupations[t].*nu));
    }
    return sum;
  };
  starts_ = chain_of_starts(process(), levels, corrected);
  excursion_ = joined(process(), starts_, corrected);
  occupation_ = mean(starts_, &Occupation::nu);
  const Starts before = chain_of_starts(process(), levels, uncorrected);
  uncorrected_ = joined(process(), before, uncorrected);
  uncorrected_occupation_ = mean(before, &Occupation::uncorrected);
}

// Sliding phases that end with V > 0 on level i, and with V < 0 on level -i in symmetry-reduced
// coordinates: halves of the sum and of the difference of both.
void StationaryDistribution::orient(Systems& systems) {
  if (!excursion_.entry_plus.empty()) return;
  auto& system = systems.at(0, Symmetry::odd);
  const petsc::Solution nu = system.factors().solve_transposed(system.a().trace_at_exit());
  petsc::check(VecAYPX(nu.correction, -1, nu.x));
  const auto set = [&](Vec odd, Excursion& e) {
    const auto oriented = real_parts(system.a().entry_rates(odd));
    const std::size_t last = e.entry.size() - 1;
    e.entry_plus.resize(e.entry.size());
    for (std::size_t i = 0; i <= last; ++i) {
      e.entry_plus[i] =
          (e.entry[i] + oriented[i]) / 2 + (e.entry[last - i] - oriented[last - i]) / 2;
    }
  };
  set(nu.x, excursion_);
  set(nu.correction, uncorrected_);
}

void StationaryDistribution::append_from(const FunctionOfExcursion& append,
                                         Results& results) const {
  Results corrected, uncorrected;
  append(discretisation_, excursion_, corrected);
  append(discretisation_, uncorrected_, uncorrected);
  const double defect = excursion_.conservation_defect(discretisation_);
  for (std::size_t r = 0; r < corrected.size(); ++r) {
    auto& result = corrected[r];
    for (std::size_t n = 0; n < result.value.size(); ++n) {
      const double value = result.value[n];
      result.error[n] += std::abs(value - uncorrected[r].value[n]) + defect * std::abs(value);
    }
    results.push_back(std::move(result));
  }
}

std::vector<Uncertain> StationaryDistribution::entry() const {
  const auto &p = excursion_.entry, &before = uncorrected_.entry;
  std::vector<Uncertain> entry;
  for (std::size_t n = 0; n < p.size(); ++n) entry.push_back({p[n], std::abs(p[n] - before[n])});
  return entry;
}

petsc::VecHandle StationaryDistribution::starts_on(const KolmogorovOperator& a) const {
  petsc::VecHandle g = a.zeros();
  for (std::size_t t = 0; t < starts_.size(); ++t) {
    petsc::check(VecAXPY(g, starts_.shares[t], a.trace_at_start(starts_.levels[t])));
  }
  return g;
}

// All operators that keep the same branches list the sliding states of a rank in the same order.
petsc::VecHandle StationaryDistribution::occupation_on(const KolmogorovOperator& a) const {
  petsc::VecHandle all = a.zeros();
  petsc::WriteView local(all);
  const petsc::ReadView nu(occupation_);
  const auto& stick = excursion_.stick_time;
  const int lowest = process().lowest_static();
  const bool both = a.states().symmetry_reduced();
  PetscInt at = 0, sliding = 0;
  a.states().for_each_local([&](const State& state) {
    if (state.kind != StateKind::static_phase) {
      local[at++] = nu[sliding++];
    } else {
      const double here = stick[state.noise - lowest];
      local[at++] = both && state.noise != 0 ? here + stick[-state.noise - lowest] : here;
    }
  });
  return all;
}

StationaryDistribution::Velocity
StationaryDistribution::velocity(const KolmogorovOperator& a) const {
  const double total = excursion_.mean_excursion();
  const double mean = excursion_.mean_drift(*discretisation_.noise) / total;
  Velocity velocity{a.values([mean](double, double, double v) { return v - mean; }), a.zeros()};
  petsc::check(VecPointwiseMult(velocity.c, velocity.b, occupation_on(a)));
  petsc::check(VecScale(velocity.c, 1 / total));
  return velocity;
}

// High order leaves far tails with signs of their own.
petsc::VecHandle StationaryDistribution::weight_on(const KolmogorovOperator& a) const {
  return positive_weight(occupation_on(a));
}

petsc::VecHandle positive_weight(petsc::VecHandle weight) {
  PetscReal largest = 0;
  petsc::check(VecAbs(weight));
  petsc::check(VecNorm(weight, NORM_INFINITY, &largest));
  petsc::check(VecShift(weight, 1e-12 * largest));
  return weight;
}

}  // namespace stickslip::quantities
