#pragma once
/// Results as JSON, in summaries and in checkpoints of sweeps, and read from it.

#include <nlohmann/json_fwd.hpp>

#include "stickslip/quantities/results.hpp"

namespace stickslip::outputs {

// JSON for Modern C++: the common header-only writer; numbers are written so that they read back
// to the same bits. It takes seconds to compile: sources that make JSON include it, headers do not.
using Json = nlohmann::ordered_json;

/// An object with the results by their keys.
[[nodiscard]] Json results_json(const quantities::Results& results);

/// The results of such an object, with what it states of them. JSON has no word for what is not
/// finite: null is read as NaN. Throws Json::exception where something is missing or of another
/// type, and std::invalid_argument where values, errors and arguments differ in number.
[[nodiscard]] quantities::Results results_of(const Json& json);

}  // namespace stickslip::outputs
