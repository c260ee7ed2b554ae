#pragma once
/// What a formula and its derivatives can be on an interval.

#include <array>
#include <cstddef>

namespace stickslip::model {

/// All numbers from low to high, which are widened by the rounding of each operation.
struct Interval {
  double low = 0, high = 0;

  [[nodiscard]] bool is_point() const { return low == high; }
  [[nodiscard]] bool is_zero() const { return low == 0 && high == 0; }
  [[nodiscard]] bool holds_zero() const { return low <= 0 && high >= 0; }
  /// Largest |x|.
  [[nodiscard]] double size() const { return low + high > 0 ? high : -low; }
};

constexpr std::size_t kJetOrder = 8;

/// Bounds on f^(k)/k!, k = 0 ... 8, inside an interval of the variable (Taylor coefficients; Moore,
/// Methods and Applications of Interval Analysis, 1979). Where f may have a jump, a kink or a pole
/// inside, `rough` is set.
struct Jet {
  std::array<Interval, kJetOrder + 1> at{};
  bool rough = false;

  Jet() = default;
  explicit Jet(double value) { at[0] = {value, value}; }
  /// The variable itself, times `slope`.
  Jet(Interval value, double slope) : at{value, Interval{slope, slope}} {}

  [[nodiscard]] bool is_zero() const;      ///< f = 0
  [[nodiscard]] bool is_constant() const;  ///< f is one number
};

[[nodiscard]] Jet operator+(const Jet& f, const Jet& g);
[[nodiscard]] Jet operator-(const Jet& f, const Jet& g);
[[nodiscard]] Jet operator-(const Jet& f);
[[nodiscard]] Jet operator*(const Jet& f, const Jet& g);
[[nodiscard]] Jet operator/(const Jet& f, const Jet& g);
[[nodiscard]] Jet pow(const Jet& f, const Jet& g);
[[nodiscard]] Jet exp(const Jet& f);
[[nodiscard]] Jet log(const Jet& f);
[[nodiscard]] Jet sqrt(const Jet& f);
[[nodiscard]] Jet sin(const Jet& f);
[[nodiscard]] Jet cos(const Jet& f);
[[nodiscard]] Jet tan(const Jet& f);
[[nodiscard]] Jet asin(const Jet& f);
[[nodiscard]] Jet acos(const Jet& f);
[[nodiscard]] Jet atan(const Jet& f);
[[nodiscard]] Jet atan2(const Jet& f, const Jet& g);
[[nodiscard]] Jet sinh(const Jet& f);
[[nodiscard]] Jet cosh(const Jet& f);
[[nodiscard]] Jet tanh(const Jet& f);
[[nodiscard]] Jet asinh(const Jet& f);
[[nodiscard]] Jet acosh(const Jet& f);
[[nodiscard]] Jet atanh(const Jet& f);
[[nodiscard]] Jet abs(const Jet& f);
[[nodiscard]] Jet sign(const Jet& f);
[[nodiscard]] Jet rint(const Jet& f);
[[nodiscard]] Jet minimum(const Jet& f, const Jet& g);
/// 1 where f < g, 0 elsewhere; values at ends of the interval do not count.
[[nodiscard]] Jet less(const Jet& f, const Jet& g);
[[nodiscard]] Jet equal(const Jet& f, const Jet& g);
/// Whether both are not 0.
[[nodiscard]] Jet both(const Jet& f, const Jet& g);
/// f where `condition` is not 0, g elsewhere.
[[nodiscard]] Jet choose(const Jet& condition, const Jet& f, const Jet& g);

}  // namespace stickslip::model
