#pragma once
/// The noise X: a Markov chain.

#include <array>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace stickslip::model {

// Indices of grid points, safe against rounding.

/// Largest integer n with n <= ratio, where a ratio within a few units of rounding of an integer
/// counts as that integer: 0.3/0.1 gives 3, 2/0.1^2 gives 200, while (1 - 1e-12)/0.25 gives 3.
/// Throws std::out_of_range when the result does not fit an int.
[[nodiscard]] int floor_index(double ratio);

/// a - b, or exactly 0 when a and b differ by no more than the rounding of their computation.
[[nodiscard]] double snapped_difference(double a, double b);

// Chains given level by level.

/// A level with the rates of jumps to its neighbours.
struct Level {
  double x;         ///< [force]
  double up, down;  ///< [1/time]
};

/// A jump from one state to another, both by their places in a list.
struct Transition {
  std::size_t from, to;
  double rate;  ///< [1/time]
};

/// Which of so many states are reached from one of them, itself included. O(states + transitions).
[[nodiscard]] std::vector<bool> reached_from(std::size_t first, std::size_t states,
                                             const std::vector<Transition>& transitions);

/// Evenly spaced forces, or positions, at which a distribution over nodes is shown: probability
/// `share` times that of a node belongs to each of them, so that probabilities over the spacing are
/// a density.
struct Shown {
  struct Share {
    int node;  ///< by place, the lowest at 0
    double share;
  };
  std::vector<double> x = {};
  std::vector<std::vector<Share>> of = {};  ///< by x

  [[nodiscard]] double at(std::size_t place, std::span<const double> by_node) const {
    double sum = 0;
    for (const auto& [node, share] : of[place])
      sum += share * by_node[static_cast<std::size_t>(node)];
    return sum;
  }
};

/// The noise where an observable is seen and, of a body on a spring, its position about `centre`,
/// g/K. Functions of the noise alone take it for a number.
struct Place {
  double x, p = 0, centre = 0;

  // NOLINTNEXTLINE(google-explicit-constructor): without a spring the noise is the place
  Place(double noise) : x(noise) {}
  Place(double noise, double about_centre, double at) : x(noise), p(about_centre), centre(at) {}
  // NOLINTNEXTLINE(google-explicit-constructor): and the place the noise
  operator double() const { return x; }
  [[nodiscard]] double position() const { return centre + p; }
  /// The mirror image.
  Place operator-() const { return {-x, -p, centre}; }
};

using FunctionOfNoise = std::function<double(const Place& place)>;

/// The means of a function of the noise under what each node stands for, by place.
using Means = std::function<std::vector<double>(const FunctionOfNoise& f)>;

/// Nodes that stand for a noise of continuous paths, or for a noise and the position of a body on
/// a spring. Rates between them may have any sign.
struct Projection {
  /// The force on the body, rising; positive and of sum 1, about what is found there.
  std::vector<double> x = {}, probability = {};
  std::vector<Transition> transitions = {};
  /// With positions: rates per distance by which a body changes nodes as it moves to either side,
  /// each over all places; the position of each node, and the noise without the spring there.
  std::vector<Transition> upwards = {}, downwards = {};
  std::vector<double> position = {}, noise = {};
  double centre = 0;  ///< of the positions
  /// The shares of nodes in the value of a function at one position, of a body at rest or in motion
  /// towards a side (0, 1, -1): under a noise, or on average over its stationary distribution.
  std::function<std::vector<Shown::Share>(std::optional<double> noise, double p, int side)>
      value_at = {};
  double deviation = 0;                      ///< of the noise itself [force]
  double intensity = 0, peak_intensity = 0;  ///< at the frequency 0, and the largest
  double step = 0;                           ///< of the finest element [force]
  double rate = 0;                           ///< with which step^2 rate is the diffusivity of X
  bool even = false, reversed = false;       ///< as LevelTable has them
  bool continuous = true;                    ///< whether the paths of the noise are
  Shown shown = {}, by_position = {};
  Means means = {};
};

/// Forces at which functions of the noise are not smooth: where bodies at rest start to move, and
/// where friction balances the force on those that slide; downwards and upwards.
struct Thresholds {
  std::array<double, 2> start, balance;

  [[nodiscard]] bool alike_both_ways() const {
    return start[0] == -start[1] && balance[0] == -balance[1];
  }
  friend bool operator<(const Thresholds& a, const Thresholds& b) {
    return std::tie(a.start, a.balance) < std::tie(b.start, b.balance);
  }
};

