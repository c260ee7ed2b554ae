#include <hdf5.h>

#include <fstream>
#include <limits>

#include "../common/catch.hpp"
#include "../common/temporary.hpp"
#include "stickslip/cli/output.hpp"

using namespace stickslip;
using cases::Reference;
using cli::read_references;

namespace {

class Folder {
 public:
  std::string write(const char* name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }

 private:
  test::TemporaryFolder folder_;
};

std::vector<Reference> read(const char* name, const std::string& text) {
  const Folder folder;
  return read_references(folder.write(name, text));
}

std::string complaint(const char* name, const std::string& text) {
  try {
    (void)read(name, text);
  } catch (const std::invalid_argument& bad) {
    return bad.what();
  }
  return "nothing";
}

void check(const Reference& r, const char* quantity, std::optional<double> argument, double value,
           double low, double high) {
  CHECK(r.quantity == quantity);
  CHECK(r.argument == argument);
  CHECK(r.value == value);
  CHECK(r.low == Approx(low).epsilon(1e-14));
  CHECK(r.high == Approx(high).epsilon(1e-14));
}

const std::string kHeader = "quantity,argument,value,low,high\n";

}  // namespace

TEST_CASE("reference: rows of CSV, scalars and arrays, with and without bounds") {
  const auto all = read("a.csv", kHeader + "P_stick,,0.25,0.2,0.3\n"
                                           "S_v, 1.5 , +2e-3,,\n"
                                           "\"F_slide\",0,1,0.5,1\r\n"
                                           "E_V,,-1,-2,0\n"
                                           "E_V2,,1,0.5,\n"
                                           "E_XV,,1,,2");
  REQUIRE(all.size() == 6);
  check(all[0], "P_stick", {}, 0.25, 0.2, 0.3);
  check(all[1], "S_v", 1.5, 2e-3, 2e-3, 2e-3);
  check(all[2], "F_slide", 0.0, 1, 0.5, 1);
  check(all[3], "E_V", {}, -1, -2, 0);
  check(all[4], "E_V2", {}, 1, 0.5, 1);
  check(all[5], "E_XV", {}, 1, 1, 2);
}

TEST_CASE("reference: columns of CSV may come in any order, and with others between") {
  const auto all = read("a.csv", "high,note,value,low,argument,quantity\n3,by hand,2,1,,E_V2\n");
  REQUIRE(all.size() == 1);
  check(all[0], "E_V2", {}, 2, 1, 3);
}

TEST_CASE("reference: bad rows of CSV are reported with their lines") {
  const std::string good = kHeader + "P_stick,,0.25,0.2,0.3\n";
  const auto reported = [&](const std::string& row) {
    return complaint("a.csv", good + row + "\n");
  };
  using Catch::Contains;
  CHECK_THAT(reported("E_V2,,abc,,"), Contains("line 3") && Contains("value = abc"));
  CHECK_THAT(reported("E_V2,,1x,,"), Contains("line 3") && Contains("value = 1x"));
  CHECK_THAT(reported("E_V2,,nan,,"), Contains("line 3") && Contains("no finite number"));
  for (const std::string text : {"0x10", "+-1", "1e400", "1 2"}) {
    CHECK_THAT(reported("E_V2,," + text + ",,"), Contains("line 3") && Contains("value = " + text));
  }
  CHECK_THAT(reported("E_V2,,1,inf,"), Contains("line 3") && Contains("low = inf"));
  CHECK_THAT(reported("E_V2,one,1,,"), Contains("line 3") && Contains("argument = one"));
  CHECK_THAT(reported("E_V2,,,,"), Contains("line 3") && Contains("a value are needed"));
  CHECK_THAT(reported(",,1,,"), Contains("line 3") && Contains("a quantity and"));
  CHECK_THAT(reported("E_V2,,1,2,3"), Contains("line 3") && Contains("low <= value <= high"));
  CHECK_THAT(reported("E_V2,,1,0,0.5"), Contains("line 3") && Contains("low <= value <= high"));
  CHECK_THAT(reported("E_V2,,1"), Contains("3") && Contains("a.csv"));
  CHECK_THAT(reported("E_V2,,1,0,2,9"), Contains("3") && Contains("a.csv"));
}

