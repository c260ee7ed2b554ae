#include "stickslip/support/seal.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <stdexcept>
#include <string_view>

namespace stickslip {
namespace {

constexpr std::string_view kMember = R"(,"check":")";
constexpr std::size_t kDigits = 16, kTail = kMember.size() + kDigits + 2;  // and the closing "}

// FNV-1a with 64 bits: against accidents, not against forgery.
std::string checksum(std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (unsigned char c : text) hash = (hash ^ c) * 0x100000001b3;
  return fmt::format("{:016x}", hash);
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
