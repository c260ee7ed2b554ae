#pragma once
/// Small models of c (z + A)^-1 b by two-sided rational Krylov projection.

#include <slepcbv.h>

#include <complex>
#include <map>
#include <memory>
#include <vector>

#include "stickslip/algebra/dense.hpp"
#include "stickslip/petsc/handle.hpp"
#include "stickslip/quantities/pencil.hpp"

namespace stickslip::quantities {

/// A small model: c (z + A)^-1 b ~ gamma (z - m)^-1 beta.
struct Reduced {
  algebra::Matrix<double> m;
  std::vector<double> beta, gamma;
  /// Coordinates in the bases of the model: x ~ V to_right (z - m)^-1 beta, and w ~ gamma (z -
  /// m)^-1 to_left W^T.
  algebra::Matrix<double> to_right, to_left;
};

/// Right and left vectors and the weight D of a problem.
struct Ends {
  Vec b, c, weight;
};

/// The transfer function as it is, by factors of z + A.
struct Truth {
  std::complex<double> z;
  /// c (z + A)^-1 b; or, where `far`, c A (z + A)^-1 A b, which lacks the leading terms of the
  /// expansion in 1/z and keeps its digits however large z is.
  std::complex<double> value;
  bool far = false;
  operators::ComplexVector x;              ///< the solution, scaled like V
  std::unique_ptr<ShiftedPencil> factors;  ///< none for real z
};

/// Size of b - (z + A) V y in the norm of a basis V that is orthonormal: with A V = V T + Q R and b
/// = V b_V + Q b_Q, the root of |b_V - (z + T) y|^2 + |b_Q - R y|^2. Q has few columns, as A V
/// leaves V in one direction for each shift.
class Residual {
 public:
  /// The first `size` columns of both. Collective. O(rows size columns(Q)).
  Residual(BV basis, BV image, int size, Vec end);
  /// Local. O(size^2).
  [[nodiscard]] double operator()(std::complex<double> z,
                                  const std::vector<std::complex<double>>& y) const;

 private:
  algebra::Matrix<double> t_, r_;
  std::vector<double> b_v_, b_q_;
};

/// Two-sided projection -(W^T V)^-1 W^T A V. V spans chains (s + A)^-1 ... b, W the
/// transposed chains from c, for real shifts s: real factorisations only. Each pair of vectors
/// matches two more derivatives of the transfer function at its shift. b, A b, c, c A, if they are
/// smooth enough to be of use, match four moments at infinity. A true solution at a complex z adds
/// its real and imaginary part. One-sided projections, W = V, fail by orders of magnitude in the
/// tail, and so does the orthogonal projection on V and W together in L2(D), although it cannot
/// have growing modes.
///
/// Vectors are orthogonalised in the scalar product with a weight D, V with D and W with D^-1: with
/// D near the stationary distribution both then are functions in L2(D). Without it V sees fast
/// bodies that never occur, W what does, and W^T V is near singular.
///
/// The error is r_c(z)^T (z + A)^-1 r_b(z), r the residuals of both sides.
class ReducedModel {
 public:
  /// Smooth b and c: V and W start with b, A b, c, c A. Rough ones, such as the value at a point,
  /// give no information at infinity; then W^T V is near singular all the same (1e-11 was seen).
  /// Those of a start in one state are rough, and what becomes of it has kinks in time.
  enum class Nature { smooth, rough, kinked };
  /// `pencil` must live as long; `ends.weight` > 0. Collective.
  ReducedModel(Pencil& pencil, const Ends& ends, Nature nature, int most_pairs);

  /// Adds up to `count` pairs of vectors of the chains of `shift` > 0 [1/time]; a new shift takes
  /// one factorisation, each pair one forward and one transposed solve. Returns how many were
  /// added: fewer when the space is full or invariant. Collective.
  int extend(double shift, int count);
  /// Adds the real and the imaginary part of (z + A)^-1 b and of c (z + A)^-1, so that the model is
  /// exact at z. Returns how many pairs were added. Collective.
  int interpolate(const Truth& truth);

  /// By complex factors, which it keeps. `far` for smooth ends alone. Collective.
  [[nodiscard]] Truth truth(std::complex<double> z, bool far) const;

  [[nodiscard]] int pairs() const { return pairs_; }
  [[nodiscard]] bool full() const { return pairs_ >= most_pairs_; }
  /// The projection on all vectors so far, without directions of V and W that see nothing of the
  /// other space: of size 0 when b is never felt at c. Collective. O(n pairs) for new pairs.
  [[nodiscard]] Reduced reduce();
  /// Those of V and b, and of W and c. Collective.
  [[nodiscard]] Residual right_residual() const { return {right_, image_, pairs_, b_}; }
  [[nodiscard]] Residual left_residual() const { return {left_, left_image_, pairs_, c_}; }

 private:
  bool append(Vec v, Vec w);
  void multiply(Vec x, Vec y, bool transposed) const;
  void resolve(double shift, Vec x, bool transposed, bool refined) const;
  [[nodiscard]] operators::ComplexVector shifted(ShiftedPencil& factors, Vec real,
                                                 bool transposed) const;

  Pencil& pencil_;
  petsc::VecHandle root_, inverse_root_;  // D^1/2, D^-1/2
  int most_pairs_, pairs_ = 0;
  petsc::BvHandle right_, left_;                 // D^1/2 V, D^-1/2 W
  petsc::BvHandle image_, left_image_;           // D^1/2 A V, D^-1/2 A^T W
  petsc::VecHandle b_, c_;                       // scaled like V and W
  petsc::VecHandle ab_, ca_;                     // of smooth ends
  algebra::Matrix<double> overlap_, projected_;  // W^T V, W^T A V
  int projected_pairs_ = 0;
  struct Chain {
    petsc::VecHandle v, w;
  };
  std::map<double, Chain> chains_;
};

}  // namespace stickslip::quantities
