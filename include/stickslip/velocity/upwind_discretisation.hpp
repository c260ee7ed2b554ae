#pragma once
/// First-order upwind differences on a uniform grid: the scheme of the paper.

#include <span>
#include <vector>

#include "stickslip/model/drag.hpp"
#include "stickslip/velocity/velocity_discretisation.hpp"

namespace stickslip::velocity {

/// Nodes v_j = j h, j = 1 ... J, with
///
///   (T u)_j = max(B_j, 0) (u_{j+1} - u_j)/h + min(B_j, 0) (u_j - u_{j-1})/h      (section 4.2),
///
/// u_0 being the inflow value. Levels above the static threshold own a state at v = 0. At the last
/// node a positive speed is dropped, which makes it a holding state. Off-diagonals are >= 0 and
/// rows sum to 0: T generates a Markov chain. Order 1 in h. Where bodies are killed, v_(J+1) is
/// where.
class UpwindDiscretisation final : public VelocityDiscretisation {
 public:
  /// `count` >= 1 nodes of spacing `spacing` > 0.
  UpwindDiscretisation(double spacing, int count, const model::Drag& drag);

  [[nodiscard]] std::span<const double> nodes() const override { return nodes_; }
  [[nodiscard]] std::span<const double> weights() const override { return weights_; }
  [[nodiscard]] double v_max() const override { return nodes_.back(); }
  [[nodiscard]] std::span<const double> cells() const override { return cells_; }
  void transport(double net_force, int j, TransportRow& row) const override;
  void transport_change(double net_force, const SpeedChange& change, int j,
                        TransportRow& row) const override;
  [[nodiscard]] std::vector<Entry> trace_at_zero() const override { return {}; }
  [[nodiscard]] std::vector<Entry> trace_at_top() const override { return {{size() - 1, 1.0}}; }
  [[nodiscard]] std::vector<Entry> value_at(double v) const override;
  [[nodiscard]] double mass_below(std::span<const double> mass, double v) const override;
  [[nodiscard]] bool keeps_origin() const override { return true; }
  [[nodiscard]] double origin_rate(double net_force) const override { return net_force / spacing_; }
  [[nodiscard]] bool needs_holding() const override { return false; }

 private:
  [[nodiscard]] std::unique_ptr<VelocityDiscretisation> up_to(double speed) const override;
  [[nodiscard]] std::unique_ptr<VelocityDiscretisation> split_at(double speed) const override;

  // The row of a node where the body moves on at `rate`, upwards or downwards by the sign of
  // `direction`.
  void fill(int j, double direction, double rate, TransportRow& row) const;

  double spacing_;
  model::Drag drag_;
  std::vector<double> nodes_, weights_, cells_, drag_at_nodes_;
};

}  // namespace stickslip::velocity
