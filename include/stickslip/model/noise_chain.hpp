#pragma once
/// The noise X: a birth-death chain on x_i = i delta, |i| <= N.

#include <vector>

namespace stickslip::model {

/// Noise chain with generator (eq. (2.2) of the paper, with the factor x restored in alpha):
///
///   Q f(x_i) = Lambda (alpha_i f(x_{i+1}) - f(x_i) + (1 - alpha_i) f(x_{i-1})),
///   Lambda = 2/(tau delta)^2,  alpha_i = (1 - tau delta x_i/2)/2,  alpha_N = 0, alpha_-N = 1.
///
/// It tends to the Ornstein-Uhlenbeck process of variance 1/tau as delta -> 0. With the full range
/// N = 2/(tau delta^2) it is the Ehrenfest urn of 2N balls: a binomial law of variance 1/tau.
struct NoiseChain {
  double tau = 1;    ///< correlation time [time]
  double delta = 1;  ///< step of the noise [force]
  int levels = 1;    ///< N, number of levels on each side of 0

  /// Jump rate Lambda [1/time].
  [[nodiscard]] double rate() const { return 2 / (tau * delta * tau * delta); }
  /// x_i [force].
  [[nodiscard]] double level(int i) const { return i * delta; }
  /// alpha_i, the probability that a jump from x_i goes up; in [0, 1].
  [[nodiscard]] double up(int i) const;
  /// 1 - alpha_i = alpha_{-i}, without subtraction from 1.
  [[nodiscard]] double down(int i) const { return up(-i); }
  /// d alpha_i/d tau at fixed N, and that of 1 - alpha_i.
  [[nodiscard]] double up_change(int i) const;
  [[nodiscard]] double down_change(int i) const { return up_change(-i); }
  /// d Lambda/d tau.
  [[nodiscard]] double rate_change() const { return -2 * rate() / tau; }
};

/// Largest N for which every alpha_i is a probability: floor(2/(tau delta^2)), safe to rounding.
/// Throws std::out_of_range when it does not fit an int.
[[nodiscard]] int full_range(double tau, double delta);

/// pi(x_i)/pi(x_{i-1}) for i >= 1, from detailed balance alpha_{i-1} pi_{i-1} = (1-alpha_i) pi_i.
[[nodiscard]] double weight_ratio(const NoiseChain& chain, int i);

/// Stationary probabilities of x_-N ... x_N (index i + N). Positive products and sums only, so
/// that every entry has full relative accuracy down to underflow. O(N).
[[nodiscard]] std::vector<double> stationary_distribution(const NoiseChain& chain);

/// Relative rounding of sums of positive terms over levels: weights are products of up to N
/// factors, each rounded, and the bulk of the law holds about sqrt(N) of them.
[[nodiscard]] double rounding_of_sums(const NoiseChain& chain);

/// P(|X| <= x_k) and P(|X| > x_k), each a sum of its own terms, and E[X^2]. O(N) time, O(1) space.
struct NoiseMoments {
  double within;    ///< P(|i| <= k)
  double beyond;    ///< P(|i| > k)
  double variance;  ///< E[X^2]
};
[[nodiscard]] NoiseMoments noise_moments(const NoiseChain& chain, int k);

}  // namespace stickslip::model
