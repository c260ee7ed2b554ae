#include <cmath>

#include "../common/catch.hpp"
#include "../common/matrices.hpp"
#include "../common/options.hpp"
#include "stickslip/algebra/dense.hpp"
#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/time_stepper.hpp"
#include "stickslip/support/errors.hpp"

using namespace stickslip;
using namespace stickslip::petsc;
using test::Given;
using Matrix = algebra::Matrix<double>;

namespace {

constexpr int kSize = 8;

// Rates from 0.1 to 1e4, fast ones fed by slow ones and the slowest by the fastest; b of the middle
// turns, so that some eigenvalues are complex.
Matrix stiff() {
  Matrix a(kSize, kSize);
  for (int r = 0; r < kSize; ++r) {
    const double rate = 0.1 * std::pow(10.0, 5.0 * static_cast<double>(r) / (kSize - 1));
    a(r, r) = rate;
    if (r > 0) a(r, r - 1) = -0.7 * rate;
  }
  a(2, 3) = 3;
  a(0, kSize - 1) = -0.01;
  return a;
}

MatHandle distributed(const Matrix& m) {
  const PetscInt n = m.rows();
  return test::matrix(n, [&m, n](PetscInt r) {
    test::Row row;
    for (PetscInt c = 0; c < n; ++c) {
      if (m(r, c) != 0 || r == c) row.emplace_back(c, m(r, c));
    }
    return row;
  });
}

double start(PetscInt r) { return 1 + 0.5 * std::sin(2.0 * static_cast<double>(r)); }

VecHandle start_on(Mat a) {
  VecHandle u;
  check(MatCreateVecs(a, u.out(), nullptr));
  PetscInt begin = 0, end = 0;
  check(VecGetOwnershipRange(u, &begin, &end));
  for (PetscInt r = begin; r < end; ++r) check(VecSetValue(u, r, start(r), INSERT_VALUES));
  check(VecAssemblyBegin(u));
  check(VecAssemblyEnd(u));
  return u;
}

std::vector<double> exact(const Matrix& m, double time) {
  std::vector<double> u;
  for (PetscInt r = 0; r < kSize; ++r) u.push_back(start(r));
  return algebra::exponential(m, -time) * u;
}

// max |u - expected|, the same on all ranks.
double distance(Vec u, const std::vector<double>& expected) {
  VecHandle difference;
  check(VecDuplicate(u, difference.out()));
  check(VecCopy(u, difference));
  PetscInt begin = 0, end = 0;
  check(VecGetOwnershipRange(u, &begin, &end));
  for (PetscInt r = begin; r < end; ++r) {
    check(VecSetValue(difference, r, -expected[r], ADD_VALUES));
  }
  check(VecAssemblyBegin(difference));
  check(VecAssemblyEnd(difference));
  PetscReal largest = 0;
  check(VecNorm(difference, NORM_INFINITY, &largest));
  return largest;
}

/// A run of a stepper on the stiff matrix.
struct Run {
  explicit Run(const std::string& prefix, double tolerance)
      : a(distributed(stiff())), u(start_on(a)), stepper(a, u, prefix, tolerance, statistics) {}

  double error_at(double time) {
    stepper.advance(time);
    return distance(u, exact(stiff(), time));
  }

  MatHandle a;
  VecHandle u;
  SolverStatistics statistics;
  TimeStepper stepper;
};

}  // namespace

TEST_CASE("time stepper: the exponential to the tolerance, from step to step", "[parallel]") {
  for (double tolerance : {1e-5, 1e-7, 1e-9}) {
    Run run("test_", tolerance);
    for (double time : {1e-9, 1e-5, 3e-3, 0.2, 0.2 + 1e-10, 1.0, 7.0, 40.0}) {
      INFO("tolerance " << tolerance << " time " << time);
      CHECK(run.error_at(time) < 100 * tolerance);
    }
  }
}

TEST_CASE("time stepper: errors fall with the tolerance, at the cost of steps") {
  double before = 1;
  int steps = 0;
  for (double tolerance : {1e-4, 1e-6, 1e-8, 1e-10}) {
    Run run("test_", tolerance);
    const double error = run.error_at(2);
    CHECK(error < 0.5 * before);
    CHECK(run.stepper.steps() > steps);
    before = error;
    steps = run.stepper.steps();
  }
  CHECK(before < 1e-8);
}

TEST_CASE("time stepper: the present time again is no step", "[parallel]") {
  Run run("test_", 1e-6);
  CHECK(run.error_at(0) == 0);
  CHECK(run.stepper.steps() == 0);
  run.stepper.advance(0.5);
  const int steps = run.stepper.steps();
  run.stepper.advance(0.5);
  CHECK(run.stepper.steps() == steps);
}

