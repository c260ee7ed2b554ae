#include <cmath>

#include "../common/catch.hpp"
#include "../common/scenes.hpp"
#include "../common/values.hpp"
#include "stickslip/case/displacement_rows.hpp"
#include "stickslip/run/carry_out.hpp"

using namespace stickslip;
using test::values_at_the_time;
using Kind = model::Start::Kind;

namespace {

const model::Start kStationary{0, 0, Kind::stationary}, kRest{0, 0, Kind::rest};

cases::Case asking(const model::Scene& s, const std::vector<double>& distance, double time,
                   double accuracy, const model::Start& start = kStationary) {
  cases::Case c;
  c.scene = s;
  c.question.quantities = {cases::kDisplacementDistribution.quantity};
  c.question.distance = distance;
  c.question.arguments["probability"] = {0.5, 0.9};
  c.question.time = {time};
  c.question.start = start;
  c.question.accuracy = accuracy;
  // Enough for what is compared, without a search for more digits.
  c.method.degree = 6;
  return c;
}

}  // namespace

// By a dense exponential on Chebyshev points and panels up to k = 80, in another program.
TEST_CASE("displacement distribution: known for telegraph noise", "[real]") {
  const std::vector<double> distance{0.1, 0.3, 1, 2, 4, 6},
      known{0.0311527, 0.0742079, 0.2518320, 0.5053344, 0.8325951, 0.9567325},
      density{0.20597, 0.22692, 0.26692, 0.22929, 0.10310, 0.03398};
  const auto found = values_at_the_time(asking(test::pushed_by_telegraph(), distance, 5, 1e-3));
  const auto &cdf = found.at("displacement_cdf"), &f = found.at("displacement_density");
  for (std::size_t n = 0; n < distance.size(); ++n) {
    INFO(distance[n] << ": " << cdf.value[n] << " +- " << cdf.error[n] << ", density " << f.value[n]
                     << " +- " << f.error[n]);
    CHECK(std::abs(cdf.value[n] - known[n]) <= cdf.error[n] + 1e-6);
    CHECK(cdf.error[n] < 5e-3);
    CHECK(std::abs(f.value[n] - density[n]) <= f.error[n] + 1e-5);
  }
}

// Bodies on the lower level rest until the noise jumps; on the upper one they move at once, with
// the velocity 1.8 (1 - exp(-t/2)).
TEST_CASE("displacement distribution: the atom in closed form", "[real][long]") {
  constexpr double time = 1.5;
  const double left = std::exp(-0.8 * time);
  const auto values_from = [](const std::vector<double>& distance, double t,
                              const model::Start& start) {
    auto c = asking(test::pushed_by_telegraph(), distance, t, 0.15, start);
    c.method.degree = 3;
    return values_at_the_time(c);
  };
  const auto rest = values_from({1}, time, kRest);
  CHECK(rest.at("displacement_atom").value[0] == Approx(left / 2).epsilon(1e-12));
  CHECK(rest.at("displacement_atom_at").value[0] == 0);
  const auto s = test::pushed_by_telegraph();
  const int upper = s.noise.table->highest(), lower = s.noise.table->lowest();
  const auto up = values_from({1}, time, {upper, 0});
  CHECK(up.at("displacement_atom").value[0] == Approx(left).epsilon(1e-12));
  CHECK(up.at("displacement_atom_at").value[0] ==
        Approx(1.8 * (time - 2 * (1 - std::exp(-time / 2)))).epsilon(1e-9));
  // From v = 0.6 with the force -1.5 - v/2 to rest, at the time 2 log(1.2).
  const auto down = values_from({1}, time, {lower, 0.6});
  CHECK(down.at("displacement_atom").value[0] == Approx(left).epsilon(1e-12));
  CHECK(down.at("displacement_atom_at").value[0] ==
        Approx(2 * (0.6 - 3 * std::log(1.2))).epsilon(1e-9));
  // From rest both levels leave an atom: x = 0 with 0.22, 0.38 with as much.
  const auto both = values_from({0.38, 0.39}, 1, kRest);
  const auto& cdf = both.at("displacement_cdf");
  CHECK(std::abs(cdf.value[1] - cdf.value[0] - std::exp(-0.8) / 2) <= cdf.error[0] + cdf.error[1]);
  CHECK(cdf.error[0] + cdf.error[1] < 0.2);
  CHECK(both.at("displacement_quantile").value[1] ==
        Approx(1.8 * (1 - 2 * (1 - std::exp(-0.5)))).epsilon(1e-9));
  // Fewer than 0.9 are above it, more than 0.5.
  CHECK(values_from({1}, 0.1, {lower, 0}).at("displacement_quantile").value[0] == 0);
}

