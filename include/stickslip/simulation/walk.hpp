#pragma once
/// Excursions of the process, event by event: the two algorithms of the paper, with the
/// sign of motion kept at a jump of the noise and taken from it where a body at v = 0 is pushed on.

#include <Random123/philox.h>
#include <boost/random/exponential_distribution.hpp>
#include <boost/random/normal_distribution.hpp>

#include <algorithm>
#include <array>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "stickslip/model/noise_chain.hpp"
#include "stickslip/model/observable.hpp"
#include "stickslip/model/process.hpp"

namespace stickslip::simulation {

// Random numbers that depend on the seed and on the place where they are used, and on nothing
// else.

/// Stream number `stream` of `seed`: 2^66 random bits of the counter-based generator Philox4x64-10
/// (Salmon, Moraes, Dror and Shaw, SC 2011), from Random123. Streams of different number or seed
/// share no counter, so that work can be distributed in any way. A UniformRandomBitGenerator.
class RandomStream {
 public:
  using result_type = std::uint64_t;

  RandomStream(std::uint64_t seed, std::uint64_t stream) : key_{{seed, stream}} {}

  static constexpr result_type min() { return 0; }
  static constexpr result_type max() { return std::numeric_limits<result_type>::max(); }
  result_type operator()() {
    if (next_ == words_.size()) refill();
    return words_[next_++];
  }

  /// 32 random bits; two calls share a word.
  std::uint32_t half_word() {
    if (kept_) {
      kept_ = false;
      return half_;
    }
    const result_type word = (*this)();
    half_ = static_cast<std::uint32_t>(word >> 32);
    kept_ = true;
    return static_cast<std::uint32_t>(word);
  }
  /// Uniform in [0, 1).
  double uniform() { return static_cast<double>((*this)() >> 11) * 0x1p-53; }
  /// Exponentially distributed with mean 1, by Boost.Random's ziggurat.
  double exponential() { return exponential_(*this); }
  /// Normally distributed with mean 0 and variance 1, by the same.
  double normal() { return normal_(*this); }

 private:
  // Many blocks at a time: they do not depend on one another, and processors overlap them.
  void refill() {
    constexpr std::size_t block = 4;
    for (std::size_t n = 0; n < words_.size(); n += block) {
      const auto random = r123::Philox4x64()(counter_, key_);
      ++counter_.v[0];
      for (std::size_t w = 0; w < block; ++w) words_[n + w] = random.v[w];
    }
    next_ = 0;
  }

  r123::Philox4x64::key_type key_;
  r123::Philox4x64::ctr_type counter_{};
  std::array<result_type, 128> words_{};
  std::size_t next_ = 128;
  std::uint32_t half_ = 0;
  bool kept_ = false;
  boost::random::exponential_distribution<double> exponential_;
  boost::random::normal_distribution<double> normal_;
};

// Jumps of a noise to any levels.

/// Draws the level to which the noise jumps from another one. Local.
class AnyJumps {
 public:
  explicit AnyJumps(const model::NoiseChain& noise) : lowest_(noise.lowest()) {
    for (int i = noise.lowest(); i <= noise.highest(); ++i) {
      double sum = 0;
      auto& row = rows_.emplace_back();
      noise.for_each_jump(i, [&](int to, double rate) { row.push_back({sum += rate, to}); });
    }
  }

  /// O(log of the number of jumps from there).
  [[nodiscard]] int next(int level, RandomStream& random) const {
    const int place = level - lowest_;
    const auto& row = rows_[static_cast<std::size_t>(place)];
    const double at = random.uniform() * row.back().up_to;
    const auto found = std::upper_bound(row.begin(), row.end() - 1, at,
                                        [](double x, const Jump& jump) { return x < jump.up_to; });
    return found->to;
  }

