#include "stickslip/catalogue/resolvent_keys.hpp"

#include <algorithm>
#include <cmath>

#include "stickslip/catalogue/averages_keys.hpp"
#include "stickslip/simulation/tally.hpp"

namespace stickslip::simulation {
namespace {

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

}  // namespace

void resolvent_tally(Tally& tally) {
  const auto& lambda = tally.wanted().discount = tally.question().lambda;
  for (std::size_t f = 0; f < tally.question().observables.size(); ++f) {
    const std::size_t place = tally.wanted().observe(tally.question().observables[f]);
    std::vector<Sums<Discounts>> sums;
    for (std::size_t n = 0; n < lambda.size(); ++n) {
      sums.push_back(tally.sums([n, place, s = lambda[n]](const Excursion& e) -> Discounts {
        const double whole = e.slide + e.stick, turned = e.turned ? 1 : 0, h = std::exp(-s * whole);
        const auto& w = e.discounted[n * e.integrals.size() + place];
        const double one = s > 0 ? -std::expm1(-s * whole) / s : whole;
        return {(1 - turned) * h, turned * h, one, w.value, w.mirrored};
      }));
    }
    if (f == 0) tally.report([=](const Tally& t) { return ends_of(t, sums); });
    tally.report(
        [=](const Tally& t) { return resolvent_of(t.question().observables[f], t, sums); });
  }
}

}  // namespace stickslip::simulation
