#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "stickslip/linalg/petsc.hpp"
#include "stickslip/linalg/vectors.hpp"
#include "stickslip/quantities/engines/propagator.hpp"

namespace stickslip::quantities {
namespace {

using generator::Clock;
using linalg::check;
using linalg::copy_of;
using linalg::Matrix;

linalg::BvHandle basis_like(Vec vec, int columns) {
  linalg::BvHandle basis;
  check(BVCreate(PetscObjectComm(reinterpret_cast<PetscObject>(vec)), basis.out()));
  check(BVSetSizesFromVec(basis, vec, columns));
  check(BVSetFromOptions(basis));
  return basis;
}

// What is left of vec outside the first `column` columns becomes a new column, unless it is
// rounding.
bool appended(BV basis, int column, Vec vec) {
  constexpr double smallest = 1e-13;
  PetscReal left = 0;
  PetscBool dependent = PETSC_FALSE;
  check(BVInsertVec(basis, column, vec));
  check(BVOrthogonalizeColumn(basis, column, nullptr, &left, &dependent));
  if (dependent || !(left > smallest * linalg::norm(vec, NORM_2))) return false;
  check(BVScaleColumn(basis, column, 1 / left));
  return true;
}

// No space has more dimensions than vectors have entries.
int room_for(int pairs, Vec vec) {
  PetscInt entries = 0;
  check(VecGetSize(vec, &entries));
  return static_cast<int>(std::min<PetscInt>(pairs, entries));
}

// Y^T X, of columns of X from `first_x` and of Y from `first_y` on, to the same places of `to`.
void add_products(BV x, BV y, int first_x, int first_y, int size, Matrix<double>& to) {
  if (first_x >= size || first_y >= size) return;
  check(BVSetActiveColumns(x, first_x, size));
  check(BVSetActiveColumns(y, first_y, size));
  linalg::MatHandle dense;
  check(MatCreateSeqDense(PETSC_COMM_SELF, size, size, nullptr, dense.out()));
  check(BVDot(x, y, dense));
  const PetscScalar* values = nullptr;
  check(MatDenseGetArrayRead(dense, &values));
  for (int c = first_x; c < size; ++c) {
    for (int r = first_y; r < size; ++r) to(r, c) = PetscRealPart(values[c * size + r]);
  }
  check(MatDenseRestoreArrayRead(dense, &values));
  // Or new columns would be orthogonalised against these alone.
  check(BVSetActiveColumns(x, 0, size));
  check(BVSetActiveColumns(y, 0, size));
}

// Y^T v of the first columns.
std::vector<double> products(BV y, Vec v, int size) {
  std::vector<PetscScalar> dots(static_cast<std::size_t>(size));
  check(BVSetActiveColumns(y, 0, size));
  check(BVDotVec(y, v, dots.data()));
  std::vector<double> result;
  for (const auto& dot : dots) result.push_back(PetscRealPart(dot));
  return result;
}

// The local rows of the first columns.
Matrix<double> local_rows(BV basis, int size) {
  Matrix<double> rows;
  for (int c = 0; c < size; ++c) {
    Vec column = nullptr;
    check(BVGetColumn(basis, c, &column));
    {
      const linalg::ReadView values(column);
      if (c == 0) rows = Matrix<double>(values.size(), size);
      for (PetscInt r = 0; r < values.size(); ++r) rows(r, c) = PetscRealPart(values[r]);
    }
    check(BVRestoreColumn(basis, c, &column));
  }
  return rows;
}

// X^T y, over all ranks.
std::vector<double> products(MPI_Comm comm, const Matrix<double>& x, const double* y) {
  std::vector<double> dots(static_cast<std::size_t>(x.columns()), 0.0);
  linalg::add_product(x, y, dots.data(), true);
  linalg::sum_over_ranks(comm, dots);
  return dots;
}

}  // namespace

ProcessPencil::ProcessPencil(generator::Systems& systems, generator::Symmetry symmetry,
                             generator::StaticPhase static_phase, Clock clock)
    : systems_(systems),
      key_{0, symmetry, static_phase, clock},
      a_(generator::assemble(systems.comm(), systems.discretisation(), 0, symmetry, static_phase,
                             systems.statistics())) {
  if (clock == Clock::time) return;
  const auto root = [&](const generator::State& state) {
    return std::sqrt(rate_of(clock, state, *systems.discretisation().velocities));
  };
  root_ = a_.by_state(root);
  inverse_root_ = a_.by_state([&](const generator::State& state) { return 1 / root(state); });
}

ProcessPencil::~ProcessPencil() {
  for (const auto& key : used_) systems_.release(key);
}

void ProcessPencil::by_clock(int power, Vec x) const {
  if (root_ != nullptr) check(VecPointwiseMult(x, x, power > 0 ? root_ : inverse_root_));
}

void ProcessPencil::multiply(Vec x, Vec y, bool transposed) const {
  const linalg::VecHandle scaled = linalg::copy_of(x);
  by_clock(-1, scaled);
  check(transposed ? MatMultTranspose(a_.matrix(), scaled, y) : MatMult(a_.matrix(), scaled, y));
  by_clock(-1, y);
}

void ProcessPencil::solve(double z, Vec b, Vec x, bool transposed, bool refined) {
  auto key = key_;
  key.lambda = z;
  used_.insert(key);
  auto& factors = systems_.at(key).factors();
  const linalg::VecHandle scaled = linalg::copy_of(b);
  by_clock(1, scaled);
  if (refined) {
    check(VecCopy(transposed ? factors.solve_transposed(scaled).x : factors.solve(scaled).x, x));
  } else {
    factors.solve_once(scaled, x, transposed);
  }
  by_clock(1, x);
}

ShiftedInverse ProcessPencil::shifted(std::complex<double> z) {
  const auto solver = std::make_shared<generator::ComplexSolver>(
      a_, generator::Shift<std::complex<double>>(z, key_.clock), systems_.statistics());
  return [this, solver](const generator::ComplexVector& b, bool transposed) {
    const auto scale = [this](const generator::ComplexVector& x) {
      for (Vec part : {Vec(x.real), Vec(x.imaginary)}) by_clock(1, part);
    };
    const generator::ComplexVector scaled{copy_of(b.real), copy_of(b.imaginary)};
    scale(scaled);
    generator::ComplexVector x = solver->solve(scaled, transposed).x;
    scale(x);
    return x;
  };
}

Residual::Residual(BV basis, BV image, int size, Vec end)
    : t_(size, size), b_v_(products(basis, end, size)) {
  constexpr double rounding = 1e-15;
  const auto comm = PetscObjectComm(reinterpret_cast<PetscObject>(end));
  add_products(image, basis, 0, 0, size, t_);
  // What is left of the images and, in the last column, of b.
  const Matrix<double> v = local_rows(basis, size);
  Matrix<double> left(v.rows(), size + 1);
  const Matrix<double> images = local_rows(image, size);
  std::copy_n(images.data(), static_cast<std::size_t>(v.rows()) * size, left.data());
  const linalg::ReadView values(end);
  for (PetscInt r = 0; r < values.size(); ++r) left(r, size) = PetscRealPart(values[r]);
  Matrix<double> coordinates(size, size + 1);
  std::copy_n(t_.data(), static_cast<std::size_t>(size) * size, coordinates.data());
  std::copy(b_v_.begin(), b_v_.end(), coordinates.column(size));
  linalg::add_product(-1, v, coordinates, size + 1, left);
  // Gram-Schmidt with pivots; what remains in the end is rounding.
  std::vector<double> squares(static_cast<std::size_t>(size) + 1);
  std::vector<std::vector<double>> rows;
  double largest = 0;
  while (static_cast<int>(rows.size()) <= size) {
    for (int c = 0; c <= size; ++c) {
      const double* column = left.column(c);
      squares[c] = std::inner_product(column, column + left.rows(), column, 0.0);
    }
    linalg::sum_over_ranks(comm, squares);
    const auto pivot = std::max_element(squares.begin(), squares.end());
    largest = std::max(largest, *pivot);
    if (!(*pivot > rounding * rounding * largest)) break;
    std::vector<double> q(left.column(static_cast<int>(pivot - squares.begin())),
                          left.column(static_cast<int>(pivot - squares.begin())) + left.rows());
    for (double& entry : q) entry /= std::sqrt(*pivot);
    rows.push_back(products(comm, left, q.data()));
    for (int c = 0; c <= size; ++c) {
      for (int r = 0; r < left.rows(); ++r) left(r, c) -= q[r] * rows.back()[c];
    }
  }
  r_ = Matrix<double>(static_cast<int>(rows.size()), size);
  for (int r = 0; r < r_.rows(); ++r) {
    for (int c = 0; c < size; ++c) r_(r, c) = rows[r][c];
    b_q_.push_back(rows[r][size]);
  }
}

double Residual::operator()(std::complex<double> z,
                            const std::vector<std::complex<double>>& y) const {
  double squares = 0;
  const auto add = [&](const std::vector<double>& b, const Matrix<double>& a,
                       std::complex<double> diagonal) {
    std::vector<std::complex<double>> left(b.begin(), b.end());
    for (int c = 0; c < a.columns(); ++c) {
      for (int r = 0; r < a.rows(); ++r) left[r] -= a(r, c) * y[c];
      if (diagonal != 0.0) left[c] -= diagonal * y[c];
    }
    for (const auto& entry : left) squares += std::norm(entry);
  };
  add(b_v_, t_, z);
  add(b_q_, r_, 0);
  return std::sqrt(squares);
}

ReducedModel::ReducedModel(Pencil& pencil, const Ends& ends, Nature nature, int most_pairs)
    : pencil_(pencil),
      root_(copy_of(ends.weight)),
      inverse_root_(copy_of(ends.weight)),
      most_pairs_(room_for(most_pairs, ends.b)),
      right_(basis_like(ends.b, most_pairs_)),
      left_(basis_like(ends.b, most_pairs_)),
      image_(basis_like(ends.b, most_pairs_)),
      left_image_(basis_like(ends.b, most_pairs_)),
      b_(copy_of(ends.b)),
      c_(copy_of(ends.c)) {
  check(VecSqrtAbs(root_));
  check(VecCopy(root_, inverse_root_));
  check(VecReciprocal(inverse_root_));
  check(VecPointwiseMult(b_, b_, root_));
  check(VecPointwiseMult(c_, c_, inverse_root_));
  if (nature != Nature::smooth) return;
  ab_ = copy_of(b_);
  ca_ = copy_of(c_);
  multiply(b_, ab_, false);
  multiply(c_, ca_, true);
  append(b_, c_);
  append(ab_, ca_);
}

// y = D^1/2 A D^-1/2 x or its transpose.
void ReducedModel::multiply(Vec x, Vec y, bool transposed) const {
  const linalg::VecHandle scaled = linalg::product(x, transposed ? root_ : inverse_root_);
  pencil_.multiply(scaled, y, transposed);
  check(VecPointwiseMult(y, y, transposed ? inverse_root_ : root_));
}

bool ReducedModel::append(Vec v, Vec w) {
  if (full() || !appended(right_, pairs_, v) || !appended(left_, pairs_, w)) return false;
  const linalg::VecHandle column = copy_of(v), image = copy_of(v);
  for (const bool transposed : {false, true}) {
    check(BVCopyVec(transposed ? left_ : right_, pairs_, column));
    multiply(column, image, transposed);
    check(BVInsertVec(transposed ? left_image_ : image_, pairs_, image));
  }
  ++pairs_;
  return true;
}

// x <- (s + A)^-1 x, or the transpose, scaled.
void ReducedModel::resolve(double shift, Vec x, bool transposed, bool refined) const {
  const linalg::VecHandle b = linalg::product(x, transposed ? root_ : inverse_root_);
  pencil_.solve(shift, b, x, transposed, refined);
  check(VecPointwiseMult(x, x, transposed ? inverse_root_ : root_));
}

int ReducedModel::extend(double shift, int count) {
  Chain& chain = chains_[shift];
  if (chain.v == nullptr) chain = {copy_of(b_), copy_of(c_)};
  int added = 0;
  for (; added < count && !full(); ++added) {
    resolve(shift, chain.v, false, false);
    resolve(shift, chain.w, true, false);
    if (!append(chain.v, chain.w)) break;
    // The chain continues from the new direction alone, as Arnoldi's process does.
    check(BVCopyVec(right_, pairs_ - 1, chain.v));
    check(BVCopyVec(left_, pairs_ - 1, chain.w));
  }
  return added;
}

// (z + A)^-1 of a real vector, or the transpose, both scaled like V or W.
generator::ComplexVector ReducedModel::shifted(const ShiftedInverse& inverse, Vec real,
                                               bool transposed) const {
  const linalg::VecHandle before = transposed ? copy_of(root_) : copy_of(inverse_root_);
  const Vec after = transposed ? inverse_root_ : root_;
  generator::ComplexVector b{copy_of(real), copy_of(real)};
  check(VecPointwiseMult(b.real, real, before));
  check(VecSet(b.imaginary, 0));
  generator::ComplexVector x = inverse(b, transposed);
  for (Vec part : {Vec(x.real), Vec(x.imaginary)}) check(VecPointwiseMult(part, part, after));
  return x;
}

Truth ReducedModel::truth(std::complex<double> z, bool far) const {
  Truth found;
  found.z = z;
  found.far = far;
  const Vec b = far ? ab_ : b_;
  if (z.imag() == 0) {
    found.x = {copy_of(b), copy_of(b)};
    check(VecSet(found.x.imaginary, 0));
    resolve(z.real(), found.x.real, false, true);
  } else {
    found.inverse = pencil_.shifted(z);
    found.x = shifted(found.inverse, b, false);
  }
  found.value = generator::dot(far ? ca_ : c_, found.x);
  return found;
}

int ReducedModel::interpolate(const Truth& truth) {
  if (truth.z.imag() == 0) {
    const linalg::VecHandle w = copy_of(c_);
    resolve(truth.z.real(), w, true, true);
    return append(truth.x.real, w) ? 1 : 0;
  }
  const auto w = shifted(truth.inverse, c_, true);
  int added = append(truth.x.real, w.real) ? 1 : 0;
  if (append(truth.x.imaginary, w.imaginary)) ++added;
  return added;
}

Reduced ReducedModel::reduce() {
  const auto grown = [this](const Matrix<double>& old) {
    Matrix<double> all(pairs_, pairs_);
    for (int c = 0; c < projected_pairs_; ++c) {
      std::copy_n(old.column(c), projected_pairs_, all.column(c));
    }
    return all;
  };
  overlap_ = grown(overlap_);
  projected_ = grown(projected_);
  for (const auto& [x, to] : {std::pair{BV(right_), &overlap_}, {BV(image_), &projected_}}) {
    add_products(x, left_, projected_pairs_, 0, pairs_, *to);
    add_products(x, left_, 0, projected_pairs_, pairs_, *to);
  }
  projected_pairs_ = pairs_;
  const linalg::SingularValues g(overlap_);
  // Directions of V and W that are orthogonal to the rounding of the products see nothing of each
  // other; the others are scaled so that W^T V = 1.
  constexpr double rounding = 1e-14;
  const int seen = static_cast<int>(
      std::count_if(g.value.begin(), g.value.end(), [](double s) { return s > rounding; }));
  Reduced r;
  r.to_left = Matrix<double>(seen, pairs_);
  r.to_right = Matrix<double>(pairs_, seen);
  for (int n = 0; n < seen; ++n) {
    const double scale = 1 / std::sqrt(g.value[n]);
    for (int row = 0; row < pairs_; ++row) {
      r.to_left(n, row) = scale * g.left(row, n);
      r.to_right(row, n) = scale * g.right_transposed(n, row);
    }
  }
  r.m = -1.0 * (r.to_left * projected_ * r.to_right);
  r.beta = r.to_left * products(left_, b_, pairs_);
  r.gamma = products(right_, c_, pairs_) * r.to_right;
  return r;
}

}  // namespace stickslip::quantities
