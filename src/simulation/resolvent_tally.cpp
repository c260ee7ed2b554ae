#include "stickslip/catalogue/resolvent_keys.hpp"

#include <algorithm>
#include <cmath>

#include "stickslip/catalogue/averages_keys.hpp"
#include "stickslip/simulation/tally.hpp"

namespace stickslip::simulation {
namespace {

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
  Parts parts{m.estimate(plus), m.estimate(minus), m.estimate(pi), m.estimate(mu),
              m.estimate(below)};
  if (lambda == 0) return parts;
  parts.u = m.estimate(pi / lambda + mu);
  parts.u_minus = m.estimate(pi / lambda + below);
  return parts;
}

// Results for an observable from its sums at each lambda.
Estimates resolvent_of(const model::Observable& f, const Tally& tally,
                       const std::vector<Sums<Discounts>>& sums) {
  const auto& lambda = tally.question().lambda;
  std::vector<Parts> parts;
  for (std::size_t n = 0; n < lambda.size(); ++n) parts.push_back(parts_at(lambda[n], sums[n]));
  const auto part = [&](const catalogue::Row& row, Estimate Parts::*which) {
    return array(
        row, lambda, [&](std::size_t n) { return parts[n].*which; }, &f);
  };
  const bool with_u = std::ranges::min(lambda) > 0;
  Estimates all{part(catalogue::kWPlus, &Parts::w_plus), part(catalogue::kWMinus, &Parts::w_minus),
                part(catalogue::kPiLambda, &Parts::pi), part(catalogue::kMu, &Parts::mu)};
  // Beside averages it may not take their name.
  const bool alone = !tally.question().wants(catalogue::Quantity::averages);
  if (alone) all[2].key = catalogue::kPi.key_of(f.name);
  if (with_u) all.push_back(part(catalogue::kU, &Parts::u));
  if (tally.process().symmetric()) return all;
  all.push_back(part(catalogue::kMuMinus, &Parts::mu_minus));
  if (with_u) all.push_back(part(catalogue::kUMinus, &Parts::u_minus));
  return all;
}

// What does not depend on the observable.
Estimates ends_of(const Tally& tally, const std::vector<Sums<Discounts>>& sums) {
  const auto end = [&](const catalogue::Row& row, std::size_t side, double Discounts::*which) {
    return array(row, tally.question().lambda,
                 [&](std::size_t n) { return sums[n].estimate(sums[n].at(side, which)); });
  };
  Estimates all{end(catalogue::kHPlus, 0, &Discounts::same),
                end(catalogue::kHMinus, 0, &Discounts::other),
                end(catalogue::kWOne, 0, &Discounts::one)};
  if (tally.process().symmetric()) return all;
  all.push_back(end(catalogue::kHPlusFromMinus, 1, &Discounts::other));
  all.push_back(end(catalogue::kHMinusFromMinus, 1, &Discounts::same));
  all.push_back(end(catalogue::kWOneFromMinus, 1, &Discounts::one));
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
    const auto mean = [&](const catalogue::Row& row, const Side& from, double Visits::*which,
                          const model::Observable* of = nullptr) {
      const auto value = [&](std::size_t n) {
        return from[n].estimate(from[n].at(0, which) / from[n].at(0, &Visits::count));
      };
      all.push_back(array(row, lambda, value, of));
    };
    const auto u = [&](const catalogue::Row& row, const Side& from) {
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
      mean(catalogue::kHPlus, plus, &Visits::up);
      mean(catalogue::kHMinus, plus, &Visits::down);
      mean(catalogue::kWOne, plus, &Visits::one);
      if (drifts) {
        mean(catalogue::kHPlusFromMinus, minus, &Visits::up);
        mean(catalogue::kHMinusFromMinus, minus, &Visits::down);
        mean(catalogue::kWOneFromMinus, minus, &Visits::one);
      }
    }
    mean(catalogue::kWPlus, plus, &Visits::f, &f);
    mean(catalogue::kWMinus, minus, &Visits::f, &f);
    if (std::ranges::min(lambda) == 0) return all;
    u(catalogue::kU, plus);
    if (drifts) u(catalogue::kUMinus, minus);
    return all;
  });
}

}  // namespace

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
