#pragma once
/// The quantities of single paths, their keys and arguments: given_force, trajectory.

#include "stickslip/case/entry.hpp"

namespace stickslip::cases {

// The quantity given_force: the motion of a body under a force from a file.

inline constexpr Row kFinalDisplacement{.key = "final_displacement",
                                        .symbol = "x(T)",
                                        .definition =
                                            "displacement from the first to the last sample",
                                        .unit = "velocity*time",
                                        .kind = Kind::mean,
                                        .asks = true};
inline constexpr Row kLargestDisplacement{.key = "largest_displacement",
                                          .symbol = "max |x(t)|",
                                          .definition = "largest distance from the beginning",
                                          .unit = "velocity*time",
                                          .kind = Kind::positive_mean,
                                          .asks = true};
inline constexpr Row kLargestSpeed{.key = "largest_speed",
                                   .symbol = "max |V|",
                                   .definition = "largest speed",
                                   .unit = "velocity",
                                   .kind = Kind::positive_mean,
                                   .asks = true};
inline constexpr Row kSlidingShare{.key = "sliding_share",
                                   .symbol = "(1/T) int 1{Y != 0} dt",
                                   .definition = "share of the time in which the body slides",
                                   .kind = Kind::probability,
                                   .asks = true};
inline constexpr Row kSlipCount{.key = "slip_count",
                                .symbol = "n",
                                .definition = "number of slips",
                                .convention = "one that is turned round without sticking is one",
                                .asks = true};
inline constexpr Row kSlipBegin{.key = "slip_begin",
                                .symbol = "t_i",
                                .definition = "when the body starts to slide",
                                .unit = "time",
                                .abscissa = "slip",
                                .convention = "by number of the slip, from 1"};
inline constexpr Row kSlipEnd{.key = "slip_end",
                              .symbol = "t_i + T_i",
                              .definition = "when it sticks again",
                              .unit = "time",
                              .abscissa = "slip",
                              .convention = "at most the end of the record"};
inline constexpr Row kSlipDisplacement{.key = "slip_displacement",
                                       .symbol = "int V dt",
                                       .definition = "net displacement of the slip",
                                       .unit = "velocity*time",
                                       .abscissa = "slip"};
inline constexpr Row kSlipPeak{.key = "slip_peak",
                               .symbol = "max |V|",
                               .definition = "largest speed of the slip",
                               .unit = "velocity",
                               .abscissa = "slip"};
inline constexpr Row kPathForce{.key = "path_force",
                                .symbol = "X(t)",
                                .definition = "force of the record, scaled",
                                .unit = "force",
                                .abscissa = "time",
                                .convention = "at the samples"};
inline constexpr Row kPathVelocity{.key = "path_velocity",
                                   .symbol = "V(t)",
                                   .definition = "velocity",
                                   .unit = "velocity",
                                   .abscissa = "time",
                                   .convention = "at the samples"};
inline constexpr Row kPathDisplacement{.key = "path_displacement",
                                       .symbol = "x(t)",
                                       .definition = "displacement",
                                       .unit = "velocity*time",
                                       .abscissa = "time",
                                       .convention = "at the samples"};

inline constexpr const Row* kGivenForceRows[] = {
    &kFinalDisplacement, &kLargestDisplacement, &kLargestSpeed, &kSlidingShare,
    &kSlipCount,         &kSlipBegin,           &kSlipEnd,      &kSlipDisplacement,
    &kSlipPeak,          &kPathForce,           &kPathVelocity, &kPathDisplacement};

inline constexpr Entry kGivenForce{
    .quantity = own_quantity("given_force"),
    .word = "given_force",
    .synonyms = "newmark, sliding_block, response, time_history",
    .title = "motion under the force of -force_file",
    .routes = {Route::excursion},
    .options = "force_file, force_interpolation, force_scale, force_rest, sample_layout, "
               "sample_step, force_gravity, start",
    .rows = kGivenForceRows,
    .without_system = true,
    .without_limit = true};

// The quantity trajectory: a simulated path in the file of -output or -trajectory.

inline constexpr Entry kTrajectory{.quantity = Quantity::trajectory,
                                   .word = "trajectory",
                                   .synonyms = "path, sample_path, simulation",
                                   .title =
                                       "a simulated path in the file of -output or -trajectory",
                                   .routes = {Route::excursion, Route::monte_carlo},
                                   .options = "start, horizon, seed",
                                   .of_levels = true,
                                   .without_system = true,
                                   .of_one_run = true};

}  // namespace stickslip::cases
