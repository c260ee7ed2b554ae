#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <functional>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

#include "slide.hpp"
#include "stickslip/base/text.hpp"
#include "stickslip/linalg/dense.hpp"
#include "stickslip/simulation/walk.hpp"

namespace stickslip::simulation {
namespace {

using Dense = linalg::Matrix<double>;

/// X = deviation Z_1 of dZ = -A Z dt + b dW, driven by one Wiener process. With p = E[Z Z^T] the
/// covariance of X is that of the noise where p e_1 = e_1, and A p + p A^T = b b^T. With A = ((a,
/// r), (q, s)) that leaves a Riccati equation for the other rows and columns P of p,
///
///   s P + P s^T = (P r^T + q) (P r^T + q)^T/(2 a),
///
/// solved by the eigenvectors of its Hamiltonian matrix. A + A^T need not be positive.
struct Driven {
  Dense a, p;
  std::vector<double> b;

  explicit Driven(const Dense& matrix) : a(matrix), p(Dense::identity(a.rows())) {
    const int n = a.rows() - 1;
    const double twice = 2 * a(0, 0);
    if (n > 0) solve(n, twice);
    for (int i = 0; i <= n; ++i) {
      double sum = a(i, 0);
      for (int k = 0; k <= n; ++k) sum += p(i, k) * a(0, k);
      b.push_back(sum / std::sqrt(twice));
    }
  }

