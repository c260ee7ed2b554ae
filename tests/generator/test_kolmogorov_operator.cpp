#include <cmath>
#include <map>
#include <memory>
#include <numeric>

#include "../common/catch.hpp"
#include "../common/full_grid.hpp"
#include "../common/near.hpp"
#include "stickslip/generator/generator.hpp"
#include "stickslip/generator/static_chain.hpp"
#include "stickslip/generator/velocity_methods.hpp"
#include "stickslip/linalg/petsc.hpp"
#include "stickslip/linalg/vectors.hpp"
#include "stickslip/model/effect.hpp"

using namespace stickslip;
using generator::Branch;
using generator::KolmogorovOperator;
using generator::State;
using generator::StateKind;
using generator::StaticPhase;
using generator::Symmetry;
using linalg::check;

namespace {

model::Process process_on(int levels, double mu_s, double mu_d, model::Drag drag = {1, 0}) {
  return {{1, 0.25, levels}, {mu_s, mu_d}, drag};
}

// No parameter is a binary fraction: rates are rounded, and their sums.
model::Process rough_process(int levels) { return {{1.3, 0.17, levels}, {0.7, 0.31}, {1, 0.4}}; }

// A vector that is the same function of the global index on any number of ranks.
linalg::VecHandle test_vector(const KolmogorovOperator& a) {
  linalg::VecHandle x = a.zeros();
  linalg::WriteView local(x);
  for (PetscInt r = 0; r < a.states().local_size(); ++r) {
    local[r] = 1 + std::sin(static_cast<double>(a.states().local_begin() + r));
  }
  return x;
}

linalg::VecHandle row_sums(const KolmogorovOperator& a) {
  linalg::VecHandle sums = a.zeros();
  const auto one = a.values([](double, double, double) { return 1.0; });
  check(MatMult(a.matrix(), one, sums));
  return sums;
}

double largest(Vec x) {
  PetscReal norm = 0;
  check(VecNorm(x, NORM_INFINITY, &norm));
  return norm;
}

double largest_entry(Mat a) {
  PetscReal norm = 0;
  check(MatNorm(a, NORM_INFINITY, &norm));
  return norm;
}

using Row = std::vector<std::pair<PetscInt, double>>;  // columns, rising, and values

// Calls visit(row, entries) for the local rows.
template <class Visit>
void for_each_row(Mat a, Visit visit) {
  PetscInt begin = 0, end = 0;
  check(MatGetOwnershipRange(a, &begin, &end));
  for (PetscInt r = begin; r < end; ++r) {
    PetscInt count = 0;
    const PetscInt* columns = nullptr;
    const PetscScalar* values = nullptr;
    check(MatGetRow(a, r, &count, &columns, &values));
    Row entries;
    for (PetscInt n = 0; n < count; ++n) entries.emplace_back(columns[n], PetscRealPart(values[n]));
    check(MatRestoreRow(a, r, &count, &columns, &values));
    visit(r, entries);
  }
}

struct Named {
  std::string name;
  generator::Discretisation on;
};

// The last one with groups of noise levels, on which functions up to degree 3 are exact.
std::vector<Named> discretisations(const model::Process& process, double v_max) {
  const auto& drag = process.drag;
  const auto hp = std::make_shared<generator::HpDiscretisation>(
      std::vector<double>{0, 0.02, 0.1, 0.5, v_max}, 3, drag);
  const auto grid = std::make_shared<generator::UpwindDiscretisation>(0.05, 40, drag);
  const auto nodes = std::make_shared<generator::Nodes>(process, generator::Grouping{3, 50});
  return {{"hp", {process, hp}}, {"upwind", {process, grid}}, {"nodes", {process, hp, nodes}}};
}

}  // namespace

// The generator of the paper, built here from its definition on the (i, j) grid, entry by entry:
// the same states in another order, those at v = 0 beyond mu_s with the sign of their force as y.
TEST_CASE("kolmogorov operator: the upwind operator on both branches is -M of the paper") {
  const std::vector<model::Process> processes{process_on(6, 1, 0.1, {1, 0.4}),
                                              process_on(6, 0.1, 0.1, {1, 0.4}), rough_process(9)};
  for (const auto& process : processes) {
    const double spacing = 0.11;
    const int nodes = 5;
    const test::FullGrid grid(process, spacing, nodes);
    const auto velocities =
        std::make_shared<generator::UpwindDiscretisation>(spacing, nodes, process.drag);
    const KolmogorovOperator a(PETSC_COMM_SELF, {process, velocities}, 0.0, Symmetry::none,
                               StaticPhase::kept);
    const auto& m = grid.generator();
    REQUIRE(a.states().global_size() == grid.size());
    std::map<PetscInt, int> place;  // in the grid's numbering
    a.states().for_each_local([&](const State& s) {
      const int sign = s.branch == Branch::positive ? 1 : -1;
      const int j = s.kind == StateKind::node ? s.node + 1 : 0;
      place[a.states().index(s)] = grid.index(sign * s.noise, sign * j);
    });
    for (const auto& [row, grid_row] : place) {
      for (const auto& [column, grid_column] : place) {
        PetscScalar value = 0;
        check(MatGetValue(a.matrix(), row, column, &value));
        const double expected = -m(grid_row, grid_column);
        REQUIRE(test::relative_difference(PetscRealPart(value), expected) <= 1e-14);
      }
    }
  }
}

