#include "stickslip/algebra/rate_elimination.hpp"

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <stdexcept>

namespace stickslip::algebra {

RateElimination::RateElimination(std::vector<double> killing, const std::vector<Rate>& rates)
    : killing_(std::move(killing)) {
  for (const auto& [from, to, value] : rates) band_ = std::max(band_, std::abs(to - from));
  rates_.resize(killing_.size() * (2 * static_cast<std::size_t>(band_) + 1));
  for (const auto& [from, to, value] : rates) entry(from, to) += value;
  factor();
}

int RateElimination::last_of(int row) const { return std::min(row + band_, size() - 1); }

// The pivot of a state is the rate at which the watched chain leaves it: to states above, or
// killed.
void RateElimination::factor() {
  pivot_.assign(killing_.size(), 0.0);
  for (int i = 0; i < size(); ++i) {
    const int last = last_of(i);
    double pivot = killing_[i];
    for (int k = i + 1; k <= last; ++k) pivot += entry(i, k);
    pivot_[i] = pivot;
    if (!(pivot > 0)) {
      if (i + 1 == size()) return;
      throw std::invalid_argument("a state is never left");
    }
    for (int j = i + 1; j <= last; ++j) {
      const double back = entry(j, i);
      if (back == 0) continue;
      killing_[j] += back * killing_[i] / pivot;
      for (int k = i + 1; k <= last; ++k) {
        if (k != j) entry(j, k) += back * entry(i, k) / pivot;
      }
    }
  }
}

std::vector<double> RateElimination::occupation(std::span<const double> entry_law) const {
  if (entry_law.size() != killing_.size()) {
    throw std::invalid_argument("a distribution of a wrong size");
  }
  std::vector<double> m(entry_law.begin(), entry_law.end());
  for (int i = 0; i < size(); ++i) {
    for (int k = i + 1; k <= last_of(i); ++k) m[k] += m[i] * entry(i, k) / pivot_[i];
  }
  for (int i = size() - 1; i >= 0; --i) {
    for (int k = i + 1; k <= last_of(i); ++k) m[i] += m[k] * entry(k, i);
    m[i] /= pivot_[i];
  }
  return m;
}

std::vector<double> RateElimination::integral(std::vector<double> f) const {
  if (f.size() != killing_.size()) throw std::invalid_argument("a function of a wrong size");
  for (int i = 0; i < size(); ++i) {
    for (int k = i + 1; k <= last_of(i); ++k) f[k] += entry(k, i) * f[i] / pivot_[i];
  }
  for (int i = size() - 1; i >= 0; --i) {
    for (int k = i + 1; k <= last_of(i); ++k) f[i] += entry(i, k) * f[k];
    f[i] /= pivot_[i];
  }
  return f;
}

std::vector<double> RateElimination::stationary() const {
  std::vector<double> p(killing_.size(), 0.0);
  if (p.empty()) return p;
  p.back() = 1;
  for (int i = size() - 2; i >= 0; --i) {
    for (int k = i + 1; k <= last_of(i); ++k) p[i] += p[k] * entry(k, i);
    p[i] /= pivot_[i];
    // Far from the last state weights may be beyond the range of numbers.
    constexpr double large = 1e200;
    if (p[i] < large) continue;
    for (double& value : p) value /= large;
  }
  const double total = std::accumulate(p.begin(), p.end(), 0.0);
  for (double& value : p) value /= total;
  return p;
}

}  // namespace stickslip::algebra
