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
      : size_(size), numbers_(1 + size + size * (size + 1) / 2, 0.0), deviation_(size) {}

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] double count() const { return numbers_[0]; }
  [[nodiscard]] double mean(std::size_t n) const { return numbers_[1 + n]; }

  /// `times` samples, all alike. Faster where their size is known to the compiler. O(size^2).
  template <std::size_t size>
  void add(std::span<const double, size> sample, double times) {
    double* const mean = numbers_.data() + 1;
    double* const deviation = deviation_.data();
    double* product = mean + sample.size();
    const double count = numbers_[0] += times, weight = times * (count - times) / count;
    for (std::size_t r = 0; r < sample.size(); ++r) {
      deviation[r] = sample[r] - mean[r];
      mean[r] += times * deviation[r] / count;
      const double weighted = weight * deviation[r];
      for (std::size_t c = 0; c <= r; ++c) *product++ += weighted * deviation[c];
    }
  }
  void add(std::span<const double> sample, double times = 1) {
    add<std::dynamic_extent>(sample, times);
  }
  /// As if all samples of others of the same size had been added, of which these are the numbers.
  void merge(std::span<const double> others);

  /// Variance of the mean of sum_n weight_n sample_n; infinite for fewer than two samples.
  [[nodiscard]] double variance_of_mean(std::span<const double> weight) const;

  /// All that is kept, in a row.
  [[nodiscard]] std::span<double> numbers() { return numbers_; }
  [[nodiscard]] std::span<const double> numbers() const { return numbers_; }

 private:
  std::size_t size_;
  std::vector<double> numbers_;    // count, means, products: the lower triangle by rows
  std::vector<double> deviation_;  // scratch
};

}  // namespace stickslip::simulation
