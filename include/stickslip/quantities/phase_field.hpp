#pragma once
/// A function on the whole (x, v) grid.

#include <memory>
#include <vector>

#include "stickslip/operators/discretisation.hpp"
#include "stickslip/operators/system_key.hpp"

namespace stickslip::operators {
class StateSpace;
}

namespace stickslip::quantities {

/// Values by rows of x_i, |i| <= N, and columns of v, -v_max ... v_max without 0, kept by noise
/// nodes, of which whole groups are owned by ranks.
class PhaseField {
 public:
  /// How values on noise nodes stand for those on levels.
  enum class Kind {
    function,  ///< u_i = sum_l P_il u_l
    measure    ///< nu_i = sum_l T_il nu_l
  };

  /// All zero.
  PhaseField(const operators::Discretisation& discretisation, const operators::StateSpace& states,
             Kind kind);

  /// Adds to the velocity node of a branch on a noise node counted along it: (x_n, v) of the
  /// positive one, (-x_n, -v) of the negative one. A noise node of this rank.
  void add(operators::Branch branch, int noise, int node, double value);

  [[nodiscard]] const std::vector<double>& x() const { return x_; }
  [[nodiscard]] const std::vector<double>& v() const { return v_; }
  /// Levels of this rank, counted from the lowest of all, and their rows. O(levels velocity nodes).
  [[nodiscard]] std::vector<std::size_t> local_levels() const;
  [[nodiscard]] std::vector<double> local_rows() const;

 private:
  // Calls visit(group) for the groups of this rank, rising.
  template <class Visit>
  void for_each_group(Visit visit) const;
  [[nodiscard]] std::size_t row_start(int noise) const;

  std::shared_ptr<const noise::Nodes> noise_;
  int lowest_;
  Kind kind_;
  std::vector<double> x_, v_;
  std::vector<int> local_noise_;
  std::vector<double> by_node_;
};

}  // namespace stickslip::quantities
