#include "stickslip/operators/linear_steps.hpp"

#include <algorithm>
#include <complex>
#include <iterator>
#include <utility>

namespace stickslip::operators {
namespace {

template <class... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
template <class... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

}  // namespace

template <class Scalar>
void LinearSteps<Scalar>::Tridiagonal::factor() {
  for (std::size_t n = 1; n < diagonal.size(); ++n) {
    below[n] /= diagonal[n - 1];
    diagonal[n] -= below[n] * above[n - 1];
  }
}

template <class Scalar>
void LinearSteps<Scalar>::Tridiagonal::solve(Lists x, bool transposed) const {
  for (int c = 0; c < x.count; ++c) solve_one(x.column(c), transposed);
}

template <class Scalar>
void LinearSteps<Scalar>::Tridiagonal::solve_one(Scalar* x, bool transposed) const {
  const std::size_t size = diagonal.size();
  if (size == 0) return;
  if (!transposed) {
    for (std::size_t n = 1; n < size; ++n) x[n] -= below[n] * x[n - 1];
    x[size - 1] /= diagonal[size - 1];
    for (std::size_t n = size - 1; n-- > 0;) x[n] = (x[n] - above[n] * x[n + 1]) / diagonal[n];
    return;
  }
  x[0] /= diagonal[0];
  for (std::size_t n = 1; n < size; ++n) x[n] = (x[n] - above[n - 1] * x[n - 1]) / diagonal[n];
  for (std::size_t n = size - 1; n-- > 0;) x[n] -= below[n + 1] * x[n + 1];
}

template <class Scalar>
void LinearSteps<Scalar>::add(Matrix a, std::size_t from, std::size_t to) {
  steps_.emplace_back(Product{std::move(a), from, to});
}

template <class Scalar>
void LinearSteps<Scalar>::add(std::vector<Coupling> couplings) {
  steps_.emplace_back(std::move(couplings));
}

template <class Scalar>
void LinearSteps<Scalar>::contract(std::span<const double> c, int block, std::size_t from,
                                   std::size_t to) {
  steps_.emplace_back(Contraction{{c.begin(), c.end()}, block, to, from, false});
}

template <class Scalar>
void LinearSteps<Scalar>::spread(std::span<const double> c, int block, std::size_t from,
                                 std::size_t to) {
  steps_.emplace_back(Contraction{{c.begin(), c.end()}, block, from, to, true});
}

template <class Scalar>
void LinearSteps<Scalar>::Contraction::run(Lists w, bool transposed) const {
  const bool outwards = spreads != transposed;
  for (std::size_t l = 0; l < c.size(); ++l) {
    const double weight = c[l];
    if (weight == 0) continue;  // of levels that are nodes, all but one
    const std::size_t row = many + l * static_cast<std::size_t>(block);
    for (int n = 0; n < w.count; ++n) {
      const Scalar* from = w.column(n) + (outwards ? one : row);
      Scalar* to = w.column(n) + (outwards ? row : one);
      for (int m = 0; m < block; ++m) to[m] += weight * from[m];
    }
  }
}

template <class Scalar>
void LinearSteps<Scalar>::solve(Factors a, std::size_t at) {
  steps_.emplace_back(Solve<Factors>{std::move(a), at});
}

template <class Scalar>
void LinearSteps<Scalar>::solve(Tridiagonal a, std::size_t at) {
  steps_.emplace_back(Solve<Tridiagonal>{std::move(a), at});
}

template <class Scalar>
void LinearSteps<Scalar>::append(LinearSteps other) {
  std::move(other.steps_.begin(), other.steps_.end(), std::back_inserter(steps_));
}

template <class Scalar>
void LinearSteps<Scalar>::add(const std::vector<Coupling>& couplings, Scalar* w, bool transposed) {
  if (!transposed) {
    for (const auto& [from, to, weight] : couplings) w[to] += weight * w[from];
    return;
  }
  for (auto c = couplings.rbegin(); c != couplings.rend(); ++c) w[c->from] += c->weight * w[c->to];
}

template <class Scalar>
void LinearSteps<Scalar>::run(Lists w, bool transposed) const {
  const Overloaded carry_out{
      [&](const Product& p) {
        const std::size_t from = transposed ? p.to : p.from, to = transposed ? p.from : p.to;
        algebra::add_product(p.a, w.from(from), w.from(to), transposed);
      },
      [&](const std::vector<Coupling>& couplings) {
        for (int n = 0; n < w.count; ++n) add(couplings, w.column(n), transposed);
      },
      [&](const Contraction& contraction) { contraction.run(w, transposed); },
      [&](const auto& solve) { solve.a.solve(w.from(solve.at), transposed); }};
  if (transposed) {
    for (auto step = steps_.rbegin(); step != steps_.rend(); ++step) std::visit(carry_out, *step);
  } else {
    for (const Step& step : steps_) std::visit(carry_out, step);
  }
}

template <class Scalar>
double LinearSteps<Scalar>::entries() const {
  double count = 0;
  const Overloaded add{
      [&](const Product& p) { count += 1.0 * p.a.rows() * p.a.columns(); },
      [&](const std::vector<Coupling>& couplings) {
        count += static_cast<double>(2 * couplings.size());
      },
      [&](const Contraction& contraction) { count += static_cast<double>(contraction.c.size()); },
      [&](const Solve<Factors>& s) { count += 1.0 * s.a.size() * s.a.size(); },
      [&](const Solve<Tridiagonal>& s) { count += static_cast<double>(3 * s.a.diagonal.size()); }};
  for (const Step& step : steps_) std::visit(add, step);
  return count;
}

template class LinearSteps<double>;
template class LinearSteps<std::complex<double>>;

}  // namespace stickslip::operators
