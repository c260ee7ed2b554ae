#pragma once
/// Checksums of what is kept between runs: a digit that a disk has changed still reads as a number.

#include <optional>
#include <string>

namespace stickslip {

/// The text of a JSON object with a last member "check", the checksum of what stands before it.
/// Throws std::invalid_argument if `object` does not end with a brace.
[[nodiscard]] std::string sealed(const std::string& object);

/// The object that was sealed; nothing unless the checksum is right.
[[nodiscard]] std::optional<std::string> unsealed(const std::string& text);

}  // namespace stickslip
