#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "stickslip/base/text.hpp"
#include "stickslip/case/displacement_rows.hpp"
#include "stickslip/generator/resolvents.hpp"
#include "stickslip/linalg/petsc.hpp"
#include "stickslip/linalg/vectors.hpp"
#include "stickslip/quantities/plan.hpp"

namespace stickslip::quantities {
namespace {

using generator::KolmogorovOperator;
using generator::State;
using generator::StateKind;
using generator::StaticPhase;
using generator::Symmetry;
using linalg::check;
using linalg::dot;

/// theta(s) and theta'(s) at one s.
struct TiltedGrowth {
  Uncertain theta, velocity;
};

/// A pair of vectors that become the eigenvectors of L + s v with the largest eigenvalue.
struct Vectors {
  linalg::VecHandle right, left;
};

linalg::VecHandle velocities(const KolmogorovOperator& a) {
  return a.values([](double, double, double v) { return v; });
}

// Whether bodies come to move upwards, however seldom.
bool starts(const model::Process& process) {
  return process.noise.highest() > process.highest_static();
}

void make_unit(Vec x) {
  PetscReal size = 0;
  check(VecNormalize(x, &size));
}

// Share of the weighted paths that a truncation velocity holds back.
double held(const KolmogorovOperator& a, const Vectors& of) {
  double sum = 0;
  const linalg::ReadView right(of.right), left(of.left);
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
  Powers(generator::Systems& systems, double s, double z) : systems_(systems) {
    key_.symmetry = Symmetry::none;
    key_.static_phase = StaticPhase::kept;
    key_.tilt = s;
    key_.lambda = z;
    key_.highest = bound_of(systems.process());
    key_.lowest = -bound_of(systems.process().mirrored());
    reached_ = a().values([up = key_.highest, down = key_.lowest](double, double y, double v) {
      return y == 0 || (y > 0 ? v < up : v > down) ? 1 : 0;
    });
    restart();
  }
  Powers(const Powers&) = delete;
  Powers& operator=(const Powers&) = delete;
  ~Powers() { systems_.release(key_); }

  void move(double z) {
    if (z == key_.lambda) return;
    systems_.release(key_);
    key_.lambda = z;
  }
  void restart() { vectors_ = {linalg::copy_of(reached_), linalg::copy_of(reached_)}; }

  // Whether z is above theta, and moves there. It is if and only if (z - L - s v) u = 1 has a
  // positive solution on all states: with the left eigenvector l of theta, which is positive, (z -
  // theta) (l, u) = (l, 1).
  bool is_above(double z) {
    move(z);
    linalg::VecHandle u = a().zeros();
    systems_.at(key_).factors().solve_once(reached_, u);
    return positive(u);
  }

  // With iterative refinement or without.
  void step(bool refined) {
    auto& factors = systems_.at(key_).factors();
    Vectors next{a().zeros(), a().zeros()};
    if (refined) {
      next.right = std::move(factors.solve(vectors_.right).x);
      next.left = std::move(factors.solve_transposed(vectors_.left).x);
    } else {
      factors.solve_once(vectors_.right, next.right);
      factors.solve_once(vectors_.left, next.left, true);
    }
    leave_unreached_out(next.right);
    leave_unreached_out(next.left);
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

  // Whether the vectors become eigenvectors, by a percent.
  bool converges(int most) {
    constexpr double near = 1e-2;
    for (int n = 0; n < most; ++n) {
      step(false);
      if (off_ < near) return true;
    }
    return false;
  }

  // Whether a part of the vectors falls so slowly that they only seem to converge: they begin alike
  // in both directions, and what is not so comes to light behind all that falls fast. What rounding
  // leaves does not fall steadily.
  bool hides_a_slow_part() {
    constexpr int steps = 4;
    constexpr double rounding = 1e-10, slow = 0.2, steady = 0.2;
    for (int n = 0; n < steps; ++n) step(false);
    const double before = fall_;
    step(false);
    return off_ > rounding && fall_ > slow && fall_ < 1 &&
           std::abs(fall_ - before) < steady * (1 - fall_);
  }

  // As far as rounding lets them.
  void finish() {
    constexpr int most = 60;
    constexpr double still = 0.5;
    for (int n = 0; n < most && (n < 3 || fall_ < still); ++n) step(false);
    for (int n = 0; n < 3; ++n) step(true);
  }

  [[nodiscard]] double velocity() {
    const linalg::VecHandle moving = product(velocities(a()), vectors_.right);
    return dot(vectors_.left, moving) / dot(vectors_.left, vectors_.right);
  }
  [[nodiscard]] double theta() const { return theta_; }
  // All changes to come, over the last one.
  [[nodiscard]] double left() const { return 1 / (1 - std::min(fall_, 0.99)); }
  // Distance from theta to the next eigenvalue, by how fast its eigenvectors vanish.
  [[nodiscard]] double gap() const {
    return std::abs(key_.lambda - theta_) * (1 / std::clamp(fall_, 1e-3, 0.99) - 1);
  }
  [[nodiscard]] const KolmogorovOperator& a() { return systems_.at(key_).a(); }
  [[nodiscard]] const Vectors& vectors() const { return vectors_; }

 private:
  // The speed that no body on the positive velocity branch goes beyond, which is an end of
  // elements: whatever would grow on branches where none starts, or at speeds that only those of
  // the other branch have, is never seen.
  [[nodiscard]] double bound_of(const model::Process& process) const {
    constexpr double rounding = 1e-9;
    if (!starts(process)) return 0;
    const auto ends = systems_.discretisation().velocities->cells();
    const auto end =
        std::lower_bound(ends.begin(), ends.end(), (1 - rounding) * process.terminal_velocity());
    return end == ends.end() ? kInfinity : *end;
  }
  void leave_unreached_out(Vec u) {
    const linalg::ReadView reached(reached_);
    linalg::WriteView values(u);
    for (PetscInt n = 0; n < values.size(); ++n) {
      if (PetscRealPart(reached[n]) == 0) values[n] = 0;
    }
  }

  // How far w, what becomes of r, is from m r: the mean of |w/r - m|/m.
  void compare(Vec weight, Vec before, Vec after, double mean) {
    double sums[] = {0, 0};
    {
      const linalg::ReadView l(weight), r(before), w(after);
      for (PetscInt n = 0; n < l.size(); ++n) {
        const double was = mean * PetscRealPart(l[n] * r[n]), is = PetscRealPart(l[n] * w[n]);
        sums[0] += std::abs(is - was);
        sums[1] += std::abs(was);
      }
    }
    linalg::sum_over_ranks(systems_.comm(), sums);
    off_ = std::max(off_, sums[0] / sums[1]);
  }

  // On all states that bodies reach, but for the ripples of polynomials on elements.
  bool positive(Vec u) {
    constexpr double ripple = 1e-2;
    const auto nodes = systems_.discretisation().velocities->nodes(),
               ends = systems_.discretisation().velocities->cells();
    std::map<std::tuple<generator::Branch, int, std::ptrdiff_t>, std::pair<double, double>>
        extremes;
    int negative = 0;
    {
      const linalg::ReadView values(u), reached(reached_);
      PetscInt at = 0;
      a().states().for_each_local([&](const State& state) {
        const double value = PetscRealPart(values[at]);
        if (PetscRealPart(reached[at++]) == 0) return;
        if (state.kind != StateKind::node) {
          negative += !(value > 0);
          return;
        }
        const auto end = std::upper_bound(ends.begin(), ends.end(), nodes[state.node]);
        auto& [least, most] = extremes[{state.branch, state.noise, end - ends.begin()}];
        least = std::min(least, value);
        most = std::max(most, value);
      });
    }
    for (const auto& [cell, of] : extremes)
      negative += !(of.second > 0 && -of.first < ripple * of.second);
    MPI_Allreduce(MPI_IN_PLACE, &negative, 1, MPI_INT, MPI_SUM, systems_.comm());
    return negative == 0;
  }

  generator::Systems& systems_;
  generator::SystemKey key_;
  linalg::VecHandle reached_;  // 1 on the states that bodies reach, 0 on others
  Vectors vectors_;
  double theta_ = 0, off_ = 1, fall_ = 1;
};

// Theta is no less than the growth on one level alone, of bodies that rest there or slide as fast
// as it drives them, until the noise jumps.
double least_growth(const model::Process& process, double s, double v_max) {
  double least = -HUGE_VAL;
  const auto on_branch = [&](const model::Process& branch, double tilt) {
    const auto& noise = branch.noise;
    for (int i = noise.lowest(); i <= noise.highest(); ++i) {
      const double force = branch.net_force(i), leaving = noise.rate(i);
      if (branch.sticks(i)) least = std::max(least, -leaving);
      if (!starts(branch) || force <= 0) continue;
      least =
          std::max(least, tilt * std::min(branch.drag.terminal_velocity(force), v_max) - leaving);
    }
  };
  on_branch(process, s);
  on_branch(process.mirrored(), -s);
  return least;
}

constexpr double kNearer = 1e-2;  // of the gap, away from theta

// From a z that is above theta, which is the eigenvalue nearest to any such z, down to a hundredth
// of the gap above it. Branches of eigenvalues of which one grows by sliding and another by resting
// cross almost without coupling, so that no eigenvalue near to one at another s need be theta.
// Returns that hundredth; none if no z above theta has been found. Of a gap that only seemed to be
// the smallest one it returns a hundredth where it finds no smaller one.
std::optional<double> approach(Powers& powers, double below, double step, double top) {
  constexpr int most = 40, steps = 8;
  double z = below + step;
  std::optional<std::pair<double, double>> found;  // z and that hundredth
  for (; !powers.is_above(z); z = below + step) {
    if (z > top) return {};
    step = 2 * (z - below);
    below = z;
  }
  powers.restart();
  for (int n = 0; n < most; ++n) {
    const bool near = powers.converges(steps);
    const double theta = powers.theta(), away = near ? kNearer * powers.gap() : 0.2 * (z - theta),
                 next = std::max(theta + away, below + 0.1 * (z - below));
    if (powers.is_above(next)) {
      z = next;
      if (near && z == theta + away) {
        found = {z, away};
        if (!powers.hides_a_slow_part()) return away;
      }
    } else {
      if (near && z - next < away) break;  // it is not there that u turns negative
      below = next;
      powers.move(z);
    }
  }
  if (!found) return {};
  powers.move(found->first);
  return found->second;
}

// Next to theta each step makes the vectors a hundred times more accurate. The last one, which
// changes nothing but rounding, shows the error. `recipe` holds z and z - theta of the refinement
// level before. Nothing where the discretisation shows no largest eigenvalue.
std::optional<TiltedGrowth> growth(generator::Systems& systems, double s, bool truncated,
                                   Recipe& recipe) {
  const double rate = 1 / systems.process().noise.correlation_time(),
               v_max = systems.discretisation().velocities->v_max(),
               least = least_growth(systems.process(), s, v_max);
  auto& known = recipe.steps;
  Powers powers(systems, s, known.empty() ? least + rate : known[0].z.real());
  const auto next_to_theta = [&] {  // as on the level before
    constexpr double share = 0.3;
    constexpr int steps = 40;
    if (known.empty() || !powers.is_above(known[0].z.real()) || !powers.converges(steps))
      return false;
    const double gap = known[1].z.real() / kNearer;
    return std::abs(powers.theta() - known[0].z.real()) < share * gap &&
           !powers.hides_a_slow_part();
  };
  if (!next_to_theta()) {
    known.clear();
    const auto away = approach(powers, least, rate, std::abs(s) * v_max);
    if (!away) return {};
    known = {{powers.theta() + *away}, {*away}};
  }
  powers.finish();
  const double theta = powers.theta(), velocity = powers.velocity();
  powers.step(true);
  const double left = powers.left();
  known[0].z = powers.theta() + known[1].z;
  const double cut = truncated ? held(powers.a(), powers.vectors()) * v_max : 0;
  const auto with_error = [left](double now, double before, double more) {
    return Uncertain{now, left * std::abs(now - before) + more};
  };
  return TiltedGrowth{s == 0 ? Uncertain{} : with_error(powers.theta(), theta, cut * std::abs(s)),
                      with_error(powers.velocity(), velocity, cut)};
}

// Theta is convex, 0 at s = 0, and its slopes are velocities of bodies. Where grossly another
// eigenvalue was taken, there is no value. `rate` is that at which the noise changes.
void leave_out_contradictions(std::map<double, TiltedGrowth>& known, double v_max, double rate) {
  constexpr double share = 1e-2, rounding = 1e-9;
  std::set<double> doubtful;
  const auto below_tangent = [&](double s, double theta, double at) {
    const auto& [there, slope] = known[at];
    const double rise = slope.value * (s - at);
    return theta - there.value - rise <
           -share * (std::abs(theta) + std::abs(there.value) + std::abs(rise)) - rounding * rate;
  };
  for (const auto& [s, g] : known) {
    if (below_tangent(0, 0, s) || std::abs(g.velocity.value) > (1 + share) * v_max) {
      doubtful.insert(s);
    }
    for (const auto& [at, other] : known) {
      if (below_tangent(s, g.theta.value, at)) doubtful.insert({s, at});
    }
  }
  for (double s : doubtful) known[s] = {kNoValue, kNoValue};
}

void find_growth(Computation& computation) {
  const auto tilts = computation.question().values(cases::kTilt.option);
  const auto& scene = computation.problem.given.scene;
  std::map<double, TiltedGrowth> known;
  // Mirror images grow alike.
  const auto alike = [mirrored = computation.process().symmetric()](double s) {
    return mirrored ? std::abs(s) : s;
  };
  for (double s : tilts) {
    const double tilt = alike(s);
    auto& recipe = computation.tolerance().recipe(fmt::format("tilt {}", tilt));
    if (!known.contains(tilt)) {
      known[tilt] = growth(computation.systems, tilt, !scene.limits_speed, recipe)
                        .value_or(TiltedGrowth{kNoValue, kNoValue});
    }
  }
  leave_out_contradictions(known, computation.problem.discretisation.velocities->v_max(),
                           1 / computation.process().noise.correlation_time());
  Result theta = array(cases::kTheta, tilts), velocity = array(cases::kTiltedVelocity, tilts),
         rate = array(cases::kRateFunction, tilts);
  for (double s : tilts) {
    TiltedGrowth g = known[alike(s)];
    if (s != alike(s)) g.velocity.value = -g.velocity.value;
    append_value(theta, g.theta);
    append_value(velocity, g.velocity);
    append_value(rate, s * g.velocity - g.theta);
  }
  for (auto* result : {&theta, &velocity, &rate}) {
    result->unreached = "is not resolved: no eigenvalue was found for certain to be the largest "
                        "one; leave it out, or take -noise_degree 0 or a higher -degree";
    computation.results().push_back(std::move(*result));
  }
}

}  // namespace

void large_deviation_tasks(Planner& planner) {
  const auto& tilts = planner.question().values(cases::kTilt.option);
  planner.needs().rates.tilt = largest_size(tilts);
  const auto count = static_cast<int>(tilts.size());
  planner.add_adaptive("large deviations", 2 * count, 40 * count, find_growth);
}

}  // namespace stickslip::quantities
