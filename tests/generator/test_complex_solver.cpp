#include <cmath>
#include <complex>
#include <string>

#include "../common/catch.hpp"
#include "../common/options.hpp"
#include "../common/scenes.hpp"
#include "stickslip/generator/resolvents.hpp"
#include "stickslip/linalg/petsc.hpp"
#include "stickslip/linalg/vectors.hpp"

using namespace stickslip;
using generator::ComplexVector;
using linalg::check;

namespace {

void fill(Vec x, double a) {
  linalg::WriteView local(x);
  for (PetscInt n = 0; n < local.size(); ++n) local[n] = std::sin(a + 1.7 * n * n);
}

// A x, or A^T x.
linalg::VecHandle product(const generator::KolmogorovOperator& a, Vec x, bool transposed) {
  linalg::VecHandle y = a.zeros();
  check(transposed ? MatMultTranspose(a.matrix(), x, y) : MatMult(a.matrix(), x, y));
  return y;
}

}  // namespace

// Right without the step of refinement, too: what it corrects is rounding.
TEST_CASE("complex solver: both ways, by elements and in the real form") {
  auto s = test::scene(1, 0.5, 1, 0.25, {1, 0});
  s.bias = 0.2;
  const auto on = test::on_hp(s, 4);
  for (const char* type : {"elements", "lu"}) {
    const test::Given options{{"-slide_pc_type", type}};
    linalg::SolverStatistics statistics;
    const auto a = generator::assemble(PETSC_COMM_WORLD, on, 0, generator::Symmetry::none,
                                       generator::StaticPhase::kept, statistics);
    for (const std::complex<double> z : {std::complex<double>(0.3, 2), {0, 30}, {1, -0.7}}) {
      generator::ComplexSolver solver(a, z, statistics);
      for (bool transposed : {false, true}) {
        INFO(type << " " << z << (transposed ? " transposed" : ""));
        const ComplexVector b{a.zeros(), a.zeros()};
        fill(b.real, 0.2);
        fill(b.imaginary, 1.1);
        const auto [x, correction, change] =
            solver.solve({linalg::copy_of(b.real), linalg::copy_of(b.imaginary)}, transposed);
        const auto real = product(a, x.real, transposed),
                   imaginary = product(a, x.imaginary, transposed);
        check(VecAXPBYPCZ(real, z.real(), -z.imag(), 1, x.real, x.imaginary));
        check(VecAXPBYPCZ(imaginary, z.real(), z.imag(), 1, x.imaginary, x.real));
        check(VecAXPY(real, -1, b.real));
        check(VecAXPY(imaginary, -1, b.imaginary));
        PetscReal left = 0, more = 0, size = 0, corrected = 0;
        check(VecNorm(real, NORM_INFINITY, &left));
        check(VecNorm(imaginary, NORM_INFINITY, &more));
        check(VecNorm(x.real, NORM_2, &size));
        check(VecNorm(correction.real, NORM_2, &corrected));
        CHECK(std::max(left, more) < 1e-10);
        CHECK(corrected < 1e-9 * size);
        CHECK(change > 0);
        CHECK(change < 1e-9);
        const auto once = solver.solve_once(b, transposed);
        check(VecAXPBYPCZ(correction.real, 1, -1, 1, once.real, x.real));
        check(VecNorm(correction.real, NORM_2, &corrected));
        CHECK(corrected < 1e-15 * size);
      }
    }
  }
}
