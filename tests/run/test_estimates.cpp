#include <cmath>

#include "../common/catch.hpp"
#include "../common/made_results.hpp"
#include "stickslip/case/sticking_rows.hpp"
#include "stickslip/run/estimates.hpp"

using namespace stickslip;
using quantities::array;
using quantities::Kind;
using quantities::Result;
using quantities::Results;
using quantities::scalar;
using run::add_discretisation;
using run::Changes;

namespace {

constexpr double kShared = 0.65;

Result modes(std::vector<double> values, std::vector<double> errors) {
  Result r = test::array("relaxation_odd", "1/time", "mode", {1, 2, 3});
  r.value = std::move(values);
  r.error = std::move(errors);
  return r;
}

std::vector<double> errors(const Results& results) {
  std::vector<double> all;
  for (const auto& r : results) all.insert(all.end(), r.error.begin(), r.error.end());
  return all;
}

void check_errors(const Results& results, const std::vector<double>& expected) {
  const auto found = errors(results);
  REQUIRE(found.size() == expected.size());
  for (std::size_t n = 0; n < found.size(); ++n) {
    INFO("error " << n);
    CHECK(found[n] == Approx(expected[n]).epsilon(1e-12));
  }
}

}  // namespace

TEST_CASE("estimates: rounding and truncation make the least error, of every entry") {
  Results results{test::scalar("a", "", -2, 0), test::scalar("b", "", 3, 1),
                  modes({1, -4, 0}, {0, 5, 6})};
  run::require_least_error(0.25, results);
  check_errors(results, {0.5, 1, 0.25, 5, 6});
}

TEST_CASE("estimates: two changes are added as one length, each by its factor") {
  const Results coarse{test::scalar("f", "", 3, 9), modes({1, 2}, {9, 9})};
  Results results{test::scalar("f", "", 1, 0.5), modes({2, 2.5, 7}, {0, 0.25, 0})};
  const Changes before{{16}, {0, 4}};
  const Changes changes = add_discretisation({3, 0.5}, coarse, before, results);
  check_errors(results, {0.5 + 10, 3, 0.25 + 2.5, 21});
  CHECK(changes == Changes{{2}, {1, 0.5, 7}});  // the third mode is new, and all change
}

TEST_CASE("estimates: what shares no errors with means has a factor of its own") {
  const Results coarse{scalar(cases::kFStick0, 3, 9), scalar(cases::kEX2, 3, 9)};
  Results results{scalar(cases::kFStick0, 1, 0), scalar(cases::kEX2, 1, 0)};
  (void)add_discretisation({3, 0.5, 4}, coarse, {{16}, {16}}, results);
  check_errors(results, {40, std::hypot(10, 6.5)});
}

TEST_CASE("estimates: values of a spectrum that may have waves change unevenly") {
  Result spectrum = test::array("S_v", "velocity^2 time", "omega", {1, 2});
  spectrum.kind = Kind::spectrum;
  spectrum.value = {8, 8};
  spectrum.error = {0, 0};
  Results results{spectrum};
  Results coarse = results;
  coarse[0].value = {9, 8};
  run::ErrorPerChange factor{
      .last = 3, .earlier = 0.5, .alone = 4, .of_waves = 1.5, .waves_from = 1};
  (void)add_discretisation(factor, coarse, {{16, 0}}, results);
  const double error = 1.5 * 4 * std::hypot(3, 0.6 * 16);
  check_errors(results, {error, 0.7 * error});
  factor.waves_from = 1.5;
  (void)add_discretisation(factor, coarse, {{16, 0}}, results = {spectrum});
  check_errors(results, {4 * std::hypot(3, 8), 0.7 * 4 * std::hypot(3, 8)});
}

TEST_CASE("estimates: without an earlier change the last one counts alone") {
  Results results{test::scalar("f", "", 1, 0.5)};
  (void)add_discretisation({3, 0.5}, {test::scalar("f", "", 3, 9)}, {}, results);
  check_errors(results, {6.5});
}

