#include "stickslip/catalogue/sticking_keys.hpp"
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
    return {{&catalogue::kPStick, {sums.estimate(1 / (1 + slide / stick))}},
            {&catalogue::kPSlide, {sums.estimate(1 / (1 + stick / slide))}},
            {&catalogue::kMeanStick, {sums.estimate(stick)}},
            {&catalogue::kMeanSlide, {sums.estimate(slide)}},
            {&catalogue::kMeanExcursion, {sums.estimate(slide + stick)}}};
  });
}

}  // namespace stickslip::simulation
