#pragma once
/// What is kept of many excursions and paths, and the estimates made from it.

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "stickslip/case/case.hpp"
#include "stickslip/simulation/means.hpp"
#include "stickslip/simulation/walk.hpp"

namespace stickslip::simulation {

/// A result: a scalar, or an array over an abscissa.
struct Estimated {
  const cases::Row* row = nullptr;
  std::vector<Estimate> values = {};
  std::vector<double> abscissa = {};
  const model::Observable* observable = nullptr;  ///< of a row that stands for many
  std::string key = {};                           ///< in place of that of the row, if any
  bool exact = false;  ///< known without a simulation, and given without interval
};

using Estimates = std::vector<Estimated>;

/// Of a row that stands for one array for each time or speed.
[[nodiscard]] inline Estimated at(double place, Estimated array) {
  array.key = array.row->key_of(fmt::format("{}", place));
  return array;
}
/// With value(n) at the n-th place of the abscissa.
[[nodiscard]] Estimated array(const cases::Row& row, const std::vector<double>& abscissa,
                              const auto& value, const model::Observable* observable = nullptr) {
  Estimated all{&row, {}, abscissa, observable};
  for (std::size_t n = 0; n < abscissa.size(); ++n) all.values.push_back(value(n));
  return all;
}

/// A number that a path shows, times its weight; and its mean over paths.
struct Weighted {
  double weight, value;
};
[[nodiscard]] inline Smooth mean_of(const Sums<Weighted>& paths) {
  return paths.overall(&Weighted::value) / paths.overall(&Weighted::weight);
}

/// All that is kept for the quantities of a question. Each of them is a function that says what it
/// follows along excursions or paths, and what it makes of the sums; tally.cpp lists them.
///
/// Excursions of a long path start from s+ and s- in turn by a Markov chain. Quantities of an
/// excursion are means over all, so that a stationary mean is E[G]/E[T], with G the integral over
/// an excursion and T its duration. Where the noise jumps further than to neighbours excursions
/// start from many levels, and the samples are cycles: those from one level until the next from the
/// same. Intervals are those of the delta method. Tallies of parts,
/// merged in a fixed order, give the same bits however the parts were distributed. Local.
class Tally {
 public:
  Tally(const cases::Question& question, const model::Process& process);
  Tally(Tally&&) = default;  // and no copies, which would share sums

  [[nodiscard]] const cases::Question& question() const { return question_; }
  [[nodiscard]] const model::Process& process() const { return process_; }
  /// What is to be followed, to which quantities add.
  [[nodiscard]] Wanted& wanted() { return wanted_; }
  [[nodiscard]] const Wanted& wanted() const { return wanted_; }

  /// A number that an excursion has, such as &Excursion::slide.
  using Number = std::function<double(const Excursion&)>;
  /// Gives the mean of of(excursion, s) over excursions for each s of the abscissa.
  void mean(const cases::Row& row, const std::vector<double>& abscissa,
            const std::function<double(const Excursion&, double s)>& of);
  /// Gives the mean and the variance of a number; `parity` is its sign in the mirror.
  void moments(const cases::Row& mean, const cases::Row& variance, const Number& of,
               double parity = 1);
  /// Gives what a long path gathers in a unit of time.
  void over_time(const cases::Row& row, const Number& of, double parity = 1);
  /// Gives averages of the density of a number over cells up to halfway between neighbouring values
  /// and as far on the other side at the ends, and the distribution function.
  void distribution(const cases::Row& density, const cases::Row& distribution,
                    const std::vector<double>& at, const Number& of);

  /// Sums of the samples of(excursion), which sees the excursions of a cycle one after the other.
  auto sums(auto of) {
    using Row = typename Sums<decltype(of(Excursion{}))>::Row;
    auto all = new_sums<decltype(of(Excursion{}))>(sampled());
    if (sampled() != Sampled::cycles) {
      of_excursions_.emplace_back([all, of](std::size_t side, const Excursion& e) mutable {
        all.add(side, {e.turned ? 1.0 : 0.0, of(e)});
      });
      return all;
    }
    of_excursions_.emplace_back([all, of, sum = Row{}](std::size_t, const Excursion& e) mutable {
      sum += {1, of(e)};
      if (e.ends_cycle) all.add(0, std::exchange(sum, Row{}));
    });
    return all;
  }
  /// The same of excursions or cycles as a whole, of which the excursion given has durations, int v
  /// dt and its transforms.
  auto sums_of_renewals(const auto& of) {
    if (sampled() != Sampled::cycles) return sums(of);
    auto all = new_sums<decltype(of(Excursion{}))>(sampled());
    of_cycles_.emplace_back([all, of](const Excursion& cycle) mutable {
      all.add(0, {1, of(cycle)});
    });
    return all;
  }
  /// Sums of of(path), of paths from a start.
  auto sums_of_paths(const model::Start& start, const auto& of) {
    auto all = new_sums<decltype(of(FollowedPath{}))>(sampled_from(start));
    follow(start, [all, of](const FollowedPath& path, bool turned) mutable {
      all.add(path.side, {turned ? 1.0 : 0.0, of(path)});
    });
    return all;
  }
  /// For each time of the question sums of of(path, state at that time).
  auto sums_along(const model::Start& start, const auto& of) {
    wanted_.time = question_.time;
    std::vector<Sums<decltype(of(FollowedPath{}, State{}))>> all;
    for (std::size_t n = 0; n < question_.time.size(); ++n) {
      all.push_back(sums_of_paths(
          start, [of, n](const FollowedPath& path) { return of(path, path.states[n]); }));
    }
    return all;
  }
  /// For each time of the question bins of the number of(displacement) of paths from a start, which
  /// last as long as the tally.
  [[nodiscard]] std::vector<const PathBins*>
  bins_along(const model::Start& start, bool both_signs,
             const std::function<double(double displacement)>& of);
  /// Probabilities that a number lies in [low, high), by the place of the range. An interval has
  /// some width also where all samples agree.
  struct Range {
    double low, high;
  };
  using Shares = std::function<Estimate(std::size_t)>;
  [[nodiscard]] Shares shares(const std::vector<Range>& ranges, const Number& of);
  /// Of a number; it lasts as long as the tally.
  [[nodiscard]] const Histogram& histogram(std::vector<double> edges, const Number& of);
  /// What is made of the sums; the tally is this one, wherever it has been moved.
  void report(std::function<Estimates(const Tally&)> estimates) {
    reports_.push_back(std::move(estimates));
  }

