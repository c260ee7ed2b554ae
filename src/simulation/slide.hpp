#pragma once
/// Slides of a body that may be tied to a spring.

#include <memory>
#include <optional>
#include <type_traits>

#include "stickslip/model/process.hpp"
#include "stickslip/simulation/flow.hpp"
#include "stickslip/simulation/walk.hpp"

namespace stickslip::simulation {

/// A piece of a sliding phase in which the speed may rise and fall, from q = 0 on, q' = u.
struct Slide : Piece {
  double peak = 0;                     ///< largest speed
  double place = 0, place_square = 0;  ///< int q dt, int q^2 dt
};

/// u' = force + slope t + b(u) - K q. Where drag is linear, speeds follow closed forms from one
/// extremum of the speed to the next, so that no stop is missed. Otherwise they follow Taylor
/// series of order 14, in steps of at most `stride` of the length at which these are right to
/// rounding. As a flow, without a slope, it takes the place of LinearFlow and GeneralFlow where K >
/// 0. Not to be shared by threads.
class Slider {
 public:
  /// Drag and stiffness are those of the process; force has lost its friction already.
  explicit Slider(const model::Process& process, double stride = 1);

  /// Moves for a time, or until the body stops. `integrals`: of u^2, q and q^2, to 1e-8.
  [[nodiscard]] Slide slide(double speed, double force, double slope, double time,
                            bool integrals = false) const;
  [[nodiscard]] Slide move(double speed, double force, double time, bool integrals) const {
    return slide(speed, force, 0, time, integrals);
  }

 private:
  template <class Step>
  void step(const Step& step, double force, double slope, double end, bool integrals,
            Slide& slide) const;
  template <class Step>
  static void integrate(const Step& step, double h, Slide& slide);

  double k_, c_ = 0, stride_;
  double negligible_;  ///< force that is 0 up to rounding
  mutable std::optional<DragTable> table_;
};

// Sources of excursions by the flow that they need.

/// Whether a spring holds the bodies of a flow.
template <class Flow>
constexpr bool kTied = std::is_same_v<Flow, Slider>;

template <class Flow>
[[nodiscard]] Flow flow_of(const model::Process& process) {
  if constexpr (kTied<Flow>) {
    return Flow(process);
  } else {
    return Flow(process.drag);
  }
}

template <template <class> class Made>
[[nodiscard]] std::unique_ptr<ExcursionSource> with_flow(const model::Process& process,
                                                         const Wanted& wanted) {
  if (process.stiffness > 0) return std::make_unique<Made<Slider>>(process, wanted);
  if (process.drag.is_linear()) return std::make_unique<Made<LinearFlow>>(process, wanted);
  return std::make_unique<Made<GeneralFlow>>(process, wanted);
}

/// Moves a body from p by a piece of its motion to either side, or of its rest, under the noise x.
inline void follow_position(Excursion& e, double& p, double x, int sign, const Slide& piece) {
  const double all = p * piece.time + sign * piece.place;
  e.place += all;
  e.place_square += p * (2 * all - p * piece.time) + piece.place_square;
  e.place_noise += x * all;
  p += sign * piece.path;
}

}  // namespace stickslip::simulation
