#pragma once
/// The quantity resolvent: resolvent of the generator, and its parts over one excursion.

#include "stickslip/catalogue/entry.hpp"

namespace stickslip::catalogue {

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

}  // namespace stickslip::catalogue
