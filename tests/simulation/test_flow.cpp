#include <cmath>
#include <functional>
#include <stdexcept>

#include "../common/catch.hpp"
#include "../common/quadrature.hpp"
#include "stickslip/simulation/flow.hpp"

using namespace stickslip;
using simulation::GeneralFlow;
using simulation::LinearFlow;
using simulation::Piece;

namespace {

struct Start {
  model::Drag drag;
  double speed, force, time;
};

std::ostream& operator<<(std::ostream& out, const Start& s) {
  return out << "drag " << s.drag.linear << " + " << s.drag.cubic << " u^2, speed " << s.speed
             << ", force " << s.force << ", time " << s.time;
}

/// Times on both sides of the series of LinearFlow, which ends at c t = 0.02.
std::vector<Start> linear_starts() {
  std::vector<Start> all;
  for (double c : {0.0, 1e-6, 0.3, 1.0, 5.0}) {
    for (double force : {-0.7, 0.0, 0.4, 2.0}) {
      for (double speed : {0.0, 1e-3, 0.5, 3.0}) {
        for (double time : {1e-4, 0.0199, 0.0201, 0.5, 3.0}) {
          if (speed > 0 || force > 0) all.push_back({{c, 0}, speed, force, time});
        }
      }
    }
  }
  return all;
}

std::vector<Start> cubic_starts() {
  std::vector<Start> all;
  for (const model::Drag& drag : {model::Drag{0, 1}, model::Drag{0.5, 0.3}, model::Drag{1, 4}}) {
    for (double force : {-0.7, 0.0, 2.0}) {
      for (double speed : {0.0, 0.1, 1.5}) {
        for (double time : {1e-3, 0.4, 3.0}) {
          if (speed > 0 || force > 0) all.push_back({drag, speed, force, time});
        }
      }
    }
  }
  return all;
}

// u(t) of linear drag before it stops.
double linear_speed(const Start& s, double t) {
  const long double c = s.drag.linear, force = s.force, speed = s.speed;
  if (c == 0) return static_cast<double>(speed + force * t);
  return static_cast<double>(speed * std::exp(-c * t) - force * std::expm1(-c * t) / c);
}

// u' = 0 at u = -force/c < 0 is never reached with force >= 0.
double linear_stop(const Start& s) {
  if (s.force >= 0) return std::numeric_limits<double>::infinity();
  const long double c = s.drag.linear, force = s.force, speed = s.speed;
  if (c == 0) return static_cast<double>(-speed / force);
  return static_cast<double>(std::log1p(-c * speed / force) / c);
}

/// Time, path and square from one speed down to 0, as integrals over the speed.
Piece cubic_stop(const Start& s) {
  const auto q = test::panels(0, s.speed, 40);
  const auto integral = [&](int power) {
    return q.sum(
        [&](std::size_t n) { return std::pow(q.node[n], power) / -(s.force + s.drag(q.node[n])); });
  };
  return {integral(0), 0, integral(1), integral(2), true};
}

struct Motion {
  long double speed = 0, path = 0, square = 0;
};

/// Runge-Kutta steps of order 4, with no regard to stops.
Motion runge_kutta(const Start& s, int steps = 20000) {
  const long double h = static_cast<long double>(s.time) / steps;
  const auto rate = [&](const Motion& m) {
    const long double drag = (s.drag.linear + s.drag.cubic * m.speed * m.speed) * m.speed;
    return Motion{s.force - drag, m.speed, m.speed * m.speed};
  };
  const auto after = [](const Motion& m, const Motion& r, long double t) {
    return Motion{m.speed + t * r.speed, m.path + t * r.path, m.square + t * r.square};
  };
  Motion m{s.speed, 0, 0};
  for (int n = 0; n < steps; ++n) {
    const Motion a = rate(m), b = rate(after(m, a, h / 2)), c = rate(after(m, b, h / 2)),
                 d = rate(after(m, c, h));
    for (const auto& [r, weight] : {std::pair{a, 1}, {b, 2}, {c, 2}, {d, 1}}) {
      m = after(m, r, weight * h / 6);
    }
  }
  return m;
}

void check_piece(const Piece& found, const Piece& known, double tolerance) {
  CHECK(found.stopped == known.stopped);
  CHECK(found.time == Approx(known.time).epsilon(tolerance).margin(1e-15));
  CHECK(found.end == Approx(known.end).epsilon(tolerance).margin(1e-14));
  CHECK(found.path == Approx(known.path).epsilon(tolerance).margin(1e-15));
  CHECK(found.square == Approx(known.square).epsilon(tolerance).margin(1e-15));
  if (found.stopped) CHECK(found.end == 0);
}

/// int_0^time u exp(-i omega s) ds, u by the flow itself.
template <class Flow>
std::complex<double> transform_by_panels(const Flow& flow, const Start& s, double time,
                                         double omega) {
  const double rate = omega + s.drag.linear + 3 * s.drag.cubic * s.speed * s.speed;
  const auto q = test::panels(0, time, 10 + static_cast<int>(rate * time));
  const auto part = [&](const std::function<double(double)>& wave) {
    return q.sum([&](std::size_t n) {
      return flow.move(s.speed, s.force, q.node[n], false).end * wave(omega * q.node[n]);
    });
  };
  return {part([](double a) { return std::cos(a); }), -part([](double a) { return std::sin(a); })};
}

template <class Flow>
void check_transforms(const Start& s) {
  INFO(s);
  const Flow flow(s.drag);
  const Piece piece = flow.move(s.speed, s.force, s.time, true);
  // One by one: the highest of a list decides how finely all are integrated.
  for (double omega : {0.0, 1e-3, 0.7, 5.0, 60.0}) {
    INFO("omega " << omega);
    std::vector<std::complex<double>> found(1);
    flow.transform(s.speed, s.force, piece, {omega}, found);
    const auto known = transform_by_panels(flow, s, piece.time, omega);
    CHECK(std::abs(found[0] - known) <= 1e-10 * piece.path + 1e-15);
    if (omega == 0) CHECK(std::abs(found[0] - piece.path) <= 1e-10 * piece.path + 1e-15);
  }
}

}  // namespace

