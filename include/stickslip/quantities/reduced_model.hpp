#pragma once
/// Small models of c (z - L)^-1 b by two-sided rational Krylov projection.

#include <slepcbv.h>

#include <functional>
#include <map>
#include <vector>

#include "stickslip/exact/dense.hpp"
#include "stickslip/operators/systems.hpp"
#include "stickslip/petsc/handle.hpp"

namespace stickslip::quantities {

/// L seen through W^T (.) V, with b = V beta and c = W gamma:
///
///   c (z - L)^-1 b ~ gamma G (z - M)^-1 beta,   G = W^T V,  M = G^-1 W^T L V.
struct Reduced {
  exact::Matrix g, m;
  std::vector<double> beta, gamma;
};

/// Spans V by b, L b and chains (s - L)^-1 ... b, W by c, c L and the transposed chains, for real
/// shifts s: real factorisations only. Each pair of vectors matches two more derivatives of the
/// transfer function at its shift; b, L b, c, c L match four moments at infinity. One-sided
/// projections, W = V, fail by orders of magnitude in the tail.
///
/// Vectors are orthogonalised in the scalar product with a weight D, V with D and W with D^-1: with
/// D near the stationary law both then are functions in L2(pi). Without it, V sees fast bodies that
/// never occur, W what does, and G is near singular.
class ReducedModel {
 public:
  /// `sector` says on which states L lives, `weight` > 0. Collective.
  struct Sector {
    operators::Symmetry symmetry;
    operators::Rest rest;
  };
  ReducedModel(operators::Systems& systems, Sector sector, Vec b, Vec c, Vec weight,
               int most_vectors);
  /// Releases the factors it had made. Collective.
  ~ReducedModel();
  ReducedModel(const ReducedModel&) = delete;
  ReducedModel& operator=(const ReducedModel&) = delete;

  /// Adds up to `count` pairs of vectors of the chains of `shift` > 0 [1/time]; a new shift takes
  /// one factorisation, each pair one plain and one transposed solve. Returns how many were added:
  /// fewer when the space is full or invariant. Collective.
  int extend(double shift, int count);

  [[nodiscard]] int size() const { return size_; }
  [[nodiscard]] bool full() const { return size_ >= most_vectors_; }
  /// The projection on all vectors so far. Collective. O(n size^2).
  [[nodiscard]] Reduced reduce() const;

 private:
  bool append(Vec v, Vec w);

  operators::Systems& systems_;
  Sector sector_;
  petsc::VecHandle root_, inverse_root_;   // D^1/2, D^-1/2
  operators::KolmogorovOperator minus_l_;  // D^1/2 (-L) D^-1/2
  int most_vectors_, size_ = 0;
  petsc::BvHandle right_, left_;  // D^1/2 V, D^-1/2 W
  double beta_ = 0, gamma_ = 0;
  struct Chain {
    petsc::VecHandle v, w;
  };
  std::map<double, Chain> chains_;
};

/// Numbers to be had from a reduced model, and how to make it better for each of them.
struct Questions {
  std::function<std::vector<double>(const Reduced&)> values;
  std::vector<double> shift;      ///< for each value a shift that serves it [1/time]
  bool each_by_its_size = false;  ///< whether tolerance is relative to each value or to the largest
  double tolerance = 1e-8;
  double first_shift = 1;              ///< [1/time]
  double lowest = 0, highest = 1e300;  ///< range of further shifts
};

struct Answers {
  Reduced model;
  std::vector<double> value;
  std::vector<double> error;  ///< absolute: what the last vectors changed
  double relative_error = 1;  ///< the largest, in the sense of the questions
  int vectors = 0;
  std::vector<double> shifts;
};

/// Extends `model` in blocks until the answers stand still; shifts are added where the error is
/// largest. Returns the best model met, when it is full or nothing helps any more. Collective.
[[nodiscard]] Answers ask(ReducedModel& model, const Questions& questions);

}  // namespace stickslip::quantities
