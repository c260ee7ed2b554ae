#pragma once
/// Small models of c (z + A)^-1 b by two-sided rational Krylov projection.

#include <slepcbv.h>

#include <functional>
#include <map>
#include <vector>

#include "stickslip/algebra/dense.hpp"
#include "stickslip/petsc/handle.hpp"
#include "stickslip/quantities/pencil.hpp"

namespace stickslip::quantities {

/// A small model: c (z + A)^-1 b ~ gamma (z - m)^-1 beta.
struct Reduced {
  algebra::Matrix<double> m;
  std::vector<double> beta, gamma;
};

/// Right and left vectors and the weight D of a problem.
struct Ends {
  Vec b, c, weight;
};

/// Two-sided projection -(W^T V)^-1 W^T A V. V spans chains (s + A)^-1 ... b, W the
/// transposed chains from c, for real shifts s: real factorisations only. Each pair of vectors
/// matches two more derivatives of the transfer function at its shift. b, A b, c, c A, if they are
/// smooth enough to be of use, match four moments at infinity. One-sided projections, W = V, fail
/// by orders of magnitude in the tail, and so does the orthogonal projection on V and W together in
/// L2(D), although it cannot have growing modes.
///
/// Vectors are orthogonalised in the scalar product with a weight D, V with D and W with D^-1: with
/// D near the stationary distribution both then are functions in L2(D). Without it V sees fast
/// bodies that never occur, W what does, and W^T V is near singular.
class ReducedModel {
 public:
  /// Smooth b and c: V and W start with b, A b, c, c A. Rough ones, such as the value at a point,
  /// give no information at infinity; then W^T V is near singular all the same (1e-11 was seen),
  /// and the solves of the chains are refined, which leaves seven digits of the largest value.
  enum class Nature { smooth, rough };
  /// `pencil` must live as long; `ends.weight` > 0. Collective.
  ReducedModel(Pencil& pencil, const Ends& ends, Nature nature, int most_pairs);

  /// Adds up to `count` pairs of vectors of the chains of `shift` > 0 [1/time]; a new shift takes
  /// one factorisation, each pair one forward and one transposed solve. Returns how many were
  /// added: fewer when the space is full or invariant. Collective.
  int extend(double shift, int count);

  [[nodiscard]] Nature nature() const { return nature_; }
  [[nodiscard]] int pairs() const { return pairs_; }
  [[nodiscard]] bool full() const { return pairs_ >= most_pairs_; }
  /// The projection on all vectors so far, without directions of V and W that see nothing of the
  /// other space: of size 0 when b is never felt at c. Collective. O(n pairs^2).
  [[nodiscard]] Reduced reduce() const;

 private:
  bool append(Vec v, Vec w);
  void multiply(Vec x, Vec y, bool transposed) const;
  void resolve(double shift, Vec v, Vec w);

  Pencil& pencil_;
  Nature nature_;
  petsc::VecHandle root_, inverse_root_;  // D^1/2, D^-1/2
  int most_pairs_, pairs_ = 0;
  petsc::BvHandle right_, left_, image_;  // D^1/2 V, D^-1/2 W, D^1/2 A V
  petsc::VecHandle b_, c_;                // scaled like V and W
  struct Chain {
    petsc::VecHandle v, w;
  };
  std::map<double, Chain> chains_;
};

/// The model that is not reduced: A itself, in the coordinates of ReducedModel or in its own, which
/// round otherwise. Collective. O(size^2) memory.
[[nodiscard]] Reduced whole_model(const Pencil& pencil, const Ends& ends, bool scaled);

/// Numbers to be had from a reduced model, and how to make it better for each of them.
struct Questions {
  std::function<std::vector<double>(const Reduced&)> values;
  std::vector<double> shift;      ///< for each value a shift that serves it [1/time]
  bool each_by_its_size = false;  ///< whether `tolerance` is relative to each value, or absolute
  double tolerance = 1e-8;
  int patience = 4;                    ///< blocks of pairs in a row that may fail to help
  std::vector<double> first_shifts;    ///< [1/time]
  double lowest = 0, highest = 1e300;  ///< range of further shifts
};

struct Answers {
  Reduced model;
  std::vector<double> value;
  std::vector<double> error;  ///< absolute: what the last vectors changed, and noise
  double relative_error = 1;  ///< the largest, in the sense of the questions
  int pairs = 0;              ///< of vectors in the space
  std::vector<double> shifts;
};

/// Extends `model` in blocks until the answers stand still; shifts are added where the error is
/// largest. Returns the best model met, when it is full or nothing helps any more. Collective.
[[nodiscard]] Answers ask(ReducedModel& model, const Questions& questions);

}  // namespace stickslip::quantities