TEST_CASE("reference: CSV without its header, or with nothing below it") {
  using Catch::Contains;
  CHECK_THAT(complaint("a.csv", "P_stick,,0.25,0.2,0.3\n"),
             Contains("not a CSV file of reference values"));
  CHECK_THAT(complaint("a.csv", "quantity,value\nP_stick,1\n"),
             Contains("not a CSV file of reference values"));
  CHECK_THAT(complaint("a.csv", ""), Contains("not a CSV file of reference values"));
  CHECK_THAT(complaint("a.csv", kHeader), Contains("holds no values"));
}

TEST_CASE("reference: computed values of JSON count their errors as standard deviations") {
  const auto all = read("a.json", R"({"results": {
    "P_stick": {"value": 0.5, "error": 0.01},
    "S_v": {"omega": [0, 2], "value": [3, 4], "error": [0, 1]}}})");
  constexpr double normal = 1.959963984540054;
  REQUIRE(all.size() == 3);
  check(all[0], "P_stick", {}, 0.5, 0.5 - 0.01 * normal, 0.5 + 0.01 * normal);
  check(all[1], "S_v", 0.0, 3, 3, 3);
  check(all[2], "S_v", 2.0, 4, 4 - normal, 4 + normal);
}

TEST_CASE("reference: simulated values of JSON have intervals, histograms are left out") {
  const auto all = read("a.json", R"({"results": {
    "P_stick": {"value": 0.5, "error": 0.2, "ci95": [0.4, 0.7]},
    "entry_law": {"k": [-1, 0], "value": [0.25, 0.75], "error": [1, 1],
                  "ci95": [[0, 0.5], [0.5, 1]]},
    "f_slide": {"time": [1], "value": [2], "error": [1], "ci95": [[1, 3]]},
    "f_stick_0": {"value": 1, "error": 1, "ci95": [0, 2]}}})");
  REQUIRE(all.size() == 4);
  check(all[0], "P_stick", {}, 0.5, 0.4, 0.7);
  check(all[1], "entry_law", -1.0, 0.25, 0, 0.5);
  check(all[2], "entry_law", 0.0, 0.75, 0.5, 1);
  check(all[3], "f_stick_0", {}, 1, 0, 2);  // a scalar, no histogram
}

TEST_CASE("reference: arguments of JSON by any of their names, and intervals of no width") {
  for (const std::string name : {"lambda", "omega", "time", "k", "n"}) {
    const auto all = read("a.json", R"({"results": {"a": {")" + name +
                                        R"(": [2, 4], "value": [3, 5], "error": [0, 0]}}})");
    REQUIRE(all.size() == 2);
    check(all[1], "a", 4.0, 5, 5, 5);
  }
  check(read("a.json", R"({"results": {"a": {"value": 1, "error": 0, "ci95": [1, 1]}}})")[0], "a",
        {}, 1, 1, 1);
}

TEST_CASE("reference: JSON that is broken, of others, or lacks something") {
  using Catch::Contains;
  CHECK_THAT(complaint("a.json", ""), Contains("not a JSON summary"));
  CHECK_THAT(complaint("a.json", "{\"results\": "), Contains("not a JSON summary"));
  CHECK_THAT(complaint("a.json", "{\"values\": {}}"), Contains("not a JSON summary"));
  CHECK_THAT(complaint("a.json", "[1]"), Contains("not a JSON summary"));
  CHECK_THAT(complaint("a.json", R"({"results": {}})"), Contains("holds no values"));
  CHECK_THAT(complaint("a.json", R"({"results": {"a": {"value": "x", "error": 0}}})"),
             Contains("not a JSON summary"));
  CHECK_THAT(complaint("a.json", R"({"results": {"a": {"value": 1}}})"),
             Contains("not a JSON summary"));
  CHECK_THAT(
      complaint("a.json", R"({"results": {"a": {"omega": [1], "value": [1, 2], "error": [0]}}})"),
      Contains("a lacks"));
  CHECK_THAT(complaint("a.json", R"({"results": {"a": {"value": [1, 2], "error": [0, 0]}}})"),
             Contains("a lacks"));
  CHECK_THAT(complaint("a.json", R"({"results": {"a": {"value": 1, "error": 0, "ci95": []}}})"),
             Contains("lacks") || Contains("not a JSON summary"));
}

