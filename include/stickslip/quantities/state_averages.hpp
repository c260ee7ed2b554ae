#pragma once
/// Stationary averages of functions of the state.

#include <vector>

#include "stickslip/model/observable.hpp"
#include "stickslip/quantities/stationary.hpp"

namespace stickslip::quantities {

/// For each observable pi(f) = E[f], pi(f|stick) and pi(f|slide), in the stationary distribution
/// and given the phase; then friction_power and slip_rate = 1/mean_excursion. What symmetry makes
/// zero is exactly 0. `a` is an operator of the distribution. No solves: O(states) each.
/// Collective.
void append_averages(const StationaryDistribution& distribution,
                     const operators::KolmogorovOperator& a,
                     const std::vector<model::Observable>& observables, Results& results);

}  // namespace stickslip::quantities
