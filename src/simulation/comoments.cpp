#include "stickslip/simulation/comoments.hpp"

#include <algorithm>
#include <limits>

namespace stickslip::simulation {

void Comoments::add(std::span<const double> sample) {
  ++count_;
  for (std::size_t n = 0; n < size(); ++n) {
    deviation_[n] = sample[n] - mean_[n];
    mean_[n] += deviation_[n] / count_;
  }
  const double weight = (count_ - 1) / count_;
  double* product = product_.data();
  for (std::size_t r = 0; r < size(); ++r) {
    for (std::size_t c = 0; c <= r; ++c) *product++ += weight * deviation_[r] * deviation_[c];
  }
}

void Comoments::merge(const Comoments& other) {
  if (other.count_ == 0) return;
  const double total = count_ + other.count_, weight = count_ * (other.count_ / total);
  for (std::size_t n = 0; n < size(); ++n) deviation_[n] = other.mean_[n] - mean_[n];
  std::size_t at = 0;
  for (std::size_t r = 0; r < size(); ++r) {
    for (std::size_t c = 0; c <= r; ++c, ++at) {
      product_[at] += other.product_[at] + weight * deviation_[r] * deviation_[c];
    }
    mean_[r] += deviation_[r] * (other.count_ / total);
  }
  count_ = total;
}

double Comoments::variance_of_mean(std::span<const double> weight) const {
  if (count_ < 2) return std::numeric_limits<double>::infinity();
  double sum = 0;
  std::size_t at = 0;
  for (std::size_t r = 0; r < size(); ++r) {
    for (std::size_t c = 0; c <= r; ++c, ++at) {
      sum += (c < r ? 2 : 1) * weight[r] * weight[c] * product_[at];
    }
  }
  return std::max(sum, 0.0) / (count_ * (count_ - 1));
}

void Comoments::pack(std::vector<double>& numbers) const {
  numbers.push_back(count_);
  numbers.insert(numbers.end(), mean_.begin(), mean_.end());
  numbers.insert(numbers.end(), product_.begin(), product_.end());
}

void Comoments::unpack(std::span<const double>& numbers) {
  count_ = numbers[0];
  numbers = numbers.subspan(1);
  for (auto* part : {&mean_, &product_}) {
    std::copy_n(numbers.begin(), part->size(), part->begin());
    numbers = numbers.subspan(part->size());
  }
}

}  // namespace stickslip::simulation
