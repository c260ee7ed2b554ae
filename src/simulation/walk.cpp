#include "stickslip/simulation/walk.hpp"

#include <cmath>
#include <cstdlib>
#include <numeric>
#include <stdexcept>

#include "slide.hpp"

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

/// The noise and the forces in tables over the levels that occur.
class Levels {
 public:
  explicit Levels(const model::Process& process)
      : lowest_(process.lowest_static()),
        highest_(process.highest_static()),
        least_within_(process.noise.first_from(-process.friction.mu_s)),
        most_within_(process.noise.last_up_to(process.friction.mu_s)),
        begin_(std::max(process.noise.lowest(), -reach(process))),
        end_(std::min(process.noise.highest(), reach(process))) {
    const auto mirrored = process.mirrored();
    for (int i = begin_; i <= end_; ++i) {
      // 2^-32 is far below what any number of excursions resolves.
      const auto threshold = [](double p) {
        return static_cast<std::uint64_t>(std::llround(p * 0x1p32));
      };
      levels_.push_back({process.noise.level(i),
                         1 / process.noise.rate(i),
                         {process.net_force(i), mirrored.net_force(-i)},
                         {threshold(process.noise.up(i)), threshold(process.noise.down(i))}});
    }
    if (!process.noise.neighbours_only()) any_.emplace(process.noise);
  }

  [[nodiscard]] bool rests(int i) const { return lowest_ <= i && i <= highest_; }
  [[nodiscard]] bool within(int i) const { return least_within_ <= i && i <= most_within_; }
  [[nodiscard]] bool is_below(int i) const { return i < lowest_; }
  [[nodiscard]] int direction(int exit) const { return exit > highest_ ? 1 : -1; }
  [[nodiscard]] double level(int i) const { return at(i).x; }
  /// Acceleration along the motion at v = 0 of a body that moves upwards or downwards.
  [[nodiscard]] double force(int sign, int i) const { return at(i).force[sign > 0 ? 0 : 1]; }
  [[nodiscard]] double wait(int i, RandomStream& random) const {
    return at(i).mean_wait * random.exponential();
  }
  /// The level after a jump. Drawn along the motion, so that mirror images take the same numbers.
  [[nodiscard]] int next(int i, int sign, RandomStream& random) const {
    if (any_) return any_->next(i, random);
    const bool onwards = random.half_word() < at(i).onwards[sign > 0 ? 0 : 1];
    const int next = onwards ? i + sign : i - sign;
    if (next < begin_ || next > end_) throw std::runtime_error("the noise left 40 deviations");
    return next;
  }

 private:
  // The noise passes 40 standard deviations with probability exp(-800).
  static int reach(const model::Process& process) {
    const auto& noise = process.noise;
    const double far = 40 * noise.standard_deviation() / noise.step();
    const int edge = std::max(process.highest_static(), -process.lowest_static());
    const double all = std::max(-noise.lowest(), noise.highest());
    return static_cast<int>(noise.table ? all : std::min(all, edge + 2 + far));
  }
  // What motions upwards and downwards find on a level.
  struct Level {
    double x, mean_wait;
    std::array<double, 2> force;
    std::array<std::uint64_t, 2> onwards;  // probabilities of jumps, in units of 2^-32
  };
  [[nodiscard]] const Level& at(int i) const {
    const int place = i - begin_;
    return levels_[static_cast<std::size_t>(place)];
  }

  int lowest_, highest_, least_within_, most_within_;
  int begin_, end_;  // of the tables, the end included
  std::vector<Level> levels_;
  std::optional<AnyJumps> any_;
};

/// Speeds are |V| >= 0.
template <class Flow>
class Source final : public PathSource {
 public:
  Source(const model::Process& process, const Wanted& wanted)
      : PathSource(kTied<Flow> ? span_of_sample(process) : 0),
        levels_(process),
        flow_(flow_of<Flow>(process)),
        backward_flow_(flow_of<Flow>(process.mirrored())),
        stiffness_(process.stiffness),
        centre_(kTied<Flow> ? process.mean_force() / process.stiffness : 0),
        highest_(process.friction.mu_s - process.bias),
        lowest_(-process.mirrored().friction.mu_s - process.bias),
        wanted_(wanted),
        symmetric_(process.symmetric()) {
    piece_transform_.resize(wanted.omega.size());
    phase_.resize(wanted.omega.size());
    if (kTied<Flow>) at_start_.emplace(process.noise);
  }

  void draw(RandomStream& random, int level, double place, Excursion& e) override {
    place_ = place;
    draw_from(level, random, e);
    e.turned = levels_.is_below(e.next) != levels_.is_below(level);
  }

  void draw_from(int level, RandomStream& random, Excursion& e) override {
    if constexpr (kTied<Flow>) return PathSource::draw_from(level, random, e);
    i_ = level;
    follow_one(random, e);
  }

 private:
  // From rest where the spring holds the body without force.
  void begin(RandomStream& random) override {
    i_ = at_start_->draw(random.uniform());
    elapsed_ = 0;
    p_ = centre_;
    while (rests(i_)) i_ = levels_.next(i_, 1, random);
  }

  void follow_one(RandomStream& random, Excursion& e) override {
    e = {.transform = std::move(e.transform),
         .integrals = std::move(e.integrals),
         .discounted = std::move(e.discounted)};
    e.transform.assign(wanted_.omega.size(), 0.0);
    e.integrals.assign(wanted_.observables.size(), {});
    e.discounted.assign(wanted_.observables.size() * wanted_.discount.size(), {});
    std::fill(phase_.begin(), phase_.end(), 1.0);
    e.start = e.entry = i_;
    e.upwards = direction(i_) > 0;
    double wait = levels_.wait(i_, random);
    if (!rests(i_)) slide(random, e, wait, i_);
    elapsed_ += e.slide;
    sticking(random, e, wait);
    i_ = e.next;
  }

