#pragma once
/// What an operator is of: the part that plans and reports need, independent of the scalar type.

#include <algorithm>
#include <cmath>
#include <concepts>
#include <optional>
#include <tuple>
#include <vector>

#include "stickslip/base/text.hpp"
#include "stickslip/model/process.hpp"

namespace stickslip::generator {

/// Functions under (x, y, v) -> (-x, -y, -v): even or odd, for which the velocity branch y = +1 is
/// enough ("symmetry-reduced"), or of no symmetry, for which both branches are kept.
enum class Symmetry { even, odd, none };

/// The symmetry of densities and constants: even where the process is symmetric.
[[nodiscard]] inline Symmetry symmetry_of(const model::Process& process) {
  return process.symmetric() ? Symmetry::even : Symmetry::none;
}

/// The symmetries into which all functions fall apart.
[[nodiscard]] inline std::vector<Symmetry> sectors_of(const model::Process& process) {
  if (process.symmetric()) return {Symmetry::even, Symmetry::odd};
  return {Symmetry::none};
}

/// The velocity branches v > 0 and v < 0.
enum class Branch { positive, negative };
[[nodiscard]] inline Branch opposite(Branch branch) {
  return branch == Branch::positive ? Branch::negative : Branch::positive;
}

/// The part of the static states in an operator.
enum class StaticPhase {
  killing,         ///< no unknowns: the process is killed on reaching them, A_us is kept apart
  kept,            ///< unknowns like all others: the whole process
  killed_on_exit,  ///< unknowns; the process is killed on leaving them (L' of Prop. 3.1)
  /// Unknowns, but killed on reaching one from which the noise can leave them: (x_+-k, 0, 0) where
  /// it jumps to neighbours (R-check of Prop. 4.1).
  killing_edges
};

/// What lambda is per unit of: with the path length for a clock the process runs at the speed |v|,
/// and lambda - L becomes lambda |v| - L.
enum class Clock { time, path_length };

/// The rate of a clock at a speed.
[[nodiscard]] inline double rate_of(Clock clock, double speed) {
  return clock == Clock::time ? 1 : speed;
}

/// What is added to -L at a velocity v: lambda + path |v| - tilt v. The largest eigenvalue of
/// L + tilt v is the rate at which E[exp(tilt x(t))] grows, x the displacement.
template <class Scalar>
struct Shift {
  Scalar lambda = 0;  ///< [1/time]
  Scalar path = 0;    ///< [1/(velocity time)], as tilt
  Scalar tilt = 0;
  /// Velocities beyond which the tilt does not go on to grow, where no body gets.
  double lowest = -kInfinity, highest = kInfinity;
  Shift() = default;
  Shift(Scalar by_time, Scalar by_path, Scalar by_tilt)
      : lambda(by_time), path(by_path), tilt(by_tilt) {}
  // NOLINTNEXTLINE(google-explicit-constructor): a number is a lambda
  Shift(std::convertible_to<Scalar> auto by, Clock clock = Clock::time)
      : lambda(clock == Clock::time ? Scalar(by) : Scalar(0)),
        path(clock == Clock::time ? Scalar(0) : Scalar(by)) {}
  template <std::convertible_to<Scalar> Other>
  // NOLINTNEXTLINE(google-explicit-constructor): a real one is a complex one
  Shift(const Shift<Other>& other)
      : lambda(other.lambda),
        path(other.path),
        tilt(other.tilt),
        lowest(other.lowest),
        highest(other.highest) {}

  [[nodiscard]] Scalar at(double v) const {
    return lambda + path * std::abs(v) - tilt * std::clamp(v, lowest, highest);
  }
  /// By the speeds of a branch.
  [[nodiscard]] Shift along(Branch branch) const {
    Shift turned = *this;
    if (branch == Branch::positive) return turned;
    turned.tilt = -tilt;
    turned.lowest = -highest;
    turned.highest = -lowest;
    return turned;
  }
};

/// lambda - L on functions of one symmetry, killed where |v| reaches a limit; with a tilt, of none.
/// With a passage those alone are killed, and elements go on beyond the limit.
struct SystemKey {
  double lambda = 0;
  Symmetry symmetry = Symmetry::even;
  StaticPhase static_phase = StaticPhase::killing;
  Clock clock = Clock::time;
  double speed_limit = kInfinity;
  double tilt = 0;  ///< [1/(velocity time)]
  std::optional<model::Passage> passage = {};
  double lowest = -kInfinity, highest = kInfinity;  ///< velocities up to which the tilt grows

  [[nodiscard]] Shift<double> shift() const {
    Shift<double> all(lambda, clock);
    all.tilt = tilt;
    all.lowest = lowest;
    all.highest = highest;
    return all;
  }
  friend bool operator<(const SystemKey& a, const SystemKey& b) {
    return std::tie(a.lambda, a.symmetry, a.static_phase, a.clock, a.speed_limit, a.tilt, a.passage,
                    a.lowest, a.highest) < std::tie(b.lambda, b.symmetry, b.static_phase, b.clock,
                                                    b.speed_limit, b.tilt, b.passage, b.lowest,
                                                    b.highest);
  }
  friend bool operator==(const SystemKey&, const SystemKey&) = default;
};

}  // namespace stickslip::generator
