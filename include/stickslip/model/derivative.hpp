#pragma once
/// Parameters of the process by which its operators can be differentiated.

#include <string_view>

#include "stickslip/model/friction.hpp"

namespace stickslip::model {

/// The friction on one velocity branch, seen with v > 0, and which coefficients belong to this
/// branch alone, as those towards negative v do where they are given.
struct BranchFriction {
  Friction friction;
  bool own_mu_s = false, own_mu_d = false;
};

/// A parameter, and how the acceleration changes with it.
struct Derivative {
  std::string_view option;  ///< that sets the parameter
  /// d(dv/dt)/d(parameter) on a branch at the speed v > 0. Where there is no such function, the
  /// parameter is the correlation time of the noise, at a fixed number of levels, and changes the
  /// jumps.
  double (*acceleration)(const BranchFriction& branch, double v) = nullptr;

  [[nodiscard]] bool is_of_jumps() const { return acceleration == nullptr; }
};

}  // namespace stickslip::model
