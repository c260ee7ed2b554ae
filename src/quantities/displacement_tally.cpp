#include <fmt/format.h>

#include <cmath>

#include "stickslip/case/displacement_rows.hpp"
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
    return {array(cases::kDisplacementMean, time,
                  [&](std::size_t n) { return still ? Estimate{} : sums[n].estimate(mean(n)); }),
            array(cases::kDisplacementVariance, time, variance)};
  });
}

namespace {

struct TransformWave {
  double weight, cosine, sine;
};

// With symmetry x is as likely as -x, and |x| is below the quantile of |2 p - 1| with that
// probability.
Estimate mirrored(const PathBins& sizes, double p) {
  if (p == 0.5) return {};
  const auto [value, low, high] = sizes.quantile(std::abs(2 * p - 1));
  return p > 0.5 ? Estimate{value, low, high} : Estimate{-value, -high, -low};
}

void quantiles_tally(Tally& tally, bool even) {
  const auto probabilities = tally.question().values(cases::kProbability.option);
  if (probabilities.empty()) return;
  const auto bins = tally.bins_along(tally.question().start, !even,
                                     [even](double x) { return even ? std::abs(x) : x; });
  tally.report([=](const Tally& t) -> Estimates {
    Estimates found;
    for (std::size_t at = 0; at < bins.size(); ++at) {
      found.push_back(array(cases::kDisplacementQuantile, probabilities, [&](std::size_t n) {
        const double p = probabilities[n];
        return even ? mirrored(*bins[at], p) : bins[at]->quantile(p);
      }));
      found.back().key =
          cases::kDisplacementQuantile.key_of(fmt::format("{}", t.question().time[at]));
    }
    return found;
  });
}

}  // namespace

void displacement_transform_tally(Tally& tally) {
  const auto wavenumbers = tally.question().values(cases::kWavenumber.option);
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
      const auto add = [&](const cases::Row& row, double TransformWave::*of, bool zero,
                           double parity) {
        found.push_back(array(row, wavenumbers, [&](std::size_t n) {
          const auto& m = all[n][at];
          if (zero) return Estimate{};
          return m.estimate(m.overall(of, even ? parity : 1) / m.overall(&TransformWave::weight));
        }));
        found.back().key = row.key_of(fmt::format("{}", time[at]));
      };
      add(cases::kDisplacementCosine, &TransformWave::cosine, false, 1);
      add(cases::kDisplacementSine, &TransformWave::sine, still, -1);
    }
    return found;
  });
}

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
      return Weighted{path.weight, path.weight * share};
    });
  };
  std::vector<std::vector<Sums<Weighted>>> below, inside;
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
        return jeffreys(m, mean_of(m), 1, m.count());
      };
      const auto add = [&](const cases::Row& row, const auto& value) {
        found.push_back(simulation::at(time[at], array(row, distance, value)));
      };
      add(cases::kDisplacementDensity,
          [&](std::size_t n) { return share(inside[n]) / (cells[n].high - cells[n].low); });
      add(cases::kDisplacementCdf, [&](std::size_t n) { return share(below[n]); });
    }
    return found;
  });
  quantiles_tally(tally, even);
}

}  // namespace stickslip::simulation
