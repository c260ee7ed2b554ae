#pragma once
/// What an operator is of: the part that plans and reports need, independent of the scalar type.

#include <tuple>
#include <vector>

#include "stickslip/model/process.hpp"
#include "stickslip/support/infinity.hpp"

namespace stickslip::operators {

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

/// lambda - L on functions of one symmetry, killed where |v| reaches a limit.
struct SystemKey {
  double lambda = 0;
  Symmetry symmetry = Symmetry::even;
  StaticPhase static_phase = StaticPhase::killing;
  Clock clock = Clock::time;
  double speed_limit = kInfinity;
  friend bool operator<(const SystemKey& a, const SystemKey& b) {
    return std::tie(a.lambda, a.symmetry, a.static_phase, a.clock, a.speed_limit) <
           std::tie(b.lambda, b.symmetry, b.static_phase, b.clock, b.speed_limit);
  }
  friend bool operator==(const SystemKey&, const SystemKey&) = default;
};

}  // namespace stickslip::operators
