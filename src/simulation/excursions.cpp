#include "stickslip/simulation/excursions.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>

#include "stickslip/simulation/flow.hpp"

namespace stickslip::simulation {
namespace {

/// The noise and the forces in tables over the levels that occur.
class Levels {
 public:
  explicit Levels(const model::Process& process)
      : lowest_(process.lowest_static()),
        highest_(process.static_index()),
        within_(process.threshold_index()),
        reach_(reach(process)),
        mean_wait_(1 / process.noise.rate()) {
    const auto mirrored = process.mirrored();
    for (int i = -reach_; i <= reach_; ++i) {
      level_.push_back(process.noise.level(i));
      upper_force_.push_back(process.net_force(i));
      lower_force_.push_back(mirrored.net_force(i));
      // 2^-32 is far below what any number of excursions resolves.
      up_.push_back(static_cast<std::uint64_t>(std::llround(process.noise.up(i) * 0x1p32)));
    }
  }

  [[nodiscard]] bool rests(int i) const { return lowest_ <= i && i <= highest_; }
  [[nodiscard]] bool within(int i) const { return std::abs(i) <= within_; }
  /// The first level beyond those that rest, along a direction of motion.
  [[nodiscard]] int exit(int sign) const { return 1 + (sign > 0 ? highest_ : -lowest_); }
  [[nodiscard]] double level(int i) const { return level_[at(i)]; }
  /// Acceleration at v = 0 of a body that moves upwards, by i, or downwards, by -i.
  [[nodiscard]] double force(int sign, int along) const {
    return (sign > 0 ? upper_force_ : lower_force_)[at(along)];
  }
  [[nodiscard]] double wait(RandomStream& random) const {
    return mean_wait_ * random.exponential();
  }
  [[nodiscard]] int next(int i, RandomStream& random) const {
    const int next = i + (random.half_word() < up_[at(i)] ? 1 : -1);
    if (std::abs(next) > reach_) throw std::runtime_error("the noise left 40 deviations");
    return next;
  }

 private:
  // The noise passes 40 standard deviations with probability exp(-800).
  static int reach(const model::Process& process) {
    const double far = 40 / (std::sqrt(process.noise.tau) * process.noise.delta);
    const int edge = std::max(process.static_index(), -process.lowest_static());
    const double most = std::min<double>(process.noise.levels, edge + 2 + far);
    return static_cast<int>(most);
  }
  [[nodiscard]] std::size_t at(int i) const {
    const int place = i + reach_;
    return static_cast<std::size_t>(place);
  }

  int lowest_, highest_, within_, reach_;
  double mean_wait_;
  std::vector<double> level_, upper_force_, lower_force_;
  std::vector<std::uint64_t> up_;  // alpha_i in units of 2^-32
};

/// In the frame of the motion: speed u = |V| >= 0, level j = i sign(V).
template <class Flow>
class Source : public ExcursionSource {
 public:
  Source(const model::Process& process, const Wanted& wanted)
      : levels_(process),
        flow_(process.drag),
        backward_flow_(process.mirrored().drag),
        wanted_(wanted),
        symmetric_(process.symmetric()) {
    piece_transform_.resize(wanted.omega.size());
    phase_.resize(wanted.omega.size());
  }

  void draw(RandomStream& random, std::size_t side, double place, Excursion& e) override {
    e = {.transform = std::move(e.transform),
         .integrals = std::move(e.integrals),
         .discounted = std::move(e.discounted)};
    e.transform.assign(wanted_.omega.size(), 0.0);
    e.integrals.assign(wanted_.observables.size(), {});
    e.discounted.assign(wanted_.observables.size() * wanted_.discount.size(), {});
    std::fill(phase_.begin(), phase_.end(), 1.0);
    place_ = place;
    double wait = levels_.wait(random);
    slide(random, e, wait, side == 0 ? 1 : -1);
    sticking(random, e, wait);
    if (side == 1) e.turned = !e.turned;
  }

