#include <petscsys.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <memory>
#include <vector>

#include "../common/catch.hpp"
#include "../common/matrices.hpp"
#include "../common/options.hpp"
#include "stickslip/base/errors.hpp"
#include "stickslip/linalg/petsc.hpp"
#include "stickslip/linalg/session.hpp"
#include "stickslip/linalg/solver.hpp"
#include "stickslip/linalg/vectors.hpp"

using namespace stickslip;
using namespace stickslip::linalg;

namespace {

// Upper bidiagonal with 2 + r on the diagonal and -1 above: A x and A^T x are known by hand.
MatHandle bidiagonal(PetscInt n) {
  return test::matrix(n, [n](PetscInt r) {
    test::Row row{{r, 2 + static_cast<double>(r)}};
    if (r + 1 < n) row.emplace_back(r + 1, -1);
    return row;
  });
}

enum class Side { right, left };

// A 1 or A^T 1.
VecHandle image_of_one(Mat a, Side side) {
  VecHandle one, image;
  check(MatCreateVecs(a, one.out(), image.out()));
  check(VecSet(one, 1));
  check(side == Side::right ? MatMult(a, one, image) : MatMultTranspose(a, one, image));
  return image;
}

double kilobytes_in_use() {
  std::ifstream status("/proc/self/status");
  double value = 0;
  for (std::string name; status >> name;) {
    if (name == "VmSize:" && status >> value) break;
  }
  return value;
}

double resident_bytes() {
  PetscLogDouble bytes = 0;
  check(PetscMemoryGetCurrentUsage(&bytes));
  return bytes;
}

double distance_from_one(Vec x) {
  check(VecShift(x, -1));
  PetscReal norm = 0;
  check(VecNorm(x, NORM_INFINITY, &norm));
  return norm;
}

}  // namespace

TEST_CASE("factorization: forward and transposed solves, counted", "[parallel]") {
  const MatHandle a = bidiagonal(20);
  SolverStatistics statistics;
  Factorization factors(a, "test_", statistics);
  CHECK(distance_from_one(factors.solve(image_of_one(a, Side::right)).x) < 1e-14);
  const auto transposed = factors.solve_transposed(image_of_one(a, Side::left));
  CHECK(transposed.backward_error < 1e-15);
  CHECK(distance_from_one(transposed.x) < 1e-14);

  const bool complex = PetscDefined(USE_COMPLEX);
  CHECK(statistics.factorizations_real == (complex ? 0 : 1));
  CHECK(statistics.factorizations_complex == (complex ? 1 : 0));
  CHECK(statistics.solves == 2);
  CHECK(statistics.corrections == 2);
  CHECK(statistics.analysis_seconds > 0);  // as PETSc logs the analysis by MUMPS
  CHECK(statistics.factorization_seconds > 0);
  CHECK(statistics.factor_entries >= 2 * 20 - 1);  // those of the matrix; no more than a dense one
  CHECK(statistics.factor_entries <= 20 * 20);
}

TEST_CASE("factorization: a second step of refinement where one is not enough", "[parallel]") {
  const MatHandle a = bidiagonal(50);
  const VecHandle b = image_of_one(a, Side::right);
  const auto iterated_to = [](const char* tolerance) {
    return test::Given({{"-rough_ksp_type", "gmres"},
                        {"-rough_pc_type", "jacobi"},
                        {"-rough_ksp_rtol", tolerance}});
  };
  {
    const test::Given fair = iterated_to("1e-5");
    SolverStatistics statistics;
    Factorization solver(a, "rough_", statistics);
    const Solution s = solver.solve(b);
    CHECK(statistics.corrections == 2);
    CHECK(s.backward_error < 1e-12);
    CHECK(statistics.backward_error == s.backward_error);
    check(VecAXPY(s.x, -1, s.correction));  // what one solve alone gave
    CHECK(distance_from_one(s.x) > 1e-9);
  }
  const test::Given poor = iterated_to("1e-2");
  SolverStatistics statistics;
  Factorization solver(a, "rough_", statistics);
  CHECK_THROWS_WITH(solver.solve(b), Catch::Contains("-rough_ left a backward error"));
}

TEST_CASE("factorization: of several right-hand sides each is refined and measured by itself",
          "[parallel]") {
  const MatHandle a = bidiagonal(50);
  const test::Given fair(
      {{"-rough_ksp_type", "gmres"}, {"-rough_pc_type", "jacobi"}, {"-rough_ksp_rtol", "1e-5"}});
  SolverStatistics statistics;
  Factorization solver(a, "rough_", statistics);
  // One that takes two steps, nothing, and one that a single iteration solves.
  std::vector<VecHandle> b;
  for (int n = 0; n < 3; ++n) b.push_back(image_of_one(a, Side::left));
  check(VecSet(b[1], 0));
  check(VecSet(b[2], 0));
  check(VecSetValue(b[2], 49, 51, INSERT_VALUES));
  check(VecAssemblyBegin(b[2]));
  check(VecAssemblyEnd(b[2]));
  const auto all = solver.solve_transposed(b);
  CHECK(statistics.solves == 3);
  CHECK(statistics.corrections == 2 + 1 + 1);
  CHECK(distance_from_one(all[0].x) < 1e-11);
  PetscReal size = 1;
  check(VecNorm(all[1].x, NORM_INFINITY, &size));
  CHECK(size == 0);
  CHECK(all[1].backward_error == 0);
  check(VecNorm(all[2].x, NORM_1, &size));
  CHECK(size == Approx(1));
  CHECK(statistics.backward_error == std::max(all[0].backward_error, all[2].backward_error));
}

