#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "../common/systems.hpp"
#include "stickslip/operators/kolmogorov_operator.hpp"
#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/split_matrix.hpp"
#include "stickslip/petsc/vectors.hpp"

using namespace stickslip;
using operators::Form;
using operators::KolmogorovOperator;
using operators::Rest;
using operators::Symmetry;
using petsc::check;

namespace {

std::vector<test::System> systems() {
  auto all = test::killed_systems();
  all.push_back({all[0].scene, Symmetry::odd, Rest::kept});
  all.push_back({all[3].scene, Symmetry::none, Rest::kept});
  all.push_back({all[4].scene, Symmetry::none, Rest::kept});
  return all;
}

struct Forms {
  KolmogorovOperator whole, split;
};

Forms forms(const test::System& s, int degree) {
  const auto d = test::on_hp(s.scene, degree);
  const auto made = [&](Form form) {
    return KolmogorovOperator(PETSC_COMM_WORLD, d.process, *d.axis, 0.3, s.symmetry, s.rest, form);
  };
  return {made(Form::assembled), made(Form::by_elements)};
}

petsc::VecHandle some_vector(const KolmogorovOperator& a) {
  return a.values([](double x, double y, double v) {
    return std::cos(3 * x) + std::sin(x + 40 * v) * std::exp(-v) + 0.2 * y;
  });
}

petsc::VecHandle image(Mat matrix, Vec x, bool transposed) {
  petsc::VecHandle y;
  check(VecDuplicate(x, y.out()));
  check(transposed ? MatMultTranspose(matrix, x, y) : MatMult(matrix, x, y));
  return y;
}

// Largest |a - b| / |scale| of all components.
double distance(Vec a, Vec b, Vec scale) {
  petsc::VecHandle difference;
  PetscReal largest = 0;
  check(VecDuplicate(a, difference.out()));
  check(VecWAXPY(difference, -1, a, b));
  check(VecPointwiseDivide(difference, difference, scale));
  check(VecNorm(difference, NORM_INFINITY, &largest));
  return largest;
}

}  // namespace

TEST_CASE("split matrix: products are those of the assembled matrix", "[parallel]") {
  for (const test::System& s : systems()) {
    for (int degree : {0, 1, 6}) {
      const Forms f = forms(s, degree);
      INFO("mu_d " << s.scene.friction.mu_d << ", delta " << s.scene.delta << ", degree "
                   << degree);
      const auto x = some_vector(f.whole);
      const auto size = petsc::magnitudes(f.whole.matrix());
      petsc::VecHandle x_size = f.whole.zeros();
      check(VecCopy(x, x_size));
      check(VecAbs(x_size));
      for (bool transposed : {false, true}) {
        const auto expected = image(f.whole.matrix(), x, transposed);
        const auto found = image(f.split.matrix(), x, transposed);
        CHECK(distance(found, expected, image(size, x_size, transposed)) < 1e-14);
      }
      CHECK(f.split.nonzeros() == f.whole.nonzeros());
    }
  }
}

TEST_CASE("split matrix: magnitudes are a bound, and not much larger", "[parallel]") {
  for (const test::System& s : systems()) {
    const Forms f = forms(s, 5);
    petsc::VecHandle x = some_vector(f.whole);
    check(VecAbs(x));
    const auto compare = [](Vec bound, Vec sharp) {
      const petsc::ReadView larger(bound), smaller(sharp);
      double least = 1, most = 1;  // bound over sharp
      for (PetscInt n = 0; n < smaller.size(); ++n) {
        const double ratio = PetscRealPart(larger[n]) / PetscRealPart(smaller[n]);
        least = std::min(least, ratio);
        most = std::max(most, ratio);
      }
      CHECK(least > 1 - 1e-12);
      CHECK(most < 10);
    };
    const auto whole = petsc::magnitudes(f.whole.matrix());
    const auto split = petsc::magnitudes(f.split.matrix());
    for (bool transposed : {false, true}) {
      compare(image(split, x, transposed), image(whole, x, transposed));
    }
    compare(petsc::magnitude_sums(f.split.matrix()), petsc::magnitude_sums(f.whole.matrix()));
  }
}

TEST_CASE("split matrix: only such ones are taken for one") {
  const Forms f = forms(systems()[0], 2);
  CHECK(petsc::SplitMatrix::of(f.whole.matrix()) == nullptr);
  CHECK(petsc::SplitMatrix::of(f.split.matrix()) != nullptr);
}
