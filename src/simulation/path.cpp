#include "stickslip/simulation/path.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <optional>

#include "stickslip/simulation/any_jumps.hpp"
#include "stickslip/simulation/flow.hpp"
#include "stickslip/simulation/rise_time.hpp"
#include "stickslip/support/infinity.hpp"

namespace stickslip::simulation {
namespace {

// Far from the streams of excursions, which count from 0.
constexpr std::uint64_t kPathStream = std::numeric_limits<std::uint64_t>::max();

template <class Flow>
class Walker : public Walk {
 public:
  Walker(const model::Process& process, bool travel)
      : process_(process),
        mirrored_(process.mirrored()),
        flow_(process_.drag),
        backward_flow_(mirrored_.drag),
        travel_(travel),
        lowest_(process.lowest_static()),
        highest_(process.highest_static()) {
    if (!process.noise.neighbours_only()) any_.emplace(process.noise);
  }

  void begin(const RandomStream& random, const model::Start& start) override {
    random_ = random;
    i_ = start.kind == model::Start::Kind::rest ? stationary_level() : start.level;
    speed_ = std::abs(start.v);
    y_ = start.v == 0 ? 0 : (start.v > 0 ? 1 : -1);
    time_ = jumps_ = displacement_ = 0;
    start_if_pushed();
    wait();
  }

  void step(double limit) override {
    const double end = std::min(limit, next_jump_);
    if (y_ != 0) {
      const Piece piece = move_on(end - time_);
      speed_ = piece.end;
      displacement_ += y_ * piece.path;
      if (piece.stopped) {
        time_ += piece.time;
        y_ = 0;
        return start_if_pushed();
      }
    }
    time_ = end;
    if (end < next_jump_) return;
    if (any_) {
      i_ = any_->next(i_, random_);
    } else {
      i_ += random_.half_word() * 0x1p-32 < process_.noise.up(i_) ? 1 : -1;
    }
    ++jumps_;
    start_if_pushed();
    wait();
  }

  [[nodiscard]] double passes(model::Passage passage, double speed) const override {
    if (!model::has_passed(passage, y_ * speed, speed)) return kInfinity;  // the other side, rest
    if (speed_ >= speed) return time_;
    const double wait = next_jump_ - time_;
    if (y_ > 0) return time_ + rise_time(flow_, speed_, process_.net_force(i_), wait, speed);
    return time_ + rise_time(backward_flow_, speed_, mirrored_.net_force(-i_), wait, speed);
  }

  [[nodiscard]] State state() const override {
    return {time_, process_.noise.level(i_), static_cast<double>(y_), y_ * speed_, displacement_};
  }
  [[nodiscard]] double jumps() const override { return jumps_; }
  [[nodiscard]] int level() const override { return i_; }

 private:
  [[nodiscard]] int stationary_level() {
    if (!noise_) noise_.emplace(process_.noise);
    return noise_->draw(random_.uniform());
  }
  void start_if_pushed() {
    if (y_ == 0 && (i_ < lowest_ || i_ > highest_)) y_ = i_ > highest_ ? 1 : -1;
  }
  void wait() { next_jump_ = time_ + random_.exponential() / process_.noise.rate(i_); }

  [[nodiscard]] Piece move_on(double time) const {
    if (y_ > 0) return flow_.move(speed_, process_.net_force(i_), time, travel_);
    return backward_flow_.move(speed_, mirrored_.net_force(-i_), time, travel_);
  }

  model::Process process_, mirrored_;
  Flow flow_, backward_flow_;
  std::optional<NoiseLevels> noise_;  // where it has been of use
  std::optional<AnyJumps> any_;
  RandomStream random_{0, 0};
  bool travel_;
  int lowest_, highest_, i_ = 0, y_ = 0;
  double speed_ = 0, time_ = 0, next_jump_ = 0, jumps_ = 0, displacement_ = 0;
};

// The same numbers again up to a time of the first thousand excursions.
void begin_stationary(Walk& walk, const model::Process& process, RandomStream& random) {
  constexpr int excursions = 1000;
  const double share = random.uniform();
  if (!process.sticks()) {
    walk.begin(random, {.kind = model::Start::Kind::rest});
    walk.advance(excursions * (1 + share) * process.noise.correlation_time());
    return;
  }
  const model::Start start{process.exit_level(true)};
  walk.begin(random, start);
  for (int n = 0; n < excursions; ++n) walk.end_excursion();
  const double time = share * walk.state().time;
  walk.begin(random, start);
  walk.advance(time);
}

}  // namespace

State Walk::advance(double time) {
  while (state().time < time) step(time);
  return state();
}

double Walk::end_excursion() {
  bool rested = false;
  for (;; step(kInfinity)) {
    const State now = state();
    if (rested && now.y != 0) return now.time;
    rested = rested || now.y == 0;
  }
}

std::unique_ptr<Walk> make_walk(const model::Process& process, bool travel) {
  if (process.drag.is_linear()) return std::make_unique<Walker<LinearFlow>>(process, travel);
  return std::make_unique<Walker<GeneralFlow>>(process, travel);
}

NoiseLevels::NoiseLevels(const model::NoiseChain& noise)
    : lowest_(noise.lowest()), below_(model::stationary_distribution(noise)) {
  std::partial_sum(below_.begin(), below_.end(), below_.begin());
}

int NoiseLevels::draw(double uniform) const {
  const auto found = std::upper_bound(below_.begin(), below_.end() - 1, uniform * below_.back());
  return lowest_ + static_cast<int>(found - below_.begin());
}

Path simulate_path(const model::Process& process, const model::Start& start, double horizon,
                   std::uint64_t seed) {
  const auto walk = make_walk(process);
  RandomStream random(seed, kPathStream);
  if (start.kind == model::Start::Kind::stationary) {
    begin_stationary(*walk, process, random);
  } else {
    walk->begin(random, start);
  }
  Path path;
  const double begun = walk->state().time, end = begun + horizon;
  const auto record = [&] {
    const State now = walk->state();
    path.time.push_back(now.time < end ? now.time - begun : horizon);
    path.x.push_back(now.x);
    path.y.push_back(now.y);
    path.v.push_back(now.v);
  };
  for (record(); walk->state().time < end; record()) walk->step(end);
  return path;
}

}  // namespace stickslip::simulation
