#pragma once
/// Steps of reading a request, each in a file of its own, and those that sweeps share.

#include <string>
#include <utility>
#include <vector>

#include "stickslip/options/request.hpp"
#include "stickslip/options/settings.hpp"

namespace stickslip::options {

// question.cpp

/// The quantities and their arguments, for the model and the method that the request holds already.
void read_question(Settings& settings, Request& request);

/// The words of -quantities. With a given force, trajectory is its motion.
[[nodiscard]] std::vector<std::string> asked_quantities(const Settings& settings);

// rules.cpp

/// Options that exclude one another, lack one another, or have no effect, which is a warning.
void check_rules(Settings& settings, Request& request);

// request.cpp

/// Names of the files, and whether progress is shown.
[[nodiscard]] Files read_files(const Settings& settings);

/// The run that the settings ask for; what is wrong with it is added to their problems.
[[nodiscard]] Request request_of(Settings& settings);

// command_line.cpp

/// Words on the line that are neither an option nor the value of one; PETSc would ignore them.
void check_stray_words(const std::vector<std::string>& argv, Problems& problems);

// sweep.cpp

/// Whether an option -sweep_<option> is given.
[[nodiscard]] bool sweeps(const Settings& settings);

/// The request of the first point, with the sweep in it, after all points have been validated.
/// Throws BadInput.
[[nodiscard]] Request read_sweep(Settings settings);

}  // namespace stickslip::options
