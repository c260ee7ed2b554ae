#include "stickslip/quantities/reduced_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "stickslip/petsc/check.hpp"

namespace stickslip::quantities {
namespace {

using petsc::check;

petsc::BvHandle basis_like(Vec vec, int columns) {
  petsc::BvHandle basis;
  check(BVCreate(PetscObjectComm(reinterpret_cast<PetscObject>(vec)), basis.out()));
  check(BVSetSizesFromVec(basis, vec, columns));
  check(BVSetFromOptions(basis));
  return basis;
}

// What is left of vec outside the first `column` columns, as a new column; its norm before scaling.
double orthogonalised(BV basis, int column, Vec vec) {
  check(BVInsertVec(basis, column, vec));
  PetscReal norm = 0;
  check(BVOrthogonalizeColumn(basis, column, nullptr, &norm, nullptr));
  if (norm > 0) check(BVScaleColumn(basis, column, 1 / norm));
  return norm;
}

exact::Matrix real_matrix(Mat dense, int size) {
  exact::Matrix result(size, size);
  const PetscScalar* values = nullptr;
  PetscInt leading = 0;
  check(MatDenseGetLDA(dense, &leading));
  check(MatDenseGetArrayRead(dense, &values));
  for (int c = 0; c < size; ++c) {
    for (int r = 0; r < size; ++r) result(r, c) = PetscRealPart(values[c * leading + r]);
  }
  check(MatDenseRestoreArrayRead(dense, &values));
  return result;
}

// Y^T X of the first columns.
exact::Matrix products(BV x, BV y, int size) {
  petsc::MatHandle dense;
  check(MatCreateSeqDense(PETSC_COMM_SELF, size, size, nullptr, dense.out()));
  check(BVSetActiveColumns(x, 0, size));
  check(BVSetActiveColumns(y, 0, size));
  check(BVDot(x, y, dense));
  return real_matrix(dense, size);
}

petsc::VecHandle copy_of(Vec vec) {
  petsc::VecHandle copy;
  check(VecDuplicate(vec, copy.out()));
  check(VecCopy(vec, copy));
  return copy;
}

}  // namespace

ReducedModel::ReducedModel(operators::Systems& systems, Sector sector, Vec b, Vec c, Vec weight,
                           int most_vectors)
    : systems_(systems),
      sector_(sector),
      root_(copy_of(weight)),
      inverse_root_(copy_of(weight)),
      minus_l_(operators::assemble(systems.comm(), systems.process(), systems.axis(), 0,
                                   sector.symmetry, sector.rest, systems.ledger())),
      most_vectors_(most_vectors),
      right_(basis_like(b, most_vectors)),
      left_(basis_like(c, most_vectors)) {
  check(VecSqrtAbs(root_));
  check(VecCopy(root_, inverse_root_));
  check(VecReciprocal(inverse_root_));
  check(MatDiagonalScale(minus_l_.matrix(), root_, inverse_root_));
  const petsc::VecHandle v = copy_of(b), w = copy_of(c), lv = copy_of(b), wl = copy_of(c);
  check(VecPointwiseMult(v, v, root_));
  check(VecPointwiseMult(w, w, inverse_root_));
  check(VecNorm(v, NORM_2, &beta_));
  check(VecNorm(w, NORM_2, &gamma_));
  check(MatMult(minus_l_.matrix(), v, lv));
  check(MatMultTranspose(minus_l_.matrix(), w, wl));
  append(v, w);
  append(lv, wl);
}

ReducedModel::~ReducedModel() {
  for (const auto& chain : chains_) systems_.release(chain.first, sector_.symmetry, sector_.rest);
}

bool ReducedModel::append(Vec v, Vec w) {
  PetscReal v_size = 0, w_size = 0;
  check(VecNorm(v, NORM_2, &v_size));
  check(VecNorm(w, NORM_2, &w_size));
  const double v_new = orthogonalised(right_, size_, v), w_new = orthogonalised(left_, size_, w);
  // What is left of a vector inside the space is rounding.
  constexpr double smallest = 1e-13;
  if (!(v_new > smallest * v_size) || !(w_new > smallest * w_size)) return false;
  ++size_;
  return true;
}

int ReducedModel::extend(double shift, int count) {
  auto& factors = systems_.at(shift, sector_.symmetry, sector_.rest).factors();
  Chain& chain = chains_[shift];
  if (chain.v == nullptr) {
    Vec first = nullptr;
    check(BVGetColumn(right_, 0, &first));
    chain.v = copy_of(first);
    check(BVRestoreColumn(right_, 0, &first));
    check(BVGetColumn(left_, 0, &first));
    chain.w = copy_of(first);
    check(BVRestoreColumn(left_, 0, &first));
  }
  int added = 0;
  for (; added < count && !full(); ++added) {
    const petsc::VecHandle v = copy_of(chain.v), w = copy_of(chain.w);
    check(VecPointwiseMult(v, v, inverse_root_));
    check(VecPointwiseMult(w, w, root_));
    factors.solve_once(v, chain.v);
    factors.solve_transposed_once(w, chain.w);
    check(VecPointwiseMult(chain.v, chain.v, root_));
    check(VecPointwiseMult(chain.w, chain.w, inverse_root_));
    if (!append(chain.v, chain.w)) break;
    // The chain goes on from the new direction alone, as Arnoldi's process does.
    check(BVCopyVec(right_, size_ - 1, chain.v));
    check(BVCopyVec(left_, size_ - 1, chain.w));
  }
  return added;
}

Reduced ReducedModel::reduce() const {
  Reduced r;
  r.g = products(right_, left_, size_);
  petsc::BvHandle image;
  check(BVDuplicate(right_, image.out()));
  check(BVSetActiveColumns(right_, 0, size_));
  check(BVSetActiveColumns(image, 0, size_));
  check(BVMatMult(right_, minus_l_.matrix(), image));
  r.m = exact::LuFactors(r.g).solve(-1.0 * products(image, left_, size_));
  r.beta.assign(static_cast<std::size_t>(size_), 0.0);
  r.gamma = r.beta;
  r.beta[0] = beta_;
  r.gamma[0] = gamma_;
  return r;
}

namespace {

/// The search for a good model.
class Search {
 public:
  Search(ReducedModel& model, const Questions& questions) : model_(model), questions_(questions) {}

