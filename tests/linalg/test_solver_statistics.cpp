#include "../common/catch.hpp"
#include "stickslip/linalg/solver_statistics.hpp"

using namespace stickslip;
using linalg::SolverStatistics;

namespace {

SolverStatistics numbered(int first) {
  SolverStatistics l;
  for (auto* count : {&l.assemblies, &l.factorizations_real, &l.factorizations_complex, &l.solves,
                      &l.corrections, &l.iterations}) {
    *count = first++;
  }
  return l;
}

}  // namespace

TEST_CASE("solver statistics: work adds up") {
  SolverStatistics sum = numbered(1);
  sum += numbered(10);
  CHECK(sum.assemblies == 11);
  CHECK(sum.factorizations_real == 13);
  CHECK(sum.factorizations_complex == 15);
  CHECK(sum.solves == 17);
  CHECK(sum.corrections == 19);
  CHECK(sum.iterations == 21);
}

TEST_CASE("solver statistics: seconds add up, each for its phase") {
  SolverStatistics one, other;
  one.assembly_seconds = 1;
  one.analysis_seconds = 2;
  one.factorization_seconds = 4;
  one.solve_seconds = 8;
  other.assembly_seconds = 16;
  other.analysis_seconds = 32;
  other.factorization_seconds = 64;
  other.solve_seconds = 128;
  one += other;
  CHECK(one.assembly_seconds == 17);
  CHECK(one.analysis_seconds == 34);
  CHECK(one.factorization_seconds == 68);
  CHECK(one.solve_seconds == 136);
}

TEST_CASE(
    "solver statistics: of sizes and backward errors the largest counts, whichever came first") {
  SolverStatistics small, large;
  large.unknowns = 5;
  large.nonzeros = 6;
  large.factor_entries = 7;
  large.factor_megabytes = 8;
  large.backward_error = 9;
  small.unknowns = small.nonzeros = small.factor_entries = 1;
  small.factor_megabytes = small.backward_error = 1;
  for (const auto& [first, second] : {std::pair{small, large}, {large, small}}) {
    SolverStatistics sum = first;
    sum += second;
    CHECK(sum.unknowns == 5);
    CHECK(sum.nonzeros == 6);
    CHECK(sum.factor_entries == 7);
    CHECK(sum.factor_megabytes == 8);
    CHECK(sum.backward_error == 9);
  }
}
