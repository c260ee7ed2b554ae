#pragma once
/// Sums over excursions, and smooth functions of their means with intervals by the delta method.

#include <complex>
#include <cstddef>
#include <span>
#include <type_traits>
#include <utility>
#include <valarray>
#include <vector>

#include "stickslip/simulation/comoments.hpp"

namespace stickslip::simulation {

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

 private:
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

}  // namespace stickslip::simulation