 private:
  struct Jump {
    double up_to;  // sum of the rates of this one and those before
    int to;
  };
  int lowest_;
  std::vector<std::vector<Jump>> rows_;
};

// Simulated paths, event by event.

/// The process at some time; y = sign of the motion, 0 at rest; displacement since the beginning.
struct State {
  double time = 0, x = 0, y = 0, v = 0, displacement = 0;
};

/// A path and its states at some times. A stationary one begins at a uniformly distributed time of
/// an excursion from one side, or of a cycle, and weighs as much as that lasts. The others have
/// side 0 and weight 1.
struct FollowedPath {
  State first = {};
  std::span<const State> states = {};
  bool stationary = false;
  std::size_t side = 0;
  bool turned = false;  ///< whether that excursion is followed by one from the other side
  double weight = 1;
  std::span<const double> passages = {};  ///< when the wanted ones happen
};

/// A path of the process, followed event by event. Between events X and Y stay and V follows the
/// flow. Local.
class Walk {
 public:
  virtual ~Walk() = default;
  /// Begins at time 0 with the numbers of `random`, in a state or with the noise at rest. At v = 0
  /// a body on static levels rests.
  virtual void begin(const RandomStream& random, const model::Start& start) = 0;
  /// On to the next event, a jump of the noise or a body that comes to rest or is turned round, at
  /// most to the time `limit`.
  virtual void step(double limit) = 0;
  /// When the speed is passed before the next event: now if it has been, never if it is not.
  [[nodiscard]] virtual double passes(model::Passage passage, double speed) const = 0;
  [[nodiscard]] virtual State state() const = 0;
  [[nodiscard]] virtual double jumps() const = 0;  ///< of the noise since the beginning
  [[nodiscard]] virtual int level() const = 0;     ///< of the noise

  /// On to a time that is not past.
  State advance(double time);
  /// On to the end of the excursion, where a body at rest is pushed. The time.
  double end_excursion();
};

[[nodiscard]] std::unique_ptr<Walk> make_walk(const model::Process& process, bool travel = false);

/// Draws levels of the noise from its stationary distribution. Local.
class NoiseLevels {
 public:
  explicit NoiseLevels(const model::NoiseChain& noise);
  [[nodiscard]] int draw(double uniform) const;

 private:
  int lowest_;
  std::vector<double> below_;  // probability of a level and all below
};

/// A path: the state at time 0, just after every event, and at the end.
struct Path {
  std::vector<double> time, x, y, v;
};

/// The path from `start` up to `horizon` [time]. A stationary one starts at a uniformly distributed
/// time within 1000 excursions after s+, which is stationary but for about a thousandth. Local.
/// O(horizon/Lambda) memory.
[[nodiscard]] Path simulate_path(const model::Process& process, const model::Start& start,
                                 double horizon, std::uint64_t seed);

/// What is followed besides the durations.
struct Wanted {
  bool integrals = false;           ///< of v, v^2, |v|, x v
  bool noise = false;               ///< of 1{|x| <= mu_s}, x^2
  std::vector<double> omega = {};   ///< transforms of v at these frequencies [1/time]
  std::vector<double> speeds = {};  ///< rising; when |v| reaches them [velocity]
  std::vector<model::Observable> observables = {};  ///< integrals of them
  std::vector<double> discount = {};       ///< discounted ones of them at these lambda [1/time]
  std::vector<double> time = {};           ///< along paths [time]
  std::optional<model::Start> start = {};  ///< of paths from a state or from rest
  bool stationary_paths = false;
  bool travel = false;                ///< int v dt along paths
  std::vector<double> passages = {};  ///< of paths; rising [velocity]
  model::Passage passage = model::Passage::both;