TEST_CASE("flow: linear drag and none against closed forms and quadrature") {
  for (const auto& s : linear_starts()) {
    INFO(s);
    const double stop = linear_stop(s), time = std::min(s.time, stop);
    const auto q = test::panels(0, time, 20);
    const auto integral = [&](int power) {
      return q.sum([&](std::size_t n) { return std::pow(linear_speed(s, q.node[n]), power); });
    };
    const bool stopped = stop < s.time;
    check_piece(LinearFlow(s.drag).move(s.speed, s.force, s.time, true),
                {time, stopped ? 0 : linear_speed(s, time), integral(1), integral(2), stopped},
                1e-11);
  }
}

TEST_CASE("flow: without integrals the motion is the same") {
  for (const auto& s : linear_starts()) {
    const LinearFlow flow(s.drag);
    const auto all = flow.move(s.speed, s.force, s.time, true),
               some = flow.move(s.speed, s.force, s.time, false);
    CHECK(some.end == all.end);
    CHECK(some.time == all.time);
    CHECK(some.stopped == all.stopped);
  }
}

TEST_CASE("flow: the integrator gives the closed forms where the drag is linear") {
  for (const auto& s : linear_starts()) {
    INFO(s);
    check_piece(GeneralFlow(s.drag).move(s.speed, s.force, s.time, true),
                LinearFlow(s.drag).move(s.speed, s.force, s.time, true), 1e-11);
  }
}

TEST_CASE("flow: cubic drag against Runge-Kutta of tiny steps, stops against integrals over u") {
  int stops = 0;
  for (const auto& s : cubic_starts()) {
    INFO(s);
    const auto found = GeneralFlow(s.drag).move(s.speed, s.force, s.time, true);
    Piece known = s.force < 0 ? cubic_stop(s) : Piece{s.time + 1};
    if (known.time > s.time) {
      const Motion m = runge_kutta(s);
      known = {s.time, static_cast<double>(m.speed), static_cast<double>(m.path),
               static_cast<double>(m.square), false};
    }
    stops += known.stopped;
    check_piece(found, known, 1e-10);
  }
  CHECK(stops >= 6);
}

