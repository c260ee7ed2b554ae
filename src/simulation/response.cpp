#include "stickslip/simulation/response.hpp"

#include <boost/math/tools/toms748_solve.hpp>

#include <array>
#include <cstdint>
#include <optional>

#include "stickslip/base/text.hpp"
#include "stickslip/model/noise_chain.hpp"
#include "stickslip/simulation/flow.hpp"

namespace stickslip::simulation {
namespace {

/// Where f changes its sign between 0 and `end`.
template <class Function>
double root(const Function& f, double end) {
  const double first = f(0), last = f(end);
  if (first == 0) return 0;
  if (last == 0 || (first < 0) == (last < 0)) return end;
  std::uintmax_t iterations = 200;
  const auto [a, b] = boost::math::tools::toms748_solve(
      f, 0.0, end, first, last, boost::math::tools::eps_tolerance<double>(), iterations);
  return a + (b - a) / 2;
}

/// phi_k(z) = int_0^1 exp(-z (1 - s)) s^(k-1)/(k-1)! ds, which is 1/k! at z = 0.
struct Phi {
  double one, two, three;

  // For small z by the series of the last one, as 1 - z phi_1 = exp(-z) and so on leave few digits.
  explicit Phi(double z) {
    if (z > 1) {
      one = -std::expm1(-z) / z;
      two = (1 - one) / z;
      three = (0.5 - two) / z;
      return;
    }
    double sum = 1;
    for (int n = z < 0.02 ? 10 : 21; n > 3; --n) sum = 1 - z / n * sum;
    three = sum / 6;
    two = 0.5 - z * three;
    one = 1 - z * two;
  }
};

/// u' = force + slope t - c u from u(0), in closed form.
class LinearStep {
 public:
  LinearStep(double c, double speed, double force, double slope, double room)
      : c_(c), speed_(speed), force_(force), slope_(slope), reach_(room) {}

  [[nodiscard]] double reach() const { return reach_; }
  [[nodiscard]] bool leaves(double /*speed*/) const { return false; }
  [[nodiscard]] double end_towards(double /*speed*/) const { return 0; }
  [[nodiscard]] double speed(double t) const {
    const Phi phi(c_ * t);
    return speed_ * (1 - c_ * t * phi.one) + t * (force_ * phi.one + slope_ * t * phi.two);
  }
  [[nodiscard]] double path(double t) const {
    const Phi phi(c_ * t);
    return t * (speed_ * phi.one + t * (force_ * phi.two + slope_ * t * phi.three));
  }
  /// When u' changes its sign: u'(t) = slope/c + (u'(0) - slope/c) exp(-c t).
  [[nodiscard]] double turn() const {
    const double rate = force_ - c_ * speed_;
    if (rate == 0 || slope_ == 0 || (rate > 0) == (slope_ > 0)) return kInfinity;
    const double time = -rate / slope_;
    return c_ > 0 ? std::log1p(c_ * time) / c_ : time;
  }

 private:
  double c_, speed_, force_, slope_, reach_;
};

constexpr std::size_t kTerms = 14;

/// u' = force + slope t + b(u) from u(0), b a polynomial: u(t) - u(0) = sum_{n=1}^{14} x_n t^n.
class SeriesStep {
 public:
  SeriesStep(const DragPanel& panel, double speed, double force, double slope, double room,
             double stride)
      : panel_(panel), speed_(speed), reach_(room) {
    auto b = panel.coefficient;
    const double shift = speed - panel.centre;
    for (std::size_t k = 0; k + 1 < kDragTerms; ++k) {
      for (std::size_t n = kDragTerms - 1; n-- > k;) b[n] += shift * b[n + 1];
    }
    std::array<std::array<double, kTerms>, kDragTerms> power{};  // [k][n]: of t^n in (u - u(0))^k
    x_[1] = force + b[0];
    for (std::size_t n = 1; n < kTerms; ++n) {
      power[1][n] = x_[n];
      double sum = b[1] * x_[n] + (n == 1 ? slope : 0);
      for (std::size_t k = 2; k < kDragTerms && k <= n; ++k) {
        for (std::size_t m = 1; m + k <= n + 1; ++m) power[k][n] += x_[m] * power[k - 1][n - m];
        sum += b[k] * power[k][n];
      }
      x_[n + 1] = sum / static_cast<double>(n + 1);
    }
    for (double left = remainder(reach_); left > 1; left = remainder(reach_)) {
      reach_ *= 0.95 * std::max(0.1, std::pow(left, -1.0 / kTerms));
    }
    if (reach_ < room) reach_ *= stride;
  }

