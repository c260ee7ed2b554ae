#include <cmath>
#include <numbers>

#include "../common/catch.hpp"
#include "../common/rigid_block.hpp"
#include "stickslip/simulation/response.hpp"

using namespace stickslip;
using model::ForceRecord;
using simulation::respond;
using simulation::Response;
using test::record;
using test::records;

namespace {

model::Process process(const model::Friction& friction, const model::Drag& drag, double bias = 0,
                       double stiffness = 0) {
  return {{1, 0.125, 1}, friction, model::with_weakening(drag, friction), bias, stiffness};
}

/// V' = X + g + b(V) - F(V) sign V in many small steps of order 4; bodies stop where V changes
/// sign.
struct Stepped {
  double v, x;
};
Stepped stepped(const ForceRecord& r, const model::Friction& friction, const model::Drag& drag) {
  constexpr int fine = 2000;
  Stepped s{0, 0};
  double y = 0;
  for (std::size_t n = 0; n + 1 < r.time.size(); ++n) {
    const double h = (r.time[n + 1] - r.time[n]) / fine;
    for (int k = 0; k < fine; ++k) {
      const auto force = [&](double t) {
        return r.force[n] + (r.force[n + 1] - r.force[n]) * (k + t) / fine;
      };
      if (y == 0 && std::abs(force(0.5)) > friction.mu_s) y = force(0.5) > 0 ? 1 : -1;
      if (y == 0) continue;
      const auto rate = [&](double t, double v) {
        return force(t) + drag(v) - y * friction(std::max(y * v, 0.0));
      };
      const double a = rate(0, s.v), b = rate(0.5, s.v + h / 2 * a), c = rate(0.5, s.v + h / 2 * b),
                   d = rate(1, s.v + h * c);
      s.x += h * s.v + h * h / 6 * (a + b + c);
      s.v += h / 6 * (a + 2 * b + 2 * c + d);
      if (y * s.v <= 0) s.v = y = 0;
    }
  }
  return s;
}

/// V' = X - K p + b(V) - F(V) sign V, p' = V, by Runge-Kutta steps of order 4 in long double, cut
/// by halving where V changes sign; and at rest until X - K p exceeds static friction. Errors fall
/// like the fourth power of the steps, of which `fine` fill an interval between samples.
class OnSpring {
 public:
  OnSpring(const model::Friction& friction, const model::Drag& drag, long double k)
      : friction_(friction), drag_(drag), k_(k) {}

  void follow(const ForceRecord& r, std::size_t n, int fine) {
    const long double length = static_cast<long double>(r.time[n + 1]) - r.time[n];
    slope_ = r.constant ? 0 : (static_cast<long double>(r.force[n + 1]) - r.force[n]) / length;
    first_ = r.force[n];
    for (long double t = 0; t < length;) {
      if (y_ == 0) {
        t += wait(t, length - t);
        if (t >= length) return;
      }
      t = slide(t, std::min(length / fine, length - t));
    }
  }

  long double v = 0, p = 0;

 private:
  struct State {
    long double v, p;
  };
  // At rest; sets the direction of the motion that follows.
  long double wait(long double t, long double most) {
    const long double force = first_ + slope_ * t - k_ * p, mu = friction_.mu_s;
    y_ = force > mu ? 1 : force < -mu ? -1 : 0;
    if (y_ != 0) return 0;
    if (slope_ == 0) return most;
    const int towards = slope_ > 0 ? 1 : -1;
    const long double time = (towards * mu - force) / slope_;
    if (time < most) y_ = towards;
    return std::min(time, most);
  }
  [[nodiscard]] State moved(long double t, long double h) const {
    const auto rate = [&](long double at, const State& s) {
      const double speed = std::max(static_cast<double>(y_ * s.v), 0.0);
      const long double slide = drag_.is_linear() ? -drag_.linear * s.v : y_ * drag_(speed);
      return State{first_ + slope_ * at - k_ * s.p + slide - y_ * friction_(speed), s.v};
    };
    const auto ahead = [&](long double by, const State& d) {
      return State{v + by * d.v, p + by * d.p};
    };
    const State a = rate(t, {v, p}), b = rate(t + h / 2, ahead(h / 2, a)),
                c = rate(t + h / 2, ahead(h / 2, b)), d = rate(t + h, ahead(h, c));
    return {v + h / 6 * (a.v + 2 * b.v + 2 * c.v + d.v),
            p + h / 6 * (a.p + 2 * b.p + 2 * c.p + d.p)};
  }
  long double slide(long double t, long double h) {
    const bool stops = y_ * moved(t, h).v <= 0;
    if (stops) {
      long double low = 0;
      while (true) {
        const long double middle = (low + h) / 2;
        if (middle <= low || middle >= h) break;
        (y_ * moved(t, middle).v > 0 ? low : h) = middle;
      }
    }
    const State next = moved(t, h);
    v = stops ? 0 : next.v;
    p = next.p;
    if (stops) y_ = 0;
    return t + h;
  }

