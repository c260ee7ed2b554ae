#pragma once
/// Means and covariances of samples, by updates and merges that do not cancel.

#include <cstddef>
#include <span>
#include <vector>

namespace stickslip::simulation {

/// Count, means and sums of products of deviations of a vector of numbers (Chan, Golub and LeVeque,
/// The American Statistician 37, 1983). Local.
class Comoments {
 public:
  explicit Comoments(std::size_t size)
      : mean_(size, 0.0), product_(size * (size + 1) / 2, 0.0), deviation_(size) {}

  [[nodiscard]] std::size_t size() const { return mean_.size(); }
  [[nodiscard]] double count() const { return count_; }
  [[nodiscard]] double mean(std::size_t n) const { return mean_[n]; }

  /// O(size^2).
  void add(std::span<const double> sample);
  /// As if all samples of `other` had been added.
  void merge(const Comoments& other);

  /// Variance of the mean of sum_n weight_n sample_n; infinite for fewer than two samples.
  [[nodiscard]] double variance_of_mean(std::span<const double> weight) const;

  /// How many numbers pack() appends.
  [[nodiscard]] std::size_t packed_size() const { return 1 + mean_.size() + product_.size(); }
  /// Appends all to `numbers`; unpack takes it from `at` on and moves it.
  void pack(std::vector<double>& numbers) const;
  void unpack(std::span<const double>& numbers);

 private:
  double count_ = 0;
  std::vector<double> mean_, product_;  // lower triangle by rows
  std::vector<double> deviation_;       // scratch
};

}  // namespace stickslip::simulation
