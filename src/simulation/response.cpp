#include "stickslip/simulation/response.hpp"

#include <array>
#include <optional>

#include "slide.hpp"

namespace stickslip::simulation {
namespace {

/// Friction and slides of one direction of motion.
class Branch {
 public:
  Branch(const model::Process& process, double stride)
      : friction_(process.friction), bias_(process.bias), slider_(process, stride) {}

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

  [[nodiscard]] const Slider& slider() const { return slider_; }

 private:
  model::Friction friction_;
  double bias_;
  Slider slider_;
};

/// What acts on a body: a force, and the normal force over the weight.
struct Action {
  double force, load;
};

class Body {
 public:
  Body(const model::Process& process, double stride, double time, double velocity)
      : branches_{Branch(process, stride), Branch(process.mirrored(), stride)},
        k_(process.stiffness),
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
      const double held = k_ * x_;  // by the spring
      const Action now{from.force + slope.force * t - held, from.load + slope.load * t};
      double push = y_ == 0 ? 0 : branch(y_).net_force(y_ * now.force, now.load);
      if (y_ == 0) {
        const auto start = release(now, {to.force - held, to.load}, length - t);
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
    const Slide slide = branch(y_).slider().slide(u_, push, slope, time);
    u_ = slide.end;
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
  double k_;
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
