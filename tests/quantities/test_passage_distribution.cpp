#include <algorithm>
#include <cmath>

#include "../common/catch.hpp"
#include "../common/chains.hpp"
#include "../common/full_grid.hpp"
#include "../common/passages.hpp"
#include "../common/solved.hpp"
#include "../common/values.hpp"
#include "stickslip/case/passage_rows.hpp"
#include "stickslip/generator/velocity_methods.hpp"
#include "stickslip/linalg/dense.hpp"
#include "stickslip/linalg/vectors.hpp"
#include "stickslip/quantities/passages.hpp"

using namespace stickslip;
using model::Passage;
using model::Start;
using Matrix = linalg::Matrix<double>;
using test::passage_key;
using test::passing;
using test::Solved;

namespace {

constexpr Passage kPassages[] = {Passage::both, Passage::up, Passage::down};
const Start kRest{0, 0, Start::Kind::rest}, kStationary{0, 0, Start::Kind::stationary};

// Levels +-1 without drag. Without bias bodies never rest where mu_s < 1; with 0.3 and mu_s = 1
// they rest on the lower level.
model::Scene telegraph(double bias, double mu_s) {
  auto s = test::biased(test::scene(mu_s, 0.5, 1, 0.25, {0, 0}), bias);
  s.noise.name = "telegraph";
  s.noise.table =
      std::make_shared<const model::LevelTable>(std::vector<model::Level>{{-1, 1, 0}, {1, 0, 1}});
  return s;
}

// On the upper level bodies get faster at the rate p, on the lower one slower at the rate q; with u
// the transforms by level, p u+' = (s + 1) u+ - u-, q u-' = u+ - (s + 1) u-, u+(w) = 1, and at rest
// u- = h u+.
template <class Scalar>
struct ByLevel {
  Scalar up, down;
};
template <class Scalar>
ByLevel<Scalar> telegraph_transform(Scalar s, double p, double q, double w, Scalar h, double v) {
  const auto unscaled = [&](double speed) -> ByLevel<Scalar> {
    const Scalar mean = (s + 1.0) * (1 / p - 1 / q) / 2.0, half = (s + 1.0) * (1 / p + 1 / q) / 2.0,
                 root = std::sqrt(half * half - 1 / (p * q)), even = std::cosh(root * speed),
                 odd = std::sinh(root * speed) / root, growth = std::exp(mean * speed);
    return {growth * (even + odd * (half - h / p)), growth * (h * even + odd * (1 / q - half * h))};
  };
  const auto here = unscaled(v);
  const Scalar top = unscaled(w).up;
  return {here.up / top, here.down / top};
}

/// A dense chain on the whole grid of the paper, killed where it passes j steps.
class DensePassage {
 public:
  DensePassage(const test::FullGrid& grid, Passage passage, int j, const model::Process& process)
      : grid_(grid), m_(grid.size() + 1, grid.size() + 1) {
    const auto& all = grid.generator();
    for (int r = 0; r < grid.size(); ++r) {
      for (int c = 0; c < grid.size(); ++c) m_(r, c) = all(r, c);
    }
    for (int i = -process.noise.levels; i <= process.noise.levels; ++i) {
      if (passage != Passage::down) kill(grid.index(i, j - 1), grid.index(i, j));
      if (passage != Passage::up) kill(grid.index(i, 1 - j), grid.index(i, -j));
    }
  }
  // By time, from each state.
  struct OfStates {
    std::vector<double> density, distribution;
  };
  [[nodiscard]] OfStates at(double time) const {
    const auto e = linalg::exponential(m_, time);
    const int n = grid_.size();
    OfStates law;
    for (int r = 0; r < n; ++r) {
      law.distribution.push_back(e(r, n));
      double rate = 0;
      for (int c = 0; c < n; ++c) rate += e(r, c) * m_(c, n);
      law.density.push_back(rate);
    }
    return law;
  }

 private:
  void kill(int from, int to) {
    m_(from, grid_.size()) += m_(from, to);
    m_(from, to) = 0;
  }
  const test::FullGrid& grid_;
  Matrix m_;
};

}  // namespace