TEST_CASE("reference: files of other kinds are refused") {
  using Catch::Contains;
  CHECK_THAT(complaint("a.txt", kHeader), Contains(".h5, .json or .csv"));
  CHECK_THAT(complaint("csv", kHeader), Contains(".h5, .json or .csv"));
  CHECK_THAT(complaint("a.h5", "no HDF5"), Contains("not a readable HDF5 file"));
  CHECK_THAT(complaint("a.hdf5", ""), Contains("not a readable HDF5 file"));
  const test::TemporaryFolder folder;
  CHECK_THROWS_WITH(read_references(folder / "none.csv"), Contains("cannot be read"));
}

TEST_CASE("reference: values that are no numbers are refused") {
  using Catch::Contains;
  const auto json = [](const std::string& result) {
    return complaint("a.json", R"({"results": {"a": )" + result + "}}");
  };
  CHECK(json(R"({"value": 1, "error": 0.5})") == "nothing");
  CHECK_THAT(json(R"({"value": 1, "error": -0.5})"), Contains("a has values or errors"));
  CHECK_THAT(json(R"({"value": 1, "error": 0, "ci95": [2, 1]})"), Contains("a has values"));
  CHECK_THAT(json(R"({"value": 1, "error": null})"), Contains("a has values"));
  CHECK_THAT(json(R"({"value": null, "error": 1})"), Contains("a has values"));
  CHECK(json(R"({"value": 1, "error": null, "ci95": [1, null]})") == "nothing");
  CHECK(json(R"({"value": 1, "error": null, "ci95": [null, 2]})") == "nothing");
}

// In JSON null may stand for infinity; HDF5 has both.
TEST_CASE("reference: what is no number in HDF5 is refused, an open interval is not") {
  const test::TemporaryFolder folder;
  const auto reading = [&](double error, double high) {
    const std::string name = folder / "a.h5";
    const hid_t file = H5Fcreate(name.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    const hid_t results = H5Gcreate2(file, "/results", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                group = H5Gcreate2(results, "a", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                space = H5Screate(H5S_SCALAR);
    for (const auto& [key, value] :
         {std::pair{"value", 1.0}, {"error", error}, {"low", 0.5}, {"high", high}}) {
      const hid_t data =
          H5Dcreate2(group, key, H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
      H5Dwrite(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, &value);
      H5Dclose(data);
    }
    H5Sclose(space);
    H5Gclose(group);
    H5Gclose(results);
    H5Fclose(file);
    return read_references(name);
  };
  using Catch::Contains;
  const double infinite = std::numeric_limits<double>::infinity(),
               none = std::numeric_limits<double>::quiet_NaN();
  CHECK(reading(infinite, infinite).at(0).high == infinite);
  CHECK_THROWS_WITH(reading(none, 2), Contains("a has values or errors that are no numbers"));
  CHECK_THROWS_WITH(reading(1, none), Contains("a has values or errors that are no numbers"));
}

// A chunk of the file's own structure points outside, at which the library has crashed.
TEST_CASE("reference: damaged HDF5 ends nothing but the reading") {
  const test::TemporaryFolder folder;
  const std::string sound = folder / "sound.h5", damaged = folder / "damaged.h5";
  const hid_t file = H5Fcreate(sound.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t results = H5Gcreate2(file, "/results", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  H5Gclose(results);
  H5Fclose(file);
  const std::string whole = test::content(sound);
  for (std::size_t n = 0; n < whole.size(); n += 7) {
    std::string other = whole;
    other[n] = static_cast<char>(0xff);
    std::ofstream(damaged, std::ios::binary) << other;
    CHECK_THROWS_AS(read_references(damaged), std::invalid_argument);
  }
}
