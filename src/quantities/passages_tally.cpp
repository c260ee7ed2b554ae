#include <algorithm>
#include <array>
#include <cmath>

#include "stickslip/base/text.hpp"
#include "stickslip/case/passage_rows.hpp"
#include "stickslip/simulation/tally.hpp"

namespace stickslip::simulation {
namespace {

// Until a speed is reached, or until an excursion ends, also of the first one from rest.
struct Passage {
  double reached, crossed, lasted, rest, rest_up, rest_down;
};
// Mean times until a speed is first reached, from the start of a sliding phase and from rest.
struct Times {
  Estimate slide, rest;
};

Passage passage(const Excursion& e, std::size_t n) {
  const auto time = [n](const Excursion& of) {
    return n < of.passages.size() ? of.passages[n] : of.slide + of.stick;
  };
  const Excursion& rest = *e.from_rest;
  const double turned = e.turned ? 1 : 0, down = rest.turned ? 1 : 0,
               missed = n < e.passages.size() ? 0 : 1,
               rest_missed = n < rest.passages.size() ? 0 : 1;
  return {1 - missed, missed * turned,          time(e),
          time(rest), rest_missed * (1 - down), rest_missed * down};
}

// Known up to a factor; where no sliding phase reached w the interval has no end.
Times times(const Means& m, const Smooth& slide, const Smooth& rest, bool never) {
  const auto estimate = [&](const Smooth& time) -> Estimate {
    const auto [mean, low, high] = m.estimate(time);
    if (never) return {mean, mean, kInfinity};
    const double factor = std::exp(high / mean - 1);
    return {mean, mean / factor, mean * factor};
  };
  return {estimate(slide), estimate(rest)};
}

// The mean time to come that as many samples of this mean duration miss with probability 0.025.
Smooth least(double samples, const Smooth& duration) {
  return samples / -std::log(0.025) * duration;
}

// From side s an excursion reaches w with probability p(s), ends before on the other side with
// probability q(s), and takes the mean time a(s) until it does either or ends. The mean time to
// come is m+ = a+ + (1 - p+ - q+) m+ + q+ m-, and so for m-.
Times times(const Sums<Passage>& m, double samples) {
  const auto sides = [&](double Passage::*which) {
    return std::array{m.at(0, which), m.at(1, which)};
  };
  const auto p = sides(&Passage::reached), q = sides(&Passage::crossed),
             a = sides(&Passage::lasted);
  const Smooth det = p[0] * p[1] + p[0] * q[1] + q[0] * p[1];
  const bool never = det.value == 0.0;
  const Smooth most = least(samples, m.overall(&Passage::lasted));
  const Smooth up = never ? most : (a[0] * (p[1] + q[1]) + q[0] * a[1]) / det;
  const Smooth down = never ? most : (a[1] * (p[0] + q[0]) + q[1] * a[0]) / det;
  return times(m, m.share(0) * up + m.share(1) * down,
               m.at(0, &Passage::rest) + m.at(0, &Passage::rest_up) * up +
                   m.at(0, &Passage::rest_down) * down,
               never);
}

// A cycle reaches w or lasts without it. From the start of each of its excursions it is `waited`
// for until the next time or, for the last ones that are `open`, to the end of the cycle, and from
// rest to the first start of a cycle.
struct PassageOfCycle {
  double reached, lasted, waited, open, rest, rest_missed;
};

/// Follows the excursions of one cycle after the other.
class CyclesUntil {
 public:
  /// Until the n-th speed.
  explicit CyclesUntil(std::size_t n) : n_(n) {}

  PassageOfCycle operator()(const Excursion& e) {
    const auto reaches = [n = n_](const Excursion& of) { return n < of.passages.size(); };
    const auto time = [&](const Excursion& of) {
      return reaches(of) ? of.passages[n_] : of.slide + of.stick;
    };
    PassageOfCycle p{};
    if (first_) {
      p.rest = time(*e.from_rest);
      p.rest_missed = reaches(*e.from_rest) ? 0 : 1;
    }
    if (!reached_) p = {reaches(e) ? 1.0 : 0.0, time(e), 0, 0, p.rest, p.rest_missed};
    reached_ = reached_ || reaches(e);
    p.waited = (waiting_ + 1) * time(e);
    waiting_ = reaches(e) ? 0 : waiting_ + 1;
    first_ = e.ends_cycle;
    if (first_) {
      p.open = waiting_;
      *this = CyclesUntil(n_);
    }
    return p;
  }

