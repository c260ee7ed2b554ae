#pragma once
/// Samples of a force without times and names, and a rest behind the last one.

#include <string>
#include <vector>

#include "stickslip/model/effect.hpp"
#include "stickslip/model/process.hpp"

namespace stickslip::effects {

/// -sample_layout, -sample_step, -force_rest.
[[nodiscard]] std::vector<Option> sample_options();

/// Whether a layout has a step, and columns none; refuses what is not so.
[[nodiscard]] bool layout_is_sound(Given& given);

/// The samples of -force_file: those of rows if -sample_layout says so, else what `columns` reads.
/// No force for the time of -force_rest follows, from one step behind the last sample on. Throws
/// std::invalid_argument with the line of what is no finite number.
[[nodiscard]] model::ForceRecord read_samples(const Given& given, const std::string& file,
                                              model::ForceRecord (*columns)(const std::string&));

// A force over time from a file.

/// Its options.
[[nodiscard]] std::vector<Option> force_options();

/// Reads the record that they name, if any, into a scene; what is wrong with it is refused.
void read_force(Given& given, model::Scene& scene);

}  // namespace stickslip::effects