  [[nodiscard]] double reach() const { return reach_; }
  /// Whether a speed lies beyond the panel; below the lowest one, bodies stop.
  [[nodiscard]] bool leaves(double speed) const {
    return speed > panel_.to || (panel_.low > 0 && speed < panel_.from);
  }
  [[nodiscard]] double end_towards(double speed) const {
    return speed > panel_.to ? panel_.to : panel_.low > 0 ? panel_.from : 0;
  }
  [[nodiscard]] double speed(double t) const {
    double sum = 0;
    for (std::size_t n = kTerms; n > 0; --n) sum = (sum + x_[n]) * t;
    return speed_ + sum;
  }
  [[nodiscard]] double path(double t) const {
    double sum = 0;
    for (std::size_t n = kTerms; n > 0; --n) sum = (sum + x_[n] / static_cast<double>(n + 1)) * t;
    return t * (speed_ + sum);
  }
  // Near a terminal velocity u' is rounding, whatever its sign.
  [[nodiscard]] double turn() const {
    const auto rate = [this](double t) {
      double sum = 0;
      for (std::size_t n = kTerms; n > 0; --n) sum = sum * t + static_cast<double>(n) * x_[n];
      return sum;
    };
    constexpr double rounding = 1e-14;
    if (std::abs(x_[1]) * reach_ <= rounding * speed_) return kInfinity;
    return (x_[1] < 0) == (rate(reach_) < 0) ? kInfinity : root(rate, reach_);
  }

 private:
  // The last terms over what is allowed of them; some, but not seven, may be 0 by chance.
  [[nodiscard]] double remainder(double h) const {
    constexpr double fall = 1e-2, tolerance = 1e-16;
    double size = 0;
    for (std::size_t n = kTerms - 6; n <= kTerms; ++n) {
      size = fall * size + std::pow(h, n) * std::abs(x_[n]);
    }
    return size / (tolerance * (speed_ + h * (std::abs(x_[1]) + h * std::abs(x_[2]))));
  }

  DragPanel panel_;
  double speed_, reach_;
  std::array<double, kTerms + 1> x_{};
};

/// A body that slides upwards while the force is linear in time.
struct Slide {
  double time = 0, speed = 0, path = 0, peak = 0;
  bool stopped = false;
};

/// Friction, drag and steps of one direction of motion.
class Branch {
 public:
  Branch(const model::Process& process, double stride)
      : friction_(process.friction), bias_(process.bias), stride_(stride) {
    process.drag.is_linear() ? void(c_ = process.drag.linear) : void(table_.emplace(process.drag));
  }

  /// force + g - mu_s, 0 where that is rounding: above 0 no body stays at rest. Friction, here and
  /// below, is that under the weight times `load`.
  [[nodiscard]] double beyond_static(double force, double load) const {
    return model::snapped_difference(force, friction_.mu_s * load - bias_);
  }
  /// The acceleration of a body that starts to slide, beside drag; `beyond` as above.
  [[nodiscard]] double push(double beyond, double load) const {
    return beyond + (friction_.mu_s - friction_.at_rest()) * load;
  }
  /// force + g - F(0+).
  [[nodiscard]] double net_force(double force, double load) const {
    return model::snapped_difference(force, friction_.at_rest() * load - bias_);
  }
  /// Its slope over time of those of force and load.
  [[nodiscard]] double net_slope(double force, double load) const {
    return force - friction_.at_rest() * load;
  }

  /// Slides from a speed for a time, or until the body stops. u' changes its sign once at most: it
  /// obeys a linear equation with the right-hand side `slope`. So u is monotone up to there.
  [[nodiscard]] Slide move(double speed, double force, double slope, double time) {
    Slide slide{0, speed, 0, speed};
    while (!slide.stopped && slide.time < time) {
      const double now = force + slope * slide.time, room = time - slide.time;
      if (table_) {
        step(SeriesStep(table_->at(slide.speed), slide.speed, now, slope, room, stride_), time,
             slide);
      } else {
        step(LinearStep(c_, slide.speed, now, slope, room), time, slide);
      }
    }
    return slide;
  }

 private:
  template <class Step>
  void step(const Step& step, double end, Slide& slide) const {
    const double room = end - slide.time;
    double h = std::min(step.reach(), step.turn());
    if (slide.time + h == slide.time) h = step.reach();  // it turns here, up to rounding
    double next = step.speed(h);
    slide.stopped = next <= 0 && next < slide.speed && step.end_towards(next) == 0;
    if (slide.stopped || step.leaves(next)) {
      const double bound = step.end_towards(next);
      h = root([&](double t) { return step.speed(t) - bound; }, h);
      next = bound;
    }
    slide.path += step.path(h);
    slide.time = h == room ? end : slide.time + h;
    slide.speed = std::max(next, 0.0);
    slide.peak = std::max(slide.peak, slide.speed);
  }

