#include "stickslip/simulation/means.hpp"

#include <cmath>

#include "stickslip/support/statistics.hpp"

namespace stickslip::simulation {
namespace {

using Complex = Smooth::Complex;

std::valarray<Complex> sum(const Smooth& a, Complex by_a, const Smooth& b, Complex by_b) {
  if (b.slope.size() == 0) return a.slope * by_a;
  if (a.slope.size() == 0) return b.slope * by_b;
  return a.slope * by_a + b.slope * by_b;
}

}  // namespace

Smooth operator+(const Smooth& a, const Smooth& b) { return {a.value + b.value, sum(a, 1, b, 1)}; }
Smooth operator-(const Smooth& a, const Smooth& b) { return {a.value - b.value, sum(a, 1, b, -1)}; }
Smooth operator*(const Smooth& a, const Smooth& b) {
  return {a.value * b.value, sum(a, b.value, b, a.value)};
}
Smooth operator/(const Smooth& a, const Smooth& b) {
  const Complex value = a.value / b.value;
  return {value, sum(a, 1.0 / b.value, b, -value / b.value)};
}

Smooth Means::at(std::size_t side, std::size_t n, double parity) const {
  if (symmetric() && side == 1) return parity * at(0, n);
  std::valarray<Complex> slope(Complex(0), sides_.size() * sides_[0].size());
  slope[side * sides_[0].size() + n] = 1;
  return {sides_[side].mean(n), slope};
}

Smooth Means::complex_at(std::size_t side, std::size_t n, double parity) const {
  const Smooth imaginary = at(side, n + 1, parity);
  const Complex i(0, 1);
  return at(side, n, parity) + Smooth(i * imaginary.value, imaginary.slope * i);
}

Smooth Means::share(std::size_t side) const {
  return symmetric() ? Smooth(0.5) : at(1 - side, 0) / (at(0, 0) + at(1, 0));
}

Smooth Means::overall(std::size_t n, double parity) const {
  if (cycles()) return at(0, n) / at(0, 0);
  return share(0) * at(0, n) + share(1) * at(1, n, parity);
}

double Means::variance(const Smooth& f) const {
  double variance = 0;
  std::vector<double> weight(sides_[0].size());
  for (std::size_t side = 0; side < sides_.size() && f.slope.size() > 0; ++side) {
    for (std::size_t n = 0; n < weight.size(); ++n) {
      weight[n] = f.slope[side * weight.size() + n].real();
    }
    variance += sides_[side].variance_of_mean(weight);
  }
  return variance;
}

Estimate Means::estimate(const Smooth& f) const {
  const double half = kNormalQuantile * std::sqrt(variance(f)), value = f.value.real();
  return {value, value - half, value + half};
}

}  // namespace stickslip::simulation
