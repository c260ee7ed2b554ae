#include "stickslip/catalogue/autocorrelation_keys.hpp"
#include "stickslip/simulation/tally.hpp"

namespace stickslip::simulation {

void autocorrelation_tally(Tally& tally) {
  // Velocities at the first and at a later time, times the duration.
  struct Pair {
    double duration, first, last, product;
  };
  const model::Start start{.kind = model::Start::Kind::stationary};
  const auto sums = tally.sums_along(start, [](const FollowedPath& path, const State& z) {
    const double v = path.first.v, last = path.weight * z.v;
    return Pair{path.weight, path.weight * v, last, v * last};
  });
  tally.report([=](const Tally& t) -> Estimates {
    return {array(catalogue::kAutocovariance, t.question().time, [&](std::size_t n) {
      const auto& m = sums[n];
      const Smooth duration = m.overall(&Pair::duration);
      return m.estimate(m.overall(&Pair::product) / duration - m.overall(&Pair::first, -1) *
                                                                   m.overall(&Pair::last, -1) /
                                                                   (duration * duration));
    })};
  });
}

}  // namespace stickslip::simulation