  model::Friction friction_;
  double bias_, stride_, c_ = 0;
  std::optional<DragTable> table_;
};

/// What acts on a body: a force, and the normal force over the weight.
struct Action {
  double force, load;
};

class Body {
 public:
  Body(const model::Process& process, double stride, double time, double velocity)
      : branches_{Branch(process, stride), Branch(process.mirrored(), stride)},
        y_(velocity > 0   ? 1
           : velocity < 0 ? -1
                          : 0),
        u_(std::abs(velocity)) {
    if (y_ != 0) open_ = Slip{time, 0, 0, u_};
  }

  /// While the action goes from one to another.
  void follow(double begin, double end, const Action& from, const Action& to) {
    const double length = end - begin;
    const Action slope{(to.force - from.force) / length, (to.load - from.load) / length};
    for (double t = 0; t < length;) {
      const Action now{from.force + slope.force * t, from.load + slope.load * t};
      double push = y_ == 0 ? 0 : branch(y_).net_force(y_ * now.force, now.load);
      if (y_ == 0) {
        const auto start = release(now, to, length - t);
        if (open_ && (!start || start->wait > 0)) close(begin + t);
        if (!start) return;
        t += start->wait;
        push = start->push;
        if (!open_) open_ = Slip{begin + t, 0, x_, 0};
      }
      if (t >= length) return;
      t += slide(push, branch(y_).net_slope(y_ * slope.force, slope.load), length - t);
    }
  }
  void expect(std::size_t samples) {
    response_.v.reserve(samples);
    response_.x.reserve(samples);
  }
  void sample() {
    response_.v.push_back(y_ * u_);
    response_.x.push_back(x_);
  }
  [[nodiscard]] Response end(double time) {
    if (open_) close(time);
    return std::move(response_);
  }

 private:
  /// When static friction is overcome, and the force less friction from there on.
  struct Release {
    double wait, push;
  };

  Branch& branch(int y) { return branches_[y > 0 ? 0 : 1]; }

  // Of a body at rest under an action that goes from one to another; nothing if it stays.
  std::optional<Release> release(const Action& from, const Action& to, double length) {
    for (int y : {1, -1}) {
      const double now = branch(y).beyond_static(y * from.force, from.load),
                   then = branch(y).beyond_static(y * to.force, to.load);
      if (now <= 0 && then <= 0) continue;
      y_ = y;
      u_ = 0;
      if (now > 0) return Release{0, branch(y).push(now, from.load)};
      const double share = -now / (then - now);
      return Release{length * share, branch(y).push(0, from.load + share * (to.load - from.load))};
    }
    return std::nullopt;
  }
  // Up to a stop, or for a time; returns how long.
  double slide(double push, double slope, double time) {
    const Slide slide = branch(y_).move(u_, push, slope, time);
    u_ = slide.speed;
    x_ += y_ * slide.path;
    response_.sliding += slide.time;
    response_.farthest = std::max(response_.farthest, std::abs(x_));
    open_->peak = std::max(open_->peak, slide.peak);
    if (slide.stopped) y_ = 0;
    return slide.time;
  }
  void close(double time) {
    Slip& slip = *open_;
    slip.end = time;
    slip.displacement = x_ - slip.displacement;
    response_.fastest = std::max(response_.fastest, slip.peak);
    if (slip.peak > 0) response_.slips.push_back(slip);
    open_.reset();
  }

  std::array<Branch, 2> branches_;
  Response response_;
  std::optional<Slip> open_;  // the displacement is that at its beginning
  int y_ = 0;
  double u_ = 0, x_ = 0;
};

}  // namespace

Response respond(const model::Process& process, const model::ForceRecord& record, double velocity,
                 double stride) {
  const auto& time = record.time;
  Body body(process, stride, time.front(), velocity);
  const auto action = [&](std::size_t n) { return Action{record.force[n], record.load_at(n)}; };
  body.expect(time.size());
  body.sample();
  for (std::size_t n = 0; n + 1 < time.size(); ++n) {
    body.follow(time[n], time[n + 1], action(n), action(record.constant ? n : n + 1));
    body.sample();
  }
  return body.end(time.back());
}

}  // namespace stickslip::simulation
