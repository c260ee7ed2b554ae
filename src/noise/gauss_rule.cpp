#include "stickslip/noise/gauss_rule.hpp"

#include <cmath>
#include <cstddef>
#include <stdexcept>

#include "stickslip/algebra/dense.hpp"

namespace stickslip::noise {
namespace {

using Column = std::vector<double>;

/// Polynomials p_0 ... p_(n-1), orthonormal for normalised weights, with their recurrence
///
///   b_(j+1) p_(j+1) = (t - a_j) p_j - b_j p_(j-1).
class OrthogonalPolynomials {
 public:
  OrthogonalPolynomials(std::span<const double> t, std::span<const double> w, int size)
      : t_(t), w_(w), off_diagonal(1, 0.0) {
    value.emplace_back(t.size(), 1.0);
    for (int j = 0; j < size; ++j) {
      Column next(t.size());
      for (std::size_t i = 0; i < next.size(); ++i) next[i] = t[i] * value[j][i];
      diagonal.push_back(product(next, value[j]));
      if (j + 1 == size) break;
      for (int pass = 0; pass < 2; ++pass) orthogonalise(next);
      const double norm = std::sqrt(product(next, next));
      for (double& entry : next) entry /= norm;
      off_diagonal.push_back(norm);
      value.push_back(std::move(next));
    }
  }

  // p_j(t_(i+1)) - p_j(t_i), by the differences of the recurrence.
  [[nodiscard]] std::vector<Column> steps() const {
    const std::size_t count = t_.size() - 1, size = value.size();
    std::vector<Column> step(size, Column(count, 0.0));
    for (std::size_t j = 0; j + 1 < size; ++j) {
      for (std::size_t i = 0; i < count; ++i) {
        const double before = j == 0 ? 0 : off_diagonal[j] * step[j - 1][i];
        step[j + 1][i] =
            ((t_[i + 1] - diagonal[j]) * step[j][i] + (t_[i + 1] - t_[i]) * value[j][i] - before) /
            off_diagonal[j + 1];
      }
    }
    return step;
  }

 private:
  std::span<const double> t_, w_;

 public:
  std::vector<Column> value;  // p_j(t_i)
  Column diagonal, off_diagonal;

 private:
  [[nodiscard]] double product(const Column& x, const Column& y) const {
    double sum = 0;
    for (std::size_t i = 0; i < x.size(); ++i) sum += w_[i] * x[i] * y[i];
    return sum;
  }

  void orthogonalise(Column& next) const {
    for (const Column& p : value) {
      const double part = product(next, p);
      for (std::size_t i = 0; i < next.size(); ++i) next[i] -= part * p[i];
    }
  }
};

// Points and weights scaled such that neither overflows: t in [-1, 1], weights of sum 1.
Column scaled(std::span<const double> x, double shift, double factor) {
  Column result;
  for (double value : x) result.push_back((value - shift) * factor);
  return result;
}

// Rows of sum_j p_j(x) vector_jl scale_l.
std::vector<double> combined(const std::vector<Column>& p, const algebra::Matrix<double>& vectors,
                             const Column& scale) {
  const std::size_t rows = p.front().size();
  const int n = vectors.rows();
  std::vector<double> result(rows * p.size(), 0.0);
  for (std::size_t i = 0; i < rows; ++i) {
    for (int j = 0; j < n; ++j) {
      for (int l = 0; l < n; ++l) result[i * n + l] += p[j][i] * vectors(j, l) * scale[l];
    }
  }
  return result;
}

}  // namespace

GaussRule::GaussRule(std::span<const double> points, std::span<const double> weights, int size) {
  if (size < 1 || points.size() != weights.size() ||
      points.size() <= static_cast<std::size_t>(size)) {
    throw std::invalid_argument("a Gauss rule needs more points than nodes");
  }
  double total = 0;
  for (double w : weights) total += w;
  const double middle = (points.front() + points.back()) / 2;
  const double half = (points.back() - points.front()) / 2;
  const Column t = scaled(points, middle, 1 / half), w = scaled(weights, 0, 1 / total);
  const OrthogonalPolynomials p(t, w, size);
  algebra::TridiagonalEigen eigen(p.diagonal, {p.off_diagonal.begin() + 1, p.off_diagonal.end()});
  node = std::move(eigen.value);
  // p_0 = 1, so that the first entry of an eigenvector is the root of its weight.
  Column root(node.size());
  for (int l = 0; l < size; ++l) {
    root[l] = eigen.vectors(0, l);
    weight.push_back(total * root[l] * root[l]);
    node[l] = middle + half * node[l];
  }
  cardinal = combined(p.value, eigen.vectors, root);
  step = combined(p.steps(), eigen.vectors, root);
}

}  // namespace stickslip::noise
