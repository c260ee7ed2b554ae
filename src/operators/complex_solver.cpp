#include "stickslip/operators/complex_solver.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "stickslip/operators/element_elimination.hpp"
#include "stickslip/operators/solver_policy.hpp"
#include "stickslip/operators/systems.hpp"
#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/linear_solver.hpp"
#include "stickslip/petsc/solver_choice.hpp"
#include "stickslip/petsc/vectors.hpp"
#include "stickslip/support/errors.hpp"

namespace stickslip::operators {
namespace {

using petsc::check;
using Complex = std::complex<double>;

// What a solution keeps of its right-hand side after one step of refinement.
constexpr double kLargestCorrection = 1e-3;

bool serves_elements(const KolmogorovOperator& a) {
  const cases::Factors given = given_factors();
  if (given != cases::Factors::own) return given == cases::Factors::elements;
  return std::strcmp(default_pc_type(a.discretisation()), petsc::kElementsPc) == 0;
}

double norm(const ComplexVector& x) {
  PetscReal real = 0, imaginary = 0;
  check(VecNorm(x.real, NORM_2, &real));
  check(VecNorm(x.imaginary, NORM_2, &imaginary));
  return std::hypot(real, imaginary);
}

}  // namespace

std::complex<double> dot(Vec c, const ComplexVector& x) {
  return {petsc::dot(c, x.real), petsc::dot(c, x.imaginary)};
}

class ComplexSolver::Factors {
 public:
  virtual ~Factors() = default;
  virtual void solve(const ComplexVector& b, const ComplexVector& x, bool transposed) = 0;

 protected:
  Factors() = default;
  Factors(const Factors&) = delete;
  Factors& operator=(const Factors&) = delete;
};

class ComplexSolver::ByElements final : public Factors {
 public:
  ByElements(const KolmogorovOperator& a, const Shift<Complex>& shift)
      : factors_(a.matrix(), data_of(a.matrix()), shift), vectors_(a.matrix()) {}

  void solve(const ComplexVector& b, const ComplexVector& x, bool transposed) override {
    const auto real = vectors_.gathered(b.real), imaginary = vectors_.gathered(b.imaginary);
    algebra::Matrix<Complex> all(static_cast<int>(real.size()), 1);
    for (std::size_t n = 0; n < real.size(); ++n) {
      all.data()[n] = {PetscRealPart(real[n]), PetscRealPart(imaginary[n])};
    }
    factors_.solve(all, transposed);
    vectors_.scatter(all.data(), x.real, [](Complex entry) { return entry.real(); });
    vectors_.scatter(all.data(), x.imaginary, [](Complex entry) { return entry.imag(); });
  }

 private:
  ElementElimination<Complex> factors_;
  petsc::WholeVectors vectors_;
};

/// The real and then the imaginary parts of each rank.
class ComplexSolver::InRealForm final : public Factors {
 public:
  InRealForm(const KolmogorovOperator& a, const ComplexVector& diagonal,
             petsc::SolverStatistics& statistics) {
    check(MatGetOwnershipRange(a.matrix(), &begin_, &end_));
    check(MatGetOwnershipRanges(a.matrix(), &ranges_));
    const PetscInt local = 2 * (end_ - begin_);
    const auto object = reinterpret_cast<PetscObject>(a.matrix());
    check(MatCreate(PetscObjectComm(object), matrix_.out()));
    check(MatSetSizes(matrix_, local, local, PETSC_DETERMINE, PETSC_DETERMINE));
    check(MatSetType(matrix_, MATAIJ));
    PetscInt most = 0;
    for (PetscInt row = begin_; row < end_; ++row) {
      const petsc::RowView view(a.matrix(), row);
      PetscInt count = 2;
      view.for_each([&](PetscInt, PetscScalar) { ++count; });
      most = std::max(most, count);
    }
    check(MatSeqAIJSetPreallocation(matrix_, most, nullptr));
    check(MatMPIAIJSetPreallocation(matrix_, most, nullptr, most, nullptr));
    const petsc::ReadView real(diagonal.real), imaginary(diagonal.imaginary);
    for (PetscInt row = begin_; row < end_; ++row) {
      const PetscInt n = row - begin_;
      add_row(a.matrix(), row, {PetscRealPart(real[n]), PetscRealPart(imaginary[n])});
    }
    check(MatAssemblyBegin(matrix_, MAT_FINAL_ASSEMBLY));
    check(MatAssemblyEnd(matrix_, MAT_FINAL_ASSEMBLY));
    factors_ = std::make_unique<petsc::Factorization>(matrix_, kSlidePrefix, statistics, PCLU);
  }