namespace {

// Results after changes by such amounts.
Results changed(Results results, const std::vector<double>& amounts, double of_other_family = 0) {
  Results coarse = results;
  for (std::size_t r = 0; r < results.size(); ++r) coarse[r].value[0] += amounts[r];
  (void)add_discretisation({.last = 1, .of_other_family = of_other_family}, coarse, {}, results);
  return results;
}

}  // namespace

TEST_CASE("estimates: a change through zero is no small error, as the other means show") {
  const Results means{scalar(cases::kEXV, 10, 0), scalar(cases::kEV2, 4, 1e-9),
                      scalar(cases::kEAbsV, 2, 0)};
  // Relative changes of 0.3, 1e-12 and 0.4 have the mean square 0.25/3.
  const double shared = kShared * std::sqrt(0.25 / 3);
  check_errors(changed(means, {3, 4e-12, 0.8}),
               {std::hypot(3, 10 * shared), 1e-9 + 4 * shared, std::hypot(0.8, 2 * shared)});
}

TEST_CASE("estimates: where errors of means fall too fast, changes were small by accident") {
  constexpr double small = 0x1p-20;
  const Results coarse{scalar(cases::kEV2, 4, 1), scalar(cases::kEAbsV, 2, 0),
                       scalar(cases::kPStick, 0.5, 2), scalar(cases::kFStick0, 1, 1)};
  const Results means{scalar(cases::kEV2, 4, small), scalar(cases::kEAbsV, 2, 0),
                      scalar(cases::kPStick, 0.5, 0), scalar(cases::kFStick0, 1, 0)};
  Results first = means, second = means;
  (void)add_discretisation({.most_fall = 16}, coarse, {}, first);  // of two, nothing fell yet
  check_errors(first, {small, 0, 0, 0});
  (void)add_discretisation({.most_fall = 16}, coarse, {{0}, {0}, {0}, {0}}, second);
  check_errors(second, {small + 1.0 / 16, 0, 2.0 / 16, 0});
}

TEST_CASE("estimates: durations and functions of the velocity share errors among themselves") {
  const Results means{scalar(cases::kMeanSlide, 10, 0), scalar(cases::kMeanExcursion, 20, 0),
                      scalar(cases::kSlipRate, 0.05, 0), scalar(cases::kEV2, 4, 0),
                      scalar(cases::kEAbsV, 2, 0)};
  // Relative changes of 0.3, 2e-12, 0.4 of durations and rates, and of 2e-12 and 0.5.
  const double of_time = kShared * std::sqrt(0.25 / 3), of_velocity = kShared * std::sqrt(0.25 / 2);
  check_errors(changed(means, {3, 4e-11, 0.02, 8e-12, 1}),
               {std::hypot(3, 10 * of_time), 20 * of_time, std::hypot(0.02, 0.05 * of_time),
                4 * of_velocity, std::hypot(1, 2 * of_velocity)});
}

TEST_CASE("estimates: where all changes of one family vanish, those of the other one count") {
  constexpr double of_other = 0.6;
  const Results means{scalar(cases::kMeanSlide, 10, 0), scalar(cases::kEV2, 4, 0),
                      scalar(cases::kEAbsV, 2, 0)};
  check_errors(changed(means, {3, 8e-12, 4e-12}, of_other),
               {std::hypot(3, 10 * kShared * 0.3), 4 * of_other * kShared * 0.3,
                2 * of_other * kShared * 0.3});
  check_errors(changed(means, {2e-11, 1.2, 0.6}, of_other),
               {10 * of_other * kShared * 0.3, std::hypot(1.2, 4 * kShared * 0.3),
                std::hypot(0.6, 2 * kShared * 0.3)});
}

