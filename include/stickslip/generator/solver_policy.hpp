#pragma once
/// Which solver serves which system, and what its factors cost.

#include <cstdint>

#include "stickslip/case/case.hpp"
#include "stickslip/generator/discretisation.hpp"
#include "stickslip/generator/noise_nodes.hpp"
#include "stickslip/generator/velocity_methods.hpp"

namespace stickslip::generator {

/// What the options of -slide_ say of it.
[[nodiscard]] cases::Factors given_factors();

/// By what a sliding operator is factored, where the options of -slide_ leave it `own`: on hp
/// elements by the PC "elements" where few noise nodes stand for the levels, as groups couple all
/// of their nodes and MUMPS takes ten times as long, and up to 700 levels that are nodes
/// themselves, which have two neighbours alone: both are even at some 900; and where the noise
/// jumps further than to neighbours, however many they are. All else goes to MUMPS, in memory. A
/// solver reports what it cannot do; the advice then is -slide_pc_type lu.
[[nodiscard]] cases::Factors chosen_factors(cases::Factors asked, cases::Scheme scheme,
                                            std::int64_t noise_nodes, bool all_levels,
                                            bool neighbours_only);

/// The default of -slide_pc_type by the same rule.
[[nodiscard]] const char* default_pc_type(const Discretisation& discretisation);

/// Whether ElementElimination factors one velocity branch for both: (-X, -Y, -V) is the same
/// process, and the nodes of the noise, all levels or not, mirror each other.
[[nodiscard]] bool branches_share_factors(const model::Process& process, bool all_levels,
                                          const VelocityDiscretisation& velocities);

/// What the factors of a matrix take, all ranks together.
struct FactorCost {
  double entries = 0;
  double bytes = 0;
  double operations = 0;  ///< of factoring
};

/// Of ElementElimination on one velocity branch, exactly. The elements are distributed over the
/// ranks, what is between them each rank has. Local. O(elements (groups + log nodes)).
[[nodiscard]] FactorCost elimination_cost(const model::Process& process,
                                          const HpDiscretisation& velocities, const Nodes& noise,
                                          int ranks);

/// Of both velocity branches, or of the positive one if symmetry-reduced or as good as both.
[[nodiscard]] FactorCost elimination_cost(const Discretisation& discretisation,
                                          bool symmetry_reduced, int ranks);

/// Of MUMPS, or of what stands in its place, from counts: 2.7 to 3.2 n n_v entries (n unknowns, n_v
/// of them on a noise node) on hp velocity discretisations with all levels. The upwind matrix is a
/// two-dimensional grid to MUMPS, where the shorter side m decides: 4.5 n m^0.52 entries were
/// counted for m = 65 ... 257. 9 to 12 bytes a real entry, of which a third stays in memory when
/// factors go to disk; incomplete factors count as none. Operations up to a factor.
[[nodiscard]] FactorCost sparse_cost(cases::Factors factors, cases::Scheme scheme, double unknowns,
                                     double noise_nodes);

// PCs of this program.

/// Makes PETSc know the type "elements", see ElementElimination, for any KSP around a matrix of a
/// KolmogorovOperator on an hp velocity discretisation; others are refused with BadInput when the
/// PC is set up. Its option is -pc_elements_share, its log events PCElementsSetUp and
/// PCElementsSolve. To be called once PETSc has been started. Not collective.
void register_preconditioners();

}  // namespace stickslip::generator
