#pragma once
/// Levels of a noise that have one force: jumps between them move no body otherwise.

#include <vector>

#include "stickslip/model/noise_chain.hpp"

namespace stickslip::model {

/// The rates at which levels with the force of level i are left for other forces [1/time].
struct ChangeRates {
  double least, most;
};
[[nodiscard]] ChangeRates change_rates(const NoiseChain& chain, int i);

/// Of a noise that starts on level i: P(on that level, and the force has not changed), for all
/// levels of its force from the lowest up. O(n^3) for n of them.
struct Unchanged {
  int lowest = 0;
  std::vector<double> probability = {};
};
[[nodiscard]] Unchanged unchanged(const NoiseChain& chain, int i, double time);

}  // namespace stickslip::model
