#include <petscsys.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <type_traits>

#include "../common/catch.hpp"
#include "../common/matrices.hpp"
#include "../common/options.hpp"
#include "stickslip/base/errors.hpp"
#include "stickslip/linalg/eigensolver.hpp"
#include "stickslip/linalg/petsc.hpp"
#include "stickslip/linalg/solver_options.hpp"
#include "stickslip/linalg/vectors.hpp"

using namespace stickslip;
using namespace stickslip::linalg;
using test::Given;
using test::matrix;
using test::Row;

namespace {

// A walk round a ring, one way: 1 on the diagonal, -1 after it. Eigenvalues 1 - exp(2 pi i m/n).
MatHandle ring(PetscInt n) {
  return matrix(n, [n](PetscInt r) { return Row{{r, 1}, {(r + 1) % n, -1}}; });
}

// Blocks [a -b; b a] with a = 1, 2, ... and b = 1/2, each coupled to the next one: far from normal,
// eigenvalues a +- i b.
MatHandle rotations(PetscInt n) {
  return matrix(n, [n](PetscInt r) {
    const double a = 1 + static_cast<double>(r / 2);
    Row row{{r, a}, r % 2 == 0 ? Row::value_type{r + 1, -0.5} : Row::value_type{r - 1, 0.5}};
    if (r + 2 < n) row.emplace_back(r + 2, 1);
    return row;
  });
}

std::vector<std::complex<double>> values(const Eigensolver& solver) {
  std::vector<std::complex<double>> all;
  for (const auto& pair : solver.pairs()) all.push_back(pair.value);
  return all;
}

// The value of an eigenpair as a scalar of this build; its real part if that is real.
template <class Scalar = PetscScalar>
Scalar scalar_of(std::complex<double> value) {
  if constexpr (std::is_same_v<Scalar, double>) {
    return value.real();
  } else {
    return value;
  }
}

// ||A x - value x||_2, |x| = 1; real builds keep the real and imaginary parts of x in two vectors.
double residual(Mat a, const Eigenpair& pair) {
  PetscReal real = 0, imaginary = 0;
  VecHandle y;
  check(VecDuplicate(pair.real, y.out()));
  check(MatMult(a, pair.real, y));
  check(VecAXPY(y, -scalar_of(pair.value), pair.real));
  if (!kComplex) check(VecAXPY(y, pair.value.imag(), pair.imaginary));
  check(VecNorm(y, NORM_2, &real));
  if (kComplex) return real;
  check(MatMult(a, pair.imaginary, y));
  check(VecAXPY(y, -scalar_of(pair.value), pair.imaginary));
  check(VecAXPY(y, -pair.value.imag(), pair.real));
  check(VecNorm(y, NORM_2, &imaginary));
  return std::hypot(real, imaginary);
}

}  // namespace

TEST_CASE("eigensolver: complex pairs of a ring, nearest to the target first", "[parallel]") {
  const PetscInt n = 12;
  const MatHandle a = ring(n);
  SolverStatistics statistics;
  const Eigensolver solver(a, "test_", -0.1, 5, statistics);
  REQUIRE(solver.pairs().size() >= 5);
  const auto found = values(solver);
  for (int m : {0, 1, -1, 2, -2}) {
    const auto known = 1.0 - std::polar(1.0, 2 * std::numbers::pi * m / static_cast<double>(n));
    const auto near = [known](const auto& value) { return std::abs(value - known) < 1e-12; };
    INFO("m = " << m);
    CHECK(std::count_if(found.begin(), found.begin() + 5, near) == 1);
  }
  for (std::size_t p = 1; p < found.size(); ++p) {
    CHECK(std::abs(found[p] + 0.1) > std::abs(found[p - 1] + 0.1) - 1e-12);
  }
}

