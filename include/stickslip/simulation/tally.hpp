#pragma once
/// What is kept of many excursions, and the estimates made from it.

#include <array>
#include <span>
#include <vector>

#include "stickslip/simulation/comoments.hpp"
#include "stickslip/simulation/excursions.hpp"

namespace stickslip::simulation {

/// An estimate with its 95 % confidence interval.
struct Estimate {
  double value = 0, low = 0, high = 0;
};

/// Durations whose laws are asked for.
enum class Duration { slide, stick, excursion };

/// Counts and co-moments of excursions. Tallies of parts, merged in a fixed order, give the same
/// bits however the parts were dealt out.
///
/// A stationary mean is the ratio of mean integrals over an excursion, E[G]/E[T]; its interval is
/// that of the delta method. Local.
class Tally {
 public:
  /// `k`: levels |i| <= k can stick. Entries are not counted for cycles.
  Tally(const Wanted& wanted, int k);

  void add(const Excursion& excursion);
  void merge(const Tally& other);

  /// Excursions, or cycles of them.
  [[nodiscard]] double samples() const { return totals_.count(); }
  [[nodiscard]] double jumps() const { return jumps_; }

  [[nodiscard]] Estimate sticking() const;  ///< P_stick
  [[nodiscard]] Estimate sliding() const;   ///< P_slide
  [[nodiscard]] Estimate mean(Duration duration) const;
  [[nodiscard]] Estimate mean_square() const;    ///< E[V^2]
  [[nodiscard]] Estimate mean_speed() const;     ///< E[|V|]
  [[nodiscard]] Estimate mean_product() const;   ///< E[X V]
  [[nodiscard]] Estimate mean_velocity() const;  ///< E[V]; of cycles
  /// S_v(0) about E[V], of cycles; see tally.cpp.
  [[nodiscard]] Estimate spectrum_at_zero() const;
  [[nodiscard]] Estimate within() const;        ///< P(|X| <= mu_s)
  [[nodiscard]] Estimate noise_square() const;  ///< E[X^2]
  /// Probability that a slide comes to rest on level i, by Jeffreys' interval.
  [[nodiscard]] Estimate entry(int i) const;
  /// Probability that it does on one of two levels, both times `factor`.
  [[nodiscard]] Estimate entry_of_both(int i, int j, double factor) const;
  /// E[exp(-lambda D)] for the n-th lambda.
  [[nodiscard]] Estimate laplace(std::size_t n, Duration duration) const;
  /// P(low <= D < high); low and high are edges, or 0 and infinity.
  [[nodiscard]] Estimate probability(Duration duration, double low, double high) const;
  /// S_v at the n-th omega, see spectrum() in tally.cpp.
  [[nodiscard]] Estimate spectrum(std::size_t n) const;

  /// All numbers in a row, and back. `unpack` expects a tally of the same questions, and throws
  /// std::invalid_argument if the size is another.
  [[nodiscard]] std::vector<double> pack() const;
  [[nodiscard]] std::size_t packed_size() const;
  void unpack(std::span<const double> numbers);

 private:
  [[nodiscard]] Estimate ratio(std::size_t total) const;
  [[nodiscard]] std::size_t place(int level) const;  // in entries_
  void count_cells(const Excursion& excursion);
  void add_transforms(const Excursion& excursion);

  int k_;
  Wanted wanted_;
  Comoments totals_, displacement_;
  std::vector<Comoments> laplace_, spectrum_;
  std::vector<double> entries_;
  std::array<std::vector<double>, 3> cells_;  // counts between edges, by duration
  double jumps_ = 0;
};

/// The tally of one batch of `count` excursions, by the random stream of its number.
[[nodiscard]] Tally simulate_batch(ExcursionSource& source, const Wanted& wanted, int k,
                                   std::uint64_t seed, std::uint64_t batch, int count);

}  // namespace stickslip::simulation