// A force of exactly 0, as on the level that equals mu_d, slows a body down but never stops it,
// however long the noise stays there.
TEST_CASE("flow: no body stops unless it is pushed back") {
  for (const model::Drag& drag : {model::Drag{1, 0}, model::Drag{5, 0}, model::Drag{1, 1}}) {
    for (double time : {30.0, 45.0, 1000.0}) {
      INFO("time " << time << " drag " << drag.linear << " " << drag.cubic);
      const auto general = GeneralFlow(drag).move(1, 0, time, true);
      CHECK_FALSE(general.stopped);
      CHECK(general.end >= 0);
      if (drag.cubic > 0) continue;
      const auto linear = LinearFlow(drag).move(1, 0, time, true);
      CHECK_FALSE(linear.stopped);
      CHECK(linear.time == time);
      CHECK(linear.end >= 0);
      CHECK(linear.path == Approx(1 / drag.linear).epsilon(1e-11));
    }
  }
}

TEST_CASE("flow: a body all but at rest stops at once when it is pushed back") {
  for (double speed : {0.0, 1e-300}) {
    const auto linear = LinearFlow({1, 0}).move(speed, -0.5, 1, true);
    const auto general = GeneralFlow({1, 1}).move(speed, -0.5, 1, true);
    for (const auto& piece : {linear, general}) {
      CHECK(piece.stopped);
      CHECK(piece.end == 0);
      CHECK(piece.time >= 0);
      CHECK(piece.time <= 1e-15);
    }
  }
}

TEST_CASE("flow: any drag law gives what the closed forms and the built-in laws give") {
  for (const auto& s : cubic_starts()) {
    INFO(s);
    const model::Drag written{
        0, 0, [c = s.drag](double v) { return -c.linear * v - c.cubic * v * v * v; }};
    check_piece(GeneralFlow(written).move(s.speed, s.force, s.time, true),
                GeneralFlow(s.drag).move(s.speed, s.force, s.time, true), 1e-12);
    for (double omega : {0.0, 0.7, 60.0}) {
      std::vector<std::complex<double>> found(1), known(1);
      const auto piece = GeneralFlow(s.drag).move(s.speed, s.force, s.time, true);
      GeneralFlow(written).transform(s.speed, s.force, piece, {omega}, found);
      GeneralFlow(s.drag).transform(s.speed, s.force, piece, {omega}, known);
      CHECK(std::abs(found[0] - known[0]) <= 1e-10 * piece.path + 1e-15);
    }
  }
  // u' = -tanh(u): sinh(u) decays as exp(-t).
  const GeneralFlow saturating({0, 0, [](double v) { return -std::tanh(v); }});
  for (double speed : {0.01, 1.0, 20.0}) {
    const auto piece = saturating.move(speed, 0, 1.5, true);
    CHECK(std::sinh(piece.end) == Approx(std::sinh(speed) * std::exp(-1.5)).epsilon(1e-11));
    CHECK_FALSE(piece.stopped);
  }
}

// Powers whose series about u = 0 lack many terms: a step must not be too long for that.
TEST_CASE("flow: steep powers from rest against integrals over the speed") {
  for (double power : {1.5, 3.0, 5.0, 6.0, 7.0, 9.0}) {
    const GeneralFlow flow({0, 0, [power](double v) { return -std::pow(v, power); }});
    for (double time : {0.01, 0.1, 0.3, 0.6}) {
      INFO("power " << power << " time " << time);
      const auto piece = flow.move(0, 1, time, true);
      const auto q = test::panels(0, piece.end, 200);
      const auto integral = [&](int n) {
        return q.sum([&](std::size_t i) {
          return std::pow(q.node[i], n) / (1 - std::pow(q.node[i], power));
        });
      };
      CHECK(integral(0) == Approx(time).epsilon(1e-11));
      CHECK(integral(1) == Approx(piece.path).epsilon(1e-10));
      CHECK(integral(2) == Approx(piece.square).epsilon(1e-10));
    }
  }
}

// -min(u, 0.3) has its kink between the numbers of any grid of halves.
TEST_CASE("flow: a kink of the drag ends a step from either side") {
  const GeneralFlow flow({0, 0, [](double v) { return -std::min(v, 0.3); }});
  for (double force : {0.5, 2.0}) {
    const double reached = std::log(force / (force - 0.3));
    const auto piece = flow.move(0, force, reached + 1, true);
    CHECK(piece.end == Approx(force).epsilon(1e-12));
    CHECK(piece.path == Approx(force * reached + (force - 0.3) / 2).epsilon(1e-11));
  }
  const auto falling = flow.move(0.6, -0.1, 10, true);
  CHECK(falling.stopped);
  CHECK(falling.time == Approx(0.3 / 0.4 + std::log(4.0)).epsilon(1e-12));
}

