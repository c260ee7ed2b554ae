#include <cmath>

#include "../common/catch.hpp"
#include "../common/chains.hpp"
#include "../common/passages.hpp"
#include "../common/solved.hpp"
#include "../common/tallies.hpp"
#include "stickslip/case/passage_rows.hpp"
#include "stickslip/linalg/vectors.hpp"
#include "stickslip/quantities/passages.hpp"
#include "stickslip/simulation/tally.hpp"

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

simulation::Tally simulated(const model::Process& process, const cases::Question& question,
                            int count) {
  simulation::Sampler sampler(question, process);
  simulation::Tally all(question, process);
  for (int batch = 0; batch * 1000 < count; ++batch) {
    all.merge(sampler.batch(1, static_cast<std::uint64_t>(batch), 1000).pack());
  }
  return all;
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
        const auto p = model::stationary_distribution(solved.systems.process().noise);
        compare(kRest, a.mean_at_zero(p), 1e-8);
        compare({1, 0}, a.value_at(1, 0), 1e-8);
        if (!d.velocities->keeps_origin()) {  // squares of what is interpolated
          compare({2, 0.1}, a.value_at(2, 0.1), 0.02);
          compare({-3, -0.2}, a.value_at(-3, -0.2), 0.02);
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
                               solved.systems.discretisation().passing(w, std::nullopt),
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

TEST_CASE("passage time: up is down in the mirror") {
  Solved there(test::on_hp(passing(0.3), 9)), back(test::on_hp(passing(-0.3), 9));
  for (const auto& [start, mirrored] :
       {std::pair{kRest, kRest}, {kStationary, kStationary}, {Start{3, 0.2}, Start{-3, -0.2}}}) {
    const auto up = time_of(there, Passage::up, 0.5, start),
               down = time_of(back, Passage::down, 0.5, mirrored);
    CHECK(up.mean.value == Approx(down.mean.value).epsilon(1e-9));
    CHECK(up.variance.value == Approx(down.variance.value).epsilon(1e-9));
    const auto other = time_of(there, Passage::down, 0.5, start);
    CHECK(up.mean.value < 0.9 * other.mean.value);
    CHECK(time_of(there, Passage::both, 0.5, start).mean.value < up.mean.value);
  }
}

TEST_CASE("passage time: from rest as first passages of peaks") {
  Solved solved(test::on_hp(passing_by_direction(), 9));
  for (double w : {0.02, 0.3, 1.0}) {
    const auto known = quantities::first_passage(solved.systems, solved.distribution.starts(), w);
    CHECK(time_of(solved, Passage::both, w, kRest).mean.value ==
          Approx(known.from_rest.value).epsilon(1e-7));
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

TEST_CASE("passage time: as simulated from every start", "[real][long]") {
  auto any = passing(0.25);
  any.noise.name = "chain";
  any.noise.table = std::make_shared<const model::LevelTable>(test::five_states());
  int turn = 0;  // each start with each passage once
  for (const auto& s : {test::on_full_noise(passing()), test::on_full_noise(passing(0.3)), any}) {
    ++turn;
    Solved solved(test::on_hp(s, 10));
    const auto& process = solved.systems.process();
    for (const Passage passage : kPassages) {
      const Start starts[] = {kRest, kStationary, Start{process.lowest_static() - 1, -0.1}};
      const auto& start = starts[(static_cast<int>(passage) + turn) % 3];
      const cases::Question question{.quantities = {cases::kFirstPassageTime.quantity},
                                     .velocity = {0.4, 0.2},
                                     .start = start,
                                     .passage = passage};
      const auto tally = simulated(process, question, 20000);
      for (std::size_t n : {0, 1}) {
        const auto found = time_of(solved, passage, question.velocity[n], start);
        const auto holds = [&](const char* key, double value) {
          const auto e = test::estimate(tally, key, n);
          return std::abs(e.value - value) < 4.5 / 1.96 * (e.high - e.value);
        };
        INFO("bias " << s.bias << ", passage " << static_cast<int>(passage) << ", start "
                     << static_cast<int>(start.kind) << ", w " << question.velocity[n]);
        CHECK(holds("first_passage_mean", found.mean.value));
        CHECK(holds("first_passage_variance", found.variance.value));
      }
    }
  }
}

// mu_s = mu_d = 1 in white noise: exp(w) - 1 - w, and corrections of order tau^(1/2).
TEST_CASE("passage time: tends to that in white noise", "[slow]") {
  const auto missed = [](double tau, double w) {
    const auto s = test::scene(1, 1, tau, 0.5 / std::sqrt(tau), {0, 0});
    Solved solved(test::on_hp(s, 8));
    return time_of(solved, Passage::both, w, kRest).mean.value / (std::exp(w) - 1 - w) - 1;
  };
  const double coarse = missed(0.01, 2), fine = missed(0.0025, 2);
  CHECK(coarse > 0);
  CHECK(coarse / fine == Approx(2).margin(0.3));
}
