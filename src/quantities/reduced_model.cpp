#include "stickslip/quantities/reduced_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/vectors.hpp"

namespace stickslip::quantities {
namespace {

using algebra::Matrix;
using petsc::check;
using petsc::copy_of;

petsc::BvHandle basis_like(Vec vec, int columns) {
  petsc::BvHandle basis;
  check(BVCreate(PetscObjectComm(reinterpret_cast<PetscObject>(vec)), basis.out()));
  check(BVSetSizesFromVec(basis, vec, columns));
  check(BVSetFromOptions(basis));
  return basis;
}

// What is left of vec outside the first `column` columns becomes a new column, unless it is
// rounding.
bool appended(BV basis, int column, Vec vec) {
  constexpr double smallest = 1e-13;
  PetscReal size = 0, left = 0;
  PetscBool dependent = PETSC_FALSE;
  check(VecNorm(vec, NORM_2, &size));
  check(BVInsertVec(basis, column, vec));
  check(BVOrthogonalizeColumn(basis, column, nullptr, &left, &dependent));
  if (dependent || !(left > smallest * size)) return false;
  check(BVScaleColumn(basis, column, 1 / left));
  return true;
}

// No space has more dimensions than vectors have entries.
int room_for(int pairs, Vec vec) {
  PetscInt entries = 0;
  check(VecGetSize(vec, &entries));
  return static_cast<int>(std::min<PetscInt>(pairs, entries));
}

// Y^T X of the first columns.
Matrix<double> products(BV x, BV y, int size) {
  petsc::MatHandle dense;
  check(MatCreateSeqDense(PETSC_COMM_SELF, size, size, nullptr, dense.out()));
  check(BVDot(x, y, dense));
  Matrix<double> result(size, size);
  const PetscScalar* values = nullptr;
  check(MatDenseGetArrayRead(dense, &values));
  for (int c = 0; c < size; ++c) {
    for (int r = 0; r < size; ++r) result(r, c) = PetscRealPart(values[c * size + r]);
  }
  check(MatDenseRestoreArrayRead(dense, &values));
  return result;
}

// Y^T v of the first columns.
std::vector<double> products(BV y, Vec v, int size) {
  std::vector<PetscScalar> dots(static_cast<std::size_t>(size));
  check(BVDotVec(y, v, dots.data()));
  std::vector<double> result;
  for (const auto& dot : dots) result.push_back(PetscRealPart(dot));
  return result;
}

}  // namespace

ReducedModel::ReducedModel(Pencil& pencil, const Ends& ends, Nature nature, int most_pairs)
    : pencil_(pencil),
      nature_(nature),
      root_(copy_of(ends.weight)),
      inverse_root_(copy_of(ends.weight)),
      most_pairs_(room_for(most_pairs, ends.b)),
      right_(basis_like(ends.b, most_pairs_)),
      left_(basis_like(ends.b, most_pairs_)),
      image_(basis_like(ends.b, most_pairs_)),
      b_(copy_of(ends.b)),
      c_(copy_of(ends.c)) {
  check(VecSqrtAbs(root_));
  check(VecCopy(root_, inverse_root_));
  check(VecReciprocal(inverse_root_));
  check(VecPointwiseMult(b_, b_, root_));
  check(VecPointwiseMult(c_, c_, inverse_root_));
  if (nature == Nature::rough) return;
  const petsc::VecHandle ab = copy_of(b_), ca = copy_of(c_);
  multiply(b_, ab, false);
  multiply(c_, ca, true);
  append(b_, c_);
  append(ab, ca);
}

// y = D^1/2 A D^-1/2 x or its transpose.
void ReducedModel::multiply(Vec x, Vec y, bool transposed) const {
  const petsc::VecHandle scaled = copy_of(x);
  check(VecPointwiseMult(scaled, scaled, transposed ? root_ : inverse_root_));
  pencil_.multiply(scaled, y, transposed);
  check(VecPointwiseMult(y, y, transposed ? inverse_root_ : root_));
}

bool ReducedModel::append(Vec v, Vec w) {
  if (!appended(right_, pairs_, v) || !appended(left_, pairs_, w)) return false;
  const petsc::VecHandle column = copy_of(v), image = copy_of(v);
  check(BVCopyVec(right_, pairs_, column));
  multiply(column, image, false);
  check(BVInsertVec(image_, pairs_, image));
  ++pairs_;
  return true;
}

// v <- (s + A)^-1 v and w <- w (s + A)^-1, scaled.
void ReducedModel::resolve(double shift, Vec v, Vec w) {
  const petsc::VecHandle b = copy_of(v), c = copy_of(w);
  check(VecPointwiseMult(b, b, inverse_root_));
  check(VecPointwiseMult(c, c, root_));
  const bool refined = nature_ == Nature::rough;
  pencil_.solve(shift, b, v, false, refined);
  pencil_.solve(shift, c, w, true, refined);
  check(VecPointwiseMult(v, v, root_));
  check(VecPointwiseMult(w, w, inverse_root_));
}

int ReducedModel::extend(double shift, int count) {
  Chain& chain = chains_[shift];
  if (chain.v == nullptr) chain = {copy_of(b_), copy_of(c_)};
  int added = 0;
  for (; added < count && !full(); ++added) {
    resolve(shift, chain.v, chain.w);
    if (!append(chain.v, chain.w)) break;
    // The chain continues from the new direction alone, as Arnoldi's process does.
    check(BVCopyVec(right_, pairs_ - 1, chain.v));
    check(BVCopyVec(left_, pairs_ - 1, chain.w));
  }
  return added;
}

Reduced ReducedModel::reduce() const {
  for (BV basis : {BV(right_), BV(left_), BV(image_)}) check(BVSetActiveColumns(basis, 0, pairs_));
  const algebra::SingularValues g(products(right_, left_, pairs_));
  const Matrix<double> projected = products(image_, left_, pairs_);
  // Directions of V and W that are orthogonal to the rounding of the products see nothing of each
  // other; the others are scaled so that W^T V = 1.
  constexpr double rounding = 1e-14;
  const int seen = static_cast<int>(
      std::count_if(g.value.begin(), g.value.end(), [](double s) { return s > rounding; }));
  Matrix<double> to_left(seen, pairs_), to_right(pairs_, seen);
  for (int n = 0; n < seen; ++n) {
    const double scale = 1 / std::sqrt(g.value[n]);
    for (int row = 0; row < pairs_; ++row) {
      to_left(n, row) = scale * g.left(row, n);
      to_right(row, n) = scale * g.right_transposed(n, row);
    }
  }
  Reduced r;
  r.m = -1.0 * (to_left * projected * to_right);
  r.beta = to_left * products(left_, b_, pairs_);
  r.gamma = products(right_, c_, pairs_) * to_right;
  return r;
}

Reduced whole_model(const Pencil& pencil, const Ends& ends, bool scaled) {
  PetscInt size = 0;
  check(VecGetSize(ends.b, &size));
  const int n = static_cast<int>(size);
  const petsc::BvHandle units = basis_like(ends.b, n), images = basis_like(ends.b, n);
  const petsc::VecHandle unit = copy_of(ends.b), image = copy_of(ends.b);
  for (int column = 0; column < n; ++column) {
    check(VecSet(unit, 0));
    check(VecSetValue(unit, column, 1, INSERT_VALUES));
    check(VecAssemblyBegin(unit));
    check(VecAssemblyEnd(unit));
    pencil.multiply(unit, image, false);
    check(BVInsertVec(units, column, unit));
    check(BVInsertVec(images, column, image));
  }
  Reduced r{-1.0 * products(images, units, n), products(units, ends.b, n),
            products(units, ends.c, n)};
  if (!scaled) return r;
  const auto weight = products(units, ends.weight, n);
  for (int j = 0; j < n; ++j) {
    const double root = std::sqrt(weight[j]);
    for (int i = 0; i < n; ++i) {
      r.m(j, i) *= root;
      r.m(i, j) /= root;
    }
    r.beta[j] *= root;
    r.gamma[j] /= root;
  }
  return r;
}

namespace {

/// The search for a good model.
class Search {
 public:
  Search(ReducedModel& model, const Questions& questions) : model_(model), questions_(questions) {}

