#pragma once
/// An independent route for tests: the upwind chain on the whole (x, v) grid of the paper, both
/// signs of v, as a dense generator; no folding, no excursions, no PETSc.

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "stickslip/model/process.hpp"

namespace stickslip::test {

/// Dense linear algebra by Gaussian elimination with partial pivoting; a is n x n by rows.
inline std::vector<double> dense_solve(std::vector<double> a, std::vector<double> b) {
  const std::size_t n = b.size();
  for (std::size_t c = 0; c < n; ++c) {
    std::size_t pivot = c;
    for (std::size_t r = c + 1; r < n; ++r) {
      if (std::abs(a[r * n + c]) > std::abs(a[pivot * n + c])) pivot = r;
    }
    for (std::size_t s = 0; s < n; ++s) std::swap(a[c * n + s], a[pivot * n + s]);
    std::swap(b[c], b[pivot]);
    for (std::size_t r = c + 1; r < n; ++r) {
      const double factor = a[r * n + c] / a[c * n + c];
      if (factor == 0) continue;
      for (std::size_t s = c; s < n; ++s) a[r * n + s] -= factor * a[c * n + s];
      b[r] -= factor * b[c];
    }
  }
  for (std::size_t c = n; c-- > 0;) {
    for (std::size_t s = c + 1; s < n; ++s) b[c] -= a[c * n + s] * b[s];
    b[c] /= a[c * n + c];
  }
  return b;
}

/// The generator M of eqs. (5.x): states (i, j), |i| <= N, |j| <= J, v_j = j h.
class FullGrid {
 public:
  FullGrid(const model::Process& process, double spacing, int nodes)
      : process_(process),
        spacing_(spacing),
        n_(process.noise.levels),
        j_(nodes),
        k_(process.static_index()),
        size_(static_cast<std::size_t>(2 * n_ + 1) * static_cast<std::size_t>(2 * j_ + 1)),
        m_(size_ * size_, 0.0) {
    for (int i = -n_; i <= n_; ++i) {
      for (int j = -j_; j <= j_; ++j) add_state(i, j);
    }
  }

  [[nodiscard]] std::size_t size() const { return size_; }
  /// M by rows.
  [[nodiscard]] const std::vector<double>& generator() const { return m_; }
  [[nodiscard]] bool is_static(int i, int j) const { return j == 0 && std::abs(i) <= k_; }
  [[nodiscard]] std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(i + n_) * static_cast<std::size_t>(2 * j_ + 1) +
           static_cast<std::size_t>(j + j_);
  }
  /// Calls visit(i, j, v, index) for all states.
  template <class Visit>
  void for_each(Visit visit) const {
    for (int i = -n_; i <= n_; ++i) {
      for (int j = -j_; j <= j_; ++j) visit(i, j, j * spacing_, index(i, j));
    }
  }

  /// pi M = 0, sum pi = 1.
  [[nodiscard]] std::vector<double> stationary() const {
    std::vector<double> a(size_ * size_), b(size_, 0.0);
    for (std::size_t r = 0; r < size_; ++r) {
      for (std::size_t c = 0; c < size_; ++c) a[c * size_ + r] = m_[r * size_ + c];
    }
    for (std::size_t c = 0; c < size_; ++c) a[c] = 1;  // replaces one redundant equation
    b[0] = 1;
    return dense_solve(std::move(a), std::move(b));
  }

  /// E_{s+}[f at the first static state], s+ = (x_{k+1}, 0+).
  template <class Value>
  [[nodiscard]] double mean_at_rest(Value f) const {
    std::vector<double> a = m_, b(size_, 0.0);
    for_each([&](int i, int j, double, std::size_t s) {
      if (!is_static(i, j)) return;
      for (std::size_t c = 0; c < size_; ++c) a[s * size_ + c] = 0;
      a[s * size_ + s] = 1;
      b[s] = f(i);
    });
    return dense_solve(std::move(a), std::move(b))[index(k_ + 1, 0)];
  }

 private:
  void add_rate(std::size_t from, std::size_t to, double rate) {
    m_[from * size_ + to] += rate;
    m_[from * size_ + from] -= rate;
  }

  void add_state(int i, int j) {
    const std::size_t s = index(i, j);
    const double lambda = process_.noise.rate();
    if (i < n_) add_rate(s, index(i + 1, j), lambda * process_.noise.up(i));
    if (i > -n_) add_rate(s, index(i - 1, j), lambda * process_.noise.down(i));
    if (is_static(i, j)) return;
    const int y = j > 0 || (j == 0 && i > 0) ? 1 : -1;
    const double v = j * spacing_;
    const double speed = process_.noise.level(i) + process_.drag(v) - y * process_.friction.mu_d;
    if (speed > 0 && j < j_) add_rate(s, index(i, j + 1), speed / spacing_);
    if (speed < 0 && j > -j_) add_rate(s, index(i, j - 1), -speed / spacing_);
  }

  model::Process process_;
  double spacing_;
  int n_, j_, k_;
  std::size_t size_;
  std::vector<double> m_;
};

}  // namespace stickslip::test
