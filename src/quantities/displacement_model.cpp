#include "stickslip/quantities/displacement_model.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "stickslip/operators/complex_solver.hpp"
#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/vectors.hpp"
#include "stickslip/quantities/transient.hpp"

namespace stickslip::quantities {
namespace {

using algebra::Matrix;
using Complex = std::complex<double>;
using operators::KolmogorovOperator;
using operators::State;
using operators::StateKind;
using operators::StaticPhase;
using operators::Symmetry;
using Entries = std::vector<double>;  // of this rank

Entries entries_of(Vec x) {
  const petsc::ReadView local(x);
  Entries all;
  for (PetscInt n = 0; n < local.size(); ++n) all.push_back(PetscRealPart(local[n]));
  return all;
}

void put(const Entries& x, Vec to) {
  petsc::WriteView local(to);
  std::copy(x.begin(), x.end(), local.data());
}

// The stationary distribution on states of both signs of v; mirror images share what stands for
// both where symmetry reduces the distribution.
Entries stationary_on(operators::Systems& systems, const StationaryDistribution& distribution,
                      const KolmogorovOperator& a) {
  const double total = distribution.excursion().mean_excursion();
  Entries all;
  if (!systems.process().symmetric()) {
    all = entries_of(distribution.occupation_on(a));
  } else {
    const auto even = operators::assemble(systems.comm(), systems.discretisation(), 0,
                                          Symmetry::even, StaticPhase::kept, systems.statistics());
    const Entries reduced = entries_of(distribution.occupation_on(even));
    std::map<std::tuple<StateKind, int, int>, double> known;
    std::size_t at = 0;
    even.states().for_each_local([&](const State& s) {
      known[{s.kind, s.noise, s.node}] = reduced[at++];
    });
    a.states().for_each_local([&](const State& s) {
      const bool rests = s.kind == StateKind::static_phase;
      const double both = known.at({s.kind, rests ? std::abs(s.noise) : s.noise, s.node});
      all.push_back(rests && s.noise == 0 ? both : both / 2);
    });
  }
  for (double& p : all) p /= total;
  return all;
}

/// Orthonormal columns.
class Basis {
 public:
  explicit Basis(MPI_Comm comm) : comm_(comm) {}

  // What is left of x outside the columns, unless it is rounding.
  bool add(Entries x) {
    constexpr double smallest = 1e-12;
    const double size = std::sqrt(dot(x, x));
    for (int pass = 0; pass < 2; ++pass) {
      for (const auto& column : columns_) {
        const double share = dot(column, x);
        for (std::size_t n = 0; n < x.size(); ++n) x[n] -= share * column[n];
      }
    }
    const double left = std::sqrt(dot(x, x));
    if (!(left > smallest * size)) return false;
    for (double& entry : x) entry /= left;
    columns_.push_back(std::move(x));
    return true;
  }
  void remove_last() { columns_.pop_back(); }
  [[nodiscard]] const std::vector<Entries>& columns() const { return columns_; }
  [[nodiscard]] double dot(const Entries& x, const Entries& y) const {
    double sum = 0;
    for (std::size_t n = 0; n < x.size(); ++n) sum += x[n] * y[n];
    MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPI_DOUBLE, MPI_SUM, comm_);
    return sum;
  }

