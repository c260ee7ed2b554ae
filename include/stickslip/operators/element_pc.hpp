#pragma once
/// PCs of this program.

namespace stickslip::operators {

/// The PC type that eliminates velocity elements; see ElementElimination.
inline constexpr const char* kElementsPc = "elements";

/// Makes PETSc know the type "elements", for any KSP around a matrix of a KolmogorovOperator on an
/// hp axis; others are refused with BadInput when the PC is set up. It has apply, applytranspose,
/// view and the log events PCElementsSetUp and PCElementsSolve. To be called once PETSc has been
/// started. Not collective.
void register_preconditioners();

}  // namespace stickslip::operators
