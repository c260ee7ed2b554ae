#include <cmath>

#include "stickslip/case/duration_rows.hpp"
#include "stickslip/simulation/tally.hpp"

namespace stickslip::simulation {
namespace {

void follow_phases(Tally& tally) {
  const auto& time = tally.question().time;
  tally.distribution(cases::kDensitySlide, cases::kCdfSlide, time, &Excursion::slide);
  tally.distribution(cases::kDensityStick, cases::kCdfStick, time, &Excursion::stick);
}

double of_slide(const Excursion& e, double lambda) { return std::exp(-lambda * e.slide); }
double of_stick(const Excursion& e, double lambda) { return std::exp(-lambda * e.stick); }

}  // namespace

void duration_density_tally(Tally& tally) {
  follow_phases(tally);
  tally.distribution(cases::kDensityExcursion, cases::kCdfExcursion, tally.question().time,
                     [](const Excursion& e) { return e.slide + e.stick; });
}

void phase_durations_tally(Tally& tally) {
  if (!tally.question().wants(cases::Quantity::duration_density)) follow_phases(tally);
}

void laplace_tally(Tally& tally) {
  struct Durations {
    double slide, stick, square_of_slide, square_of_stick, square;
  };
  const auto& lambda = tally.question().lambda;
  tally.mean(cases::kTransformSlide, lambda, of_slide);
  tally.mean(cases::kTransformStick, lambda, of_stick);
  tally.mean(cases::kTransformExcursion, lambda,
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
    return {{&cases::kVarSlide, {variance(&Durations::square_of_slide, slide)}},
            {&cases::kVarStick, {variance(&Durations::square_of_stick, stick)}},
            {&cases::kVarExcursion, {variance(&Durations::square, slide + stick)}}};
  });
}

// The transforms of all durations include it.
void stick_transform_tally(Tally& tally) {
  if (tally.question().wants(cases::Quantity::laplace)) return;
  tally.mean(cases::kTransformStick, tally.question().lambda, of_stick);
}

void slip_tally(Tally& tally) {
  using namespace cases;
  const auto& [distance, s] =
      std::tie(tally.question().distance, tally.question().inverse_distance);
  tally.wanted().integrals = true;
  tally.moments(kMeanSlip, kVarSlip, &Excursion::path);
  tally.moments(kMeanSlipNet, kVarSlipNet, &Excursion::drift, -1);
  if (!distance.empty()) {
    tally.distribution(kDensitySlip, kCdfSlip, distance, &Excursion::path);
  }
  if (s.empty()) return;
  tally.mean(kTransformSlip, s,
             [](const Excursion& e, double by) { return std::exp(-by * e.path); });
}

}  // namespace stickslip::simulation
