#pragma once
/// A function on the whole (x, v) grid, made from its folded half.

#include <vector>

#include "stickslip/operators/state_space.hpp"

namespace stickslip::quantities {

/// Values by rows of x_i, |i| <= N, and columns of v, -v_max ... v_max without 0; rows of whole
/// levels are owned by ranks.
class PhaseField {
 public:
  /// All zero. `states` must be folded.
  PhaseField(const model::Process& process, const velocity::Axis& axis,
             const operators::StateSpace& states);

  /// Adds to (x_level, v_node) and, times `sign`, to its mirror image (-x_level, -v_node). A level
  /// of this rank.
  void add(int level, int node, double value, double sign);

  [[nodiscard]] const std::vector<double>& x() const { return x_; }
  [[nodiscard]] const std::vector<double>& v() const { return v_; }
  [[nodiscard]] const std::vector<int>& local_levels() const { return local_levels_; }
  [[nodiscard]] const std::vector<double>& local_rows() const { return local_rows_; }

 private:
  [[nodiscard]] std::size_t row_start(int level) const;

  std::vector<double> x_, v_;
  std::vector<int> local_levels_;
  std::vector<double> local_rows_;
};

}  // namespace stickslip::quantities