TEST_CASE("kolmogorov operator: constants are harmonic for the whole process", "[parallel]") {
  const double v_max = GENERATE(8.0, 1.0);  // the second truncates the velocity: holding states
  const auto process = process_on(11, 1, 0.25);
  for (const auto& d : discretisations(process, v_max)) {
    for (Symmetry symmetry : {Symmetry::even, Symmetry::none}) {
      const KolmogorovOperator a(PETSC_COMM_WORLD, d.on, 0.0, symmetry, StaticPhase::kept);
      INFO(d.name);
      CHECK(largest(row_sums(a)) < 1e-14 * largest_entry(a.matrix()));
    }
  }
}

// nu (A 1) = -nu A_us 1 + lambda nu 1: what leaves the sliding states enters the static ones.
TEST_CASE("kolmogorov operator: rows conserve probability up to killing", "[parallel]") {
  const double lambda = GENERATE(0.0, 1.5);
  const double v_max = GENERATE(8.0, 1.0);
  const auto process = process_on(11, 1, 0.25);
  for (const auto& d : discretisations(process, v_max)) {
    for (Symmetry symmetry : {Symmetry::even, Symmetry::none}) {
      INFO(d.name << " lambda " << lambda << " v_max " << v_max);
      const KolmogorovOperator a(PETSC_COMM_WORLD, d.on, lambda, symmetry, StaticPhase::killing);
      const auto nu = test_vector(a);
      PetscScalar left = 0, mass = 0, sent = 0;
      check(VecTDot(nu, row_sums(a), &left));
      check(VecSum(nu, &mass));
      const auto rates = a.entry_rates(nu);
      const PetscScalar entering = std::accumulate(rates.begin(), rates.end(), PetscScalar(0));
      CHECK(PetscRealPart(left) == Approx(PetscRealPart(entering + lambda * mass)).epsilon(1e-11));
      // The same coupling read the other way: nu (-A_us s) with s = 1.
      check(VecTDot(nu, a.from_static(std::vector<PetscScalar>(rates.size(), 1.0)), &sent));
      CHECK(PetscRealPart(sent) == Approx(PetscRealPart(entering)).epsilon(1e-12));
    }
  }
}

// Symmetry reduction is exact: an even (odd) function on both branches and its part on the positive
// one have the same image.
TEST_CASE(
    "kolmogorov operator: reduced by symmetry and not, it agrees on functions of that symmetry") {
  const auto process = process_on(11, 0.6, 0.25);
  const auto even = [](double x, double y, double v) { return 1 + x * v + std::cos(v) + y * x; };
  const auto odd = [](double x, double y, double v) { return x + v * v * v + y; };
  for (const auto& d : discretisations(process, 8)) {
    for (Symmetry symmetry : {Symmetry::even, Symmetry::odd}) {
      for (StaticPhase static_phase :
           {StaticPhase::killing, StaticPhase::kept, StaticPhase::killing_edges}) {
        const auto f = symmetry == Symmetry::even ? KolmogorovOperator::Observable(even)
                                                  : KolmogorovOperator::Observable(odd);
        const KolmogorovOperator reduced(PETSC_COMM_SELF, d.on, 0.3, symmetry, static_phase);
        const KolmogorovOperator whole(PETSC_COMM_SELF, d.on, 0.3, Symmetry::none, static_phase);
        linalg::VecHandle from_branch = reduced.zeros(), from_whole = whole.zeros();
        check(MatMult(reduced.matrix(), reduced.values(f), from_branch));
        check(MatMult(whole.matrix(), whole.values(f), from_whole));
        const linalg::ReadView of_branch(from_branch), of_whole(from_whole);
        const double scale = largest_entry(whole.matrix());
        PetscInt at = 0;
        reduced.states().for_each_local([&](const State& s) {
          const PetscInt there = whole.states().index(s);
          CHECK(std::abs(of_branch[at++] - of_whole[there]) < 1e-13 * scale);
        });
      }
    }
  }
}