  model::Friction friction_;
  model::Drag drag_;
  long double k_, first_ = 0, slope_ = 0;
  int y_ = 0;
};

double largest(const std::vector<double>& values) {
  double most = 0;
  for (double value : values) most = std::max(most, std::abs(value));
  return most;
}

void check_block(const ForceRecord& r, const model::Friction& friction, double bias) {
  const auto backwards = friction.mirrored();
  test::Block block(friction.mu_s, backwards.mu_s, bias);
  const Response found = respond(process(friction, {0, 0}, bias), r);
  REQUIRE(!found.slips.empty());
  const double size = largest(found.x), speed = largest(found.v);
  for (std::size_t n = 0; n + 1 < r.time.size(); ++n) {
    block.follow(r, n);
    REQUIRE(std::abs(found.v[n + 1] - static_cast<double>(block.v)) <= 3e-14 * speed);
    REQUIRE(std::abs(found.x[n + 1] - static_cast<double>(block.x)) <= 3e-14 * size);
  }
}

}  // namespace

TEST_CASE("response: without drag, that of a rigid block on a plane") {
  for (const auto& r : records()) {
    for (double bias : {0.0, 0.3}) {
      check_block(r, {0.7, 0.7}, bias);
      check_block(r, {0.7, 0.7, 1.1, 1.1}, bias);
    }
  }
}

TEST_CASE("response: a block that never slides upslope") {
  for (const auto& r : records()) {
    check_block(r, {0.7, 0.7, 1e9, 1e9}, 0);
    const Response found = respond(process({0.7, 0.7, 1e9, 1e9}, {0, 0}), r);
    for (std::size_t n = 1; n < found.x.size(); ++n) REQUIRE(found.x[n] >= found.x[n - 1]);
    CHECK(found.farthest == found.x.back());
  }
}

TEST_CASE("response: a velocity at the first sample, under friction that grows with the load") {
  // u' = -mu (1 + s t) from u(0) = v.
  constexpr double v = 3, mu = 0.5, s = 0.1;
  const double stop = (std::sqrt(1 + 2 * s * v / mu) - 1) / s;
  const double path = v * stop - mu * stop * stop * (1.0 / 2 + s * stop / 6);
  const ForceRecord r{.time = {0, 10}, .force = {0, 0}, .load = {1, 1 + 10 * s}};
  for (double sign : {1, -1}) {
    const Response found = respond(process({mu, mu}, {0, 0}), r, sign * v);
    CHECK(found.x.back() == Approx(sign * path).epsilon(1e-14));
    CHECK(found.v.front() == sign * v);
    REQUIRE(found.slips.size() == 1);
    CHECK(found.slips[0].end == Approx(stop).epsilon(1e-14));
    CHECK(found.slips[0].peak == v);
  }
}

TEST_CASE("response: a load that falls lets a body go") {
  // 1.5 (1 - t/2) holds a force of 1 until t = 2/3; from there on u' = t/2.
  const ForceRecord r{.time = {0, 1}, .force = {1, 1}, .load = {1, 0.5}};
  const Response found = respond(process({1.5, 1}, {0, 0}), r);
  CHECK(found.slips.at(0).begin == Approx(2.0 / 3).epsilon(1e-14));
  CHECK(found.v.back() == Approx(5.0 / 36).epsilon(1e-14));
  CHECK(found.x.back() == Approx(7.0 / 324).epsilon(1e-14));
}

TEST_CASE("response: a push and what follows it, with linear drag") {
  // A force F for a time T, then none; b = -c v.
  constexpr double c = 0.8, mu_s = 1, mu_d = 0.6, force = 2, time = 1.5;
  ForceRecord r{{0, 0.5, 0.5 + time, 6}, {0.9, force, 0, 0}, true};
  const Response found = respond(process({mu_s, mu_d}, {c, 0}), r);
  const double v = (force - mu_d) / c * -std::expm1(-c * time), stop = std::log1p(c * v / mu_d) / c;
  const double path = (force - mu_d) / c * time - v / c + v / c - mu_d / c * stop;
  REQUIRE(found.slips.size() == 1);
  CHECK(found.slips[0].begin == 0.5);
  CHECK(found.slips[0].end == Approx(0.5 + time + stop).epsilon(1e-14));
  CHECK(found.slips[0].peak == Approx(v).epsilon(1e-14));
  CHECK(found.slips[0].displacement == Approx(path).epsilon(1e-14));
  CHECK(found.v == std::vector<double>{0, 0, found.v[2], 0});
  CHECK(found.x.back() == found.farthest);
  CHECK(found.sliding == Approx(time + stop).epsilon(1e-14));
  CHECK(found.fastest == found.slips[0].peak);
}