TEST_CASE("eigensolver: conjugate pairs of a matrix far from normal", "[parallel]") {
  const MatHandle a = rotations(20);
  SolverStatistics statistics;
  const Eigensolver solver(a, "test_", -0.1, 4, statistics);
  const auto found = values(solver);
  REQUIRE(found.size() >= 4);
  for (std::size_t p = 0; p < 4; ++p) {
    CHECK(found[p].real() == Approx(p < 2 ? 1 : 2).epsilon(1e-10));
    CHECK(std::abs(found[p].imag()) == Approx(0.5).epsilon(1e-10));
    CHECK(solver.pairs()[p].residual < 1e-12);
    CHECK(residual(a, solver.pairs()[p]) < 1e-12);
  }
  CHECK(found[0].imag() == Approx(-found[1].imag()).epsilon(1e-12));
}

TEST_CASE("eigensolver: residuals are those of its vectors", "[parallel]") {
  const MatHandle a = ring(300);
  const Given given{{"-loose_eps_tol", "1e-3"}, {"-loose_eps_ncv", "12"}};
  SolverStatistics statistics;
  const Eigensolver solver(a, "loose_", -0.1, 4, statistics);
  double largest = 0;
  for (const auto& pair : solver.pairs()) {
    CHECK(pair.residual == Approx(residual(a, pair)).epsilon(1e-6).margin(1e-13));
    largest = std::max(largest, pair.residual);
  }
  CHECK(largest > 1e-10);  // there was something to see
}

TEST_CASE("eigensolver: what it did is counted in the solver statistics", "[parallel]") {
  const MatHandle a = ring(12);
  SolverStatistics statistics;
  const Eigensolver solver(a, "test_", -0.1, 1, statistics);
  CHECK(statistics.factorizations_real == (kComplex ? 0 : 1));
  CHECK(statistics.factorizations_complex == (kComplex ? 1 : 0));
  // Vectors of the space, each from one solve, at most as many as there are rows.
  CHECK(statistics.solves >= 2);
  CHECK(statistics.solves <= 4 * 12);
  CHECK(statistics.factor_entries >= 2 * 12);  // the diagonal and one coupling of each row
  CHECK(statistics.factor_entries <= 12 * 12);
}

TEST_CASE("eigensolver: the shifted matrix may be another one", "[parallel]") {
  const MatHandle a = rotations(20);
  std::vector<double> targets;
  const ShiftedSolver shifted{[&](PetscScalar target) {
    targets.push_back(PetscRealPart(target));
    MatHandle copy;
    check(MatDuplicate(a, MAT_COPY_VALUES, copy.out()));
    check(MatShift(copy, -target));
    return copy;
  }};
  const auto first = [&] {
    SolverStatistics statistics;
    const Eigensolver solver(a, "given_", -0.1, 4, statistics, shifted);
    CHECK(solver.pairs()[3].residual < 1e-12);
    return solver.pairs()[0].value.real();
  };
  CHECK(first() == Approx(1).epsilon(1e-10));
  const Given target{{"-given_eps_target", "7.1"}};
  CHECK(first() == Approx(7).epsilon(1e-8));
  const Given shift{{"-given_st_shift", "7.2"}};
  CHECK(first() == Approx(7).epsilon(1e-8));
  CHECK(targets == std::vector<double>{-0.1, 7.1, 7.2});
}

// Of pairs that converge besides some would come or not by rounding.
TEST_CASE("eigensolver: as many as wanted, and the conjugate of the last one", "[parallel]") {
  const MatHandle a = rotations(20);
  for (int wanted : {3, 4, 5}) {
    SolverStatistics statistics;
    const Eigensolver solver(a, "test_", -0.1, wanted, statistics);
    CHECK(static_cast<int>(solver.pairs().size()) == (wanted == 4 ? 4 : wanted + 1));
  }
}

TEST_CASE("eigensolver: options of the role override number and target", "[parallel]") {
  const MatHandle a = rotations(20);
  const Given given{{"-own_eps_nev", "4"},
                    {"-own_eps_target", "7.1"},
                    // The default; given here, it also goes with the others.
                    {"-own_st_mat_mumps_icntl_7", "2"}};
  SolverStatistics statistics;
  const Eigensolver solver(a, "own_", -0.1, 1, statistics);
  REQUIRE(solver.pairs().size() >= 4);
  CHECK(solver.pairs()[0].value.real() == Approx(7).epsilon(1e-8));
  CHECK(solver.pairs()[2].value.real() == Approx(8).epsilon(1e-8));
}

