#pragma once
/// Files to read.

#include <string>

namespace stickslip {

/// Throws std::invalid_argument unless it is a regular file that can be read.
void require_readable(const std::string& file);

}  // namespace stickslip
