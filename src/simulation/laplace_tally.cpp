#include "stickslip/catalogue/laplace_keys.hpp"

#include <cmath>

#include "stickslip/simulation/tally.hpp"

namespace stickslip::simulation {
namespace {

double of_slide(const Excursion& e, double lambda) { return std::exp(-lambda * e.slide); }
double of_stick(const Excursion& e, double lambda) { return std::exp(-lambda * e.stick); }

}  // namespace

void laplace_tally(Tally& tally) {
  struct Durations {
    double slide, stick, square_of_slide, square_of_stick, square;
  };
  const auto& lambda = tally.question().lambda;
  tally.mean(catalogue::kTransformSlide, lambda, of_slide);
  tally.mean(catalogue::kTransformStick, lambda, of_stick);
  tally.mean(catalogue::kTransformExcursion, lambda,
             [](const Excursion& e, double s) { return of_slide(e, s) * of_stick(e, s); });
  const auto m = tally.sums([](const Excursion& e) {
    const double whole = e.slide + e.stick;
    return Durations{e.slide, e.stick, e.slide * e.slide, e.stick * e.stick, whole * whole};
  });
  tally.report([=](const Tally&) -> Estimates {
    const Smooth slide = m.overall(&Durations::slide), stick = m.overall(&Durations::stick);
    const auto variance = [&](double Durations::*square, const Smooth& mean) {
      return m.estimate(m.overall(square) - mean * mean);
    };
    return {{&catalogue::kVarSlide, {variance(&Durations::square_of_slide, slide)}},
            {&catalogue::kVarStick, {variance(&Durations::square_of_stick, stick)}},
            {&catalogue::kVarExcursion, {variance(&Durations::square, slide + stick)}}};
  });
}

// The transforms of all durations include it.
void stick_transform_tally(Tally& tally) {
  if (tally.question().wants(catalogue::Quantity::laplace)) return;
  tally.mean(catalogue::kTransformStick, tally.question().lambda, of_stick);
}

}  // namespace stickslip::simulation
