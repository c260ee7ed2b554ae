#pragma once
/// Jumps of a noise to any levels.

#include <algorithm>
#include <vector>

#include "stickslip/model/noise_chain.hpp"
#include "stickslip/simulation/random_stream.hpp"

namespace stickslip::simulation {

/// Draws the level to which the noise jumps from another one. Local.
class AnyJumps {
 public:
  explicit AnyJumps(const model::NoiseChain& noise) : lowest_(noise.lowest()) {
    for (int i = noise.lowest(); i <= noise.highest(); ++i) {
      double sum = 0;
      auto& row = rows_.emplace_back();
      noise.for_each_jump(i, [&](int to, double rate) { row.push_back({sum += rate, to}); });
    }
  }

  /// O(log of the number of jumps from there).
  [[nodiscard]] int next(int level, RandomStream& random) const {
    const int place = level - lowest_;
    const auto& row = rows_[static_cast<std::size_t>(place)];
    const double at = random.uniform() * row.back().up_to;
    const auto found = std::upper_bound(row.begin(), row.end() - 1, at,
                                        [](double x, const Jump& jump) { return x < jump.up_to; });
    return found->to;
  }

 private:
  struct Jump {
    double up_to;  // sum of the rates of this one and those before
    int to;
  };
  int lowest_;
  std::vector<std::vector<Jump>> rows_;
};

}  // namespace stickslip::simulation
