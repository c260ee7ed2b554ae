#pragma once
/// The quantity noise_spectrum: power spectral density of the noise.

#include "stickslip/catalogue/entry.hpp"

namespace stickslip::catalogue {

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

}  // namespace stickslip::catalogue
