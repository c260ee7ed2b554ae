#pragma once
/// Sums over excursions, and smooth functions of their means with intervals by the delta method.

#include <algorithm>
#include <complex>
#include <cstddef>
#include <functional>
#include <initializer_list>
#include <span>
#include <type_traits>
#include <utility>
#include <valarray>
#include <vector>

namespace stickslip::simulation {

// Means and covariances of samples, by updates and merges that do not cancel.

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

/// An estimate with its 95 % confidence interval.
struct Estimate {
  double value = 0, low = 0, high = 0;
};

[[nodiscard]] inline Estimate operator/(const Estimate& e, double by) {
  return {e.value / by, e.low / by, e.high / by};
}

/// A function of means and its derivative by each of them; none of a constant.
struct Smooth {
  using Complex = std::complex<double>;

  Smooth(double constant) : value(constant) {}  // NOLINT(google-explicit-constructor)
  Smooth(Complex v, std::valarray<Complex> d) : value(v), slope(std::move(d)) {}

  Complex value;
  std::valarray<Complex> slope;
};

[[nodiscard]] Smooth operator+(const Smooth& a, const Smooth& b);
[[nodiscard]] Smooth operator-(const Smooth& a, const Smooth& b);
[[nodiscard]] Smooth operator*(const Smooth& a, const Smooth& b);
[[nodiscard]] Smooth operator/(const Smooth& a, const Smooth& b);

/// What samples are.
enum class Sampled {
  sides,     ///< excursions from s+ and from s-, which follow one another by a Markov chain
  one_side,  ///< those from s+, where those from s- are their mirror images
  cycles     ///< all excursions from one of a level to the next from the same: a cycle renews
};

/// Means of the same numbers over samples. The first number is 1 for an excursion that ends on the
/// other side, and 0 for others; of a cycle it is the number of excursions, and the others are sums
/// over them.
class Means {
 public:
  /// One for each side; they must outlive this.
  explicit Means(std::span<const Comoments> sides, Sampled sampled)
      : sides_(sides), sampled_(sampled) {}

  [[nodiscard]] bool symmetric() const { return sampled_ == Sampled::one_side; }
  [[nodiscard]] double count() const { return sides_[0].count(); }  ///< of samples
  [[nodiscard]] bool cycles() const { return sampled_ == Sampled::cycles; }
  /// Mean n from s+ (side 0) or s- (side 1), whose sign in the mirror is `parity`.
  [[nodiscard]] Smooth at(std::size_t side, std::size_t n, double parity = 1) const;
  /// Mean n + i (mean n + 1).
  [[nodiscard]] Smooth complex_at(std::size_t side, std::size_t n, double parity = 1) const;
  /// The share of excursions from one side that end on the other.
  [[nodiscard]] Smooth turned(std::size_t side) const { return at(side, 0); }
  /// The share of excursions from one side in a long path: sides are a Markov chain.
  [[nodiscard]] Smooth share(std::size_t side) const;
  /// Mean n over all excursions of a long path.
  [[nodiscard]] Smooth overall(std::size_t n, double parity = 1) const;
  /// Of the real part of f, as all that follows.
  [[nodiscard]] double variance(const Smooth& f) const;
  [[nodiscard]] Estimate estimate(const Smooth& f) const;
  /// The same, where the means with these numbers are of samples from 0 to 1 which few may carry,
  /// such as exp(-lambda T) at a large lambda: the interval then covers what samples of this count
  /// miss.
  [[nodiscard]] Estimate estimate(const Smooth& f, const std::vector<std::size_t>& shares) const;

 private:
  /// By how much Jeffreys' interval for as many trials as samples reaches beyond that of the delta
  /// method, where few samples carry mean n from 0 to 1; 0 elsewhere.
  [[nodiscard]] double missed(std::size_t side, std::size_t n) const;

  std::span<const Comoments> sides_;
  Sampled sampled_;
};

/// Means and covariances over excursions from each side of the numbers in a struct of doubles and
/// complex numbers, such as
///
///   struct Phases { double slide, stick; };
///   sums.add(side, {turned, {1.5, 0.5}});
///   sums.estimate(sums.overall(&Phases::slide));
///
/// Copies share what is kept, which has to outlive them. Local.
template <class Sample>
class Sums : public Means {
  static_assert(std::is_trivially_copyable_v<Sample> && sizeof(Sample) % sizeof(double) == 0);

 public:
  /// Size of the co-moments: whether an excursion turns, and the numbers.
  static constexpr std::size_t kSize = 1 + sizeof(Sample) / sizeof(double);

  Sums(std::span<Comoments> sides, Sampled sampled) : Means(sides, sampled), sides_(sides) {}

  /// A sample, and the number before it.
  struct Row {
    double first;
    Sample sample;

    Row& operator+=(const Row& other) {
      auto* const sums = reinterpret_cast<double*>(this);
      const auto* const more = reinterpret_cast<const double*>(&other);
      for (std::size_t n = 0; n < kSize; ++n) sums[n] += more[n];
      return *this;
    }
  };
  /// Of an excursion from a side. O(kSize^2).
  void add(std::size_t side, const Row& row) {
    const std::span<const double, kSize> numbers(reinterpret_cast<const double*>(&row), kSize);
    sides_[side].add(numbers, 1);
  }

