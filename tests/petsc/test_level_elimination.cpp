#include <catch2/catch.hpp>
#include <numeric>
#include <random>
#include <stdexcept>
#include <vector>

#include "../common/options.hpp"
#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/factorization.hpp"
#include "stickslip/petsc/level_elimination.hpp"
#include "stickslip/petsc/session.hpp"
#include "stickslip/petsc/vectors.hpp"
#include "stickslip/support/errors.hpp"

using namespace stickslip;
using namespace stickslip::petsc;

namespace {

struct Example {
  MatHandle matrix;
  Chain chain;
};

// Blocks of size(s) rows, dealt out to the ranks in order and numbered backwards within each.
// row(s, p, set) calls set(t, q, value) for the entries of row p of block s in column q of block t;
// what lies outside is left out.
template <class Size, class Row>
Example chain_of(int blocks, Size size, Row row) {
  const int ranks = petsc::ranks(PETSC_COMM_WORLD), rank = petsc::rank(PETSC_COMM_WORLD);
  const auto owner = [=](int s) { return s * ranks / blocks; };
  std::vector<PetscInt> begin(static_cast<std::size_t>(blocks) + 1, 0);  // of each block
  for (int s = 0; s < blocks; ++s) begin[s + 1] = begin[s] + size(s);
  Example result;
  PetscInt local = 0, first = begin[blocks];
  for (int s = 0; s < blocks; ++s) {
    if (owner(s) != rank) continue;
    first = std::min(first, begin[s]);
    for (int p = 0; p < size(s); ++p) result.chain.rows.push_back(begin[s + 1] - 1 - p - first);
    result.chain.start.push_back(static_cast<int>(result.chain.rows.size()));
    local += size(s);
  }
  check(MatCreate(PETSC_COMM_WORLD, result.matrix.out()));
  check(MatSetSizes(result.matrix, local, local, PETSC_DETERMINE, PETSC_DETERMINE));
  check(MatSetType(result.matrix, MATAIJ));
  check(MatSetUp(result.matrix));
  check(MatSetOption(result.matrix, MAT_NEW_NONZERO_ALLOCATION_ERR, PETSC_FALSE));
  const auto row_of = [&](int s, int p) { return begin[s + 1] - 1 - p; };
  for (int s = 0; s < blocks; ++s) {
    if (owner(s) != rank) continue;
    for (int p = 0; p < size(s); ++p) {
      row(s, p, [&](int t, int q, double value) {
        if (t < 0 || t >= blocks || q >= size(t)) return;
        check(MatSetValue(result.matrix, row_of(s, p), row_of(t, q), value, INSERT_VALUES));
      });
    }
  }
  check(MatAssemblyBegin(result.matrix, MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(result.matrix, MAT_FINAL_ASSEMBLY));
  return result;
}

// Blocks of 3 to 6 rows, which lead to later ones of their block, and to those of the same number
// in the neighbours.
Example example(int blocks) {
  const auto size = [](int s) { return 3 + s % 4; };
  return chain_of(blocks, size, [&](int s, int p, const auto& set) {
    set(s, p, 4 + 0.1 * s);
    for (int q = p + 1; q < size(s); ++q) set(s, q, -1.0 / (1 + q));
    if (s % 3 == 0 && p > 0) set(s, p - 1, -0.5);  // no triangle
    set(s + 1, p, -0.7 - 0.1 * p);
    set(s - 1, p, -0.9);
    if (p == 0) set(s + 1, 2, -0.3);  // a second entry in the same coupling
  });
}

// Three blocks of 30 rows that lead to themselves; with `later`, to all later ones of their block.
// Rows lead to those of the same number in the neighbours; the last row of a block leads on to row
// `returns` of the block before.
Example wide(bool later, int returns) {
  return chain_of(
      3, [](int) { return 30; },
      [=](int s, int p, const auto& set) {
        set(s, p, 6 + 0.1 * p);
        for (int q = p + 1; q < 30 && later; ++q) set(s, q, -1.0 / (20 + q));
        set(s + 1, p, -0.7);
        set(s - 1, p == 29 ? returns : p, -0.9);
      });
}

// Largest error of plain and transposed solves with known solutions.
double error_of_solves(const Example& e) {
  LevelElimination levels(e.matrix, e.chain);
  levels.factor();
  VecHandle x, b, found;
  check(MatCreateVecs(e.matrix, x.out(), b.out()));
  check(VecDuplicate(x, found.out()));
  check(VecSetRandom(x, nullptr));
  double largest = 0;
  for (bool transposed : {false, true}) {
    check(transposed ? MatMultTranspose(e.matrix, x, b) : MatMult(e.matrix, x, b));
    levels.apply(b, found, transposed);
    check(VecAXPY(found, -1, x));
    PetscReal norm = 0;
    check(VecNorm(found, NORM_INFINITY, &norm));
    largest = std::max(largest, norm);
  }
  return largest;
}

Structure structure(const Chain& chain, bool narrow = true) {
  return {[&chain] { return chain; }, narrow};
}

double distance(Vec a, Vec b) {
  check(VecAXPY(a, -1, b));
  PetscReal norm = 0;
  check(VecNorm(a, NORM_INFINITY, &norm));
  return norm;
}

}  // namespace

TEST_CASE("level elimination: plain and transposed solves", "[parallel]") {
  for (int blocks : {1, 2, 7, 20}) {
    INFO(blocks << " blocks");
    CHECK(error_of_solves(example(blocks)) < 1e-13);
  }
}

TEST_CASE("level elimination: new values of the same pattern", "[parallel]") {
  const Example e = example(9);
  Ledger ledger;
  Factorization factors(e.matrix, "test_", ledger, structure(e.chain));
  VecHandle x, b;
  check(MatCreateVecs(e.matrix, x.out(), b.out()));
  check(VecSet(x, 1));
  check(MatMult(e.matrix, x, b));
  (void)factors.solve(b);
  // Backward errors are those of the new entries: with the old ones they would be far too small.
  check(MatScale(e.matrix, 1e-8));
  check(VecSetRandom(x, nullptr));
  factors.update();
  check(MatMult(e.matrix, x, b));
  const Solution s = factors.solve(b);
  CHECK(s.backward_error < 1e-15);
  CHECK(s.backward_error > 1e-20);
  CHECK(distance(s.x, x) < 1e-13);
}

// 30 rows are cut into 18 and 12: blocks of a triangle have 12 rows at least.
TEST_CASE("level elimination: of triangles no zeros are kept below the blocks", "[parallel]") {
  constexpr double full = 30 * 30, triangle = 18 * 30 + 12 * 12, diagonal = 18 * 18 + 12 * 12;
  const auto entries = [](bool later, int returns) {
    const Example e = wide(later, returns);
    CHECK(error_of_solves(e) < 1e-13);
    return LevelElimination(e.matrix, e.chain).entries();
  };
  CHECK(entries(false, 29) == 3 * diagonal);
  CHECK(entries(true, 29) == 3 * triangle);
  // Rows 18 and on come back to row 18, which is no way across the cut, or to row 17, which is one.
  // The last block has no rows after it to come back from.
  CHECK(entries(false, 18) == 3 * diagonal);
  CHECK(entries(true, 18) == 3 * triangle);
  CHECK(entries(true, 17) == 2 * full + triangle);
  CHECK(entries(true, 0) == 2 * full + triangle);
}

// Two blocks, of which one leads from its first part to the second by way of the other.
TEST_CASE("level elimination: rows reach as far as ways through other blocks", "[parallel]") {
  const auto entries = [](int from, int to) {
    const Example e = chain_of(
        2, [](int) { return 30; },
        [=](int s, int p, const auto& set) {
          set(s, p, 4);
          if (s == 0 && p == from) set(1, 3, -1);
          if (s == 1 && p == 3) set(0, to, -1);
        });
    CHECK(error_of_solves(e) < 1e-13);
    return LevelElimination(e.matrix, e.chain).entries();
  };
  constexpr double triangle = 18 * 30 + 12 * 12, diagonal = 18 * 18 + 12 * 12;
  CHECK(entries(2, 17) == 2 * diagonal);
  CHECK(entries(2, 18) == triangle + diagonal);
  // The cut moves with the rows; no block of less than 12 rows is made.
  CHECK(entries(18, 17) == 17 * 17 + 13 * 13 + diagonal);
  CHECK(entries(18, 5) == 30 * 30 + diagonal);
}

TEST_CASE("level elimination: its cost is that of its dense blocks", "[parallel]") {
  const int ranks = petsc::ranks(PETSC_COMM_WORLD);
  const Example e = chain_of(
      3, [](int) { return 10; }, [](int s, int p, const auto& set) { set(s, p, 1); });
  const LevelElimination levels(e.matrix, e.chain);
  CHECK(levels.entries() == 300);
  CHECK(levels.operations() == 3 * 2 * 1000);
  // Three dense blocks of each rank in work besides.
  CHECK(levels.bytes() == sizeof(PetscScalar) * (300 + ranks * 3 * 100));
}

TEST_CASE("level elimination: is the choice for narrow chains unless options name another",
          "[parallel]") {
  const Example e = example(6);
  const auto entries = [&e](const char* prefix, bool narrow) {
    Ledger ledger;
    const Factorization factors(e.matrix, prefix, ledger, structure(e.chain, narrow));
    return ledger.factor_entries;
  };
  const auto levels = static_cast<std::int64_t>(LevelElimination(e.matrix, e.chain).entries());
  CHECK(entries("plain_", true) == levels);
  CHECK(entries("plain_", false) != levels);
  const test::Given given({{"-chosen_pc_type", "lu"}, {"-wide_pc_type", "levels"}});
  CHECK(entries("chosen_", true) != levels);
  CHECK(entries("wide_", false) == levels);
}

TEST_CASE("level elimination: a singular block ends all ranks alike", "[parallel]") {
  Example e = example(9);
  PetscInt begin = 0, end = 0;
  check(MatGetOwnershipRange(e.matrix, &begin, &end));
  // Of the last rank alone, the first row in its order.
  const bool last = petsc::rank(PETSC_COMM_WORLD) == petsc::ranks(PETSC_COMM_WORLD) - 1;
  const PetscInt row = begin + e.chain.rows.front();
  check(MatZeroRows(e.matrix, last ? 1 : 0, &row, 0, nullptr, nullptr));
  LevelElimination levels(e.matrix, e.chain);
  CHECK_THROWS_AS(levels.factor(), NotReached);
}

TEST_CASE("level elimination: is refused without a chain") {
  const test::Given given({{"-none_pc_type", "levels"}});
  const Example e = example(3);
  Ledger ledger;
  CHECK_THROWS_AS(Factorization(e.matrix, "none_", ledger), BadInput);
}

TEST_CASE("level elimination: rows that couple further than to the next block are told") {
  Example e = example(4);
  e.chain.start = {0, 3, 7, 8, static_cast<int>(e.chain.rows.size())};
  std::swap(e.chain.rows.front(), e.chain.rows.back());
  CHECK_THROWS_AS(LevelElimination(e.matrix, e.chain).factor(), std::logic_error);
}
