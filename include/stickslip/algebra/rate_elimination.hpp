#pragma once
/// Chains given by rates: times, integrals and stationary probabilities without subtraction.

#include <cstddef>
#include <span>
#include <vector>

namespace stickslip::algebra {

/// K - Q on the states 0 ... n-1 of a chain that jumps from state i to state j at the rate Q_ij and
/// is killed in state i at the rate K_i, factored once.
///
/// All members use the elimination of Grassmann, Taksar and Heyman on (jump rates, killing rates)
/// instead of (diagonal, off-diagonals): rates are only added, multiplied and divided, never
/// subtracted. Results have full relative accuracy in every entry, whatever the time scale, if what
/// they are asked about is >= 0. States are eliminated from the first one up: what is left on i,
/// i+1, ... is the chain watched there. Where jumps lead over at most b states memory is O(n b) and
/// time O(n b^2). Local.
class RateElimination {
 public:
  struct Rate {
    int from, to;
    double value;
  };
  /// Rates of killing by state, and of jumps. Throws std::invalid_argument where a state is neither
  /// left nor killed; the last state may be that if nothing at all is killed.
  RateElimination(std::vector<double> killing, const std::vector<Rate>& rates);

  [[nodiscard]] int size() const { return static_cast<int>(killing_.size()); }

  /// m with m (K - Q) = entry: mean time in each state of a chain that starts by `entry`.
  [[nodiscard]] std::vector<double> occupation(std::span<const double> entry) const;
  /// u with (K - Q) u = f: the mean integral of f until the chain is killed, by its first state.
  [[nodiscard]] std::vector<double> integral(std::vector<double> f) const;
  /// p with p Q = 0 and sum 1, where nothing is killed.
  [[nodiscard]] std::vector<double> stationary() const;

 private:
  void factor();
  [[nodiscard]] double& entry(int row, int column) { return rates_[at(row, column)]; }
  [[nodiscard]] double entry(int row, int column) const { return rates_[at(row, column)]; }
  [[nodiscard]] std::size_t at(int row, int column) const {
    const int place = column - row + band_;
    return static_cast<std::size_t>(row) * (2 * static_cast<std::size_t>(band_) + 1) +
           static_cast<std::size_t>(place);
  }
  [[nodiscard]] int last_of(int row) const;

  int band_ = 0;
  std::vector<double> killing_, rates_, pivot_;
};

}  // namespace stickslip::algebra