TEST_CASE("factorization: an iteration that stops early ends every kind of solve", "[parallel]") {
  const test::Given short_of({{"-short_ksp_type", "gmres"},
                              {"-short_pc_type", "jacobi"},
                              {"-short_ksp_rtol", "1e-14"},
                              {"-short_ksp_max_it", "3"}});
  const MatHandle a = bidiagonal(50);
  const VecHandle b = image_of_one(a, Side::right), x = image_of_one(a, Side::right);
  SolverStatistics statistics;
  Factorization solver(a, "short_", statistics);
  const auto stopped = Catch::Contains("-short_ stopped: DIVERGED_ITS");
  CHECK_THROWS_WITH(solver.solve(b), stopped);
  CHECK_THROWS_WITH(solver.solve_once(b, x), stopped);
  CHECK_THROWS_WITH(solver.solve_once(b, x, true), stopped);
}

TEST_CASE("factorization: a singular matrix is refused, whatever the package reports") {
  MatHandle a = bidiagonal(4);
  PetscInt begin = 0, end = 0;
  check(MatGetOwnershipRange(a, &begin, &end));
  // Rows that sum to zero: a generator, with the constants as null vectors.
  for (PetscInt r = begin; r < end; ++r) {
    check(MatSetValue(a, r, r, r + 1 < 4 ? 1 : 0, INSERT_VALUES));
  }
  check(MatAssemblyBegin(a, MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(a, MAT_FINAL_ASSEMBLY));
  VecHandle b;
  check(MatCreateVecs(a, b.out(), nullptr));
  check(VecSet(b, 1));
  SolverStatistics statistics;
  const auto solve = [&] { return Factorization(a, "test_", statistics).solve(b); };
  CHECK_THROWS_AS(solve(), NotReached);
}

namespace {

// [0 B; B^T 0] with B bidiagonal as above: without a search for large diagonals no pivot is where
// the analysis expects one.
MatHandle saddle(PetscInt half) {
  MatHandle a;
  check(MatCreate(PETSC_COMM_WORLD, a.out()));
  check(MatSetSizes(a, PETSC_DECIDE, PETSC_DECIDE, 2 * half, 2 * half));
  check(MatSetType(a, MATAIJ));
  check(MatSetUp(a));
  PetscInt begin = 0, end = 0;
  check(MatGetOwnershipRange(a, &begin, &end));
  for (PetscInt r = begin; r < end; ++r) {
    const bool upper = r < half;
    const PetscInt other = upper ? r + half : r - half, step = upper ? 1 : -1;
    const bool inside = upper ? r + 1 < half : r > half;
    check(MatSetValue(a, r, r, 0, INSERT_VALUES));
    check(MatSetValue(a, r, other, 3, INSERT_VALUES));
    if (inside) check(MatSetValue(a, r, other + step, -1, INSERT_VALUES));
  }
  check(MatAssemblyBegin(a, MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(a, MAT_FINAL_ASSEMBLY));
  return a;
}

test::Given tight_workspace() {
  return {{"-tight_mat_mumps_icntl_6", "0"},
          {"-tight_mat_mumps_icntl_8", "0"},
          {"-tight_mat_mumps_icntl_14", "-95"}};
}

std::string complaint(Mat a, const std::string& prefix) {
  SolverStatistics statistics;
  try {
    const Factorization factors(a, prefix, statistics);
  } catch (const Failure& failure) {
    return failure.what();
  }
  return "nothing";
}

}  // namespace

TEST_CASE("factorization: MUMPS gets more workspace once when it runs out of it", "[parallel]") {
  const test::Given tight = tight_workspace();
  const MatHandle a = saddle(400);
  SolverStatistics statistics;
  Factorization factors(a, "tight_", statistics);
  CHECK(distance_from_one(factors.solve(image_of_one(a, Side::right)).x) < 1e-12);
  CHECK(distance_from_one(factors.solve_transposed(image_of_one(a, Side::left)).x) < 1e-12);
}

TEST_CASE("factorization: a failure is reported with the meaning of MUMPS's code") {
  const test::Given little({{"-little_mat_mumps_icntl_23", "1"}});
  CHECK_THAT(complaint(saddle(40000), "little_"),
             Catch::Contains("INFOG(1) = -19") && Catch::Contains("ICNTL(23) is too small"));
  MatHandle zero = bidiagonal(4);
  check(MatZeroEntries(zero));
  CHECK_THAT(complaint(zero, "zero_"),
             Catch::Contains("INFOG(1) = -10") && Catch::Contains("singular"));
}

TEST_CASE("factorization: options of the role override its defaults") {
  check(PetscOptionsSetValue(nullptr, "-own_pc_factor_mat_solver_type", "petsc"));
  const MatHandle a = bidiagonal(6);
  SolverStatistics statistics;
  Factorization factors(a, "own_", statistics);
  CHECK(distance_from_one(factors.solve(image_of_one(a, Side::right)).x) < 1e-14);
  CHECK(statistics.factor_entries == 0);  // MUMPS's count; another package ran
  check(PetscOptionsClearValue(nullptr, "-own_pc_factor_mat_solver_type"));
}

namespace {

// What MUMPS is asked for (ICNTL(7)); left to itself it takes AMF too for small matrices.
PetscInt ordering_asked(Mat a, const std::string& prefix) {
  const KspHandle ksp = linear_solver(a, prefix, PCLU);
  const auto ordering = default_ordering(prefix);
  check(KSPSetUp(ksp));
  PC pc = nullptr;
  Mat factors = nullptr;
  PetscInt asked = -1;
  check(KSPGetPC(ksp, &pc));
  check(PCFactorGetMatrix(pc, &factors));
  check(MatMumpsGetIcntl(factors, 7, &asked));
  return asked;
}

}  // namespace

TEST_CASE("factorization: MUMPS orders by AMF unless options say otherwise", "[parallel]") {
  const MatHandle a = saddle(400);
  constexpr PetscInt amd = 0, amf = 2;
  CHECK(ordering_asked(a, "order_") == amf);
  CHECK(implied_pc_type("order_").empty());  // nothing stays behind
  const test::Given given({{"-order_mat_mumps_icntl_7", "0"}});
  CHECK(ordering_asked(a, "order_") == amd);
}

TEST_CASE("factorization: probing marks the options of a role as known") {
  check(PetscOptionsSetValue(nullptr, "-probe_mat_mumps_icntl_14", "30"));
  check(PetscOptionsSetValue(nullptr, "-probe_mat_mumps_icntl_99", "1"));
  probe_linear_solver("probe_");
  PetscBool used = PETSC_FALSE;
  check(PetscOptionsUsed(nullptr, "probe_mat_mumps_icntl_14", &used));
  CHECK(used == PETSC_TRUE);
  check(PetscOptionsUsed(nullptr, "probe_mat_mumps_icntl_99", &used));
  CHECK(used == PETSC_FALSE);
  check(PetscOptionsClearValue(nullptr, "-probe_mat_mumps_icntl_14"));
  check(PetscOptionsClearValue(nullptr, "-probe_mat_mumps_icntl_99"));
}

TEST_CASE("blas and memory: something is known about both", "[parallel]") {
  CHECK_FALSE(loaded_blas().library.empty());
  CHECK(available_bytes(PETSC_COMM_WORLD, 0) > 1e6);
  CHECK(peak_resident_bytes() > 1e6);
}

TEST_CASE("memory: all ranks have what each has", "[parallel]") {
  const double alone = available_bytes(PETSC_COMM_SELF, 0);
  const double together = available_bytes(PETSC_COMM_WORLD, 0);
  CHECK(together == Approx(linalg::ranks(PETSC_COMM_WORLD) * alone).epsilon(0.1));
}

TEST_CASE("memory: of a limited address space what is not in use is left") {
  rlimit before{};
  REQUIRE(getrlimit(RLIMIT_AS, &before) == 0);
  const double used = 1024 * kilobytes_in_use();
  rlimit limited = before;
  limited.rlim_cur = static_cast<rlim_t>(used + 3e9);
  REQUIRE(setrlimit(RLIMIT_AS, &limited) == 0);
  const double left = left_in_address_space();
  const double available = available_bytes(PETSC_COMM_SELF, 0);
  REQUIRE(setrlimit(RLIMIT_AS, &before) == 0);
  CHECK(std::abs(left - 3e9) < 2e6);
  CHECK(available <= left + 2e6);
}

// Slow ones do not run under sanitizers, whose allocator keeps what is freed.
TEST_CASE("memory that was freed can be had again", "[slow]") {
  // Small pieces below one that is kept: the C library cannot shrink its heap by itself.
  std::vector<std::unique_ptr<std::array<char, 1000>>> pieces(200'000);
  for (auto& piece : pieces) piece = std::make_unique<std::array<char, 1000>>();
  const auto kept = std::make_unique<std::array<char, 1000>>();
  pieces.clear();
  const double resident = resident_bytes();
  CHECK(available_bytes(PETSC_COMM_WORLD, std::numeric_limits<double>::infinity()) > 1e6);
  CHECK(resident_bytes() < resident - 1e8);
}
