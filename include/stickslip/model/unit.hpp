#pragma once
/// Units of results as products of powers.

#include <string>
#include <string_view>

namespace stickslip::model {

/// A product of powers of force (per unit mass), velocity and time. Force is kept apart from
/// velocity/time, so that a unit shows what its number is made of.
struct Unit {
  int force = 0, velocity = 0, time = 0;

  /// Reads what text() writes. O(length). Throws std::invalid_argument for anything else.
  [[nodiscard]] static Unit parse(std::string_view text);
  /// Such as "velocity^2*time", "1/time", "force/(velocity*time)"; empty for a pure number.
  [[nodiscard]] std::string text() const;

  friend bool operator==(const Unit&, const Unit&) = default;
  friend Unit operator/(const Unit& a, const Unit& b) {
    return {a.force - b.force, a.velocity - b.velocity, a.time - b.time};
  }
};

}  // namespace stickslip::model
