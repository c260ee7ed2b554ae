#include "stickslip/cli/output.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "../common/catch.hpp"
#include "../common/made_results.hpp"

using namespace stickslip;
using cli::Json;
using cli::results_of;

namespace {

quantities::Result read(const char* text) { return results_of(Json{{"a", Json::parse(text)}})[0]; }

}  // namespace

TEST_CASE("results of JSON: what was written is read") {
  auto scalar = test::scalar("P_stick", "", 0.1, 1e-300);
  auto array = test::array("S_v", "length^2/time", "omega", {0.5, 2});
  array.value = {3, -1 / 3.0};
  array.error = {0.25, 0};
  array.ci95 = {{2.5, 3.25}, {-0.5, 5.5}};
  const auto read = results_of(Json::parse(cli::results_json({scalar, array}).dump()));
  REQUIRE(read.size() == 2);
  for (const auto& [found, expected] : {std::pair{read[0], scalar}, {read[1], array}}) {
    CHECK(found.key == expected.key);
    CHECK(found.unit == expected.unit);
    CHECK(found.abscissa_name == expected.abscissa_name);
    CHECK(found.abscissa == expected.abscissa);
    CHECK(found.value == expected.value);
    CHECK(found.error == expected.error);
    CHECK(found.ci95 == expected.ci95);
  }
}

TEST_CASE("results of JSON: null is no number, and the abscissa may stand anywhere") {
  const auto r = read(R"({"value": [1, null], "error": [null, 2], "time": [3, 4], "unit": "time",
                          "ci95": [[0, null], [null, 5]]})");
  CHECK(r.abscissa_name == "time");
  CHECK(r.abscissa == std::vector<double>{3, 4});
  CHECK(r.value[0] == 1);
  CHECK(std::isnan(r.value[1]));
  CHECK(std::isnan(r.error[0]));
  CHECK(std::isnan(r.ci95[0].second));
  CHECK(r.ci95[1].second == 5);
}

TEST_CASE("results of JSON: parts that are missing or differ in number are refused") {
  for (const char* text : {R"({"value": 1})", R"({"error": 1})", R"({"value": "x", "error": 0})",
                           R"({"value": 1, "error": 0, "ci95": [1]})", "1", "[]"}) {
    INFO(text);
    CHECK_THROWS_AS(read(text), Json::exception);
  }
  for (const char* text :
       {R"({"value": [1], "error": [0]})", R"({"time": [1, 2], "value": [1], "error": [0]})",
        R"({"time": [1], "value": [1], "error": [0, 0]})",
        R"({"time": [1], "value": [1], "error": [0], "ci95": [[0, 1], [0, 1]]})"}) {
    INFO(text);
    CHECK_THROWS_AS(read(text), std::invalid_argument);
  }
}
