#pragma once
/// A linear map as a sequence of small steps.

#include <cstddef>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "stickslip/algebra/dense.hpp"

namespace stickslip::operators {

/// A linear map of lists in place, of several at once, by columns. Each step adds a multiple of one
/// part of the list to another, or solves a small system on one; the transposed map runs the
/// transposed steps from the last to the first, so that one description serves both. For double and
/// std::complex<double>. Local.
template <class Scalar>
class LinearSteps {
 public:
  using Scalars = std::vector<Scalar>;
  using Matrix = algebra::Matrix<Scalar>;
  using Factors = algebra::LuFactors<Scalar>;
  using Lists = algebra::Columns<Scalar>;

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
  /// The steps of another map after those of this one.
  void append(LinearSteps other);

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

}  // namespace stickslip::operators