  Answers run() {
    shifts_ = {questions_.first_shift};
    grow();
    int barren = 0;  // blocks in a row that did not help
    while (!model_.full() && barren < kPatience && best_.relative_error > questions_.tolerance) {
      const double before = best_.relative_error;
      const bool grew = grow();
      barren = grew && best_.relative_error < 0.3 * before ? 0 : barren + 1;
      if (barren > 0) add_shift();
    }
    best_.vectors = model_.size();
    best_.shifts = shifts_;
    return std::move(best_);
  }

 private:
  static constexpr int kBlock = 6, kPatience = 5;

  bool grow() {
    const bool grew = model_.extend(shifts_.back(), kBlock) > 0;
    Answers now;
    now.model = model_.reduce();
    now.value = questions_.values(now.model);
    judge(now);
    last_ = now.value;
    if (best_.value.empty() || now.relative_error < best_.relative_error) best_ = std::move(now);
    return grew;
  }

  void judge(Answers& now) {
    relative_.assign(now.value.size(), 1.0);
    double largest = 0;
    for (double v : now.value) largest = std::max(largest, std::abs(v));
    for (std::size_t n = 0; n < now.value.size(); ++n) {
      const double size = questions_.each_by_its_size ? std::abs(now.value[n]) : largest;
      const double rounding = std::numeric_limits<double>::epsilon() * size;
      const double change = last_.empty() ? size : std::abs(now.value[n] - last_[n]);
      now.error.push_back(std::max(change, rounding));
      relative_[n] = now.error[n] / size;
    }
    now.relative_error = *std::max_element(relative_.begin(), relative_.end());
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
  std::vector<double> shifts_, last_, relative_;
};

}  // namespace

Answers ask(ReducedModel& model, const Questions& questions) {
  return Search(model, questions).run();
}

}  // namespace stickslip::quantities