  /// The place among the observables of one that is to be followed; each has a name of its own.
  std::size_t observe(const model::Observable& f);
};

/// Integrals of f over the sliding and the sticking phase of an excursion; with symmetry of its
/// even part.
struct Integrals {
  double slide = 0, stick = 0;
};

/// int exp(-lambda t) f dt, t from the start of the excursion, and that of f(-x, -y, -v).
struct Discounted {
  double value = 0, mirrored = 0;
};

/// One excursion: a sliding phase from v = 0 on a level beyond the static ones to rest, and the
/// sticking phase until these are left again.
struct Excursion {
  double slide = 0, stick = 0;  ///< durations [time]
  double square = 0;            ///< int v^2 dt
  double path = 0;              ///< int |v| dt
  double product = 0;           ///< int x v dt
  double within = 0;            ///< time with |X| <= mu_s
  double noise_square = 0;      ///< int x^2 dt
  int entry = 0;                ///< level i at which the sliding phase ended
  bool turned = false;          ///< whether the next one starts from the other side
  double jumps = 0;             ///< of the noise
  /// int v exp(-i omega t) dt, t from the start of the excursion.
  std::vector<std::complex<double>> transform = {};
  double drift = 0;                         ///< int v dt
  std::vector<Integrals> integrals = {};    ///< by observable
  std::vector<Discounted> discounted = {};  ///< by lambda and observable
  double peak = 0;                          ///< largest |v|
  std::vector<double> passages = {};        ///< when |v| first reached the speeds that it reached
  const Excursion* from_rest = nullptr;     ///< from rest, where speeds are wanted
  bool upwards = true;                      ///< direction of the sliding phase
  int start = 0, next = 0;                  ///< levels from which it and the next one start
  bool ends_cycle = true;                   ///< whether that is the one from which its cycle did
  double place = 0, place_square = 0, place_noise = 0;  ///< int p dt, int p^2 dt, int x p dt
};

/// Draws excursions from any of the levels from which they start. Exact for linear and no drag,
/// else to 1e-11. Integrals of observables are their values at one uniformly distributed time in
/// each piece of the motion, times its duration: right in the mean whatever the function.
class ExcursionSource {
 public:
  virtual ~ExcursionSource() = default;
  /// The next one, with the numbers of `random`; `place` in [0, 1) moves the times at which
  /// observables are taken, and nothing else.
  virtual void draw(RandomStream& random, int level, double place, Excursion& excursion) = 0;
  /// From v = 0 on any level; on static ones the sliding phase lasts 0. `turned`: the next one is
  /// from below.
  virtual void draw_from(int level, RandomStream& random, Excursion& excursion) = 0;
};

/// Where noise of continuous paths has no levels, or a spring makes excursions start from any
/// position, they follow one another in samples: this one is drawn from where the path of a sample
/// begins, and another one is next within a sample.
constexpr int kPathBegins = 0;

/// Whether samples are such paths.
[[nodiscard]] inline bool follows_paths(const model::Process& process) {
  return process.noise.gaussian || process.stiffness > 0;
}

/// Draws samples that are all excursions which begin in a span of time: so each counts as often as
/// it occurs. The span follows another one, in which the path forgets where it began. On a spring
/// time counts while the body slides: at rest it does not forget its position.
class PathSource : public ExcursionSource {
 public:
  explicit PathSource(double span) : span_(span) {}

  void draw_from(int level, RandomStream& random, Excursion& e) override;

 protected:
  double elapsed_ = 0;  ///< of the path

 private:
  virtual void begin(RandomStream& random) = 0;  ///< at the start of a sliding phase
  virtual void follow_one(RandomStream& random, Excursion& e) = 0;

  double span_, end_ = 0;
};

/// Closed forms where b is linear, a series otherwise. Local.
[[nodiscard]] std::unique_ptr<ExcursionSource> make_source(const model::Process& process,
                                                           const Wanted& wanted);
/// Of noise of continuous paths, without what Wanted has of passages, transforms and discounts.
[[nodiscard]] std::unique_ptr<ExcursionSource> make_gaussian_source(const model::Process& process,
                                                                    const Wanted& wanted);
/// What its steps leave of error, relative to each result: intervals are so much wider. With steps
/// four times as long P_stick of a narrow band is off by 2e-3, P(|X| <= mu_s) by 3e-3.
constexpr double kStepError = 1e-3;

/// The span of a sample, in which a path forgets.
[[nodiscard]] double span_of_sample(const model::Process& process);
/// Steps of such a path, or jumps of its noise, that a sample takes at least.
[[nodiscard]] double steps_of_sample(const model::Process& process);

}  // namespace stickslip::simulation
