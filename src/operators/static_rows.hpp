#pragma once
/// The rows of static states in the elimination of elements.

#include <algorithm>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "stickslip/operators/linear_steps.hpp"

namespace stickslip::operators {

/// The matrix of the static states among each other, tridiagonal where the noise jumps to
/// neighbours, and what leaves them. Local.
template <class Scalar>
class StaticRows {
 public:
  using Steps = LinearSteps<Scalar>;

  StaticRows(std::size_t size, bool neighbours_only) : size_(size), near_(neighbours_only) {
    for (auto* band : {&chain_.diagonal, &chain_.below, &chain_.above}) {
      band->assign(near_ ? size : 0, 0.0);
    }
    if (!near_) dense_ = algebra::Matrix<Scalar>(static_cast<int>(size), static_cast<int>(size));
  }

  /// The states among which a row may have entries.
  [[nodiscard]] std::pair<std::size_t, std::size_t> columns_of(std::size_t row) const {
    if (!near_) return {0, size_};
    return {row > 0 ? row - 1 : 0, std::min(row + 2, size_)};
  }
  void add(std::size_t row, std::size_t column, Scalar value) {
    if (!near_) {
      dense_(static_cast<int>(row), static_cast<int>(column)) += value;
    } else if (row == column) {
      chain_.diagonal[row] += value;
    } else {
      (column < row ? chain_.below : chain_.above)[row] += value;
    }
  }
  /// A rate of leaving for what lies at a place outside.
  void add_exit(std::size_t row, std::size_t place, Scalar rate) {
    auto& rates = exits_[place];
    rates.resize(size_);
    rates[row] += rate;
  }

  /// Throws NotReached if the matrix is singular.
  void factor() {
    if (near_) chain_.factor();
    if (!near_) factors_.emplace(std::move(dense_));
  }
  /// x <- A^-1 x.
  void solve(Scalar* x) const {
    const algebra::Columns<Scalar> one{x};
    if (near_) chain_.solve(one, false);
    if (!near_) factors_->solve(one, false);
  }
  /// Rates by state, by place outside.
  [[nodiscard]] const std::map<std::size_t, std::vector<Scalar>>& exits() const { return exits_; }
  /// Hands the factors over as a step on the states at a place of a list.
  void move_to(Steps& steps, std::size_t at) {
    if (near_) steps.solve(std::move(chain_), at);
    if (!near_) steps.solve(*std::move(factors_), at);
  }

 private:
  std::size_t size_;
  bool near_;
  typename Steps::Tridiagonal chain_;
  algebra::Matrix<Scalar> dense_;
  std::optional<algebra::LuFactors<Scalar>> factors_;
  std::map<std::size_t, std::vector<Scalar>> exits_;
};

}  // namespace stickslip::operators
