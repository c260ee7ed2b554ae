#include "../common/catch.hpp"
#include "stickslip/cli/reports.hpp"

#include <hdf5.h>
#include <petscsys.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "../common/made_results.hpp"
#include "../common/temporary.hpp"
#include "../common/written.hpp"
#include "stickslip/cli/hdf5_file.hpp"
#include "stickslip/cli/output.hpp"

using namespace stickslip;
using Json = nlohmann::json;

namespace {

// Every number of the outcome is another one, so that none can stand in the place of another.
run::Step step(double offset) {
  run::Step s;
  s.resolution.degree = 8;
  s.resolution.layers = 5;
  s.resolution.levels = 40;
  s.resolution.v_max = 7.5;
  s.statistics.unknowns = 1001;
  s.statistics.nonzeros = 20002;
  s.statistics.factor_entries = 300003;
  s.statistics.factor_megabytes = 12;
  s.statistics.backward_error = 3e-16;
  s.statistics.assembly_seconds = 0.125 + offset;
  s.statistics.analysis_seconds = 0.25 + offset;
  s.statistics.factorization_seconds = 0.5 + offset;
  s.statistics.solve_seconds = 0.75 + offset;
  s.seconds = 2 + offset;
  s.checks = {{"lambda", 0.0625}};
  return s;
}

quantities::Results results() {
  quantities::Result array = test::array("S_v", "length^2/time", "omega", {0.5, 2});
  array.value = {3, 5};
  array.error = {0.25, 0.125};
  array.ci95 = {{2.5, 3.25}, {4.75, 5.5}};
  auto simulated = test::scalar("P_stick", "", 0.25, 0.03125);
  simulated.ci95 = {{0.2, 0.3}};
  return {test::scalar("E_V2", "velocity^2", -4, 0.5), simulated, array};
}

run::Outcome outcome() {
  run::Outcome o;
  o.results = results();
  o.shortfall = "too little";
  o.next_digit_seconds = 17;
  o.steps = {step(0), step(1)};
  o.steps[1].estimate = 0.03;
  o.steps[1].limiting_key = "E_V2";
  o.total.assemblies = 2;
  o.total.factorizations_real = 3;
  o.total.factorizations_complex = 5;
  o.total.solves = 7;
  o.total.corrections = 11;
  o.total.iterations = 13;
  o.total.unknowns = 1001;
  o.total.solve_seconds = 19;
  return o;
}

run::Compared compared(const char* quantity, double z, run::Verdict verdict) {
  return {{quantity, 1.5, 10, 9, 12}, 11, 0.5, z, verdict};
}

cli::Request request() {
  cli::Request r;
  r.scene.friction = {1, 0.25};
  r.scene.tau = 2;
  r.scene.delta = 0.5;
  r.scene.drag = {3, 4};
  r.scene.bias = 0.0625;
  r.question.accuracy = 1e-5;
  r.files.compared = "a.csv";
  r.resolved = {{"mu_d", "0.25"}};
  return r;
}

template <class... Parts>
cli::Report report(const Parts&... parts) {
  return cli::report_of(PETSC_COMM_SELF, parts...);
}

const cli::RunTimes kTimes{0.5, 4};

Json summary_of(const run::Outcome& o) {
  return Json::parse(test::written(report(request(), o, kTimes), "summary"));
}

std::string table(const cli::Request& r, const run::Outcome& o, const cli::RunTimes& times = {}) {
  return report(r, o, times).text;
}

std::vector<std::string> lines(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> all;
  for (std::string line; std::getline(stream, line);) all.push_back(line);
  return all;
}

/// Words of the first line that begins with `start`.
std::vector<std::string> row(const std::string& text, const std::string& start) {
  for (const auto& line : lines(text)) {
    std::istringstream stream(line);
    std::vector<std::string> words;
    for (std::string word; stream >> word;) words.push_back(word);
    if (!words.empty() && words[0] == start) return words;
  }
  return {};
}

using Words = std::vector<std::string>;

std::vector<double> dataset(const std::string& file, const std::string& path) {
  const Hdf5Id id(H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  const Hdf5Id data(H5Dopen2(id, path.c_str(), H5P_DEFAULT), H5Dclose);
  REQUIRE(data.valid());
  const Hdf5Id space(H5Dget_space(data), H5Sclose);
  std::vector<double> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
  REQUIRE(H5Dread(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) >= 0);
  return values;
}

using Numbers = std::vector<double>;

run::Study study() {
  run::Study s;
  s.kind = "p";
  s.runs = {{"upwind", {{"delta", 0.5}, {"p", 4}}, results(), 2, step(0).statistics}};
  s.tables = {{"P_stick on a level",
               "a title",
               {{"p", run::Digits::parameter}, {"kappa", run::Digits::order}},
               {{4, std::nan("")}, {8, 1.5}}}};
  s.conclusions = {"so it is"};
  return s;
}

}  // namespace

TEST_CASE("summary: every number stands at its own key") {
  const Json s = summary_of(outcome());
  CHECK(s["scene"] == Json{{"mu_s", 1.0},
                           {"mu_d", 0.25},
                           {"tau", 2.0},
                           {"delta", 0.5},
                           {"drag", "linear"},
                           {"drag_coefficient", 3.0},
                           {"drag_cubic", 4.0},
                           {"bias", 0.0625},
                           {"mu_s_effective", 0.5625},  // X <= 0.5 sticks
                           {"mu_s_minus_effective", 0.9375},
                           {"noise_levels_meant", 4},
                           {"noise_levels", 40},
                           {"v_max", 7.5}});
  const auto& r = s["results"];
  CHECK(r["E_V2"] == Json{{"value", -4.0}, {"error", 0.5}, {"unit", "velocity^2"}});
  CHECK(r["P_stick"] == Json{{"value", 0.25}, {"error", 0.03125}, {"ci95", {0.2, 0.3}}});
  CHECK(r["S_v"]["omega"] == Json{0.5, 2.0});
  CHECK(r["S_v"]["value"] == Json{3.0, 5.0});
  CHECK(r["S_v"]["error"] == Json{0.25, 0.125});
  CHECK(r["S_v"]["ci95"] == Json{{2.5, 3.25}, {4.75, 5.5}});
  CHECK(s["accuracy"] == Json{{"asked", 1e-5}, {"reached", false}, {"shortfall", "too little"}});
  CHECK(s["plan"] == Json{{"assemblies", 2},
                          {"factorizations_real", 3},
                          {"factorizations_complex", 5},
                          {"solves", 7},
                          {"corrections", 11},
                          {"iterations", 13},
                          {"unknowns", 1001}});
  CHECK(s["provenance"]["options"] == Json{{"mu_d", "0.25"}});
}

TEST_CASE("summary: the cost is reported in all and by steps") {
  const Json cost = summary_of(outcome())["cost"];
  CHECK(cost["seconds"] == 4.0);
  CHECK(cost["start_up_seconds"] == 0.5);
  CHECK(cost["next_digit_seconds"] == 17.0);
  CHECK(cost["solve_seconds"] == 19.0);
  REQUIRE(cost["steps"].size() == 2);
  const Json last = cost["steps"][1];
  CHECK(last == Json{{"scheme", "hp"},
                     {"degree", 8},
                     {"layers", 5},
                     {"noise_degree", 0},
                     {"v_max", 7.5},
                     {"noise_levels", 40},
                     {"noise_nodes", 81},
                     {"unknowns", 1001},
                     {"nonzeros", 20002},
                     {"factor_entries", 300003},
                     {"factor_megabytes", 12.0},
                     {"backward_error", 3e-16},
                     {"assembly_seconds", 1.125},
                     {"analysis_seconds", 1.25},
                     {"factorization_seconds", 1.5},
                     {"solve_seconds", 1.75},
                     {"seconds", 3.0},
                     {"checks", {{"lambda", 0.0625}}},
                     {"relative_error", 0.03},
                     {"limited_by", "E_V2"}});
  CHECK_FALSE(cost["steps"][0].contains("relative_error"));
}

TEST_CASE("summary: simulations and comparisons") {
  auto o = outcome();
  o.reached = true;
  o.simulation.emplace();
  o.simulation->state = {1000, 2000, 30000, 5, 6};
  o.simulation->continued_from = 400;
  o.comparison = run::Comparison{{compared("S_v", 2.5, run::Verdict::by_chance)}, {"E_X2"}, true};
  o.comparison->rows.push_back({{"E_V2", {}, 1, 1, 1}, 1, 0, 0, run::Verdict::agrees});
  const Json s = summary_of(o);
  CHECK(s["accuracy"] == Json{{"asked", 1e-5}, {"reached", true}});
  CHECK(s["cost"]["simulation"] == Json{{"excursions", 1000.0},
                                        {"continued_from", 400.0},
                                        {"jumps", 30000.0},
                                        {"seconds", 5.0}});
  const auto& c = s["comparison"];
  CHECK(c["file"] == "a.csv");
  CHECK(c["disagrees"] == true);
  CHECK(c["left_out"] == Json{"E_X2"});
  CHECK(c["rows"][0] == Json{{"quantity", "S_v"},
                             {"argument", 1.5},
                             {"value", 11.0},
                             {"error", 0.5},
                             {"reference", 10.0},
                             {"ci95", {9.0, 12.0}},
                             {"z", 2.5},
                             {"verdict", "by chance"}});
  CHECK_FALSE(c["rows"][1].contains("argument"));
}

TEST_CASE("table: values with their errors, absolute and relative") {
  auto r = request();
  CHECK_THAT(table(r, outcome(), kTimes),
             Catch::StartsWith("mu_s = 1 (acts as 0.5625)   mu_d = 0.25   "
                               "mu_s_minus = 1 (acts as 0.9375)"));
  r.scene.bias = 0.5;
  const std::string text = table(r, outcome(), kTimes);
  CHECK(row(text, "mu_s") == Words{"mu_s", "=",     "1", "mu_d", "=",    "0.25",    "tau", "=",
                                   "2",    "delta", "=", "0.5",  "drag", "linear,", "c",   "=",
                                   "3,",   "c3",    "=", "4",    "bias", "=",       "0.5"});
  CHECK(row(text, "E_V2") == Words{"E_V2", "-4.0", "5.0e-01", "1.2e-01", "velocity^2"});
  CHECK(row(text, "P_stick") == Words{"P_stick", "0.25", "3.1e-02", "1.2e-01"});
  CHECK(row(text, "0.5") == Words{"0.5", "3.0", "2.5e-01"});
  CHECK(row(text, "2") == Words{"2", "5.0", "1.2e-01"});
  CHECK_THAT(text, Catch::Contains("\nS_v by omega [length^2/time]\n") &&
                       Catch::Contains("\naccuracy 1e-05 NOT reached: too little\n") &&
                       Catch::Contains("\n4.00 s in total, 0.50 s of it start-up\n") &&
                       Catch::Contains("\none more digit would take about 17 s\n") &&
                       Catch::Contains("\n13 Krylov iterations in 7 solves and 11 steps of "
                                       "iterative refinement\n") &&
                       Catch::Contains("\nlambda = 0.0625: "));
}

TEST_CASE("table: digits are those that the error supports, and exact values are short") {
  auto o = outcome();
  o.results = {test::scalar("a", "", 0.15648616853236219, 3e-10), test::scalar("b", "", 0.1, 0),
               test::scalar("c", "", 0, 1e-3), test::scalar("d", "", std::nan(""), std::nan(""))};
  const std::string text = table(request(), o);
  CHECK(row(text, "a") == Words{"a", "0.1564861685", "3.0e-10", "1.9e-09"});
  CHECK(row(text, "b") == Words{"b", "0.1", "0", "0"});
  CHECK(row(text, "c") == Words{"c", "0", "1.0e-03", "-"});
  CHECK(row(text, "d") == Words{"d", "nan", "-", "-"});
}

TEST_CASE("table: values end in one column, and a long key has a line of its own") {
  auto o = outcome();
  const std::string name(41, 'k');
  o.results.push_back(test::scalar(name, "time", 0.5, 0));
  CHECK_THAT(table(request(), o),
             Catch::Contains("\n"
                             "quantity  value    error  rel. error  unit\n"
                             "E_V2       -4.0  5.0e-01     1.2e-01  velocity^2\n"
                             "P_stick    0.25  3.1e-02     1.2e-01\n"
                             "S_v by omega [length^2/time]\n"
                             "  0.5       3.0  2.5e-01\n"
                             "    2       5.0  1.2e-01\n" +
                             name +
                             "\n"
                             "            0.5        0           0  time\n"));
}

TEST_CASE("table: refinement levels with their sizes and seconds, the first without estimate") {
  auto o = outcome();
  o.results.clear();
  o.steps.insert(o.steps.begin(), step(-0.125));
  const std::string text = table(request(), o);
  Words row_of_first{"8", "5", "40", "81", "7.5", "1001", "2.00e+04", "12"};
  Words row_of_last = row_of_first;
  for (const char* word : {"0.000", "0.500", "0.625", "1.875", "-"}) {
    row_of_first.emplace_back(word);
  }
  for (const char* word : {"1.125", "2.750", "1.750", "3.000", "3.0e-02"}) {
    row_of_last.emplace_back(word);
  }
  CHECK(row(text, "8") == row_of_first);
  CHECK(row(text.substr(text.find("1.125") - 60), "8") == row_of_last);
  CHECK_THAT(text,
             Catch::Contains("\n-: no estimate yet; an error estimate compares 3 discretisations\n"
                             "largest relative error, last row: E_V2\n"));
}

// Sizes and times beyond what fits this machine.
TEST_CASE("table: the cost has room in 100 columns") {
  auto o = outcome();
  o.results.clear();
  auto& last = o.steps[1];
  last.resolution.degree = 19;
  last.resolution.layers = 123;
  last.resolution.levels = 123456;
  last.resolution.v_max = 1234.5678;
  last.statistics.unknowns = 987654321;
  last.statistics.nonzeros = 123456789012;
  last.statistics.factor_megabytes = 1234567;
  last.statistics.assembly_seconds = last.statistics.factorization_seconds = 98765.4321;
  last.statistics.solve_seconds = last.seconds = 98765.4321;
  last.limiting_key = "dmean_excursion_dstribeck_velocity";
  last.checks = {
      {"excursion_pairs", 123,
       "pairs of Krylov vectors in the reduced model of excursion durations"},
      {"norm_pi_M_over_norm_M", 3.185e-19, "residual of the null vector pi of the generator M"}};
  auto r = request();
  for (auto scheme : {cases::Scheme::hp, cases::Scheme::upwind, cases::Scheme::none}) {
    r.method.scheme = scheme;
    for (auto& step : o.steps) step.resolution.scheme = scheme;
    for (const auto& line : lines(table(r, o))) {
      INFO(line);
      CHECK(line.size() <= 100);
    }
  }
}

TEST_CASE("table: of a long array the first and the last six") {
  auto o = outcome();
  auto& r = o.results[2];
  r.ci95.clear();
  for (int size : {12, 13}) {
    r.abscissa.clear();
    for (int n = 0; n < size; ++n) r.abscissa.push_back(100 + n);
    r.value = r.error = r.abscissa;
    const std::string text = table(request(), o);
    for (int n = 0; n < size; ++n) {
      INFO(n << " of " << size);
      CHECK(row(text, std::to_string(100 + n)).empty() == (size == 13 && n == 6));
    }
    CHECK(row(text, "...").empty() == (size == 12));
  }
}

TEST_CASE("table: a comparison of many rows shows its ends and what disagrees") {
  auto o = outcome();
  o.comparison = run::Comparison{{}, {"E_X2"}, true};
  for (int n = 0; n < 50; ++n) {
    o.comparison->rows.push_back(
        compared(("Q" + std::to_string(n)).c_str(), n < 48 ? 0.5 : -2.5, run::Verdict::agrees));
  }
  o.comparison->rows[23].verdict = run::Verdict::disagrees;
  const std::string text = table(request(), o);
  for (int n = 0; n < 50; ++n) {
    INFO(n);
    CHECK(row(text, "Q" + std::to_string(n)).empty() == (n >= 20 && n < 30 && n != 23));
  }
  CHECK(row(text, "Q0") == Words{"Q0", "1.5", "11.0", "10", "[9.0,", "12.0]", "0.50", "agrees"});
  CHECK_THAT(text, Catch::Contains("48 of 50 values within 1.96 standard deviations; significant "
                                   "disagreement") &&
                       Catch::Contains("E_X2: not computed here\n"));
  o.comparison->rows.clear();
  CHECK_THAT(table(request(), o), Catch::Contains("NOTHING was compared"));
}

TEST_CASE("table: a simulation reports its size, and of accuracy only if one was asked for") {
  auto o = outcome();
  o.simulation.emplace();
  o.simulation->state = {1000, 2000, 4e6, 2, 6};
  o.simulation->continued_from = 400;
  auto r = request();
  CHECK_THAT(table(r, o),
             Catch::Contains("1000 excursions, 400 of them from the checkpoint, 4e+06 jumps of the "
                             "noise in 2.00 s (500 ns a jump)\n") &&
                 !Catch::Contains("accuracy 1e-05"));
  r.question.accuracy_given = true;
  CHECK_THAT(table(r, o), Catch::Contains("accuracy 1e-05 NOT reached"));
}

TEST_CASE("trajectory: columns of CSV in the order of their names") {
  auto o = outcome();
  o.path = simulation::Path{{0, 0.5}, {-1.5, 2}, {0, 1}, {0, 0.25}};
  CHECK(test::written(report(request(), o, kTimes), "trajectory") ==
        "time,x,y,v\n0,-1.5,0,0\n0.5,2,1,0.25\n");
}

TEST_CASE("HDF5: results, intervals, comparison and path at their paths") {
  const test::TemporaryFolder folder;
  const std::string file = folder / "out.h5";
  auto o = outcome();
  o.comparison = run::Comparison{{compared("S_v", 2.5, run::Verdict::by_chance)}, {}, false};
  o.path = simulation::Path{{0, 0.5}, {-1.5, 2}, {0, 1}, {0, 0.25}};
  test::write(report(request(), o, kTimes), "output", file);
  const auto at = [&](const char* path) { return dataset(file, path); };
  CHECK(at("/results/E_V2/value") == Numbers{-4});
  CHECK(at("/results/E_V2/error") == Numbers{0.5});
  CHECK(at("/results/P_stick/low") == Numbers{0.2});
  CHECK(at("/results/P_stick/high") == Numbers{0.3});
  CHECK(at("/results/S_v/omega") == Numbers{0.5, 2});
  CHECK(at("/results/S_v/value") == Numbers{3, 5});
  CHECK(at("/results/S_v/error") == Numbers{0.25, 0.125});
  CHECK(at("/results/S_v/low") == Numbers{2.5, 4.75});
  CHECK(at("/results/S_v/high") == Numbers{3.25, 5.5});
  const std::vector<std::pair<std::string, double>> row{
      {"argument", 1.5}, {"value", 11}, {"error", 0.5}, {"reference", 10},
      {"low", 9},        {"high", 12},  {"z", 2.5}};
  for (const auto& [name, value] : row) {
    CHECK(at(("/comparison/S_v/" + name).c_str()) == Numbers{value});
  }
  CHECK(at("/trajectory/time") == Numbers{0, 0.5});
  CHECK(at("/trajectory/x") == Numbers{-1.5, 2});
  CHECK(at("/trajectory/y") == Numbers{0, 1});
  CHECK(at("/trajectory/v") == Numbers{0, 0.25});
}

// Without an interval, errors are standard deviations.
TEST_CASE("reports: references read from a summary and from HDF5 are what was written") {
  const test::TemporaryFolder folder;
  const std::string hdf5 = folder / "out.h5", json = folder / "out.json";
  test::write(report(request(), outcome(), kTimes), "output", hdf5);
  test::write(report(request(), outcome(), kTimes), "summary", json);
  const double half = 1.959963984540054 * 0.5;
  const std::vector<cases::Reference> written{{"E_V2", {}, -4, -4 - half, -4 + half},
                                              {"P_stick", {}, 0.25, 0.2, 0.3},
                                              {"S_v", 0.5, 3, 2.5, 3.25},
                                              {"S_v", 2.0, 5, 4.75, 5.5}};
  for (const auto& file : {hdf5, json}) {
    const auto read = cli::read_references(file);
    REQUIRE(read.size() == written.size());
    for (std::size_t n = 0; n < read.size(); ++n) {
      CHECK(read[n].quantity == written[n].quantity);
      CHECK(read[n].argument == written[n].argument);
      CHECK(read[n].value == written[n].value);
      CHECK(read[n].low == Approx(written[n].low).epsilon(1e-14));
      CHECK(read[n].high == Approx(written[n].high).epsilon(1e-14));
    }
  }
}

TEST_CASE("study reports: CSV, JSON and HDF5 hold the same numbers") {
  const test::TemporaryFolder folder;
  const std::string file = folder / "out.h5";
  const auto r = request();
  const auto s = study();
  const auto all = report(r, s, kTimes);
  CHECK(lines(test::written(all, "study_csv"))[1] ==
        "upwind,delta=0.5;p=4,E_V2,-4,0.5,2,0.125,0.25,0.5,0.75,12");
  const Json json = Json::parse(test::written(all, "summary"));
  const auto& run = json["runs"][0];
  CHECK(run["scene"]["method"] == "upwind");
  CHECK(run["scene"]["p"] == 4.0);
  CHECK(run["results"]["E_V2"]["error"] == 0.5);
  CHECK(run["cost"] == Json{{"assembly_seconds", 0.125},
                            {"analysis_seconds", 0.25},
                            {"factorization_seconds", 0.5},
                            {"solve_seconds", 0.75},
                            {"seconds", 2.0},
                            {"unknowns", 1001},
                            {"factor_megabytes", 12.0}});
  const auto& table = json["study"]["tables"]["P_stick on a level"];
  CHECK(table["p"] == Json{4.0, 8.0});
  CHECK(table["kappa"] == Json{nullptr, 1.5});
  CHECK(json["cost"]["seconds"] == 4.0);
  test::write(all, "output", file);
  CHECK(dataset(file, "/study/P_stick_on_a_level/p") == Numbers{4, 8});
  CHECK(dataset(file, "/study/P_stick_on_a_level/kappa")[1] == 1.5);
  const std::string text = all.text;
  CHECK(row(text, "8") == Words{"8", "1.500"});
  CHECK(row(text, "4") == Words{"4"});
  CHECK_THAT(text, Catch::Contains("1 runs, 4.00 s in total"));
}

TEST_CASE("study reports: numbers have the digits of their columns") {
  using run::Digits;
  auto s = study();
  s.tables = {{"name",
               "title",
               {{"delta", Digits::parameter},
                {"value", Digits::supported},
                {"error", Digits::error},
                {"order", Digits::order},
                {"extrapolated", Digits::compared},
                {"seconds", Digits::measurement}},
               {{0.2222222222, 0.15648616853236219, 3e-10, 1.23456, 0.123456789012, 0.0123456}}}};
  CHECK(row(report(request(), s, cli::RunTimes{}).text, "0.222222") ==
        Words{"0.222222", "0.1564861685", "3.0e-10", "1.235", "0.123456789", "0.0123"});
}

TEST_CASE("plan reports: sizes, solves and seconds in their places") {
  run::Prediction p;
  p.plan.tasks = {{"stationary distribution", {{{0, generator::Symmetry::even}, 3, 0}}},
                  {"hitting distribution", {{{0.5, generator::Symmetry::none}, 0, 2}}}};
  p.steps = {{step(0).resolution, 1001, 20002, 3e5, 12, 4e6, 0.25, 0.125}};
  p.seconds = 7;
  auto r = request();
  r.question.quantities = {cases::Quantity::sticking};
  const std::string text = report(r, p).text;
  CHECK(row(text, "8") ==
        Words{"8", "5", "40", "81", "7.5", "1001", "2.00e+04", "3.00e+05", "12", "0.250"});
  CHECK_THAT(text, Catch::Contains("total: 2 assemblies, 2 factorisations, 5 solves\n") &&
                       Catch::Contains("lambda = 0, even functions") &&
                       Catch::Contains("3 forward") &&
                       Catch::Contains("lambda = 0.5, v of both signs") &&
                       Catch::Contains("2 transposed") && Catch::Contains("about 7 s for"));
  const Json plan = Json::parse(test::written(report(r, p), "summary"))["plan"];
  CHECK(plan["solves"] == 5);
  CHECK(plan["adaptive"] == false);
  CHECK(plan["seconds"] == 7.0);
  CHECK(plan["tasks"][0]["systems"][0] ==
        Json{{"lambda", 0.0}, {"symmetry", "even"}, {"plain_solves", 3}, {"transposed_solves", 0}});
  CHECK(plan["tasks"][1]["systems"][0]["transposed_solves"] == 2);
  const auto& s = plan["steps"][0];
  CHECK(s["factor_entries"] == 3e5);
  CHECK(s["factor_megabytes"] == 12.0);
  CHECK(s["factor_operations"] == 4e6);
  CHECK(s["seconds"] == 0.25);
  p.plan.tasks[1].adaptive = true;
  CHECK_THAT(report(r, p).text,
             Catch::Contains("total, adaptive tasks not counted: 2 assemblies") &&
                 Catch::Contains("adaptive: about 0 factorisations"));
}
