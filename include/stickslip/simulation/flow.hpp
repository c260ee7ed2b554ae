#pragma once
/// Motion between two jumps of the noise: u' = force + b(u) for the speed u = |V| >= 0.

#include <boost/math/tools/toms748_solve.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "stickslip/base/text.hpp"
#include "stickslip/model/drag.hpp"

namespace stickslip::simulation {

// When a body gets as fast as wanted, in a piece of its motion.

/// The time at which |v| reaches `to` from `speed` below it within `time`; infinite where it does
/// not. The speed rises or falls all along a piece.
template <class Flow>
[[nodiscard]] double rise_time(const Flow& flow, double speed, double force, double time,
                               double to) {
  const auto above = [&](double t) { return flow.move(speed, force, t, false).end - to; };
  if (!(above(time) >= 0)) return kInfinity;
  std::uintmax_t most = 60;
  return boost::math::tools::toms748_solve(above, 0.0, time,
                                           boost::math::tools::eps_tolerance<double>(40), most)
      .second;
}

// Drag as a piecewise polynomial, which costs the same whatever the drag law.

constexpr std::size_t kDragTerms = 8;

/// A polynomial in u - centre that stands for b(u) on [low, high], and a little beyond.
struct DragPanel {
  double low, high;  ///< no other panel has speeds between them
  double from, to;   ///< how far it is right
  double centre;
  std::array<double, kDragTerms> coefficient;  ///< of rising powers
};

/// b(u) for u >= 0. The built-in laws are one panel. Of any other, Chebyshev interpolants on panels
/// that are halved until they agree with it to 2e-14 of its size or to its own rounding, and where
/// they can be by a quarter longer on each side; kinks are found by bisection and end panels.
/// Panels depend on the law alone, and are made as speeds come to need them. Local.
class DragTable {
 public:
  explicit DragTable(const model::Drag& drag);

  /// The panel with low <= speed < high.
  [[nodiscard]] const DragPanel& at(double speed);

 private:
  [[nodiscard]] DragPanel interpolant(double low, double high, double overlap) const;
  [[nodiscard]] double relative_error(const DragPanel& panel) const;
  [[nodiscard]] bool holds(const DragPanel& panel) const;
  [[nodiscard]] double rough_place(double low, double high) const;
  void add(double low, double high, int depth, double error_of_whole);

  model::Drag drag_;
  std::vector<DragPanel> panel_;  // in rising order without gaps
  std::size_t last_ = 0;
  double floor_ = 0;  // of the size to which errors relate
};

/// A piece of a sliding phase at constant force: over `time`, from one speed to `end`.
struct Piece {
  double time = 0;
  double end = 0;        ///< speed at the end; 0 where the body came to rest
  double path = 0;       ///< int u dt
  double square = 0;     ///< int u^2 dt
  bool stopped = false;  ///< whether u reached 0 before the time was over
};

namespace detail {

// Below it the series are right to 1e-11, and cheaper than an exponential.
constexpr double kSeries = 0.02;

// sum (-z)^n coefficient_n
template <std::size_t terms>
[[nodiscard]] double series(double z, const double (&coefficient)[terms]) {
  double sum = 0;
  for (std::size_t n = terms; n-- > 0;) sum = coefficient[n] - z * sum;
  return sum;
}

/// (1 - exp(-z))/z.
[[nodiscard]] inline double phi_one(double z) {
  if (z >= kSeries) return (1 - std::exp(-z)) / z;
  return series(z, {1, 1.0 / 2, 1.0 / 6, 1.0 / 24, 1.0 / 120});
}

/// (1 - phi_one)/z.
[[nodiscard]] inline double phi_two(double z, double one) {
  if (z >= kSeries) return (1 - one) / z;
  return series(z, {1.0 / 2, 1.0 / 6, 1.0 / 24, 1.0 / 120, 1.0 / 720});
}

/// int_0^1 ((1 - exp(-z s))/z)^2 ds.
[[nodiscard]] inline double mean_square(double z, double one) {
  if (z >= kSeries) return (1 - one - z * one * one / 2) / (z * z);
  return series(z, {1.0 / 3, 1.0 / 4, 7.0 / 60, 1.0 / 24, 31.0 / 2520});
}

}  // namespace detail

/// Closed forms for b(u) = -c u, c >= 0, to 1e-11: nothing beside the spread of any sample. Local.
class LinearFlow {
 public:
  explicit LinearFlow(const model::Drag& drag) : c_(drag.linear) {}

  /// Moves for `time`, or until the body stops. `integrals`: whether path and square are wanted.
  [[nodiscard]] Piece move(double speed, double force, double time, bool integrals) const;

  /// int_0^time u(s) exp(-i omega s) ds over a piece, for each omega.
  void transform(double speed, double force, const Piece& piece, const std::vector<double>& omega,
                 std::vector<std::complex<double>>& result) const;

 private:
  double c_;
};

// The innermost step of every simulation: a call would cost a tenth of its time.
[[gnu::always_inline]] inline Piece LinearFlow::move(double speed, double force, double time,
                                                     bool integrals) const {
  Piece piece;
  double one = detail::phi_one(c_ * time);
  piece.time = time;
  piece.end = speed + time * one * (force - c_ * speed);
  if (piece.end <= 0) {
    piece.end = 0;
    piece.stopped = force < 0;  // else the rest of the speed is below rounding
  }
  if (piece.stopped) {
    const double stop = c_ > 0 ? std::log1p(-c_ * speed / force) / c_ : -speed / force;
    piece.time = std::min(time, stop);
    one = detail::phi_one(c_ * piece.time);
  }
  if (!integrals) return piece;
  const double t = piece.time, z = c_ * t, gain = force * t;
  piece.path = t * (speed * one + gain * detail::phi_two(z, one));
  piece.square = t * (speed * speed * one * (1 - z * one / 2) +
                      gain * (speed * one * one + gain * detail::mean_square(z, one)));
  return piece;
}

/// Any other drag: Taylor series of order 6 or 8 in time, from piecewise polynomials for b, whose
/// last terms are below 1e-11 of the speed; where the speed vanishes or b has another polynomial, a
/// step ends. Not to be shared by threads.
class GeneralFlow {
 public:
  explicit GeneralFlow(const model::Drag& drag) : drag_(drag), table_(drag) {}

  /// As LinearFlow::move.
  [[nodiscard]] Piece move(double speed, double force, double time, bool integrals) const;
  /// As LinearFlow::transform.
  void transform(double speed, double force, const Piece& piece, const std::vector<double>& omega,
                 std::vector<std::complex<double>>& result) const;

 private:
  model::Drag drag_;
  mutable DragTable table_;  // grows with the speeds that occur
};

}  // namespace stickslip::simulation
