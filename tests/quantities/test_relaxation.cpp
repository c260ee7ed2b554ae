#include <petscsys.h>

#include <algorithm>
#include <cmath>

#include "../common/catch.hpp"
#include "../common/scenes.hpp"
#include "stickslip/generator/resolvents.hpp"
#include "stickslip/linalg/petsc.hpp"
#include "stickslip/quantities/relaxation.hpp"

using namespace stickslip;
using generator::Symmetry;
using generator::Systems;
using quantities::PhaseField;
using quantities::RelaxationMode;
using test::scene;

namespace {

struct Case {
  test::Discrete discrete;
  Symmetry symmetry;
};

std::vector<RelaxationMode> solve(const Case& c) {
  linalg::SolverStatistics statistics;
  Systems systems(PETSC_COMM_WORLD, c.discrete, statistics);
  return quantities::relaxation_modes(systems, c.symmetry).modes;
}

std::vector<Case> sample_cases() {
  std::vector<Case> cases;
  for (const auto& s : {scene(1, 0.25, 1, 0.5, {1, 0}), scene(1, 1, 2, 0.5, {1, 0.4}),
                        scene(0.3, 0.3, 0.5, 0.5, {0.2, 0})}) {
    for (Symmetry symmetry : {Symmetry::even, Symmetry::odd}) {
      cases.push_back({test::on_hp(test::on_full_noise(s), 5), symmetry});
      cases.push_back({test::on_upwind(test::on_full_noise(s), 4), symmetry});
    }
  }
  return cases;
}

const RelaxationMode& with_rate(const std::vector<RelaxationMode>& modes, double rate) {
  return *std::min_element(modes.begin(), modes.end(), [rate](const auto& a, const auto& b) {
    return std::abs(a.rate - rate) < std::abs(b.rate - rate);
  });
}

// Calls visit(level, column, value) for the local values of a field.
template <class Visit>
void for_each_value(const PhaseField& field, Visit visit) {
  const std::size_t columns = field.v().size();
  const auto levels = field.local_levels();
  const auto rows = field.local_rows();
  for (std::size_t r = 0; r < levels.size(); ++r) {
    for (std::size_t j = 0; j < columns; ++j) {
      visit(static_cast<int>(levels[r]) - static_cast<int>(field.x().size() / 2), j,
            rows[r * columns + j]);
    }
  }
}

double over_ranks(double local, MPI_Op operation) {
  double all = 0;
  MPI_Allreduce(&local, &all, 1, MPI_DOUBLE, operation, PETSC_COMM_WORLD);
  return all;
}

// Largest distance of the mode, sliding and at rest, from factor f(x).
template <class Function>
double distance(const RelaxationMode& mode, const model::NoiseChain& noise, double factor,
                Function f) {
  double largest = 0;
  for_each_value(mode.real, [&](int level, std::size_t, double value) {
    largest = std::max(largest, std::abs(value - factor * f(noise.level(level))));
  });
  const int k = static_cast<int>(mode.at_rest.size() / 2);
  for (int i = -k; i <= k; ++i) {
    largest = std::max(largest, std::abs(mode.at_rest[k + i] - factor * f(noise.level(i))));
  }
  return over_ranks(largest, MPI_MAX);
}

// Whether the mode is proportional to f(x), with modulus 1 at the ends of the noise.
template <class Function>
bool is_function_of_noise(const RelaxationMode& mode, const model::NoiseChain& noise, Function f) {
  const double factor = 1 / f(noise.level(noise.levels));
  return std::min(distance(mode, noise, factor, f), distance(mode, noise, -factor, f)) < 1e-8;
}

// Row by row, first against last: levels come in pairs +-i, columns in pairs +-v.
bool has_parity(const PhaseField& field, double sign) {
  const auto& rows = field.local_rows();
  return std::equal(rows.begin(), rows.end(), rows.rbegin(),
                    [sign](double a, double b) { return a == sign * b; });
}

// Sliding or at rest; states at v = 0 beyond mu_s are not shown.
double largest_modulus(const RelaxationMode& mode) {
  const auto& imaginary = mode.imaginary.local_rows();
  std::size_t at = 0;
  double largest = 0;
  for_each_value(mode.real, [&](int, std::size_t, double value) {
    largest = std::max(largest, std::hypot(value, imaginary[at++]));
  });
  for (const auto& value : mode.at_rest) largest = std::max(largest, std::abs(value));
  return over_ranks(largest, MPI_MAX);
}

}  // namespace

