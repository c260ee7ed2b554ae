#pragma once
/// Drag as a piecewise polynomial, which costs the same whatever the drag law.

#include <array>
#include <cstddef>
#include <vector>

#include "stickslip/model/drag.hpp"

namespace stickslip::simulation {

constexpr std::size_t kDragTerms = 8;

/// A polynomial in u - centre that stands for b(u) on [low, high], and a little beyond.
struct DragPanel {
  double low, high;  ///< no other panel has speeds between them
  double from, to;   ///< how far it is right
  double centre;
  std::array<double, kDragTerms> coefficient;  ///< of rising powers
};

/// b(u) for u >= 0. The built-in laws are one panel. Of any other, Chebyshev interpolants on panels
/// that are halved until they agree with it to 2e-14 of its size or to its own rounding, and where
/// they can be by a quarter longer on each side; kinks are found by bisection and end panels.
/// Panels depend on the law alone, and are made as speeds come to need them. Local.
class DragTable {
 public:
  explicit DragTable(const model::Drag& drag);

  /// The panel with low <= speed < high.
  [[nodiscard]] const DragPanel& at(double speed);

 private:
  [[nodiscard]] DragPanel interpolant(double low, double high, double overlap) const;
  [[nodiscard]] double relative_error(const DragPanel& panel) const;
  [[nodiscard]] bool holds(const DragPanel& panel) const;
  [[nodiscard]] double rough_place(double low, double high) const;
  void add(double low, double high, int depth, double error_of_whole);

  model::Drag drag_;
  std::vector<DragPanel> panel_;  // in rising order without gaps
  std::size_t last_ = 0;
  double floor_ = 0;  // of the size to which errors relate
};

}  // namespace stickslip::simulation
