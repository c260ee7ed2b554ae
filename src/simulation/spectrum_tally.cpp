#include "stickslip/catalogue/spectrum_keys.hpp"

#include <array>
#include <complex>

#include "stickslip/simulation/tally.hpp"

namespace stickslip::simulation {
namespace {

// D, T and products of them, and what of them belongs to excursions that turn.
struct Moves {
  double d, t, dd, dt, tt, d_turned, t_turned;
};
// |C|^2, C, exp(-i omega T) and conj(C) exp(-i omega T) of excursions that end on the same and on
// the other side, and T.
struct Wave {
  double power;
  std::complex<double> c, same, other, c_same, c_other;
  double time;
};

// With D the displacement and T the duration of an excursion, m = E[D]/E[T] and W = D - m T, the
// sum of W over the excursions to come differs by u = E+[W]/P(s+ to s-) between a start at s+ and
// one at s-, and a long path spreads about its drift at the rate
//
//   S_v(0) = (E[W^2] + 2 u E[W; the next one starts at s+])/E[T].
Estimate at_zero(const Sums<Moves>& m) {
  const Smooth drift = m.overall(&Moves::d, -1) / m.overall(&Moves::t);
  const auto sum = [&](std::size_t side, double Moves::*d, double Moves::*t) {
    return m.at(side, d, -1) - drift * m.at(side, t);
  };
  const Smooth spread = m.overall(&Moves::dd) - 2 * drift * m.overall(&Moves::dt, -1) +
                        drift * drift * m.overall(&Moves::tt);
  if (m.cycles()) return m.estimate(spread / m.overall(&Moves::t));
  const Smooth all = sum(0, &Moves::d, &Moves::t);
  const Smooth up = m.share(0) * (all - sum(0, &Moves::d_turned, &Moves::t_turned)) +
                    m.share(1) * sum(1, &Moves::d_turned, &Moves::t_turned);
  // One side alone renews the process at each of its starts.
  const Smooth turning = m.turned(0);
  const Smooth to_come = turning.value == 0.0 ? Smooth(0) : 2 * all / turning * up;
  return m.estimate((spread + to_come) / m.overall(&Moves::t));
}

// Let C be the transform of v over an excursion, T its duration, and H(s, s') and K(s, s') the
// means from side s of exp(-i omega T) and of conj(C) exp(-i omega T) where it ends on side s'.
// What is to come from side s has the mean transform G = C + H G, and with p the shares of the
// sides
//
//   S_v = (E|C|^2 + 2 Re(p K G))/E[T]
//
// without any window. With symmetry G(s-) = -G(s+). A constant added to v counts at omega = 0 only.
Estimate at_frequency(const Sums<Wave>& m) {
  if (m.cycles()) {
    const Smooth to_come = m.at(0, &Wave::c) / (1 - m.at(0, &Wave::same));
    return m.estimate((m.overall(&Wave::power) + 2 * m.at(0, &Wave::c_same) * to_come) /
                      m.overall(&Wave::time));
  }
  const std::array side{m.at(0, &Wave::c), m.at(1, &Wave::c, -1)};
  const std::array diagonal{1 - m.at(0, &Wave::same), 1 - m.at(1, &Wave::same)};
  const std::array turns{m.at(0, &Wave::other), m.at(1, &Wave::other)};
  const Smooth det = diagonal[0] * diagonal[1] - turns[0] * turns[1];
  std::array to_come{(side[0] * diagonal[1] + turns[0] * side[1]) / det,
                     (side[1] * diagonal[0] + turns[1] * side[0]) / det};
  if (m.symmetric())
    to_come = {side[0] / (diagonal[0] + turns[0]), -1 * side[0] / (diagonal[0] + turns[0])};
  Smooth sum = m.overall(&Wave::power);
  for (std::size_t s : {0, 1}) {
    sum = sum + 2 * m.share(s) *
                    (m.at(s, &Wave::c_same, -1) * to_come[s] +
                     m.at(s, &Wave::c_other, -1) * to_come[1 - s]);
  }
  return m.estimate(sum / m.overall(&Wave::time));
}

}  // namespace

void spectrum_tally(Tally& tally) {
  const auto& omega = tally.wanted().omega = tally.question().omega;
  tally.wanted().integrals = true;
  const auto moves = tally.sums_of_renewals([](const Excursion& e) -> Moves {
    const double d = e.drift, t = e.slide + e.stick, turned = e.turned ? 1 : 0;
    return {d, t, d * d, d * t, t * t, turned * d, turned * t};
  });
  std::vector<Sums<Wave>> waves;
  for (std::size_t n = 0; n < omega.size(); ++n) {
    waves.push_back(tally.sums_of_renewals([n, w = omega[n]](const Excursion& e) -> Wave {
      const double t = e.slide + e.stick, turned = e.turned ? 1 : 0, kept = 1 - turned;
      const auto c = e.transform[n], turn = std::polar(1.0, -w * t), both = std::conj(c) * turn;
      return {std::norm(c), c, kept * turn, turned * turn, kept * both, turned * both, t};
    }));
  }
  tally.report([=](const Tally&) {
    const Estimate s = at_zero(moves);
    Estimates all;
    const auto of_wave = [&](std::size_t n) { return omega[n] == 0 ? s : at_frequency(waves[n]); };
    if (!omega.empty()) all.push_back(array(catalogue::kSV, omega, of_wave));
    all.push_back({&catalogue::kS0, {s}});
    all.push_back({&catalogue::kDiffusivity, {s / 2}});
    return all;
  });
}

}  // namespace stickslip::simulation