  /// As those of Means.
  template <class Number>
  [[nodiscard]] Smooth at(std::size_t side, Number Sample::*which, double parity = 1) const {
    if constexpr (std::is_same_v<Number, double>) return Means::at(side, column(which), parity);
    return complex_at(side, column(which), parity);
  }
  [[nodiscard]] Smooth overall(double Sample::*which, double parity = 1) const {
    return Means::overall(column(which), parity);
  }
  using Means::estimate;
  [[nodiscard]] Estimate estimate(const Smooth& f,
                                  std::initializer_list<double Sample::*> shares) const {
    std::vector<std::size_t> columns;
    for (const auto which : shares) columns.push_back(column(which));
    return Means::estimate(f, columns);
  }
  /// What a long path gathers in a unit of time, given what it gathers in an excursion. The sample
  /// has the durations of both phases.
  [[nodiscard]] Estimate over_time(const Smooth& total) const {
    return estimate(total / (overall(&Sample::slide) + overall(&Sample::stick)));
  }

 private:
  template <class Number>
  static std::size_t column(Number Sample::*which) {
    static constexpr Sample sample{};
    const auto* const begin = reinterpret_cast<const char*>(&sample);
    const auto* const here = reinterpret_cast<const char*>(&(sample.*which));
    return 1 + static_cast<std::size_t>(here - begin) / sizeof(double);
  }

  std::span<Comoments> sides_;
};

// How many excursions have a number between edges.

/// The mean of numbers from 0 to `largest`, from `count` samples: Jeffreys' interval for as many
/// trials as give the variance of the delta method.
[[nodiscard]] Estimate jeffreys(const Means& means, const Smooth& mean, double largest,
                                double count);

/// Counts by the side from which an excursion starts, by whether it ends on the other one, and by
/// bin, of which the n-th is below the n-th of the rising edges. With symmetry all start at s+.
class Histogram {
 public:
  Histogram(bool symmetric, std::vector<double> edges)
      : edges_(std::move(edges)), bins_(edges_.size() + 1), counts_((symmetric ? 2 : 4) * bins_) {}

  void add(std::size_t side, bool turned, double value) {
    counts_[(2 * side + (turned ? 1 : 0)) * bins_ + bin(value)] += 1;
  }
  [[nodiscard]] std::span<double> counts() { return counts_; }
  [[nodiscard]] std::span<const double> counts() const { return counts_; }

  /// Mean of weight(bin) >= 0 over all excursions of a long path, or over those from one side.
  using Weight = std::function<double(std::size_t bin)>;
  [[nodiscard]] Estimate mean(const Weight& weight) const;
  [[nodiscard]] Estimate mean(std::size_t side, const Weight& weight) const;
  /// Probability of low <= value < high; low and high are edges, or 0 and infinity.
  [[nodiscard]] Estimate probability(double low, double high) const;

 private:
  [[nodiscard]] std::size_t bin(double value) const {
    const auto above = std::upper_bound(edges_.begin(), edges_.end(), value);
    return static_cast<std::size_t>(above - edges_.begin());
  }
  /// Of 1{turned} and weight(bin) over the excursions from one side.
  [[nodiscard]] Comoments moments(std::size_t side, const Weight& weight) const;
  [[nodiscard]] Estimate jeffreys(std::span<const Comoments> sides, const Weight& weight) const;

  std::vector<double> edges_;
  std::size_t bins_;
  std::vector<double> counts_;
};

// Quantiles of a number that paths have at their ends.

/// Counts, weights and their squares of paths by side, by whether they turn, and by bin of a number
/// y. Bins are `step` |y| wide, from far below a scale to far above it on either side of 0, which
/// is a bin of its own. So memory is the same for any number of paths.
///
/// Intervals of quantiles hold for any distribution: they reach from the first bin up to whose end
/// there may be a probability of p, by Jeffreys' interval of the share, to the first one up to
/// whose end there is at least that. Local.
class PathBins {
 public:
  /// Of both signs of y, or of y >= 0 alone.
  PathBins(Sampled sampled, bool both_signs, double scale, double step);

  void add(std::size_t side, bool turned, double weight, double y);
  /// The y up to which there is the probability p. An end of the interval is infinite where too few
  /// samples are beyond. O(bins log bins).
  [[nodiscard]] Estimate quantile(double p) const;

  /// All that is kept, in a row.
  [[nodiscard]] std::span<double> numbers() { return numbers_; }
  [[nodiscard]] std::span<const double> numbers() const { return numbers_; }

 private:
  struct Edges {
    double low, high;
  };
  [[nodiscard]] Edges edges(std::size_t bin) const;
  /// The share of paths in the bins up to this one.
  [[nodiscard]] Estimate share_up_to(std::size_t bin) const;
  /// The first bin up to which a share, or an end of its interval, is p; the last one if none is.
  [[nodiscard]] std::size_t first(double Estimate::*end, double p) const;

  Sampled sampled_;
  double scale_, step_;
  std::size_t side_bins_, zero_, bins_;  // of one sign, the one of 0, all
  std::vector<double> numbers_;          // count, weight and its square by side, turned and bin
};

}  // namespace stickslip::simulation