  Answers run() {
    shifts_ = questions_.first_shifts;
    extend();  // a first model is not worth its questions
    grow();
    int barren = 0;  // blocks in a row that did not help
    while (!model_.full() && barren < questions_.patience &&
           best_.relative_error > questions_.tolerance) {
      const double before = best_.relative_error;
      const bool grew = grow();
      barren = grew && best_.relative_error < 0.3 * before ? 0 : barren + 1;
      if (barren > 0) add_shift();
    }
    doubt_best();
    best_.pairs = model_.pairs();
    best_.shifts = shifts_;
    return std::move(best_);
  }

 private:
  static constexpr int kBlock = 4;

  // About a block of pairs, shared out over the shifts: many pairs at few shifts are nearly
  // dependent.
  bool extend() {
    const int each = std::max(1, kBlock / static_cast<int>(shifts_.size()));
    int added = 0;
    for (double shift : shifts_) added += model_.extend(shift, each);
    return added > 0;
  }

  bool grow() {
    const bool grew = extend();
    Answers now;
    now.model = model_.reduce();
    now.value = questions_.values(now.model);
    judge(now);
    met_.push_back(now.value);
    if (best_.value.empty() || now.relative_error < best_.relative_error) {
      best_ = std::move(now);
      best_at_ = met_.size() - 1;
    }
    return grew;
  }

