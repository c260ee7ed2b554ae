#include "stickslip/model/noise_chain.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "stickslip/model/grid_index.hpp"

namespace stickslip::model {
namespace {

// The first level above x, or also one that equals it; highest + 1 if there is none.
int first_beyond(const LevelTable& table, double x, bool above) {
  int low = table.lowest(), high = table.highest() + 1;
  while (low < high) {
    const int middle = low + (high - low) / 2;
    const double difference = snapped_difference(table.at(middle).x, x);
    if (difference < 0 || (above && difference == 0)) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}

}  // namespace

double NoiseChain::up(int i) const {
  if (table) return table->at(i).up / rate(i);
  if (i >= levels) return 0;
  if (i <= -levels) return 1;
  return std::clamp((1 - precision() * delta * level(i) / 2) / 2, 0.0, 1.0);
}

double NoiseChain::down(int i) const { return table ? table->at(i).down / rate(i) : up(-i); }

double NoiseChain::up_change(int i) const {
  return deviation || std::abs(i) >= levels ? 0 : -delta * level(i) / 4;
}

double NoiseChain::standard_deviation() const {
  return table ? std::sqrt(table->variance()) : deviation.value_or(1 / std::sqrt(tau));
}

double NoiseChain::intensity() const {
  if (table) return table->intensity();
  return deviation ? *deviation * *deviation * tau : 1;
}

double NoiseChain::correlation_time() const {
  return table ? table->intensity() / table->variance() : tau;
}

int NoiseChain::last_up_to(double x) const {
  if (table) return first_beyond(*table, x, true) - 1;
  return floor_index(std::clamp<double>(x / delta, -levels - 1.0, levels));
}

int NoiseChain::first_from(double x) const {
  if (table) return first_beyond(*table, x, false);
  return -floor_index(std::clamp<double>(-x / delta, -levels - 1.0, levels));
}

std::optional<int> NoiseChain::find(double x) const {
  // A level far outside the chain need not fit an integer.
  const int i = last_up_to(std::clamp(x, level(lowest()), level(highest())));
  constexpr double rounding = 1e-9;  // of what people write
  for (int near : {i, i + 1}) {
    if (near < lowest() || near > highest()) continue;
    if (std::abs(level(near) - x) <= rounding * std::max(step(), std::abs(x))) return near;
  }
  return std::nullopt;
}

double NoiseChain::place(double x) const {
  if (!table) return x / delta;
  // Several levels at an end may have its force.
  int below = std::clamp(last_up_to(x), lowest(), highest() - 1), above = below + 1;
  while (level(below) == level(above) && below > lowest()) --below;
  while (level(below) == level(above) && above < highest()) ++above;
  const double rise = level(above) - level(below);
  return rise > 0 ? below + (x - level(below)) / rise * (above - below) : below;
}

NoiseChain NoiseChain::mirrored() const {
  NoiseChain other = *this;
  if (table) other.table = std::make_shared<const LevelTable>(table->mirrored());
  return other;
}

int full_range(double tau, double delta, std::optional<double> deviation) {
  const double inverse = deviation ? 1 / (*deviation * *deviation) : tau;
  return floor_index(2 / (inverse * delta * delta));
}

double weight_ratio(const NoiseChain& chain, int i) {
  return chain.table ? chain.table->weight_ratio(i) : chain.up(i - 1) / chain.down(i);
}

std::vector<double> stationary_distribution(const NoiseChain& chain) {
  const int mode = chain.table ? chain.table->mode() : 0, low = chain.lowest();
  std::vector<double> p(static_cast<std::size_t>(chain.count()));
  p[mode - low] = 1;
  for (int i = mode + 1; i <= chain.highest(); ++i) {
    p[i - low] = p[i - 1 - low] * weight_ratio(chain, i);
  }
  for (int i = mode; i > low; --i) p[i - 1 - low] = p[i - low] / weight_ratio(chain, i);
  double above = 0, below = 0;  // from the small tail weights to the large central one
  for (int i = chain.highest(); i > mode; --i) above += p[i - low];
  for (int i = low; i < mode; ++i) below += p[i - low];
  const double total = above + below + p[mode - low];
  for (double& value : p) value /= total;
  return p;
}

double rounding_of_sums(const NoiseChain& chain) {
  return std::numeric_limits<double>::epsilon() * (4 + std::sqrt(chain.count() / 2));
}

NoiseMoments noise_moments(const NoiseChain& chain, int low, int high) {
  const int mode = chain.table ? chain.table->mode() : 0;
  double within = 0, beyond = 0, square = 0;
  const auto add = [&](int i, double weight) {
    (low <= i && i <= high ? within : beyond) += weight;
    square += weight * chain.level(i) * chain.level(i);
  };
  add(mode, 1);
  double weight = 1;
  for (int i = mode + 1; i <= chain.highest() && weight > 0; ++i) {
    add(i, weight *= weight_ratio(chain, i));
  }
  weight = 1;
  for (int i = mode; i > chain.lowest() && weight > 0; --i) {
    add(i - 1, weight /= weight_ratio(chain, i));
  }
  const double total = within + beyond;
  return {within / total, beyond / total, square / total};
}

}  // namespace stickslip::model
