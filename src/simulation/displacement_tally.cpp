#include "stickslip/catalogue/displacement_keys.hpp"
#include "stickslip/simulation/tally.hpp"

namespace stickslip::simulation {

void displacement_tally(Tally& tally) {
  struct Travel {
    double weight, x, square;
  };
  const auto& start = tally.question().start;
  tally.wanted().travel = true;
  const auto sums = tally.sums_along(start, [](const FollowedPath& path, const State& z) {
    const double x = z.displacement;
    return Travel{path.weight, path.weight * x, path.weight * x * x};
  });
  // With symmetry paths from rest and stationary ones are as likely as their mirror images.
  tally.report([=](const Tally& t) -> Estimates {
    const bool still = model::mirrors_itself(t.process(), start),
               even = still && t.process().symmetric();
    const auto mean = [&](std::size_t n) {
      return sums[n].overall(&Travel::x, even ? -1 : 1) / sums[n].overall(&Travel::weight);
    };
    const auto variance = [&](std::size_t n) {
      const auto& m = sums[n];
      const Smooth x = mean(n);
      return m.estimate(m.overall(&Travel::square) / m.overall(&Travel::weight) - x * x);
    };
    const auto& time = t.question().time;
    return {array(catalogue::kDisplacementMean, time,
                  [&](std::size_t n) { return still ? Estimate{} : sums[n].estimate(mean(n)); }),
            array(catalogue::kDisplacementVariance, time, variance)};
  });
}

}  // namespace stickslip::simulation