 private:
  void solve(int n, double twice) {
    using Complex = std::complex<double>;
    linalg::Matrix<Complex> h(2 * n, 2 * n);
    for (int i = 0; i < n; ++i) {
      for (int k = 0; k < n; ++k) {
        const double f = a(i + 1, k + 1) - a(i + 1, 0) * a(0, k + 1) / twice;
        h(k, i) = f;
        h(n + i, n + k) = -f;
        h(i, n + k) = -a(0, i + 1) * a(0, k + 1) / twice;
        h(n + i, k) = a(i + 1, 0) * a(k + 1, 0) / twice;
      }
    }
    const linalg::Eigenvectors eigen(h);
    std::vector<int> order(static_cast<std::size_t>(2 * n));
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, std::greater<>(), [&](int k) { return eigen.value[k].real(); });
    linalg::Matrix<Complex> upper(n, n), lower(n, n);  // P = lower upper^-1, transposed
    for (int k = 0; k < n; ++k) {
      for (int i = 0; i < n; ++i) {
        upper(k, i) = eigen.right(i, order[k]);
        lower(k, i) = eigen.right(n + i, order[k]);
      }
    }
    const auto found = linalg::LuFactors<Complex>(upper).solved(lower);
    for (int i = 0; i < n; ++i) {
      for (int k = 0; k < n; ++k) p(i + 1, k + 1) = (found(i, k) + found(k, i)).real() / 2;
    }
  }
};

/// L with L L^T = m for a covariance; what rounding leaves of a variance counts as none.
Dense root_of(const Dense& m) {
  constexpr double rounding = 1e-13;
  Dense l(m.rows(), m.rows());
  for (int c = 0; c < m.rows(); ++c) {
    const auto rest = [&](int r) {
      double sum = m(r, c);
      for (int k = 0; k < c; ++k) sum -= l(r, k) * l(c, k);
      return sum;
    };
    const double variance = rest(c);
    if (variance <= rounding * m(c, c)) continue;
    for (int r = c; r < m.rows(); ++r) l(r, c) = rest(r) / std::sqrt(variance);
  }
  return l;
}

/// (Z, int X dt) over a time, given Z at its start: `rows` has for each of them the d factors of Z,
/// and those of as many normal numbers as there are rows up to this one.
struct Step {
  double time, root;  ///< and its square root
  std::vector<double> rows;
};

/// Steps of the times shortest 2^k. The covariance of the shortest one is a series, in which
/// nothing cancels; of two in a row it is a sum.
std::vector<Step> steps_of(const Driven& noise, double deviation, double shortest, int count) {
  const int n = noise.a.rows() + 1;
  Dense m(n, n), term(n, n), covariance(n, n);
  for (int i = 0; i + 1 < n; ++i) {
    for (int k = 0; k + 1 < n; ++k) {
      m(i, k) = -noise.a(i, k);
      term(i, k) = noise.b[i] * noise.b[k] * shortest;
    }
  }
  m(n - 1, 0) = deviation;
  const auto transpose = transposed(m);
  for (int k = 2; k < 12; ++k) {
    covariance += term;
    term = shortest / k * (m * term + term * transpose);
  }
  std::vector<Step> steps;
  Dense moved = linalg::exponential(m, shortest);
  for (double time = shortest; count-- > 0; time *= 2) {
    auto& rows = steps.emplace_back(Step{time, std::sqrt(time), {}}).rows;
    const Dense spread = root_of(covariance);
    for (int r = 0; r < n; ++r) {
      for (int c = 0; c + 1 < n; ++c) rows.push_back(moved(r, c));
      for (int c = 0; c <= r; ++c) rows.push_back(spread(r, c));
    }
    covariance += moved * covariance * transposed(moved);
    moved = moved * moved;
  }
  return steps;
}

/// When a Brownian bridge of this variance in all first comes to a level, given that it does, from
/// `before` away from it to `after` away on either side, as a share of its time: xi/(1 + xi), with
/// xi of the inverse normal distribution (by Michael, Schucany and Haas, The American Statistician
/// 30, 1976).
double arrival(RandomStream& random, double before, double after, double variance) {
  const double mean = before / std::max(after, 1e-9 * std::sqrt(variance)),
               normal = random.normal(),
               w = mean * normal * normal * variance / (2 * before * before),
               least = mean / (1 + w + std::sqrt(w * (2 + w))),
               xi = random.uniform() * (mean + least) <= mean ? least : mean * mean / least;
  return xi / (1 + xi);
}

// How paths are cut into steps and samples.

constexpr double kLongest = 0.05;  // step, in the time of the fastest change
constexpr int kHalvings = 14,      // of it, to the shortest one
    kAtRest = kHalvings - 6, kAtStops = kHalvings - 4;
constexpr double kDeviations = 4;  // by which the noise has to miss a change of sign within a step
constexpr double kRoom = 2;        // and the threshold in a step at rest that need not be short
constexpr double kClear = 8;       // times what it has to miss is the force in which bodies stop
constexpr double kMemories = 8;    // that a path forgets before a sample, which lasts as long

struct Scales {
  double fastest;  // rate [1/time]
  double memory;   // time [time]
};

Scales scales_of(const model::Process& process) {
  const auto& noise = process.noise;
  const double root = std::sqrt(process.stiffness);
  double slowest = 1 / noise.correlation_time(), fastest = noise.rate(),
         deviation = noise.standard_deviation(), strength = noise.intensity();
  if (noise.gaussian) {
    slowest = std::ranges::min(noise.gaussian->terms(), {}, &model::CovarianceTerm::decay).decay;
    fastest = noise.gaussian->matrix().largest();
    deviation = noise.gaussian->deviation();
    strength = noise.gaussian->power_spectral_density(0) / 2;
  }
  const auto& [drag, friction] = std::tie(process.drag, process.friction);
  const double speed = drag.terminal_velocity(3 * deviation),
               slope = std::isfinite(speed) ? drag.steepest(speed) : 0,
               loss = std::isfinite(speed) ? -drag(speed) / speed : 0;
  // Under dry friction mu alone white noise of strength 2 D forgets its velocity at mu^2/(4 D).
  const double least = std::min(friction.mu_d, friction.mirrored().mu_d),
               bias = process.stiffness > 0 ? 0 : std::abs(process.bias),
               held = std::max(least - bias, 0.0),
               by_friction = held * held / (4 * std::max(strength, 1e-300));
  if (process.stiffness == 0) return {fastest + slope, 1 / slowest + 1 / (loss + by_friction)};
  // The amplitude of an oscillation falls half as fast as its energy; an overdamped body creeps.
  const double decay = loss + std::min(by_friction, root);
  return {fastest + slope + root, 1 / slowest + 2 / decay + decay / process.stiffness};
}

/// Paths by exact Gaussian steps. While a body rests they end where static friction is overcome, by
/// the law of a Brownian bridge. While it slides the force within a step is its mean, and steps
/// shorten until the noise can turn neither the speed within them nor, where the body stops,
/// the force; or down to the shortest step.
template <class Flow>
class GaussianSource final : public PathSource {
 public:
  GaussianSource(const model::Process& process, const Wanted& wanted)
      : PathSource(span_of_sample(process)),
        wanted_(wanted),
        noise_(process.noise.gaussian->matrix()),
        stationary_(root_of(noise_.p)),
        sides_{Side(process), Side(process.mirrored())},
        deviation_(process.noise.gaussian->deviation()),
        diffusion_(deviation_ * noise_.b[0]),
        size_(noise_.a.rows()),
        within_(process.friction.mu_s),
        stiffness_(process.stiffness),
        centre_(kTied<Flow> ? process.bias / process.stiffness : 0),
        now_(size_ + 1),
        before_(size_),
        normal_(size_ + 1) {
    const double longest = kLongest / scales_of(process).fastest;
    steps_ = steps_of(noise_, deviation_, std::ldexp(longest, -kHalvings), kHalvings + 1);
  }

