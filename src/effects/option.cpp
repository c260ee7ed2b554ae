#include "stickslip/effects/option.hpp"

#include <fmt/format.h>

namespace stickslip::effects {

bool Range::contains(double value) const {
  return (low_included ? value >= low : value > low) &&
         (high_included ? value <= high : value < high);
}

std::string Range::text() const {
  return fmt::format("{}{:g}, {:g}{}", low_included ? '[' : '(', low, high,
                     high_included ? ']' : ')');
}

}  // namespace stickslip::effects
