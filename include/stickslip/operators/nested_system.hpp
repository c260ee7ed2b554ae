#pragma once
/// A system on higher degrees, solved through the factors of one on lower degrees.

#include <memory>

#include "stickslip/operators/systems.hpp"
#include "stickslip/petsc/high_modes.hpp"

namespace stickslip::operators {

/// nu A = g on the elements of a coarse discretisation with higher degrees. A solution on lower
/// degrees lacks the high modes alone; they are found element by element, and what they change in
/// the lower ones with the coarse factors, in cycles
///
///   nu += r P A_c^-1 R,   nu += r H (S + J)^-1 H',   r = g - nu A before each,
///
/// in the notation of petsc::HighModes. A cycle leaves less than half of the error, in most scenes
/// a tenth. Nothing is factored but blocks of high modes.
class NestedSystem {
 public:
  /// Over coarse.at(0, symmetry_of(process)), on `axis`, an hp axis with the elements of that of
  /// `coarse`, which must outlive this object. Collective. Throws NoMemory, or NotReached
  /// if a block of high modes is singular.
  NestedSystem(Systems& coarse, std::shared_ptr<const velocity::Axis> axis, petsc::Ledger& ledger);

  [[nodiscard]] const KolmogorovOperator& a() const { return a_; }
  [[nodiscard]] const model::Process& process() const { return process_; }
  [[nodiscard]] const std::shared_ptr<const velocity::Axis>& axis() const { return axis_; }

  /// nu A = g from a solution on lower degrees, or a better one, by two cycles, which count as
  /// corrections. The correction is that of the last one, and larger than what is left. Collective.
  [[nodiscard]] petsc::Solution solve_transposed(Vec g, Vec guess);

 private:
  void compute_residual(Vec g, Vec nu, Vec residual) const;

  const model::Process& process_;
  std::shared_ptr<const velocity::Axis> axis_;
  System& coarse_;
  petsc::Ledger& ledger_;
  KolmogorovOperator a_;
  petsc::HighModes high_;
  petsc::BackwardError measure_;
};

}  // namespace stickslip::operators
