#include "stickslip/model/noise_power.hpp"

#include <algorithm>
#include <complex>
#include <cstdlib>
#include <numeric>
#include <vector>

namespace stickslip::model {
namespace {

// int_0^infinity Cov(X_0, X_t) dt of the chain of steps as it ends: an edge passes on S_i = sum_(j
// <= i) pi_j x_j, as LevelTable has it, and both halves are alike.
double intensity(const NoiseChain& chain) {
  const auto p = stationary_distribution(chain);
  double below = 0, sum = 0;
  for (int i = chain.lowest(); i < 0; ++i) {
    const double weight = p[i - chain.lowest()], flow = weight * chain.up_rate(i);
    below += weight * chain.level(i);
    if (flow > 0) sum += below * (below / flow);
  }
  return 2 * sum;
}

}  // namespace

double power_spectral_density(const NoiseChain& chain, double omega) {
  // Where i omega - Q is singular, the integral over all times.
  if (omega == 0) return 2 * (chain.table ? chain.intensity() : intensity(chain));
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