TEST_CASE("response: what grows slowly with linear drag is known to all digits") {
  // u' = s t - c u from rest: c^2 u = s (c t - 1 + exp(-c t)), by its series where c t is small.
  constexpr double slope = 0.25, mu = 1;
  for (double c : {1e-9, 1e-3, 0.019, 0.021, 0.9, 1.1, 30.0}) {
    const ForceRecord r{{0, 1, 5}, {mu - slope, mu, mu + 4 * slope}};
    const Response found = respond(process({mu, mu}, {c, 0}), r);
    const long double z = 4 * static_cast<long double>(c);
    long double u = (z - 1 + std::exp(-z)) / (z * z);
    if (z < 1) {
      long double term = 0.5L;
      u = 0;
      for (int n = 3; n < 40; ++n, term *= -z / (n - 1)) u += term;
    }
    CHECK(found.v.back() == Approx(static_cast<double>(16 * slope * u)).epsilon(1e-14));
  }
}

TEST_CASE("response: friction that weakens and any drag, beside many small steps") {
  const model::Friction stribeck{0.9, 0.4, {}, {}, model::Stribeck{0.3, 1}};
  const auto all = records();
  for (const auto& [friction, drag] :
       {std::pair{stribeck, model::Drag{0.5, 0}},
        {model::Friction{0.9, 0.4}, model::Drag{0.2, 0.7}},
        {stribeck, model::Drag{0, 0, [](double v) { return -v - v * std::abs(v); }, 1e3}}}) {
    for (std::size_t n : {0, 1}) {
      const Response found = respond(process(friction, drag), all[n]);
      const Stepped expected = stepped(all[n], friction, drag);
      CHECK(found.x.back() == Approx(expected.x).epsilon(3e-4));
      const Response finer = respond(process(friction, drag), all[n], 0, 0.5);
      CHECK(finer.x.back() == Approx(found.x.back()).epsilon(1e-13));
      CHECK(finer.fastest == Approx(found.fastest).epsilon(1e-13));
    }
  }
}

TEST_CASE("response: a body on a spring, beside small steps") {
  const model::Friction friction{0.6, 0.35};
  const model::Drag law{0, 0, [](double v) { return -0.3 * v - 0.2 * v * std::abs(v); }, 64};
  for (const auto& [drag, k] : {std::pair{model::Drag{0, 0}, 2.5},
                                {model::Drag{0.3, 0}, 2.5},
                                {model::Drag{2, 0}, 1.0},
                                {model::Drag{7, 0}, 1.0},
                                {model::Drag{0.5, 0}, 1e-7},
                                {model::Drag{0.5, 0}, 900.0},
                                {model::Drag{0.1, 0.4}, 2.5},
                                {law, 6.0}}) {
    for (bool constant : {false, true}) {
      ForceRecord r =
          record(0.4, 60, [](double t) { return (1 + t / 20) * std::sin(1.3 * t + t * t / 60); });
      r.constant = constant;
      const Response found = respond(process(friction, drag, 0, k), r);
      OnSpring body(friction, drag, k);
      const double size = largest(found.x), speed = largest(found.v);
      REQUIRE(!found.slips.empty());
      for (std::size_t n = 0; n + 1 < r.time.size(); ++n) {
        body.follow(r, n, k > 100 ? 20000 : 2000);
        INFO(drag.linear << " " << k << " at " << n);
        REQUIRE(std::abs(found.x[n + 1] - static_cast<double>(body.p)) <= 1e-10 * size);
        REQUIRE(std::abs(found.v[n + 1] - static_cast<double>(body.v)) <= 1e-10 * speed);
      }
    }
  }
}