 private:
  // Until rest; `wait` is the time to the next jump of the noise.
  void slide(RandomStream& random, Excursion& e, double& wait, int sign) {
    const bool integrals = wanted_.moments || wanted_.displacement || !wanted_.omega.empty();
    int j = levels_.exit(sign);
    double speed = 0;
    for (;;) {
      const double force = levels_.force(sign, j);
      const Piece piece = flow(sign).move(speed, force, wait, integrals);
      if (!wanted_.observables.empty()) observe_slide(e, piece.time, speed, j, sign);
      follow(e, piece, j, sign);
      if (!wanted_.omega.empty()) follow_transform(e, piece, speed, force, sign);
      speed = piece.end;
      if (!piece.stopped) {
        j = levels_.next(j, random);
        wait = levels_.wait(random);
        ++e.jumps;
        continue;
      }
      wait -= piece.time;
      if (levels_.rests(sign * j)) break;
      j = -j;  // pushed on the other way
      sign = -sign;
    }
    e.entry = sign * j;
  }

  [[nodiscard]] const Flow& flow(int sign) const { return sign > 0 ? flow_ : backward_flow_; }

  void follow(Excursion& e, const Piece& piece, int j, int sign) const {
    e.slide += piece.time;
    e.path += piece.path;
    e.drift += sign * piece.path;
    e.square += piece.square;
    const double x = levels_.level(j);
    e.product += x * piece.path;
    if (wanted_.noise) follow_noise(e, j, piece.time);
  }

  void follow_noise(Excursion& e, int i, double time) const {
    e.noise_square += levels_.level(i) * levels_.level(i) * time;
    if (levels_.within(i)) e.within += time;
  }

  void follow_transform(Excursion& e, const Piece& piece, double speed, double force, int sign) {
    flow(sign).transform(speed, force, piece, wanted_.omega, piece_transform_);
    for (std::size_t n = 0; n < phase_.size(); ++n) {
      e.transform[n] += static_cast<double>(sign) * phase_[n] * piece_transform_[n];
      phase_[n] *= std::polar(1.0, -wanted_.omega[n] * piece.time);
    }
  }

  // Places along the golden ratio spread evenly, and each is uniformly distributed.
  void observe_slide(Excursion& e, double time, double speed, int j, int sign) {
    place_ = std::fmod(place_ + 0.6180339887498949, 1);
    const double at = place_ * time;
    const double then = flow(sign).move(speed, levels_.force(sign, j), at, false).end;
    observe(e, &Integrals::slide, time, at, sign * levels_.level(j), sign, sign * then);
  }

  // A piece of `time`, with the state at `at` after its start; at rest nothing changes.
  void observe(Excursion& e, double Integrals::*part, double time, double at, double x, double y,
               double v) const {
    const double begun = e.slide + e.stick;
    for (std::size_t f = 0; f < wanted_.observables.size(); ++f) {
      const double value = wanted_.observables[f](x, y, v);
      const double mirrored = symmetric_ ? wanted_.observables[f](-x, -y, -v) : value;
      e.integrals[f].*part += time * (value + mirrored) / 2;
      for (std::size_t l = 0; l < wanted_.discount.size(); ++l) {
        const double lambda = wanted_.discount[l];
        const double weight =
            y == 0 ? time * detail::phi_one(lambda * time) * std::exp(-lambda * begun)
                   : time * std::exp(-lambda * (begun + at));
        auto& discounted = e.discounted[l * wanted_.observables.size() + f];
        discounted.value += weight * value;
        discounted.mirrored += weight * mirrored;
      }
    }
  }

  // Until the static levels are left.
  void sticking(RandomStream& random, Excursion& e, double wait) const {
    int i = e.entry;
    for (;;) {
      if (!wanted_.observables.empty()) {
        observe(e, &Integrals::stick, wait, 0, levels_.level(i), 0, 0);
      }
      e.stick += wait;
      if (wanted_.noise) follow_noise(e, i, wait);
      i = levels_.next(i, random);
      ++e.jumps;
      if (!levels_.rests(i)) break;
      wait = levels_.wait(random);
    }
    e.turned = i < e.entry;
  }

  Levels levels_;
  Flow flow_, backward_flow_;
  Wanted wanted_;
  bool symmetric_;
  double place_ = 0;
  std::vector<std::complex<double>> piece_transform_, phase_;
};

}  // namespace

std::unique_ptr<ExcursionSource> make_source(const model::Process& process, const Wanted& wanted) {
  if (process.drag.is_linear()) return std::make_unique<Source<LinearFlow>>(process, wanted);
  return std::make_unique<Source<GeneralFlow>>(process, wanted);
}

}  // namespace stickslip::simulation
