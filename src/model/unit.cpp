#include "stickslip/model/unit.hpp"

#include <array>
#include <stdexcept>

#include "stickslip/support/text.hpp"

namespace stickslip::model {
namespace {

struct Base {
  const char* name;
  int Unit::*power;
};
// In the order in which they are written.
constexpr std::array kBases{Base{"force", &Unit::force}, Base{"velocity", &Unit::velocity},
                            Base{"time", &Unit::time}};

[[noreturn]] void refuse(std::string_view text) {
  throw std::invalid_argument("no unit: " + std::string(text));
}

// "velocity^2*time"; "1" stands for no factor.
Unit product(std::string_view text) {
  Unit unit;
  if (text == "1") return unit;
  for (const std::string& factor : split(text, '*')) {
    const auto parts = split(factor, '^');
    bool known = false;
    for (const Base& base : kBases) {
      if (parts.at(0) != base.name) continue;
      known = true;
      unit.*base.power += parts.size() == 2 ? std::stoi(parts[1]) : 1;
    }
    if (!known) refuse(text);
  }
  return unit;
}

struct Product {
  std::string text;
  int factors = 0;

  void multiply(const char* name, int power) {
    text += (factors == 0 ? "" : "*") + std::string(name);
    if (power > 1) text += "^" + std::to_string(power);
    ++factors;
  }
};

}  // namespace

Unit Unit::parse(std::string_view text) {
  const auto slash = text.find('/');
  const Unit above = product(text.substr(0, slash));
  if (slash == text.npos) return above;
  std::string_view below = text.substr(slash + 1);
  const bool bracketed = below.size() > 2 && below.front() == '(' && below.back() == ')';
  if (bracketed) below = below.substr(1, below.size() - 2);
  const Unit divisor = product(below);
  if (divisor == Unit{}) refuse(text);
  return above / divisor;
}

std::string Unit::text() const {
  Product above, below;
  for (const Base& base : kBases) {
    const int power = this->*base.power;
    if (power > 0) above.multiply(base.name, power);
    if (power < 0) below.multiply(base.name, -power);
  }
  if (below.factors == 0) return above.text;
  return (above.factors == 0 ? "1" : above.text) + "/" +
         (below.factors == 1 ? below.text : "(" + below.text + ")");
}

}  // namespace stickslip::model
