#include "stickslip/simulation/comoments.hpp"

#include <algorithm>

#include "stickslip/support/infinity.hpp"

namespace stickslip::simulation {

void Comoments::merge(std::span<const double> others) {
  const double more = others[0];
  if (more == 0) return;
  const double total = count() + more, share = more / total;
  const double weight = count() * share;
  for (std::size_t n = 0; n < size_; ++n) deviation_[n] = others[1 + n] - mean(n);
  std::size_t at = 1 + size_;
  for (std::size_t r = 0; r < size_; ++r) {
    for (std::size_t c = 0; c <= r; ++c, ++at) {
      numbers_[at] += others[at] + weight * deviation_[r] * deviation_[c];
    }
    numbers_[1 + r] += deviation_[r] * share;
  }
  numbers_[0] = total;
}

double Comoments::variance_of_mean(std::span<const double> weight) const {
  if (count() < 2) return kInfinity;
  double sum = 0;
  std::size_t at = 1 + size_;
  for (std::size_t r = 0; r < size_; ++r) {
    for (std::size_t c = 0; c <= r; ++c, ++at) {
      sum += (c < r ? 2 : 1) * weight[r] * weight[c] * numbers_[at];
    }
  }
  return std::max(sum, 0.0) / (count() * (count() - 1));
}

}  // namespace stickslip::simulation