// F(s) = 1 - s E[T] + s^2 E[T^2]/2 - ..., by differences of third order.
TEST_CASE("passage transform: its derivatives at 0 are the moments", "[parallel]") {
  for (const auto& s : {passing(), test::by_direction(passing(0.2)), telegraph(0, 0.8)}) {
    for (const auto& d : {test::on_hp(s, 8), test::on_upwind(s, 4)}) {
      Solved solved(d);
      for (const Passage passage : kPassages) {
        for (const auto& start :
             {kRest, kStationary, Start{solved.systems.process().noise.highest(), 0}}) {
          INFO("symmetric " << solved.systems.process().symmetric() << ", passage "
                            << static_cast<int>(passage) << ", start "
                            << static_cast<int>(start.kind));
          const auto key = passage_key(solved.systems.process(), passage, 0.3);
          const auto known = quantities::passage_time(solved.systems, key, start);
          const double m = known.mean.value, h = 1e-3 / std::max(1.0, m);
          const auto f = quantities::passage_transform(solved.systems, key, start,
                                                       {0, h, 2 * h, 3 * h, 4 * h});
          CHECK(f[0].value == Approx(1).epsilon(1e-11));
          const double slope = (-25 * f[0].value + 48 * f[1].value - 36 * f[2].value +
                                16 * f[3].value - 3 * f[4].value) /
                               (12 * h);
          const double curve = (35 * f[0].value - 104 * f[1].value + 114 * f[2].value -
                                56 * f[3].value + 11 * f[4].value) /
                               (12 * h * h);
          CHECK(-slope == Approx(m).epsilon(1e-6));
          CHECK(curve - m * m == Approx(known.variance.value).epsilon(1e-3));
        }
      }
      solved.systems.keep({});
    }
  }
}

TEST_CASE("passage transform: telegraph noise without drag, in closed form") {
  Solved turning(test::on_hp(telegraph(0, 0.8), 12, 1e-14)),
      resting(test::on_hp(telegraph(0.3, 1), 12, 1e-14));
  const std::vector<double> lambda{0.01, 0.7, 3};
  const double w = 0.6;
  const int lower = telegraph(0, 1).noise.table->lowest();
  const auto transforms = [&](Solved& solved, Passage passage, const Start& start) {
    return quantities::passage_transform(
        solved.systems, passage_key(solved.systems.process(), passage, w), start, lambda);
  };
  const auto both = transforms(turning, Passage::both, kRest),
             fast = transforms(turning, Passage::both, {lower, 0.4}),
             up = transforms(resting, Passage::up, kRest),
             slow = transforms(resting, Passage::both, {lower, 0.4});
  for (std::size_t n = 0; n < lambda.size(); ++n) {
    const double s = lambda[n], h = 1 / (1 + s);
    const auto at_once = telegraph_transform(s, 0.5, 1.5, w, 1.0, 0);
    CHECK(both[n].value == Approx(at_once.up).epsilon(1e-10));
    CHECK(fast[n].value ==
          Approx(telegraph_transform(s, 0.5, 1.5, w, 1.0, 0.4).down).epsilon(1e-8));
    const auto first = telegraph_transform(s, 0.8, 1.2, w, h, 0);
    CHECK(up[n].value == Approx((first.up + first.down) / 2).epsilon(1e-10));
    CHECK(slow[n].value == Approx(telegraph_transform(s, 0.8, 1.2, w, h, 0.4).down).epsilon(1e-8));
    CHECK(both[n].error < 1e-10);
  }
}

