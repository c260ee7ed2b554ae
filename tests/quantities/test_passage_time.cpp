#include "../common/catch.hpp"
#include "../common/passages.hpp"
#include "../common/solved.hpp"
#include "stickslip/linalg/vectors.hpp"
#include "stickslip/quantities/passages.hpp"

using namespace stickslip;
using generator::StaticPhase;
using generator::Symmetry;
using model::Passage;
using model::Start;
using test::passage_key;
using test::passing;
using test::Solved;

namespace {

model::Scene passing_by_direction() { return test::by_direction(passing(0.2)); }

quantities::PassageTime time_of(Solved& solved, Passage passage, double w, const Start& start) {
  return quantities::passage_time(solved.systems, passage_key(solved.systems.process(), passage, w),
                                  start);
}

constexpr Passage kPassages[] = {Passage::both, Passage::up, Passage::down};
const Start kRest{0, 0, Start::Kind::rest}, kStationary{0, 0, Start::Kind::stationary};

}  // namespace

// Renewal and squared jumps against two backward equations with the sticking phase as unknowns.
TEST_CASE("passage time: both moments solve their backward equations", "[parallel]") {
  for (const auto& s : {passing(), passing_by_direction()}) {
    for (const auto& d : {test::on_hp(s, 8), test::on_nodes(s, 7, 3), test::on_upwind(s, 4)}) {
      Solved solved(d);
      for (const Passage passage : kPassages) {
        auto key = passage_key(solved.systems.process(), passage, 0.3);
        key.static_phase = StaticPhase::kept;
        auto& whole = solved.systems.at(key);
        const auto& a = whole.a();
        const auto time = whole.factors().solve(a.values([](double, double, double) { return 2; }));
        const auto square = whole.factors().solve(time.x);
        const auto compare = [&](const Start& start, Vec from, double tolerance) {
          const double mean = linalg::dot(from, time.x) / 2, second = linalg::dot(from, square.x);
          const auto found = time_of(solved, passage, 0.3, start);
          CHECK(found.mean.value == Approx(mean).epsilon(1e-9));
          CHECK(found.variance.value == Approx(second - mean * mean).epsilon(tolerance));
        };
        const auto& noise = solved.systems.process().noise;
        const auto on = [&](int level, double v) {
          return a.mean_at(model::levels_at(noise, {.level = level, .v = v}), v);
        };
        const auto p = model::stationary_distribution(noise);
        compare(kRest, a.mean_at(p), 1e-8);
        compare({1, 0}, on(1, 0), 1e-8);
        if (!d.velocities->keeps_origin()) {  // squares of what is interpolated
          compare({2, 0.1}, on(2, 0.1), 0.02);
          compare({-3, -0.2}, on(-3, -0.2), 0.02);
        }
        solved.systems.keep({});
      }
    }
  }
}

// By the masses of the discretisation without killing.
TEST_CASE("passage time: a stationary start is the mean over all states") {
  for (const auto& s : {passing(), passing_by_direction()}) {
    Solved solved(test::on_hp(s, 9));
    for (const Passage passage : kPassages) {
      const double w = 0.4;
      generator::Systems split(PETSC_COMM_WORLD,
                               solved.systems.discretisation().cut_at(w, true, std::nullopt),
                               solved.statistics);
      const quantities::StationaryDistribution law(split);
      auto key = passage_key(solved.systems.process(), Passage::both, w);
      key.passage = passage;
      key.symmetry = generator::symmetry_of(solved.systems.process());
      if (passage != Passage::both && key.symmetry == Symmetry::even) continue;
      key.static_phase = StaticPhase::kept;
      auto& whole = solved.systems.at(key);
      const auto inside = whole.a().values(
          [&](double, double, double v) { return model::has_passed(passage, v, w) ? 0.0 : 1.0; });
      const auto time =
          whole.factors().solve(whole.a().values([](double, double, double) { return 1; }));
      const auto square = whole.factors().solve(time.x);
      const auto law_inside = law.occupation_on(whole.a());
      linalg::check(VecPointwiseMult(law_inside, law_inside, inside));
      const double total = law.excursion().mean_excursion(),
                   mean = linalg::dot(law_inside, time.x) / total,
                   second = 2 * linalg::dot(law_inside, square.x) / total;
      const auto found = time_of(solved, passage, w, kStationary);
      CHECK(found.mean.value == Approx(mean).epsilon(1e-9));
      CHECK(found.variance.value == Approx(second - mean * mean).epsilon(1e-7));
    }
  }
}

TEST_CASE("passage time: symmetric bodies pass either side alike, and as nearly symmetric ones") {
  Solved symmetric(test::on_hp(passing(), 9)), nearly(test::on_hp(passing(1e-300), 9));
  for (const auto& start : {kRest, kStationary}) {
    const auto up = time_of(symmetric, Passage::up, 0.4, start),
               down = time_of(symmetric, Passage::down, 0.4, start),
               both = time_of(symmetric, Passage::both, 0.4, start),
               other = time_of(nearly, Passage::both, 0.4, start),
               rising = time_of(nearly, Passage::up, 0.4, start);
    CHECK(up.mean.value == Approx(down.mean.value).epsilon(1e-9));
    CHECK(up.variance.value == Approx(down.variance.value).epsilon(1e-9));
    CHECK(both.mean.value == Approx(other.mean.value).epsilon(1e-9));
    CHECK(both.variance.value == Approx(other.variance.value).epsilon(1e-9));
    CHECK(up.mean.value == Approx(rising.mean.value).epsilon(1e-9));
    CHECK(both.mean.value < 0.9 * up.mean.value);
  }
}

// A body that is pushed on meets the speed after the distance by the acceleration.
TEST_CASE("passage time: hardly any from just below the speed") {
  Solved solved(test::on_hp(passing(), 9));
  const auto& process = solved.systems.process();
  const int level = process.noise.highest();
  const double w = 0.3, force = process.net_force(level) + process.drag(w);
  for (double below : {1e-3, 1e-5}) {
    const auto time = time_of(solved, Passage::up, w, {level, w - below});
    CHECK(time.mean.value == Approx(below / force).epsilon(0.02 + 20 * below));
    CHECK(time.variance.value < below);
  }
}
