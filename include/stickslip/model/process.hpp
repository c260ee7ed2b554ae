#pragma once
/// The piecewise deterministic Markov process (X, Y, V) with everything that fixes its
/// distribution.

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "stickslip/model/drag.hpp"
#include "stickslip/model/friction.hpp"
#include "stickslip/model/noise_chain.hpp"

namespace stickslip::model {

/// dV/dt = X + g + b(V) - F(|V|) Y while Y = sign V is +-1; V = 0 and -mu_s- <= X + g <= mu_s is
/// the static phase. F is mu_d, or friction that weakens with the speed; on v < 0 that of mu_s-,
/// mu_d-.
struct Process {
  NoiseChain noise;
  Friction friction;
  Drag drag;        ///< with what friction loses to the speed: b(v) + F(0+) - F(v) on v > 0
  double bias = 0;  ///< g, a constant force

  /// Whether (-X, -Y, -V) has another distribution, so that E[V] need not be 0.
  [[nodiscard]] bool drifts() const {
    return bias != 0 || !drag.odd() || !friction.symmetric() || !noise.even();
  }
  /// Whether it has the same one, level -i for level i.
  [[nodiscard]] bool symmetric() const { return !drifts() && noise.symmetric(); }
  /// The process (-X, -Y, -V): what holds for sliding upwards here holds for sliding downwards
  /// there.
  [[nodiscard]] Process mirrored() const {
    return {noise.mirrored(), friction.mirrored(), drag.mirrored(), -bias};
  }

  /// The highest level that can stick; k with symmetry, where the levels |i| <= k stick.
  [[nodiscard]] int highest_static() const {
    return balances(noise.lowest(), friction, 1) ? noise.lowest() - 1
                                                 : noise.last_up_to(friction.mu_s - bias);
  }
  /// The lowest level that can stick; -k with symmetry.
  [[nodiscard]] int lowest_static() const {
    return balances(noise.highest(), friction.mirrored(), -1)
               ? noise.highest() + 1
               : noise.first_from(-friction.mirrored().mu_s - bias);
  }
  /// Whether bodies at rest start upwards: there is a level s+ beyond those that stick, and of the
  /// jumps by which the noise leaves these, more than one in 1e18 leads there. Otherwise all
  /// excursions start downwards. O(levels that stick).
  [[nodiscard]] bool starts_upwards() const;
  [[nodiscard]] bool starts_downwards() const { return mirrored().starts_upwards(); }
  /// The level from which excursions to one side start, of several the most frequent one; if they
  /// start on the other side alone, its.
  [[nodiscard]] int exit_level(bool upwards) const {
    const bool there = upwards ? starts_upwards() : starts_downwards();
    const bool up = upwards == there;
    if (!noise.neighbours_only()) return most_frequent_start(up);
    return up ? highest_static() + 1 : lowest_static() - 1;
  }
  /// All levels from which excursions start, rising: those that do not stick and to which more than
  /// one in 1e18 of the jumps from those that do lead; none where bodies never stick. O(levels that
  /// stick) where the noise jumps to neighbours, else O(levels).
  [[nodiscard]] std::vector<int> starts() const;
  /// The rates of such jumps in the stationary process X, by level [1/time]. O(levels).
  [[nodiscard]] std::map<int, double> flows_to_starts() const;
  /// By level that sticks, from the lowest up: the rate of jumps to those that do not [1/time].
  [[nodiscard]] std::vector<double> exit_rates() const;
  /// Whether there are levels on which bodies stick. On none, v = 0 is passed and never held.
  [[nodiscard]] bool sticks() const { return lowest_static() <= highest_static(); }
  /// Whether bodies that slide upwards do so for ever, as friction exceeds the force on no level.
  [[nodiscard]] bool moves_on() const { return net_force(noise.lowest()) >= 0; }
  /// Whether bodies stick on level i.
  [[nodiscard]] bool sticks(int i) const { return lowest_static() <= i && i <= highest_static(); }
  /// g + E[X]: what drives bodies over long times.
  [[nodiscard]] double mean_force() const { return bias + noise.mean(); }
  /// x_i + g - F(0+): the speed of V at v = 0+ on level i.
  [[nodiscard]] double net_force(int i) const { return net_force_at(noise.level(i)); }
  /// The velocity to which upward motion tends on the highest level: no body is faster.
  [[nodiscard]] double terminal_velocity() const {
    return drag.terminal_velocity(net_force(noise.highest()));
  }
  /// That of the side on which it is larger.
  [[nodiscard]] double terminal_speed() const {
    return std::max(terminal_velocity(), mirrored().terminal_velocity());
  }
  /// x + g - F(0+) for any x.
  [[nodiscard]] double net_force_at(double x) const { return friction.net_force(x, bias); }

 private:
  // Whether the force on the outermost level of a direction equals friction, at rest and sliding
  // alike. Then bodies that slide that way come to rest on no level, and are never pushed the other
  // way: none sticks in the long run. The end of a truncated range is no such level.
  [[nodiscard]] bool balances(int level, const Friction& that_way, double sign) const {
    const double force = that_way.net_force(sign * noise.level(level), sign * bias);
    return force == 0 && that_way.at_rest() == that_way.mu_s &&
           (noise.table || noise.levels == full_range(noise.tau, noise.delta, noise.deviation));
  }
  [[nodiscard]] int most_frequent_start(bool up) const;
};

/// "; this should not happen: please report it with the model parameters mu_s = ...".
[[nodiscard]] std::string please_report(const Process& process);

}  // namespace stickslip::model
