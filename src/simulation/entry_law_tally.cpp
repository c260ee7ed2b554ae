#include "stickslip/catalogue/entry_law_keys.hpp"
#include "stickslip/simulation/tally.hpp"

namespace stickslip::simulation {

void entry_law_tally(Tally& tally) {
  std::vector<double> levels;
  const int lowest = tally.process().lowest_static(), highest = tally.process().highest_static();
  for (int i = lowest; i <= highest; ++i) levels.push_back(i);
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
    const auto& noise = t.process().noise;
    const double up = noise.up_rate(highest), down = noise.down_rate(lowest);
    const auto rate = [&](std::size_t n) {
      return (n == 0 ? down : 0) + (n + 1 == levels.size() ? up : 0);
    };
    all.push_back({&catalogue::kFStick0, {entries.mean(rate)}});
    return all;
  });
}

}  // namespace stickslip::simulation
