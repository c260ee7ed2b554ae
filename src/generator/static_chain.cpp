#include "stickslip/generator/static_chain.hpp"

#include <stdexcept>

namespace stickslip::generator {
namespace {

void require_range(const model::NoiseChain& chain, int low, int high, double lambda) {
  if (high < low - 1 || high > chain.highest() || low < chain.lowest() ||
      high - low + 1 == chain.count()) {
    throw std::invalid_argument("levels outside the noise");
  }
  if (!(lambda >= 0)) throw std::invalid_argument("negative Laplace parameter");
}

linalg::RateElimination without_exits(const model::NoiseChain& chain, int low, int high,
                                      double lambda) {
  require_range(chain, low, high, lambda);
  const int count = high - low + 1;
  std::vector<double> killing(static_cast<std::size_t>(count), lambda);
  std::vector<linalg::RateElimination::Rate> rates;
  for (int i = low; i <= high; ++i) {
    chain.for_each_jump(i, [&](int to, double rate) {
      if (low <= to && to <= high) {
        rates.push_back({i - low, to - low, rate});
      } else {
        killing[i - low] += rate;
      }
    });
  }
  return {std::move(killing), rates};
}

}  // namespace

StaticChain::StaticChain(const model::NoiseChain& chain, int low, int high, double lambda)
    : high_(high), rates_(without_exits(chain, low, high, lambda)) {
  for (int i = low; i <= high; ++i) {
    chain.for_each_jump(i, [&](int to, double rate) {
      if (low <= to && to <= high) return;
      auto& exit = exits_[to];
      exit.resize(static_cast<std::size_t>(size()));
      exit[i - low] = rate;
    });
  }
}

template <class Counts>
std::vector<double> StaticChain::transform(Counts counts) const {
  std::vector<double> leaving(static_cast<std::size_t>(size()), 0.0);
  for (const auto& [to, rates] : exits_) {
    for (std::size_t n = 0; counts(to) && n < rates.size(); ++n) leaving[n] += rates[n];
  }
  return rates_.integral(std::move(leaving));
}

std::vector<double> StaticChain::exit_transform() const {
  return transform([](int) { return true; });
}

std::vector<double> StaticChain::upward_exit_transform() const {
  return transform([this](int to) { return to > high_; });
}

std::vector<double> StaticChain::downward_exit_transform() const {
  return transform([this](int to) { return to <= high_; });
}

std::vector<double> StaticChain::exit_transform_to(int level) const {
  return transform([level](int to) { return to == level; });
}

}  // namespace stickslip::generator
