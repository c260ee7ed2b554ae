#pragma once
/// Drag laws as users write them, and what is asked of them.

#include <stdexcept>
#include <string>

#include "stickslip/model/drag.hpp"
#include "stickslip/model/friction.hpp"

namespace stickslip::model {

/// A text that is no drag law: what() says why, fix() what to do.
class UnfitLaw : public std::invalid_argument {
 public:
  UnfitLaw(const std::string& why, std::string fix)
      : std::invalid_argument(why), fix_(std::move(fix)) {}
  [[nodiscard]] const std::string& fix() const { return fix_; }

 private:
  std::string fix_;
};

/// b(v) from an expression in v, mu_s, mu_d and tau, known to be sound on both sides: b(0) = 0,
/// finite and with bounded slopes on the velocities that can occur. They end at twice the terminal
/// velocity under `force`, or where the density is below exp(-51); a law that lets a body run away
/// has no such end. b is sampled there at 3000 places. `force` is the largest that occurs, with the
/// bias and less mu_d, `bias` the mean one, `intensity` that of the noise at large speeds. Throws
/// UnfitLaw.
[[nodiscard]] Drag parse_drag(const std::string& text, const Friction& friction, double tau,
                              double force, double bias = 0, double intensity = 1);

}  // namespace stickslip::model