TEST_CASE("estimates: derivatives take the larger share of both families") {
  Result by_mu_d = test::scalar("dE_V2_dmu_d", "velocity^2/force", -6, 0);
  by_mu_d.kind = Kind::derivative;
  const Results means{scalar(cases::kMeanSlide, 10, 0), scalar(cases::kEV2, 4, 0), by_mu_d};
  Results results = means;
  Results coarse = results;
  coarse[0].value[0] += 3;
  coarse[1].value[0] += 0.4;
  coarse[2].value[0] += 0.5;
  (void)add_discretisation({.last = 1, .alone = 2}, coarse, {}, results);
  check_errors(results, {std::hypot(3, 3 * kShared), std::hypot(0.4, 0.4 * kShared),
                         std::hypot(1.5 * 2 * 0.5, 6 * 1.5 * 2 * 0.3 * kShared)});
}

TEST_CASE("estimates: the drift takes its share of the errors of means, and gives none") {
  constexpr double small = 0x1p-20;
  const Results means{scalar(cases::kEAbsV, -10, 0), scalar(cases::kEV, 0.5, 0),
                      scalar(cases::kFStick0, 1, 0)};
  // A density is no mean.
  check_errors(changed(means, {2, 100, small}),
               {std::hypot(2, 1.3), std::hypot(100, 0.065), small});
  check_errors(changed(means, {2, small, small}),
               {std::hypot(2, 1.3), std::hypot(small, 0.065), small});
  const Results drift{scalar(cases::kEV, 0.5, 0)};
  check_errors(changed(drift, {small}), {small});
}

TEST_CASE("estimates: what changes by less than 1e-13 does not depend on the discretisation") {
  const Results means{scalar(cases::kEAbsV, 8, 0), scalar(cases::kEV2, 1, 0),
                      scalar(cases::kEXV, 1, 0)};
  const double above = 0x1p-43, below = 0x1p-44;  // 1.1e-13 and 0.6e-13
  const double shared = kShared * 0.25 / std::sqrt(3);
  check_errors(changed(means, {2, above, below}), {std::hypot(2, 8 * shared), shared, below});
}

// P_stick = 1/(1 + q), q = mean_slide/mean_stick: dP_stick = P_stick P_slide dq/q.
TEST_CASE("estimates: probabilities of the phases share what their ratio does") {
  const Results shares{scalar(cases::kPStick, 0.2, 0), scalar(cases::kPSlide, 0.8, 0),
                       scalar(cases::kMeanExcursion, 10, 0), scalar(cases::kPWithin, 0.5, 0)};
  const double shared = kShared * 0.5 * 0.16;
  constexpr double small = 0x1p-20;
  check_errors(changed(shares, {small, 1, 5, small}),
               {std::hypot(small, shared), std::hypot(1, shared), std::hypot(5, 3.25), small});
  check_errors(changed(shares, {0, 0.7, 5, 0}),
               {0, std::hypot(0.7, shared), std::hypot(5, 3.25), 0});
}

TEST_CASE("estimates: an entry has 0.7 of the error of its neighbours, and no more than relative") {
  Result curve = test::array("f_stick", "1/time", "time", {1, 2, 3, 4, 5, 6});
  curve.value = {8, 8, -16, 8, 2, 0};
  curve.error.assign(6, 0);
  Results results{curve};
  Results coarse = results;
  const double small = 0x1p-30;
  coarse[0].value[1] += small;
  coarse[0].value[3] += 1;
  (void)add_discretisation({1, 0}, coarse, {}, results);
  check_errors(results, {0.7 * small, 0.7, 0.7, 1, 0.7 / 4, 0});
}

TEST_CASE("estimates: modes keep their own errors") {
  Result array_of_means = modes({1, 2, 3}, {1e-6, 1e-6, 1e-6});
  array_of_means.kind = Kind::mean;
  Results results{scalar(cases::kMeanStick, 10, 0), array_of_means};
  Results coarse = results;
  coarse[0].value[0] = 15;
  (void)add_discretisation({1, 0}, coarse, {}, results);
  check_errors(results, {std::hypot(5, 3.25), 1e-6, 1e-6, 1e-6});
}