 private:
  std::size_t n_;
  bool first_ = true, reached_ = false;
  double waiting_ = 0;  // excursions of the cycle since w was reached
};

// The mean time to come from the start of a cycle is that in a cycle by the share that reach w.
Times times(const Sums<PassageOfCycle>& m, double samples) {
  using Of = PassageOfCycle;
  const Smooth reached = m.at(0, &Of::reached), lasted = m.at(0, &Of::lasted);
  const bool never = reached.value == 0.0;
  const Smooth to_come = never ? least(samples, lasted) : lasted / reached;
  return times(m, m.overall(&Of::waited) + m.overall(&Of::open) * to_come,
               m.at(0, &Of::rest) + m.at(0, &Of::rest_missed) * to_come, never);
}

// Sums for each speed, and what follows from them.
template <class Follow>
void passages_of(Tally& tally, const std::vector<double>& speeds, const Follow& follow) {
  std::vector<decltype(tally.sums(follow(0)))> passages;
  for (std::size_t n = 0; n < speeds.size(); ++n) passages.push_back(tally.sums(follow(n)));
  tally.report([=](const Tally& t) -> Estimates {
    const auto& w = t.question().velocity;
    const auto until = [&](const cases::Row& row, Estimate Times::*which) {
      return array(row, w, [&](std::size_t n) {
        const auto at = std::lower_bound(speeds.begin(), speeds.end(), w[n]) - speeds.begin();
        return times(passages[static_cast<std::size_t>(at)], t.samples()).*which;
      });
    };
    return {until(cases::kFirstPassage, &Times::slide),
            until(cases::kFirstPassageRest, &Times::rest)};
  });
}

struct PassedPath {
  double weight, time, square;
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

using MeansBySpeed = std::vector<Sums<Weighted>>;

// Of of(time, s), for each s of a list.
std::vector<MeansBySpeed> means_by_speed(Tally& tally, const auto& list, const auto& of) {
  std::vector<MeansBySpeed> all;
  for (const auto& s : list) {
    all.push_back(sums_by_speed(tally, [=](double weight, double time) {
      return Weighted{weight, weight * of(time, s)};
    }));
  }
  return all;
}

// An array for each speed; an interval has some width also where all samples agree.
void report_by_speed(Tally& tally, const cases::Row& row, const std::vector<double>& abscissa,
                     const std::vector<MeansBySpeed>& means, const std::vector<double>& unit) {
  tally.report([=, &row](const Tally& t) {
    Estimates found;
    const auto& speeds = t.question().velocity;
    for (std::size_t w = 0; w < speeds.size(); ++w) {
      found.push_back(at(speeds[w], array(row, abscissa, [&](std::size_t n) {
                           const auto& m = means[n][w];
                           return jeffreys(m, mean_of(m), 1, m.count()) / unit[n];
                         })));
    }
    return found;
  });
}

}  // namespace

void peak_tally(Tally& tally) {
  auto speeds = tally.question().velocity;
  std::sort(speeds.begin(), speeds.end());
  tally.wanted().speeds = speeds;
  std::vector<Tally::Range> above;
  for (double w : tally.question().velocity) above.push_back({w, kInfinity});
  tally.report([of = tally.shares(above, &Excursion::peak)](const Tally& t) -> Estimates {
    return {array(cases::kPPeak, t.question().velocity, of)};
  });
  if (tally.sampled() == Sampled::cycles) {
    passages_of(tally, speeds, [](std::size_t n) { return CyclesUntil(n); });
  } else {
    passages_of(tally, speeds,
                [](std::size_t n) { return [n](const Excursion& e) { return passage(e, n); }; });
  }
}

void first_passage_tally(Tally& tally) {
  const auto passed = sums_by_speed(tally, [](double weight, double time) {
    return PassedPath{weight, weight * time, weight * time * time};
  });
  tally.report([=](const Tally& t) -> Estimates {
    const auto of = [&](const cases::Row& row, bool variance) {
      return array(row, t.question().velocity, [&](std::size_t n) {
        const auto& m = passed[n];
        const Smooth weight = m.overall(&PassedPath::weight),
                     mean = m.overall(&PassedPath::time) / weight;
        return m.estimate(variance ? m.overall(&PassedPath::square) / weight - mean * mean : mean);
      });
    };
    return {of(cases::kPassageMean, false), of(cases::kPassageVariance, true)};
  });
}

void passage_transform_tally(Tally& tally) {
  const auto& lambda = tally.question().lambda;
  const auto means =
      means_by_speed(tally, lambda, [](double time, double s) { return std::exp(-s * time); });
  report_by_speed(tally, cases::kPassageTransform, lambda, means,
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
  report_by_speed(tally, cases::kPassageDensity, times, inside, widths);
  const auto before =
      means_by_speed(tally, times, [](double time, double t) { return time <= t ? 1.0 : 0.0; });
  report_by_speed(tally, cases::kPassageCdf, times, before, std::vector<double>(times.size(), 1));
}

}  // namespace stickslip::simulation
