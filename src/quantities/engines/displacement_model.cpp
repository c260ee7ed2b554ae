#include "displacement_model.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

#include "stickslip/quantities/correlations.hpp"

namespace stickslip::quantities {
namespace {

using linalg::Matrix;
using Complex = std::complex<double>;
using generator::KolmogorovOperator;
using generator::State;
using generator::StateKind;
using generator::StaticPhase;
using generator::Symmetry;
using linalg::check;
using Entries = std::vector<double>;  // of this rank
using Vector = std::vector<Complex>;

constexpr double kLeaving = 2;     // the rate of the exponential time, in units of 1/t
constexpr double kRefined = 1e-9;  // of a vector, where refinement is not worth its time

Entries entries_of(Vec x) {
  const linalg::ReadView local(x);
  Entries all;
  for (PetscInt n = 0; n < local.size(); ++n) all.push_back(PetscRealPart(local[n]));
  return all;
}

void put(const Entries& x, Vec to) {
  linalg::WriteView local(to);
  std::copy(x.begin(), x.end(), local.data());
}

// The stationary distribution on states of both signs of v; mirror images share what stands for
// both where symmetry reduces the distribution.
Entries stationary_on(generator::Systems& systems, const StationaryDistribution& distribution,
                      const KolmogorovOperator& a) {
  const double total = distribution.excursion().mean_excursion();
  Entries all;
  if (!systems.process().symmetric()) {
    all = entries_of(distribution.occupation_on(a));
  } else {
    const auto even = generator::assemble(systems.comm(), systems.discretisation(), 0,
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

std::vector<Complex> conjugate(std::vector<Complex> x) {
  for (Complex& entry : x) entry = std::conj(entry);
  return x;
}

// g exp(t a) b by eigenvectors, which grow by no more than the rate `most`.
Complex exponential(const Matrix<Complex>& a, const std::vector<Complex>& b,
                    const std::vector<Complex>& g, double t, double most) {
  const linalg::Eigenvectors modes(a);
  auto shares = b;
  linalg::LuFactors<Complex>(modes.right).solve(shares, false);
  const auto seen = g * modes.right;
  Complex sum = 0;
  for (std::size_t n = 0; n < b.size(); ++n) {
    const Complex rate(std::min(modes.value[n].real(), most), modes.value[n].imag());
    sum += seen[n] * shares[n] * std::exp(t * rate);
  }
  return sum;
}

// The leading block.
Matrix<Complex> first(const Matrix<Complex>& a, int size) {
  Matrix<Complex> block(size, size);
  for (int c = 0; c < size; ++c) std::copy_n(a.column(c), size, block.column(c));
  return block;
}

/// Orthonormal columns, by Gram and Schmidt twice.
class Basis {
 public:
  Basis(MPI_Comm comm, std::size_t rows) : comm_(comm), columns_(static_cast<int>(rows), 16) {}

  [[nodiscard]] int size() const { return size_; }
  // V^H x.
  [[nodiscard]] Vector products(const Vector& x) const {
    Vector all = conjugate(conjugate(x) * columns_);
    all.resize(static_cast<std::size_t>(size_));
    linalg::sum_over_ranks(comm_, all);
    return all;
  }
  // The products of x with the columns, the new one last; this is 0 where x is in their span.
  Vector add(Vector x) {
    constexpr double rounding = 1e-12;
    Vector shares(static_cast<std::size_t>(size_), 0.0);
    const double size = norm(x);
    for (int pass = 0; pass < 2; ++pass) {
      Vector part = products(x);
      for (std::size_t n = 0; n < part.size(); ++n) {
        shares[n] += part[n];
        part[n] = -part[n];
      }
      part.resize(static_cast<std::size_t>(columns_.columns()));
      linalg::add_product(columns_, part.data(), x.data());
    }
    const double left = norm(x);
    shares.emplace_back(left > rounding * size ? left : 0);
    if (shares.back() == 0.0) return shares;
    if (size_ == columns_.columns()) {
      Matrix<Complex> more(columns_.rows(), size_ + 16);
      std::copy_n(columns_.data(), x.size() * static_cast<std::size_t>(size_), more.data());
      columns_ = std::move(more);
    }
    Complex* const column = columns_.column(size_++);
    for (std::size_t n = 0; n < x.size(); ++n) column[n] = x[n] / left;
    return shares;
  }
  [[nodiscard]] Vector column(int n) const {
    return {columns_.column(n), columns_.column(n) + columns_.rows()};
  }

 private:
  [[nodiscard]] double norm(const Vector& x) const {
    Vector square{0};
    for (const Complex entry : x) square[0] += std::norm(entry);
    linalg::sum_over_ranks(comm_, square);
    return std::sqrt(square[0].real());
  }
  MPI_Comm comm_;
  Matrix<Complex> columns_;
  int size_ = 0;
};

// c exp(t A) 1 on the space of a resolvent at z from 1, which grows until that is the same as with
// a few vectors less: A = z - 1/(its resolvent) there. `vectors` holds how many were enough at the
// wavenumber before: with far fewer nothing is compared.
template <class Resolvent>
DisplacementModel::Transform
exponential_of(MPI_Comm comm, const Vector& one, const Vector& c, double z, double t, int most,
               double most_growth, double enough, int& vectors, const Resolvent& resolvent) {
  Basis basis(comm, one.size());
  const Vector start{basis.add(one).back()};
  Matrix<Complex> h(most, most);
  DisplacementModel::Transform found;
  Complex before = 0;
  Vector seen;
  // n vectors follow times up to about n/z. With fewer than for t, waves have died out in the space
  // that they span, and more vectors change nothing of that for a while.
  const int least = std::min(most / 2, std::max({4, static_cast<int>(z * t / 2), vectors * 2 / 3}));
  for (int count = 1, next = least; count < most; ++count) {
    const Vector newest = basis.column(count - 1);
    Vector product{std::inner_product(c.begin(), c.end(), newest.begin(), Complex(0))};
    linalg::sum_over_ranks(comm, product);
    seen.push_back(product[0]);
    const Vector shares = basis.add(resolvent(newest));
    std::copy(shares.begin(), shares.end(), h.column(count - 1));
    const bool exhausted = shares.back() == 0.0;
    if (!exhausted && count < next) continue;
    next = count + std::max(2, count / 6);
    Matrix<Complex> a = Matrix<Complex>::identity(count);
    linalg::LuFactors<Complex>(first(h, count)).solve(a);
    a *= -1.0;
    for (int r = 0; r < count; ++r) a(r, r) += z;
    Vector b = start;
    b.resize(static_cast<std::size_t>(count));
    const Complex last = std::exchange(found.value, exponential(a, b, seen, t, most_growth));
    found.error = std::max(std::abs(found.value - last), std::abs(found.value - before));
    before = last;
    if (exhausted) found.error = 1e-14;
    vectors = count;
    if (found.error < enough || exhausted) break;
  }
  return found;
}

}  // namespace

DisplacementModel::DisplacementModel(generator::Systems& systems,
                                     const StationaryDistribution& distribution,
                                     const model::Start& start, double t, double accuracy,
                                     Tilt tilt)
    : systems_(systems),
      a_(generator::assemble(systems.comm(), systems.discretisation(), 0, Symmetry::none,
                             StaticPhase::kept, systems.statistics())),
      t_(t),
      accuracy_(accuracy),
      tilt_(tilt),
      pole_(6 / t) {
  const bool stationary = start.kind == model::Start::Kind::stationary;
  const Entries c =
      stationary ? stationary_on(systems, distribution, a_) : entries_of(start_on(a_, start));
  if (tilt.s != 0) {
    weigh_tilted(c);
  } else {
    weigh_by(stationary ? c : after_exponential_time(c), Entries(c.size(), 1), c);
  }
}

// w = c z (z - L)^-1, the distribution after an exponential time of mean 1/z, up to a factor. As
// w L <= z w, L + i k v lets no function grow faster than exp(z t/2) in the norm with this weight.
Entries DisplacementModel::after_exponential_time(const Entries& c) {
  const generator::SystemKey key{kLeaving / t_, Symmetry::none, StaticPhase::kept};
  const linalg::VecHandle start = a_.zeros();
  put(c, start);
  const linalg::VecHandle l = std::move(systems_.at(key).factors().solve_transposed(start).x);
  systems_.release(key);
  return entries_of(l);
}

// l and r are known up to a factor that is the same for all.
void DisplacementModel::weigh_by(const Entries& l, const Entries& r, const Entries& c) {
  constexpr double rounding = 1e-14;
  const Entries v = entries_of(a_.values([](double, double, double u) { return u; }));
  std::array<double, 2> most{};
  std::array<double, 3> sums{};
  for (std::size_t n = 0; n < l.size(); ++n) {
    most = {std::max(most[0], l[n]), std::max(most[1], r[n])};
  }
  MPI_Allreduce(MPI_IN_PLACE, most.data(), 2, MPI_DOUBLE, MPI_MAX, systems_.comm());
  const double least = rounding * most[1];
  for (std::size_t n = 0; n < l.size(); ++n) {
    root_.push_back(
        std::sqrt((std::abs(l[n]) + rounding * most[0]) / std::max(std::abs(r[n]), least)));
    one_.emplace_back(root_[n]);
    c_.emplace_back(c[n] / root_[n]);
    const double both = l[n] * r[n];
    sums = {sums[0] + both, sums[1] + both * v[n], sums[2] + both * v[n] * v[n]};
  }
  linalg::sum_over_ranks(systems_.comm(), sums);
  drift_ = sums[1] / sums[0];
  speed_ = std::sqrt(std::abs(sums[2] / sums[0] - drift_ * drift_));
  resolved_ = true;
}

// Implicit steps to half of the time from either side, with the resolvent at some z beyond the
// growth. With z above all modes they keep l and r positive, where elements resolve them; no mode
// lies above the largest s v, and those of bodies too fast to count need not be followed. With z
// below that of a mode that counts, l r has both signs, or another size than is expected.
void DisplacementModel::weigh_tilted(const Entries& c) {
  constexpr double negative = 0.1, at_most = 2, other = 10;
  const auto gain = a_.values([s = tilt_.s](double, double, double v) { return s * v; });
  PetscReal most = 0;
  check(VecMax(gain, nullptr, &most));
  const double first = 12 / t_, last = std::max(first / 2 + most - tilt_.growth, first);
  pole_ = first;
  for (double z = first; !resolved_; z = std::min(2 * z, last)) {
    generator::SystemKey key{tilt_.growth + z, Symmetry::none, StaticPhase::kept};
    key.tilt = tilt_.s;
    auto& factors = systems_.at(key).factors();
    linalg::VecHandle l = a_.zeros(), r = a_.values([](double, double, double) { return 1; });
    put(c, l);
    for (int n = static_cast<int>(std::lround(z * t_ / 2)); n > 0; --n) {
      l = std::move(factors.solve_transposed(l).x);
      r = std::move(factors.solve(r).x);
      for (Vec x : {Vec(l), Vec(r)}) check(VecScale(x, z));
    }
    systems_.release(key);
    const linalg::VecHandle both = linalg::product(l, r);
    PetscScalar sum = 0;
    check(VecSum(both, &sum));
    const double size = PetscRealPart(sum), sizes = linalg::norm(both, NORM_1);
    const double limit = z < last ? negative : at_most;
    const bool kept =
        sizes < (1 + limit) * size && (z == last || (size > 1 / other && size < other));
    if (kept) weigh_by(entries_of(l), entries_of(r), c);
    if (z == last) return;
  }
}

DisplacementModel::Transform DisplacementModel::projected(double k, double z) {
  const generator::Shift<Complex> shift{Complex(tilt_.growth + z, k * drift_), 0.0,
                                        Complex(tilt_.s, k)};
  generator::ComplexSolver solver(a_, shift, systems_.statistics());
  // Where bodies too fast to count let the space converge slowly, the error says so.
  const bool tilted = tilt_.s != 0;
  const int most = tilted ? 60 : 120;
  const double most_growth = (tilted ? 40 : kLeaving / 2) / t_;
  // What refinement changes in the first vector says whether the others need it.
  bool refined = true;
  const generator::ComplexVector b{a_.zeros(), a_.zeros()};
  const auto solve = [&] {
    if (!refined) return solver.solve_once(b, false);
    auto found = solver.solve(b, false);
    refined = found.change > kRefined;
    return std::move(found.x);
  };
  const auto resolvent = [&](Vector y) {
    {
      linalg::WriteView real(b.real), imaginary(b.imaginary);
      for (std::size_t m = 0; m < y.size(); ++m) {
        real[static_cast<PetscInt>(m)] = y[m].real() / root_[m];
        imaginary[static_cast<PetscInt>(m)] = y[m].imag() / root_[m];
      }
    }
    const auto x = solve();
    const Entries real = entries_of(x.real), imaginary = entries_of(x.imaginary);
    for (std::size_t m = 0; m < y.size(); ++m) y[m] = root_[m] * Complex(real[m], imaginary[m]);
    return y;
  };
  auto found = exponential_of(systems_.comm(), one_, c_, z, t_, most, most_growth, accuracy_,
                              vectors_, resolvent);
  found.value *= std::polar(1.0, k * drift_ * t_);
  return found;
}

DisplacementModel::Transform DisplacementModel::at(double k) {
  const double turns = std::abs(k);
  const double z = pole_ + turns * speed_;  // further away where the weight turns fast
  Transform found = projected(turns, z);
  if (turns > (tilt_.s == 0 ? 2 : 4) * checked_) {
    checked_ = turns;
    const Transform other = projected(turns, 1.7 * z);
    other_pole_ = std::max(other_pole_, std::abs(other.value - found.value));
  }
  found.error += other_pole_;
  if (k < 0) found.value = std::conj(found.value);
  return found;
}

// They are waves exp(i k v t) in v, which jumps of the noise damp within some correlation times.
void resolve_displacements(Planner& planner, double wavenumber) {
  constexpr double damped = 4;  // correlation times
  const double tau = planner.given().scene.meant().noise.correlation_time(),
               last = largest_size(planner.question().time);
  planner.resolve_times();
  double& phase = planner.needs().phase;
  phase = std::max(phase, wavenumber * std::min(last, damped * tau));
}

}  // namespace stickslip::quantities
