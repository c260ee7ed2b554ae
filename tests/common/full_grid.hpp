#pragma once
/// An independent solution for tests: the upwind chain on the whole (x, v) grid of the paper, both
/// signs of v, as a dense generator; no symmetry reduction, no excursions, no PETSc.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "stickslip/linalg/dense.hpp"
#include "stickslip/model/process.hpp"

namespace stickslip::test {

/// The generator M of eqs. (5.x): states (i, j), |i| <= N, |j| <= J, v_j = j h.
class FullGrid {
 public:
  FullGrid(const model::Process& process, double spacing, int nodes)
      : process_(process),
        spacing_(spacing),
        n_(process.noise.levels),
        j_(nodes),
        k_(process.highest_static()),
        m_((2 * n_ + 1) * (2 * j_ + 1), (2 * n_ + 1) * (2 * j_ + 1)) {
    for (int i = -n_; i <= n_; ++i) {
      for (int j = -j_; j <= j_; ++j) add_state(i, j);
    }
  }

  [[nodiscard]] int size() const { return m_.rows(); }
  [[nodiscard]] const linalg::Matrix<double>& generator() const { return m_; }
  [[nodiscard]] bool is_static(int i, int j) const { return j == 0 && std::abs(i) <= k_; }
  [[nodiscard]] int index(int i, int j) const { return (i + n_) * (2 * j_ + 1) + j + j_; }
  /// Calls visit(i, j, v, index) for all states.
  template <class Visit>
  void for_each(Visit visit) const {
    for (int i = -n_; i <= n_; ++i) {
      for (int j = -j_; j <= j_; ++j) visit(i, j, j * spacing_, index(i, j));
    }
  }

  /// pi M = 0, sum pi = 1.
  [[nodiscard]] std::vector<double> stationary() const {
    linalg::Matrix<double> a = m_;
    std::vector<double> pi(static_cast<std::size_t>(size()), 0.0);
    std::fill_n(a.column(0), size(), 1.0);  // replaces one redundant equation
    pi[0] = 1;
    linalg::LuFactors(std::move(a)).solve(pi, true);
    return pi;
  }

  /// E_{s+}[f at the first static state], s+ = (x_{k+1}, 0+).
  template <class Value>
  [[nodiscard]] double mean_at_rest(Value f) const {
    linalg::Matrix<double> a = m_;
    std::vector<double> mean(static_cast<std::size_t>(size()), 0.0);
    for_each([&](int i, int j, double, int s) {
      if (!is_static(i, j)) return;
      for (int c = 0; c < size(); ++c) a(s, c) = c == s;
      mean[s] = f(i);
    });
    linalg::LuFactors(std::move(a)).solve(mean, false);
    return mean[index(k_ + 1, 0)];
  }

 private:
  void add_rate(int from, int to, double rate) {
    m_(from, to) += rate;
    m_(from, from) -= rate;
  }

  void add_state(int i, int j) {
    const int s = index(i, j);
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
  linalg::Matrix<double> m_;
};

}  // namespace stickslip::test
