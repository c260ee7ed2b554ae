#include "stickslip/catalogue/large_deviation_keys.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "stickslip/operators/solver_policy.hpp"
#include "stickslip/operators/systems.hpp"
#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/eigensolver.hpp"
#include "stickslip/petsc/vectors.hpp"
#include "stickslip/quantities/plan.hpp"
#include "stickslip/quantities/relaxation.hpp"
#include "stickslip/quantities/uncertain.hpp"

namespace stickslip::quantities {
namespace {

using operators::KolmogorovOperator;
using operators::State;
using operators::StateKind;
using operators::StaticPhase;
using operators::Symmetry;
using petsc::check;
using petsc::dot;

// The largest eigenvalue, and how far below it the next one lies.
constexpr int kEigenvalues = 2;

/// theta(s) and theta'(s) at one s.
struct TiltedGrowth {
  Uncertain theta, velocity;
};

/// A pair of vectors that become the eigenvectors of L + s v with the largest eigenvalue.
struct Vectors {
  petsc::VecHandle right, left;
};

petsc::VecHandle velocities(const KolmogorovOperator& a) {
  return a.values([](double, double, double v) { return v; });
}

void make_unit(Vec x) {
  PetscReal size = 0;
  check(VecNormalize(x, &size));
}

// Exp(s x) weighs no state negatively: with z above theta all of (z - L - s v)^-1 is positive, and
// its largest eigenvalue, 1/(z - theta), is the one nearest to z. No speed exceeds the largest.
double above_theta(const operators::Systems& systems, double s) {
  const double tau = systems.process().noise.correlation_time();
  return std::abs(s) * systems.discretisation().velocities->v_max() + 0.1 / tau;
}

/// theta by SLEPc, to start with.
struct Found {
  double theta = 0, gap = 0;
  petsc::VecHandle right = {};  // none where there is no single one
};
Found find(operators::Systems& systems, double s) {
  const auto a = operators::assemble(systems.comm(), systems.discretisation(), {0.0, 0.0, s},
                                     Symmetry::none, StaticPhase::kept, systems.statistics());
  const petsc::Eigensolver solver(a.matrix(), kRelaxPrefix, -above_theta(systems, s), kEigenvalues,
                                  systems.statistics(),
                                  {[&a](PetscScalar at) { return a.shifted(-at); },
                                   operators::default_pc_type(systems.discretisation())});
  const auto& pairs = solver.pairs();
  const auto smaller = [](const petsc::Eigenpair& one, const petsc::Eigenpair& other) {
    return one.value.real() < other.value.real();
  };
  const auto first = std::min_element(pairs.begin(), pairs.end(), smaller);
  double gap = above_theta(systems, s) + first->value.real();
  for (auto next = pairs.begin(); next != pairs.end(); ++next) {
    if (next != first) gap = std::min(gap, next->value.real() - first->value.real());
  }
  // What coarse elements make of steep weights may be anything. With complex scalars what is real
  // comes with rounding and a phase of its own.
  constexpr double rounding = 1e-6;
  if (!(gap > 0) || std::abs(first->value.imag()) > rounding * gap) return {};
  auto right = petsc::copy_of(first->real);
  PetscScalar sum = 0;
  check(VecSum(right, &sum));
  if (sum != PetscScalar(0)) check(VecScale(right, PetscAbsScalar(sum) / sum));
  return {-first->value.real(), gap, std::move(right)};
}

// Share of the weighted paths that a truncation velocity holds back.
double held(const KolmogorovOperator& a, const Vectors& of) {
  double sum = 0;
  const petsc::ReadView right(of.right), left(of.left);
  PetscInt at = 0;
  a.states().for_each_local([&](const State& state) {
    if (state.kind == StateKind::holding) sum += PetscRealPart(left[at] * right[at]);
    ++at;
  });
  MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPI_DOUBLE, MPI_SUM, a.states().comm());
  return std::abs(sum / dot(of.left, of.right));
}

// By inverse iteration from both sides next to theta, each of which makes the vectors a hundred
// times more accurate; their product counts in theta. With w = (z - L - s v)^-1 r, 1/(z - theta) is
// (l, w)/(l, r). The last iterations, which change nothing but rounding, show the error.
TiltedGrowth growth(operators::Systems& systems, double s, bool truncated) {
  constexpr double nearer = 1e-2;
  constexpr int iterations = 7;
  auto [theta, gap, right] = find(systems, s);
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  if (right == nullptr) return {{none, none}, {none, none}};
  operators::SystemKey key{theta + nearer * gap, Symmetry::none, StaticPhase::kept};
  key.tilt = s;
  auto& system = systems.at(key);
  const auto& a = system.a();
  const petsc::VecHandle v = velocities(a), moving = a.zeros();
  Vectors of{std::move(right), a.values([](double, double, double) { return 1; })};
  TiltedGrowth now, before;
  for (int n = 0; n < iterations; ++n) {
    before = now;
    petsc::VecHandle next = std::move(system.factors().solve(of.right).x);
    now.theta.value = key.lambda - dot(of.left, of.right) / dot(of.left, next);
    of.right = std::move(next);
    make_unit(of.right);
    of.left = std::move(system.factors().solve_transposed(of.left).x);
    make_unit(of.left);
    check(VecPointwiseMult(moving, v, of.right));
    now.velocity.value = dot(of.left, moving) / dot(of.left, of.right);
  }
  const double cut = truncated ? held(a, of) * systems.discretisation().velocities->v_max() : 0;
  systems.release(key);
  now.theta.error = std::abs(now.theta.value - before.theta.value) + cut * std::abs(s);
  now.velocity.error = std::abs(now.velocity.value - before.velocity.value) + cut;
  return now;
}

void find_growth(Computation& computation) {
  const auto tilts = computation.question().values(catalogue::kTilt.option);
  const auto& scene = computation.problem.given.scene;
  std::map<double, TiltedGrowth> known;  // mirror images grow alike
  Result theta = array(catalogue::kTheta, tilts),
         velocity = array(catalogue::kTiltedVelocity, tilts),
         rate = array(catalogue::kRateFunction, tilts);
  for (double s : tilts) {
    const bool mirrored = computation.process().symmetric() && s < 0;
    const double tilt = mirrored ? -s : s;
    if (!known.contains(tilt)) known[tilt] = growth(computation.systems, tilt, !scene.limits_speed);
    TiltedGrowth g = known[tilt];
    if (mirrored) g.velocity.value = -g.velocity.value;
    append_value(theta, g.theta);
    append_value(velocity, g.velocity);
    append_value(rate, s * g.velocity - g.theta);
  }
  for (auto* result : {&theta, &velocity, &rate})
    computation.results().push_back(std::move(*result));
}

}  // namespace

void large_deviation_tasks(Planner& planner) {
  const auto& tilts = planner.question().values(catalogue::kTilt.option);
  planner.needs().rates.tilt = largest_size(tilts);
  const auto count = static_cast<int>(tilts.size());
  planner.add_adaptive("large deviations", 2 * count, 56 * count, find_growth);
}

}  // namespace stickslip::quantities
