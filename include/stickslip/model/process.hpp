#pragma once
/// The piecewise deterministic Markov process (X, Y, V) with everything that fixes its
/// distribution.

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "stickslip/model/drag.hpp"
#include "stickslip/model/gaussian.hpp"
#include "stickslip/model/noise_chain.hpp"
#include "stickslip/model/spring.hpp"

namespace stickslip::model {

// Which passages of a speed count.

/// Of w > 0: |V| reaches w, V rises to w, or V falls to -w.
enum class Passage { both, up, down };

/// Whether a body at the velocity v is beyond w.
[[nodiscard]] inline bool has_passed(Passage passage, double v, double w) {
  return (v >= w && passage != Passage::down) || (-v >= w && passage != Passage::up);
}

/// dV/dt = X + g + b(V) - F(|V|) Y while Y = sign V is +-1; V = 0 and -mu_s- <= X + g <= mu_s is
/// the static phase. F is mu_d, or friction that weakens with the speed; on v < 0 that of mu_s-,
/// mu_d-.
struct Process {
  NoiseChain noise;
  Friction friction;
  Drag drag;        ///< with what friction loses to the speed: b(v) + F(0+) - F(v) on v > 0
  double bias = 0;  ///< g, a constant force
  /// K of a spring, where the motion itself is followed; nodes of a projection stand for positions
  /// by themselves, and then it is 0.
  double stiffness = 0;

