#pragma once
/// The search for a reduced model that is good enough, and how that is known.

#include <complex>
#include <cstddef>
#include <functional>
#include <vector>

#include "stickslip/quantities/recipe.hpp"
#include "stickslip/quantities/reduced_model.hpp"
#include "stickslip/quantities/uncertain.hpp"
#include "stickslip/support/infinity.hpp"

namespace stickslip::quantities {

/// Numbers to be had from a reduced model of a transfer function H.
struct Questions {
  /// From a model, with what their evaluation leaves.
  std::function<std::vector<Uncertain>(const Reduced&)> values;
  /// Where they need it; the first and the last one are the low and the high end.
  std::vector<std::complex<double>> points;
  /// A value is off by at most the sum of weight |H - H_r|(points[point]).
  struct Term {
    std::size_t point;
    double weight;
  };
  std::vector<std::vector<Term>> terms;  ///< by value
  std::vector<double> shift;             ///< by value: one that serves it, for until_still()
  bool each_by_its_size = false;  ///< whether `tolerance` is relative to each value, or absolute
  double tolerance = 1e-8;
  std::vector<Recipe::Step> first;     ///< what a model begins with
  double lowest = 0, highest = 1e300;  ///< range of further shifts
  double far = kInfinity;              ///< |z| from where Truth::far is found
  int most_truths =
      12;  ///< true solutions at most; where they are dear, the answers are what they are
};

struct Answers {
  Reduced model;
  std::vector<double> value;
  std::vector<double> error;          ///< absolute
  double relative_error = kInfinity;  ///< the largest, in the sense of the questions
  int pairs = 0;                      ///< of vectors in the space
  int truths = 0;                     ///< true solutions that were compared
  std::vector<double> shifts;
};

/// Extends `model` until the answers are known to the tolerance. With r_b, r_c the residuals of the
/// model from both sides,
///
///   H(z) - H_r(z) = r_c(z)^T (z + A)^-1 r_b(z):
///
/// the product of their sizes says where the error is large, and true solutions at points that the
/// model was not made from say how large it is in those units. There are true solutions at both
/// ends and where the estimate is largest. While that exceeds the tolerance, the model gets a shift
/// of about |z| there, and where this does not help it interpolates the true solution. Returns the
/// best model met. `recipe`: of a coarser discretisation, or empty; it is brought up to date.
/// Collective.
[[nodiscard]] Answers ask(ReducedModel& model, const Questions& questions, Recipe& recipe);

/// The same for rough ends, where residuals are far from errors and W^T V is near singular: extends
/// `model` at all shifts alike until the values stand still, with shifts where they moved most.
/// True solutions at both ends and where the last vectors changed most say whether they stand in
/// the right place: what the model misses there counts as an error. Collective.
[[nodiscard]] Answers until_still(ReducedModel& model, const Questions& questions, Recipe& recipe);

}  // namespace stickslip::quantities