  // The transposed real form is that of the transposed matrix for the conjugate of d.
  void solve(const ComplexVector& b, const ComplexVector& x, bool transposed) override {
    const double sign = transposed ? -1 : 1;
    petsc::VecHandle all, solved;
    check(MatCreateVecs(matrix_, all.out(), solved.out()));
    {
      const petsc::ReadView real(b.real), imaginary(b.imaginary);
      petsc::WriteView to(all);
      auto* const next = std::copy_n(real.data(), real.size(), to.data());
      std::transform(imaginary.data(), imaginary.data() + imaginary.size(), next,
                     [sign](PetscScalar value) { return sign * value; });
    }
    transposed ? factors_->solve_transposed_once(all, solved) : factors_->solve_once(all, solved);
    const petsc::ReadView from(solved);
    petsc::WriteView real(x.real), imaginary(x.imaginary);
    std::copy_n(from.data(), real.size(), real.data());
    const auto* const next = from.data() + real.size();
    std::transform(next, next + imaginary.size(), imaginary.data(),
                   [sign](PetscScalar value) { return sign * value; });
  }

 private:
  // Of the real part; the imaginary one follows after all real ones of its rank.
  [[nodiscard]] PetscInt place(PetscInt index, bool imaginary) const {
    PetscInt rank = 0;
    while (ranges_[rank + 1] <= index) ++rank;
    return ranges_[rank] + index + (imaginary ? ranges_[rank + 1] - ranges_[rank] : 0);
  }

  void add_row(Mat a, PetscInt row, Complex d) const {
    const petsc::RowView view(a, row);
    for (bool imaginary : {false, true}) {
      const PetscInt at = place(row, imaginary);
      const auto add = [&](PetscInt column, PetscScalar value) {
        check(MatSetValue(matrix_, at, column, value, ADD_VALUES));
      };
      view.for_each(
          [&](PetscInt column, PetscScalar value) { add(place(column, imaginary), value); });
      add(at, d.real());
      add(place(row, !imaginary), (imaginary ? 1 : -1) * d.imag());
    }
  }

  PetscInt begin_ = 0, end_ = 0;
  const PetscInt* ranges_ = nullptr;
  petsc::MatHandle matrix_;
  std::unique_ptr<petsc::Factorization> factors_;
};

ComplexSolver::ComplexSolver(const KolmogorovOperator& a, Shift<Complex> shift,
                             petsc::SolverStatistics& statistics)
    : a_(a), diagonal_{a.zeros(), a.zeros()}, statistics_(statistics) {
  {
    petsc::WriteView real(diagonal_.real), imaginary(diagonal_.imaginary);
    PetscInt at = 0;
    a.states().for_each_local([&](const State& state) {
      const Complex d = shift.at(velocity_of(state, *a.discretisation().velocities));
      real[at] = d.real();
      imaginary[at++] = d.imag();
    });
  }
  if (!serves_elements(a)) {
    factors_ = std::make_unique<InRealForm>(a, diagonal_, statistics);
    return;
  }
  const petsc::PhaseTimer timer("factorisation", statistics_.factorization_seconds);
  factors_ = std::make_unique<ByElements>(a, shift);
  ++statistics_.factorizations_complex;
}

ComplexSolver::~ComplexSolver() = default;

ComplexVector ComplexSolver::residual(const ComplexVector& b, const ComplexVector& x,
                                      bool transposed) const {
  ComplexVector r{petsc::copy_of(b.real), petsc::copy_of(b.imaginary)};
  const petsc::VecHandle image = a_.zeros();
  const auto subtract = [&](Vec part, Vec d, Vec from, double sign) {
    check(VecPointwiseMult(image, part, d));
    check(VecAXPY(from, -sign, image));
  };
  for (const auto& [part, from] :
       {std::pair{Vec(x.real), Vec(r.real)}, std::pair{Vec(x.imaginary), Vec(r.imaginary)}}) {
    check(transposed ? MatMultTranspose(a_.matrix(), part, image)
                     : MatMult(a_.matrix(), part, image));
    check(VecAXPY(from, -1, image));
  }
  subtract(x.real, diagonal_.real, r.real, 1);
  subtract(x.imaginary, diagonal_.imaginary, r.real, -1);
  subtract(x.imaginary, diagonal_.real, r.imaginary, 1);
  subtract(x.real, diagonal_.imaginary, r.imaginary, 1);
  return r;
}

ComplexVector ComplexSolver::solve_once(const ComplexVector& b, bool transposed) {
  const petsc::PhaseTimer timer("solve", statistics_.solve_seconds);
  ComplexVector x{a_.zeros(), a_.zeros()};
  factors_->solve(b, x, transposed);
  ++statistics_.solves;
  return x;
}

ComplexSolver::Solution ComplexSolver::solve(const ComplexVector& b, bool transposed) {
  Solution s{solve_once(b, transposed), {a_.zeros(), a_.zeros()}};
  const petsc::PhaseTimer timer("solve", statistics_.solve_seconds);
  factors_->solve(residual(b, s.x, transposed), s.correction, transposed);
  check(VecAXPY(s.x.real, 1, s.correction.real));
  check(VecAXPY(s.x.imaginary, 1, s.correction.imaginary));
  ++statistics_.corrections;
  const double size = norm(s.x);
  s.change = size > 0 ? norm(s.correction) / size : 0;
  if (!(s.change <= kLargestCorrection)) {
    throw NotReached("complex factors of z - L are too inaccurate for iterative refinement");
  }
  return s;
}

}  // namespace stickslip::operators
