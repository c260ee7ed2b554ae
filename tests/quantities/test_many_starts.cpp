#include <cmath>
#include <functional>
#include <map>

#include "../common/catch.hpp"
#include "../common/chains.hpp"
#include "../common/near.hpp"
#include "../common/scenes.hpp"
#include "../common/solved.hpp"
#include "stickslip/linalg/dense.hpp"
#include "stickslip/model/effect.hpp"
#include "stickslip/quantities/engines/excursions.hpp"
#include "stickslip/quantities/sensitivity.hpp"
#include "stickslip/quantities/spectra.hpp"
#include "stickslip/run/evaluation.hpp"

using namespace stickslip;
using cases::Quantity;
using cases::Route;
using quantities::Results;
using quantities::Uncertain;
using test::relative_difference;

namespace {

constexpr int kDegree = 11;

const model::Scene kPlain = test::scene(1, 0.5, 1, 1, {1, 0});

model::Scene biased(model::Scene s) {
  s.bias = 0.15;
  return s;
}

// 42 states, 10 of which are starts.
model::Scene sine(const model::Drag& drag = {1, 0}) {
  auto s = test::with_table(test::scene(0.8, 0.4, 1, 1, drag),
                            test::sine_and_levels(1.1, 4, 6, 0.6, 1, 0.7, 3));
  s.bias = 0.1;
  return s;
}

std::vector<model::Scene> samples() {
  const auto five = test::with_table(kPlain, test::five_states());
  return {five, biased(five), sine()};
}

std::vector<model::Observable> observables(const std::vector<std::string>& texts) {
  std::vector<model::Observable> all;
  for (const auto& text : texts) all.push_back(model::parse_observable(text, {1, 0.5}));
  return all;
}

struct Discretised {
  explicit Discretised(const model::Scene& s, int degree = kDegree)
      : systems(PETSC_COMM_WORLD, test::on_hp(s, degree), statistics) {}
  linalg::SolverStatistics statistics;
  generator::Systems systems;
};

// (lambda - Q) u = f, or lambda u + (u - E[u]) with f - E[f], by the noise alone.
std::vector<double> of_noise(const model::NoiseChain& noise, double lambda,
                             const std::function<double(double)>& f) {
  std::vector<double> values;
  std::vector<linalg::RateElimination::Rate> rates;
  for (int i = noise.lowest(); i <= noise.highest(); ++i) {
    values.push_back(f(noise.level(i)));
    noise.for_each_jump(i, [&](int to, double rate) {
      rates.push_back({i - noise.lowest(), to - noise.lowest(), rate});
    });
  }
  return linalg::RateElimination(std::vector<double>(values.size(), lambda), rates)
      .integral(values);
}

double at_level(const model::NoiseChain& noise, const std::vector<double>& values, int level) {
  return values[static_cast<std::size_t>(level - noise.lowest())];
}

}  // namespace

TEST_CASE("many starts: the resolvent of functions of the noise is that of its chain",
          "[parallel]") {
  for (const auto& s : samples()) {
    Discretised made(s);
    const auto& process = made.systems.process();
    const int plus = process.exit_level(true), minus = process.exit_level(false);
    for (double lambda : {1e-5, 0.3, 20.0}) {
      const auto r = quantities::resolvent(made.systems, lambda, observables({"x", "x^2", "1"}));
      const auto x = of_noise(process.noise, lambda, [](double v) { return v; }),
                 square = of_noise(process.noise, lambda, [](double v) { return v * v; });
      INFO("lambda " << lambda << " bias " << s.bias);
      for (const auto& [found, known] : {std::pair{&r.of[0], &x}, {&r.of[1], &square}}) {
        // Terms of the size of 1/lambda cancel where the mean of f is small.
        const double rounding = 2e-15 / lambda;
        for (const auto& [u, level] : {std::pair{&found->u, plus}, {&found->u_from_minus, minus}}) {
          const double right = at_level(process.noise, *known, level);
          CHECK(std::abs(u->value - right) < rounding + 1e-10 * std::abs(right));
        }
      }
      CHECK(relative_difference(r.of[2].u.value, 1 / lambda) < 1e-13);
      CHECK(relative_difference(r.of[2].pi_lambda.value, 1) < 1e-13);
      CHECK(std::abs(r.of[2].mu_lambda.value) < 1e-13);
      for (const auto& exits : {r.from_plus, r.from_minus}) {
        CHECK(std::abs(1 - exits.h_plus.value - exits.h_minus.value - lambda * exits.w_one.value) <
              1e-11);
      }
    }
  }
}

