#pragma once
/// The quantities of the stationary distribution, their keys and arguments: sticking, moments,
/// averages, noise_law, entry_law, sensitivity.

#include "stickslip/case/entry.hpp"

namespace stickslip::cases {

// The quantity sticking: probability of sticking, mean durations of the phases.

inline constexpr Row kPStick{.key = "P_stick",
                             .symbol = "P_stick",
                             .definition = "probability of sticking: share of the time at rest",
                             .convention = "average per time",
                             .paper = "(4.5), (4.6), S^1 in (5.1)",
                             .kind = Kind::share,
                             .asks = true};
inline constexpr Row kPSlide{
    .key = "P_slide",
    .symbol = "1 - P_stick",
    .definition = "share of the time in sliding phases, computed without the subtraction",
    .convention = "average per time",
    .paper = "(4.10)",
    .kind = Kind::share,
    .asks = true};
inline constexpr Row kMeanStick{.key = "mean_stick",
                                .symbol = "E_exc[T_stick]",
                                .definition = "mean duration of a sticking phase",
                                .unit = "time",
                                .convention = "average per excursion",
                                .paper = "(4.6)",
                                .kind = Kind::positive_mean,
                                .without = {Route::lambda},
                                .asks = true};
inline constexpr Row kMeanSlide{.key = "mean_slide",
                                .symbol = "E_exc[T_slide]",
                                .definition = "mean duration of a sliding phase",
                                .unit = "time",
                                .convention = "average per excursion",
                                .paper = "R^(s+) in (4.7)",
                                .kind = Kind::positive_mean,
                                .without = {Route::lambda},
                                .asks = true};
inline constexpr Row kMeanExcursion{.key = "mean_excursion",
                                    .symbol = "E_exc[T], T = T_slide + T_stick",
                                    .definition = "mean duration of an excursion",
                                    .unit = "time",
                                    .convention = "average per excursion; T is tau_1 of the paper",
                                    .paper = "Prop. 3.1, (4.8), (4.9)",
                                    .kind = Kind::positive_mean,
                                    .without = {Route::lambda},
                                    .asks = true};

inline constexpr const Row* kStickingRows[] = {&kPStick, &kPSlide, &kMeanStick, &kMeanSlide,
                                               &kMeanExcursion};

inline constexpr Entry kSticking{.quantity = Quantity::sticking,
                                 .word = "sticking",
                                 .synonyms = "stick, mean_durations",
                                 .title = "probability of sticking, mean durations of the phases",
                                 .routes = {Route::excursion, Route::lambda, Route::hitting,
                                            Route::null_vector, Route::fluid_queue,
                                            Route::monte_carlo},
                                 .rows = kStickingRows,
                                 .of_phases = true,
                                 .by_excursion = true};

// The quantity moments: moments of the velocity in the stationary distribution.

inline constexpr Row kEV2{.key = "E_V2",
                          .symbol = "E[V^2]",
                          .definition = "second moment of the velocity",
                          .unit = "velocity^2",
                          .convention = "about 0: Var V = E_V2 - E_V^2",
                          .paper = "S^2 in (5.1)",
                          .kind = Kind::positive_mean,
                          .asks = true};
inline constexpr Row kEAbsV{.key = "E_absV",
                            .symbol = "E[|V|]",
                            .definition = "mean speed",
                            .unit = "velocity",
                            .convention = "average per time",
                            .kind = Kind::mean,
                            .asks = true};
inline constexpr Row kEXV{.key = "E_XV",
                          .symbol = "E[X V]",
                          .definition = "mean power of the noise, per unit mass",
                          .unit = "force*velocity",
                          .convention = "X without the bias g: E[(X + g) V] = E[F|V|] - E[b(V) V]",
                          .kind = Kind::mean,
                          .asks = true};
inline constexpr Row kEV{.key = "E_V",
                         .symbol = "E[V]",
                         .definition = "mean velocity",
                         .unit = "velocity",
                         .convention = "exactly 0 with symmetry",
                         .kind = Kind::drift,
                         .asks = true};

// Of a body on a spring, which other routes do not know.
inline constexpr Routes kWithoutSprings{Route::lambda, Route::hitting, Route::null_vector,
                                        Route::fluid_queue};

inline constexpr Row kEP{.key = "E_P",
                         .symbol = "E[P]",
                         .definition = "mean position of a body on a spring",
                         .unit = "length",
                         .convention =
                             "with -spring_stiffness K only; E[X + g]/K where friction is "
                             "the same to both sides",
                         .kind = Kind::drift,
                         .without = kWithoutSprings,
                         .asks = true};
inline constexpr Row kEP2{.key = "E_P2",
                          .symbol = "E[P^2]",
                          .definition = "second moment of the position",
                          .unit = "length^2",
                          .convention = "about 0, with -spring_stiffness K only; K E_P2/2 is the "
                                        "mean potential energy per unit mass",
                          .kind = Kind::positive_mean,
                          .without = kWithoutSprings,
                          .asks = true};
inline constexpr Row kEXP{.key = "E_XP",
                          .symbol = "E[X P]",
                          .definition = "mean product of noise and position",
                          .unit = "force*length",
                          .convention = "with -spring_stiffness only; tau E[X V] under -noise ou",
                          .kind = Kind::mean,
                          .without = kWithoutSprings,
                          .asks = true};

inline constexpr const Row* kMomentsRows[] = {&kEV2, &kEAbsV, &kEXV, &kEV, &kEP, &kEP2, &kEXP};

inline constexpr Entry kMoments{.quantity = Quantity::moments,
                                .word = "moments",
                                .synonyms = "variance, mean_square, energy",
                                .title = "moments of the velocity in the stationary distribution",
                                .routes = {Route::excursion, Route::lambda, Route::null_vector,
                                           Route::fluid_queue, Route::monte_carlo},
                                .rows = kMomentsRows,
                                .by_excursion = true};

// The quantity averages: stationary averages of functions of the state, overall and by phase.

inline constexpr Row kPi{.key = "pi(f)",
                         .symbol = "pi(f) = E[f(Z)]",
                         .definition = "stationary average of each observable f of -observable",
                         .unit = "[f]",
                         .convention = "average per time; Z = (X, Y, V)",
                         .paper = "(3.17), (4.1)",
                         .kind = Kind::drift,
                         .is_mean_of_f = true};
inline constexpr Row kPiStick{.key = "pi(f|stick)",
                              .symbol = "E[f(Z) given Y = 0]",
                              .definition = "average of f over the time at rest",
                              .unit = "[f]",
                              .convention = "average per time at rest",
                              .kind = Kind::drift,
                              .is_mean_of_f = true};
inline constexpr Row kPiSlide{.key = "pi(f|slide)",
                              .symbol = "E[f(Z) given Y != 0]",
                              .definition = "average of f over the time in sliding phases",
                              .unit = "[f]",
                              .convention = "average per time in motion",
                              .kind = Kind::drift,
                              .is_mean_of_f = true};
inline constexpr Row kSlipRate{.key = "slip_rate",
                               .symbol = "1/E_exc[T]",
                               .definition = "mean number of sliding phases per unit time",
                               .unit = "1/time",
                               .convention = "average per time",
                               .kind = Kind::positive_mean,
                               .without = {Route::lambda},
                               .asks = true};
inline constexpr Row kFrictionPower{.key = "friction_power",
                                    .symbol = "E[F|V|]",
                                    .definition =
                                        "mean power dissipated by dry friction, per unit mass",
                                    .unit = "force*velocity",
                                    .convention = "average per time",
                                    .kind = Kind::positive_mean,
                                    .asks = true};

inline constexpr const Row* kAveragesRows[] = {&kPi, &kPiStick, &kPiSlide, &kSlipRate,
                                               &kFrictionPower};

inline constexpr Entry kAverages{
    .quantity = Quantity::averages,
    .word = "averages",
    .title = "stationary averages of functions of the state, overall and by phase",
    .routes = {Route::excursion, Route::lambda, Route::null_vector, Route::monte_carlo},
    .options = "observable",
    .rows = kAveragesRows,
    .by_excursion = true};

// The quantity noise_law: stationary distribution of the noise.

inline constexpr Row kPWithin{
    .key = "P_X_le_mu_s",
    .symbol = "P(|X| <= mu_s)",
    .definition =
        "probability that the noise alone is within the static threshold, in motion or at rest",
    .convention = "X without the bias, mu_s that of -mu_s",
    .paper = "S^3 in (5.1)",
    .kind = Kind::probability,
    .asks = true};
inline constexpr Row kEX2{.key = "E_X2",
                          .symbol = "E[X^2]",
                          .definition = "second moment of the noise",
                          .unit = "force^2",
                          .convention = "about 0; 1/tau for -noise ou with all levels",
                          .paper = "sec. 2",
                          .kind = Kind::positive_mean,
                          .asks = true};

inline constexpr const Row* kNoiseLawRows[] = {&kPWithin, &kEX2};

inline constexpr Entry kNoiseLaw{.quantity = Quantity::noise_law,
                                 .word = "noise_law",
                                 .title = "stationary distribution of the noise",
                                 .routes = {Route::excursion, Route::lambda, Route::null_vector,
                                            Route::fluid_queue, Route::monte_carlo},
                                 .rows = kNoiseLawRows,
                                 .by_excursion = true};

// The quantity entry_law: hitting distribution at the onset of sticking.

inline constexpr Row kEntryLawPlus{.key = "entry_law",
                                   .symbol = "P^_k(s+)",
                                   .definition =
                                       "hitting distribution at the onset of sticking: probability "
                                       "that X = x_k when the sliding phase from s+ ends",
                                   .abscissa = "k",
                                   .convention = "sums to 1 over the levels that stick",
                                   .paper = "(4.13)",
                                   .asks = true};
inline constexpr Row kEntryLawMinus{.key = "entry_law_minus",
                                    .symbol = "P^_k(s-)",
                                    .definition =
                                        "the same as entry_law for the sliding phase from s-",
                                    .abscissa = "k",
                                    .convention = "without symmetry only"};
inline constexpr Row kFStick0{
    .key = "f_stick_0",
    .symbol = "f_stick(0+)",
    .definition = "limit of the probability density of sticking durations at t -> 0+",
    .unit = "1/time",
    .convention = "average per excursion",
    .paper = "sec. 5.3",
    .asks = true};

inline constexpr const Row* kEntryLawRows[] = {&kEntryLawPlus, &kEntryLawMinus, &kFStick0};

inline constexpr Entry kEntryLaw{
    .quantity = Quantity::entry_law,
    .word = "entry_law",
    .synonyms = "hitting, entry, onset",
    .title = "hitting distribution at the onset of sticking",
    .routes = {Route::excursion, Route::fluid_queue, Route::monte_carlo},
    .rows = kEntryLawRows,
    .degrees_besides = 2,
    .of_phases = true,
    .of_levels = true,
    .without_limit = true};

// The quantity sensitivity: derivatives of the scalars of sticking, moments and noise_law.

inline constexpr Row kDerivative{
    .key = "dA_dp",
    .symbol = "dA/dp",
    .definition = "derivative of each scalar A of sticking, moments and noise_law that is asked "
                  "for, such as dP_stick_dtau",
    .unit = "[A]/[p]",
    .convention = "p: mu_d, mu_d_minus if given, tau at fixed N, drag_coefficient, with -friction "
                  "stribeck also mu_s and stribeck_velocity; the static levels are held fixed. "
                  "Under noise of continuous paths also mu_s and the numbers of the noise",
    .kind = Kind::derivative};

/// The parameters p of these keys.
inline constexpr std::string_view kDifferentiatedBy[] = {"mu_d",
                                                         "mu_d_minus",
                                                         "mu_s",
                                                         "mu_s_minus",
                                                         "stribeck_velocity",
                                                         "tau",
                                                         "drag_coefficient",
                                                         "noise_deviation",
                                                         "band_frequency",
                                                         "band_width",
                                                         "ground_frequency",
                                                         "ground_damping",
                                                         "ground_intensity"};

inline constexpr const Row* kSensitivityRows[] = {&kDerivative};

inline constexpr Entry kSensitivity{
    .quantity = Quantity::sensitivity,
    .word = "sensitivity",
    .synonyms = "derivatives, gradient, gradients",
    .title = "derivatives of the scalars of sticking, moments and noise_law",
    .routes = {Route::excursion},
    .rows = kSensitivityRows,
    .of_phases = true,
    .without_system = true,
    .without_limit = true};

}  // namespace stickslip::cases
