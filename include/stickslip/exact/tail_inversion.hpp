#pragma once
/// Small probabilities from a characteristic function of weighted paths.

#include <complex>
#include <map>

#include "stickslip/exact/fourier_inversion.hpp"

namespace stickslip::exact {

/// The tail of a density f on the side of a tilt s, beyond x > 0 for s > 0 and below for s < 0:
/// with phi(k) = int f(x) exp((s + i k) x) dx / int f(x) exp(s x) dx and m that integral,
///
///   P(d) = m exp(-s d) 1/pi int_0^infinity Re exp(-i k d) phi(k)/|s + i k| dk,
///
/// where |s + i k| stands for s + i k or minus that, the sign being that of s. Nothing cancels for
/// d near the mean of the weighted density, so that the tail is as accurate as phi.
///
/// By the trapezoidal rule, which is off by the tails at d + n 2 pi/h, n = +-1, +-2 ..., and a
/// window that falls smoothly to 0 at the largest k, so that edges of f elsewhere do not show. Step
/// and largest k are refined for the mean. Errors are what changes by a step of twice the length
/// show, the changes by a range of two thirds, and those of phi. Local.
class TailInversion {
 public:
  using Transformed = FourierInversion::Transformed;

  /// Takes mean and standard deviation of the weighted density; `accuracy` is relative, `most` the
  /// largest number of wavenumbers.
  TailInversion(const FourierInversion::Transform& phi, double s, double mean, double deviation,
                double accuracy, int most);

  /// exp(s d) P(d)/m. O(wavenumbers).
  [[nodiscard]] Uncertain beyond(double d) const { return with_error(d, false); }
  /// exp(s d) f(d)/m. O(wavenumbers).
  [[nodiscard]] Uncertain density(double d) const { return with_error(d, true); }
  [[nodiscard]] int evaluations() const { return static_cast<int>(known_.size()); }

 private:
  // What is summed at k.
  [[nodiscard]] std::complex<double> weight(double k, double d, bool density) const;
  // With steps of `stride` times the step up to `share` of the range.
  [[nodiscard]] double sum(double d, bool density, int stride, double share) const;
  // By the tails at other d: what falls like exp(-1/h) is, with the step, the square of what it is
  // with twice the step.
  [[nodiscard]] double aliased(double d, bool density, double value) const;
  // By errors of phi.
  [[nodiscard]] double doubt(double d, bool density) const;
  [[nodiscard]] Uncertain with_error(double d, bool density) const;
  void sample(const FourierInversion::Transform& phi);

  double s_, step_;
  int count_ = 8;
  std::map<double, Transformed> known_;
};

}  // namespace stickslip::exact
