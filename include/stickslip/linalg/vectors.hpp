#pragma once
/// Local views of distributed vectors and matrices, and the inner product of vectors.

#include <petscksp.h>
#include <petscsys.h>
#include <slepcbv.h>
#include <slepceps.h>

#include <exception>
#include <iterator>
#include <type_traits>
#include <utility>
#include <vector>

#include "stickslip/linalg/dense.hpp"
#include "stickslip/linalg/petsc.hpp"

namespace stickslip::linalg {

// Ownership of PETSc objects.

/// Move-only owner of one PETSc object; converts to the raw handle, which every PETSc call takes.
///
/// Destruction is collective. When one rank unwinds alone, a collective Destroy would make it wait
/// for the others for ever; so a handle that dies during unwinding on several ranks forgets its
/// object, and main ends all ranks with MPI_Abort.
template <class T, PetscErrorCode (*Destroy)(T*)>
class Handle {
 public:
  Handle() = default;
  explicit Handle(T object) : object_(object) {}
  Handle(Handle&& other) noexcept : object_(std::exchange(other.object_, nullptr)) {}
  Handle& operator=(Handle&& other) noexcept {
    if (this != &other) {
      reset();
      object_ = std::exchange(other.object_, nullptr);
    }
    return *this;
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() { reset(); }

  /// Address to create an object into; what was held before is destroyed.
  [[nodiscard]] T* out() {
    reset();
    return &object_;
  }
  // NOLINTNEXTLINE(google-explicit-constructor): a handle stands for its object in PETSc calls.
  operator T() const { return object_; }

 private:
  void reset() noexcept {
    if (object_ == nullptr) return;
    if (std::uncaught_exceptions() > 0 && ranks() > 1) return;
    (void)Destroy(&object_);
    object_ = nullptr;
  }
  [[nodiscard]] int ranks() const {
    int size = 1;
    MPI_Comm_size(PetscObjectComm(reinterpret_cast<PetscObject>(object_)), &size);
    return size;
  }

  T object_ = nullptr;
};

using VecHandle = Handle<Vec, VecDestroy>;
using MatHandle = Handle<Mat, MatDestroy>;
using KspHandle = Handle<KSP, KSPDestroy>;
using BvHandle = Handle<BV, BVDestroy>;
using EpsHandle = Handle<EPS, EPSDestroy>;

// The scalar type of this build variant, and dense matrices of it.

inline constexpr bool kComplex = PetscDefined(USE_COMPLEX);

using DenseMatrix = Matrix<PetscScalar>;
using DenseFactors = LuFactors<PetscScalar>;
using Scalars = std::vector<PetscScalar>;

/// Access to the local part of a Vec for the life of the view. Not collective.
template <class Entry, auto take, auto give_back>
class View {
 public:
  explicit View(Vec vec) : vec_(vec) {
    check(VecGetLocalSize(vec_, &size_));
    check(take(vec_, &data_));
  }
  ~View() { (void)give_back(vec_, &data_); }
  View(const View&) = delete;
  View& operator=(const View&) = delete;

  [[nodiscard]] Entry& operator[](PetscInt i) const { return data_[i]; }
  [[nodiscard]] PetscInt size() const { return size_; }
  [[nodiscard]] Entry* data() const { return data_; }

 private:
  Vec vec_;
  PetscInt size_ = 0;
  Entry* data_ = nullptr;
};
using ReadView = View<const PetscScalar, VecGetArrayRead, VecRestoreArrayRead>;
using WriteView = View<PetscScalar, VecGetArray, VecRestoreArray>;

/// Read access to a local row of a Mat for the life of the view. Not collective.
class RowView {
 public:
  RowView(Mat matrix, PetscInt row) : matrix_(matrix), row_(row) {
    check(MatGetRow(matrix_, row_, &count_, &columns_, &values_));
  }
  ~RowView() { (void)MatRestoreRow(matrix_, row_, &count_, &columns_, &values_); }
  RowView(const RowView&) = delete;
  RowView& operator=(const RowView&) = delete;

  /// Calls visit(column, value) for each entry.
  template <class Visit>
  void for_each(Visit visit) const {
    for (PetscInt n = 0; n < count_; ++n) visit(columns_[n], values_[n]);
  }

