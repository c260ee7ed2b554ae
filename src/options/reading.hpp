#pragma once
/// Steps of read_request that single runs and sweeps share.

#include <string>
#include <utility>
#include <vector>

#include "stickslip/options/request.hpp"
#include "stickslip/options/settings.hpp"

namespace stickslip::options {

/// The run that the settings ask for; what is wrong with it goes to `problems`.
[[nodiscard]] Request request_of(const Settings& settings, Problems& problems);

/// Name and value of the options given to the solvers, by name.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> solver_options();

/// Whether an option -sweep_<option> is given.
[[nodiscard]] bool sweeps(const Settings& settings);

/// The request of the first point, with the sweep in it, after all points have been validated.
/// Throws BadInput.
[[nodiscard]] Request read_sweep(const Settings& settings);

}  // namespace stickslip::options
