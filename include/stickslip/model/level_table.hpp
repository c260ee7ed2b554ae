#pragma once
/// Birth-death chains given level by level.

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

/// A chain that reaches each of its levels from each other one: of the rates only that below the
/// lowest level and that above the highest one are 0. It is reversible. Level 0 is the one nearest
/// to x = 0, the upper one of two. Immutable. O(levels) to make.
class LevelTable {
 public:
  /// At least two levels, rising. Throws UnfitTable.
  explicit LevelTable(std::vector<Level> levels);

  [[nodiscard]] int lowest() const { return lowest_; }
  [[nodiscard]] int highest() const { return lowest_ + static_cast<int>(levels_.size()) - 1; }
  [[nodiscard]] const Level& at(int i) const {
    const int place = i - lowest_;
    return levels_[static_cast<std::size_t>(place)];
  }

  [[nodiscard]] int mode() const { return mode_; }  ///< a level of largest probability
  [[nodiscard]] double mean() const { return mean_; }
  [[nodiscard]] double variance() const { return variance_; }
  /// int_0^infinity Cov(X_0, X_t) dt [force^2 time].
  [[nodiscard]] double intensity() const { return intensity_; }
  /// What intensity() is to speeds that need X to stay high: where a force f slows a body, its
  /// density falls like exp(-theta v), theta > 0 the root of lim log E[exp(theta int_0^t (X - m -
  /// f))]/t = 0; the largest f/theta over forces from `least` to `most`, and intensity() if that is
  /// more. O(levels).
  [[nodiscard]] double tail_intensity(double least, double most) const;
  /// The same over all forces.
  [[nodiscard]] double upper_tail() const { return upper_tail_; }
  [[nodiscard]] double rate() const { return rate_; }  ///< largest rate of leaving a level
  [[nodiscard]] double step() const { return step_; }  ///< smallest distance of neighbours
  /// Whether -X is the same chain; and whether level -i then mirrors level i, which needs one at 0.
  [[nodiscard]] bool even() const { return even_; }
  [[nodiscard]] bool symmetric() const { return even_ && levels_.size() % 2 == 1; }
  /// The chain on low <= i <= high alone, as far as they exist; what is known of the whole stays.
  [[nodiscard]] LevelTable within(int low, int high) const;
  /// The chain of -X, level -i for level i.
  [[nodiscard]] LevelTable mirrored() const;

 private:
  [[nodiscard]] bool decays(double theta, double force) const;

  std::vector<Level> levels_;
  int lowest_, mode_ = 0;
  double upper_tail_ = 0, lower_tail_ = 0;
  double mean_ = 0, variance_ = 0, intensity_ = 0, rate_ = 0, step_ = 0;
  bool even_ = true;
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