TEST_CASE("response: a body that a spring stops") {
  // From v without drag, 1/2 of a swing about -mu/K: mu + K a = (mu^2 + K v^2)^(1/2), and so on.
  constexpr double v = 3, mu = 0.5, k = 4;
  const ForceRecord r{{0, 100}, {0, 0}};
  const Response found = respond(process({mu, mu}, {0, 0}, 0, k), r, v);
  double amplitude = std::sqrt(mu * mu + k * v * v) / k, x = amplitude - mu / k, farthest = x;
  double time = std::atan2(v * std::sqrt(k), mu) / std::sqrt(k);
  for (; k * std::abs(x) > mu; time += std::numbers::pi / std::sqrt(k)) {
    x = x > 0 ? -(x - 2 * mu / k) : -(x + 2 * mu / k);
  }
  REQUIRE(found.slips.size() == 1);
  CHECK(found.x.back() == Approx(x).epsilon(1e-13));
  CHECK(found.farthest == Approx(farthest).epsilon(1e-14));
  CHECK(found.slips[0].end == Approx(time).epsilon(1e-14));
  CHECK(found.slips[0].peak == v);
}

TEST_CASE(
    "response: an overdamped body creeps towards where the spring holds it, and never rests") {
  constexpr double mu_d = 0.5, k = 1, c = 5, force = 1.5, root = 2.291287847477920003294;
  for (double time : {3.0, 30.0, 3000.0}) {
    const Response found = respond(process({1, mu_d}, {c, 0}, 0, k), {{0, time}, {force, force}});
    const double slow = c / 2 - root, fast = c / 2 + root, most = (force - mu_d) / k,
                 left =
                     (fast * std::exp(-slow * time) - slow * std::exp(-fast * time)) / (2 * root);
    CHECK(found.x.back() == Approx(most * (1 - left)).epsilon(1e-13));
    CHECK(found.sliding == time);
  }
}

TEST_CASE("response: the closed form and the series agree") {
  for (const auto& r : records()) {
    const model::Drag linear{0.7, 0}, law{0, 0, [](double v) { return -0.7 * v; }, 16};
    const Response a = respond(process({0.9, 0.5}, linear, 0.1), r),
                   b = respond(process({0.9, 0.5}, law, 0.1), r);
    REQUIRE(a.slips.size() == b.slips.size());
    for (std::size_t n = 0; n < a.slips.size(); ++n) {
      CHECK(a.slips[n].begin == Approx(b.slips[n].begin).epsilon(1e-13));
      CHECK(a.slips[n].end == Approx(b.slips[n].end).epsilon(1e-13));
      CHECK(a.slips[n].peak == Approx(b.slips[n].peak).epsilon(1e-12));
      CHECK(a.slips[n].displacement ==
            Approx(b.slips[n].displacement).epsilon(1e-12).margin(1e-13 * a.farthest));
    }
    CHECK(a.x.back() == Approx(b.x.back()).epsilon(1e-12));
  }
}

TEST_CASE("response: the mirror image of a force moves bodies the other way") {
  for (auto r : records()) {
    const model::Friction friction{0.9, 0.5, 1.2, 0.6};
    const Response a = respond(process(friction, {0.3, 0.1}, 0.2), r);
    for (double& force : r.force) force = -force;
    const Response b = respond(process(friction.mirrored(), {0.3, 0.1}, -0.2), r);
    REQUIRE(a.slips.size() == b.slips.size());
    for (std::size_t n = 0; n < a.x.size(); ++n) {
      REQUIRE(a.x[n] == -b.x[n]);
      REQUIRE(a.v[n] == -b.v[n]);
    }
  }
}

TEST_CASE("response: a force that equals static friction up to rounding moves nothing") {
  const auto touching = [](double t) { return 0.3 * std::sin(std::numbers::pi / 2 * t) * 3; };
  const Response found = respond(process({0.9, 0.2}, {1, 0}), record(0.5, 40, touching));
  CHECK(found.slips.empty());
  CHECK(found.sliding == 0);
  CHECK(found.x == std::vector<double>(41, 0.0));
}

TEST_CASE("response: a body that is turned round goes on with the same slip") {
  // mu = 1: from +3 to -3 at once, so that it stops under a force that pushes it back.
  const ForceRecord r{{0, 1, 4, 5}, {3, -3, 0, 0}, true};
  const Response found = respond(process({1, 1}, {0, 0}), r);
  REQUIRE(found.slips.size() == 1);
  // Up for 1 with 2, down to rest for 1/2 with -4, back for 5/2 with -2, then to rest with +1.
  CHECK(found.v[1] == 2);
  CHECK(found.x[1] == 1);
  CHECK(found.v[2] == Approx(-5).epsilon(1e-15));
  CHECK(found.farthest == Approx(std::abs(1.5 - 6.25 - 4.5)).epsilon(1e-15));
  CHECK(found.slips[0].peak == Approx(5).epsilon(1e-15));
  CHECK(found.slips[0].end == 5);
}
