#pragma once
/// Smooth functions of means of excursions, with intervals by the delta method.

#include <complex>
#include <cstddef>
#include <span>
#include <utility>
#include <valarray>
#include <vector>

#include "stickslip/simulation/comoments.hpp"

namespace stickslip::simulation {

/// An estimate with its 95 % confidence interval.
struct Estimate {
  double value = 0, low = 0, high = 0;
};

/// A function of means and its derivative by each of them; none of a constant.
struct Smooth {
  using Complex = std::complex<double>;

  Smooth(double constant) : value(constant) {}  // NOLINT(google-explicit-constructor)
  Smooth(Complex v, std::valarray<Complex> d) : value(v), slope(std::move(d)) {}

  Complex value;
  std::valarray<Complex> slope;
};

[[nodiscard]] Smooth operator+(const Smooth& a, const Smooth& b);
[[nodiscard]] Smooth operator-(const Smooth& a, const Smooth& b);
[[nodiscard]] Smooth operator*(const Smooth& a, const Smooth& b);
[[nodiscard]] Smooth operator/(const Smooth& a, const Smooth& b);

/// Means of the same numbers over excursions from s+ and over those from s-, of which the first is
/// 1 for an excursion that ends on the other side. With symmetry there are those from s+ alone, and
/// the others are their mirror images.
class Means {
 public:
  /// One for each side; they must outlive this.
  explicit Means(std::span<const Comoments> sides) : sides_(sides) {}

  [[nodiscard]] bool symmetric() const { return sides_.size() == 1; }
  /// Mean n from s+ (side 0) or s- (side 1), whose sign in the mirror is `parity`.
  [[nodiscard]] Smooth at(std::size_t side, std::size_t n, double parity = 1) const;
  /// Mean n + i (mean n + 1).
  [[nodiscard]] Smooth complex_at(std::size_t side, std::size_t n, double parity = 1) const;
  /// The share of excursions from one side in a long path: sides are a Markov chain.
  [[nodiscard]] Smooth share(std::size_t side) const;
  /// Mean n over all excursions of a long path.
  [[nodiscard]] Smooth overall(std::size_t n, double parity = 1) const;
  /// Of the real part of f, as all that follows.
  [[nodiscard]] double variance(const Smooth& f) const;
  [[nodiscard]] Estimate estimate(const Smooth& f) const;

 private:
  std::span<const Comoments> sides_;
};

}  // namespace stickslip::simulation