class LevelTable;

/// What is solved on nodes, more of them with each order. Immutable but for a store of tables;
/// local.
class Projector {
 public:
  virtual ~Projector() = default;
  /// The generator on nodes, for the thresholds of its scene; order >= 2. Kept for the next call.
  /// Throws UnfitTable unless fits().
  [[nodiscard]] std::shared_ptr<const LevelTable> projected(const Thresholds& thresholds,
                                                            int order) const;
  /// Whether the nodes of an order are few enough.
  [[nodiscard]] virtual bool fits(const Thresholds& thresholds, int order) const = 0;

 private:
  [[nodiscard]] virtual Projection projection(const Thresholds& thresholds, int order) const = 0;

  mutable std::map<std::pair<Thresholds, int>, std::shared_ptr<const LevelTable>> made_;
};

/// A chain that reaches each of its levels from each other one, by jumps to the neighbours or,
/// where it is made of transitions, by jumps of any length. Levels are numbered by rising x, which
/// several may share; level 0 is the one nearest to x = 0, the upper one of two. Immutable.
class LevelTable {
 public:
  /// A jump to the level at a place, the lowest at 0.
  struct Jump {
    int to;
    double rate;
  };

  /// At least two levels, rising, that jump to their neighbours: of the rates only that below the
  /// lowest level and that above the highest one are 0. Such a chain is reversible. O(levels).
  /// Throws UnfitTable.
  explicit LevelTable(std::vector<Level> levels);
  /// Any chain: states of force x, and the jumps between them, each pair at most once. Where all
  /// jumps are to neighbours it is the chain above. O(states band^2), jumps leading over at most
  /// `band` levels. Throws UnfitTable, whose rows are states.
  LevelTable(const std::vector<double>& x, const std::vector<Transition>& transitions);
  /// Nodes, which are no levels of a chain: only operators and what is solved with them know them.
  [[nodiscard]] static LevelTable of(const Projection& projection);

  [[nodiscard]] int lowest() const { return lowest_; }
  [[nodiscard]] int highest() const { return lowest_ + static_cast<int>(levels_.size()) - 1; }
  [[nodiscard]] const Level& at(int i) const {
    const int place = i - lowest_;
    return levels_[static_cast<std::size_t>(place)];
  }

  /// Whether these are the levels of a noise, and not nodes of a projection.
  [[nodiscard]] bool has_levels() const { return !projected_; }
  /// Whether they are nodes of a noise of continuous paths.
  [[nodiscard]] bool continuous() const { return continuous_; }
  /// The forces at which a distribution over these nodes is shown; null for levels.
  [[nodiscard]] const Shown* shown() const { return shown_.get(); }
  /// The positions at which it is shown; null where there are none.
  [[nodiscard]] const Shown* by_position() const { return by_position_.get(); }
  /// Whether all jumps are to neighbours.
  [[nodiscard]] bool neighbours_only() const { return jumps_.empty(); }
  /// Calls visit(level, rate) for the jumps from a level, from the lowest one up.
  template <class Visit>
  void for_each_jump(int i, Visit visit) const {
    if (!neighbours_only()) {
      const int place = i - lowest_;
      for (const auto& [to, rate] : jumps_[static_cast<std::size_t>(place)]) {
        visit(lowest_ + to, rate);
      }
      return;
    }
    if (i > lowest()) visit(i - 1, at(i).down);
    if (i < highest()) visit(i + 1, at(i).up);
  }
  /// Whether the body has a position, which its motion changes.
  [[nodiscard]] bool has_positions() const { return !position_.empty(); }
  /// Calls visit(level, rate per distance) for the changes of a body that moves upwards.
  template <class Visit>
  void for_each_carried(int i, Visit visit) const {
    if (!has_positions()) return;
    for (const auto& [to, rate] : upwards_[static_cast<std::size_t>(i - lowest_)]) {
      visit(lowest_ + to, rate);
    }
  }
  [[nodiscard]] double position(int i) const {
    return position_[static_cast<std::size_t>(i - lowest_)];
  }
  /// The noise on a level: its x, or with positions what that is without the spring.
  [[nodiscard]] double noise(int i) const {
    return has_positions() ? noise_[static_cast<std::size_t>(i - lowest_)] : at(i).x;
  }
  [[nodiscard]] Place place_of(int i) const {
    return has_positions() ? Place{noise(i), position(i) - centre_, centre_} : Place(noise(i));
  }
  /// Of a body with a position, see Projection; nodes count from the lowest level. None where there
  /// is no such noise or position.
  [[nodiscard]] std::vector<Shown::Share> value_at(std::optional<double> noise, double p,
                                                   int side) const {
    return value_at_(noise, p, side);
  }
  /// Means under what nodes stand for; empty for levels.
  [[nodiscard]] const Means& means() const { return means_; }
  /// Probability of level i against that of level i - 1.
  [[nodiscard]] double weight_ratio(int i) const {
    if (neighbours_only()) return at(i - 1).up / at(i).down;
    const double* here = &probability_[static_cast<std::size_t>(i - lowest_)];
    return here[0] / here[-1];
  }
  /// The place of a level in the list of which the table was made.
  [[nodiscard]] std::size_t listed(int i) const {
    const auto place = static_cast<std::size_t>(i - lowest_);
    return order_.empty() ? place : order_[place];
  }

