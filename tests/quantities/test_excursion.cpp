#include <cmath>
#include <limits>

#include "../common/catch.hpp"
#include "stickslip/model/noise_chain.hpp"
#include "stickslip/quantities/excursion.hpp"

using namespace stickslip;
using quantities::Excursion;
using quantities::Results;

namespace {

// Levels -3 ... 3 of half a unit, of which -2 ... 2 lie within mu_s; a bias moves what sticks.
model::Process process(double bias = 0) { return {{1, 0.5, 3}, {1.1, 0.25}, {1, 0}, bias}; }
generator::Discretisation on_levels(double bias = 0) { return {process(bias), nullptr}; }

Excursion by_hand() {
  Excursion e;
  e.slide_time = {1, 2, 3, 4, 5, 6, 7};
  e.slide_distance = {0.5, 0.25, 0.125, 1, 2, 3, 4};
  e.slide_square = {1, 1, 1, 1, 1, 1, 2};
  e.stick_time = {10, 20, 30, 20, 10};
  return e;
}

// Of levels beyond +-2.
double beyond() { return model::noise_moments(process().noise, -2, 2).beyond; }

}  // namespace

TEST_CASE("excursion: the time beyond mu_s is compared with its known share") {
  Excursion e = by_hand();  // 118 in all, 1 + 7 of it beyond
  CHECK(e.conservation_defect(on_levels()) == Approx(std::abs(8 / (118 * beyond()) - 1)));
  e.lost_probability = -0.1;  // counts by its square
  CHECK(e.conservation_defect(on_levels()) == Approx(std::abs(8 / (118 * beyond()) - 1) + 0.01));
  // Exactly met.
  e.lost_probability = 0;
  e.slide_time = {0, 0, 0, 0, 0, 0, 90 * beyond() / (1 - beyond())};
  CHECK(e.conservation_defect(on_levels()) < 1e-14);
}

TEST_CASE("excursion: with a bias levels that stick do not count, on both velocity branches") {
  const auto inclined = process(0.5);  // levels -3 ... 1 stick
  REQUIRE(inclined.lowest_static() == -3);
  REQUIRE(inclined.highest_static() == 1);
  const double above = model::noise_moments(inclined.noise, -3, 1).beyond;
  Excursion e = by_hand();                                              // 118 in all
  e.slide_time.insert(e.slide_time.end(), {0.25, 0.5, 1, 0, 0, 0, 8});  // 9.75 on 3, 2, 1 ... -3
  CHECK(e.conservation_defect(on_levels(0.5)) ==
        Approx(std::abs((6 + 7 + 0.25 + 0.5) / (127.75 * above) - 1)));
  const auto declined = process(-0.5);  // -1 ... 3
  REQUIRE(declined.highest_static() == 3);
  CHECK(e.conservation_defect(on_levels(-0.5)) ==
        Approx(std::abs((1 + 2 + 8) / (127.75 * above) - 1)));
}

TEST_CASE("excursion: a drift is a difference, exact to the size of E|V|") {
  Excursion e = by_hand();
  Results symmetry_reduced, both;
  quantities::append_moments(on_levels(), e, symmetry_reduced);
  CHECK(symmetry_reduced.back().value[0] == 0);
  CHECK(symmetry_reduced.back().error[0] == 0);
  e.slide_distance.insert(e.slide_distance.end(), {0.5, 0, 0, 10, 0, 0, 1});
  quantities::append_moments(on_levels(0.5), e, both);
  CHECK(both.back().value[0] == Approx((10.875 - 11.5) / 118));
  CHECK(both.back().error[0] == Approx(e.conservation_defect(on_levels(0.5)) * 22.375 / 118));
}

TEST_CASE("excursion: closed forms of the noise have the rounding of its sums") {
  Results results;
  quantities::append_noise_distribution(process(), results);
  const double rounding = model::rounding_of_sums(process().noise);
  CHECK(rounding >= std::numeric_limits<double>::epsilon());
  for (const auto& r : results) CHECK(r.error[0] == Approx(rounding * r.value[0]));
}

// The levels -2 ... 1 stick; Lambda = 8, and the rate of the way out is 3.5 above and 3 below.
TEST_CASE("excursion: sticking phases end at once from the level at either end, at its own rate") {
  CHECK(quantities::stick_density_at_zero(process(0.2), {0.5, 0.1, 0.15, 0.25}) ==
        Approx(0.5 * 3 + 0.25 * 3.5));
}

TEST_CASE("excursion: what excursions from either side lose counts by its share") {
  for (const auto& [plus, minus] : {std::pair{-3e-9, 1e-9}, {1e-9, -3e-9}}) {
    Excursion up = by_hand(), down = by_hand();
    up.lost_probability = plus;
    down.lost_probability = minus;
    CHECK(quantities::joined(process(), {{9, -9}, {0.5, 0.5}, {}}, {up, down}).lost_probability ==
          Approx(2e-9));
  }
}
