#include "slide.hpp"

#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/tools/toms748_solve.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <tuple>
#include <utility>

namespace stickslip::simulation {
namespace {

constexpr double kRounding = 1e-13;  // of friction
constexpr double kSmooth = 2;        // length of steps, in the time of their fastest change

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

/// The answers of g'' + c g' + K g = 0: g_1(0) = 0 and g_1'(0) = 1, g_0 = g_1', g_2 and g_3 the
/// integrals of g_1 and g_2 from 0. Here g_0, g_1/t, g_2/t^2 and g_3/t^3.
struct Kernel {
  double zero, one, two, three;

  Kernel(double c, double k, double t) {
    const double z = c * t, y = k * t * t;
    if (k == 0) {
      const Phi phi(z);
      std::tie(one, two, three) = std::tie(phi.one, phi.two, phi.three);
      zero = 1 - z * one;
    } else if (z + std::sqrt(y) < 2) {
      expand(z, y);
    } else {
      close(c, k, t);
    }
  }

  /// Of the frequency, in units of K^(1/2): what is closer to critical damping has the same path.
  static constexpr double kCritical = 1e-9;

 private:
  // Far above critical damping by its rates, as 1 - g_0 - c g_1 leaves few digits.
  void close(double c, double k, double t) {
    const double z = c * t, y = k * t * t, h = c / 2, d = k - h * h,
                 w = std::max(std::sqrt(std::abs(d)), kCritical * std::sqrt(k)), fast = h + w,
                 slow = k / fast, e = std::exp(-(d > 0 ? h : slow) * t);
    one = d > 0 ? e * std::sin(w * t) / (w * t) : -e * std::expm1(-2 * w * t) / (2 * w * t);
    zero = d > 0 ? e * std::cos(w * t) - h * t * one : e - fast * t * one;
    if (k > 0.1 * c * c) {
      two = (1 - zero - z * one) / y;
      three = (1 - one - z * two) / y;
    } else {
      const Phi first(slow * t), second(fast * t);
      two = (first.one - second.one) / (2 * w * t);
      three = (first.two - second.two) / (2 * w * t);
    }
  }
  // By series, where little is left of 1 - g_0 - c g_1.
  void expand(double z, double y) {
    double before = 0, term = 1.0 / 6;
    two = 3 * term;
    three = term;
    for (int n = 4; n < 28 && std::abs(term) + std::abs(before) > 1e-18; ++n) {
      before = std::exchange(term, -(z * term + y * before / (n - 1)) / n);
      two += n * term;
      three += term;
    }
    one = 1 - z * two - y * three;
    zero = 1 - z * one - y * two;
  }
};

/// Speed and path after a time.
struct Moved {
  double u, q;
};

/// u' = force + slope t - c u - K q, q' = u from u(0) and q = 0, in closed form.
class LinearStep {
 public:
  LinearStep(double c, double k, double speed, double force, double slope, double room)
      : c_(c), k_(k), speed_(speed), force_(force), slope_(slope), reach_(room) {}

  [[nodiscard]] double reach() const { return reach_; }
  [[nodiscard]] bool leaves(double /*speed*/) const { return false; }
  [[nodiscard]] double end_towards(double /*speed*/) const { return 0; }
  [[nodiscard]] Moved at(double t) const {
    const Kernel g(c_, k_, t);
    return {speed_ * g.zero + t * (force_ * g.one + slope_ * t * g.two),
            t * (speed_ * g.one + t * (force_ * g.two + slope_ * t * g.three))};
  }
  /// When u' changes its sign: without a spring u'(t) = slope/c + (u'(0) - slope/c) exp(-c t).
  [[nodiscard]] double turn() const {
    const double rate = force_ - c_ * speed_;
    if (k_ > 0) return turn_of_spring(rate + 0.0, slope_ - k_ * speed_);  // -0 is another angle
    if (rate == 0 || slope_ == 0 || (rate > 0) == (slope_ > 0)) return kInfinity;
    const double time = -rate / slope_;
    return c_ > 0 ? std::log1p(c_ * time) / c_ : time;
  }

 private:
  // u' = rate g_0 + change g_1. At the end of the last step it was 0 up to rounding.
  [[nodiscard]] double turn_of_spring(double rate, double change) const {
    const double h = c_ / 2, d = k_ - h * h, root = std::sqrt(k_),
                 w = std::max(std::sqrt(std::abs(d)), Kernel::kCritical * root),
                 other = (change - h * rate) / w, now = 1e-9 / (c_ + root);
    if (d <= 0) {
      const double tangent = -rate / other, time = std::atanh(tangent) / w;
      return tangent < 1 && time > now ? time : kInfinity;
    }
    double time = std::atan2(rate, -other) / w;
    while (time <= now) time += std::numbers::pi / w;
    return time;
  }

