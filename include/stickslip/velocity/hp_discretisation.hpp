#pragma once
/// hp discontinuous Galerkin discretisation of one velocity branch.

#include <map>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "stickslip/model/drag.hpp"
#include "stickslip/velocity/velocity_discretisation.hpp"

namespace stickslip::velocity {

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

  [[nodiscard]] std::span<const double> nodes() const override { return nodes_; }
  [[nodiscard]] std::span<const double> weights() const override { return weights_; }
  [[nodiscard]] double v_max() const override { return ends_.back(); }
  [[nodiscard]] std::span<const double> cells() const override { return ends_; }
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
  [[nodiscard]] std::unique_ptr<VelocityDiscretisation> up_to(double speed) const override;
  [[nodiscard]] std::unique_ptr<VelocityDiscretisation> split_at(double speed) const override;

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

  std::vector<double> ends_;
  std::vector<Element> elements_;
  std::map<int, ReferenceElement> finer_;  // with 2q + 1 nodes, by q
  std::vector<int> element_of_;            // by node
  std::vector<double> nodes_, weights_;
  model::Drag drag_;
  std::vector<double> drag_at_nodes_, drag_at_ends_;
};

}  // namespace stickslip::velocity
