#pragma once
/// The quantities of correlations in time, their keys and arguments: autocorrelation, expectations,
/// spectra, resolvent, relaxation.

#include "stickslip/case/entry.hpp"

namespace stickslip::cases {

// The quantity autocorrelation: autocovariance of the velocity.

inline constexpr Row kAutocovariance{.key = "C_vv",
                                     .symbol = "E[(V_0 - m)(V_t - m)]",
                                     .definition = "autocovariance of the velocity, m = E[V]",
                                     .unit = "velocity^2",
                                     .abscissa = "time",
                                     .convention = "stationary start; C_vv(0) = Var V",
                                     .paper = "sec. 4.2",
                                     .asks = true};

inline constexpr const Row* kAutocorrelationRows[] = {&kAutocovariance};

inline constexpr Entry kAutocorrelation{.quantity = Quantity::autocorrelation,
                                        .word = "autocorrelation",
                                        .synonyms = "acf, vacf, correlation, autocovariance",
                                        .title = "autocovariance of the velocity",
                                        .routes = {Route::excursion, Route::monte_carlo},
                                        .options = "time",
                                        .rows = kAutocorrelationRows};

// The quantity expectation: expectations from -start (backward Kolmogorov equation).

inline constexpr Row kExpectationOf{
    .key = "E(f)",
    .symbol = "E[f(Z_t) given Z_0]",
    .definition = "expectation of each observable f at time t, from the state of -start",
    .unit = "[f]",
    .abscissa = "time",
    .convention = "solution of the backward Kolmogorov equation",
    .paper = "(2.21), (2.22)",
    .is_mean_of_f = true};
inline constexpr Row kStationaryOf{.key = "stationary(f)",
                                   .symbol = "pi(f)",
                                   .definition = "limit of E(f) for t -> infinity",
                                   .unit = "[f]",
                                   .convention = "average per time",
                                   .paper = "(3.17)",
                                   .is_mean_of_f = true};

inline constexpr const Row* kExpectationRows[] = {&kExpectationOf, &kStationaryOf};

inline constexpr Entry kExpectation{.quantity = Quantity::expectation,
                                    .word = "expectation",
                                    .title =
                                        "expectations from -start (backward Kolmogorov equation)",
                                    .routes = {Route::excursion, Route::monte_carlo},
                                    .options = "observable, time, start",
                                    .rows = kExpectationRows};

// The quantity spectrum: power spectral density of the velocity, diffusivity.

inline constexpr Row kSV{.key = "S_v",
                         .symbol = "S_v(omega)",
                         .definition = "power spectral density of V - E[V]",
                         .unit = "velocity^2*time",
                         .abscissa = "omega",
                         .convention = "two-sided, angular frequency: int C_vv(t) exp(-i omega t) "
                                       "dt over all t; Var V = (1/2 pi) int S_v domega",
                         .paper = "(4.2) to (4.4)",
                         .kind = Kind::spectrum,
                         .each_by_its_size = true,
                         .asks = true};
inline constexpr Row kS0{.key = "S_0",
                         .symbol = "S_v(0)",
                         .definition = "power spectral density at frequency 0",
                         .unit = "velocity^2*time",
                         .convention = "as S_v",
                         .paper = "sec. 5.3",
                         .kind = Kind::spectrum,
                         .asks = true};
inline constexpr Row kDiffusivity{
    .key = "diffusivity",
    .symbol = "D = S_v(0)/2",
    .definition = "diffusivity: the variance of the displacement grows like 2 D t",
    .unit = "velocity^2*time",
    .convention = "about the drift E[V] t"};
inline constexpr Row kFullWidth{.key = "fwhm",
                                .symbol = "Delta omega",
                                .definition =
                                    "full width at half maximum: twice the omega where S_v = S_0/2",
                                .unit = "1/time",
                                .convention = "angular frequency",
                                .paper = "sec. 5.3",
                                .without = {Route::monte_carlo},
                                .asks = true};
inline constexpr Row kCorrelationTime{.key = "t_corr",
                                      .symbol = "1/Delta omega",
                                      .definition = "correlation time of the velocity",
                                      .unit = "time",
                                      .convention = "inverse of fwhm; of exp(-t/T) it is T/2. The "
                                                    "integral of C_vv(t)/C_vv(0) is S_0/(2 Var V)",
                                      .paper = "sec. 5.3",
                                      .without = {Route::monte_carlo},
                                      .asks = true};
inline constexpr Row kVarianceFromSpectrum{.key = "variance_from_spectrum",
                                           .symbol = "(1/2 pi) int S_v domega",
                                           .definition =
                                               "variance of V from the spectrum (Wiener-Khinchin)",
                                           .unit = "velocity^2",
                                           .convention = "compare with E_V2 - E_V^2",
                                           .without = {Route::monte_carlo}};

inline constexpr const Row* kSpectrumRows[] = {
    &kSV, &kS0, &kDiffusivity, &kFullWidth, &kCorrelationTime, &kVarianceFromSpectrum};

inline constexpr Entry kSpectrum{
    .quantity = Quantity::spectrum,
    .word = "spectrum",
    .synonyms = "psd, power, power_spectrum, power_spectral_density, spectral_density",
    .title = "power spectral density of the velocity, diffusivity",
    .routes = {Route::excursion, Route::monte_carlo},
    .options = "omega, spectrum_solver",
    .rows = kSpectrumRows};

// The quantity noise_spectrum: power spectral density of the noise.

inline constexpr Row kSX{.key = "S_x",
                         .symbol = "S_X(omega)",
                         .definition = "power spectral density of the chain X - E[X]",
                         .unit = "force^2*time",
                         .abscissa = "omega",
                         .convention = "as S_v; Var X = (1/2 pi) int S_x domega",
                         .kind = Kind::spectrum,
                         .each_by_its_size = true,
                         .asks = true};
inline constexpr Row kSXTarget{
    .key = "S_x_target",
    .symbol = "S(omega)",
    .definition = "power spectral density of the noise that the chain stands for",
    .unit = "force^2*time",
    .abscissa = "omega",
    .convention = "as S_x; of -noise ou, narrow_band and filtered, and sums of these",
    .kind = Kind::spectrum,
    .each_by_its_size = true};

inline constexpr const Row* kNoiseSpectrumRows[] = {&kSX, &kSXTarget};

inline constexpr Entry kNoiseSpectrum{
    .quantity = own_quantity("noise_spectrum"),
    .word = "noise_spectrum",
    .synonyms = "force_spectrum, noise_psd",
    .title = "power spectral density of the noise, beside that of what it stands for",
    .routes = {Route::excursion},
    .options = "omega",
    .rows = kNoiseSpectrumRows,
    .without_limit = true};

// The quantity resolvent: resolvent of the generator, and its parts over one excursion.

inline constexpr Row kHPlus{
    .key = "h_plus",
    .symbol = "h+_lambda(s+)",
    .definition = "E_s+[exp(-lambda T) 1{end at s+}]: transform of the duration of "
                  "the excursion from s+, on the event that it ends at s+",
    .abscissa = "lambda",
    .convention = "probability of that event at lambda = 0; of many starts, any one upwards",
    .paper = "(3.5), (3.10)",
    .each_by_its_size = true};
inline constexpr Row kHMinus{
    .key = "h_minus",
    .symbol = "h-_lambda(s+)",
    .definition = "E_s+[exp(-lambda T) 1{end at s-}]: the same on the event that it ends at s-",
    .abscissa = "lambda",
    .convention = "probability of that event at lambda = 0; of many starts, any one downwards",
    .paper = "(3.5), (3.11)",
    .each_by_its_size = true};
inline constexpr Row kWOne{
    .key = "w_one",
    .symbol = "w_lambda(s+; 1)",
    .definition = "E_s+[int_0^T exp(-lambda t) dt]: discounted duration of the excursion from s+",
    .unit = "time",
    .abscissa = "lambda",
    .convention = "its mean duration at lambda = 0",
    .paper = "(3.6), (3.12)",
    .each_by_its_size = true};
inline constexpr Row kHPlusFromMinus{.key = "h_plus_from_minus",
                                     .symbol = "h+_lambda(s-)",
                                     .definition = "the same as h_plus for the excursion from s-",
                                     .abscissa = "lambda",
                                     .convention = "without symmetry only",
                                     .paper = "(3.5)",
                                     .each_by_its_size = true};
inline constexpr Row kHMinusFromMinus{.key = "h_minus_from_minus",
                                      .symbol = "h-_lambda(s-)",
                                      .definition = "the same as h_minus for the excursion from s-",
                                      .abscissa = "lambda",
                                      .convention = "without symmetry only",
                                      .paper = "(3.5)",
                                      .each_by_its_size = true};
inline constexpr Row kWOneFromMinus{.key = "w_one_from_minus",
                                    .symbol = "w_lambda(s-; 1)",
                                    .definition = "the same as w_one for the excursion from s-",
                                    .unit = "time",
                                    .abscissa = "lambda",
                                    .convention = "without symmetry only",
                                    .paper = "(3.6)",
                                    .each_by_its_size = true};
inline constexpr Row kU{
    .key = "u(f)",
    .symbol = "u_lambda(s+; f)",
    .definition = "resolvent (lambda - L)^-1 f at s+: E_s+[int_0^inf exp(-lambda t) f(Z_t) dt]",
    .unit = "[f]*time",
    .abscissa = "lambda",
    .convention = "not given where a lambda is 0",
    .paper = "(3.1), (3.2), (3.15)",
    .each_by_its_size = true};
inline constexpr Row kWPlus{.key = "w_plus(f)",
                            .symbol = "w_lambda(s+; f)",
                            .definition = "E_s+[int_0^T exp(-lambda t) f(Z_t) dt]: discounted "
                                          "integral of f over the excursion from s+",
                            .unit = "[f]*time",
                            .abscissa = "lambda",
                            .convention = "finite at lambda = 0",
                            .paper = "(3.6), (3.12)"};
inline constexpr Row kWMinus{.key = "w_minus(f)",
                             .symbol = "w_lambda(s-; f)",
                             .definition = "the same as w_plus(f) for the excursion from s-",
                             .unit = "[f]*time",
                             .abscissa = "lambda",
                             .convention = "finite at lambda = 0",
                             .paper = "(3.6), (3.12)"};
inline constexpr Row kPiLambda{
    .key = "pi_lambda(f)",
    .symbol = "pi_lambda(f)",
    .definition = "discounted average, which tends to pi(f) as lambda -> 0",
    .unit = "[f]",
    .abscissa = "lambda",
    .convention =
        "its key is pi(f) where averages is not asked for; from many starts not by simulation",
    .paper = "(3.16)",
    .is_mean_of_f = true,
    .each_by_its_size = true};
inline constexpr Row kMu{.key = "mu(f)",
                         .symbol = "mu_lambda(f)",
                         .definition = "u_lambda(s+; f) - pi_lambda(f)/lambda",
                         .unit = "[f]*time",
                         .abscissa = "lambda",
                         .convention = "finite at lambda = 0; from many starts not by simulation",
                         .paper = "(3.16)"};
inline constexpr Row kUMinus{.key = "u_minus(f)",
                             .symbol = "u_lambda(s-; f)",
                             .definition = "the same as u(f) at s-",
                             .unit = "[f]*time",
                             .abscissa = "lambda",
                             .convention = "without symmetry only",
                             .paper = "(3.1)",
                             .each_by_its_size = true};
inline constexpr Row kMuMinus{.key = "mu_minus(f)",
                              .symbol = "u_lambda(s-; f) - pi_lambda(f)/lambda",
                              .definition = "the same as mu(f) at s-",
                              .unit = "[f]*time",
                              .abscissa = "lambda",
                              .convention = "without symmetry only"};

inline constexpr const Row* kResolventRows[] = {
    &kHPlus,           &kHMinus,        &kWOne, &kHPlusFromMinus,
    &kHMinusFromMinus, &kWOneFromMinus, &kU,    &kWPlus,
    &kWMinus,          &kPiLambda,      &kMu,   &kUMinus,
    &kMuMinus};

inline constexpr Entry kResolvent{
    .quantity = Quantity::resolvent,
    .word = "resolvent",
    .title = "resolvent of the generator, and its parts over one excursion",
    .routes = {Route::excursion, Route::monte_carlo},
    .options = "lambda, observable",
    .rows = kResolventRows,
    .of_phases = true};

// The quantity relaxation: leading eigenvalues of the generator, by SLEPc.

inline constexpr Row kRelaxationEven{.key = "relaxation_even",
                                     .symbol = "Re lambda_n, even",
                                     .definition =
                                         "relaxation rates: real parts of the leading eigenvalues "
                                         "of -L on even functions of the state",
                                     .unit = "1/time",
                                     .abscissa = "mode",
                                     .convention = "slowest first; with symmetry only"};
inline constexpr Row kRelaxationEvenFrequency{.key = "relaxation_even_frequency",
                                              .symbol = "Im lambda_n, even",
                                              .definition = "angular frequencies of these modes",
                                              .unit = "1/time",
                                              .abscissa = "mode",
                                              .convention = ">= 0: one of each conjugate pair"};
inline constexpr Row kRelaxationOdd{.key = "relaxation_odd",
                                    .symbol = "Re lambda_n, odd",
                                    .definition = "relaxation rates on odd functions of the state",
                                    .unit = "1/time",
                                    .abscissa = "mode",
                                    .convention = "slowest first; with symmetry only"};
inline constexpr Row kRelaxationOddFrequency{.key = "relaxation_odd_frequency",
                                             .symbol = "Im lambda_n, odd",
                                             .definition = "angular frequencies of these modes",
                                             .unit = "1/time",
                                             .abscissa = "mode",
                                             .convention = ">= 0: one of each conjugate pair"};
inline constexpr Row kRelaxationAll{.key = "relaxation",
                                    .symbol = "Re lambda_n",
                                    .definition = "relaxation rates on all functions of the state",
                                    .unit = "1/time",
                                    .abscissa = "mode",
                                    .convention = "slowest first; without symmetry only"};
inline constexpr Row kRelaxationAllFrequency{.key = "relaxation_frequency",
                                             .symbol = "Im lambda_n",
                                             .definition = "angular frequencies of these modes",
                                             .unit = "1/time",
                                             .abscissa = "mode",
                                             .convention = ">= 0: one of each conjugate pair"};

inline constexpr const Row* kRelaxationRows[] = {&kRelaxationEven, &kRelaxationEvenFrequency,
                                                 &kRelaxationOdd,  &kRelaxationOddFrequency,
                                                 &kRelaxationAll,  &kRelaxationAllFrequency};

inline constexpr Entry kRelaxation{
    .quantity = Quantity::relaxation,
    .word = "relaxation",
    .synonyms = "eigenvalues, spectral_gap, gap, modes, relaxation_time",
    .title = "leading eigenvalues of the generator, by SLEPc",
    .routes = {Route::excursion},
    .rows = kRelaxationRows,
    .unbounded = "the spectrum of the generator is continuous: its leading "
                 "eigenvalues would be those of a truncation",
    .instead = "take autocorrelation or spectrum, or a drag that grows",
    .weighs_tail = true};

}  // namespace stickslip::cases
