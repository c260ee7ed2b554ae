#pragma once
/// Derivatives of stationary scalars with respect to parameters of the process, by adjoints.

#include <vector>

#include "stickslip/generator/resolvents.hpp"
#include "stickslip/quantities/engines/excursions.hpp"

namespace stickslip::quantities {

/// Derivatives of means over an excursion, M = nu f + entry . s, for a function f of the sliding
/// states and static values s. With the adjoint h, A h = f - A_us s,
///
///   dM = nu dL (h, s) + entry . ds,
///
/// where dL is the derivative of the generator on functions with the static values s: the flow
/// changes by dB, the jumps by d(Lambda alpha). One forward solve with systems.at(0, even) for each
/// M, whatever the number of parameters; one assembly for each parameter. Elements and upwind
/// directions are kept: what that leaves out is an error of the discretisation, and falls with it.
///
/// Without symmetry the shares of excursions by the level from which they start change as well. The
/// level from which the next one starts then counts like a static value: h and s get the mean of z
/// there, where (1 - P) z = h - M for the chain P of the starts (DiscountedStarts::apart). One more
/// forward solve for each M. With a single static level mean_stick takes no solve, and has no
/// derivative but that by tau.
///
/// Appends dKEY_dPARAMETER for each KEY of append_sticking() and, with `moments`, of
/// append_moments(), which takes three more solves; effects::derivatives_of has the parameters of a
/// scene. Collective.
void append_sensitivity(generator::Systems& systems, const StationaryDistribution& distribution,
                        const std::vector<model::Derivative>& parameters, bool sticking,
                        bool moments, Results& results);

}  // namespace stickslip::quantities