  /// Whether (-X, -Y, -V) has another distribution, so that E[V] need not be 0.
  [[nodiscard]] bool drifts() const {
    return bias != 0 || !drag.odd() || !friction.symmetric() || !noise.even();
  }
  /// Whether it has the same one, level -i for level i.
  [[nodiscard]] bool symmetric() const { return !drifts() && noise.symmetric(); }
  /// The process (-X, -Y, -V): what holds for sliding upwards here holds for sliding downwards
  /// there.
  [[nodiscard]] Process mirrored() const {
    return {noise.mirrored(), friction.mirrored(), drag.mirrored(), -bias, stiffness};
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
  /// Whether noise of continuous paths lets bodies slide where friction balances it: each that
  /// starts comes to rest infinitely often at once, so that slides cannot be counted, and mean
  /// durations are 0.
  [[nodiscard]] bool starts_at_balance() const {
    const auto at_once = [](const Friction& f) { return f.at_rest() == f.mu_s; };
    return noise.continuous() && (at_once(friction) || at_once(friction.mirrored()));
  }
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

// Parameters of the process by which its operators can be differentiated.

/// The friction on one velocity branch, seen with v > 0, and which coefficients belong to this
/// branch alone, as those towards negative v do where they are given.
struct BranchFriction {
  Friction friction;
  bool own_mu_s = false, own_mu_d = false;
};

/// How the nodes of a projection change with a parameter, by place: their forces, and the rates
/// between them, to places.
struct NodeChange {
  std::vector<double> x;
  std::vector<std::vector<LevelTable::Jump>> rates;
};

/// A parameter, and how the acceleration changes with it.
struct Derivative {
  std::string_view option;  ///< that sets the parameter
  /// d(dv/dt)/d(parameter) on a branch at the speed v > 0. Where there is no such function, the
  /// parameter is the correlation time of the noise, at a fixed number of levels, and changes the
  /// jumps.
  double (*acceleration)(const BranchFriction& branch, double v) = nullptr;
  std::shared_ptr<const NodeChange> nodes = {};  ///< besides; null where there are no nodes

  [[nodiscard]] bool is_of_jumps() const { return acceleration == nullptr; }
};

// Where the process is at time 0.

/// A state, or a distribution over states.
struct Start {
  enum class Kind {
    state,  ///< (x_level, v); v = 0 is rest on the static levels, and s+, s- or beyond otherwise
    rest,   ///< X in its stationary distribution, V = 0, at the position p of a spring
    stationary  ///< the whole process in its stationary distribution
  };
  int level = 0;
  double v = 0;
  Kind kind = Kind::state;
  /// On a spring, where x takes the place of the level.
  std::optional<double> p = {};
  double x = 0;
};

/// The shares of levels, from the lowest up, in the value of a function of x at the start, which is
/// not stationary. With a position, under which levels are nodes, none beyond the positions.
[[nodiscard]] std::vector<double> levels_at(const NoiseChain& noise, const Start& start);

/// Whether (-X, -Y, -V) has the distribution of (X, Y, V) at all times from this start, so that
/// means of odd functions, and of the displacement, are exactly 0.
[[nodiscard]] inline bool mirrors_itself(const Process& process, const Start& start) {
  return !process.drifts() && start.kind != Start::Kind::state && !start.p;
}

// Levels of a noise that have one force: jumps between them move no body otherwise.

/// The rates at which levels with the force of level i are left for other forces [1/time]; infinite
/// where paths are continuous.
struct ChangeRates {
  double least, most;
};
[[nodiscard]] ChangeRates change_rates(const NoiseChain& chain, int i);

/// Of a noise that starts on level i: P(on that level, and the force has not changed), for all
/// levels of its force from the lowest up. O(n^3) for n of them.
struct Unchanged {
  int lowest = 0;
  std::vector<double> probability = {};
};
[[nodiscard]] Unchanged unchanged(const NoiseChain& chain, int i, double time);

// A force given over time.

/// Samples of a force, at least two, at rising times. Between two of them it is linear, or keeps
/// the value of the first.
struct ForceRecord {
  std::vector<double> time = {}, force = {};  ///< [time], [force]
  bool constant = false;
  std::string file = {};  ///< from which it was read
  double scale = 1;       ///< by which the values of the file have been multiplied
  double step = 0;        ///< [time], of a file of rows of samples
  double rest = 0;        ///< [time] without force behind the last sample of the file
  /// Normal force over the weight, by which all friction is multiplied: 1 + a/g under a vertical
  /// acceleration a of the ground. Empty where it is 1.
  std::vector<double> load = {};
  double gravity = 0;     ///< g; 0 where load is empty
  std::string unit = {};  ///< of the force, m/s^2; empty where it is the user's

  [[nodiscard]] double load_at(std::size_t n) const { return load.empty() ? 1 : load[n]; }
  /// The first sample of the largest |force|.
  [[nodiscard]] std::size_t peak() const {
    const auto smaller = [](double a, double b) { return std::abs(a) < std::abs(b); };
    return static_cast<std::size_t>(std::ranges::max_element(force, smaller) - force.begin());
  }
};

// The model parameters: what the user fixes about the process. The noise range and the truncation
// velocity may stay open.

/// Values by the names of their options.
using Parameters = std::vector<std::pair<std::string, std::variant<double, std::string>>>;

/// The noise as the user gave it: word of -noise, and what belongs to it.
struct NoiseChoice {
  std::string name = "ou";                       ///< empty where nothing asks for noise
  std::optional<double> deviation = {};          ///< of "ou", if it has its own [force]
  std::shared_ptr<const LevelTable> table = {};  ///< the levels of all but "ou"
  /// A noise of continuous paths, of which `table` is a projection for the friction of its scene.
  std::shared_ptr<const GaussianNoise> gaussian = {};
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
  Parameters own = {};   ///< values of its noise or laws that have no place above
  double bias = 0;       ///< constant force g
  double stiffness = 0;  ///< K of a spring that ties the body to p = 0
  /// The body on that spring where noise drives it; takes the bias.
  std::shared_ptr<const Spring> spring = {};
  std::shared_ptr<const ForceRecord> force = {};  ///< a given one, beside the noise or without it
  std::optional<int> noise_levels;                ///< N, if fixed by the user
  std::optional<double> v_max;                    ///< truncation velocity, if fixed by the user
  bool limits_speed = false;                      ///< v_max is part of the model: no body is faster

  [[nodiscard]] bool symmetric() const { return process(1).symmetric(); }
  /// The order of projections where none is chosen by an accuracy.
  static constexpr int kMeantOrder = 5;
  /// What is solved on nodes in the place of levels; null where there is nothing of that kind.
  [[nodiscard]] const Projector* projector() const {
    return spring ? static_cast<const Projector*>(spring.get()) : noise.gaussian.get();
  }
  /// Whether a body on a spring has few enough pairs of a force and a position to be solved for.
  [[nodiscard]] bool solvable() const { return !spring || spring->fits(thresholds(), kMeantOrder); }
  /// The range that is meant when noise_levels is open: full_range(), or that of the table.
  [[nodiscard]] int full_levels() const {
    if (projector() != nullptr) return solvable() ? kMeantOrder : 2;
    return noise.table ? std::max(-noise.table->lowest(), noise.table->highest())
                       : full_range(tau, delta, noise.deviation);
  }
  /// The process on the noise levels |i| <= levels and those next to rest; of a noise of continuous
  /// paths on the nodes of the order `levels`.
  [[nodiscard]] Process process(int levels) const {
    Process all{{tau, delta, levels, noise.deviation, noise.table},
                friction,
                with_weakening(drag, friction),
                spring ? 0 : bias};
    if (projector() != nullptr) {
      all.noise.gaussian = noise.gaussian;
      all.noise.table = projector()->projected(thresholds(), std::max(levels, 2));
    } else if (noise.table && levels < full_levels()) {
      all.noise.table = std::make_shared<const LevelTable>(noise.table->within(
          std::min(-levels, all.lowest_static() - 1), std::max(levels, all.highest_static() + 1)));
    }
    return all;
  }
  /// The process whose motion is followed, by simulation or under a given force: that which is
  /// meant, with the levels of the noise and the spring itself.
  [[nodiscard]] Process followed() const {
    const bool by_levels = spring && spring->chain() != nullptr;
    Process all =
        by_levels ? Process{*spring->chain(), friction, with_weakening(drag, friction)} : meant();
    all.bias = bias;
    all.stiffness = stiffness;
    return all;
  }
  [[nodiscard]] Thresholds thresholds() const {
    const Friction other = friction.mirrored();
    const double constant = spring ? 0 : bias;
    return {{-other.mu_s - constant, friction.mu_s - constant},
            {-other.at_rest() - constant, friction.at_rest() - constant}};
  }
  /// The process that is meant: on noise_levels if fixed, else on the full range.
  [[nodiscard]] Process meant() const {
    return process(spring ? full_levels() : noise_levels.value_or(full_levels()));
  }
};

// Static friction as it acts on noise levels that are delta apart.

/// The largest force X + g that holds a body at rest [force]: x_k + g with the highest level
/// x_k <= mu_s - g; `backwards`: the same against motion towards negative v, of mu_s_minus. All
/// mu_s from x_k + g up to x_k + g + delta act alike. Nothing where it is the coefficient given,
/// and where the levels are given by themselves (telegraph, file).
[[nodiscard]] std::optional<double> effective_mu_s(const Scene& scene, bool backwards);

// The largest force of a scene.

/// The largest force on a body that slides [force]: X passes mu_s by 12 standard deviations with
/// probability e^-72. A given force counts as well.
[[nodiscard]] double largest_force(const Scene& scene);

}  // namespace stickslip::model
