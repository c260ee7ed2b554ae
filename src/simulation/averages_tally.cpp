#include "stickslip/catalogue/averages_keys.hpp"

#include <cmath>
#include <optional>

#include "observed_phases.hpp"

namespace stickslip::simulation {

Sums<ObservedPhases> observe(Tally& tally, const model::Observable& f) {
  return tally.sums([place = tally.wanted().observe(f)](const Excursion& e) {
    return ObservedPhases{e.slide, e.stick, e.integrals[place].slide, e.integrals[place].stick};
  });
}

Estimate stationary_mean(const Sums<ObservedPhases>& sums) {
  return sums.over_time(sums.overall(&ObservedPhases::of_slide) +
                        sums.overall(&ObservedPhases::of_stick));
}

Estimate widened(const Tally& tally, const model::Observable& f, const Estimate& e) {
  const bool odd = tally.process().symmetric() && f.least == -f.most;
  if (e.low < e.high || odd || !std::isfinite(f.most - f.least)) return e;
  const double missed = -std::log(0.025) / tally.samples();
  return {e.value, e.low - missed * (e.value - f.least), e.high + missed * (f.most - e.value)};
}

namespace {

struct Paths {
  double slide, stick, path, drift;
};

void average(Tally& tally, std::size_t n) {
  const auto m = observe(tally, tally.question().observables[n]);
  tally.report([=](const Tally& t) -> Estimates {
    const auto& f = t.question().observables[n];
    const auto ratio = [&](auto integral, auto time) {
      return m.estimate(m.overall(integral) / m.overall(time));
    };
    const Estimate stick = ratio(&ObservedPhases::of_stick, &ObservedPhases::stick),
                   slide = ratio(&ObservedPhases::of_slide, &ObservedPhases::slide);
    return {{&catalogue::kPi, {widened(t, f, stationary_mean(m))}, {}, &f},
            {&catalogue::kPiStick, {stick}, {}, &f},
            {&catalogue::kPiSlide, {widened(t, f, slide)}, {}, &f}};
  });
}

}  // namespace

void averages_tally(Tally& tally) {
  for (std::size_t n = 0; n < tally.question().observables.size(); ++n) average(tally, n);
  tally.wanted().integrals = true;
  const auto& friction = tally.process().friction;
  std::optional<Sums<ObservedPhases>> power;
  if (friction.weakens()) power = observe(tally, model::friction_power(friction));
  const auto m = tally.sums([](const Excursion& e) {
    return Paths{e.slide, e.stick, e.path, e.drift};
  });
  tally.report([=](const Tally& t) -> Estimates {
    // mu_d+ E[V+] + mu_d- E[V-] where friction does not depend on the velocity.
    const double up = t.process().friction.mu_d, down = t.process().friction.mirrored().mu_d;
    const Smooth constant =
        (up + down) / 2 * m.overall(&Paths::path) + (up - down) / 2 * m.overall(&Paths::drift, -1);
    return {
        {&catalogue::kSlipRate, {m.over_time(1)}},
        {&catalogue::kFrictionPower, {power ? stationary_mean(*power) : m.over_time(constant)}}};
  });
}

}  // namespace stickslip::simulation
