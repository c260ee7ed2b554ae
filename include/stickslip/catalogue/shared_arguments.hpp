#pragma once
/// Lists of numbers that more than one quantity or method takes. A quantity names them among its
/// options.

#include "stickslip/catalogue/entry.hpp"

namespace stickslip::catalogue {

inline constexpr Argument kLambda{
    .option = "lambda",
    .unit = "1/time",
    .sentence = "arguments of the Laplace transforms and resolvents",
    .besides = "With -route lambda one positive value, chosen from -accuracy unless given",
    .example = "0.1,1,10",
    .low = 0,
    .low_included = true};

inline constexpr Argument kOmega{.option = "omega",
                                 .unit = "1/time",
                                 .sentence = "angular frequencies",
                                 .example = "0.01:10:31:log",
                                 .synonyms = "freq, frequency, frequencies",
                                 .low = 0,
                                 .low_included = true,
                                 .optional = true};

inline constexpr Argument kTime{.option = "time",
                                .unit = "time",
                                .sentence = "times",
                                .example = "0.01:10:31:log",
                                .synonyms = "t, times",
                                .low = 0,
                                .low_included = true};

inline constexpr Argument kDistance{.option = "distance",
                                    .unit = "velocity*time",
                                    .sentence =
                                        "distances, positive where they are lengths of paths,",
                                    .example = "0.01:10:31:log",
                                    .optional = true};

inline constexpr Argument kInverseDistance{.option = "inverse_distance",
                                           .unit = "1/(velocity*time)",
                                           .sentence = "arguments s of the transform F_slip",
                                           .example = "0.1,1,10",
                                           .low = 0,
                                           .low_included = true,
                                           .optional = true};

inline constexpr Argument kVelocity{.option = "velocity",
                                    .unit = "velocity",
                                    .sentence = "speeds w > 0",
                                    .example = "0.1:2:20",
                                    .synonyms = "speed, speeds",
                                    .low = 0};

}  // namespace stickslip::catalogue