// No symmetry reduction, no renewal, no reduced models, no PETSc.
TEST_CASE("passage distribution: upwind equals dense exponentials on the whole grid",
          "[parallel]") {
  const std::vector<double> time{2.5, 0.05, 0.4};
  const int levels = 4, nodes = 5, j = 3;
  const double spacing = 0.25;
  {
    const model::Process process{{1, 0.5, levels}, {1, 0.5}, {1, 0}};
    const test::FullGrid grid(process, spacing, nodes);
    Solved s({process, std::make_shared<generator::UpwindDiscretisation>(spacing, nodes,
                                                                         model::Drag{1, 0})});
    const auto p = model::stationary_distribution(process.noise);
    const auto pi = grid.stationary();
    for (const Passage passage : kPassages) {
      const auto key = passage_key(process, passage, j * spacing);
      const DensePassage dense(grid, passage, j, process);
      for (const auto& start : {kRest, kStationary, Start{1, 0.25}}) {
        const auto found = quantities::passage_distribution(s.systems, key, start, time, 1e-10);
        for (std::size_t n = 0; n < time.size(); ++n) {
          const auto law = dense.at(time[n]);
          double density = 0, below = 0;
          const auto add = [&](int state, double share) {
            density += share * law.density[state];
            below += share * law.distribution[state];
          };
          if (start.kind == Start::Kind::state) add(grid.index(1, 1), 1);
          if (start.kind == Start::Kind::rest) {
            for (int i = -levels; i <= levels; ++i) add(grid.index(i, 0), p[i + levels]);
          }
          if (start.kind == Start::Kind::stationary) {
            grid.for_each([&](int, int at, double v, int state) {
              const bool passed = model::has_passed(passage, v, j * spacing);
              passed ? static_cast<void>(below += pi[state]) : add(state, pi[state]);
              static_cast<void>(at);
            });
          }
          INFO("passage " << static_cast<int>(passage) << ", start " << static_cast<int>(start.kind)
                          << ", time " << time[n]);
          CHECK(std::abs(found.density[n].value - density) < 1e-8);
          CHECK(std::abs(found.distribution[n].value - below) < 1e-8);
        }
      }
    }
  }
}

// The transform of the closed form above inverted to 12 digits, in another program: before 0.375
// nobody arrives, and then those whom the noise has not turned, exp(-0.375)/2 of all.
TEST_CASE("passage distribution: telegraph noise, with a step", "[real]") {
  const std::vector<double> time{0.1, 0.3, 0.36, 0.39, 0.5, 1, 3, 10},
      below{0, 0, 0, 0.348982493, 0.391481999, 0.555216550, 0.879549229, 0.998754292},
      density{0, 0, 0, 2.171901209, 0.393338286, 0.290789461, 0.078663599, 0.000813542755};
  cases::Case c;
  c.scene = telegraph(0.3, 1);
  c.question = {.quantities = {cases::kPassageTimeDistribution.quantity},
                .time = time,
                .velocity = {0.3},
                .start = kRest,
                .accuracy = 1e-4};
  const auto found = test::values(c);
  const auto &cdf = found.at("cdf_passage(0.3)"), &f = found.at("f_passage(0.3)");
  for (std::size_t n = 0; n < time.size(); ++n) {
    INFO("time " << time[n] << ": " << cdf.value[n] << " +- " << cdf.error[n] << ", density "
                 << f.value[n] << " +- " << f.error[n]);
    CHECK(std::abs(cdf.value[n] - below[n]) <= cdf.error[n] + 1e-9);
    CHECK(std::abs(f.value[n] - density[n]) <= f.error[n] + 1e-9);
    CHECK(cdf.error[n] < (time[n] > 5 ? 1e-5 : time[n] > 0.6 ? 0.02 : 0.3));
  }
}

