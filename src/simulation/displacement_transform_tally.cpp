#include <fmt/format.h>

#include <cmath>

#include "stickslip/catalogue/displacement_transform_keys.hpp"
#include "stickslip/simulation/tally.hpp"

namespace stickslip::simulation {
namespace {

struct TransformWave {
  double weight, cosine, sine;
};

}  // namespace

void displacement_transform_tally(Tally& tally) {
  const auto wavenumbers = tally.question().values(catalogue::kWavenumber.option);
  const auto& start = tally.question().start;
  tally.wanted().travel = true;
  std::vector<std::vector<Sums<TransformWave>>> all;
  for (double k : wavenumbers) {
    all.push_back(tally.sums_along(start, [k](const FollowedPath& path, const State& z) {
      const double phase = k * z.displacement;
      return TransformWave{path.weight, path.weight * std::cos(phase),
                           path.weight * std::sin(phase)};
    }));
  }
  // With symmetry paths from rest and stationary ones are as likely as their mirror images.
  tally.report([=](const Tally& t) -> Estimates {
    const bool still = model::mirrors_itself(t.process(), start);
    const bool even = still && t.process().symmetric();
    const auto& time = t.question().time;
    Estimates found;
    for (std::size_t at = 0; at < time.size(); ++at) {
      const auto add = [&](const catalogue::Row& row, double TransformWave::*of, bool zero,
                           double parity) {
        found.push_back(array(row, wavenumbers, [&](std::size_t n) {
          const auto& m = all[n][at];
          if (zero) return Estimate{};
          return m.estimate(m.overall(of, even ? parity : 1) / m.overall(&TransformWave::weight));
        }));
        found.back().key = row.key_of(fmt::format("{}", time[at]));
      };
      add(catalogue::kDisplacementCosine, &TransformWave::cosine, false, 1);
      add(catalogue::kDisplacementSine, &TransformWave::sine, still, -1);
    }
    return found;
  });
}

}  // namespace stickslip::simulation
