#pragma once
/// The quantity spectrum: power spectral density of the velocity, diffusivity.

#include "stickslip/catalogue/entry.hpp"

namespace stickslip::catalogue {

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

}  // namespace stickslip::catalogue
