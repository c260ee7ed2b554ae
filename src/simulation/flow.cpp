#include "stickslip/simulation/flow.hpp"

#include <algorithm>
#include <array>
#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/tools/roots.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>
#include <cmath>

namespace stickslip::simulation {

// With theta = omega t, phi = int_0^1 exp(-i theta s) ds and psi = int_0^1 s exp(-i theta s) ds,
//
//   (c + i omega) int u exp(-i omega s) ds
//       = i omega t (u(0) phi + force t psi) + c exp(-i theta) int u ds,
//
// where nothing cancels however small c and omega are.
void LinearFlow::transform(double speed, double force, const Piece& piece,
                           const std::vector<double>& omega,
                           std::vector<std::complex<double>>& result) const {
  const double t = piece.time;
  for (std::size_t n = 0; n < omega.size(); ++n) {
    if (omega[n] == 0) {
      result[n] = piece.path;
      continue;
    }
    const double half = omega[n] * t / 2, sine = std::sin(half), cosine = std::cos(half);
    const std::complex<double> turn(cosine, -sine);
    const double mean = half > 0 ? sine / half : 1;
    const double bend = half > 0.02 ? (mean - cosine) / half : half * (1 - half * half / 10) / 3;
    // phi = turn mean, psi = turn (mean - i bend)/2.
    const std::complex<double> moved(mean * (speed + force * t / 2), -force * t * bend / 2);
    const std::complex<double> pushed(omega[n] * t * turn * moved);
    result[n] =
        (std::complex<double>(-pushed.imag(), pushed.real()) + c_ * piece.path * turn * turn) /
        std::complex<double>(c_, omega[n]);
  }
}

namespace {

namespace odeint = boost::numeric::odeint;

using State = std::array<double, 3>;  // speed, path, square
using Stepper = odeint::runge_kutta_fehlberg78<State>;

constexpr double kTolerance = 1e-13;

/// Steps from state to state, cut where the body stops.
class Motion {
 public:
  Motion(const model::Drag& drag, double force, double speed)
      : drag_(drag), force_(force), state_{speed, 0, 0}, stopped_(speed <= 0 && force < 0) {}

  [[nodiscard]] const State& state() const { return state_; }
  [[nodiscard]] double time() const { return time_; }
  [[nodiscard]] bool stopped() const { return stopped_; }

  void advance(double end) {
    while (!stopped_ && time_ < end) step(end);
  }

 private:
  [[nodiscard]] auto rates() const {
    return [this](const State& s, State& rate, double) {
      rate = {force_ + drag_(s[0]), s[0], s[0] * s[0]};
    };
  }

  void step(double end) {
    const double room = end - time_;
    double h = step_ > 0 ? std::min(step_, room) : room;
    State next{}, error{};
    for (;;) {
      Stepper().do_step(rates(), state_, 0.0, next, h, error);
      double ratio = 1e-8;  // of the error to what is allowed; a step grows tenfold at most
      for (std::size_t n = 0; n < error.size(); ++n) {
        const double share = std::abs(error[n]) / (kTolerance * (1 + std::abs(next[n])));
        const bool overflows = !std::isfinite(share) || !std::isfinite(next[n]);
        ratio = std::max(ratio, overflows ? 1e8 : share);
      }
      step_ = 0.9 * h / std::pow(ratio, 1.0 / 8);
      if (ratio <= 1) break;
      h = step_;
    }
    const State before = state_;
    state_ = next;
    time_ = h == room ? end : time_ + h;
    if (state_[0] > 0) return;
    // Only a body that is pushed back stops; else the rest of the speed is below the tolerance.
    if (force_ < 0) return stop_after(before, h);
    state_[0] = 0;
  }

  // Stopped within the step of size h that was made last.
  void stop_after(const State& before, double h) {
    const auto after = [&](double t) {
      State s = before;
      Stepper().do_step(rates(), s, 0.0, t);
      return s;
    };
    std::uintmax_t iterations = 60;
    const auto root = boost::math::tools::toms748_solve(
        [&](double t) { return after(t)[0]; }, 0.0, h, before[0], state_[0],
        boost::math::tools::eps_tolerance<double>(50), iterations);
    state_ = after(root.first);
    time_ -= h - root.first;
    stopped_ = true;
  }

  const model::Drag& drag_;
  double force_, time_ = 0, step_ = 0;
  State state_;
  bool stopped_ = false;
};

}  // namespace

Piece GeneralFlow::move(double speed, double force, double time, bool) const {
  Motion motion(drag_, force, speed);
  motion.advance(time);
  const auto& [end, path, square] = motion.state();
  return {motion.time(), motion.stopped() ? 0 : end, path, square, motion.stopped()};
}

void GeneralFlow::transform(double speed, double force, const Piece& piece,
                            const std::vector<double>& omega,
                            std::vector<std::complex<double>>& result) const {
  using Rule = boost::math::quadrature::gauss<double, 10>;
  result.assign(omega.size(), 0.0);
  if (omega.empty()) return;
  const double highest = *std::max_element(omega.begin(), omega.end());
  // The drag bends u(t) as fast as waves do.
  const double decay = drag_.steepest(std::max(speed, piece.end));
  const int panels = 1 + static_cast<int>((highest + decay) * piece.time / 3);
  const double half = piece.time / (2 * panels);
  Motion motion(drag_, force, speed);
  for (int p = 0; p < panels; ++p) {
    for (int n = -5; n <= 5; ++n) {
      if (n == 0) continue;
      const auto at = static_cast<std::size_t>(std::abs(n) - 1);
      const double node = std::copysign(Rule::abscissa()[at], n);
      const double t = half * (2 * p + 1 + node);
      motion.advance(t);
      const double weighted = half * Rule::weights()[at] * motion.state()[0];
      for (std::size_t w = 0; w < omega.size(); ++w) {
        result[w] +=
            weighted * std::complex<double>(std::cos(omega[w] * t), -std::sin(omega[w] * t));
      }
    }
  }
}

}  // namespace stickslip::simulation