TEST_CASE("time stepper: constants of a generator stay constant", "[parallel]") {
  Matrix ring(kSize, kSize);
  for (int r = 0; r < kSize; ++r) {
    const double rate = std::pow(10.0, static_cast<double>(r) - 3);
    ring(r, r) = rate;
    ring(r, (r + 1) % kSize) = -rate;
  }
  const MatHandle a = distributed(ring);
  const VecHandle u = start_on(a);
  check(VecSet(u, 1));
  SolverStatistics statistics;
  TimeStepper stepper(a, u, "test_", 1e-6, statistics);
  stepper.advance(100);
  CHECK(distance(u, std::vector<double>(kSize, 1.0)) < 1e-12);
}

// Each step of ARKIMEX5, fully implicit, has eight stages, each of one linear system.
TEST_CASE("time stepper: linear systems are counted in the solver statistics", "[parallel]") {
  Run run("test_", 1e-6);
  run.stepper.advance(1);
  CHECK(run.statistics.iterations >= run.stepper.steps());
  CHECK(run.statistics.iterations <= 10 * run.stepper.steps());
}

// Backward Euler with fixed steps is known in closed form: (1 + h A)^-n u.
TEST_CASE("time stepper: options of the role override method, steps and solver", "[parallel]") {
  const Given given{{"-own_ts_type", "beuler"},
                    {"-own_ts_adapt_type", "none"},
                    {"-own_ts_dt", "0.125"},
                    {"-own_ksp_type", "gmres"},
                    {"-own_ksp_rtol", "1e-13"}};
  Run run("own_", 1e-6);
  run.stepper.advance(0.5);
  CHECK(run.stepper.steps() == 4);
  // (1 + h A)^4 takes the result back to the start.
  VecHandle back, next;
  check(VecDuplicate(run.u, next.out()));
  check(VecDuplicate(run.u, back.out()));
  check(VecCopy(run.u, back));
  for (int n = 0; n < 4; ++n) {
    check(MatMult(run.a, back, next));
    check(VecAXPY(back, 0.125, next));
  }
  CHECK(distance(back, exact(stiff(), 0)) < 1e-4);  // (1 + h A)^4 is as large as 1e12
}

TEST_CASE("time stepper: other methods give the same") {
  for (const char* type : {"rosw", "bdf"}) {
    const Given given{{"-own_ts_type", type}};
    Run run("own_", 1e-7);
    INFO(type);
    CHECK(run.error_at(0.2) < 1e-4);
    CHECK(run.error_at(3) < 1e-4);
    CHECK(run.error_at(3) > 1e-13);
  }
}

TEST_CASE("time stepper: too few steps are refused, and the role is named") {
  const Given given{{"-few_ts_max_steps", "3"}};
  Run run("few_", 1e-6);
  try {
    run.stepper.advance(1);
    FAIL("took " << run.stepper.steps() << " steps, error " << run.error_at(1));
  } catch (const NotReached& failure) {
    CHECK_THAT(failure.what(), Catch::Contains("few_"));
  }
}

TEST_CASE("time stepper: linear systems that are not solved end the run") {
  const Given given{{"-no_ts_dt", "1"},
                    {"-no_ts_max_reject", "2"},
                    {"-no_ksp_type", "gmres"},
                    {"-no_ksp_max_it", "1"},
                    {"-no_pc_type", "none"}};
  Run run("no_", 1e-9);
  CHECK_THROWS_AS(run.stepper.advance(100), NotReached);
}

TEST_CASE("time stepper: probing marks the options of a role as known") {
  const std::vector<std::string> known{"ts_type", "ts_max_steps", "ts_adapt_type", "ksp_type",
                                       "mat_mumps_icntl_14"};
  const std::vector<std::string> unknown{"ts_max_step", "ts_rtoll", "mat_mumps_icntl_99"};
  const Given given{{"-probe_ts_type", "rosw"},          {"-probe_ts_max_steps", "7"},
                    {"-probe_ts_adapt_type", "basic"},   {"-probe_ksp_type", "preonly"},
                    {"-probe_mat_mumps_icntl_14", "30"}, {"-probe_ts_max_step", "7"},
                    {"-probe_ts_rtoll", "1e-9"},         {"-probe_mat_mumps_icntl_99", "1"}};
  probe_time_stepper("probe_");
  const auto used = [](const std::string& name) {
    PetscBool is_used = PETSC_FALSE;
    check(PetscOptionsUsed(nullptr, ("probe_" + name).c_str(), &is_used));
    return is_used == PETSC_TRUE;
  };
  for (const auto& name : known) {
    INFO(name);
    CHECK(used(name));
  }
  for (const auto& name : unknown) CHECK_FALSE(used(name));
}