  [[nodiscard]] double size(double value) const {
    return questions_.each_by_its_size ? std::abs(value) : 1;
  }

  // The changes of a value fall from block to block. Once those of rough ends have grown they are
  // noise that adds up: a value is then no better known than it is far from all met since.
  void judge(Answers& now) {
    const std::size_t last = met_.empty() ? 0 : met_.size() - 1;
    double largest = 0;
    for (std::size_t n = 0; n < now.value.size(); ++n) {
      largest = std::max(largest, distance(now.value, last, n) / size(now.value[n]));
    }
    if (model_.nature() == ReducedModel::Nature::rough && largest > change_) {
      noisy_from_ = std::min(noisy_from_, last);
    }
    change_ = largest;
    relative_.clear();
    for (std::size_t n = 0; n < now.value.size(); ++n) {
      double error = std::numeric_limits<double>::epsilon() * size(now.value[n]);
      for (std::size_t m = std::min(noisy_from_, last); m <= last; ++m) {
        error = std::max(error, distance(now.value, m, n));
      }
      now.error.push_back(error);
      relative_.push_back(error / size(now.value[n]));
    }
    now.relative_error = *std::max_element(relative_.begin(), relative_.end());
  }

  // From value n of the model met m-th; the first has only its size to be judged by.
  [[nodiscard]] double distance(const std::vector<double>& value, std::size_t m,
                                std::size_t n) const {
    const double change = met_.empty() ? size(value[n]) : std::abs(value[n] - met_[m][n]);
    // A projection may have a pole on the wrong side; the next ones have it elsewhere.
    return std::isfinite(change) ? change : std::numeric_limits<double>::infinity();
  }

  // The best of several that miss the tolerance owes something to chance. The next one, which was
  // to be better, shows how much: the error lies between the changes before and after it.
  void doubt_best() {
    if (model_.nature() == ReducedModel::Nature::smooth || best_at_ + 1 == met_.size() ||
        best_.relative_error <= questions_.tolerance) {
      return;
    }
    for (std::size_t n = 0; n < best_.value.size(); ++n) {
      const double after = distance(best_.value, best_at_ + 1, n);
      best_.error[n] = std::max(best_.error[n], std::sqrt(best_.error[n] * after));
      best_.relative_error = std::max(best_.relative_error, best_.error[n] / size(best_.value[n]));
    }
  }

  // Where the error is largest, unless a shift is near.
  void add_shift() {
    const auto worst = std::max_element(relative_.begin(), relative_.end()) - relative_.begin();
    const double shift = std::clamp(questions_.shift[worst], questions_.lowest, questions_.highest);
    for (double s : shifts_) {
      if (std::abs(std::log(shift / s)) < std::log(1.5)) return;
    }
    shifts_.push_back(shift);
  }

  ReducedModel& model_;
  const Questions& questions_;
  Answers best_;
  std::size_t best_at_ = 0;
  std::vector<std::vector<double>> met_;  // values of all models
  std::size_t noisy_from_ = std::numeric_limits<std::size_t>::max();
  double change_ = std::numeric_limits<double>::infinity();
  std::vector<double> shifts_, relative_;
};

}  // namespace

Answers ask(ReducedModel& model, const Questions& questions) {
  return Search(model, questions).run();
}

}  // namespace stickslip::quantities
