#include "stickslip/exact/fluid_queue.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "stickslip/algebra/dense.hpp"

namespace stickslip::exact {
namespace {

using algebra::LuFactors;
using Matrix = algebra::Matrix<double>;

/// Noise levels by the sign of their fluid rate x_i - mu_d.
struct Phases {
  explicit Phases(const model::Process& process) {
    for (int i = -process.noise.levels; i <= process.noise.levels; ++i) {
      const double rate = process.net_force(i);
      (rate > 0 ? rising : rate < 0 ? falling : still).push_back(i);
    }
  }
  std::vector<int> rising, falling, still;  // `still`: mu_d on the grid
};

/// T - lambda between groups of phases, the still one censored: what passes through it counts as a
/// direct jump, discounted for the stay.
class Jumps {
 public:
  Jumps(const model::Process& process, const Phases& phases, double lambda)
      : process_(process), phases_(phases), lambda_(lambda) {}

  [[nodiscard]] double rate(int from, int to) const {
    const auto& noise = process_.noise;
    if (to == from + 1) return noise.rate() * noise.up(from);
    if (to == from - 1) return noise.rate() * noise.down(from);
    return to == from ? -(noise.rate() + lambda_) : 0;
  }
  [[nodiscard]] double censored(int from, int to) const {
    double total = rate(from, to);
    for (int s : phases_.still) total += rate(from, s) * sojourn() * rate(s, to);
    return total;
  }
  /// Mean discounted stay in the still phase.
  [[nodiscard]] double sojourn() const { return 1 / (process_.noise.rate() + lambda_); }

  /// diag(|x_i - mu_d|)^-1 T between two groups.
  [[nodiscard]] Matrix per_length(const std::vector<int>& from, const std::vector<int>& to) const {
    Matrix m(static_cast<int>(from.size()), static_cast<int>(to.size()));
    for (int r = 0; r < m.rows(); ++r) {
      for (int c = 0; c < m.columns(); ++c) {
        m(r, c) = censored(from[r], to[c]) / std::abs(process_.net_force(from[r]));
      }
    }
    return m;
  }

 private:
  const model::Process& process_;
  const Phases& phases_;
  double lambda_;
};

double largest_diagonal(const Matrix& m) {
  double size = 0;
  for (int i = 0; i < m.rows(); ++i) size = std::max(size, std::abs(m(i, i)));
  return size;
}

/// Only products of one factor e and one f enter: where one grows and the other falls doubly
/// exponentially, sharing their sizes keeps both in range.
void balance(Matrix& e, Matrix& f) {
  const double factor = std::sqrt(f.largest() / e.largest());
  if (!std::isnormal(factor)) return;
  e *= factor;
  f *= 1 / factor;
}

/// Largest change of an entry relative to the entry.
double largest_ratio(const Matrix& change, const Matrix& h) {
  double ratio = 0;
  for (int c = 0; c < h.columns(); ++c) {
    for (int r = 0; r < h.rows(); ++r) {
      if (h(r, c) > 0) ratio = std::max(ratio, std::abs(change(r, c)) / h(r, c));
    }
  }
  return ratio;
}

/// Minimal non-negative X with X C X - X D - A X + B = 0, [D -C; -B A] an M-matrix.
struct Riccati {
  Matrix a, b, c, d;

  [[nodiscard]] Matrix solve() const {
    const double alpha = largest_diagonal(a), beta = largest_diagonal(d), sum = alpha + beta;
    const int m = a.rows(), n = d.rows();
    const LuFactors a_shifted(a + Matrix::identity(m, beta));
    const LuFactors d_shifted(d + Matrix::identity(n, alpha));
    const Matrix into_a = a_shifted.solved(b), into_d = d_shifted.solved(c);
    const LuFactors w(a + Matrix::identity(m, beta) - b * into_d);
    const LuFactors v(d + Matrix::identity(n, alpha) - c * into_a);
    // I - sum V^-1 = V^-1 (D - beta - C A_beta^-1 B): all terms of one sign.
    Matrix e = v.solved(d - Matrix::identity(n, beta) - c * into_a);
    Matrix f = w.solved(a - Matrix::identity(m, alpha) - b * into_d);
    Matrix g = sum * d_shifted.solved(c * w.solved(Matrix::identity(m)));
    Matrix h = sum * w.solved(b * d_shifted.solved(Matrix::identity(n)));
    constexpr int most = 60;
    for (int step = 0; step < most; ++step) {
      balance(e, f);
      const LuFactors gh(Matrix::identity(n) - g * h), hg(Matrix::identity(m) - h * g);
      const Matrix change = f * hg.solved(h * e);
      g += e * gh.solved(g * f);
      h += change;
      // Convergence is quadratic: what is left is the square of the last change.
      if (largest_ratio(change, h) <= 1e-9) return h;
      e = e * gh.solved(e);
      f = f * hg.solved(f);
    }
    throw std::runtime_error("the doubling algorithm of the fluid queue does not converge");
  }

