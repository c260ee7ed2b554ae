#pragma once
/// Steps of reading a request, each in a file of its own, and those that sweeps share.

#include <string>
#include <utility>
#include <vector>

#include "stickslip/options/request.hpp"
#include "stickslip/options/settings.hpp"

namespace stickslip::options {

// model_parameters.cpp

/// The parameters of the model; v_max and the noise levels may stay open.
[[nodiscard]] model::Scene read_scene(const Settings& settings, Problems& problems);

/// The largest force that occurs: X passes mu_s by 12 standard deviations with probability e^-72.
[[nodiscard]] double largest_force(const model::Scene& scene);

/// What to say where static friction acts with another value than the one given, because it lies
/// between two noise levels; empty where it does not.
[[nodiscard]] std::string step_warning(const model::Scene& scene);

// reference.cpp

/// Throws std::invalid_argument unless it is a regular file that can be read.
void require_readable(const std::string& file);

// noise_file.cpp

/// The levels in a CSV file with the columns x,rate_up,rate_down. Throws std::invalid_argument with
/// the line and the value that is wrong.
[[nodiscard]] model::LevelTable read_levels(const std::string& file);

// question.cpp

/// The quantities and their arguments, for the model and the method that the request holds already.
void read_question(const Settings& settings, Request& request, Problems& problems);

// rules.cpp

/// Options that exclude one another, lack one another, or have no effect, which is a warning.
void check_rules(const Settings& settings, Request& request, Problems& problems);

// request.cpp

/// Names of the files, and whether progress is shown.
[[nodiscard]] Output read_output(const Settings& settings);

/// The run that the settings ask for; what is wrong with it goes to `problems`.
[[nodiscard]] Request request_of(const Settings& settings, Problems& problems);

// command_line.cpp

/// Whether a word of the command line names an option, and is no negative number.
[[nodiscard]] bool is_option_name(const std::string& word);

/// Words on the line that are neither an option nor the value of one; PETSc would ignore them.
void check_stray_words(const std::vector<std::string>& argv, Problems& problems);

// solver_options.cpp

/// Whether the types of solvers given are among those that work from options alone.
[[nodiscard]] bool check_solver_types(Problems& problems);

/// What the solver of each role says to its options, tried on a tiny matrix.
void check_solver_options(Problems& problems);

/// Options that neither the table nor a solver knows.
void check_unknown_options(Problems& problems);

/// What factors the sliding operator, by the options of its solver.
[[nodiscard]] Factors read_factors();

/// Name and value of the options given to the solvers, by name.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> solver_options();

// sweep.cpp

/// Whether an option -sweep_<option> is given.
[[nodiscard]] bool sweeps(const Settings& settings);

/// The request of the first point, with the sweep in it, after all points have been validated.
/// Throws BadInput.
[[nodiscard]] Request read_sweep(const Settings& settings);

}  // namespace stickslip::options
