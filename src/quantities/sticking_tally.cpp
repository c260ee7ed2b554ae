#include <cmath>
#include <optional>

#include "stickslip/case/spectrum_rows.hpp"
#include "stickslip/case/sticking_rows.hpp"
#include "stickslip/simulation/tally.hpp"

namespace stickslip::simulation {

void sticking_tally(Tally& tally) {
  struct Phases {
    double slide, stick;
  };
  const auto sums = tally.sums([](const Excursion& e) { return Phases{e.slide, e.stick}; });
  // Shares without differences of nearly equal numbers.
  tally.report([=](const Tally&) -> Estimates {
    const Smooth slide = sums.overall(&Phases::slide), stick = sums.overall(&Phases::stick);
    return {{&cases::kPStick, {sums.estimate(1 / (1 + slide / stick))}},
            {&cases::kPSlide, {sums.estimate(1 / (1 + stick / slide))}},
            {&cases::kMeanStick, {sums.estimate(stick)}},
            {&cases::kMeanSlide, {sums.estimate(slide)}},
            {&cases::kMeanExcursion, {sums.estimate(slide + stick)}}};
  });
}

void moments_tally(Tally& tally) {
  tally.wanted().integrals = true;
  tally.over_time(cases::kEV2, &Excursion::square);
  tally.over_time(cases::kEAbsV, &Excursion::path);
  tally.over_time(cases::kEXV, &Excursion::product);
  const bool tied = tally.process().stiffness > 0;
  const auto odd = [&](const cases::Row& row, double Excursion::*of, bool zero) {
    if (!zero) return tally.over_time(row, of, -1);
    tally.report([&row](const Tally&) -> Estimates {
      return {{.row = &row, .values = {{}}, .exact = true}};
    });
  };
  odd(cases::kEV, &Excursion::drift, tied || !tally.process().drifts());
  if (!tied) return;
  odd(cases::kEP, &Excursion::place, !tally.process().drifts());
  tally.over_time(cases::kEP2, &Excursion::place_square);
  tally.over_time(cases::kEXP, &Excursion::place_noise);
}

namespace {

// Integrals of an observable over the phases of an excursion, and their durations.
struct ObservedPhases {
  double slide, stick, of_slide, of_stick;
};

Sums<ObservedPhases> observe(Tally& tally, const model::Observable& f) {
  return tally.sums([place = tally.wanted().observe(f)](const Excursion& e) {
    return ObservedPhases{e.slide, e.stick, e.integrals[place].slide, e.integrals[place].stick};
  });
}

// pi(f).
Estimate stationary_mean(const Sums<ObservedPhases>& sums) {
  return sums.over_time(sums.overall(&ObservedPhases::of_slide) +
                        sums.overall(&ObservedPhases::of_stick));
}

// Where all samples of f agree they may have missed what is rare: no interval is narrower than that
// of an event that as many samples miss with probability 0.025. What symmetry makes zero is exactly
// zero.
Estimate widened(const Tally& tally, const model::Observable& f, const Estimate& e) {
  const bool odd = tally.process().symmetric() && f.least == -f.most;
  if (e.low < e.high || odd || !std::isfinite(f.most - f.least)) return e;
  const double missed = -std::log(0.025) / tally.samples();
  return {e.value, e.low - missed * (e.value - f.least), e.high + missed * (f.most - e.value)};
}

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
    return {{&cases::kPi, {widened(t, f, stationary_mean(m))}, {}, &f},
            {&cases::kPiStick, {stick}, {}, &f},
            {&cases::kPiSlide, {widened(t, f, slide)}, {}, &f}};
  });
}

