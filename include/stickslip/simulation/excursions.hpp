#pragma once
/// Excursions of the process, event by event: the two algorithms of the paper, with the
/// sign of motion kept at a jump of the noise and taken from it where a body at v = 0 is pushed on.

#include <complex>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "stickslip/model/observable.hpp"
#include "stickslip/model/passage.hpp"
#include "stickslip/model/process.hpp"
#include "stickslip/model/start.hpp"
#include "stickslip/simulation/random_stream.hpp"

namespace stickslip::simulation {

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

/// Closed forms where b is linear, a series otherwise. Local.
[[nodiscard]] std::unique_ptr<ExcursionSource> make_source(const model::Process& process,
                                                           const Wanted& wanted);

}  // namespace stickslip::simulation