  double c_, k_, speed_, force_, slope_, reach_;
};

constexpr std::size_t kTerms = 14;

/// u' = force + slope t + b(u) - K q, b a polynomial: u(t) - u(0) = sum_{n=1}^{14} x_n t^n.
class SeriesStep {
 public:
  SeriesStep(const DragPanel& panel, double k, double speed, double force, double slope,
             double room, double stride)
      : panel_(panel), speed_(speed), reach_(room) {
    auto b = panel.coefficient;
    const double shift = speed - panel.centre;
    for (std::size_t p = 0; p + 1 < kDragTerms; ++p) {
      for (std::size_t n = kDragTerms - 1; n-- > p;) b[n] += shift * b[n + 1];
    }
    std::array<std::array<double, kTerms>, kDragTerms> power{};  // [p][n]: of t^n in (u - u(0))^p
    x_[1] = force + b[0];
    for (std::size_t n = 1; n < kTerms; ++n) {
      power[1][n] = x_[n];
      double sum = b[1] * x_[n] + (n == 1 ? slope : 0);
      for (std::size_t p = 2; p < kDragTerms && p <= n; ++p) {
        for (std::size_t m = 1; m + p <= n + 1; ++m) power[p][n] += x_[m] * power[p - 1][n - m];
        sum += b[p] * power[p][n];
      }
      sum -= k * (n == 1 ? speed : x_[n - 1] / static_cast<double>(n));
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
  [[nodiscard]] Moved at(double t) const {
    double sum = 0, mean = 0;
    for (std::size_t n = kTerms; n > 0; --n) {
      sum = (sum + x_[n]) * t;
      mean = (mean + x_[n] / static_cast<double>(n + 1)) * t;
    }
    return {speed_ + sum, t * (speed_ + mean)};
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

}  // namespace

Slider::Slider(const model::Process& process, double stride)
    : k_(process.stiffness),
      stride_(stride),
      negligible_(k_ > 0 ? kRounding * process.friction.mu_s : -kInfinity) {
  process.drag.is_linear() ? void(c_ = process.drag.linear) : void(table_.emplace(process.drag));
}

Slide Slider::slide(double speed, double force, double slope, double time, bool integrals) const {
  Slide slide{{.end = speed}, speed};
  while (!slide.stopped && slide.time < time) {
    const double now = force + slope * slide.time - k_ * slide.path, room = time - slide.time;
    if (table_) {
      step(SeriesStep(table_->at(slide.end), k_, slide.end, now, slope, room, stride_), now, slope,
           time, integrals, slide);
    } else {
      const double reach = integrals ? std::min(room, kSmooth / (c_ + std::sqrt(k_))) : room;
      step(LinearStep(c_, k_, slide.end, now, slope, reach), now, slope, time, integrals, slide);
    }
  }
  return slide;
}

// A body that creeps towards where the spring holds it never stops, whatever rounding leaves of its
// speed.
template <class Step>
void Slider::step(const Step& step, double force, double slope, double end, bool integrals,
                  Slide& slide) const {
  const double room = end - slide.time;
  double h = std::min(step.reach(), step.turn());
  if (slide.time + h == slide.time) h = step.reach();  // it turns here, up to rounding
  double next = step.at(h).u;
  const bool ends = next <= 0 && next < slide.end && step.end_towards(next) == 0;
  if (ends || step.leaves(next)) {
    const double bound = step.end_towards(next),
                 there = root([&](double t) { return step.at(t).u - bound; }, h);
    slide.stopped = ends && force + slope * there - k_ * step.at(there).q < -negligible_;
    if (slide.stopped || !ends) h = there;
    next = bound;
  }
  if (integrals) integrate(step, h, slide);
  slide.path += step.at(h).q;
  slide.time = h == room ? end : slide.time + h;
  slide.end = std::max(next, 0.0);
  slide.peak = std::max(slide.peak, slide.end);
}

template <class Step>
void Slider::integrate(const Step& step, double h, Slide& slide) {
  using Rule = boost::math::quadrature::gauss<double, 6>;
  for (std::size_t n = 0; n < Rule::abscissa().size(); ++n) {
    for (double side : {-1.0, 1.0}) {
      const double t = h / 2 * (1 + side * Rule::abscissa()[n]), w = h / 2 * Rule::weights()[n];
      const auto [u, along] = step.at(t);
      const double q = slide.path + along;
      slide.square += w * u * u;
      slide.place += w * q;
      slide.place_square += w * q * q;
    }
  }
}

}  // namespace stickslip::simulation
