#pragma once
/// A sliding block by itself, and forces that move it.

#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "stickslip/model/process.hpp"

namespace stickslip::test {

/// Samples of a function.
inline model::ForceRecord record(double step, int count,
                                 const std::function<double(double)>& force) {
  model::ForceRecord r;
  for (int n = 0; n <= count; ++n) {
    r.time.push_back(n * step);
    r.force.push_back(force(n * step));
  }
  return r;
}

/// A decaying sine, a pulse and a random walk.
inline std::vector<model::ForceRecord> records() {
  const auto decaying = [](double t) { return 3 * std::exp(-t / 6) * std::sin(2.1 * t + 0.3); };
  const auto ricker = [](double t) {
    const double s = std::pow((t - 4) / 0.9, 2);
    return 4 * (1 - 2 * s) * std::exp(-s);
  };
  std::mt19937_64 random(7);
  double walk = 0;
  const auto random_walk = [&](double) {
    walk = 0.97 * walk + 0.6 * (static_cast<double>(random() >> 11) * 0x1p-53 - 0.5);
    return 1.5 * walk;
  };
  return {record(0.05, 400, decaying), record(0.02, 500, ricker), record(0.01, 4000, random_walk)};
}

/// Newmark's sliding block on a plane: friction mu against either direction, a constant force g.
/// The velocity is a parabola between samples, the displacement a cubic. In long double.
class Block {
 public:
  Block(long double up, long double down, long double bias) : mu_{up, down}, bias_(bias) {}

  void follow(const model::ForceRecord& r, std::size_t n) {
    const long double h = static_cast<long double>(r.time[n + 1]) - r.time[n];
    const long double slope = (static_cast<long double>(r.force[n + 1]) - r.force[n]) / h;
    long double t = 0;
    while (t < h) {
      const long double force = r.force[n] + bias_ + slope * t;
      if (v == 0) {
        const long double start = t + wait(force, slope, h - t);
        if (start >= h) return;
        t = start;
        const long double at = r.force[n] + bias_ + slope * t;
        side_ = at > 0 ? 1 : -1;
        slide(side_ * at - mu_[side_ > 0 ? 0 : 1], side_ * slope, h, t);
        continue;
      }
      slide(side_ * force - mu_[side_ > 0 ? 0 : 1], side_ * slope, h, t);
    }
  }
  long double v = 0, x = 0;

 private:
  // Until the force leaves [-mu_down, mu_up].
  [[nodiscard]] long double wait(long double force, long double slope, long double room) const {
    if (force > mu_[0] || force < -mu_[1]) return 0;
    if (slope > 0) return (mu_[0] - force) / slope;
    if (slope < 0) return (-mu_[1] - force) / slope;
    return room;
  }
  // |v|' = a + s t, up to h or to the first zero of the parabola.
  void slide(long double a, long double s, long double h, long double& t) {
    const long double u = std::abs(v), room = h - t;
    long double stop = room;
    bool stops = false;
    // s/2 t^2 + a t + u = 0.
    const long double square = a * a - 2 * s * u;
    if (square >= 0) {
      const long double q = -(a + (a < 0 ? -1 : 1) * std::sqrt(square));
      for (long double root : {q / s, 2 * u / q}) {
        if (!(root > 0) || !(root < stop)) continue;
        if (u == 0 && a > 0 && s > 0) continue;
        stop = root;
        stops = true;
      }
    }
    const long double d = stop;
    x += side_ * d * (u + d * (a / 2 + s * d / 6));
    v = stops ? 0 : side_ * (u + d * (a + s * d / 2));
    t = stops ? t + d : h;
  }
  long double mu_[2], bias_;
  int side_ = 1;
};

}  // namespace stickslip::test