TEST_CASE("eigensolver: too few eigenvalues are refused, and the options that help are named") {
  // Eigenvalues crowd around the target, and one small Krylov space must do.
  const MatHandle a = ring(300);
  const Given given{{"-few_eps_max_it", "1"}, {"-few_eps_ncv", "6"}, {"-few_eps_tol", "1e-15"}};
  SolverStatistics statistics;
  try {
    const Eigensolver solver(a, "few_", -0.1, 4, statistics);
    FAIL("found " << solver.pairs().size());
  } catch (const NotReached& failure) {
    CHECK_THAT(failure.what(), Catch::Contains("of 4") && Catch::Contains("-few_eps_max_it"));
  }
}

// The constants: A 1 = 0, so that (A - target)^-1 1 = -1/target.
TEST_CASE("eigensolver: iterate is one step of inverse iteration", "[parallel]") {
  const MatHandle a = ring(12);
  SolverStatistics statistics;
  Eigensolver solver(a, "test_", -0.25, 1, statistics);
  VecHandle x;
  check(MatCreateVecs(a, x.out(), nullptr));
  check(VecSet(x, 1));
  solver.iterate(x);
  check(VecShift(x, -4));
  PetscReal distance = 1;
  check(VecNorm(x, NORM_INFINITY, &distance));
  CHECK(distance < 1e-13);
}

TEST_CASE("eigensolver: probing marks the options of a role as known") {
  const std::vector<std::string> known{"eps_tol", "eps_ncv", "st_mat_mumps_icntl_14"};
  const std::vector<std::string> unknown{"eps_tolerance", "st_mat_mumps_icntl_99"};
  const Given given{{"-probe_eps_tol", "1e-9"},
                    {"-probe_eps_ncv", "20"},
                    {"-probe_st_mat_mumps_icntl_14", "30"},
                    {"-probe_eps_tolerance", "1e-9"},
                    {"-probe_st_mat_mumps_icntl_99", "1"}};
  probe_eigensolver("probe_");
  const auto used = [](const std::string& name) {
    PetscBool is_used = PETSC_FALSE;
    check(PetscOptionsUsed(nullptr, ("probe_" + name).c_str(), &is_used));
    return is_used == PETSC_TRUE;
  };
  for (const auto& name : known) CHECK(used(name));
  for (const auto& name : unknown) CHECK_FALSE(used(name));
}

TEST_CASE("eigensolver: probing takes any number of eigenvalues and any space") {
  for (const char* number : {"1", "4", "10", "60"}) {
    const Given given{{"-many_eps_nev", number}};
    CHECK_NOTHROW(probe_eigensolver("many_"));
  }
  const Given given{{"-wide_eps_nev", "5"}, {"-wide_eps_ncv", "7"}};
  CHECK_NOTHROW(probe_eigensolver("wide_"));
}

// A Krylov space of four is enough for one eigenvalue next to the target.
TEST_CASE("eigensolver: one eigenvalue takes few solves, unless a larger space is given") {
  const MatHandle a = ring(300);
  const auto solves = [&a](double target) {
    SolverStatistics statistics;
    (void)Eigensolver(a, "one_", target, 1, statistics);
    return statistics.solves;
  };
  const int few = solves(-1e-8);
  CHECK(few <= 8);
  const Given given{{"-one_eps_ncv", "40"}};
  CHECK(solves(-1e-8) >= 40);
}

TEST_CASE("eigensolver: a real pair has no imaginary part") {
  const MatHandle a = matrix(6, [](PetscInt r) { return Row{{r, static_cast<double>(r + 1)}}; });
  SolverStatistics statistics;
  const Eigensolver solver(a, "test_", 0.5, 2, statistics);
  for (const auto& pair : solver.pairs()) {
    PetscReal size = 1;
    check(VecNorm(pair.imaginary, NORM_INFINITY, &size));
    CHECK(size == 0);
    CHECK(std::abs(pair.value.imag()) <= (kComplex ? 1e-12 : 0));
  }
}
