#include "stickslip/simulation/path.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "stickslip/simulation/flow.hpp"
#include "stickslip/simulation/random_stream.hpp"

namespace stickslip::simulation {
namespace {

// Far from the streams of excursions, which count from 0.
constexpr std::uint64_t kPathStream = std::numeric_limits<std::uint64_t>::max();

template <class Flow>
class Walker {
 public:
  Walker(const model::Process& process, int level, double v, std::uint64_t seed)
      : process_(process),
        mirrored_(process.mirrored()),
        flow_(process_.drag),
        backward_flow_(mirrored_.drag),
        random_(seed, kPathStream),
        lowest_(process.lowest_static()),
        highest_(process.static_index()),
        i_(level),
        speed_(std::abs(v)) {
    if (v != 0) y_ = v > 0 ? 1 : -1;
    start_if_pushed();
  }

  Path run(double horizon) {
    record();
    while (time_ < horizon) {
      const double jump = random_.exponential() / process_.noise.rate();
      move_to(std::min(horizon, time_ + jump));
      if (time_ >= horizon) break;
      jump_once();
      record();
    }
    record();
    return std::move(path_);
  }

 private:
  void record() {
    path_.time.push_back(time_);
    path_.x.push_back(process_.noise.level(i_));
    path_.y.push_back(y_);
    path_.v.push_back(y_ * speed_);
  }

  void start_if_pushed() {
    if (y_ == 0 && (i_ < lowest_ || i_ > highest_)) y_ = i_ > highest_ ? 1 : -1;
  }

  void move_to(double end) {
    while (y_ != 0 && time_ < end) {
      const Piece piece = move_on(end - time_);
      speed_ = piece.end;
      if (!piece.stopped) break;
      time_ += piece.time;
      y_ = 0;
      start_if_pushed();
      record();
    }
    time_ = end;
  }

  [[nodiscard]] Piece move_on(double time) const {
    if (y_ > 0) return flow_.move(speed_, process_.net_force(i_), time, false);
    return backward_flow_.move(speed_, mirrored_.net_force(-i_), time, false);
  }

  void jump_once() {
    const double up = process_.noise.up(i_);
    i_ += random_.half_word() * 0x1p-32 < up ? 1 : -1;
    start_if_pushed();
  }

  model::Process process_, mirrored_;
  Flow flow_, backward_flow_;
  RandomStream random_;
  int lowest_, highest_, i_, y_ = 0;
  double speed_, time_ = 0;
  Path path_;
};

}  // namespace

Path simulate_path(const model::Process& process, int level, double v, double horizon,
                   std::uint64_t seed) {
  if (process.drag.is_linear()) return Walker<LinearFlow>(process, level, v, seed).run(horizon);
  return Walker<GeneralFlow>(process, level, v, seed).run(horizon);
}

}  // namespace stickslip::simulation
