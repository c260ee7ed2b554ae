#pragma once
/// The noise X: a Markov chain.

#include <memory>
#include <optional>
#include <vector>

#include "stickslip/model/level_table.hpp"

namespace stickslip::model {

/// A chain on levels x_i, lowest() <= i <= highest(), x rising. Its members are all that the
/// discretisations and the simulation know of the noise. Two kinds:
///
/// A discrete Ornstein-Uhlenbeck process (eq. (2.2) of the paper, with the factor x restored in
/// alpha), x_i = i delta, |i| <= N, of standard deviation sigma, without its own 1/sqrt(tau):
///
///   Q f(x_i) = Lambda (alpha_i f(x_{i+1}) - f(x_i) + (1 - alpha_i) f(x_{i-1})),
///   Lambda = 2 sigma^2/(tau delta^2),  alpha_i = (1 - delta x_i/(2 sigma^2))/2,
///   alpha_N = 0, alpha_-N = 1.
///
/// It tends to the Ornstein-Uhlenbeck process as delta -> 0. With the full range N = 2
/// sigma^2/delta^2 it is the Ehrenfest urn of 2N balls: a binomial distribution of variance
/// sigma^2.
///
/// Or the chain of a table, whose jumps may be of any length.
struct NoiseChain {
  double tau = 1;                                ///< correlation time [time]
  double delta = 1;                              ///< step of the noise [force]
  int levels = 1;                                ///< N, number of levels on each side of 0
  std::optional<double> deviation = {};          ///< sigma [force]
  std::shared_ptr<const LevelTable> table = {};  ///< what counts instead, if there is one

  [[nodiscard]] int lowest() const { return table ? table->lowest() : -levels; }
  [[nodiscard]] int highest() const { return table ? table->highest() : levels; }
  [[nodiscard]] int count() const { return highest() - lowest() + 1; }
  /// x_i [force].
  [[nodiscard]] double level(int i) const { return table ? table->at(i).x : i * delta; }
  /// Whether all jumps are to neighbouring levels.
  [[nodiscard]] bool neighbours_only() const { return !table || table->neighbours_only(); }
  /// Calls visit(level, rate) for the jumps from level i, from the lowest one up.
  template <class Visit>
  void for_each_jump(int i, Visit visit) const {
    if (table) return table->for_each_jump(i, visit);
    if (i > -levels) visit(i - 1, down_rate(i));
    if (i < levels) visit(i + 1, up_rate(i));
  }
  /// Rates of all jumps from level i to higher and to lower ones [1/time].
  [[nodiscard]] double up_rate(int i) const { return table ? table->at(i).up : rate() * up(i); }
  [[nodiscard]] double down_rate(int i) const {
    return table ? table->at(i).down : rate() * down(i);
  }
  /// Rate of leaving level i; the largest of them, Lambda.
  [[nodiscard]] double rate(int i) const {
    return table ? table->at(i).up + table->at(i).down : rate();
  }
  [[nodiscard]] double rate() const {
    return table ? table->rate() : 2 / (tau * delta * precision() * delta);
  }
  /// alpha_i, the probability that a jump from x_i goes up, and 1 - alpha_i without subtraction.
  [[nodiscard]] double up(int i) const;
  [[nodiscard]] double down(int i) const;

  /// Distance of neighbouring levels, the smallest one.
  [[nodiscard]] double step() const { return table ? table->step() : delta; }
  [[nodiscard]] double mean() const { return table ? table->mean() : 0; }
  [[nodiscard]] double standard_deviation() const;
  /// int_0^infinity Cov(X_0, X_t) dt = sigma^2 tau: over long times X is white noise of twice this
  /// strength [force^2 time]. Without a table that of the full range; see power_spectral_density().
  [[nodiscard]] double intensity() const;
  /// The same for large speeds; see LevelTable.
  [[nodiscard]] double tail_intensity() const { return table ? table->upper_tail() : intensity(); }
  /// The same where forces from `least` to `most` slow bodies.
  [[nodiscard]] double tail_intensity(double least, double most) const {
    return table ? table->tail_intensity(least, most) : intensity();
  }
  /// intensity()/variance [time].
  [[nodiscard]] double correlation_time() const;

  /// Highest level <= x, and lowest one >= x, where rounding counts as equal; lowest() - 1 and
  /// highest() + 1 where there is none.
  [[nodiscard]] int last_up_to(double x) const;
  [[nodiscard]] int first_from(double x) const;
  /// The level with x_i = x up to rounding.
  [[nodiscard]] std::optional<int> find(double x) const;
  /// i + 1/2 for x between the levels i and i + 1 halfway: linear between levels and beyond.
  [[nodiscard]] double place(double x) const;

  /// Whether -X is the same chain; and level -i the mirror image of level i, with 0 a level.
  [[nodiscard]] bool even() const { return !table || table->even(); }
  /// Whether -X is this chain with its levels in the reverse order.
  [[nodiscard]] bool even_in_order() const { return !table || table->even_in_order(); }
  [[nodiscard]] bool symmetric() const { return !table || table->symmetric(); }
  /// The chain of -X, level -i for level i.
  [[nodiscard]] NoiseChain mirrored() const;

  /// Without a table: derivatives by tau at fixed N of Lambda, alpha_i and 1 - alpha_i.
  [[nodiscard]] double rate_change() const { return (deviation ? -1 : -2) * rate() / tau; }
  [[nodiscard]] double up_change(int i) const;
  [[nodiscard]] double down_change(int i) const { return -up_change(i); }

 private:
  // 1/sigma^2.
  [[nodiscard]] double precision() const { return deviation ? 1 / (*deviation * *deviation) : tau; }
};

/// Largest N for which every alpha_i is a probability: floor(2 sigma^2/delta^2), safe to rounding.
/// Throws std::out_of_range when it does not fit an int.
[[nodiscard]] int full_range(double tau, double delta, std::optional<double> deviation = {});

/// pi(x_i)/pi(x_{i-1}); from detailed balance where jumps are to neighbours.
[[nodiscard]] double weight_ratio(const NoiseChain& chain, int i);

/// Stationary probabilities from the lowest level up. Positive products and sums only, so that
/// every entry has full relative accuracy down to underflow. O(levels).
[[nodiscard]] std::vector<double> stationary_distribution(const NoiseChain& chain);

/// Relative rounding of sums of positive terms over levels: weights are products of up to N
/// factors, each rounded, and the bulk of the distribution holds about sqrt(N) of them.
[[nodiscard]] double rounding_of_sums(const NoiseChain& chain);

/// P(low <= i <= high), the rest, and moments, each a sum of its own terms. O(levels) time, O(1)
/// space.
struct NoiseMoments {
  double within;
  double beyond;
  double square;  ///< E[X^2]
};
[[nodiscard]] NoiseMoments noise_moments(const NoiseChain& chain, int low, int high);

}  // namespace stickslip::model
