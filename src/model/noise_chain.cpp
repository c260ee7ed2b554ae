#include "stickslip/model/noise_chain.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "stickslip/model/grid_index.hpp"

namespace stickslip::model {

double NoiseChain::up(int i) const {
  if (i >= levels) return 0;
  if (i <= -levels) return 1;
  return std::clamp((1 - tau * delta * level(i) / 2) / 2, 0.0, 1.0);
}

double NoiseChain::up_change(int i) const {
  return std::abs(i) >= levels ? 0 : -delta * level(i) / 4;
}

int full_range(double tau, double delta) { return floor_index(2 / (tau * delta * delta)); }

double weight_ratio(const NoiseChain& chain, int i) { return chain.up(i - 1) / chain.down(i); }

std::vector<double> stationary_distribution(const NoiseChain& chain) {
  const int n = chain.levels;
  std::vector<double> law(2 * static_cast<std::size_t>(n) + 1);
  double weight = 1;
  law[n] = weight;
  for (int i = 1; i <= n; ++i) {
    weight *= weight_ratio(chain, i);
    law[n + i] = law[n - i] = weight;
  }
  double total = 0;  // from the small tail weights to the large central one
  for (int i = n; i >= 1; --i) total += 2 * law[n + i];
  total += law[n];
  for (double& p : law) p /= total;
  return law;
}

double rounding_of_sums(const NoiseChain& chain) {
  return std::numeric_limits<double>::epsilon() * (4 + std::sqrt(chain.levels));
}

NoiseMoments noise_moments(const NoiseChain& chain, int k) {
  double weight = 1, within = 1, beyond = 0, second = 0;
  for (int i = 1; i <= chain.levels && weight > 0; ++i) {
    weight *= weight_ratio(chain, i);
    (i <= k ? within : beyond) += 2 * weight;
    second += 2 * weight * chain.level(i) * chain.level(i);
  }
  const double total = within + beyond;
  return {within / total, beyond / total, second / total};
}

}  // namespace stickslip::model
