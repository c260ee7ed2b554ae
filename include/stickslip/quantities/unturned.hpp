#pragma once
/// Bodies that reach a speed before the force first changes: all at one time.

#include <vector>

#include "stickslip/model/start.hpp"
#include "stickslip/operators/discretisation.hpp"
#include "stickslip/operators/system_key.hpp"

namespace stickslip::quantities {

/// What such bodies add to density and distribution function at one time.
struct Unturned {
  double exact = 0;                      ///< P(T <= t) by their path, a step
  double distribution = 0, density = 0;  ///< by the elements, which smear the step out
};

/// By time > 0, from a start that is not stationary. On level i with the probability p_i such a
/// body arrives after t_i, and with the probability p_i exp(-rate_i t_i), rate_i the largest one at
/// which levels of its force are left for others, as if all were left at that rate: of those left
/// more slowly a part. On the elements it is transported by the matrix of its force alone. What has
/// less than `least` of the probability is left out. Zero on grids, which are chains of their own.
/// `killed` kills at the speed of `key`. Local. O(size^3) for each level, size that of the elements
/// below the speed.
[[nodiscard]] std::vector<Unturned>
before_first_jump(const operators::Discretisation& killed, const operators::SystemKey& key,
                  const model::Start& start, const std::vector<double>& time, double least);

/// The time before which nobody arrives from such a start, as forces between those of the lowest
/// and the highest level make nobody faster than these two; infinite beyond `longest`. 0 on grids.
/// Local.
[[nodiscard]] double earliest_arrival(const operators::Discretisation& killed,
                                      const operators::SystemKey& key, const model::Start& start,
                                      double longest);

}  // namespace stickslip::quantities
