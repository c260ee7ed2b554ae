#include <fmt/format.h>

#include "stickslip/catalogue/displacement_distribution_keys.hpp"
#include "stickslip/simulation/tally.hpp"

namespace stickslip::simulation {
namespace {

struct Within {
  double weight, within;
};

// With symmetry x is as likely as -x, and |x| is below the quantile of |2 p - 1| with that
// probability.
Estimate mirrored(const PathBins& sizes, double p) {
  if (p == 0.5) return {};
  const auto [value, low, high] = sizes.quantile(std::abs(2 * p - 1));
  return p > 0.5 ? Estimate{value, low, high} : Estimate{-value, -high, -low};
}

void quantiles_tally(Tally& tally, bool even) {
  const auto probabilities = tally.question().values(catalogue::kProbability.option);
  if (probabilities.empty()) return;
  const auto bins = tally.bins_along(tally.question().start, !even,
                                     [even](double x) { return even ? std::abs(x) : x; });
  tally.report([=](const Tally& t) -> Estimates {
    Estimates found;
    for (std::size_t at = 0; at < bins.size(); ++at) {
      found.push_back(array(catalogue::kDisplacementQuantile, probabilities, [&](std::size_t n) {
        const double p = probabilities[n];
        return even ? mirrored(*bins[at], p) : bins[at]->quantile(p);
      }));
      found.back().key =
          catalogue::kDisplacementQuantile.key_of(fmt::format("{}", t.question().time[at]));
    }
    return found;
  });
}

}  // namespace

// The share of paths that end below each distance, and in a cell about it, which ends at 0 so that
// bodies that have not moved are in none.
void displacement_distribution_tally(Tally& tally) {
  const auto& distance = tally.question().distance;
  const auto& start = tally.question().start;
  const bool even = model::mirrors_itself(tally.process(), start);
  tally.wanted().travel = true;
  const auto cells = cells_around(distance);
  const auto shares = [&](auto is_within) {
    // With symmetry paths are as likely as their mirror images.
    return tally.sums_along(start, [=](const FollowedPath& path, const State& z) {
      const double x = z.displacement, here = is_within(x) ? 1 : 0;
      const double share = even ? (here + (is_within(-x) ? 1 : 0)) / 2 : here;
      return Within{path.weight, path.weight * share};
    });
  };
  std::vector<std::vector<Sums<Within>>> below, inside;
  for (std::size_t n = 0; n < distance.size(); ++n) {
    const double d = distance[n];
    below.push_back(shares([d](double x) { return x <= d; }));
    inside.push_back(shares([d, cell = cells[n]](double x) {
      return d > 0 ? cell.low < x && x <= cell.high : cell.low <= x && x < cell.high;
    }));
  }
  tally.report([=](const Tally& t) -> Estimates {
    const auto& time = t.question().time;
    Estimates found;
    for (std::size_t at = 0; !distance.empty() && at < time.size(); ++at) {
      const auto share = [at](const auto& all) {
        const auto& m = all[at];
        return jeffreys(m, m.overall(&Within::within) / m.overall(&Within::weight), 1, m.count());
      };
      const auto add = [&](const catalogue::Row& row, const auto& value) {
        found.push_back(array(row, distance, value));
        found.back().key = row.key_of(fmt::format("{}", time[at]));
      };
      add(catalogue::kDisplacementDensity,
          [&](std::size_t n) { return share(inside[n]) / (cells[n].high - cells[n].low); });
      add(catalogue::kDisplacementCdf, [&](std::size_t n) { return share(below[n]); });
    }
    return found;
  });
  quantiles_tally(tally, even);
}

}  // namespace stickslip::simulation
