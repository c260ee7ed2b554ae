#pragma once
/// Which passages of a speed count.

namespace stickslip::model {

/// Of w > 0: |V| reaches w, V rises to w, or V falls to -w.
enum class Passage { both, up, down };

/// Whether a body at the velocity v is beyond w.
[[nodiscard]] inline bool has_passed(Passage passage, double v, double w) {
  return (v >= w && passage != Passage::down) || (-v >= w && passage != Passage::up);
}

}  // namespace stickslip::model
