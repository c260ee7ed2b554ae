#pragma once
/// A discretised velocity branch v > 0, seen by the operators through a few rows and weights.

#include <functional>
#include <map>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "stickslip/model/drag.hpp"

namespace stickslip::generator {

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
  [[nodiscard]] std::span<const double> nodes() const { return nodes_; }
  /// Weights with sum_j w_j f(v_j) ~ int_0^v_max f(v) dv.
  [[nodiscard]] std::span<const double> weights() const { return weights_; }
  /// End of the velocity discretisation [velocity].
  [[nodiscard]] virtual double v_max() const = 0;
  /// Ends 0 = e_0 < e_1 < ... of the cells by which fields are compared between discretisations.
  [[nodiscard]] std::span<const double> cells() const { return ends_; }

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
  /// The same with a cell that ends at `speed` > 0, as fine below it as at v = 0, and `beyond` it
  /// or not: bodies that rise to it are killed on this branch, on the other one, on both or on
  /// none.
  [[nodiscard]] std::shared_ptr<const VelocityDiscretisation> cut_at(double speed, bool beyond,
                                                                     bool here, bool there) const {
    auto own = split(speed, beyond);
    own->kills_ = here;
    if (mirrored_ || here != there) {
      auto lower = mirrored().split(speed, beyond);
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
  explicit VelocityDiscretisation(const model::Drag& drag) : drag_(drag) {}
  VelocityDiscretisation(const VelocityDiscretisation&) = default;
  VelocityDiscretisation& operator=(const VelocityDiscretisation&) = default;

  void add_node(double v, double weight) {
    nodes_.push_back(v);
    weights_.push_back(weight);
    drag_at_nodes_.push_back(drag_(v));
  }
  /// Whether bodies are killed that rise out of a cell.
  [[nodiscard]] bool kills_above(int cell) const { return kills_ && cell == last_below_; }
  void end_at_speed(int cell) { last_below_ = cell; }

  model::Drag drag_;
  std::vector<double> nodes_, weights_, drag_at_nodes_, ends_;  // of cells

 private:
  /// With end_at_speed() of the cell below the speed.
  [[nodiscard]] virtual std::unique_ptr<VelocityDiscretisation> split(double speed,
                                                                      bool beyond) const = 0;

  bool kills_ = false;
  int last_below_ = -1;
  std::shared_ptr<const VelocityDiscretisation> mirrored_;
};

// hp discontinuous Galerkin discretisation of one velocity branch.

/// Gauss-Legendre nodes of one reference element [0, 1] with what its rows are made of.
struct ReferenceElement {
  explicit ReferenceElement(int degree);  ///< degree >= 0; q = degree + 1 nodes

  int size;                        ///< q
  std::vector<double> node;        ///< q
  std::vector<double> weight;      ///< q, sums to 1
  std::vector<double> derivative;  ///< q x q by rows: l_n'(x_m); the diagonal is not set
  std::vector<double> at_left;     ///< l_n(0)
  std::vector<double> at_right;    ///< l_n(1)

  /// l_n(t), n = 0 ... q-1, for t in [0, 1]. O(q).
  [[nodiscard]] std::vector<double> basis(double t) const;
  /// int_0^t l_n, n = 0 ... q-1. O(q^2).
  [[nodiscard]] std::vector<double> integral(double t) const;

 private:
  std::vector<double> barycentric_;
};

/// Elements shared by all noise levels, polynomials of a degree of its own on each, Lagrange basis
/// on the Gauss-Legendre nodes of each element. With u = sum_n u_n l_n and q-point quadrature
/// (exact for linear drag), testing B u' with l_m and dividing by w_m gives on the element [a, b]
///
///   (T u)_m = B(v_m) sum_n l_n'(v_m) u_n
///           + max(B(b), 0) l_m(b)/w_m (u(b+) - u(b-)) + max(-B(a), 0) l_m(a)/w_m (u(a-) - u(a+)),
///
/// the jumps entering where the flow leaves the element. Errors of functionals fall exponentially
/// with the degrees.
class HpDiscretisation final : public VelocityDiscretisation {
 public:
  /// `ends`: element ends from 0 to v_max, rising. `degrees`: of each element, >= 0. Throws
  /// std::invalid_argument if they are not.
  HpDiscretisation(std::vector<double> ends, const std::vector<int>& degrees,
                   const model::Drag& drag);
  /// The same degree everywhere.
  HpDiscretisation(const std::vector<double>& ends, int degree, const model::Drag& drag);

  [[nodiscard]] double v_max() const override { return ends_.back(); }
  void transport(double net_force, int j, TransportRow& row) const override;
  void transport_change(double net_force, const SpeedChange& change, int j,
                        TransportRow& row) const override;
  [[nodiscard]] std::vector<Entry> trace_at_zero() const override;
  [[nodiscard]] std::vector<Entry> trace_at_top() const override;
  [[nodiscard]] std::vector<Entry> value_at(double v) const override;
  [[nodiscard]] double mass_below(std::span<const double> mass, double v) const override;
  [[nodiscard]] std::vector<double>
  overlooked(const std::function<double(double)>& f) const override;
  [[nodiscard]] bool keeps_origin() const override { return false; }
  [[nodiscard]] double origin_rate(double) const override { return 0; }
  [[nodiscard]] bool needs_holding() const override { return !kills_at_top(); }

  struct Element {
    std::shared_ptr<const ReferenceElement> reference;
    int first;  ///< of its nodes
    double length;
  };
  [[nodiscard]] int elements() const { return static_cast<int>(ends_.size()) - 1; }
  [[nodiscard]] const Element& element(int e) const { return elements_[e]; }

  /// b at an end of elements.
  [[nodiscard]] double drag_at_end(int end) const { return drag_at_ends_[end]; }

 private:
  [[nodiscard]] std::unique_ptr<VelocityDiscretisation> split(double speed,
                                                              bool beyond) const override;

  // Ends from 0 to a speed, and the degrees between them.
  [[nodiscard]] std::pair<std::vector<double>, std::vector<int>> below(double speed) const;

  using Trace = std::vector<double> ReferenceElement::*;

  // The row of a node where B is `speed` and the flow leaves its element with the speeds `down` and
  // `up`.
  void fill(int j, double down, double speed, double up, TransportRow& row) const;

  // `factor` times the value of the element at one of its ends, as part of a row.
  void append(int element, double factor, Trace trace, TransportRow& row) const;
  [[nodiscard]] std::vector<Entry> at_end(int element, Trace trace) const;
  [[nodiscard]] std::vector<Entry> entries(int element, std::span<const double> values) const;

  std::vector<Element> elements_;
  std::map<int, ReferenceElement> finer_;  // with 2q + 1 nodes, by q
  std::vector<int> element_of_;            // by node
  std::vector<double> drag_at_ends_;
};

// First-order upwind differences on a uniform grid: the scheme of the paper.

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

  [[nodiscard]] double v_max() const override { return nodes_.back(); }
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
  [[nodiscard]] std::unique_ptr<VelocityDiscretisation> split(double speed,
                                                              bool beyond) const override;

  // The row of a node where the body moves on at `rate`, upwards or downwards by the sign of
  // `direction`.
  void fill(int j, double direction, double rate, TransportRow& row) const;

  double spacing_;
};

}  // namespace stickslip::generator
