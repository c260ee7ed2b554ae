#pragma once
/// Results as JSON, in summaries and in checkpoints of sweeps.

#include <nlohmann/json_fwd.hpp>

#include "stickslip/quantities/results.hpp"

namespace stickslip::outputs {

// JSON for Modern C++: the common header-only writer; numbers are written so that they read back
// to the same bits. It takes seconds to compile: sources that make JSON include it, headers do not.
using Json = nlohmann::ordered_json;

/// An object with the results by their keys.
[[nodiscard]] Json results_json(const quantities::Results& results);

}  // namespace stickslip::outputs
