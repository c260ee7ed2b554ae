#pragma once
/// Chains given level by level.

#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

namespace stickslip::model {

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

  [[nodiscard]] int lowest() const { return lowest_; }
  [[nodiscard]] int highest() const { return lowest_ + static_cast<int>(levels_.size()) - 1; }
  [[nodiscard]] const Level& at(int i) const {
    const int place = i - lowest_;
    return levels_[static_cast<std::size_t>(place)];
  }

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

}  // namespace stickslip::model