  [[nodiscard]] int mode() const { return mode_; }  ///< a level of largest probability
  [[nodiscard]] double mean() const { return mean_; }
  [[nodiscard]] double variance() const { return variance_; }
  /// int_0^infinity Cov(X_0, X_t) dt [force^2 time].
  [[nodiscard]] double intensity() const { return intensity_; }
  /// What intensity() is to speeds that need X to stay high: where a force f slows a body, its
  /// density falls like exp(-theta v), theta > 0 the root of lim log E[exp(theta int_0^t (X - m -
  /// f))]/t = 0; the largest f/theta over forces from `least` to `most`, and intensity() if that is
  /// more. O(levels). Where jumps lead further, of a few such forces, and at least the largest
  /// strength at any frequency, which a narrow band has away from 0.
  [[nodiscard]] double tail_intensity(double least, double most) const;
  /// The same over all forces.
  [[nodiscard]] double upper_tail() const { return upper_tail_; }
  [[nodiscard]] double rate() const { return rate_; }  ///< largest rate of leaving a level
  [[nodiscard]] double step() const { return step_; }  ///< smallest distance of neighbours
  /// Whether -X is the same chain; and whether level -i then mirrors level i, which needs one at 0
  /// and is of use where jumps are to neighbours.
  [[nodiscard]] bool even() const { return even_; }
  /// Whether -X is this chain with its levels in the reverse order. Several levels at x = 0 may be
  /// their own mirror images; then it is not.
  [[nodiscard]] bool even_in_order() const { return even_ && reversed_; }
  [[nodiscard]] bool symmetric() const {
    return even_ && neighbours_only() && levels_.size() % 2 == 1;
  }
  /// The chain on low <= i <= high alone, as far as they exist; what is known of the whole stays.
  /// Where jumps lead further, all of it.
  [[nodiscard]] LevelTable within(int low, int high) const;
  /// The chain of -X, level -i for level i.
  [[nodiscard]] LevelTable mirrored() const;

 private:
  LevelTable() = default;
  // A force that slows bodies, and the decay theta of their density under it.
  struct Decay {
    double force, theta;
  };
  void find_moments();
  void add_edges(const std::vector<double>& w, const std::vector<double>& part, double total);
  void find_tails();
  [[nodiscard]] std::vector<Decay> find_decays() const;
  [[nodiscard]] bool decays(double theta, double force) const;

  std::vector<Level> levels_;  // where jumps lead further, with the rates of all that go up or down
  std::vector<std::vector<Jump>> jumps_;      // by place; none where jumps are to neighbours
  std::vector<double> probability_;           // beside these, as what follows
  std::vector<Decay> decays_, lower_decays_;  // those of -X
  double peak_intensity_ = 0;
  std::vector<std::size_t> order_;  // of the list of states, by place
  int lowest_ = 0, mode_ = 0;
  double upper_tail_ = 0, lower_tail_ = 0;
  double mean_ = 0, variance_ = 0, intensity_ = 0, rate_ = 0, step_ = 0;
  bool even_ = true, reversed_ = true;
  bool projected_ = false, continuous_ = false;
  std::shared_ptr<const Shown> shown_, by_position_;
  Means means_;
  std::vector<std::vector<Jump>> upwards_, downwards_;  // by place, per distance
  std::vector<double> position_, noise_;
  double centre_ = 0;
  decltype(Projection::value_at) value_at_;
};

/// Levels that are no such chain: what() says why, row() in which of them, from 0; in none
/// if it is their number.
class UnfitTable : public std::invalid_argument {
 public:
  UnfitTable(std::size_t row, const std::string& why) : std::invalid_argument(why), row_(row) {}
  [[nodiscard]] std::size_t row() const { return row_; }