 private:
  MPI_Comm comm_;
  std::vector<Entries> columns_;
};

// W^T X.
Matrix<double> products(const Basis& w, const std::vector<Entries>& x) {
  Matrix<double> all(static_cast<int>(w.columns().size()), static_cast<int>(x.size()));
  for (int c = 0; c < all.columns(); ++c) {
    for (int r = 0; r < all.rows(); ++r) all(r, c) = w.dot(w.columns()[r], x[c]);
  }
  return all;
}

Matrix<double> first(const Matrix<double>& a, int rows, int columns) {
  Matrix<double> part(rows, columns);
  for (int c = 0; c < columns; ++c) std::copy_n(a.column(c), rows, part.column(c));
  return part;
}

Entries times(const Entries& x, const Entries& y) {
  Entries product = x;
  for (std::size_t n = 0; n < x.size(); ++n) product[n] *= y[n];
  return product;
}

// The weight of the inner product, and its inverse.
struct Weights {
  Entries root, inverse;
};
Weights weights_of(MPI_Comm comm, const Entries& pi) {
  double most = 0;
  for (double p : pi) most = std::max(most, std::abs(p));
  MPI_Allreduce(MPI_IN_PLACE, &most, 1, MPI_DOUBLE, MPI_MAX, comm);
  Weights all;
  for (double p : pi) {
    all.root.push_back(std::sqrt(std::abs(p) + 1e-14 * most));
    all.inverse.push_back(1 / all.root.back());
  }
  return all;
}

/// Vectors that one system makes of 1 and of c, each of the last.
struct Chain {
  operators::SystemKey key;
  int vectors, first;  // in all, and in the coarse model
  Entries x, w;
  int found = 0;
};

std::vector<Chain> chains_at(double t, double largest, double speed, const Entries& one,
                             const Entries& c) {
  std::vector<Chain> chains;
  for (double z : {0.3, 1.0, 3.0, 9.0, 27.0, 81.0}) {
    chains.push_back({{z / t, Symmetry::none, StaticPhase::kept}, 16, 11, one, c});
  }
  for (double s : {largest, largest / 4, largest / 16}) {
    constexpr double counts = 2;
    if (s * speed * t < counts) continue;
    for (double z : {1.0, 4.0, 16.0}) {
      chains.push_back({{z / t, Symmetry::none, StaticPhase::kept}, 8, 5, one, c});
      chains.back().key.path = s;
    }
  }
  return chains;
}

// The next vectors of a chain, with two vectors to work with.
void extend(operators::Systems& systems, const Entries& v, Vec b, Vec solved, Chain& chain) {
  auto& factors = systems.at(chain.key).factors();
  const auto next = [&](Entries& x, bool transposed) {
    put(chain.found == 0 ? x : times(x, v), b);
    transposed ? factors.solve_transposed_once(b, solved) : factors.solve_once(b, solved);
    x = entries_of(solved);
    PetscReal size = 0;
    petsc::check(VecNorm(solved, NORM_2, &size));
    for (double& entry : x) entry /= size;
  };
  next(chain.x, false);
  next(chain.w, true);
  ++chain.found;
}

}  // namespace

struct DisplacementModel::Products {
  Matrix<double> overlap, m, n, to_one;
  Entries of_c;
};

DisplacementModel::Projected DisplacementModel::projected(const Products& all, int size) {
  constexpr double rounding = 1e-13;
  const algebra::SingularValues g(first(all.overlap, size, size));
  const int seen = static_cast<int>(std::count_if(
      g.value.begin(), g.value.end(), [&](double s) { return s > rounding * g.value.front(); }));
  Matrix<double> to_left(seen, size), to_right(size, seen);
  for (int r = 0; r < seen; ++r) {
    const double scale = 1 / std::sqrt(g.value[r]);
    for (int l = 0; l < size; ++l) {
      to_left(r, l) = scale * g.left(l, r);
      to_right(l, r) = scale * g.right_transposed(r, l);
    }
  }
  Projected p;
  p.m = -1.0 * (to_left * first(all.m, size, size) * to_right);
  p.n = to_left * first(all.n, size, size) * to_right;
  p.b = to_left * Entries(all.to_one.data(), all.to_one.data() + size);
  p.g = Entries(all.of_c.begin(), all.of_c.begin() + size) * to_right;
  return p;
}