// Off-diagonals summed from left to right and the diagonal added last leave nothing, not even the
// rounding of the rates.
TEST_CASE(
    "kolmogorov operator: on both branches and kept, upwind is minus a generator to the last bit",
    "[parallel]") {
  for (const auto& process : {process_on(9, 1, 0.25, {1, 0.4}), rough_process(53)}) {
    const auto velocities = std::make_shared<generator::UpwindDiscretisation>(
        process.noise.delta / 3, 40, process.drag);
    const KolmogorovOperator a(PETSC_COMM_WORLD, {process, velocities}, 0.0, Symmetry::none,
                               StaticPhase::kept);
    for_each_row(a.matrix(), [](PetscInt row, const Row& entries) {
      double off_diagonal = 0, diagonal = 0;
      for (const auto& [column, value] : entries) {
        if (column != row) REQUIRE(value <= 0);
        (column == row ? diagonal : off_diagonal) += value;
      }
      REQUIRE(off_diagonal + diagonal == 0.0);
      REQUIRE(entries.size() <= 5);
    });
  }
}

// Killed on exit, the static states see nothing of the sliding ones: their values are those of the
// static chain, F_lambda for the sum of both exits.
TEST_CASE("kolmogorov operator: exits of the static states carry their rates", "[parallel]") {
  const auto process = process_on(11, 1, 0.25);
  for (const auto& d : discretisations(process, 8)) {
    const KolmogorovOperator a(PETSC_COMM_WORLD, d.on, 0.7, Symmetry::none,
                               StaticPhase::killed_on_exit);
    // What is killed: row sums beyond lambda.
    const linalg::VecHandle one = a.values([](double, double, double) { return 1.0; });
    linalg::VecHandle rates = a.zeros();
    check(MatMult(a.matrix(), one, rates));
    check(VecAXPY(rates, -0.7, one));
    const auto transform = generator::StaticChain(process.noise, 4, 0.7).exit_transform();
    linalg::VecHandle u = a.zeros(), residual = a.zeros();
    {
      linalg::WriteView local(u);
      PetscInt at = 0;
      a.states().for_each_local([&](const State& s) {
        local[at++] = s.kind == StateKind::static_phase ? transform[s.noise + 4] : 0.0;
      });
    }
    check(MatMult(a.matrix(), u, residual));
    check(VecAXPY(residual, -1, rates));
    const linalg::ReadView local(residual);
    PetscInt at = 0;
    a.states().for_each_local([&](const State& s) {
      if (s.kind == StateKind::static_phase) CHECK(std::abs(local[at]) < 1e-11);
      ++at;
    });
  }
}

namespace {

// Linear in |v| on each branch, so that both schemes have its exact values.
double even_sample(double x, double y, double v) { return 1 + x * x + y * x + x * v + y * v; }
double odd_sample(double x, double y, double v) {
  return x + 2 * y + 3 * v + x * x * x + x * y * v;
}

double applied(Vec functional, Vec values) {
  PetscScalar sum = 0;
  check(VecTDot(functional, values, &sum));
  return PetscRealPart(sum);
}

linalg::VecHandle value_at(const KolmogorovOperator& a, int i, double v) {
  const auto& noise = a.discretisation().process.noise;
  return a.mean_at(model::levels_at(noise, {.level = i, .v = v}), v);
}

// f at (x_i, v) by the definition of the process.
double at_state(const model::Process& process, const KolmogorovOperator::Observable& f, int i,
                double v) {
  const bool rest = v == 0 && std::abs(i) <= process.highest_static();
  const double y = v > 0 || (v == 0 && i > 0) ? 1 : -1;
  return f(process.noise.level(i), rest ? 0 : y, v);
}

struct Symmetric {
  Symmetry symmetry;
  KolmogorovOperator::Observable f;
};

std::vector<Symmetric> symmetric_samples() {
  return {{Symmetry::even, even_sample},
          {Symmetry::odd, odd_sample},
          {Symmetry::none, [](double x, double y, double v) {
             return even_sample(x, y, v) + odd_sample(x, y, v);
           }}};
}

}  // namespace

// Every level at rest, at s+ and s- and beyond, and at velocities of both signs; symmetry-reduced,
// from the branch that is kept, with the sign of the symmetry.
TEST_CASE("kolmogorov operator: values at single states", "[parallel]") {
  const auto process = process_on(11, 1, 0.25);
  for (const auto& d : discretisations(process, 2)) {
    for (const auto& [symmetry, f] : symmetric_samples()) {
      const KolmogorovOperator a(PETSC_COMM_WORLD, d.on, 0.0, symmetry, StaticPhase::kept);
      const auto values = a.values(f);
      for (int i = -11; i <= 11; ++i) {
        for (double v : {0.0, 0.05, 0.333, 2.0, -0.05, -0.1234, -2.0}) {
          INFO(d.name << " level " << i << " v " << v << " symmetry-reduced "
                      << a.states().symmetry_reduced());
          const double expected = at_state(process, f, i, v);
          CHECK(applied(value_at(a, i, v), values) == Approx(expected).margin(1e-11));
        }
      }
    }
  }
}

