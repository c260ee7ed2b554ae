#pragma once
/// PCs of this program.

namespace stickslip::operators {

/// Makes PETSc know the type "elements", see ElementElimination, for any KSP around a matrix of a
/// KolmogorovOperator on an hp velocity discretisation; others are refused with BadInput when the
/// PC is set up. Its option is -pc_elements_share, its log events PCElementsSetUp and
/// PCElementsSolve. To be called once PETSc has been started. Not collective.
void register_preconditioners();

}  // namespace stickslip::operators
