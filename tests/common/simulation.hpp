#pragma once
/// The process itself, event by event: nothing of the library but the numbers that define it.

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

namespace stickslip::test {

/// dV/dt = X - c V - mu_d Y while Y = sign V is +-1; V = 0 and |X| <= mu_s is rest. X jumps at the
/// rate Lambda = 2/(tau delta)^2 from i delta up with probability (1 - tau delta^2 i/2)/2, else
/// down.
struct SimulatedProcess {
  double mu_s = 1, mu_d = 1, tau = 1, delta = 0.5;
  double drag = 1;   ///< c; 0 for none
  double hurry = 1;  ///< factor of the jump rate, for wrong distributions
};

/// Durations of excursions from s+-, each a sliding and a sticking phase, and what happens on the
/// way.
struct Excursions {
  std::vector<double> slide, stick, excursion;
  std::vector<double> square_of_jumps;  ///< sum of the squared jumps of the acceleration
};

/// Paths between events in closed form; the same numbers at every run.
class Simulation {
 public:
  Simulation(const SimulatedProcess& process, std::uint64_t seed)
      : p_(process),
        random_(seed),
        rate_(process.hurry * 2 / (process.tau * process.tau * process.delta * process.delta)),
        k_(static_cast<int>(std::floor(process.mu_s / process.delta + 1e-9))),
        i_(k_ + 1) {}

  [[nodiscard]] Excursions run(int count) {
    Excursions all;
    for (int n = 0; n < count; ++n) {
      jumps_ = 0;
      const double slide = slide_on();
      const double stick = sticking();
      all.slide.push_back(slide);
      all.stick.push_back(stick);
      all.excursion.push_back(slide + stick);
      all.square_of_jumps.push_back(jumps_);
    }
    return all;
  }

 private:
  // From s+- until rest.
  double slide_on() {
    int y = i_ > 0 ? 1 : -1;
    double v = 0, time = 0;
    count_jump(force(y));
    for (;;) {
      const double jump = waiting_time(), stop = time_to_stop(v, force(y));
      if (jump < stop) {
        v = velocity_after(v, force(y), jump);
        time += jump;
        move();
        count_jump(p_.delta);
        continue;
      }
      // The noise has no memory of how long it has waited.
      time += stop;
      v = 0;
      if (std::abs(i_) <= k_) {
        count_jump(force(y));
        return time;
      }
      y = -y;
      count_jump(2 * p_.mu_d);
    }
  }

  // Until |X| > mu_s.
  double sticking() {
    double time = 0;
    while (std::abs(i_) <= k_) {
      time += waiting_time();
      move();
    }
    return time;
  }

  [[nodiscard]] double force(int y) const { return i_ * p_.delta - p_.mu_d * y; }

  // Until v(t) = 0; infinity when it never is.
  [[nodiscard]] double time_to_stop(double v, double force) const {
    constexpr double never = std::numeric_limits<double>::infinity();
    if (v == 0 || force == 0 || (force > 0) == (v > 0)) return never;
    if (p_.drag == 0) return -v / force;
    return std::log1p(-p_.drag * v / force) / p_.drag;
  }
  [[nodiscard]] double velocity_after(double v, double force, double time) const {
    if (p_.drag == 0) return v + force * time;
    return v - std::expm1(-p_.drag * time) * (force / p_.drag - v);
  }

  void move() {
    const double up = (1 - p_.tau * p_.delta * p_.delta * i_ / 2) / 2;
    i_ += uniform() < up ? 1 : -1;
  }
  [[nodiscard]] double waiting_time() { return -std::log1p(-uniform()) / rate_; }
  // In [0, 1), the same on every platform.
  [[nodiscard]] double uniform() { return static_cast<double>(random_() >> 11) * 0x1p-53; }
  void count_jump(double size) { jumps_ += size * size; }

  SimulatedProcess p_;
  std::mt19937_64 random_;
  double rate_;
  int k_, i_;
  double jumps_ = 0;
};

}  // namespace stickslip::test