  void draw(RandomStream& random, int level, double, Excursion& e) override {
    draw_from(level, random, e);
  }

 private:
  /// What a body that moves one way finds.
  struct Side {
    explicit Side(const model::Process& seen)
        : drag(seen.drag),
          flow(flow_of<Flow>(seen)),
          start(seen.friction.mu_s - seen.bias),
          balance(seen.friction.at_rest() - seen.bias) {}

    model::Drag drag;
    Flow flow;
    double start, balance;  ///< forces of the noise that overcome friction, at rest and in motion
  };
  [[nodiscard]] const Side& side(int sign) const { return sides_[sign > 0 ? 0 : 1]; }
  [[nodiscard]] double x() const { return deviation_ * now_[0]; }
  /// The force of the spring, against X.
  [[nodiscard]] double held() const { return kTied<Flow> ? stiffness_ * p_ : 0; }
  /// By how much static friction exceeds the force.
  [[nodiscard]] double room(int sign) const { return side(sign).start - sign * (x() - held()); }

  // From rest, with the noise in its stationary distribution.
  void begin(RandomStream& random) override {
    elapsed_ = k_ = 0;
    p_ = centre_;
    for (double& z : normal_) z = random.normal();
    std::fill(now_.begin(), now_.end(), 0.0);
    linalg::add_product(stationary_, normal_.data(), now_.data());
    Excursion none;
    none.integrals.resize(wanted_.observables.size());
    stick(random, none);
    if (kTied<Flow>) elapsed_ = 0;
  }

  void follow_one(RandomStream& random, Excursion& e) override {
    const double begun = elapsed_;
    e = {.integrals = std::move(e.integrals)};
    e.integrals.assign(wanted_.observables.size(), {});
    e.upwards = sign_ > 0;
    slide(random, e);
    stick(random, e);
    if (kTied<Flow>) elapsed_ = begun + e.slide;
  }

  void slide(RandomStream& random, Excursion& e) {
    for (double speed = 0;;) {
      choose_for(speed);
      const double from = x(), time = steps_[k_].time;
      double mean = step(random, true);
      const auto move = [&] {
        const double force = sign_ * (mean - held()) - side(sign_).balance;
        return side(sign_).flow.move(speed, force, time, wanted_.integrals);
      };
      auto piece = move();
      // The shortest steps end as they are, as the force may have turned in them.
      const bool cuts = piece.stopped && k_ > 0;
      if (cuts) {
        mean = from + (x() - from) * piece.time / (2 * time);
        piece = move();
        const double share = piece.time / time;
        cut(share, random.normal() * std::sqrt(piece.time * (1 - share)));
      }
      follow(e, piece, mean, x() - from, piece.end - speed);
      observe(random, e, &Integrals::slide, piece.time, {from, sign_ * speed},
              {x(), sign_ * piece.end}, sign_);
      speed = piece.end;
      if (!piece.stopped) continue;
      if (!cuts) rest(random, e, time - piece.time, x());
      if (room(-sign_) >= 0) return;
      sign_ = -sign_;  // pushed on the other way
    }
  }

  // The longest step in which neither the speed nor, where the body stops, the force turns.
  void choose_for(double speed) {
    const double force = sign_ * (x() - held()) - side(sign_).balance + side(sign_).drag(speed),
                 bend = std::min(sign_ * drift() - stiffness_ * speed, 0.0) / 2,
                 spread = kDeviations * diffusion_;
    choose([&](int k) {
      const auto& [h, root, rows] = steps_[k];
      const bool moves = speed + h * (force + h * bend - spread * root / std::sqrt(3)) > 0;
      return moves || (k <= kAtStops && kClear * spread * root < -force);
    });
  }

