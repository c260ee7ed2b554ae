#include "stickslip/catalogue/entry_law_keys.hpp"
#include "stickslip/simulation/tally.hpp"

namespace stickslip::simulation {
namespace {

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
    const auto law = [&](const catalogue::Row& row, double Hits::*here, double Hits::*all) {
      return array(row, levels, [&](std::size_t n) {
        const Smooth share = hits[n].overall(here) / hits[n].overall(all);
        return jeffreys(hits[n], share, 1, hits[n].count());
      });
    };
    return {law(catalogue::kEntryLawPlus, &Hits::up_here, &Hits::up),
            law(catalogue::kEntryLawMinus, &Hits::down_here, &Hits::down),
            {&catalogue::kFStick0, {exits.estimate(exits.overall(&Exits::rate))}}};
  });
}

}  // namespace

void entry_law_tally(Tally& tally) {
  std::vector<double> levels;
  const int lowest = tally.process().lowest_static(), highest = tally.process().highest_static();
  for (int i = lowest; i <= highest; ++i) levels.push_back(i);
  if (tally.sampled() == Sampled::cycles) return entry_laws_of_cycles(tally, levels);
  const Histogram& entries = tally.histogram({levels.begin() + 1, levels.end()}, &Excursion::entry);
  tally.report([=, &entries](const Tally& t) {
    const auto from = [&](const catalogue::Row& row, std::size_t side) {
      return array(row, levels, [&](std::size_t at) {
        return entries.mean(side, [at](std::size_t n) { return n == at ? 1.0 : 0.0; });
      });
    };
    Estimates all{from(catalogue::kEntryLawPlus, 0)};
    if (!t.process().symmetric()) all.push_back(from(catalogue::kEntryLawMinus, 1));
    // The rate at which a body leaves rest as it has come there.
    const auto rates = t.process().exit_rates();
    all.push_back({&catalogue::kFStick0, {entries.mean([&](std::size_t n) { return rates[n]; })}});
    return all;
  });
}

}  // namespace stickslip::simulation
