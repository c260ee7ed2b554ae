#pragma once
/// What is kept of many excursions and paths, and the estimates made from it.

#include <array>
#include <initializer_list>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "stickslip/catalogue/entry.hpp"
#include "stickslip/simulation/comoments.hpp"
#include "stickslip/simulation/excursions.hpp"
#include "stickslip/simulation/histogram.hpp"
#include "stickslip/simulation/means.hpp"
#include "stickslip/simulation/path.hpp"

namespace stickslip::simulation {

/// Durations whose distributions are asked for.
enum class Duration { slide, stick, excursion };

/// Random variables with histograms: durations, the path length of a sliding phase, and its largest
/// speed.
enum class Variable { slide, stick, excursion, path, peak };

/// Functions of the state whose integrals over excursions are kept; inside is 1{|x| <= mu_s}.
enum class Integrand { v_square, v_size, x_v, inside, x_square, v };

/// Estimates by their rows.
using Named = std::vector<std::pair<const catalogue::Row*, Estimate>>;

/// Counts and co-moments of excursions from both sides, or with symmetry from s+. Tallies of parts,
/// merged in a fixed order, give the same bits however the parts were distributed.
///
/// Excursions of a long path start from s+ and s- in turn by a Markov chain. Quantities of an
/// excursion are means over all, so that a stationary mean is E[G]/E[T], with G the integral over
/// an excursion and T its duration. Intervals are those of the delta method. Local.
class Tally {
 public:
  Tally(const model::Process& process, const Wanted& wanted);

  void add(std::size_t side, const Excursion& excursion);
  /// When an excursion and a path from rest reached wanted.speeds.
  void add_passages(std::size_t side, const Excursion& excursion, const Excursion& from_rest);
  /// The states at wanted.time of a path from wanted.start, or of a stationary one: such a path
  /// begins at a uniformly distributed time of an excursion from one side, and counts with the
  /// duration of that. The others have side 0 and weight 1.
  void add_path(std::size_t side, bool turned, double weight, const std::vector<State>& states);
  /// The same of a stationary path for the autocorrelation.
  void add_lagged(std::size_t side, bool turned, double duration, const State& start,
                  const std::vector<State>& states);
  void add_jumps(double jumps) { jumps_ += jumps; }
  void merge(const Tally& other);

  /// Excursions, or pairs of one from each side.
  [[nodiscard]] double samples() const { return comoments_[0].count(); }
  [[nodiscard]] double jumps() const { return jumps_; }

  [[nodiscard]] Estimate share(Duration duration) const;  ///< P_slide or P_stick
  [[nodiscard]] Estimate mean(Duration duration) const;
  [[nodiscard]] Estimate variance(Duration duration) const;
  [[nodiscard]] Estimate slip_rate() const;                      ///< 1/E[T]
  [[nodiscard]] Estimate stationary(Integrand integrand) const;  ///< E[V^2] and the like
  /// up E[V+] + down E[V-].
  [[nodiscard]] Estimate mean_of_speeds(double up, double down) const;
  /// Probability that a sliding phase from one side ends on level i.
  [[nodiscard]] Estimate entry(std::size_t side, int i) const;
  /// Rate at which a body leaves rest as it has come there: `up` on the highest level, `down` on
  /// the lowest.
  [[nodiscard]] Estimate first_exit(double up, double down) const;
  /// E[exp(-lambda D)] for the n-th lambda.
  [[nodiscard]] Estimate laplace(std::size_t n, Duration duration) const;
  /// P(low <= D < high); low and high are edges, or 0 and infinity.
  [[nodiscard]] Estimate probability(Variable variable, double low, double high) const;
  /// Mean and variance of the path length of a sliding phase and of its net displacement.
  [[nodiscard]] Named slip() const;
  /// E[exp(-s L)] of the path length L of a sliding phase for the n-th s.
  [[nodiscard]] Estimate slip_transform(std::size_t n) const;
  /// S_v at the n-th omega, and at 0, of V - E[V]; see tally.cpp.
  [[nodiscard]] Estimate spectrum(std::size_t n) const;
  [[nodiscard]] Estimate spectrum_at_zero() const;
  /// pi, pi given rest and pi given motion of the f-th observable.
  [[nodiscard]] Named averages(std::size_t f) const;
  /// h and w_one at the l-th lambda of the resolvent, and what there is of the f-th observable.
  [[nodiscard]] Named exits(std::size_t l) const;
  [[nodiscard]] Named resolvent(std::size_t l, std::size_t f) const;
  /// E[f(Z_t)] for the f-th observable at the n-th time, and E[(V_0 - m)(V_t - m)].
  [[nodiscard]] Estimate expectation(std::size_t f, std::size_t n) const;
  [[nodiscard]] Estimate autocorrelation(std::size_t n) const;
  /// Mean and variance of int_0^t V at the n-th time.
  [[nodiscard]] Named travel(std::size_t n) const;
  /// Mean times until |V| first reaches w, one of wanted.speeds, from the start of a sliding phase
  /// and from rest. If no sliding phase reached w, a lower bound with an interval up to infinity.
  [[nodiscard]] Named first_passage(double w) const;

  /// All numbers in a row, and back. `unpack` expects a tally of the same questions, and throws
  /// std::invalid_argument if the size is another.
  [[nodiscard]] std::vector<double> pack() const;
  [[nodiscard]] std::size_t packed_size() const;
  void unpack(std::span<const double> numbers);

 private:
  enum Group {
    totals,
    displacement,
    laplaces,
    spectra,
    observed,
    discounted,
    expected,
    lagged,
    travels,
    slip_transforms,
    passages,
    size_of_groups
  };
  /// Where a group begins, and how many comoments it has for each side; one side with symmetry.
  struct Place {
    std::size_t first = 0, members = 0, sides = 0;
  };

  void keep(Group group, std::size_t n, std::size_t side, std::initializer_list<double> sample) {
    const Place& place = places_[group];
    comoments_[place.first + n * place.sides + side].add({sample.begin(), sample.size()});
  }
  [[nodiscard]] Means means(Group group, std::size_t n = 0) const {
    const Place& place = places_[group];
    return Means(std::span(comoments_).subspan(place.first + n * place.sides, place.sides));
  }
  template <class Self, class Action>
  static void each_row(Self& tally, const Action& action);
  [[nodiscard]] std::size_t bin(int level) const;
  void add_transforms(std::size_t side, const Excursion& e);
  void add_integrals(std::size_t side, const Excursion& e);

  int lowest_;
  Wanted wanted_;
  bool symmetric_;
  std::array<Place, size_of_groups> places_;
  std::vector<Comoments> comoments_;        // by group, member and side
  std::vector<Histogram> histograms_;       // of entries, then by Variable
  std::vector<std::vector<double>> edges_;  // of the cells of histograms
  double jumps_ = 0;
};

}  // namespace stickslip::simulation
