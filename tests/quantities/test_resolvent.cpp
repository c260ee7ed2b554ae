#include <algorithm>
#include <cmath>

#include "../common/catch.hpp"
#include "../common/chains.hpp"
#include "../common/near.hpp"
#include "../common/scenes.hpp"
#include "stickslip/linalg/petsc.hpp"
#include "stickslip/quantities/durations.hpp"
#include "stickslip/quantities/engines/excursions.hpp"
#include "stickslip/quantities/spectra.hpp"

using namespace stickslip;
using generator::Branch;
using generator::StaticPhase;
using generator::Symmetry;
using generator::Systems;
using linalg::check;
using test::relative_difference;
using test::scene;

namespace {

std::vector<model::Observable> observables(const std::vector<std::string>& texts) {
  std::vector<model::Observable> all;
  for (const auto& text : texts) all.push_back(model::parse_observable(text, {1, 0.25}));
  return all;
}

/// u = R f on the whole grid, with R = (lambda - L)^-1, by its even and odd parts at s+.
///
/// R has the eigenvalue 1/lambda: rounding of the solve comes back as a constant of the size of
/// rounding/lambda. The number c with R(f - c) = 0 at s+ and s- in the mean keeps all digits: found
/// by c <- c + lambda R(f - c), it is lambda times the even part of u, and the solutions stay of
/// order one. The odd part is half a difference, which sees no constants.
class Direct {
 public:
  Direct(Systems& systems, double lambda)
      : lambda_(lambda),
        system_(systems.at(lambda, Symmetry::none, StaticPhase::kept)),
        upper_(system_.a().trace_at_exit(Branch::positive)),
        lower_(system_.a().trace_at_exit(Branch::negative)) {}

  struct Parts {
    double even_by_lambda, odd;
  };
  [[nodiscard]] Parts of(const model::Observable& f) {
    const linalg::VecHandle rest = system_.a().values(f.value);
    double c = 0, odd = 0;
    for (int n = 0; n < 3; ++n) {
      const auto u = system_.factors().solve(rest);
      const double at_plus = quantities::value_of(upper_, u).value;
      const double at_minus = quantities::value_of(lower_, u).value;
      const double step = lambda_ * (at_plus + at_minus) / 2;
      odd = (at_plus - at_minus) / 2;
      c += step;
      check(VecShift(rest, -step));
    }
    return {c, odd};
  }

 private:
  double lambda_;
  generator::System& system_;
  linalg::VecHandle upper_, lower_;
};

// Relative closeness; what is zero by symmetry is so up to rounding in the direct solution.
bool close(double found, double expected) {
  if (expected == 0) return std::abs(found) < 1e-12;
  return relative_difference(found, expected) < 1e-9;
}

const std::vector<model::Scene>& sample_scenes() {
  static const std::vector<model::Scene> scenes{
      scene(1, 0.25, 1, 0.5, {1, 0}), scene(1, 1, 1, 0.5, {0, 0}), scene(0.7, 0.4, 1, 0.5, {2, 1}),
      scene(0.2, 0.1, 0.5, 0.5, {0.3, 0})};
  return scenes;
}

// The last one has 42 states, 10 of which are starts.
std::vector<model::Scene> without_symmetry() {
  auto asymmetric = test::biased(scene(1, 0.4, 1, 0.5, {1, 0}), 0.2);
  asymmetric.friction.mu_s_minus = 1.3;
  asymmetric.friction.mu_d_minus = 0.7;
  const auto five = test::with_table(scene(1, 0.5, 1, 1, {1, 0}), test::five_states());
  const auto sine = test::with_table(scene(0.8, 0.4, 1, 1, {1, 0}),
                                     test::sine_and_levels(1.1, 4, 6, 0.6, 1, 0.7, 3));
  return {asymmetric, five, test::biased(five, 0.15), test::biased(sine, 0.1)};
}

/// Systems of one discretisation, with what must outlive them.
struct Discretised {
  explicit Discretised(const test::Discrete& d) : systems(PETSC_COMM_WORLD, d, statistics) {}
  linalg::SolverStatistics statistics;
  Systems systems;
};

std::vector<test::Discrete> sample_discretisations() {
  std::vector<test::Discrete> all;
  for (const auto& s : sample_scenes()) {
    all.push_back(test::on_hp(s, 5, 1e-9));
    all.push_back(test::on_upwind(s, 3));
  }
  return all;
}

}  // namespace

