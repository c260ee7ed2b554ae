#pragma once
/// The quantity displacement_transform: characteristic function of the displacement.

#include "stickslip/catalogue/entry.hpp"

namespace stickslip::catalogue {

inline constexpr Argument kWavenumber{.option = "wavenumber",
                                      .unit = "1/(velocity*time)",
                                      .sentence = "wavenumbers k",
                                      .example = "0.5,1,2",
                                      .synonyms = "wavenumbers, wave_number"};

inline constexpr Row kDisplacementCosine{
    .key = "displacement_cosine(t)",
    .symbol = "Re E[exp(i k x(t))]",
    .definition = "real part of the characteristic function of the displacement from -start",
    .abscissa = "wavenumber",
    .convention = "1 at k = 0; for each -time",
    .asks = true};
inline constexpr Row kDisplacementSine{
    .key = "displacement_sine(t)",
    .symbol = "Im E[exp(i k x(t))]",
    .definition = "imaginary part of the characteristic function of the displacement from -start",
    .abscissa = "wavenumber",
    .convention = "0 at k = 0; for each -time",
    .asks = true};

inline constexpr const Row* kDisplacementTransformRows[] = {&kDisplacementCosine,
                                                            &kDisplacementSine};
inline constexpr const Argument* kDisplacementTransformArguments[] = {&kWavenumber};

inline constexpr Entry kDisplacementTransform{
    .quantity = own_quantity("displacement_transform"),
    .word = "displacement_transform",
    .synonyms = "characteristic_function, intermediate_scattering_function, isf",
    .title = "characteristic function of the displacement from -start",
    .routes = {Route::excursion, Route::monte_carlo},
    .options = "time, start",
    .arguments = kDisplacementTransformArguments,
    .rows = kDisplacementTransformRows,
    .weighs_tail = true,
    .both_branches = true};

}  // namespace stickslip::catalogue