TEST_CASE("kolmogorov operator: values at s+ and s- are the traces at the exits", "[parallel]") {
  const auto process = process_on(11, 1, 0.25);
  const auto distance = [](const linalg::VecHandle& one, const linalg::VecHandle& other,
                           double sign) {
    check(VecAXPY(one, -sign, other));
    return largest(one);
  };
  for (const auto& d : discretisations(process, 2)) {
    for (Symmetry symmetry : {Symmetry::even, Symmetry::odd, Symmetry::none}) {
      const KolmogorovOperator a(PETSC_COMM_WORLD, d.on, 0.0, symmetry, StaticPhase::kept);
      const bool symmetry_reduced = a.states().symmetry_reduced();
      const double sign = symmetry == Symmetry::odd ? -1 : 1;
      const auto lower = a.trace_at_exit(symmetry_reduced ? Branch::positive : Branch::negative);
      CHECK(distance(value_at(a, 5, 0), a.trace_at_exit(), 1) == 0);
      CHECK(distance(value_at(a, -5, 0), lower, sign) == 0);
    }
  }
}

TEST_CASE("kolmogorov operator: with a bias rows of the whole process sum to 0", "[parallel]") {
  auto process = rough_process(19);
  for (double bias : {0.23, -0.4}) {
    process.bias = bias;
    for (const auto& d : discretisations(process, 1.4)) {
      const KolmogorovOperator a(PETSC_COMM_WORLD, d.on, 0, Symmetry::none, StaticPhase::kept);
      CHECK(largest(row_sums(a)) < 1e-14 * largest_entry(a.matrix()));
    }
  }
}

// dA by a difference of A on the same velocity discretisation: A is linear in mu_d and c, and
// smooth in tau.
TEST_CASE("kolmogorov operator: derivatives are limits of differences", "[parallel]") {
  const auto process = rough_process(9);
  struct Step {
    std::string_view parameter;
    model::Process above, below;
    double width;
  };
  const auto changed = [&](double mu_d, double tau, double c) {
    auto p = process;
    p.friction.mu_d += mu_d;
    p.noise.tau += tau;
    p.drag.linear += c;
    return p;
  };
  const double h = 1e-4;
  const std::vector<Step> steps{{"mu_d", changed(h, 0, 0), changed(-h, 0, 0), 2 * h},
                                {"tau", changed(0, h, 0), changed(0, -h, 0), 2 * h},
                                {"drag_coefficient", changed(0, 0, h), changed(0, 0, -h), 2 * h}};
  const auto on = [](const model::Process& p, bool hp) {
    std::shared_ptr<generator::VelocityDiscretisation> velocities;
    if (hp) {
      velocities = std::make_shared<generator::HpDiscretisation>(std::vector{0.0, 0.1, 0.5, 1.43},
                                                                 5, p.drag);
    } else {
      velocities = std::make_shared<generator::UpwindDiscretisation>(0.053, 25, p.drag);
    }
    return generator::Discretisation(p, velocities);
  };
  const auto parameters = effects::derivatives_of({});
  REQUIRE(parameters.size() == steps.size());
  for (std::size_t place = 0; place < steps.size(); ++place) {
    const Step& step = steps[place];
    REQUIRE(parameters[place].option == step.parameter);
    for (bool hp : {true, false}) {
      const KolmogorovOperator derivative(PETSC_COMM_WORLD, on(process, hp), {}, Symmetry::even,
                                          StaticPhase::killing, parameters[place]);
      const auto at = [&](const model::Process& p) {
        return KolmogorovOperator(PETSC_COMM_WORLD, on(p, hp), 0, Symmetry::even,
                                  StaticPhase::killing);
      };
      const auto upper = at(step.above), lower = at(step.below);
      const auto x = test_vector(derivative);
      const auto image = derivative.zeros(), up = derivative.zeros(), down = derivative.zeros();
      check(MatMult(derivative.matrix(), x, image));
      check(MatMult(upper.matrix(), x, up));
      check(MatMult(lower.matrix(), x, down));
      check(VecAXPY(up, -1, down));
      check(VecAXPY(image, -1 / step.width, up));
      CHECK(largest(image) < 1e-5 * largest(up) / step.width);
      const auto rates = derivative.entry_rates(x), above_rates = upper.entry_rates(x),
                 below_rates = lower.entry_rates(x);
      for (std::size_t n = 0; n < rates.size(); ++n) {
        const auto difference = (above_rates[n] - below_rates[n]) / step.width;
        CHECK(std::abs(rates[n] - difference) < 1e-6 * (1 + std::abs(difference)));
      }
    }
  }
}