// The symmetry-reduced problems of Prop. 3.1, static values first, against one with both branches
// solve.
TEST_CASE("resolvent: the representation formula gives the resolvent of the whole process") {
  const auto f = observables({"v^2", "stick", "v", "x*v+v"});
  for (const auto& d : sample_discretisations()) {
    Discretised made(d);
    for (double lambda : {1e-8, 1e-4, 1e-2, 1.0, 1e2}) {
      const auto r = quantities::resolvent(made.systems, lambda, f);
      Direct direct(made.systems, lambda);
      for (std::size_t n = 0; n < f.size(); ++n) {
        const auto u = direct.of(f[n]);
        INFO(f[n].name << " at lambda " << lambda);
        CHECK(close(u.even_by_lambda, r.of[n].pi_lambda.value));
        CHECK(close(u.odd, r.of[n].mu_lambda.value));
        const double even = r.of[n].pi_lambda.value == 0 ? 0 : u.even_by_lambda / lambda;
        CHECK(close(even + u.odd, r.of[n].u.value));
      }
    }
  }
}

// Without symmetry, and from many starts; solved for on all states, with the static ones.
TEST_CASE("resolvent: without symmetry it is that of the whole process, too") {
  const auto f = observables({"v^2", "stick", "v", "x*v+v", "y == 0 ? x + 1 : v*v*v"});
  auto discretisations = std::vector{test::on_upwind(without_symmetry()[0], 3)};
  for (const auto& s : without_symmetry()) discretisations.push_back(test::on_hp(s, 5, 1e-9));
  for (const auto& d : discretisations) {
    Discretised made(d);
    for (double lambda : {1e-3, 0.5, 1e2}) {
      const auto r = quantities::resolvent(made.systems, lambda, f);
      auto& whole = made.systems.at(lambda, Symmetry::none, StaticPhase::kept);
      for (std::size_t n = 0; n < f.size(); ++n) {
        const auto u = whole.factors().solve(whole.a().values(f[n].value));
        INFO(f[n].name << " at " << lambda);
        for (const auto& [branch, found] :
             {std::pair{Branch::positive, &r.of[n].u}, {Branch::negative, &r.of[n].u_from_minus}}) {
          const double known = quantities::value_of(whole.a().trace_at_exit(branch), u).value;
          CHECK(std::abs(found->value - known) < 1e-10 * std::abs(known));
        }
      }
      made.systems.release({lambda, Symmetry::none, StaticPhase::kept});
    }
  }
}

TEST_CASE("resolvent: an excursion ends at s+ or s-, now or later", "[parallel]") {
  for (const auto& d : sample_discretisations()) {
    Discretised made(d);
    const quantities::StationaryDistribution distribution(made.systems);
    for (double lambda : {0.0, 1.0, 1e2}) {
      const auto exits = quantities::resolvent(made.systems, lambda, {}).from_plus;
      const double ends = exits.h_plus.value + exits.h_minus.value;
      CHECK(std::abs(1 - ends - lambda * exits.w_one.value) < 1e-11);
      CHECK(exits.h_plus.value > 0);
      CHECK(exits.h_minus.value > 0);
      const double excursion =
          quantities::duration_transforms(made.systems, distribution, lambda).excursion.value;
      CHECK(relative_difference(ends, excursion) < 1e-11);
    }
  }
}

