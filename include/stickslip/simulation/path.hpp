#pragma once
/// Simulated paths, event by event.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "stickslip/model/passage.hpp"
#include "stickslip/model/process.hpp"
#include "stickslip/model/start.hpp"
#include "stickslip/simulation/random_stream.hpp"

namespace stickslip::simulation {

/// The process at some time; y = sign of the motion, 0 at rest; displacement since the beginning.
struct State {
  double time = 0, x = 0, y = 0, v = 0, displacement = 0;
};

/// A path and its states at some times. A stationary one begins at a uniformly distributed time of
/// an excursion from one side, or of a cycle, and weighs as much as that lasts. The others have
/// side 0 and weight 1.
struct FollowedPath {
  State first = {};
  std::span<const State> states = {};
  bool stationary = false;
  std::size_t side = 0;
  bool turned = false;  ///< whether that excursion is followed by one from the other side
  double weight = 1;
  std::span<const double> passages = {};  ///< when the wanted ones happen
};

/// A path of the process, followed event by event. Between events X and Y stay and V follows the
/// flow. Local.
class Walk {
 public:
  virtual ~Walk() = default;
  /// Begins at time 0 with the numbers of `random`, in a state or with the noise at rest. At v = 0
  /// a body on static levels rests.
  virtual void begin(const RandomStream& random, const model::Start& start) = 0;
  /// On to the next event, a jump of the noise or a body that comes to rest or is turned round, at
  /// most to the time `limit`.
  virtual void step(double limit) = 0;
  /// When the speed is passed before the next event: now if it has been, never if it is not.
  [[nodiscard]] virtual double passes(model::Passage passage, double speed) const = 0;
  [[nodiscard]] virtual State state() const = 0;
  [[nodiscard]] virtual double jumps() const = 0;  ///< of the noise since the beginning
  [[nodiscard]] virtual int level() const = 0;     ///< of the noise

  /// On to a time that is not past.
  State advance(double time);
  /// On to the end of the excursion, where a body at rest is pushed. The time.
  double end_excursion();
};

[[nodiscard]] std::unique_ptr<Walk> make_walk(const model::Process& process, bool travel = false);

/// Draws levels of the noise from its stationary distribution. Local.
class NoiseLevels {
 public:
  explicit NoiseLevels(const model::NoiseChain& noise);
  [[nodiscard]] int draw(double uniform) const;

 private:
  int lowest_;
  std::vector<double> below_;  // probability of a level and all below
};

/// A path: the state at time 0, just after every event, and at the end.
struct Path {
  std::vector<double> time, x, y, v;
};

/// The path from `start` up to `horizon` [time]. A stationary one starts at a uniformly distributed
/// time within 1000 excursions after s+, which is stationary but for about a thousandth. Local.
/// O(horizon/Lambda) memory.
[[nodiscard]] Path simulate_path(const model::Process& process, const model::Start& start,
                                 double horizon, std::uint64_t seed);

}  // namespace stickslip::simulation
