#pragma once
/// Direct solution of lambda - L, element by element along the velocity.

#include <petscmat.h>

#include <memory>
#include <vector>

#include "stickslip/generator/element_system.hpp"
#include "stickslip/generator/generator.hpp"
#include "stickslip/linalg/vectors.hpp"

namespace stickslip::generator {

template <class Scalar>
class BranchFactors;
template <class Scalar>
class StaticRows;

/// LU factors of the matrix A of a KolmogorovOperator on an hp velocity discretisation. With A_E
/// its elements alone, decoupled from each other, G what they give at their ends and T what they
/// take there,
///
///   A^-1 = A_E^-1 + A_E^-1 T (1 - S)^-1 G A_E^-1,   S = G A_E^-1 T;
///
/// between two elements each noise node has one value w: u+ (v_e) on nodes that rise there, from
/// above, and u- (v_e) on those that fall, from below. With the responses S of element e, these are
/// eliminated from v_max down,
///
///   u+(v_e) = R_e u-(v_e) + r_e,   R_e = S_ii + S_io R_(e+1) (1 - S_oo R_(e+1))^-1 S_oi,
///
/// R_e being the reflection by the part of the branch above v_e; at v_max holding states reflect.
/// At v = 0 the velocity branches meet each other and the static states, a tridiagonal chain
/// eliminated before. With M noise nodes and E elements of q velocity nodes, factors take some 1.5
/// E M^2 entries and 1.1 E M^3 operations, besides those of the elements.
///
/// Where the velocity branches mirror each other, the factors of one serve both; see
/// branches_share_factors().
///
/// Ranks share the elements; what is between them each rank eliminates alike, so that results do
/// not depend on the number of ranks.
///
/// `Scalar` is PetscScalar, or std::complex<double> with either: what is added may be complex where
/// the matrix, of which only the static states are read, is real.
template <class Scalar>
class ElementElimination {
 public:
  using DenseMatrix = linalg::Matrix<Scalar>;

  /// Factors `matrix`, which carries `data`; of its entries the rows of static states are read, the
  /// others follow from the discretisation. Without `share` each rank factors all elements.
  /// Collective. Throws NotReached where the matrix is singular.
  ElementElimination(Mat matrix, std::shared_ptr<const MatrixData> data, bool share = true)
      : ElementElimination(matrix, data, data->shift, share) {}
  /// The same with something else added to -L.
  ElementElimination(Mat matrix, std::shared_ptr<const MatrixData> data, Shift<Scalar> shift,
                     bool share = true);
  ~ElementElimination();

  /// X <- A^-1 X, or A^-T X without conjugation, whole vectors on every rank, by columns: factors
  /// are read once for all of them. Collective.
  void solve(DenseMatrix& x, bool transposed) const;

  /// Numbers kept by this rank.
  [[nodiscard]] double entries() const;

 private:
  using Scalars = std::vector<Scalar>;
  using DenseFactors = linalg::LuFactors<Scalar>;
  using Element = ElementSystem<Scalar>;
  using Steps = LinearSteps<Scalar>;
  using Couplings = std::vector<typename Steps::Coupling>;
  using Factors = BranchFactors<Scalar>;
  struct Line;

  [[nodiscard]] std::unique_ptr<Factors> unfactored(Branch branch) const;
  [[nodiscard]] Line line_of(Branch branch, const Factors& factors) const;
  [[nodiscard]] double sign() const { return data_->states.symmetry() == Symmetry::odd ? -1 : 1; }
  void add_shares(const Line& line, std::size_t fall, Couplings& shares) const;
  void add_crossings(const Line& line, std::size_t fall, Couplings& found) const;
  [[nodiscard]] std::size_t exit_at(PetscInt column) const;
  [[nodiscard]] StaticRows<Scalar> read_static_rows(Mat matrix) const;
  void meet(Mat matrix);
  void solve_between(linalg::Columns<Scalar> w, bool transposed) const;

  [[nodiscard]] DenseMatrix given_on(const Line& line, const Element& element,
                                     const DenseMatrix& x) const;
  template <class Visit>
  void for_each_own_element(Visit visit) const;
  template <class Visit>
  static void for_each_unknown(const Line& line, const Element& element, Visit visit);
  template <class Visit>
  void for_each_unknown_between(Visit visit) const;

  std::shared_ptr<const MatrixData> data_;
  Shift<Scalar> shift_;
  MPI_Comm comm_;                                  // of the ranks that share elements
  std::vector<std::unique_ptr<Factors>> factors_;  // of each branch, or of both
  std::vector<Line> lines_;
  std::vector<PetscInt> static_rows_;  // of static states, from the lowest level up
  int lowest_static_ = 0;
  // The list w: values between elements, holding states among them; static states; what falling
  // nodes find at v = 0.
  std::size_t static_begin_ = 0, length_ = 0;
  // (1 - S)^-1: those at v = 0 come between the steps of the branches inwards and outwards.
  Steps meeting_, leaving_;
};

}  // namespace stickslip::generator
