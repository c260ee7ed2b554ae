#include "stickslip/catalogue/peak_keys.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "stickslip/simulation/tally.hpp"
#include "stickslip/support/infinity.hpp"

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
    const auto until = [&](const catalogue::Row& row, Estimate Times::*which) {
      return array(row, w, [&](std::size_t n) {
        const auto at = std::lower_bound(speeds.begin(), speeds.end(), w[n]) - speeds.begin();
        return times(passages[static_cast<std::size_t>(at)], t.samples()).*which;
      });
    };
    return {until(catalogue::kFirstPassage, &Times::slide),
            until(catalogue::kFirstPassageRest, &Times::rest)};
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
    return {array(catalogue::kPPeak, t.question().velocity, of)};
  });
  if (tally.sampled() == Sampled::cycles) {
    passages_of(tally, speeds, [](std::size_t n) { return CyclesUntil(n); });
  } else {
    passages_of(tally, speeds,
                [](std::size_t n) { return [n](const Excursion& e) { return passage(e, n); }; });
  }
}

}  // namespace stickslip::simulation
