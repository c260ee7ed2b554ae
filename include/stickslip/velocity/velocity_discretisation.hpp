#pragma once
/// A discretised velocity branch v > 0, seen by the operators through a few rows and weights.

#include <functional>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace stickslip::velocity {

/// One entry of a sparse row over the nodes of a velocity discretisation.
struct Entry {
  int node;
  double value;
};

/// A row of the transport operator T with (T u)_j ~ B(v_j) u'(v_j), upwinded for the backward
/// equation (information comes from where the flow goes). Besides the nodes it may refer to the
/// inflow, the value of u where a body comes to rest at v = 0, and to the outflow, the value of u
/// on the holding state at v_max. With both, the diagonal that is left out and, of opposite sign,
/// what is killed, a row sums to zero.
struct TransportRow {
  std::vector<Entry> entries;  ///< sorted by node, without the diagonal
  double inflow = 0;           ///< coefficient of u(0)
  double outflow = 0;          ///< coefficient of the holding state
  double killed = 0;           ///< rate of reaching a speed at which bodies are killed
};

/// The derivative of the speed B(v) with respect to a parameter.
using SpeedChange = std::function<double(double v)>;

/// A velocity discretisation on [0, v_max] for the speeds B(v) = net_force + b(v).
/// Implementations are immutable; all members are local and cost O(size) unless stated.
class VelocityDiscretisation {
 public:
  virtual ~VelocityDiscretisation() = default;

  /// Nodes v_j > 0 in rising order [velocity].
  [[nodiscard]] virtual std::span<const double> nodes() const = 0;
  /// Weights with sum_j w_j f(v_j) ~ int_0^v_max f(v) dv.
  [[nodiscard]] virtual std::span<const double> weights() const = 0;
  /// End of the velocity discretisation [velocity].
  [[nodiscard]] virtual double v_max() const = 0;
  /// Ends 0 = e_0 < e_1 < ... of the cells by which fields are compared between discretisations.
  [[nodiscard]] virtual std::span<const double> cells() const = 0;

  /// Row j of T for the speed B(v) = net_force + b(v), into the storage of `row`. O(its entries).
  virtual void transport(double net_force, int j, TransportRow& row) const = 0;
  /// Derivative of that row where B changes by dB, upwinded as B is. O(its entries).
  virtual void transport_change(double net_force, const SpeedChange& change, int j,
                                TransportRow& row) const = 0;
  /// u(0+) as a combination of nodal values; empty when the velocity discretisation keeps a state
  /// of its own at v = 0 on the levels that leave it (`keeps_origin`).
  [[nodiscard]] virtual std::vector<Entry> trace_at_zero() const = 0;
  /// u(v_max) as a combination of nodal values.
  [[nodiscard]] virtual std::vector<Entry> trace_at_top() const = 0;

  /// u(v) for 0 < v <= v_max as a combination of nodal values.
  [[nodiscard]] virtual std::vector<Entry> value_at(double v) const = 0;

  /// Mass on (0, v] of a measure given by the masses of the nodes. O(size).
  [[nodiscard]] virtual double mass_below(std::span<const double> mass, double v) const = 0;

  /// By node, what sums over nodes overlook of a function: (1/w_j) int l_j f - f(v_j), the integral
  /// by a rule with other points. A product with a measure on the nodes is the error of the sum
  /// with f, as far as these points see it; 0 for polynomials of the degrees of the elements, and
  /// where nodes are all there is, on a grid. Evaluates f at twice as many points as there are
  /// nodes.
  [[nodiscard]] virtual std::vector<double>
  overlooked(const std::function<double(double)>& f) const {
    (void)f;
    return std::vector<double>(static_cast<std::size_t>(size()), 0.0);
  }

  /// Whether the levels above the static threshold own a state at v = 0 (a grid scheme does).
  [[nodiscard]] virtual bool keeps_origin() const = 0;
  /// Rate at which such a state moves on to the first node: speed over spacing.
  [[nodiscard]] virtual double origin_rate(double net_force) const = 0;
  /// Whether levels that still accelerate at v_max need a holding state there.
  [[nodiscard]] virtual bool needs_holding() const = 0;

  /// Whether bodies that reach v_max are killed there, instead of waiting.
  [[nodiscard]] bool kills_at_top() const {
    return kills_above(static_cast<int>(cells().size()) - 2);
  }
  /// Whether bodies of either branch are killed somewhere.
  [[nodiscard]] bool kills() const { return kills_ || (mirrored_ && mirrored_->kills_); }
  /// The same on [0, speed], where bodies are killed that reach `speed` > 0, as fine there as at
  /// v = 0; of both branches.
  [[nodiscard]] std::shared_ptr<const VelocityDiscretisation> killing_at(double speed) const {
    auto own = up_to(speed);
    own->last_below_ = static_cast<int>(own->cells().size()) - 2;
    own->kills_ = true;
    if (mirrored_) own->set_mirrored(mirrored_->killing_at(speed));
    return own;
  }
  /// The same with a cell that ends at `speed`, as fine below it as at v = 0, and what is beyond:
  /// bodies that rise to it are killed on this branch, on the other one, on both or on none.
  [[nodiscard]] std::shared_ptr<const VelocityDiscretisation> passing(double speed, bool here,
                                                                      bool there) const {
    auto own = split_at(speed);
    own->kills_ = here;
    if (mirrored_ || here != there) {
      auto lower = mirrored().split_at(speed);
      lower->kills_ = there;
      own->set_mirrored(std::move(lower));
    }
    return own;
  }

  /// The velocity discretisation of the negative branch, where speeds are net_force - b(-v); this
  /// one for an odd b. It has the same nodes.
  [[nodiscard]] const VelocityDiscretisation& mirrored() const {
    return mirrored_ ? *mirrored_ : *this;
  }
  void set_mirrored(std::shared_ptr<const VelocityDiscretisation> lower) {
    mirrored_ = std::move(lower);
  }

  [[nodiscard]] int size() const { return static_cast<int>(nodes().size()); }

 protected:
  VelocityDiscretisation() = default;
  VelocityDiscretisation(const VelocityDiscretisation&) = default;
  VelocityDiscretisation& operator=(const VelocityDiscretisation&) = default;

  /// Whether bodies are killed that rise out of a cell.
  [[nodiscard]] bool kills_above(int cell) const { return kills_ && cell == last_below_; }
  void end_at_speed(int cell) { last_below_ = cell; }

 private:
  [[nodiscard]] virtual std::unique_ptr<VelocityDiscretisation> up_to(double speed) const = 0;
  /// With end_at_speed() of the cell below the speed.
  [[nodiscard]] virtual std::unique_ptr<VelocityDiscretisation> split_at(double speed) const = 0;

  bool kills_ = false;
  int last_below_ = -1;
  std::shared_ptr<const VelocityDiscretisation> mirrored_;
};

}  // namespace stickslip::velocity