// Forces -1.5, 0.2 and 1.6, each of one state or of two; the highest is left at the rate 1.
TEST_CASE("displacement distribution: noise that is always 0 leaves the atom as it is",
          "[real][long]") {
  const std::vector<double> x{-1.5, 0.2, 1.6};
  const std::vector<model::Transition> jumps{{0, 1, 1}, {1, 0, 0.5}, {1, 2, 0.7}, {2, 1, 1}};
  std::vector<double> doubled;
  std::vector<model::Transition> both{jumps};
  for (std::size_t n = 0; n < 3; ++n) both.push_back({n, n + 3, 0.5});
  for (std::size_t n = 0; n < 3; ++n) both.push_back({n + 3, n, 0.5});
  for (const auto& [from, to, rate] : jumps) both.push_back({from + 3, to + 3, rate});
  for (int copy = 0; copy < 2; ++copy) doubled.insert(doubled.end(), x.begin(), x.end());
  for (const auto& table : {model::LevelTable(x, jumps), model::LevelTable(doubled, both)}) {
    auto s = test::pushed_by_telegraph();
    s.friction = {1, 0.5};
    s.noise.table = std::make_shared<const model::LevelTable>(table);
    const int highest = table.highest();
    for (const auto& start : {model::Start{highest, 0}, model::Start{highest, 0.4}}) {
      auto c = asking(s, {1}, 1, 0.3, start);
      c.method.degree = 3;
      const auto atom = values_at_the_time(c).at("displacement_atom");
      CHECK(atom.value[0] == Approx(std::exp(-1)).epsilon(1e-12));
      CHECK(atom.error[0] < 1e-12);
    }
  }
}

// Whatever the density is, a probability that lies within an atom has its place for a quantile.
// Only one body in 13 meets a jump by that time, and what no jumps leave is less than that.
TEST_CASE("displacement distribution: quantiles at atoms, though the density is not resolved",
          "[real][long]") {
  constexpr double time = 0.1;
  auto c = asking(test::pushed_by_telegraph(), {1e-4, 2e-3}, time, 0.05, kRest);
  c.question.arguments["probability"] = {0.1, 0.35, 0.65, 0.9};
  c.method.degree = 2;
  const auto found = values_at_the_time(c);
  const auto& quantile = found.at("displacement_quantile");
  const double moved = 1.8 * (time - 2 * (1 - std::exp(-time / 2)));
  const double expected[] = {0, 0, moved, moved};
  for (std::size_t n = 0; n < quantile.value.size(); ++n) {
    INFO(quantile.value[n] << " +- " << quantile.error[n]);
    CHECK(quantile.value[n] == Approx(expected[n]).epsilon(1e-9));
    CHECK(quantile.error[n] < 1e-9);
  }
  for (double error : found.at("displacement_cdf").error) {
    CHECK(error <= 2 * (1 - std::exp(-0.8 * time)));
  }
}

TEST_CASE("displacement distribution: its own mirror image with symmetry", "[real]") {
  const auto found =
      values_at_the_time(asking(test::scene(1, 0.5, 1, 0.5, {1, 0}), {-1, -0.2, 0.2, 1}, 2, 1e-2));
  const auto &cdf = found.at("displacement_cdf").value, &f = found.at("displacement_density").value;
  CHECK(cdf[3] == 1 - cdf[0]);
  CHECK(cdf[2] == 1 - cdf[1]);
  CHECK(f[2] == f[1]);
  CHECK(found.at("displacement_quantile").value[0] == 0);
  CHECK(found.at("displacement_quantile").value[1] > 0);
}

// By a dense exponential on Chebyshev points in another program, along another line in the plane of
// z = s + i k; to three or four digits.
TEST_CASE("displacement distribution: tails with an accuracy of their own", "[real]") {
  auto c = asking(test::pushed_by_telegraph(), {4, 7, 7.5, 8}, 5, 1e-2);
  c.question.arguments["probability"] = {0.5, 0.995};
  const auto found = values_at_the_time(c);
  const auto& cdf = found.at("displacement_cdf");
  const std::vector<double> beyond{0.1674049, 0.017230, 0.009315, 0.004061};
  for (std::size_t n = 1; n < beyond.size(); ++n) {
    const double tail = 1 - cdf.value[n];
    INFO(n << ": " << tail << " +- " << cdf.error[n] << " for " << beyond[n]);
    CHECK(std::abs(tail - beyond[n]) <= cdf.error[n] + 3e-3 * beyond[n]);
    CHECK(cdf.error[n] < 2e-2 * tail);
  }
  CHECK(std::abs(1 - cdf.value[0] - beyond[0]) <= cdf.error[0] + 1e-6);
  // Between those of 0.9907 and 0.9959.
  const auto& quantile = found.at("displacement_quantile");
  CHECK(quantile.value[1] > 7.5);
  CHECK(quantile.value[1] < 8);
  CHECK(quantile.error[1] < 0.02);
}

