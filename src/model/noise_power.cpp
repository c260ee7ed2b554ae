#include "stickslip/model/noise_power.hpp"

#include <algorithm>
#include <complex>
#include <cstdlib>
#include <numeric>
#include <vector>

namespace stickslip::model {

double power_spectral_density(const NoiseChain& chain, double omega) {
  // Where i omega - Q is singular, the integral over all times is known.
  if (omega == 0) return 2 * chain.intensity();
  const int lowest = chain.lowest(), count = chain.count();
  const auto p = stationary_distribution(chain);
  int band = 0;
  for (int n = 0; n < count; ++n) {
    chain.for_each_jump(lowest + n,
                        [&](int to, double) { band = std::max(band, std::abs(to - lowest - n)); });
  }
  using Complex = std::complex<double>;
  const int width = 2 * band + 1;
  std::vector<Complex> a(static_cast<std::size_t>(count) * static_cast<std::size_t>(width)), phi;
  const auto entry = [&](int row, int column) -> Complex& {
    return a[static_cast<std::size_t>(row) * width + static_cast<std::size_t>(column - row + band)];
  };
  double mean = 0;
  for (int n = 0; n < count; ++n) mean += p[n] * chain.level(lowest + n);
  for (int n = 0; n < count; ++n) {
    entry(n, n) = Complex(0, omega);
    chain.for_each_jump(lowest + n, [&](int to, double rate) {
      entry(n, to - lowest) -= rate;
      entry(n, n) += rate;
    });
    phi.emplace_back(chain.level(lowest + n) - mean);
  }
  const auto f = phi;
  // Rows are diagonally dominant, so that no pivot has to be looked for.
  for (int i = 0; i < count; ++i) {
    const int last = std::min(i + band, count - 1);
    for (int j = i + 1; j <= last; ++j) {
      const Complex factor = entry(j, i) / entry(i, i);
      if (factor == Complex(0)) continue;
      for (int k = i + 1; k <= last; ++k) entry(j, k) -= factor * entry(i, k);
      phi[j] -= factor * phi[i];
    }
  }
  Complex sum = 0;
  for (int i = count - 1; i >= 0; --i) {
    for (int k = i + 1; k <= std::min(i + band, count - 1); ++k) phi[i] -= entry(i, k) * phi[k];
    phi[i] /= entry(i, i);
    sum += p[i] * f[i] * phi[i];
  }
  return 2 * sum.real();
}

}  // namespace stickslip::model
