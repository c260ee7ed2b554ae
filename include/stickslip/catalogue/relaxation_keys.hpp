#pragma once
/// The quantity relaxation: leading eigenvalues of the generator, by SLEPc.

#include "stickslip/catalogue/entry.hpp"

namespace stickslip::catalogue {

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

}  // namespace stickslip::catalogue
