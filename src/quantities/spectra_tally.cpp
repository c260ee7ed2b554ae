#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

#include "stickslip/case/spectrum_rows.hpp"
#include "stickslip/case/sticking_rows.hpp"
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
    return {array(cases::kAutocovariance, t.question().time, [&](std::size_t n) {
      const auto& m = sums[n];
      const Smooth duration = m.overall(&Pair::duration);
      return m.estimate(m.overall(&Pair::product) / duration - m.overall(&Pair::first, -1) *
                                                                   m.overall(&Pair::last, -1) /
                                                                   (duration * duration));
    })};
  });
}

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

double discounted_time(double lambda, double time) {
  return lambda > 0 ? -std::expm1(-lambda * time) / lambda : time;
}

// exp(-lambda T) of excursions that end on the same and on the other side, and integrals of
// exp(-lambda t) times 1, f and the mirror image of f.
struct Discounts {
  double same, other, one, f, mirrored;
};
// Of an observable at one lambda; u where lambda > 0.
struct Parts {
  Estimate w_plus, w_minus, pi, mu, mu_minus, u = {}, u_minus = {};
};

// Both sides alternate; w+ and w- weigh with the chances of going over to them.
Parts parts_at(double lambda, const Sums<Discounts>& m) {
  const Smooth a = m.at(0, &Discounts::other), b = m.at(1, &Discounts::other),
               one_plus = m.at(0, &Discounts::one), one_minus = m.at(1, &Discounts::one),
               plus = m.at(0, &Discounts::f),
               minus = m.symmetric() ? m.at(0, &Discounts::mirrored) : m.at(1, &Discounts::f);
  const Smooth s = b * one_plus + a * one_minus;
  const Smooth pi = (b * plus + a * minus) / s;
  const Smooth apart =
      (one_minus * plus - one_plus * minus) / (s * (s + lambda * one_plus * one_minus));
  const Smooth mu = a * one_minus * apart, below = -1 * b * one_plus * apart;
  const auto estimate = [&m](const Smooth& f) { return m.estimate(f, {&Discounts::other}); };
  Parts parts{estimate(plus), estimate(minus), estimate(pi), estimate(mu), estimate(below)};
  if (lambda == 0) return parts;
  parts.u = estimate(pi / lambda + mu);
  parts.u_minus = estimate(pi / lambda + below);
  return parts;
}

// Results for an observable from its sums at each lambda.
Estimates resolvent_of(const model::Observable& f, const Tally& tally,
                       const std::vector<Sums<Discounts>>& sums) {
  const auto& lambda = tally.question().lambda;
  std::vector<Parts> parts;
  for (std::size_t n = 0; n < lambda.size(); ++n) parts.push_back(parts_at(lambda[n], sums[n]));
  const auto part = [&](const cases::Row& row, Estimate Parts::*which) {
    return array(
        row, lambda, [&](std::size_t n) { return parts[n].*which; }, &f);
  };
  const bool with_u = std::ranges::min(lambda) > 0;
  Estimates all{part(cases::kWPlus, &Parts::w_plus), part(cases::kWMinus, &Parts::w_minus),
                part(cases::kPiLambda, &Parts::pi), part(cases::kMu, &Parts::mu)};
  // Beside averages it may not take their name.
  const bool alone = !tally.question().wants(cases::Quantity::averages);
  if (alone) all[2].key = cases::kPi.key_of(f.name);
  if (with_u) all.push_back(part(cases::kU, &Parts::u));
  if (tally.process().symmetric()) return all;
  all.push_back(part(cases::kMuMinus, &Parts::mu_minus));
  if (with_u) all.push_back(part(cases::kUMinus, &Parts::u_minus));
  return all;
}

// What does not depend on the observable.
Estimates ends_of(const Tally& tally, const std::vector<Sums<Discounts>>& sums) {
  const auto end = [&](const cases::Row& row, std::size_t side, double Discounts::*which) {
    return array(row, tally.question().lambda, [&](std::size_t n) {
      return sums[n].estimate(sums[n].at(side, which), {&Discounts::same, &Discounts::other});
    });
  };
  Estimates all{end(cases::kHPlus, 0, &Discounts::same), end(cases::kHMinus, 0, &Discounts::other),
                end(cases::kWOne, 0, &Discounts::one)};
  if (tally.process().symmetric()) return all;
  all.push_back(end(cases::kHPlusFromMinus, 1, &Discounts::other));
  all.push_back(end(cases::kHMinusFromMinus, 1, &Discounts::same));
  all.push_back(end(cases::kWOneFromMinus, 1, &Discounts::one));
  return all;
}

// Of the excursions of a cycle from one level: their number, exp(-lambda T) of those followed by
// one upwards or downwards, and integrals of exp(-lambda t) times 1 and f. From the starts of all
// of them to the end of the cycle, integrals of f and what is left of the discount; from the start
// of the cycle to its end, integrals of f and 1.
struct Visits {
  double count, up, down, one, f, rest, left, cycle, cycle_one;
};

