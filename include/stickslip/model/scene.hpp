#pragma once
/// The model parameters: what the user fixes about the process. The noise range and the truncation
/// velocity may stay open.

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "stickslip/model/force_record.hpp"
#include "stickslip/model/process.hpp"

namespace stickslip::model {

/// Values by the names of their options.
using Parameters = std::vector<std::pair<std::string, std::variant<double, std::string>>>;

/// The noise as the user gave it: word of -noise, and what belongs to it.
struct NoiseChoice {
  std::string name = "ou";                       ///< empty where nothing asks for noise
  std::optional<double> deviation = {};          ///< of "ou", if it has its own [force]
  std::shared_ptr<const LevelTable> table = {};  ///< the levels of all but "ou"
  /// The power spectral density of the process that the chain stands for, over omega, if it is
  /// known.
  std::function<double(double)> target = {};
};

struct Scene {
  double tau = 1;        ///< noise correlation time [time]
  double delta = 0.125;  ///< noise step [force]
  NoiseChoice noise;
  std::string friction_name = "coulomb";
  Friction friction;  ///< mu_s, mu_d [force]
  std::string drag_name = "linear";
  std::string drag_expression;  ///< b(v) as text, of the drag law "expression"
  Drag drag;
  Parameters own = {};  ///< values of its noise or laws that have no place above
  double bias = 0;      ///< constant force g
  std::shared_ptr<const ForceRecord> force = {};  ///< a given one, beside the noise or without it
  std::optional<int> noise_levels;                ///< N, if fixed by the user
  std::optional<double> v_max;                    ///< truncation velocity, if fixed by the user
  bool limits_speed = false;                      ///< v_max is part of the model: no body is faster

  [[nodiscard]] bool symmetric() const { return process(1).symmetric(); }
  /// The range that is meant when noise_levels is open: full_range(), or that of the table.
  [[nodiscard]] int full_levels() const {
    return noise.table ? std::max(-noise.table->lowest(), noise.table->highest())
                       : full_range(tau, delta, noise.deviation);
  }
  /// The process on the noise levels |i| <= levels and those next to rest.
  [[nodiscard]] Process process(int levels) const {
    Process all{{tau, delta, levels, noise.deviation, noise.table},
                friction,
                with_weakening(drag, friction),
                bias};
    if (noise.table && levels < full_levels()) {
      all.noise.table = std::make_shared<const LevelTable>(noise.table->within(
          std::min(-levels, all.lowest_static() - 1), std::max(levels, all.highest_static() + 1)));
    }
    return all;
  }
  /// The process that is meant: on noise_levels if fixed, else on the full range.
  [[nodiscard]] Process meant() const { return process(noise_levels.value_or(full_levels())); }
};

}  // namespace stickslip::model