// Solved for on all states, with the static ones, where nothing is known of starts.
TEST_CASE("many starts: the resolvent is that of the whole process", "[real]") {
  const auto f = observables({"v^2", "stick", "v", "x*v+v"});
  for (const auto& s : samples()) {
    Discretised made(s);
    for (double lambda : {1e-3, 0.5, 30.0}) {
      const auto r = quantities::resolvent(made.systems, lambda, f);
      auto& whole =
          made.systems.at(lambda, generator::Symmetry::none, generator::StaticPhase::kept);
      for (std::size_t n = 0; n < f.size(); ++n) {
        const auto u = whole.factors().solve(whole.a().values(f[n].value));
        INFO(f[n].name << " at " << lambda << " with bias " << s.bias);
        const double plus = quantities::value_of(whole.a().trace_at_exit(), u).value,
                     minus = quantities::value_of(
                                 whole.a().trace_at_exit(generator::Branch::negative), u)
                                 .value;
        CHECK(std::abs(r.of[n].u.value - plus) < 1e-9 * (std::abs(plus) + 1));
        CHECK(std::abs(r.of[n].u_from_minus.value - minus) < 1e-9 * (std::abs(minus) + 1));
      }
    }
  }
}

TEST_CASE("many starts: at lambda = 0 the resolvent is that of small lambda", "[real]") {
  const auto f = observables({"stick", "v^2", "x*v+v"});
  for (const auto& s : samples()) {
    Discretised made(s);
    const quantities::StationaryDistribution distribution(made.systems);
    Results known;
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
TEST_CASE("many starts: levels with two states each give what they give with one", "[real]") {
  auto weak = test::scene(1, 0.3, 1, 0.5, {1, 0});
  weak.noise_levels = 5;
  for (double bias : {0.0, 0.2}) {
    weak.bias = bias;
    const auto twice = test::with_table(weak, test::twice(weak.meant().noise, 0.3));
    REQUIRE(twice.meant().starts().size() == 4);
    const auto f = observables({"v^2", "stick", "v", "x*v+v", "abs(v)"});
    Discretised one(weak), two(twice);
    for (double lambda : {0.0, 0.4, 50.0}) {
      const auto known = quantities::resolvent(one.systems, lambda, f),
                 found = quantities::resolvent(two.systems, lambda, f);
      INFO("lambda " << lambda << " bias " << bias);
      const auto same = [&](Uncertain a, Uncertain b) {
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
TEST_CASE("many starts: discounted starts satisfy their equations, with errors to scale") {
  const std::vector<std::vector<double>> h{{0.1, 0.3, 0.2}, {0.05, 0.2, 0.4}, {0.3, 0.1, 0.15}};
  const double lambda = 0.4;
  const std::vector<double> f{0.7, -0.2, 1.5};
  const auto made = [&](double error) {
    std::vector<Uncertain> w, values;
    std::vector<std::vector<Uncertain>> steps(3);
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
  std::vector<std::vector<Uncertain>> steps(3);
  for (std::size_t t = 0; t < 3; ++t) {
    for (double p : moved[t]) steps[t].push_back({p, 0});
  }
  const quantities::DiscountedStarts other(lambda, w, steps);
  CHECK(std::abs(other.mean(values).value - mean.value) <= mean.error);
  for (std::size_t t = 0; t < 3; ++t) {
    CHECK(std::abs(other.apart(values)[t].value - mu[t].value) <= mu[t].error);
  }
}

namespace {

std::map<std::string, quantities::Result> by_route(const model::Scene& s, Route route,
                                                   const std::set<Quantity>& quantities,
                                                   const std::vector<double>& lambda = {}) {
  cases::Case c;
  c.scene = s;
  c.method.route = route;
  c.question.quantities = quantities;
  c.question.accuracy = 1e-8;
  c.question.lambda = lambda;
  if (route == Route::fluid_queue) c.method.scheme = cases::Scheme::none;
  linalg::SolverStatistics statistics;
  const auto d = route == Route::fluid_queue ? test::Discrete{s.meant(), nullptr}
                                             : test::on_hp(s, kDegree, 1e-13);
  std::map<std::string, quantities::Result> all;
  for (auto& r : run::evaluate({PETSC_COMM_WORLD, c, d, statistics}).results) {
    all[r.key] = std::move(r);
  }
  return all;
}

}  // namespace

TEST_CASE("many starts: hitting times give what excursions give", "[real]") {
  auto all = samples();
  all.push_back(test::with_table(kPlain, test::sine_and_levels(1.2, 4, 16, 0.5, 1, 0.7, 4)));
  for (const auto& s : all) {
    const auto known = by_route(s, Route::excursion, {Quantity::sticking}),
               found = by_route(s, Route::hitting, {Quantity::sticking});
    CHECK(found.size() == 5);
    for (const auto& [key, r] : found) {
      INFO(key);
      CHECK(relative_difference(r.value[0], known.at(key).value[0]) < 1e-10);
      CHECK(r.error[0] < 1e-10 * r.value[0]);
    }
  }
}

// Psi of the queue has nothing in common with elements in v, which see no speeds beyond theirs.
TEST_CASE("many starts: without drag excursions agree with the fluid queue", "[real]") {
  const auto without_drag = test::scene(1, 0.6, 1, 1, {0, 0});
  auto weak = test::scene(1, 0.5, 1, 0.5, {0, 0});  // with states at the force mu_d
  weak.noise_levels = 6;
  const auto five = test::with_table(without_drag, test::five_states());
  // Two states at that force which are not alike, and jump to one another.
  const model::LevelTable still({-2, -0.7, 0, 0.6, 0.6, 2}, {{0, 1, 2},
                                                             {1, 0, 0.3},
                                                             {1, 2, 1},
                                                             {2, 3, 0.7},
                                                             {3, 4, 0.5},
                                                             {3, 1, 0.2},
                                                             {4, 3, 1.2},
                                                             {4, 5, 0.3},
                                                             {5, 4, 2},
                                                             {5, 0, 0.1}});
  const std::set<Quantity> quantities{Quantity::sticking, Quantity::moments, Quantity::entry_law,
                                      Quantity::laplace, Quantity::noise_law};
  for (const auto& s : {five, biased(five), sine({0, 0}),
                        test::with_table(weak, test::twice(weak.meant().noise, 0.3)),
                        test::with_table(without_drag, still)}) {
    auto found = by_route(s, Route::excursion, quantities, {0, 0.1, 3});
    const auto known = by_route(s, Route::fluid_queue, quantities, {0, 0.1, 3});
    const auto process = s.meant();
    const auto& noise = process.noise;
    const auto moments = model::noise_moments(noise, noise.first_from(-s.friction.mu_s),
                                              noise.last_up_to(s.friction.mu_s));
    found["E_X2"].value = {moments.square};
    found["P_X_le_mu_s"].value = {moments.within};
    CHECK(known.size() > 12);
    for (const auto& [key, exact] : known) {
      if (key.starts_with("var_")) continue;
      INFO(key);
      REQUIRE(found.contains(key));
      const auto& values = found.at(key).value;
      REQUIRE(values.size() == exact.value.size());
      for (std::size_t n = 0; n < values.size(); ++n) {
        INFO(key << " number " << n << " bias " << s.bias);
        CHECK(std::abs(values[n] - exact.value[n]) < 1e-8 * (std::abs(exact.value[n]) + 1e-3));
        CHECK(exact.error[n] <= 1e-10 * (std::abs(exact.value[n]) + 1));
      }
    }
  }
}

namespace {

std::map<std::string, double> scalars(const model::Scene& s) {
  const test::Solved solved(test::on_hp(s, kDegree));
  Results results;
  quantities::append_sticking(solved.distribution.excursion(), results);
  quantities::append_moments(solved.distribution.discretisation(), solved.distribution.excursion(),
                             results);
  std::map<std::string, double> all;
  for (const auto& r : results) all[r.key] = r.value[0];
  return all;
}

std::map<std::string, Uncertain> derivatives(const model::Scene& s) {
  test::Solved solved(test::on_hp(s, kDegree));
  const quantities::Sensitivity sensitivity(solved.systems, solved.distribution,
                                            effects::derivatives_of(s));
  Results results;
  sensitivity.append_sticking(results);
  sensitivity.append_moments(results);
  std::map<std::string, Uncertain> all;
  for (const auto& r : results) all[r.key] = {r.value[0], r.error[0]};
  return all;
}

}  // namespace

TEST_CASE("many starts: derivatives agree with extrapolated differences", "[real]") {
  for (const auto& s : samples()) {
    const auto found = derivatives(s);
    const auto changed = [&](bool friction, double by) {
      auto other = s;
      (friction ? other.friction.mu_d : other.drag.linear) += by;
      return scalars(other);
    };
    for (bool friction : {true, false}) {
      const double h = 0.004;
      const auto up = changed(friction, h), down = changed(friction, -h),
                 upper = changed(friction, h / 2), lower = changed(friction, -h / 2);
      for (const auto& [key, value] : up) {
        const double coarse = (value - down.at(key)) / (2 * h),
                     fine = (upper.at(key) - lower.at(key)) / h;
        const std::string name = "d" + key + (friction ? "_dmu_d" : "_ddrag_coefficient");
        const auto by_adjoints = found.find(name);
        const double exact = by_adjoints == found.end() ? 0 : by_adjoints->second.value;
        INFO(name << " with bias " << s.bias);
        CHECK(std::abs(exact - (4 * fine - coarse) / 3) < 1e-6 * (std::abs(exact) + 0.01));
      }
    }
  }
}

TEST_CASE("many starts: derivatives with two states a level are those with one", "[real]") {
  auto weak = test::scene(1, 0.3, 1, 0.5, {1, 0});
  weak.noise_levels = 5;
  for (double bias : {0.0, 0.2}) {
    weak.bias = bias;
    const auto known = derivatives(weak),
               found = derivatives(test::with_table(weak, test::twice(weak.meant().noise, 0.3)));
    for (const auto& [key, d] : found) {
      if (bias == 0 && key.starts_with("dE_V_")) continue;  // that is 0 by symmetry there
      INFO(key << " bias " << bias);
      CHECK(std::abs(d.value - known.at(key).value) < 1e-10 * (std::abs(d.value) + 0.01));
      CHECK(d.error < 1e-10);
    }
  }
}