  /// The force of noise and spring.
  [[nodiscard]] double pull(int i) const { return levels_.level(i) - stiffness_ * p_; }
  [[nodiscard]] bool rests(int i) const {
    if constexpr (!kTied<Flow>) return levels_.rests(i);
    return lowest_ <= pull(i) && pull(i) <= highest_;
  }
  [[nodiscard]] int direction(int i) const {
    return kTied<Flow> ? (pull(i) > highest_ ? 1 : -1) : levels_.direction(i);
  }
  [[nodiscard]] double force(int sign, int i) const {
    const double noise = levels_.force(sign, i);
    return kTied<Flow> ? noise - sign * stiffness_ * p_ : noise;
  }

  // Until rest; `wait` is the time to the next jump of the noise.
  void slide(RandomStream& random, Excursion& e, double& wait, int i) {
    int sign = direction(i);
    double speed = 0;
    for (;;) {
      const double force = this->force(sign, i);
      const auto piece = flow(sign).move(speed, force, wait, wanted_.integrals);
      if (!wanted_.observables.empty()) observe_slide(e, piece.time, speed, force, i, sign);
      if constexpr (kTied<Flow>) {
        e.peak = std::max(e.peak, piece.peak);
        follow_position(e, p_, levels_.level(i), sign, piece);
      } else {
        follow_passages(e, piece, speed, force, sign);
        if (!wanted_.omega.empty()) follow_transform(e, piece, speed, force, sign);
      }
      follow(e, piece, i, sign);
      speed = piece.end;
      if (!piece.stopped) {
        i = levels_.next(i, sign, random);
        wait = levels_.wait(i, random);
        ++e.jumps;
        continue;
      }
      wait -= piece.time;
      if (rests(i)) break;
      sign = -sign;  // pushed on the other way
    }
    e.entry = i;
  }

  [[nodiscard]] const Flow& flow(int sign) const { return sign > 0 ? flow_ : backward_flow_; }

  void follow(Excursion& e, const Piece& piece, int i, int sign) const {
    e.peak = std::max(e.peak, piece.end);
    e.slide += piece.time;
    e.path += piece.path;
    e.drift += sign * piece.path;
    e.square += piece.square;
    e.product += sign * levels_.level(i) * piece.path;
    if (wanted_.noise) follow_noise(e, i, piece.time);
  }

  // The speed rises or falls all along a piece.
  void follow_passages(Excursion& e, const Piece& piece, double speed, double force,
                       int sign) const {
    const auto& speeds = wanted_.speeds;
    for (std::size_t n = e.passages.size(); n < speeds.size() && speeds[n] <= piece.end; ++n) {
      e.passages.push_back(e.slide + rise_time(flow(sign), speed, force, piece.time, speeds[n]));
    }
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
  void observe_slide(Excursion& e, double time, double speed, double force, int i, int sign) {
    place_ = std::fmod(place_ + 0.6180339887498949, 1);
    const double at = place_ * time;
    const auto then = flow(sign).move(speed, force, at, kTied<Flow>);
    observe(e, &Integrals::slide, time, at, place_at(i, sign * then.path), sign, sign * then.end);
  }
  // On level i, a distance further than the piece began.
  [[nodiscard]] model::Place place_at(int i, double further) const {
    const double x = levels_.level(i);
    if constexpr (!kTied<Flow>) return x;
    return {x, p_ + further - centre_, centre_};
  }

  // A piece of `time`, with the state at `at` after its start; at rest nothing changes.
  void observe(Excursion& e, double Integrals::*part, double time, double at, const model::Place& x,
               double y, double v) const {
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
  void sticking(RandomStream& random, Excursion& e, double wait) {
    int i = e.entry;
    for (;;) {
      if (!wanted_.observables.empty()) {
        observe(e, &Integrals::stick, wait, 0, place_at(i, 0), 0, 0);
      }
      e.stick += wait;
      if constexpr (kTied<Flow>) follow_position(e, p_, levels_.level(i), 0, {{.time = wait}});
      if (wanted_.noise) follow_noise(e, i, wait);
      i = levels_.next(i, 1, random);
      ++e.jumps;
      if (!rests(i)) break;
      wait = levels_.wait(i, random);
    }
    e.next = i;
    e.turned = levels_.is_below(i);
  }

  Levels levels_;
  std::optional<NoiseLevels> at_start_;
  Flow flow_, backward_flow_;
  double stiffness_, centre_, p_ = 0;
  double highest_, lowest_;  // forces of noise and spring that hold a body
  int i_ = 0;
  Wanted wanted_;
  bool symmetric_;
  double place_ = 0;
  std::vector<std::complex<double>> piece_transform_, phase_;
};

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

std::size_t Wanted::observe(const model::Observable& f) {
  const auto found = std::ranges::find(observables, f.name, &model::Observable::name);
  const auto place = static_cast<std::size_t>(found - observables.begin());
  if (found == observables.end()) observables.push_back(f);
  return place;
}

std::unique_ptr<ExcursionSource> make_source(const model::Process& process, const Wanted& wanted) {
  if (process.noise.gaussian) return make_gaussian_source(process, wanted);
  return with_flow<Source>(process, wanted);
}

}  // namespace stickslip::simulation