  // Until static friction is overcome.
  void stick(RandomStream& random, Excursion& e) {
    for (int sign : {1, -1}) {
      if (room(sign) < 0) return void(sign_ = sign);
    }
    for (double share = 2; share > 1;) {
      choose([&](int k) {
        return k <= kAtRest || std::min(room(1), room(-1)) > kRoom * diffusion_ * steps_[k].root;
      });
      const double from = x(), up = room(1), down = room(-1);
      step(random, false);
      const double upwards = starts(random, 1, up), downwards = starts(random, -1, down);
      share = std::min(upwards, downwards);
      if (share <= 1) {
        sign_ = upwards < downwards ? 1 : -1;
        const double there = (sign_ * side(sign_).start + held()) / deviation_;
        cut(share, (there - before_[0] - share * (now_[0] - before_[0])) / noise_.b[0]);
      }
      rest(random, e, std::min(share, 1.0) * steps_[k_].time, from);
      ++e.jumps;
    }
  }

  // The share of the last step after which static friction was overcome, which it exceeded the
  // force by `before`; 2 if it was not.
  double starts(RandomStream& random, int sign, double before) const {
    const double after = room(sign), variance = diffusion_ * diffusion_ * steps_[k_].time,
                 exponent = 2 * before * after / variance;
    if (after > 0 && (exponent > 40 || random.uniform() >= std::exp(-exponent))) return 2;
    return before > 0 ? arrival(random, before, std::abs(after), variance) : 0;
  }

  void rest(RandomStream& random, Excursion& e, double time, double from) {
    e.stick += time;
    if constexpr (kTied<Flow>) follow_position(e, p_, (from + x()) / 2, 0, {{.time = time}});
    observe(random, e, &Integrals::stick, time, {from, 0}, {x(), 0}, 0);
  }

  [[nodiscard]] double drift() const {
    double sum = 0;
    for (int i = 0; i < size_; ++i) sum -= noise_.a(0, i) * now_[i];
    return deviation_ * sum;
  }

  // The longest step that fits, or the shortest one.
  void choose(const auto& fits) {
    while (k_ < kHalvings && fits(k_ + 1)) ++k_;
    while (k_ > 0 && !fits(k_)) --k_;
  }

  // The mean of X over the step where it is wanted.
  double step(RandomStream& random, bool mean) {
    const Step& step = steps_[k_];
    const double* factor = step.rows.data();
    std::copy_n(now_.begin(), size_, before_.begin());
    for (int r = 0; r < size_ + (mean ? 1 : 0); ++r) {
      normal_[r] = random.normal();
      double sum = 0;
      for (int c = 0; c < size_; ++c) sum += *factor++ * before_[c];
      for (int c = 0; c <= r; ++c) sum += *factor++ * normal_[c];
      now_[r] = sum;
    }
    elapsed_ += step.time;
    return now_[size_] / step.time;
  }

  // Back to where a share of the last step was over, and W was off its chord.
  void cut(double share, double off) {
    for (int i = 0; i < size_; ++i) {
      now_[i] = before_[i] + share * (now_[i] - before_[i]) + noise_.b[i] * off;
    }
    elapsed_ -= (1 - share) * steps_[k_].time;
  }

  // The force also changed by `turn` along the piece, and the speed by `rise`.
  template <class Moved>
  void follow(Excursion& e, Moved piece, double mean, double turn, double rise) {
    const double bend = sign_ * turn * piece.time / 12, path = piece.path - bend * piece.time;
    ++e.jumps;
    e.peak = std::max(e.peak, piece.end);
    if constexpr (kTied<Flow>) {
      piece.path = path;
      e.place_noise += bend * path;
      follow_position(e, p_, mean, sign_, piece);
    }
    e.slide += piece.time;
    e.path += path;
    e.drift += sign_ * path;
    e.square += piece.square - 2 * bend * path;
    e.product += sign_ * mean * path + bend * rise;
  }