void expectation_of(Tally& tally, std::size_t n) {
  const auto& f = tally.question().observables[n];
  const auto stationary = observe(tally, f);
  const auto& start = tally.question().start;
  const bool even = tally.process().symmetric() && start.kind == model::Start::Kind::stationary;
  const auto sums = tally.sums_along(start, [f, even](const FollowedPath& path, const State& z) {
    const double value = even ? f.even(z.x, z.y, z.v) : f(z.x, z.y, z.v);
    return Weighted{path.weight, path.weight * value};
  });
  tally.report([=](const Tally& t) -> Estimates {
    const auto& of = t.question().observables[n];
    const auto mean = [&](std::size_t at) {
      return widened(t, of, sums[at].estimate(mean_of(sums[at])));
    };
    const Estimate in_the_end = widened(t, of, stationary_mean(stationary));
    return {array(cases::kExpectationOf, t.question().time, mean, &of),
            {&cases::kStationaryOf, {in_the_end}, {}, &of}};
  });
}

// Of sliding phases upwards and downwards, as they occur in cycles, and of all.
void entry_laws_of_cycles(Tally& tally, const std::vector<double>& levels) {
  struct Hits {
    double up, up_here, down, down_here;
  };
  struct Exits {
    double rate;
  };
  std::vector<Sums<Hits>> hits;
  for (double level : levels) {
    hits.push_back(tally.sums([level](const Excursion& e) {
      const double here = e.entry == level ? 1 : 0, up = e.upwards ? 1 : 0;
      return Hits{up, up * here, 1 - up, (1 - up) * here};
    }));
  }
  const auto exits =
      tally.sums([rates = tally.process().exit_rates(), first = tally.process().lowest_static()](
                     const Excursion& e) { return Exits{rates[e.entry - first]}; });
  tally.report([=](const Tally&) -> Estimates {
    const auto law = [&](const cases::Row& row, double Hits::*here, double Hits::*all) {
      return array(row, levels, [&](std::size_t n) {
        const Smooth share = hits[n].overall(here) / hits[n].overall(all);
        return jeffreys(hits[n], share, 1, hits[n].count());
      });
    };
    return {law(cases::kEntryLawPlus, &Hits::up_here, &Hits::up),
            law(cases::kEntryLawMinus, &Hits::down_here, &Hits::down),
            {&cases::kFStick0, {exits.estimate(exits.overall(&Exits::rate))}}};
  });
}

}  // namespace

void expectation_tally(Tally& tally) {
  for (std::size_t n = 0; n < tally.question().observables.size(); ++n) expectation_of(tally, n);
}

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
    return {{&cases::kSlipRate, {m.over_time(1)}},
            {&cases::kFrictionPower, {power ? stationary_mean(*power) : m.over_time(constant)}}};
  });
}

void noise_law_tally(Tally& tally) {
  tally.wanted().noise = true;
  tally.over_time(cases::kPWithin, &Excursion::within);
  tally.over_time(cases::kEX2, &Excursion::noise_square);
}

void entry_law_tally(Tally& tally) {
  std::vector<double> levels;
  const int lowest = tally.process().lowest_static(), highest = tally.process().highest_static();
  for (int i = lowest; i <= highest; ++i) levels.push_back(i);
  if (tally.sampled() == Sampled::cycles) return entry_laws_of_cycles(tally, levels);
  const Histogram& entries = tally.histogram({levels.begin() + 1, levels.end()}, &Excursion::entry);
  tally.report([=, &entries](const Tally& t) {
    const auto from = [&](const cases::Row& row, std::size_t side) {
      return array(row, levels, [&](std::size_t at) {
        return entries.mean(side, [at](std::size_t n) { return n == at ? 1.0 : 0.0; });
      });
    };
    Estimates all{from(cases::kEntryLawPlus, 0)};
    if (!t.process().symmetric()) all.push_back(from(cases::kEntryLawMinus, 1));
    // The rate at which a body leaves rest as it has come there.
    const auto rates = t.process().exit_rates();
    all.push_back({&cases::kFStick0, {entries.mean([&](std::size_t n) { return rates[n]; })}});
    return all;
  });
}

}  // namespace stickslip::simulation