TEST_CASE("resolvent: what is zero by symmetry is exactly zero", "[parallel]") {
  const auto d = test::on_hp(sample_scenes()[0], 4, 1e-8);
  Discretised made(d);
  for (double lambda : {0.0, 0.5}) {
    for (const auto& t :
         quantities::resolvent(made.systems, lambda, observables({"v", "x", "y*v^2"})).of) {
      CHECK(t.pi_lambda.value == 0);
      CHECK(t.pi_lambda.error == 0);
      CHECK(t.w_plus.value == -t.w_minus.value);
    }
    for (const auto& t :
         quantities::resolvent(made.systems, lambda, observables({"v^2", "stick", "x*v"})).of) {
      CHECK(t.mu_lambda.value == 0);
      CHECK(t.mu_lambda.error == 0);
      CHECK(t.w_plus.value == t.w_minus.value);
    }
  }
}

// (lambda - L) u = lambda c + (lambda - L) g has the solution u = c + g: with g = x, L x = -x/tau
// on the whole noise range, u(s+) is known without any solve.
TEST_CASE("resolvent: of the noise itself, in closed form", "[parallel]") {
  for (double tau : {1.0, 2.0}) {
    const auto s = test::on_full_noise(scene(1, 0.25, tau, 0.5, {1, 0}));
    const auto d = test::on_hp(s, 5);
    Discretised made(d);
    const double x = d.process.noise.level(d.process.highest_static() + 1);
    for (double lambda : {1e-6, 0.3, 20.0}) {
      const auto r = quantities::resolvent(made.systems, lambda, observables({"x", "x^2", "1"}));
      CHECK(relative_difference(r.of[0].u.value, x / (lambda + 1 / tau)) < 1e-11);
      const double square = 1 / (tau * lambda) + (x * x - 1 / tau) / (lambda + 2 / tau);
      CHECK(relative_difference(r.of[1].u.value, square) < 1e-11);
      CHECK(relative_difference(r.of[2].u.value, 1 / lambda) < 1e-13);
    }
  }
}

TEST_CASE("resolvent: u is given where all lambda are positive", "[parallel]") {
  const auto d = test::on_hp(sample_scenes()[1], 3, 1e-6);
  const auto f = observables({"v^2"});
  for (double first : {0.0, 0.5}) {
    Discretised made(d);
    const std::vector<double> lambda{first, 1};
    std::vector<quantities::Resolvent> all;
    for (double l : lambda) all.push_back(quantities::resolvent(made.systems, l, f));
    quantities::Results results;
    quantities::append_resolvent(lambda, f, all, true, results);
    const auto is_u = [](const auto& result) { return result.key == "u(v^2)"; };
    CHECK(std::count_if(results.begin(), results.end(), is_u) == (first > 0 ? 1 : 0));
    for (const auto& result : results) CHECK(result.value.size() == 2);
  }
}

TEST_CASE("resolvent: at lambda = 0 the resolvent is that of small lambda", "[real]") {
  const auto f = observables({"stick", "v^2", "x*v+v"});
  for (const auto& s : without_symmetry()) {
    Discretised made(test::on_hp(s, 11));
    const quantities::StationaryDistribution distribution(made.systems);
    quantities::Results known;
    quantities::append_sticking(distribution.excursion(), known);
    quantities::append_moments(distribution.discretisation(), distribution.excursion(), known);
    const auto r = quantities::resolvent(made.systems, 0, f),
               near = quantities::resolvent(made.systems, 1e-7, f);
    CHECK(relative_difference(r.of[0].pi_lambda.value, known[0].value[0]) < 1e-10);
    CHECK(relative_difference(r.of[1].pi_lambda.value, known[5].value[0]) < 1e-10);
    for (std::size_t n = 0; n < f.size(); ++n) {
      INFO(f[n].name << " bias " << s.bias);
      CHECK(std::abs(r.of[n].mu_lambda.value - near.of[n].mu_lambda.value) < 1e-5);
      CHECK(r.of[n].mu_lambda.error < 1e-11);
      CHECK(near.of[n].mu_lambda.error < 1e-11);
    }
  }
}

