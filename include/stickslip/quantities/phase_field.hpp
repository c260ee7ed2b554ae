#pragma once
/// A function on the whole (x, v) grid.

#include <vector>

#include "stickslip/operators/system_key.hpp"
#include "stickslip/velocity/axis.hpp"

namespace stickslip::operators {
class StateSpace;
}

namespace stickslip::quantities {

/// Values by rows of x_i, |i| <= N, and columns of v, -v_max ... v_max without 0; rows of whole
/// levels are owned by ranks.
class PhaseField {
 public:
  /// All zero.
  PhaseField(const model::Process& process, const velocity::Axis& axis,
             const operators::StateSpace& states);

  /// Adds to the node of a half, levels counted along it: (x_level, v_node) of the upper one,
  /// (-x_level, -v_node) of the lower one. A level of this rank.
  void add(operators::Half half, int level, int node, double value);

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