/// Follows the excursions of one cycle after the other.
class CyclesFrom {
 public:
  /// From s+ or s-; the n-th lambda, and an observable.
  CyclesFrom(const model::Process& process, bool up, double lambda, std::size_t n,
             std::size_t observable)
      : level_(process.exit_level(up)),
        highest_static_(process.highest_static()),
        lambda_(lambda),
        n_(n),
        observable_(observable) {}

  Visits operator()(const Excursion& e) {
    const double whole = e.slide + e.stick, h = std::exp(-lambda_ * whole),
                 one = discounted_time(lambda_, whole),
                 f = e.discounted[n_ * e.integrals.size() + observable_].value;
    const bool up = e.next > highest_static_;
    Visits v{};
    if (e.start == level_) {
      v = {1, up ? h : 0, up ? 0 : h, one, f, 0, 0, 0, 0};
      discount_ += 1;
    }
    v.rest = discount_ * f;
    v.cycle = since_begun_ * f;
    v.cycle_one = since_begun_ * one;
    discount_ *= h;
    since_begun_ *= h;
    if (!e.ends_cycle) return v;
    v.left = discount_;
    discount_ = 0;
    since_begun_ = 1;
    return v;
  }

 private:
  int level_, highest_static_;
  double lambda_;
  std::size_t n_, observable_;
  double discount_ = 0, since_begun_ = 1;  // from the visits and from the start of the cycle on
};

// What excursions from many starts give: nothing that takes all of them together. At the start of
// cycles u = w + E[exp(-lambda T)] u, over a cycle.
void from_cycles(Tally& tally, std::size_t number) {
  using Side = std::vector<Sums<Visits>>;
  const auto side = [&](bool up) {
    const auto& lambda = tally.question().lambda;
    const std::size_t place = tally.wanted().observe(tally.question().observables[number]);
    Side all;
    for (std::size_t n = 0; n < lambda.size(); ++n) {
      all.push_back(tally.sums(CyclesFrom(tally.process(), up, lambda[n], n, place)));
    }
    return all;
  };
  tally.report([=, plus = side(true), minus = side(false)](const Tally& t) {
    const auto& lambda = t.question().lambda;
    const auto& f = t.question().observables[number];
    Estimates all;
    const auto mean = [&](const cases::Row& row, const Side& from, double Visits::*which,
                          const model::Observable* of = nullptr) {
      const auto value = [&](std::size_t n) {
        return from[n].estimate(from[n].at(0, which) / from[n].at(0, &Visits::count),
                                {&Visits::up, &Visits::down});
      };
      all.push_back(array(row, lambda, value, of));
    };
    const auto u = [&](const cases::Row& row, const Side& from) {
      const auto value = [&](std::size_t n) {
        const auto at = [&](double Visits::*which) { return from[n].at(0, which); };
        const Smooth begun = at(&Visits::cycle) / (lambda[n] * at(&Visits::cycle_one));
        return from[n].estimate((at(&Visits::rest) + at(&Visits::left) * begun) /
                                at(&Visits::count));
      };
      all.push_back(array(row, lambda, value, &f));
    };
    const bool drifts = t.process().drifts();
    if (number == 0) {
      mean(cases::kHPlus, plus, &Visits::up);
      mean(cases::kHMinus, plus, &Visits::down);
      mean(cases::kWOne, plus, &Visits::one);
      if (drifts) {
        mean(cases::kHPlusFromMinus, minus, &Visits::up);
        mean(cases::kHMinusFromMinus, minus, &Visits::down);
        mean(cases::kWOneFromMinus, minus, &Visits::one);
      }
    }
    mean(cases::kWPlus, plus, &Visits::f, &f);
    mean(cases::kWMinus, minus, &Visits::f, &f);
    if (std::ranges::min(lambda) == 0) return all;
    u(cases::kU, plus);
    if (drifts) u(cases::kUMinus, minus);
    return all;
  });
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
    if (!omega.empty()) all.push_back(array(cases::kSV, omega, of_wave));
    all.push_back({&cases::kS0, {s}});
    all.push_back({&cases::kDiffusivity, {s / 2}});
    return all;
  });
}

void resolvent_tally(Tally& tally) {
  const auto& lambda = tally.wanted().discount = tally.question().lambda;
  if (tally.sampled() == Sampled::cycles) {
    for (std::size_t f = 0; f < tally.question().observables.size(); ++f) from_cycles(tally, f);
    return;
  }
  for (std::size_t f = 0; f < tally.question().observables.size(); ++f) {
    const std::size_t place = tally.wanted().observe(tally.question().observables[f]);
    std::vector<Sums<Discounts>> sums;
    for (std::size_t n = 0; n < lambda.size(); ++n) {
      sums.push_back(tally.sums([n, place, s = lambda[n]](const Excursion& e) -> Discounts {
        const double whole = e.slide + e.stick, turned = e.turned ? 1 : 0, h = std::exp(-s * whole);
        const auto& w = e.discounted[n * e.integrals.size() + place];
        return {(1 - turned) * h, turned * h, discounted_time(s, whole), w.value, w.mirrored};
      }));
    }
    if (f == 0) tally.report([=](const Tally& t) { return ends_of(t, sums); });
    tally.report(
        [=](const Tally& t) { return resolvent_of(t.question().observables[f], t, sums); });
  }
}

}  // namespace stickslip::simulation
