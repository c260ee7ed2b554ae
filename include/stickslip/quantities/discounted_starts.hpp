#pragma once
/// The starts of excursions as a chain whose steps are discounted.

#include <cstddef>
#include <vector>

#include "stickslip/algebra/rate_elimination.hpp"
#include "stickslip/quantities/uncertain.hpp"

namespace stickslip::quantities {

/// From start t excursions take the discounted time w_t = E_t int_0^T exp(-lambda s) ds, and the
/// next one starts at u with h_tu = E_t[exp(-lambda T); it starts at u]; sum_u h_tu = 1 - lambda
/// w_t. All is said by visits to one of the starts, a frequent one, which the others reach without
/// subtraction; errors are those of first order that the errors of w and h allow, by the same
/// eliminations. Local. O(starts^3).
class DiscountedStarts {
 public:
  /// h by rows; lambda >= 0 [1/time].
  DiscountedStarts(double lambda, std::vector<Uncertain> w, std::vector<std::vector<Uncertain>> h);

  /// p f/p w, where p are the stationary shares of the chain that goes from t to u at the rate
  /// h_tu.
  [[nodiscard]] Uncertain mean(const std::vector<Uncertain>& f) const;
  /// mu with lambda w_t mu_t + sum_u h_tu (mu_t - mu_u) = f_t - mean(f) w_t, where p w mu = 0 takes
  /// the place of the equation of one start, so that lambda = 0 is no special case. Differences of
  /// f and of mu are taken pair by pair, with positive weights.
  [[nodiscard]] std::vector<Uncertain> apart(const std::vector<Uncertain>& f) const;

 private:
  [[nodiscard]] std::size_t size() const { return w_.size(); }
  template <class Term>
  [[nodiscard]] Uncertain sum(const Term& term, std::size_t without = -1) const;
  [[nodiscard]] Uncertain weight() const;
  [[nodiscard]] algebra::RateElimination steps(double lambda) const;
  [[nodiscard]] std::vector<double> with_base(const std::vector<double>& values,
                                              double at_base) const;
  [[nodiscard]] std::vector<Uncertain> with_base(const std::vector<double>& values, double at_base,
                                                 const std::vector<double>& errors) const;
  [[nodiscard]] std::vector<Uncertain> solved(const std::vector<Uncertain>& source,
                                              double at_base) const;
  [[nodiscard]] std::vector<Uncertain> shares() const;

  double lambda_;
  std::vector<Uncertain> w_;
  std::vector<std::vector<Uncertain>> h_;
  std::size_t base_;  // the frequent one
  std::vector<std::size_t> others_;
  algebra::RateElimination until_base_;
  std::vector<Uncertain> reaching_;  // E_t[discount until the base is reached]
  std::vector<Uncertain> shares_;    // p, that of the base 1
};

}  // namespace stickslip::quantities
