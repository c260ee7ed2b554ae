#pragma once
/// What is known of a chain with any jumps.

#include <cstddef>
#include <span>
#include <vector>

#include "stickslip/model/noise_chain.hpp"

namespace stickslip::model {

/// The jumps from each state, by the states' places in rising order of x.
using Jumps = std::vector<std::vector<LevelTable::Jump>>;

/// Throws UnfitTable unless these are states of numbers x that all reach one another by positive,
/// finite rates. O(transitions).
void require_states(const std::vector<double>& x, const std::vector<Transition>& transitions);

/// The numbers x where those that agree but for rounding, up to their signs, are the same.
[[nodiscard]] std::vector<double> without_rounding(const std::vector<double>& x);

/// States in rising order of x, and the place of the mirror image of each place where -X is the
/// same chain. Images have the reverse order, but that several states may be their own images.
struct MirroredOrder {
  std::vector<std::size_t> states;
  std::vector<std::size_t> image;

  [[nodiscard]] bool reversed() const;
};

/// Such an order; among states of one x it is found from what surrounds them.
[[nodiscard]] MirroredOrder mirrored_order(const std::vector<double>& x,
                                           const std::vector<Transition>& transitions);

/// Whether images of states jump to images, at the same rates but for rounding.
[[nodiscard]] bool mirrors_itself(const Jumps& jumps, const std::vector<std::size_t>& image);

/// Stationary probabilities. O(states band^2), as all that follows, with jumps over at most `band`
/// places.
[[nodiscard]] std::vector<double> stationary(const Jumps& jumps);

/// int_0^infinity E[f(X_0) f(X_t)] dt for f of mean 0 under the stationary probabilities p.
[[nodiscard]] double intensity(const Jumps& jumps, std::span<const double> p,
                               const std::vector<double>& f);

/// The largest value over omega of int_0^infinity E[f(X_0) f(X_t)] cos(omega t) dt, by a Krylov
/// space of some tens of functions: to a few percent.
[[nodiscard]] double peak_intensity(const Jumps& jumps, std::span<const double> p,
                                    const std::vector<double>& f);

/// The root theta > 0 of lim log E[exp(theta int_0^t f(X))]/t = 0, f of negative mean and positive
/// somewhere; from below, to a thousandth.
[[nodiscard]] double decay(const Jumps& jumps, const std::vector<double>& f, double guess);

}  // namespace stickslip::model