// b is 0 at a speed where its terms are not, and in the second law they cancel everywhere: there
// no panel is as near to b as to a number of its own size.
TEST_CASE("flow: panels of a drag law end at the rounding of the law") {
  int evaluations = 0;
  const auto counted = [&](std::function<double(double)> law) {
    return [&evaluations, law](double v) {
      if (++evaluations > 10000000) throw std::runtime_error("without end");
      return law(v);
    };
  };
  const std::vector<std::function<double(double)>> laws{
      [](double v) { return -0.5 * v + 0.2 * std::tanh(3 * v); },
      [](double v) { return (1e4 * v - v) - 1e4 * v; }};
  for (const auto& law : laws) {
    evaluations = 0;
    simulation::DragTable table({0, 0, counted(law)});
    for (double u : {0.01, 0.3, 0.4, 0.7, 1.5, 3.0}) {
      const auto& panel = table.at(u);
      double b = 0;
      for (std::size_t n = panel.coefficient.size(); n-- > 0;) {
        b = panel.coefficient[n] + (u - panel.centre) * b;
      }
      CHECK(b == Approx(law(u)).margin(2e-12));
    }
  }
}

TEST_CASE("flow: the table of a drag law holds it everywhere, to rounding") {
  const std::vector<std::function<double(double)>> laws{
      [](double v) { return -std::tanh(v); },
      [](double v) { return -std::pow(v, 1.5); },
      [](double v) { return -v - std::max(0.0, v - 0.7) * 5; },
      [](double v) { return 0.3 * (1 - std::exp(-10 * v)) - v; },
      [](double) { return 0.0; },
      [](double v) { return -std::max(0.0, v - 2.7); }};
  for (const auto& law : laws) {
    simulation::DragTable table({0, 0, law});
    for (double u = 0; u < 20; u += 0.00737) {
      const auto& panel = table.at(u);
      REQUIRE(panel.low <= u);
      REQUIRE(u < panel.high);
      double sum = 0;
      for (std::size_t n = simulation::kDragTerms; n-- > 0;) {
        sum = panel.coefficient[n] + (u - panel.centre) * sum;
      }
      REQUIRE(std::abs(sum - law(u)) <= 2e-13 * (1 + std::abs(law(u))));
    }
  }
}

// A step as long as the wait makes the stages of the integrator overflow.
TEST_CASE("flow: strong cubic drag over long times ends at the terminal velocity") {
  for (double cubic : {1.0, 100.0, 1e4}) {
    for (double speed : {0.0, 0.1, 10.0}) {
      const model::Drag drag{1, cubic};
      INFO("cubic " << cubic << " speed " << speed);
      const auto piece = GeneralFlow(drag).move(speed, 2, 30, true);
      CHECK_FALSE(piece.stopped);
      CHECK(piece.end == Approx(drag.terminal_velocity(2)).epsilon(1e-10));
    }
  }
}

TEST_CASE("flow: transforms against quadrature, omega = 0 is the path") {
  for (const auto& s : linear_starts()) check_transforms<LinearFlow>(s);
}

TEST_CASE("flow: transforms of the integrator against quadrature, omega = 0 is the path") {
  for (const auto& s : cubic_starts()) check_transforms<GeneralFlow>(s);
}

// Below them the transform is the path.
TEST_CASE("flow: transforms at low frequencies and small drag do not cancel") {
  for (double c : {0.0, 1e-12, 1e-6}) {
    for (double omega : {1e-15, 1e-12, 1e-8, 1e-4}) {
      const LinearFlow flow({c, 0});
      const auto piece = flow.move(0.3, 0.7, 0.5, true);
      std::vector<std::complex<double>> found(1);
      flow.transform(0.3, 0.7, piece, {omega}, found);
      INFO("c " << c << " omega " << omega);
      CHECK(std::abs(found[0] - piece.path) <= (1e-11 + omega * 0.5) * piece.path);
    }
  }
}
