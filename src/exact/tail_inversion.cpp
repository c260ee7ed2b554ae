#include "stickslip/exact/tail_inversion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stickslip::exact {

using Complex = std::complex<double>;

namespace {

constexpr double kShorter = 2.0 / 3;

// 1 up to 0.6 and 0 at 1, with all derivatives.
double window(double x) {
  constexpr double flat = 0.6;
  const double u = (x - flat) / (1 - flat);
  if (u <= 0) return 1;
  return u >= 1 ? 0 : 1 / (1 + std::exp(1 / (1 - u) - 1 / u));
}

}  // namespace

TailInversion::TailInversion(const FourierInversion::Transform& phi, double s, double mean,
                             double deviation, double accuracy, int most)
    : s_(s), step_(0.6 / deviation) {
  for (bool open = true; open;) {
    sample(phi);
    const double here = sum(mean, false, 1, 1);
    // What phi leaves open is no matter of step and range.
    const double enough = std::max(accuracy * std::abs(here), doubt(mean, false));
    const bool coarse = !(aliased(mean, false, here) <= enough),
               cut = !(std::abs(here - sum(mean, false, 1, kShorter)) <= enough);
    open = (coarse || cut) && count_ < most;
    if (open && coarse) step_ /= 2;
    if (open) count_ = coarse ? 2 * count_ : count_ + count_ / 2;
  }
}

void TailInversion::sample(const FourierInversion::Transform& phi) {
  for (int n = 0; n < count_; ++n) {
    const double k = n * step_;
    if (!known_.contains(k)) known_[k] = phi(k);
  }
}

Complex TailInversion::weight(double k, double d, bool density) const {
  const Complex turned = std::polar(step_ * (k == 0 ? 0.5 : 1) / std::numbers::pi, -k * d);
  return density ? turned : turned / (s_ > 0 ? Complex(s_, k) : -Complex(s_, k));
}

double TailInversion::sum(double d, bool density, int stride, double share) const {
  double all = 0;
  for (int n = 0; n < count_; n += stride) {
    const double k = n * step_;
    all +=
        stride * window(n / (share * count_)) * (weight(k, d, density) * known_.at(k).value).real();
  }
  return all;
}

double TailInversion::aliased(double d, bool density, double value) const {
  const double change = value - sum(d, density, 2, 1);
  return std::abs(change * std::min(1.0, 3 * change / value));
}

double TailInversion::doubt(double d, bool density) const {
  double all = 0;
  for (int n = 0; n < count_; ++n) {
    all += std::abs(weight(n * step_, d, density)) * known_.at(n * step_).error;
  }
  return all;
}

Uncertain TailInversion::with_error(double d, bool density) const {
  const double value = sum(d, density, 1, 1);
  return {value, aliased(d, density, value) + std::abs(value - sum(d, density, 1, kShorter)) +
                     doubt(d, density)};
}

}  // namespace stickslip::exact
