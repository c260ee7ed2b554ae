#include <catch2/catch.hpp>
#include <vector>

#include "stickslip/petsc/jumps.hpp"

using namespace stickslip;
using petsc::Jumps;
using petsc::LevelJumps;

namespace {

using Scalars = std::vector<PetscScalar>;

// Levels -4, -3 | 3, 4 of one rank: those on both sides of the gap do not touch.
Jumps across_a_gap() {
  LevelJumps j;
  j.killing = 0.5;
  j.to_above = {1, 2, 3, 0};
  j.to_below = {0, 5, 6, 7};
  j.from_above = {11, 12, 13, 0};
  j.from_below = {0, 15, 16, 17};
  j.gap = 2;
  return {j, {{1, 2}}};  // two nodes, the first in row 1
}

Scalars added(const Jumps& jumps, bool transposed) {
  const Scalars x{9, 1, 10, 100, 1000, 2, 0, 0, 0, 9};
  Scalars y(x.size(), 0.0);
  jumps.add(x.data(), y.data(), transposed);
  return y;
}

}  // namespace

TEST_CASE("jumps: products by hand, with nothing across a gap and nothing outside") {
  // Diagonals 0.5 + 1, 7, 9, 7.
  CHECK(added(across_a_gap(), false) ==
        Scalars{0, 1.5 - 10, 75 - 5, 950 - 3000, 7500 - 700, 3, -10, 0, 0, 0});
  CHECK(added(across_a_gap(), true) ==
        Scalars{0, 1.5 - 110, 75 - 15, 950 - 13000, 7500 - 1700, 3, -30, 0, 0, 0});
}

TEST_CASE("jumps: sizes have every sign turned") {
  CHECK(added(across_a_gap().sizes(), false) ==
        Scalars{0, 1.5 + 10, 75 + 5, 950 + 3000, 7500 + 700, 3, 10, 0, 0, 0});
  CHECK(added(across_a_gap().sizes(), true) ==
        Scalars{0, 1.5 + 110, 75 + 15, 950 + 13000, 7500 + 1700, 3, 30, 0, 0, 0});
}

TEST_CASE("jumps: entries off the diagonal, two for each pair of neighbours") {
  CHECK(across_a_gap().entries() == 2 * 2 * 2);
  LevelJumps whole = across_a_gap().by_level();
  whole.gap = 0;
  CHECK(Jumps(whole, {{0, 2}, {8, 3}}).entries() == 2 * 3 * 5);
}
