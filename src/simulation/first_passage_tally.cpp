#include "stickslip/catalogue/first_passage_keys.hpp"

#include <algorithm>

#include "stickslip/simulation/tally.hpp"

namespace stickslip::simulation {
namespace {

struct PassedPath {
  double weight, time, square;
};

}  // namespace

void first_passage_tally(Tally& tally) {
  auto speeds = tally.question().velocity;
  std::sort(speeds.begin(), speeds.end());
  tally.wanted().passages = speeds;
  tally.wanted().passage = tally.question().passage;
  std::vector<Sums<PassedPath>> passed;
  for (std::size_t n = 0; n < speeds.size(); ++n) {
    passed.push_back(tally.sums_of_paths(tally.question().start, [n](const FollowedPath& path) {
      const double time = path.passages[n];
      return PassedPath{path.weight, path.weight * time, path.weight * time * time};
    }));
  }
  tally.report([=](const Tally& t) -> Estimates {
    const auto& w = t.question().velocity;
    const auto of = [&](const catalogue::Row& row, bool variance) {
      return array(row, w, [&](std::size_t n) {
        const auto at = std::lower_bound(speeds.begin(), speeds.end(), w[n]) - speeds.begin();
        const auto& m = passed[static_cast<std::size_t>(at)];
        const Smooth weight = m.overall(&PassedPath::weight),
                     mean = m.overall(&PassedPath::time) / weight;
        return m.estimate(variance ? m.overall(&PassedPath::square) / weight - mean * mean : mean);
      });
    };
    return {of(catalogue::kPassageMean, false), of(catalogue::kPassageVariance, true)};
  });
}

}  // namespace stickslip::simulation
