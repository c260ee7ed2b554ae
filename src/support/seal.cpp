#include "stickslip/support/seal.hpp"

#include <fmt/format.h>

#include <boost/crc.hpp>
#include <stdexcept>
#include <string_view>

namespace stickslip {
namespace {

constexpr std::string_view kMember = R"(,"check":")";
constexpr std::size_t kDigits = 16, kTail = kMember.size() + kDigits + 2;  // and the closing "}

// CRC-64/XZ: against accidents, not against forgery.
std::string checksum(const std::string& text) {
  boost::crc_optimal<64, 0x42f0e1eba9ea3693, ~0ull, ~0ull, true, true> crc;
  crc.process_bytes(text.data(), text.size());
  return fmt::format("{:016x}", crc.checksum());
}

}  // namespace

std::string sealed(const std::string& object) {
  if (!object.ends_with('}')) throw std::invalid_argument("only an object can be sealed");
  std::string text = object.substr(0, object.size() - 1);
  text += fmt::format("{}{}\"}}", kMember, checksum(object));
  return text;
}

std::optional<std::string> unsealed(const std::string& text) {
  if (text.size() < kTail) return std::nullopt;
  std::string object = text.substr(0, text.size() - kTail) + "}";
  if (sealed(object) != text) return std::nullopt;
  return object;
}

}  // namespace stickslip