 private:
  Mat matrix_;
  PetscInt row_, count_ = 0;
  const PetscInt* columns_ = nullptr;
  const PetscScalar* values_ = nullptr;
};

/// Rows of a matrix, wherever they are. Collective.
class RowsOnAllRanks {
 public:
  RowsOnAllRanks(Mat matrix, const std::vector<PetscInt>& rows) {
    PetscInt columns = 0;
    check(MatGetSize(matrix, nullptr, &columns));
    IndexSet of_rows, of_columns;
    const auto count = static_cast<PetscInt>(rows.size());
    check(ISCreateGeneral(PETSC_COMM_SELF, count, rows.data(), PETSC_USE_POINTER, of_rows.out()));
    check(ISCreateStride(PETSC_COMM_SELF, columns, 0, 1, of_columns.out()));
    IS row = of_rows, column = of_columns;
    check(MatCreateSubMatrices(matrix, 1, &row, &column, MAT_INITIAL_MATRIX, &rows_));
  }
  ~RowsOnAllRanks() { (void)MatDestroySubMatrices(1, &rows_); }
  RowsOnAllRanks(const RowsOnAllRanks&) = delete;
  RowsOnAllRanks& operator=(const RowsOnAllRanks&) = delete;
  [[nodiscard]] RowView row(std::size_t n) const { return {rows_[0], static_cast<PetscInt>(n)}; }

 private:
  using IndexSet = Handle<IS, ISDestroy>;
  Mat* rows_ = nullptr;
};

/// The vectors of a matrix, whole on every rank.
class WholeVectors {
 public:
  /// Collective.
  explicit WholeVectors(Mat matrix) {
    VecHandle any;
    check(MatCreateVecs(matrix, nullptr, any.out()));
    check(VecScatterCreateToAll(any, scatter_.out(), all_.out()));
    check(VecGetOwnershipRange(any, &begin_, nullptr));
  }
  /// All entries of a vector. Collective.
  [[nodiscard]] std::vector<PetscScalar> gathered(Vec vec) const {
    check(VecScatterBegin(scatter_, vec, all_, INSERT_VALUES, SCATTER_FORWARD));
    check(VecScatterEnd(scatter_, vec, all_, INSERT_VALUES, SCATTER_FORWARD));
    const ReadView all(all_);
    return {all.data(), all.data() + all.size()};
  }
  /// Sets the entries of this rank to part(entry), for all of them on every rank. Local.
  template <class Scalar, class Part>
  void scatter(const Scalar* all, Vec vec, Part part) const {
    WriteView local(vec);
    for (PetscInt n = 0; n < local.size(); ++n) local[n] = part(all[begin_ + n]);
  }

 private:
  Handle<VecScatter, VecScatterDestroy> scatter_;
  VecHandle all_;
  PetscInt begin_ = 0;
};

/// Adds the numbers of all ranks up, entry by entry. Collective.
template <class Numbers>
void sum_over_ranks(MPI_Comm comm, Numbers& numbers) {
  constexpr bool real = std::is_same_v<decltype(*std::data(numbers)), double&>;
  const auto type = real ? MPI_DOUBLE : MPI_C_DOUBLE_COMPLEX;
  MPI_Allreduce(MPI_IN_PLACE, std::data(numbers), static_cast<int>(std::size(numbers)), type,
                MPI_SUM, comm);
}

/// Collective.
[[nodiscard]] inline VecHandle copy_of(Vec vec) {
  VecHandle copy;
  check(VecDuplicate(vec, copy.out()));
  check(VecCopy(vec, copy));
  return copy;
}

/// Entry by entry. Collective.
[[nodiscard]] inline VecHandle product(Vec a, Vec b) {
  VecHandle both = copy_of(a);
  check(VecPointwiseMult(both, a, b));
  return both;
}

/// Collective.
[[nodiscard]] inline double norm(Vec x, NormType type) {
  PetscReal size = 0;
  check(VecNorm(x, type, &size));
  return size;
}

/// Scales the entries such that their sum is 1. Collective.
inline void scale_to_sum_one(Vec x) {
  PetscScalar sum = 0;
  check(VecSum(x, &sum));
  check(VecScale(x, 1.0 / sum));
}

/// Real part of sum_n a_n b_n, without conjugation. Collective.
[[nodiscard]] inline double dot(Vec a, Vec b) {
  PetscScalar sum = 0;
  check(VecTDot(a, b, &sum));
  return PetscRealPart(sum);
}

// What differs between the versions of PETSc from 3.18 on, and nothing else.

/// What a function that reads the options of an object is given.
#if PETSC_VERSION_LT(3, 23, 0)
using OptionItems = PetscOptionItems*;
#else
using OptionItems = PetscOptionItems;
#endif

/// Makes a container the owner of the T, made by new, that it points to. Returns PETSc's error
/// code.
template <class T>
[[nodiscard]] PetscErrorCode own_contents(PetscContainer container) {
#if PETSC_VERSION_LT(3, 23, 0)
  return PetscContainerSetUserDestroy(container, [](void* contents) -> PetscErrorCode {
    delete static_cast<T*>(contents);
    return 0;
  });
#else
  // The address of the pointer: a void** in 3.23, a void* later.
  return PetscContainerSetCtxDestroy(container, [](auto address) -> PetscErrorCode {
    delete *static_cast<T**>(static_cast<void*>(address));
    return 0;
  });
#endif
}

}  // namespace stickslip::linalg
