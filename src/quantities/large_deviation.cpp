#include "stickslip/catalogue/large_deviation_keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "stickslip/operators/systems.hpp"
#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/vectors.hpp"
#include "stickslip/quantities/plan.hpp"
#include "stickslip/quantities/uncertain.hpp"
#include "stickslip/support/errors.hpp"

namespace stickslip::quantities {
namespace {

using operators::KolmogorovOperator;
using operators::State;
using operators::StateKind;
using operators::StaticPhase;
using operators::Symmetry;
using petsc::check;
using petsc::dot;

/// theta(s) and theta'(s) at one s.
struct TiltedGrowth {
  Uncertain theta, velocity;
};

/// A pair of vectors that become the eigenvectors of L + s v with the largest eigenvalue.
struct Vectors {
  petsc::VecHandle right, left;
};

Vectors copies_of(const Vectors& of) { return {petsc::copy_of(of.right), petsc::copy_of(of.left)}; }

petsc::VecHandle velocities(const KolmogorovOperator& a) {
  return a.values([](double, double, double v) { return v; });
}

void make_unit(Vec x) {
  PetscReal size = 0;
  check(VecNormalize(x, &size));
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

// Powers of (z - L - s v)^-1 from both sides. The vectors range over more orders of magnitude than
// numbers have digits, which leads Krylov spaces astray, as they see lengths. Here the vectors are
// seen through their product alone, the probability of states on weighted paths.
class Powers {
 public:
  Powers(operators::Systems& systems, double s, double z) : systems_(systems) {
    key_.symmetry = Symmetry::none;
    key_.static_phase = StaticPhase::kept;
    move(s, z);
    const auto alike = [](double, double, double) { return 1; };
    vectors_ = {a().values(alike), a().values(alike)};
  }
  Powers(const Powers&) = delete;
  Powers& operator=(const Powers&) = delete;
  ~Powers() { systems_.release(key_); }

  void move(double s, double z) {
    systems_.release(key_);
    key_.tilt = s;
    key_.lambda = z;
  }
  void restart(const Vectors& from) { vectors_ = copies_of(from); }

  // With iterative refinement or without.
  void step(bool refined) {
    auto& factors = systems_.at(key_).factors();
    Vectors next{a().zeros(), a().zeros()};
    if (refined) {
      next.right = std::move(factors.solve(vectors_.right).x);
      next.left = std::move(factors.solve_transposed(vectors_.left).x);
    } else {
      factors.solve_once(vectors_.right, next.right);
      factors.solve_transposed_once(vectors_.left, next.left);
    }
    const double mean = dot(vectors_.left, next.right) / dot(vectors_.left, vectors_.right),
                 before = std::exchange(off_, 0);
    compare(vectors_.left, vectors_.right, next.right, mean);
    compare(vectors_.right, vectors_.left, next.left, mean);
    fall_ = off_ / before;
    theta_ = key_.lambda - 1 / mean;
    vectors_ = std::move(next);
    make_unit(vectors_.right);
    make_unit(vectors_.left);
  }

  // Whether the vectors become the positive eigenvectors, by a percent.
  bool converges(int most) {
    constexpr double near = 1e-2;
    for (int n = 0; n < most; ++n) {
      step(false);
      if (positive_ && off_ < near) return true;
    }
    return false;
  }

  // As far as rounding lets them.
  void finish() {
    constexpr int most = 60;
    constexpr double still = 0.5;
    for (int n = 0; n < most && (n < 3 || fall_ < still); ++n) step(false);
    for (int n = 0; n < 3; ++n) step(true);
  }

  [[nodiscard]] double velocity() {
    const petsc::VecHandle moving = product(velocities(a()), vectors_.right);
    return dot(vectors_.left, moving) / dot(vectors_.left, vectors_.right);
  }
  [[nodiscard]] double theta() const { return theta_; }
  // Distance from theta to the next eigenvalue, by how fast its eigenvectors vanish.
  [[nodiscard]] double gap() const {
    return std::abs(key_.lambda - theta_) * (1 / std::clamp(fall_, 1e-3, 0.99) - 1);
  }
  [[nodiscard]] const KolmogorovOperator& a() { return systems_.at(key_).a(); }
  [[nodiscard]] const Vectors& vectors() const { return vectors_; }

 private:
  // How far w, what becomes of r, is from m r: the mean of |w/r - m|/m. By Perron and Frobenius the
  // eigenvectors of theta alone have no negative entries, but for those that elements leave.
  void compare(Vec weight, Vec before, Vec after, double mean) {
    double sums[] = {0, 0, 0, 0};
    {
      const petsc::ReadView l(weight), r(before), w(after);
      for (PetscInt n = 0; n < l.size(); ++n) {
        const double was = mean * PetscRealPart(l[n] * r[n]), is = PetscRealPart(l[n] * w[n]);
        sums[0] += is;
        sums[1] += std::abs(is);
        sums[2] += std::abs(is - was);
        sums[3] += std::abs(was);
      }
    }
    MPI_Allreduce(MPI_IN_PLACE, sums, 4, MPI_DOUBLE, MPI_SUM, systems_.comm());
    constexpr double least = 0.3;
    positive_ = std::abs(sums[0]) > least * sums[1];
    off_ = std::max(off_, sums[2] / sums[3]);
  }

  operators::Systems& systems_;
  operators::SystemKey key_;
  Vectors vectors_;
  double theta_ = 0, off_ = 1, fall_ = 1;
  bool positive_ = false;
};

// From s = 0, where theta = 0, in steps that change the vectors little. Theta is smooth, so that it
// rises by the mean of theta' at both ends, but for a part of what that changes; another eigenvalue
// does not lie there. Returns where it ended, if not at the goal.
std::optional<double> approach(Powers& powers, double goal, double tau) {
  constexpr double part = 0.2;
  const double small = 1e-3 / tau;
  constexpr int first = 12, steps = 3, shifts = 3, most = 32;
  double s = 0, step = goal;
  powers.move(s, 1e-3 * small);
  if (!powers.converges(first)) return 0;
  Vectors at_s = copies_of(powers.vectors());
  double theta = 0, velocity = powers.velocity();
  for (int tried = 0; s != goal; ++tried) {
    if (tried == most) return s;
    const double next = std::abs(goal - s) < 1.5 * std::abs(step) ? goal : s + step,
                 width = next - s;
    powers.move(next, theta + width * velocity + small);
    bool found = false;
    for (int n = 0; n < shifts && !found; ++n) {
      if (powers.converges(steps)) {
        const double now = powers.velocity(),
                     misfit = powers.theta() - theta - width * (velocity + now) / 2;
        found = std::abs(misfit) < part * std::abs(width * (now - velocity)) + small;
      }
      if (!found) powers.move(next, powers.theta());
    }
    step *= found ? 1.4 : 0.5;
    if (found) {
      s = next;
      theta = powers.theta();
      velocity = powers.velocity();
      at_s = copies_of(powers.vectors());
    } else {
      powers.restart(at_s);
    }
  }
  return {};
}

// Next to theta each step makes the vectors a hundred times more accurate. The last one, which
// changes nothing but rounding, shows the error. `recipe` holds z and z - theta of the refinement
// level before. Nothing for weights that are not resolved, which finer levels then do not try.
std::optional<TiltedGrowth> growth(operators::Systems& systems, double s, bool truncated,
                                   Recipe& recipe) {
  constexpr double nearer = 1e-2;
  constexpr int steps = 40;
  const double tau = systems.process().noise.correlation_time();
  auto& known = recipe.steps;
  if (!recipe.unreached.empty()) return {};
  Powers powers(systems, s, known.empty() ? 1 / tau : known[0].z.real());
  const auto next_to_theta = [&] {  // and to no other one
    constexpr double share = 0.3;
    if (known.empty() || !powers.converges(steps)) return false;
    const double gap = (known[1].z / nearer).real();
    return std::abs(powers.theta() - known[0].z.real()) < share * gap;
  };
  if (!next_to_theta()) {
    if (const auto reached = approach(powers, s, tau)) {
      recipe.unreached = fmt::format(
          "is not resolved, as so steep a weight makes E[exp(s x(t))] that of a few fast bodies; "
          "|s| up to {:.2g} was reached: take such -tilt, or a larger -delta",
          std::abs(*reached));
      return {};
    }
    const double away = nearer * powers.gap();
    known = {{powers.theta() + away}, {away}};
    powers.move(s, powers.theta() + away);
  }
  powers.finish();
  const double theta = powers.theta(), velocity = powers.velocity();
  powers.step(true);
  known[0].z = powers.theta() + known[1].z;
  const double v_max = systems.discretisation().velocities->v_max(),
               cut = truncated ? held(powers.a(), powers.vectors()) * v_max : 0;
  const auto with_error = [](double now, double before, double more) {
    return Uncertain{now, std::abs(now - before) + more};
  };
  return TiltedGrowth{with_error(powers.theta(), theta, cut * std::abs(s)),
                      with_error(powers.velocity(), velocity, cut)};
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
    auto& recipe = computation.tolerance().recipe(fmt::format("tilt {}", tilt));
    if (!known.contains(tilt)) {
      known[tilt] = growth(computation.systems, tilt, !scene.limits_speed, recipe)
                        .value_or(TiltedGrowth{kNoValue, kNoValue});
    }
    for (auto* result : {&theta, &velocity, &rate}) {
      if (!recipe.unreached.empty()) result->unreached = recipe.unreached;
    }
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
  planner.add_adaptive("large deviations", 2 * count, 40 * count, find_growth);
}

}  // namespace stickslip::quantities