// The mass beyond it, by other elements.
TEST_CASE("passage distribution: a stationary start may be beyond the speed") {
  Solved solved(test::on_hp(passing(0.3), 10));
  const auto& velocities = *solved.systems.discretisation().velocities;
  const linalg::ReadView nu(solved.distribution.occupation());
  std::vector<double> mass(static_cast<std::size_t>(velocities.size()));
  double all = 0;
  PetscInt at = 0;
  solved.distribution.states().for_each_local([&](const generator::State& state) {
    const double here = PetscRealPart(nu[at++]);
    if (state.branch == generator::Branch::positive) mass[state.node] += here, all += here;
  });
  const double beyond =
      (all - velocities.mass_below(mass, 0.4)) / solved.distribution.excursion().mean_excursion();
  const auto key = passage_key(solved.systems.process(), Passage::up, 0.4);
  const auto law = quantities::passage_distribution(solved.systems, key, kStationary, {0}, 1e-8);
  const auto f = quantities::passage_transform(solved.systems, key, kStationary, {1e7});
  CHECK(beyond > 0.1);
  CHECK(law.distribution[0].value == Approx(beyond).epsilon(1e-7));
  CHECK(f[0].value == Approx(beyond).epsilon(1e-6));
  CHECK(f[0].value - beyond == Approx(1e-7 * law.density[0].value).epsilon(0.05));
}

TEST_CASE("passage distribution: its density is the derivative, and holds all mass", "[real]") {
  Solved solved(test::on_hp(passing(0.2), 10));
  std::vector<double> time{0};
  for (double t = 1.5; t < 90; t *= 1.02) time.push_back(t);
  const auto key = passage_key(solved.systems.process(), Passage::up, 0.4);
  const auto found = quantities::passage_distribution(solved.systems, key, kStationary, time, 1e-8);
  const auto &f = found.density, &cdf = found.distribution;
  for (std::size_t n = 2; n < time.size(); ++n) {
    const double step = (time[n] - time[n - 1]) / 2 * (f[n].value + f[n - 1].value);
    CHECK(cdf[n].value - cdf[n - 1].value == Approx(step).epsilon(6e-3).margin(1e-7));
  }
  CHECK(cdf.back().value == Approx(1).epsilon(1e-5));
  CHECK(cdf[0].value > 0);
  CHECK(quantities::passage_distribution(solved.systems, key, kRest, {0}, 1e-8)
            .distribution[0]
            .value == 0);
}

TEST_CASE("passages: simulated times, transforms and distributions, within 4.5 sigma",
          "[real][long]") {
  auto any = passing(0.25);
  any.noise.name = "chain";
  any.noise.table = std::make_shared<const model::LevelTable>(test::five_states());
  const model::Scene scenes[] = {passing(), any, telegraph(0.3, 1)};
  const Start starts[] = {kRest, kStationary, Start{-1, -0.1}};
  // Each start with each noise and each passage once.
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t m = 0; m < 3; ++m) {
      const auto& s = scenes[k];
      const auto passage = kPassages[m];
      const auto& start = starts[(k + m) % 3];
      if (passage == Passage::down && s.bias == 0.3) continue;  // nobody gets there
      cases::Case c;
      c.scene = s;
      c.question = {.quantities = {cases::kFirstPassageTime.quantity,
                                   cases::kPassageTimeDistribution.quantity,
                                   cases::kPassageTimeTransform.quantity},
                    .lambda = {0.2, 3},
                    .time = {0, 0.25, 1, 4},
                    .velocity = {0.4, 0.2},
                    .start = start,
                    .passage = passage,
                    .accuracy = 1e-3};
      c.method.degree = 9;
      const auto found = test::values(c);
      c.method.degree.reset();
      c.method.route = cases::Route::monte_carlo;
      c.method.excursions = 20000;
      for (const auto& [key, sampled] : test::values(c)) {
        if (key.starts_with("f_")) continue;  // averages over wide cells
        const auto& r = found.at(key);
        for (std::size_t n = 0; n < r.value.size(); ++n) {
          const double sigma = test::sigma(sampled, n);
          INFO("bias " << s.bias << ", passage " << static_cast<int>(passage) << ", start "
                       << static_cast<int>(start.kind) << ", " << key << " at " << r.abscissa[n]
                       << ": " << r.value[n] << " +- " << r.error[n] << ", " << sampled.value[n]
                       << " +- " << sigma);
          CHECK(std::abs(sampled.value[n] - r.value[n]) <= 4.5 * sigma + r.error[n]);
          CHECK(sigma < (key.starts_with("first_") ? 0.2 * r.value[n] : 0.02));
        }
      }
    }
  }
}
