#include <cmath>
#include <limits>

#include "../common/catch.hpp"
#include "../common/made_results.hpp"
#include "stickslip/run/estimates.hpp"

using namespace stickslip;
using cases::Reference;
using quantities::Result;
using quantities::Results;
using run::compare;
using run::Comparison;
using run::Verdict;

namespace {

constexpr double kNormal = 1.959963984540054;

/// A reference with standard deviations `below` and `above`.
Reference reference(double value, double below, double above, std::optional<double> argument = {}) {
  return {"q", argument, value, value - kNormal * below, value + kNormal * above};
}

Comparison one(const Reference& r, double value, double error) {
  return compare({r}, {test::scalar("q", "", value, error)});
}

/// References with one standard deviation, and results `z` away from them.
Comparison judged(const std::vector<double>& z) {
  Result result = test::array("q", "", "omega", {});
  std::vector<Reference> references;
  for (std::size_t n = 0; n < z.size(); ++n) {
    const auto at = static_cast<double>(n);
    result.abscissa.push_back(at);
    result.value.push_back(10 + z[n]);
    result.error.push_back(0);
    references.push_back(reference(10, 1, 1, at));
  }
  return compare(references, {result});
}

std::vector<Verdict> verdicts(const Comparison& c) {
  std::vector<Verdict> all;
  for (const auto& row : c.rows) all.push_back(row.verdict);
  return all;
}

}  // namespace

TEST_CASE("comparison: z by the half of the interval on our side") {
  CHECK(one(reference(10, 1, 2), 13, 0).rows[0].z == Approx(1.5));
  CHECK(one(reference(10, 1, 2), 7, 0).rows[0].z == Approx(-3));
  CHECK(one(reference(10, 3, 3), 15, 4).rows[0].z == Approx(1));
  CHECK(one(reference(10, 3, 3), 15, 4).rows[0].error == 4);
}

TEST_CASE("comparison: what is open above agrees with all above") {
  const double open = std::numeric_limits<double>::infinity();
  CHECK(one(reference(10, 1, open), 1e9, 0).rows[0].z == 0);
  CHECK(one(reference(10, 1, 1), 3, open).rows[0].z == 0);
}

TEST_CASE("comparison: half the interval of a simulated value is 1.96 standard deviations") {
  Result simulated = test::scalar("q", "", 15, 4 * kNormal);
  simulated.ci95 = {{15 - 4 * kNormal, 15 + 4 * kNormal}};
  const auto c = compare({reference(10, 3, 3)}, {simulated});
  CHECK(c.rows[0].z == Approx(1));
}

TEST_CASE("comparison: exact values agree to rounding, and no further") {
  CHECK(one(reference(0, 0, 0), 0, 0).rows[0].z == 0);
  CHECK(one(reference(0.1, 0, 0), 0.1, 0).rows[0].z == 0);
  const double next = std::nextafter(0.1, 1);
  CHECK(one(reference(0.1, 0, 0), next, 0).rows[0].verdict == Verdict::agrees);
  CHECK(one(reference(0.1, 0, 0), 0.1 + 1e-13, 0).disagrees);
  CHECK(one(reference(1, 0, 0), 0, 0).disagrees);
  CHECK(one(reference(0, 0, 0), 1e-300, 0).disagrees);
}

TEST_CASE("comparison: agrees below 1.96, by chance beyond, disagrees at 1e-3") {
  CHECK(judged({1.95}).rows[0].verdict == Verdict::agrees);
  CHECK(judged({-1.97}).rows[0].verdict == Verdict::by_chance);
  CHECK(judged({3.28}).rows[0].verdict == Verdict::by_chance);  // p = 1.04e-3
  CHECK_FALSE(judged({3.28}).disagrees);
  CHECK(judged({3.30}).rows[0].verdict == Verdict::disagrees);  // p = 0.97e-3
  CHECK(judged({-3.30}).disagrees);
}

// p(3.5) = 4.65e-4, p(4) = 6.33e-5.
TEST_CASE("comparison: Holm steps down from the largest") {
  using enum Verdict;
  CHECK(verdicts(judged({3.5, 0, 0})) == std::vector{by_chance, agrees, agrees});
  CHECK(verdicts(judged({0, -4, 3.5})) == std::vector{agrees, disagrees, disagrees});
  CHECK(verdicts(judged({3.5, -4, 3.5, 0})) ==
        std::vector{by_chance, disagrees, by_chance, agrees});
  CHECK(judged({3.5, -4, 3.5, 0}).disagrees);
  // Each would be significant alone, none is among so many.
  CHECK_FALSE(judged(std::vector<double>(20, 3.5)).disagrees);
}

TEST_CASE("comparison: huge differences are reported, not lost to underflow") {
  CHECK(judged({1e6, 0}).disagrees);
  CHECK(judged({-1e300}).disagrees);
}

TEST_CASE("comparison: values are found by name and argument, others are left out once") {
  Result array = test::array("S_v", "", "omega", {0, 1, 0.3});
  array.value = {5, 6, 7};
  array.error = {0, 0, 0};
  const Results results{test::scalar("P_stick", "", 0.5, 0), array};
  const auto c = compare({{"P_stick", {}, 0.5, 0.5, 0.5},
                          {"S_v", 0.1 * 3, 7, 7, 7},
                          {"S_v", 0.0, 5, 5, 5},
                          {"S_v", 1.1, 6, 6, 6},
                          {"S_v", 2.0, 6, 6, 6},
                          {"E_V2", {}, 1, 1, 1},
                          {"P_stick", 0.0, 0.5, 0.5, 0.5},
                          {"S_v", {}, 5, 5, 5}},
                         results);
  REQUIRE(c.rows.size() == 3);
  CHECK(c.rows[0].value == 0.5);
  CHECK(c.rows[1].value == 7);
  CHECK(c.rows[2].value == 5);
  CHECK(c.left_out == std::vector<std::string>{"S_v", "E_V2", "P_stick"});
  CHECK_FALSE(c.disagrees);
}

TEST_CASE("comparison: nothing in common is no disagreement") {
  const auto c = compare({reference(1, 0, 0)}, {});
  CHECK(c.rows.empty());
  CHECK(c.left_out == std::vector<std::string>{"q"});
  CHECK_FALSE(c.disagrees);
}

TEST_CASE("comparison: verdicts in words") {
  CHECK(std::string(run::verdict_text(Verdict::agrees)) == "agrees");
  CHECK(std::string(run::verdict_text(Verdict::by_chance)) == "by chance");
  CHECK(std::string(run::verdict_text(Verdict::disagrees)) == "DISAGREES");
}