// L x = -x/tau and L (x^2 - 1/tau) = -2/tau (x^2 - 1/tau) on the whole noise range, whatever the
// body does: the noise does not see it.
TEST_CASE("relaxation: the noise relaxes at its own rates", "[parallel]") {
  for (double tau : {1.0, 2.0}) {
    const auto s = test::on_full_noise(scene(1, 0.25, tau, 0.5, {1, 0}));
    for (const auto& d : {test::on_hp(s, 5), test::on_upwind(s, 4)}) {
      const auto odd = solve({d, Symmetry::odd}), even = solve({d, Symmetry::even});
      const auto& first = with_rate(odd, 1 / tau);
      const auto& second = with_rate(even, 2 / tau);
      const auto square = [tau](double x) { return x * x - 1 / tau; };
      CHECK(std::abs(first.rate - 1 / tau) < 1e-8);
      CHECK(std::abs(second.rate - 2 / tau) < 1e-8);
      CHECK(is_function_of_noise(first, d.process.noise, [](double x) { return x; }));
      CHECK(is_function_of_noise(second, d.process.noise, square));
    }
  }
}

TEST_CASE("relaxation: slowest modes first, of one parity and largest modulus 1", "[parallel]") {
  for (const auto& c : sample_cases()) {
    const auto modes = solve(c);
    CHECK(modes.size() == 4);
    const double sign = c.symmetry == Symmetry::even ? 1 : -1;
    double before = 0.1;  // the constant is no mode
    for (const auto& mode : modes) {
      CHECK(mode.rate.real() >= before);
      CHECK(mode.rate.imag() > -1e-8);  // one of each conjugate pair
      CHECK(mode.residual < 1e-9);
      CHECK(has_parity(mode.real, sign));
      CHECK(has_parity(mode.imaginary, sign));
      CHECK(std::equal(mode.at_rest.begin(), mode.at_rest.end(), mode.at_rest.rbegin(),
                       [sign](const auto& a, const auto& b) { return a == sign * b; }));
      CHECK(largest_modulus(mode) == Approx(1).epsilon(1e-5));
      before = mode.rate.real();
    }
  }
}

TEST_CASE("relaxation: half as many modes as the eigensolver is asked for") {
  const auto s = test::on_full_noise(scene(1, 0.25, 1, 0.5, {1, 0}));
  linalg::check(PetscOptionsSetValue(nullptr, "-relax_eps_nev", "5"));
  const auto modes = solve({test::on_hp(s, 4), Symmetry::even});
  linalg::check(PetscOptionsClearValue(nullptr, "-relax_eps_nev"));
  CHECK(modes.size() == 2);

  quantities::Results results;
  quantities::append_relaxation({Symmetry::even, modes}, results);
  REQUIRE(results.size() == 2);
  CHECK(results[0].key == "relaxation_even");
  CHECK(results[1].key == "relaxation_even_frequency");
  for (std::size_t n = 0; n < modes.size(); ++n) {
    CHECK(results[0].abscissa[n] == static_cast<double>(n + 1));
    CHECK(results[0].value[n] == modes[n].rate.real());
    CHECK(results[0].error[n] == modes[n].residual);
    CHECK(results[1].value[n] == 0);  // both decay without oscillation
  }
}

// Here 4/tau, a rate of the noise, is a defective double eigenvalue of the even functions. Rounding
// splits it, into conjugates or into two real ones as it happens.
TEST_CASE("relaxation: a defective double rate has no frequency, and an error that shows it") {
  const auto s = test::on_full_noise(scene(1, 1, 2, 0.5, {1, 0.4}));
  for (int degree = 6; degree <= 12; ++degree) {
    const auto modes = solve({test::on_hp(s, degree), Symmetry::even});
    quantities::Results results;
    quantities::append_relaxation({Symmetry::even, modes}, results);
    INFO("degree " << degree);
    REQUIRE(modes.size() == 4);
    for (std::size_t n = 2; n < 4; ++n) {
      const double distance = std::abs(results[0].value[n] - 2);
      CHECK(modes[n].rate.imag() == 0);
      CHECK(distance < 1e-5);
      CHECK(results[0].error[n] > distance);
      CHECK(results[0].error[n] > 1e-9);  // whatever the residual is
      CHECK(results[0].error[n] < 1e-4);
      CHECK(results[1].value[n] == 0);
      CHECK(results[1].error[n] == 0);
      for_each_value(modes[n].imaginary, [](int, std::size_t, double v) { CHECK(v == 0); });
    }
    CHECK(results[0].error[0] < 1e-9);  // the others keep theirs
    CHECK(results[0].error[1] < 1e-9);
  }
}

TEST_CASE("relaxation: of conjugate rates the one that turns forwards") {
  const auto s = test::on_full_noise(scene(1, 1, 1, 0.5, {1, 0}));
  const auto modes = solve({test::on_hp(s, 7), Symmetry::even});
  REQUIRE(modes.size() == 4);
  CHECK(modes[2].rate.real() == Approx(3.37309160).epsilon(1e-8));
  CHECK(modes[2].rate.imag() == Approx(0.70907858).epsilon(1e-7));
  CHECK(modes[2].spread == 0);
  CHECK(modes[3].rate.imag() == 0);
  quantities::Results results;
  quantities::append_relaxation({Symmetry::even, modes}, results);
  CHECK(modes[2].residual > 0);
  for (const auto& found : results) CHECK(found.error[2] == modes[2].residual);
  CHECK(results[1].error[3] == 0);  // no frequency, and no error of one
}
