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

// From side s an excursion reaches w with probability p(s), ends before on the other side with
// probability q(s), and takes the mean time a(s) until it does either or ends. The mean time to
// come is m+ = a+ + (1 - p+ - q+) m+ + q+ m-, and so for m-; it is known up to a factor. Where no
// sliding phase reached w, one that as many samples miss with probability 0.025 has the least, and
// the interval has no end.
Times times(const Sums<Passage>& m, double samples) {
  const auto sides = [&](double Passage::*which) {
    return std::array{m.at(0, which), m.at(1, which)};
  };
  const auto p = sides(&Passage::reached), q = sides(&Passage::crossed),
             a = sides(&Passage::lasted);
  const Smooth det = p[0] * p[1] + p[0] * q[1] + q[0] * p[1];
  const bool never = det.value == 0.0;
  const Smooth least = samples / -std::log(0.025) * m.overall(&Passage::lasted);
  const Smooth up = never ? least : (a[0] * (p[1] + q[1]) + q[0] * a[1]) / det;
  const Smooth down = never ? least : (a[1] * (p[0] + q[0]) + q[1] * a[0]) / det;
  const auto estimate = [&](const Smooth& time) -> Estimate {
    const auto [mean, low, high] = m.estimate(time);
    if (never) return {mean, mean, kInfinity};
    const double factor = std::exp(high / mean - 1);
    return {mean, mean / factor, mean * factor};
  };
  return {estimate(m.share(0) * up + m.share(1) * down),
          estimate(m.at(0, &Passage::rest) + m.at(0, &Passage::rest_up) * up +
                   m.at(0, &Passage::rest_down) * down)};
}

}  // namespace

void peak_tally(Tally& tally) {
  auto speeds = tally.question().velocity;
  std::sort(speeds.begin(), speeds.end());
  tally.wanted().speeds = speeds;
  const Histogram& peaks = tally.histogram(speeds, &Excursion::peak);
  std::vector<Sums<Passage>> passages;
  for (std::size_t n = 0; n < speeds.size(); ++n) {
    passages.push_back(tally.sums([n](const Excursion& e) { return passage(e, n); }));
  }
  tally.report([=, &peaks](const Tally& t) -> Estimates {
    const auto& w = t.question().velocity;
    const auto until = [&](const catalogue::Row& row, Estimate Times::*which) {
      return array(row, w, [&](std::size_t n) {
        const auto at = std::lower_bound(speeds.begin(), speeds.end(), w[n]) - speeds.begin();
        return times(passages[static_cast<std::size_t>(at)], t.samples()).*which;
      });
    };
    const auto above = [&](std::size_t n) { return peaks.probability(w[n], kInfinity); };
    return {array(catalogue::kPPeak, w, above), until(catalogue::kFirstPassage, &Times::slide),
            until(catalogue::kFirstPassageRest, &Times::rest)};
  });
}

}  // namespace stickslip::simulation