 private:
  std::size_t row_;
};

class GaussianNoise;

/// A chain on levels x_i, lowest() <= i <= highest(), x rising. Its members are all that the
/// discretisations and the simulation know of the noise. Two kinds:
///
/// A discrete Ornstein-Uhlenbeck process (eq. (2.2) of the paper, with the factor x restored in
/// alpha), x_i = i delta, |i| <= N, of standard deviation sigma, without its own 1/sqrt(tau):
///
///   Q f(x_i) = Lambda (alpha_i f(x_{i+1}) - f(x_i) + (1 - alpha_i) f(x_{i-1})),
///   Lambda = 2 sigma^2/(tau delta^2),  alpha_i = (1 - delta x_i/(2 sigma^2))/2,
///   alpha_N = 0, alpha_-N = 1.
///
/// It tends to the Ornstein-Uhlenbeck process as delta -> 0. With the full range N = 2
/// sigma^2/delta^2 it is the Ehrenfest urn of 2N balls: a binomial distribution of variance
/// sigma^2.
///
/// Or the chain of a table, whose jumps may be of any length.
struct NoiseChain {
  double tau = 1;                                ///< correlation time [time]
  double delta = 1;                              ///< step of the noise [force]
  int levels = 1;                                ///< N, number of levels on each side of 0
  std::optional<double> deviation = {};          ///< sigma [force]
  std::shared_ptr<const LevelTable> table = {};  ///< what counts instead, if there is one
  /// The noise of continuous paths of which the table is a projection, if it is one.
  std::shared_ptr<const GaussianNoise> gaussian = {};

  [[nodiscard]] int lowest() const { return table ? table->lowest() : -levels; }
  [[nodiscard]] int highest() const { return table ? table->highest() : levels; }
  [[nodiscard]] int count() const { return highest() - lowest() + 1; }
  /// x_i [force].
  [[nodiscard]] double level(int i) const { return table ? table->at(i).x : i * delta; }
  /// Whether the levels are those of the noise, and not nodes of a process of continuous paths.
  [[nodiscard]] bool has_levels() const { return !table || table->has_levels(); }
  /// Whether these nodes are of a noise of continuous paths.
  [[nodiscard]] bool continuous() const { return table && table->continuous(); }
  /// Whether the body has a position.
  [[nodiscard]] bool has_positions() const { return table && table->has_positions(); }
  [[nodiscard]] double position(int i) const { return table->position(i); }
  /// The noise alone, without a spring.
  [[nodiscard]] double noise(int i) const { return table ? table->noise(i) : i * delta; }
  /// The same, with the position where the body has one.
  [[nodiscard]] Place place_of(int i) const {
    return table ? table->place_of(i) : Place(i * delta);
  }
  /// Whether there are means under what nodes stand for.
  [[nodiscard]] bool has_means() const { return table && table->means(); }
  /// f of the noise on all levels, by place; `averaged`, of nodes its means under what they stand
  /// for, so that f need not be smooth.
  [[nodiscard]] std::vector<double> values(const FunctionOfNoise& f, bool averaged) const;
  /// Calls visit(level, rate per distance) for what a motion upwards changes.
  template <class Visit>
  void for_each_carried(int i, Visit visit) const {
    if (table) table->for_each_carried(i, visit);
  }
  /// The forces at which a distribution is shown; null where these are the levels.
  [[nodiscard]] const Shown* shown() const { return table ? table->shown() : nullptr; }
  /// Whether all jumps are to neighbouring levels.
  [[nodiscard]] bool neighbours_only() const { return !table || table->neighbours_only(); }
  /// Calls visit(level, rate) for the jumps from level i, from the lowest one up.
  template <class Visit>
  void for_each_jump(int i, Visit visit) const {
    if (table) return table->for_each_jump(i, visit);
    if (i > -levels) visit(i - 1, down_rate(i));
    if (i < levels) visit(i + 1, up_rate(i));
  }
  /// Rates of all jumps from level i to higher and to lower ones [1/time].
  [[nodiscard]] double up_rate(int i) const { return table ? table->at(i).up : rate() * up(i); }
  [[nodiscard]] double down_rate(int i) const {
    return table ? table->at(i).down : rate() * down(i);
  }
  /// Rate of leaving level i; the largest of them, Lambda.
  [[nodiscard]] double rate(int i) const {
    return table ? table->at(i).up + table->at(i).down : rate();
  }
  [[nodiscard]] double rate() const {
    return table ? table->rate() : 2 / (tau * delta * precision() * delta);
  }
  /// alpha_i, the probability that a jump from x_i goes up, and 1 - alpha_i without subtraction.
  [[nodiscard]] double up(int i) const;
  [[nodiscard]] double down(int i) const;

