#pragma once
/// What the user fixes about the process; the noise range and the velocity cut may stay open.

#include <optional>
#include <string>

#include "stickslip/model/process.hpp"

namespace stickslip::model {

struct Scene {
  double tau = 1;        ///< noise correlation time [time]
  double delta = 0.125;  ///< noise step [force]
  Friction friction;     ///< mu_s, mu_d [force]
  std::string drag_name = "linear";
  std::string drag_expression;  ///< b(v) as text, of the law "expression"
  Drag drag;
  double bias = 0;                  ///< constant force g
  std::optional<int> noise_levels;  ///< N, if fixed by the user
  std::optional<double> v_max;      ///< velocity cut, if fixed by the user [velocity]

  [[nodiscard]] bool symmetric() const { return process(1).symmetric(); }
  /// floor(2/(tau delta^2)), the range that is meant when noise_levels is open.
  [[nodiscard]] int full_levels() const { return full_range(tau, delta); }
  /// The process on `levels` noise levels.
  [[nodiscard]] Process process(int levels) const {
    return {{tau, delta, levels}, friction, with_weakening(drag, friction), bias};
  }
  /// The process that is meant: on noise_levels if fixed, else on the full range.
  [[nodiscard]] Process meant() const { return process(noise_levels.value_or(full_levels())); }
};

}  // namespace stickslip::model