  [[nodiscard]] double residual(const Matrix& x) const {
    const Matrix terms = x * c * x + b;
    return (terms - x * d - a * x).largest() / terms.largest();
  }
};

/// Starts at v = 0 in the rising phases k+1 ... N, and what a return to 0 leads to.
struct Boundary {
  Boundary(const model::Process& process, const Phases& phases, const Matrix& psi)
      : k(process.static_index()),
        starts(process.noise.levels - k),
        rising_starts(starts),
        restart(starts, starts),
        rest(starts, 2 * k + 1) {
    const int first = static_cast<int>(phases.rising.size()) - starts;
    for (int s = 0; s < starts; ++s) {
      rising_starts[s] = first + s;
      for (std::size_t c = 0; c < phases.falling.size(); ++c) {
        const int i = phases.falling[c];
        const double p = psi(first + s, static_cast<int>(c));
        if (i < -k) {
          restart(s, -i - k - 1) += p;
        } else {
          rest(s, i + k) += p;
        }
      }
    }
  }

  /// Mean number of starts in each phase k+1 ... N during a slide from s+, each counted with `sign`
  /// to the power of the number of crossings before.
  [[nodiscard]] std::vector<double> visits(double sign) const {
    std::vector<double> number(static_cast<std::size_t>(starts), 0.0);
    number[0] = 1;
    LuFactors(Matrix::identity(starts) - sign * restart).solve(number, true);
    return number;
  }

  int k, starts;
  std::vector<int> rising_starts;  // rows of Psi
  Matrix restart, rest;
};

}  // namespace

FluidQueue::FluidQueue(const model::Process& process, double lambda) {
  if (!process.drag.is_none()) throw std::invalid_argument("a fluid queue has no drag");
  const Phases phases(process);
  const Jumps jumps(process, phases, lambda);
  const auto& up = phases.rising;
  const auto& down = phases.falling;
  const Riccati riccati{-1.0 * jumps.per_length(up, up), jumps.per_length(up, down),
                        jumps.per_length(down, up), -1.0 * jumps.per_length(down, down)};
  const Matrix psi = riccati.solve();
  residual_ = riccati.residual(psi);

  const Boundary boundary(process, phases, psi);
  const auto visits = boundary.visits(1);
  entry_ = visits * boundary.rest;
  orientation_ = boundary.visits(-1) * boundary.rest;

  // Density of upcrossings of v by phase: starts exp(K v), K = C_u^-1 T_uu + Psi C_d^-1 T_du; its
  // moments are powers of (-K)^-1.
  const LuFactors minus_k(riccati.a - psi * riccati.c);
  std::vector<double> moment(up.size(), 0.0);
  for (int s = 0; s < boundary.starts; ++s) moment[boundary.rising_starts[s]] = visits[s];
  const int n = process.noise.levels;
  double factorial = 1;
  for (auto* sums : {&time_, &distance_, &square_}) {
    minus_k.solve(moment, true);
    sums->assign(2 * static_cast<std::size_t>(n) + 1, 0.0);
    const auto falling = moment * psi;
    const auto spend = [&](const std::vector<int>& group, const std::vector<double>& crossings) {
      for (std::size_t p = 0; p < group.size(); ++p) {
        const double spent = factorial * crossings[p] / std::abs(process.net_force(group[p]));
        (*sums)[group[p] + n] += spent;
        for (int s : phases.still)
          (*sums)[s + n] += spent * jumps.rate(group[p], s) * jumps.sojourn();
      }
    };
    spend(up, moment);
    spend(down, falling);
    factorial *= sums == &time_ ? 1 : 2;
  }
}

double FluidQueue::slide_transform() const {
  return std::accumulate(entry_.begin(), entry_.end(), 0.0);
}

}  // namespace stickslip::exact
