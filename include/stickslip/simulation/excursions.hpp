#pragma once
/// Excursions of the process, event by event: the two algorithms of the paper, with the
/// sign of motion kept at a jump of the noise and taken from it where a body at v = 0 is pushed on.

#include <complex>
#include <memory>
#include <vector>

#include "stickslip/model/process.hpp"
#include "stickslip/simulation/random_stream.hpp"

namespace stickslip::simulation {

/// What is followed and counted besides the durations.
struct Wanted {
  bool moments = false;        ///< integrals of v^2, |v|, x v
  bool noise = false;          ///< of 1{|x| <= mu_s}, x^2
  std::vector<double> omega;   ///< spectrum at these frequencies [1/time]
  std::vector<double> lambda;  ///< Laplace transforms of durations [1/time]
  std::vector<double> edges;   ///< rising edges of the cells of histograms of durations [time]
  bool cycles = false;         ///< without symmetry: the drift of cycles and its spread
};

/// One excursion: a slide from (x_{k+1}, v = 0) to rest, and the stay until |X| > mu_s again.
/// Without symmetry a cycle of excursions, from one side until the next one starts there again.
struct Excursion {
  double slide = 0, stick = 0;  ///< durations [time]
  double square = 0;            ///< int v^2 dt
  double path = 0;              ///< int |v| dt
  double product = 0;           ///< int x v dt
  double within = 0;            ///< time with |X| <= mu_s
  double noise_square = 0;      ///< int x^2 dt
  int entry = 0;                ///< level i at which the last slide came to rest
  bool turned = false;          ///< whether it ends at s-
  double jumps = 0;             ///< of the noise
  /// int v exp(-i omega t) dt, t from the start of the excursion.
  std::vector<std::complex<double>> transform;
  double count = 1;  ///< of excursions, in a cycle
  double drift = 0;  ///< int v dt
};

/// Draws independent excursions. By symmetry those from s- are mirror images, so that a path is a
/// sequence of excursions from s+ with signs. Without symmetry it is a sequence of cycles, from the
/// side to which the bias pushes. Exact for linear and no drag, else to 1e-13.
class ExcursionSource {
 public:
  virtual ~ExcursionSource() = default;
  /// The next one, with the numbers of `random`.
  virtual void draw(RandomStream& random, Excursion& excursion) = 0;
};

/// Closed forms where b is linear, an integrator otherwise. Local.
[[nodiscard]] std::unique_ptr<ExcursionSource> make_source(const model::Process& process,
                                                           const Wanted& wanted);

}  // namespace stickslip::simulation