// Copies of a level are alike, whichever is reached.
TEST_CASE("resolvent: levels with two states each give what they give with one", "[real]") {
  auto weak = test::scene(1, 0.3, 1, 0.5, {1, 0});
  weak.noise_levels = 5;
  for (double bias : {0.0, 0.2}) {
    weak.bias = bias;
    const auto twice = test::with_table(weak, test::twice(weak.meant().noise, 0.3));
    REQUIRE(twice.meant().starts().size() == 4);
    const auto f = observables({"v^2", "stick", "v", "x*v+v", "abs(v)"});
    Discretised one(test::on_hp(weak, 11)), two(test::on_hp(twice, 11));
    for (double lambda : {0.0, 0.4, 50.0}) {
      const auto known = quantities::resolvent(one.systems, lambda, f),
                 found = quantities::resolvent(two.systems, lambda, f);
      INFO("lambda " << lambda << " bias " << bias);
      const auto same = [&](quantities::Uncertain a, quantities::Uncertain b) {
        INFO(a.value << " for " << b.value);
        CHECK(std::abs(a.value - b.value) < 1e-11 * (std::abs(b.value) + 0.01));
        CHECK(a.error < 1e-11 * (std::abs(b.value) + 0.01));
      };
      same(found.from_plus.h_plus, known.from_plus.h_plus);
      same(found.from_plus.h_minus, known.from_plus.h_minus);
      same(found.from_minus.h_minus, known.from_minus.h_minus);
      same(found.from_minus.w_one, known.from_minus.w_one);
      for (std::size_t n = 0; n < f.size(); ++n) {
        INFO(f[n].name);
        using Of = quantities::ObservableTransforms;
        for (auto member : {&Of::w_plus, &Of::w_minus, &Of::pi_lambda, &Of::mu_lambda,
                            &Of::mu_from_minus, &Of::u}) {
          same(found.of[n].*member, known.of[n].*member);
        }
      }
    }
  }
}

// By hand: three starts, of which the equations are solved by Cramer's rule.
TEST_CASE("resolvent: discounted starts satisfy their equations, with errors to scale") {
  const std::vector<std::vector<double>> h{{0.1, 0.3, 0.2}, {0.05, 0.2, 0.4}, {0.3, 0.1, 0.15}};
  const double lambda = 0.4;
  const std::vector<double> f{0.7, -0.2, 1.5};
  const auto made = [&](double error) {
    std::vector<quantities::Uncertain> w, values;
    std::vector<std::vector<quantities::Uncertain>> steps(3);
    for (std::size_t t = 0; t < 3; ++t) {
      w.push_back({(1 - h[t][0] - h[t][1] - h[t][2]) / lambda, error});
      values.push_back({f[t], error});
      for (double p : h[t]) steps[t].push_back({p, error});
    }
    return std::tuple{quantities::DiscountedStarts(lambda, w, steps), w, values};
  };
  const auto [starts, w, values] = made(1e-9);
  const auto mean = starts.mean(values);
  const auto mu = starts.apart(values);
  for (std::size_t t = 0; t < 3; ++t) {
    double left = lambda * w[t].value * mu[t].value;
    for (std::size_t u = 0; u < 3; ++u) left += h[t][u] * (mu[t].value - mu[u].value);
    CHECK(left == Approx(f[t] - mean.value * w[t].value).epsilon(1e-12));
    CHECK(mu[t].error > 1e-9);
    CHECK(mu[t].error < 1e-7);
  }
  CHECK(mean.error > 1e-9);
  CHECK(mean.error < 1e-7);
  // What changes by errors stays within them.
  auto moved = h;
  moved[0][1] += 1e-9;
  moved[1][2] -= 1e-9;
  std::vector<std::vector<quantities::Uncertain>> steps(3);
  for (std::size_t t = 0; t < 3; ++t) {
    for (double p : moved[t]) steps[t].push_back({p, 0});
  }
  const quantities::DiscountedStarts other(lambda, w, steps);
  CHECK(std::abs(other.mean(values).value - mean.value) <= mean.error);
  for (std::size_t t = 0; t < 3; ++t) {
    CHECK(std::abs(other.apart(values)[t].value - mu[t].value) <= mu[t].error);
  }
}