// What is beyond the last weight that the elements resolve has no error estimate; what is within
// has the probability asked for.
TEST_CASE("displacement distribution: quantiles out of reach are said to be unknown",
          "[real][long]") {
  auto c = asking(test::scene(1, 0.5, 1, 0.5, {1, 0}), {}, 2, 0.1, kRest);
  c.method.degree = 5;
  c.question.arguments["probability"] = {1e-3, 1e-11};
  const auto quantile = values_at_the_time(c).at("displacement_quantile");
  CHECK(std::isinf(quantile.error[1]));
  CHECK(quantile.error[0] < 0.2);
  c.question.distance = {quantile.value[0]};
  const auto cdf = values_at_the_time(c).at("displacement_cdf");
  CHECK(std::abs(cdf.value[0] - 1e-3) <= cdf.error[0]);
}

// Bodies that start with a velocity come to rest first, and short slips begin there.
TEST_CASE("displacement distribution: simulated, within 4.5 sigma", "[real][long]") {
  for (const model::Start& start : {kStationary, kRest, model::Start{0, 1}}) {
    const bool stationary = start.kind == Kind::stationary;
    const auto scene =
        stationary ? test::pushed_by_telegraph() : test::scene(1, 0.5, 1, 0.5, {1, 0});
    auto c = asking(scene, {-0.4, 0.05, 0.6, 1.5}, 2, 3e-2, start);
    c.question.arguments["probability"] = {0.1, 0.4, 0.9};
    const auto found = values_at_the_time(c);
    c.method.degree.reset();
    c.method.route = cases::Route::monte_carlo;
    c.method.excursions = 20000;
    const auto sampled = values_at_the_time(c);
    const auto &cdf = found.at("displacement_cdf"), &r = sampled.at("displacement_cdf");
    for (std::size_t n = 0; n < r.value.size(); ++n) {
      const double sigma = test::sigma(r, n);
      INFO(n << ": " << r.value[n] << " +- " << sigma << ", " << cdf.value[n]);
      CHECK(std::abs(r.value[n] - cdf.value[n]) <= 4.5 * sigma + cdf.error[n]);
      CHECK(sigma < 0.01);
      CHECK(cdf.error[n] < 0.5);
    }
    const auto &quantile = found.at("displacement_quantile"),
               &of_paths = sampled.at("displacement_quantile");
    for (std::size_t n = 0; n < quantile.value.size(); ++n) {
      const double sigma = test::sigma(of_paths, n);
      INFO(n << ": " << of_paths.value[n] << " +- " << sigma << ", " << quantile.value[n] << " +- "
             << quantile.error[n]);
      CHECK(std::abs(of_paths.value[n] - quantile.value[n]) <= 4.5 * sigma + quantile.error[n]);
      CHECK(sigma < 0.04);
      CHECK(quantile.error[n] < 0.1);
    }
  }
}

// From rest without drag: bodies have the velocity 0.3 on average until the time, and 8 in the end.
TEST_CASE("displacement distribution: speeds that are not reached by the time cost nothing",
          "[real]") {
  auto c = asking(test::biased(test::scene(1, 0.4657, 1.518, 0.4657, {0, 0}), 0.0734), {}, 1.102,
                  2e-2, kRest);
  c.method.degree = 3;
  const auto total = run::carry_out(PETSC_COMM_WORLD, c, {}).total;
  INFO(total.solves << " solves with " << total.factorizations_complex << " complex factors");
  CHECK(total.factorizations_complex > 10);
  CHECK(total.solves < 40 * total.factorizations_complex);
}

// Over a short time densities have edges, and distribution functions oscillate within their errors.
TEST_CASE("displacement distribution: quantiles lie within their errors, as far as is known",
          "[real][long]") {
  auto c = asking(test::pushed_by_telegraph(), {}, 0.5, 3e-2);
  c.method.degree = 4;
  c.question.arguments["probability"] = {0.7, 0.8, 0.9, 0.95};
  const auto& p = c.question.arguments.at("probability");
  const auto quantile = values_at_the_time(c).at("displacement_quantile");
  for (std::size_t n = 0; n < p.size(); ++n) {
    const double d = quantile.value[n], away = 1.01 * quantile.error[n];
    c.question.distance = {d + away, d + 2 * away, d - away, d - 2 * away};
    const auto cdf = values_at_the_time(c).at("displacement_cdf");
    for (std::size_t m = 0; m < 4; ++m) {
      INFO(p[n] << ": " << d << " +- " << quantile.error[n] << ", " << c.question.distance[m]
                << " has " << cdf.value[m] << " +- " << cdf.error[m]);
      CHECK((m < 2 ? 1 : -1) * (cdf.value[m] - p[n]) > cdf.error[m]);
    }
  }
}
