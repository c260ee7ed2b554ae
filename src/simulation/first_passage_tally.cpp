#include "stickslip/catalogue/first_passage_keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "stickslip/catalogue/passage_distribution_keys.hpp"
#include "stickslip/simulation/tally.hpp"

namespace stickslip::simulation {
namespace {

struct PassedPath {
  double weight, time, square;
};
struct MeanOfPath {
  double weight, value;
};

// For each speed sums of of(weight of the path, when it passes). Paths meet speeds as they rise.
auto sums_by_speed(Tally& tally, const auto& of) {
  const auto& speeds = tally.question().velocity;
  auto rising = speeds;
  std::sort(rising.begin(), rising.end());
  tally.wanted().passages = rising;
  tally.wanted().passage = tally.question().passage;
  std::vector<Sums<decltype(of(1.0, 0.0))>> all;
  for (double speed : speeds) {
    const auto n = static_cast<std::size_t>(std::lower_bound(rising.begin(), rising.end(), speed) -
                                            rising.begin());
    all.push_back(tally.sums_of_paths(tally.question().start, [=](const FollowedPath& path) {
      return of(path.weight, path.passages[n]);
    }));
  }
  return all;
}

using MeansBySpeed = std::vector<Sums<MeanOfPath>>;

// Of of(time, s), for each s of a list.
std::vector<MeansBySpeed> means_by_speed(Tally& tally, const auto& list, const auto& of) {
  std::vector<MeansBySpeed> all;
  for (const auto& s : list) {
    all.push_back(sums_by_speed(tally, [=](double weight, double time) {
      return MeanOfPath{weight, weight * of(time, s)};
    }));
  }
  return all;
}

// An array for each speed; an interval has some width also where all samples agree.
void report_by_speed(Tally& tally, const catalogue::Row& row, const std::vector<double>& abscissa,
                     const std::vector<MeansBySpeed>& means, const std::vector<double>& unit) {
  tally.report([=, &row](const Tally& t) {
    Estimates found;
    const auto& speeds = t.question().velocity;
    for (std::size_t w = 0; w < speeds.size(); ++w) {
      found.push_back(array(row, abscissa, [&](std::size_t n) {
        const auto& m = means[n][w];
        const Smooth mean = m.overall(&MeanOfPath::value) / m.overall(&MeanOfPath::weight);
        return jeffreys(m, mean, 1, m.count()) / unit[n];
      }));
      found.back().key = row.key_of(fmt::format("{}", speeds[w]));
    }
    return found;
  });
}

}  // namespace

void first_passage_tally(Tally& tally) {
  const auto passed = sums_by_speed(tally, [](double weight, double time) {
    return PassedPath{weight, weight * time, weight * time * time};
  });
  tally.report([=](const Tally& t) -> Estimates {
    const auto of = [&](const catalogue::Row& row, bool variance) {
      return array(row, t.question().velocity, [&](std::size_t n) {
        const auto& m = passed[n];
        const Smooth weight = m.overall(&PassedPath::weight),
                     mean = m.overall(&PassedPath::time) / weight;
        return m.estimate(variance ? m.overall(&PassedPath::square) / weight - mean * mean : mean);
      });
    };
    return {of(catalogue::kPassageMean, false), of(catalogue::kPassageVariance, true)};
  });
}

void passage_transform_tally(Tally& tally) {
  const auto& lambda = tally.question().lambda;
  const auto means =
      means_by_speed(tally, lambda, [](double time, double s) { return std::exp(-s * time); });
  report_by_speed(tally, catalogue::kPassageTransform, lambda, means,
                  std::vector<double>(lambda.size(), 1));
}

// A cell at 0 has no paths that pass at once.
void passage_distribution_tally(Tally& tally) {
  const auto& times = tally.question().time;
  const auto cells = cells_around(times);
  std::vector<double> widths;
  for (const auto& cell : cells) widths.push_back(cell.high - cell.low);
  const auto inside = means_by_speed(tally, cells, [](double time, const Tally::Range& cell) {
    return time > 0 && cell.low <= time && time < cell.high ? 1.0 : 0.0;
  });
  report_by_speed(tally, catalogue::kPassageDensity, times, inside, widths);
  const auto before =
      means_by_speed(tally, times, [](double time, double t) { return time <= t ? 1.0 : 0.0; });
  report_by_speed(tally, catalogue::kPassageCdf, times, before,
                  std::vector<double>(times.size(), 1));
}

}  // namespace stickslip::simulation