  struct At {
    double x, v;
  };
  // At a moment of a step, whose length depends on where it begins: what stands at its ends counts
  // too often where steps are long.
  void observe(RandomStream& random, Excursion& e, double Integrals::*part, double time,
               const At& from, const At& to, int y) {
    if (wanted_.observables.empty() && !wanted_.noise) return;
    const double share = random.uniform(), v = from.v + share * (to.v - from.v),
                 x = y == 0 ? at_rest(random, from.x, to.x, time, share)
                            : bridge(random, from.x, to.x, time, share);
    e.noise_square += time * x * x;
    e.within += std::abs(x) <= within_ ? time : 0;
    const double left = (1 - share) * time * (v + to.v) / 2;  // to where the step ends
    const model::Place place =
        kTied<Flow> ? model::Place{x, p_ - left - centre_, centre_} : model::Place{x};
    for (std::size_t f = 0; f < wanted_.observables.size(); ++f) {
      e.integrals[f].*part += time * wanted_.observables[f](place, y, v);
    }
  }

  [[nodiscard]] double spread(double time, double share) const {
    return diffusion_ * std::sqrt(time * share * (1 - share));
  }
  // Between the ends the noise is a Brownian bridge.
  [[nodiscard]] double bridge(RandomStream& random, double from, double to, double time,
                              double share) const {
    return from + share * (to - from) + spread(time, share) * random.normal();
  }

  // The same of a path that meets no threshold; or that ends on one, which it meets there for the
  // first time: its distance is a Bessel bridge of dimension 3.
  [[nodiscard]] double at_rest(RandomStream& random, double from, double to, double time,
                               double share) const {
    const std::array starts{side(1).start + held(), held() - side(-1).start};
    for (double start : starts) {
      if (std::abs(to - start) > 1e-9 * deviation_) continue;
      const double s = spread(time, share), away = (1 - share) * (from - start);
      return start + std::copysign(std::hypot(away + s * random.normal(), s * random.normal(),
                                              s * random.normal()),
                                   from - start);
    }
    // Where bodies come to rest beyond a threshold, as in the shortest steps they may, none fits.
    constexpr int tries = 100;
    const double variance = diffusion_ * diffusion_ * time;
    for (int n = 0; n < tries && variance > 0; ++n) {
      const double x = bridge(random, from, to, time, share);
      double kept = 1;
      for (double start : starts) {
        const auto missed = [&](double end, double part) {
          return 1 - std::exp(-2 * (start - x) * (start - end) / (part * variance));
        };
        kept *= std::max(missed(from, share), 0.0) * std::max(missed(to, 1 - share), 0.0);
      }
      if (random.uniform() < kept) return x;
    }
    return from;
  }

  Wanted wanted_;
  Driven noise_;
  Dense stationary_;
  std::array<Side, 2> sides_;
  double deviation_, diffusion_;
  int size_;
  double within_, stiffness_, centre_;
  std::vector<Step> steps_;
  std::vector<double> now_, before_, normal_;  // Z, and the integral of X over the last step
  double p_ = 0;
  int k_ = 0, sign_ = 1;
};

}  // namespace

void PathSource::draw_from(int level, RandomStream& random, Excursion& e) {
  if (level == kPathBegins) {
    begin(random);
    while (elapsed_ < span_) follow_one(random, e);
    end_ = span_ * (2 + std::floor((elapsed_ - span_) / span_));
  }
  follow_one(random, e);
  e.next = elapsed_ < end_ ? kPathBegins + 1 : kPathBegins;
}

double span_of_sample(const model::Process& process) {
  return kMemories * scales_of(process).memory;
}

std::unique_ptr<ExcursionSource> make_gaussian_source(const model::Process& process,
                                                      const Wanted& wanted) {
  return with_flow<GaussianSource>(process, wanted);
}

double steps_of_sample(const model::Process& process) {
  const auto [fastest, memory] = scales_of(process);
  if (!process.noise.gaussian) return 2 * kMemories * memory * process.noise.rate();
  const auto& friction = process.friction;
  const double scale = process.noise.gaussian->deviation() * std::sqrt(2),
               up = friction.mu_s - process.bias, down = friction.mirrored().mu_s + process.bias,
               beyond = (std::erfc(up / scale) + std::erfc(down / scale)) / 2;
  // What is rarely left, or rarely met, takes long.
  return std::max(2 * kMemories * memory * fastest, 1 / std::min(beyond, 1 - beyond)) / kLongest;
}

}  // namespace stickslip::simulation
