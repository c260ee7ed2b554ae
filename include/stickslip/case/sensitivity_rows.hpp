#pragma once
/// The quantity sensitivity: derivatives of the scalars of sticking, moments and noise_law.

#include "stickslip/case/entry.hpp"

namespace stickslip::cases {

inline constexpr Row kDerivative{
    .key = "dA_dp",
    .symbol = "dA/dp",
    .definition = "derivative of each scalar A of sticking, moments and noise_law that is asked "
                  "for, such as dP_stick_dtau",
    .unit = "[A]/[p]",
    .convention = "p: mu_d, mu_d_minus if given, tau at fixed N, drag_coefficient, with -friction "
                  "stribeck also mu_s and stribeck_velocity; the static levels are held fixed",
    .kind = Kind::derivative};

/// The parameters p of these keys.
inline constexpr std::string_view kDifferentiatedBy[] = {
    "mu_d", "mu_d_minus", "mu_s", "stribeck_velocity", "tau", "drag_coefficient"};

inline constexpr const Row* kSensitivityRows[] = {&kDerivative};

inline constexpr Entry kSensitivity{
    .quantity = Quantity::sensitivity,
    .word = "sensitivity",
    .synonyms = "derivatives, gradient, gradients",
    .title = "derivatives of the scalars of sticking, moments and noise_law",
    .routes = {Route::excursion},
    .rows = kSensitivityRows,
    .of_phases = true,
    .of_levels = true,
    .without_system = true,
    .without_limit = true};

}  // namespace stickslip::cases
