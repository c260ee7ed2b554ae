#pragma once
/// Means of observables over excursions.

#include "stickslip/simulation/tally.hpp"

namespace stickslip::simulation {

/// Integrals of an observable over the phases of an excursion, and their durations.
struct ObservedPhases {
  double slide, stick, of_slide, of_stick;
};

[[nodiscard]] Sums<ObservedPhases> observe(Tally& tally, const model::Observable& f);

/// pi(f).
[[nodiscard]] Estimate stationary_mean(const Sums<ObservedPhases>& sums);

/// Where all samples of f agree they may have missed what is rare: no interval is narrower than
/// that of an event that as many samples miss with probability 0.025. What symmetry makes zero is
/// exactly zero.
[[nodiscard]] Estimate widened(const Tally& tally, const model::Observable& f, const Estimate& e);

}  // namespace stickslip::simulation