DisplacementModel::DisplacementModel(operators::Systems& systems,
                                     const StationaryDistribution& distribution,
                                     const model::Start& start, double t, double largest)
    : systems_(systems),
      a_(operators::assemble(systems.comm(), systems.discretisation(), 0, Symmetry::none,
                             StaticPhase::kept, systems.statistics())),
      t_(t) {
  const Entries pi = stationary_on(systems, distribution, a_), one(pi.size(), 1.0),
                v = entries_of(a_.values([](double, double, double u) { return u; }));
  const bool stationary = start.kind == model::Start::Kind::stationary;
  const Entries c = start_ = stationary ? pi : entries_of(start_on(a_, start));
  const auto [root, inverse] = weights_of(systems.comm(), pi);
  Basis right(systems.comm()), left(systems.comm());
  const auto append = [&, &root = root, &inverse = inverse](const Entries& x, const Entries& w) {
    if (!right.add(times(x, root))) return;
    if (!left.add(times(w, inverse))) right.remove_last();
  };
  append(one, c);
  speed_ = std::sqrt(std::max(right.dot(times(pi, v), v), 0.0));
  auto chains = chains_at(t, largest, speed_, one, c);
  const petsc::VecHandle b = a_.zeros(), solved = a_.zeros();
  const auto extend_to = [&](Chain& chain, int count) {
    while (chain.found < count) {
      extend(systems, v, b, solved, chain);
      append(chain.x, chain.w);
    }
  };
  for (Chain& chain : chains) extend_to(chain, chain.first);
  const int coarse = static_cast<int>(right.columns().size());
  for (Chain& chain : chains) extend_to(chain, chain.vectors);
  for (const Chain& chain : chains) systems.release(chain.key);

  std::vector<Entries> images, moving;
  for (const auto& column : right.columns()) {
    put(times(column, inverse), b);
    petsc::check(MatMult(a_.matrix(), b, solved));
    images.push_back(times(entries_of(solved), root));
    moving.push_back(times(column, v));
  }
  Products all{products(left, right.columns()),
               products(left, images),
               products(left, moving),
               products(left, {times(one, root)}),
               {}};
  for (const auto& column : right.columns()) {
    all.of_c.push_back(left.dot(times(c, inverse), column));
  }
  fine_ = projected(all, static_cast<int>(right.columns().size()));
  coarse_ = projected(all, coarse);
}

// An error dH of the Laplace transform in time is one of about e/pi |dH|/t at t.
void DisplacementModel::judge(double k) {
  double& caution = caution_.emplace(std::abs(k), 1).first->second;
  const Basis products(systems_.comm());
  for (const Complex z : {Complex(1 / t_, 0), Complex(1 / t_, k * speed_)}) {
    operators::ComplexSolver solver(a_, {z, 0.0, Complex(0, k)}, systems_.statistics());
    operators::ComplexVector f{a_.zeros(), a_.zeros()};
    put(Entries(start_.size(), 1.0), f.real);
    const auto x = solver.solve(f, false).x;
    const Complex truth(products.dot(start_, entries_of(x.real)),
                        products.dot(start_, entries_of(x.imaginary)));
    const Complex here = fine_.resolvent(z, k);
    const double off = std::abs(truth - here), seen = std::abs(here - coarse_.resolvent(z, k));
    caution = std::max(caution, off / std::max(seen, 1e-13 * std::abs(truth)));
  }
}

Complex DisplacementModel::Projected::resolvent(Complex z, double k) const {
  Matrix<Complex> a(m.rows(), m.rows());
  for (int c = 0; c < m.rows(); ++c) {
    for (int r = 0; r < m.rows(); ++r) a(r, c) = -Complex(m(r, c), k * n(r, c));
    a(c, c) += z;
  }
  std::vector<Complex> x(b.begin(), b.end());
  algebra::LuFactors<Complex>(std::move(a)).solve(x, false);
  Complex sum = 0;
  for (std::size_t r = 0; r < x.size(); ++r) sum += g[r] * x[r];
  return sum;
}

Complex DisplacementModel::Projected::transform(double k, double t, double& grown) const {
  Matrix<Complex> a(m.rows(), m.rows());
  for (int c = 0; c < m.rows(); ++c) {
    for (int r = 0; r < m.rows(); ++r) a(r, c) = Complex(m(r, c), k * n(r, c));
  }
  const algebra::Eigenvectors modes(std::move(a));
  std::vector<Complex> shares(b.begin(), b.end());
  algebra::LuFactors<Complex>(modes.right).solve(shares, false);
  Complex sum = 0;
  for (int l = 0; l < m.rows(); ++l) {
    Complex seen = 0;
    for (int r = 0; r < m.rows(); ++r) seen += g[r] * modes.right(r, l);
    const Complex rate = modes.value[l], share = seen * shares[l];
    if (rate.real() * t > 1e-8) grown += std::abs(share);
    sum += share * std::exp(t * Complex(std::min(rate.real(), 0.0), rate.imag()));
  }
  return sum;
}

DisplacementModel::Transform DisplacementModel::transform(double k) const {
  double grown = 0, before = 0;
  const Complex value = fine_.transform(k, t_, grown), other = coarse_.transform(k, t_, before);
  auto judged = caution_.lower_bound(std::abs(k));
  if (judged == caution_.end() && !caution_.empty()) --judged;
  const double caution = judged == caution_.end() ? 1 : judged->second;
  return {value, caution * (std::abs(value - other) + grown) + 1e-14};
}

}  // namespace stickslip::quantities
