#include "stickslip/operators/static_chain.hpp"

#include <stdexcept>

namespace stickslip::operators {

// Eliminating the levels from below leaves on level i the chain watched on {i, i+1, ...}: its
// killing rate grows by down_i times the share of killing at i-1, and its pivot is that killing
// rate plus the rate of going up.
StaticChain::StaticChain(const model::NoiseChain& chain, int low, int high, double lambda) {
  if (high < low - 1 || high > chain.highest() || low < chain.lowest() ||
      high - low + 1 == chain.count()) {
    throw std::invalid_argument("levels outside the noise");
  }
  if (!(lambda >= 0)) throw std::invalid_argument("negative Laplace parameter");
  if (high < low) return;
  up_exit_ = chain.up_rate(high);
  down_exit_ = chain.down_rate(low);
  double killing_below = 0;
  for (int i = low; i <= high; ++i) {
    const double up = chain.up_rate(i), down = chain.down_rate(i);
    double killing = lambda + (i == low ? down : 0) + (i == high ? up : 0);
    if (i > low) killing += down * killing_below / pivot_.back();
    up_.push_back(i < high ? up : 0);
    down_.push_back(i > low ? down : 0);
    pivot_.push_back(killing + up_.back());
    killing_below = killing;
  }
}

std::vector<double> StaticChain::occupation(std::span<const double> entry) const {
  if (entry.size() != pivot_.size())
    throw std::invalid_argument("hitting distribution of a wrong size");
  std::vector<double> m(entry.begin(), entry.end());
  if (m.empty()) return m;
  for (int i = 1; i < size(); ++i) m[i] += m[i - 1] * up_[i - 1] / pivot_[i - 1];
  m.back() /= pivot_.back();
  for (int i = size() - 2; i >= 0; --i) m[i] = (m[i] + m[i + 1] * down_[i + 1]) / pivot_[i];
  return m;
}

std::vector<double> StaticChain::integral(std::vector<double> f) const {
  if (f.size() != pivot_.size()) throw std::invalid_argument("observable of a wrong size");
  if (f.empty()) return f;
  for (int i = 1; i < size(); ++i) f[i] += down_[i] * f[i - 1] / pivot_[i - 1];
  f.back() /= pivot_.back();
  for (int i = size() - 2; i >= 0; --i) f[i] = (f[i] + up_[i] * f[i + 1]) / pivot_[i];
  return f;
}

std::vector<double> StaticChain::exit_transform() const {
  std::vector<double> leaving(pivot_.size(), 0.0);
  leaving.front() += down_exit_;
  leaving.back() += up_exit_;
  return integral(std::move(leaving));
}

std::vector<double> StaticChain::upward_exit_transform() const {
  std::vector<double> leaving(pivot_.size(), 0.0);
  if (!leaving.empty()) leaving.back() = up_exit_;
  return integral(std::move(leaving));
}

std::vector<double> StaticChain::downward_exit_transform() const {
  std::vector<double> leaving(pivot_.size(), 0.0);
  if (!leaving.empty()) leaving.front() = down_exit_;
  return integral(std::move(leaving));
}

}  // namespace stickslip::operators