  /// Distance of neighbouring levels, the smallest one.
  [[nodiscard]] double step() const { return table ? table->step() : delta; }
  [[nodiscard]] double mean() const { return table ? table->mean() : 0; }
  [[nodiscard]] double standard_deviation() const;
  /// int_0^infinity Cov(X_0, X_t) dt = sigma^2 tau: over long times X is white noise of twice this
  /// strength [force^2 time]. Without a table that of the full range; see power_spectral_density().
  [[nodiscard]] double intensity() const;
  /// The same for large speeds; see LevelTable.
  [[nodiscard]] double tail_intensity() const { return table ? table->upper_tail() : intensity(); }
  /// The same where forces from `least` to `most` slow bodies.
  [[nodiscard]] double tail_intensity(double least, double most) const {
    return table ? table->tail_intensity(least, most) : intensity();
  }
  /// intensity()/variance [time].
  [[nodiscard]] double correlation_time() const;

  /// Highest level <= x, and lowest one >= x, where rounding counts as equal; lowest() - 1 and
  /// highest() + 1 where there is none.
  [[nodiscard]] int last_up_to(double x) const;
  [[nodiscard]] int first_from(double x) const;
  /// The level with x_i = x up to rounding.
  [[nodiscard]] std::optional<int> find(double x) const;
  /// i + 1/2 for x between the levels i and i + 1 halfway: linear between levels and beyond.
  [[nodiscard]] double place(double x) const;

  /// Whether -X is the same chain; and level -i the mirror image of level i, with 0 a level.
  [[nodiscard]] bool even() const { return !table || table->even(); }
  /// Whether -X is this chain with its levels in the reverse order.
  [[nodiscard]] bool even_in_order() const { return !table || table->even_in_order(); }
  [[nodiscard]] bool symmetric() const { return !table || table->symmetric(); }
  /// The chain of -X, level -i for level i.
  [[nodiscard]] NoiseChain mirrored() const;

  /// Without a table: derivatives by tau at fixed N of Lambda, alpha_i and 1 - alpha_i.
  [[nodiscard]] double rate_change() const { return (deviation ? -1 : -2) * rate() / tau; }
  [[nodiscard]] double up_change(int i) const;
  [[nodiscard]] double down_change(int i) const { return -up_change(i); }

 private:
  // 1/sigma^2.
  [[nodiscard]] double precision() const { return deviation ? 1 / (*deviation * *deviation) : tau; }
};

/// Largest N for which every alpha_i is a probability: floor(2 sigma^2/delta^2), safe to rounding.
/// Throws std::out_of_range when it does not fit an int.
[[nodiscard]] int full_range(double tau, double delta, std::optional<double> deviation = {});

/// pi(x_i)/pi(x_{i-1}); from detailed balance where jumps are to neighbours.
[[nodiscard]] double weight_ratio(const NoiseChain& chain, int i);

/// Stationary probabilities from the lowest level up. Positive products and sums only, so that
/// every entry has full relative accuracy down to underflow. O(levels).
[[nodiscard]] std::vector<double> stationary_distribution(const NoiseChain& chain);

/// Relative rounding of sums of positive terms over levels: weights are products of up to N
/// factors, each rounded, and the bulk of the distribution holds about sqrt(N) of them.
[[nodiscard]] double rounding_of_sums(const NoiseChain& chain);

/// P(low <= i <= high), the rest, and moments, each a sum of its own terms. O(levels) time, O(1)
/// space.
struct NoiseMoments {
  double within;
  double beyond;
  double square;  ///< E[X^2]
};
[[nodiscard]] NoiseMoments noise_moments(const NoiseChain& chain, int low, int high);

// The power spectral density of the noise.

/// S_X(omega) = int Cov(X_0, X_t) exp(-i omega t) dt over all t [force^2 time] of a stationary
/// chain: 2 Re sum_n p_n f_n phi_n with (i omega - Q) phi = f, f = x - E[X]. O(levels band^2),
/// jumps leading over at most `band` levels.
[[nodiscard]] double power_spectral_density(const NoiseChain& chain, double omega);

}  // namespace stickslip::model