  /// What the samples are.
  [[nodiscard]] Sampled sampled() const;
  /// An excursion from s+ (side 0) or, without symmetry, from s- (side 1); of a cycle side 0.
  void add(std::size_t side, const Excursion& excursion);
  /// A cycle as a whole, after its excursions.
  void add_cycle(const Excursion& cycle);
  void add(const FollowedPath& path);
  void add_jumps(double jumps) { counts_[1] += jumps; }
  /// In the order of quantities in tally.cpp. There have to be samples.
  [[nodiscard]] Estimates estimates() const;

  /// Excursions, pairs of one from each side, or cycles.
  [[nodiscard]] double samples() const { return counts_[0]; }
  [[nodiscard]] double jumps() const { return counts_[1]; }  ///< of the noise

  void clear();
  [[nodiscard]] std::size_t size() const;  ///< count of all numbers
  /// All numbers in a row.
  [[nodiscard]] std::vector<double> pack() const;
  /// As if all samples of another tally had been added. Throws std::invalid_argument if it is not
  /// of the size of this one.
  void merge(std::span<const double> packed);

 private:
  template <class Sample>
  Sums<Sample> new_sums(Sampled sampled) {
    const std::size_t sides = sampled == Sampled::sides ? 2 : 1;
    return {comoments_.emplace_back(sides, Comoments(Sums<Sample>::kSize)), sampled};
  }
  // What paths from a start are, and what is done with each of them.
  [[nodiscard]] Sampled sampled_from(const model::Start& start) const;
  void follow(const model::Start& start,
              std::function<void(const FollowedPath&, bool turned)> take);
  template <class Self, class Action>
  static void each_row(Self& tally, const Action& action);

  cases::Question question_;
  model::Process process_;
  Wanted wanted_;
  std::array<double, 2> counts_{};                // samples, jumps
  std::deque<std::vector<Comoments>> comoments_;  // by side; these and histograms stay in place
  std::deque<Histogram> histograms_;
  std::deque<PathBins> bins_;
  std::vector<std::function<void(std::size_t, const Excursion&)>> of_excursions_;
  std::vector<std::function<void(const Excursion&)>> of_cycles_;
  std::vector<std::function<void(const FollowedPath&)>> of_paths_;
  std::vector<std::function<Estimates(const Tally&)>> reports_;
};

/// Cells around values, up to halfway between neighbours and as far on the other side at the ends;
/// none reaches beyond 0.
[[nodiscard]] std::vector<Tally::Range> cells_around(const std::vector<double>& at);

// Batches of samples.

/// A sample is an excursion from s+ and, without symmetry, another one from s-, together with the
/// paths that are wanted. Local.
class Sampler {
 public:
  Sampler(const cases::Question& question, const model::Process& process);

  /// `count` < 2^16 samples by the random streams of their batch, at most 2^44 of them; until the
  /// next batch.
  [[nodiscard]] const Tally& batch(std::uint64_t seed, std::uint64_t batch, int count);

 private:
  void draw_from_rest(RandomStream& random, Excursion& all);
  void add_cycle(RandomStream& random, RandomStream& places, Excursion& first);
  void add_stationary(const RandomStream& random, std::size_t side, double place, bool mirrored);
  [[nodiscard]] std::pair<State, std::span<const State>> follow();
  [[nodiscard]] std::span<const double> pass(bool mirrored);

  Tally tally_;
  model::Process process_;
  Sampled sampled_;
  std::vector<int> starts_;  // by side, or of cycles
  Wanted wanted_;
  std::unique_ptr<ExcursionSource> source_, from_rest_;
  std::unique_ptr<NoiseLevels> at_rest_;  // where passages from rest are wanted
  std::unique_ptr<Walk> walk_;
  std::vector<std::size_t> order_;  // of times
  std::vector<State> states_;
  std::vector<double> passages_;
};

}  // namespace stickslip::simulation
