#pragma once
/// lambda - L on one velocity element and all noise nodes.

#include <cstddef>
#include <span>
#include <variant>
#include <vector>

#include "stickslip/generator/noise_nodes.hpp"
#include "stickslip/generator/system_key.hpp"
#include "stickslip/generator/velocity_methods.hpp"
#include "stickslip/linalg/dense.hpp"

namespace stickslip::generator {

// A linear map as a sequence of small steps.

/// A linear map of lists in place, of several at once, by columns. Each step adds a multiple of one
/// part of the list to another, or solves a small system on one; the transposed map runs the
/// transposed steps from the last to the first, so that one description serves both. For double and
/// std::complex<double>. Local.
template <class Scalar>
class LinearSteps {
 public:
  using Scalars = std::vector<Scalar>;
  using Matrix = linalg::Matrix<Scalar>;
  using Factors = linalg::LuFactors<Scalar>;
  using Lists = linalg::Columns<Scalar>;

  /// w[to] += weight w[from].
  struct Coupling {
    std::size_t from, to;
    Scalar weight;
  };
  /// LU factors of a tridiagonal matrix: pivots, multipliers, upper diagonal; below[0] and the last
  /// of `above` mean nothing.
  struct Tridiagonal {
    Scalars diagonal, below, above;
    /// Factors in place, without exchanges.
    void factor();
    void solve(Lists x, bool transposed) const;

   private:
    void solve_one(Scalar* x, bool transposed) const;
  };

  /// w[to ...] += A w[from ...].
  void add(Matrix a, std::size_t from, std::size_t to);
  /// One after the other.
  void add(std::vector<Coupling> couplings);
  /// w[to ...] += sum_l c_l w[from + l block ...], of `block` entries; and w[to + l block ...] +=
  /// c_l w[from ...] for all l.
  void contract(std::span<const double> c, int block, std::size_t from, std::size_t to);
  void spread(std::span<const double> c, int block, std::size_t from, std::size_t to);
  /// w[at ...] <- A^-1 w[at ...].
  void solve(Factors a, std::size_t at);
  void solve(Tridiagonal a, std::size_t at);

  /// w <- M w, or M^T w. Factors are read once for all lists. O(entries lists).
  void run(Lists w, bool transposed) const;

  /// Numbers kept.
  [[nodiscard]] double entries() const;

 private:
  struct Product {
    Matrix a;
    std::size_t from, to;
  };
  struct Contraction {
    std::vector<double> c;
    int block;
    std::size_t one, many;  // places of the block and of its multiples
    bool spreads;
    void run(Lists w, bool transposed) const;
  };
  template <class Kind>
  struct Solve {
    Kind a;
    std::size_t at;
  };
  using Step =
      std::variant<Product, std::vector<Coupling>, Contraction, Solve<Factors>, Solve<Tridiagonal>>;
  static void add(const std::vector<Coupling>& couplings, Scalar* w, bool transposed);

  std::vector<Step> steps_;
};

/// First noise node with a positive speed, `speeds` rising, where drag adds `drag` to them.
[[nodiscard]] int first_rising(std::span<const double> speeds, double drag);

/// The rows of lambda - L on the element [a, b] of a velocity branch, decoupled from its
/// neighbours. At each end every noise node has one value that crosses it: the element takes those
/// beyond b on nodes with B(b) > 0 and beyond a on those with B(a) <= 0, and gives its own at a on
/// nodes with B(a) > 0 and at b on those with B(b) <= 0. Speeds B rise with the noise, so that each
/// of these sets is a range of nodes.
///
/// Along the noise the system is block tridiagonal over groups, its couplings of the rank of the
/// element's nodes times the levels to which jumps from the next group lead: the first or the last
/// one alone where the noise jumps to neighbours. LU factors by groups. Lists run by noise nodes 0
/// ... M-1, then by the q nodes of the element; functions take several at once. For double and
/// std::complex<double>. Local.
template <class Scalar>
class ElementSystem {
 public:
  using Scalars = std::vector<Scalar>;
  using Matrix = linalg::Matrix<Scalar>;
  using Lists = linalg::Columns<Scalar>;

  /// What the values beyond the ends make of those given, by sides:
  ///
  ///   (values at a) = inner_inner (beyond a) + inner_outer (beyond b),
  ///   (values at b) = outer_inner (beyond a) + outer_outer (beyond b).
  struct Response {
    Matrix inner_inner, inner_outer, outer_inner, outer_outer;
  };

  /// For the speeds x_l + g - mu_d + b(v), `net_force` being x_l + g - mu_d by node, `shift` along
  /// the branch; the response goes to `response`. O(M q^3 groups' sizes^2 + M^2 q). Throws
  /// NotReached if a block is singular.
  ElementSystem(const Nodes& noise, const HpDiscretisation& velocities, int element,
                std::span<const double> net_force, const Shift<Scalar>& shift, Response& response);

  [[nodiscard]] int size() const { return count_ * nodes_; }
  [[nodiscard]] int nodes() const { return nodes_; }       ///< q
  [[nodiscard]] int first_node() const { return first_; }  ///< on the velocity discretisation

  /// Places of a list for solve(): the unknowns, and room for the steps.
  [[nodiscard]] int length() const { return length_; }
  /// X <- A^-1 X, or A^-T X, lists of length() places.
  void solve(Lists x, bool transposed) const;

  /// What passes the ends, by place in a list; 0 where nothing does.
  struct Ports {
    std::vector<double> inner, outer;
  };
  /// Rates at which values beyond the ends are taken; weights of the values given at the ends.
  [[nodiscard]] const Ports& taken() const { return taken_; }
  [[nodiscard]] const Ports& given() const { return given_; }
  /// Adds to the values of all noise nodes at both ends what a list sends there.
  void collect(const Ports& ports, Lists x, Lists at_inner, Lists at_outer) const;
  /// Adds to a list what those values send.
  void distribute(const Ports& ports, Lists at_inner, Lists at_outer, Lists x) const;

  /// Of the factors.
  [[nodiscard]] double entries() const { return steps_.entries(); }

 private:
  class Elimination;

  int count_, nodes_, first_, length_ = 0;
  Ports taken_, given_;
  std::vector<double> killed_;  // rates, by place in a list
  LinearSteps<Scalar> steps_;
};

}  // namespace stickslip::generator
