#pragma once
/// The noise chain on few nodes: functions of x as piecewise polynomials.

#include <memory>
#include <span>
#include <vector>

#include "stickslip/model/process.hpp"

namespace stickslip::generator {

/// How levels are gathered into groups.
struct Grouping {
  int degree = 0;      ///< of the polynomials on a group; 0: every level is a node
  double grading = 2;  ///< levels of a group per level of distance from the nearest special point
  double width = 4;    ///< of the widest group, in standard deviations of the noise
  std::vector<double> special = {};  ///< more special points, as x
};

/// Galerkin projection of the noise chain on piecewise polynomials, held by their values at nodes.
///
/// Consecutive levels form groups. On a group of more than degree + 1 levels functions of x are
/// polynomials, of which the nodes are the Gauss nodes x_l of the stationary weights w_i on its
/// levels, gamma_l their Gauss weights, P_il the cardinal functions, T = diag(w) P diag(gamma)^-1:
///
///   u_i = sum_l P_il u_l,   nu_i = sum_l T_il nu_l,   T^T P = 1,   sum_i T_il = 1,
///
/// for functions u and measures nu. All other levels are nodes themselves, with P = T = 1. Jumps
/// become J = T^T Q P, block tridiagonal over groups, in Dirichlet form
///
///   J_lm = -(1/gamma_l) sum_i w_i Lambda alpha_i (P_(i+1)l - P_il)(P_(i+1)m - P_im),
///
/// so that w stays stationary and rows sum to zero; J_lm may be negative for l != m. Since Gauss
/// rules are exact for x times two such polynomials, speeds at the nodes are all that transport
/// needs. Groups shrink towards the special points of a process, where functions are not smooth:
/// levels on which the speed at v = 0 vanishes, the ends of the static range, and those of the
/// grouping. None contains one, and where -X is the same chain x -> -x maps groups to groups.
///
/// Where the noise jumps further than to neighbours every level is a node, and a group is as many
/// as jumps pass, so that J is block tridiagonal all the same.
///
/// Nodes are numbered first() ... last(), rising; node -n of mirrored() is that of -x_n. Immutable;
/// members are local.
class Nodes {
 public:
  /// O(levels degree^2). Throws std::invalid_argument for a degree below 0 or a grading <= 0.
  Nodes(const model::Process& process, const Grouping& grouping);
  /// Every level a node.
  explicit Nodes(const model::Process& process) : Nodes(process, Grouping{}) {}

  /// Consecutive levels with the nodes that stand for them.
  struct Group {
    int first, last;                    ///< levels
    int begin;                          ///< number of its first node
    int count;                          ///< of nodes
    std::vector<double> value, weight;  ///< P and T, levels x nodes by rows
    /// Rates into the next groups, nodes x levels reached there by rows.
    std::vector<double> to_above, to_below;
    /// The same per distance that the body moves upwards; empty where it has no position.
    std::vector<double> carried_above = {}, carried_below = {};
    /// P on the levels to which the group below jumps, and on those to which the group above does,
    /// levels x nodes by rows: on the first and on the last one, where these are not given.
    std::vector<double> from_below = {}, from_above = {};
    [[nodiscard]] int levels() const { return last - first + 1; }
    [[nodiscard]] std::span<const double> at_first() const {
      return from_below.empty() ? row(value, first) : std::span<const double>(from_below);
    }
    [[nodiscard]] std::span<const double> at_last() const {
      return from_above.empty() ? row(value, last) : std::span<const double>(from_above);
    }
    /// The row of P or T for a level.
    [[nodiscard]] std::span<const double> row(const std::vector<double>& matrix, int level) const {
      const auto from = static_cast<std::size_t>(level - first) * static_cast<std::size_t>(count);
      return std::span(matrix).subspan(from, static_cast<std::size_t>(count));
    }
  };
  [[nodiscard]] const Grouping& grouping() const { return grouping_; }
  [[nodiscard]] const std::vector<Group>& groups() const { return groups_; }
  [[nodiscard]] const Group& group_of(int node) const { return groups_[group_of_[at(node)]]; }
  [[nodiscard]] const Group& group_at(int level) const;
  /// Of a level that is a node, as those next to the static ones.
  [[nodiscard]] int node_at(int level) const {
    return all_levels() ? level : group_at(level).begin;
  }

  [[nodiscard]] int first() const { return first_; }
  [[nodiscard]] int last() const { return first_ + count() - 1; }
  [[nodiscard]] int count() const { return static_cast<int>(x_.size()); }
  [[nodiscard]] double x(int node) const { return x_[at(node)]; }
  /// Whether every level is a node.
  [[nodiscard]] bool all_levels() const { return count() == noise_.count(); }
  /// The nodes of -X, along which the negative velocity branch counts; these for a symmetric chain.
  [[nodiscard]] const Nodes& mirrored() const { return mirrored_ ? *mirrored_ : *this; }

  /// One entry of a row of J.
  struct Rate {
    int node;
    double value;
  };
  /// The row of J at a node without its diagonal, rising.
  [[nodiscard]] std::span<const Rate> jumps(int node) const { return jumps_[at(node)]; }
  /// The same per distance of a body that moves upwards: of its position, where it has one.
  [[nodiscard]] std::span<const Rate> carried(int node) const {
    return carried_.empty() ? std::span<const Rate>() : std::span<const Rate>(carried_[at(node)]);
  }
  /// The same of T^T (dQ/d tau) P, at a fixed number of levels. O(levels of the group).
  [[nodiscard]] std::vector<Rate> jumps_by_tau(int node) const;

  /// The highest node that stands for levels up to `level`, which ends a group.
  [[nodiscard]] int last_up_to(int level) const;

  /// sum_i T_il f(i): what a function on the levels is at a node, so that sums with measures on the
  /// nodes are those with the measures that they stand for.
  template <class Function>
  [[nodiscard]] double projected(int node, Function f) const {
    const Group& g = group_of(node);
    if (g.levels() == 1) return f(g.first);
    double sum = 0;
    for (int i = g.first; i <= g.last; ++i) {
      sum += g.weight[(i - g.first) * g.count + node - g.begin] * f(i);
    }
    return sum;
  }

  /// nu_i = sum_l T_il nu_l on all levels, from values by node, both from the lowest one up.
  /// O(levels degree).
  [[nodiscard]] std::vector<double> spread(std::span<const double> by_node) const;

 private:
  struct Upper;
  enum class Mirror { made, left_out };
  Nodes(const model::Process& process, const Grouping& grouping, Mirror mirror);

  [[nodiscard]] std::size_t at(int node) const {
    const int place = node - first_;
    return static_cast<std::size_t>(place);
  }
  void take_all_levels();
  void couple(const Group& from, const Group& to, std::vector<double>& rates,
              std::vector<double>& per_distance, std::vector<double>& levels) const;
  void join(const Upper& above, const Upper& below);
  void find_jumps();

  model::NoiseChain noise_;
  Grouping grouping_;
  int first_ = 0;
  std::vector<Group> groups_;
  std::vector<std::vector<double>> inner_;  // by group of several levels: rates inside, by rows
  std::vector<std::size_t> group_of_;       // by node
  std::vector<double> x_;
  std::vector<std::vector<Rate>> jumps_, carried_;
  std::shared_ptr<const Nodes> mirrored_;
};

}  // namespace stickslip::generator
