#include "../common/catch.hpp"
#include "stickslip/cli/sweep.hpp"

#include <hdf5.h>

#include <array>
#include <cmath>
#include <fstream>

#include "../common/made_results.hpp"
#include "../common/options.hpp"
#include "../common/temporary.hpp"
#include "../common/written.hpp"
#include "stickslip/base/errors.hpp"
#include "stickslip/cli/hdf5_file.hpp"
#include "stickslip/cli/reports.hpp"
#include "stickslip/linalg/session.hpp"
#include "stickslip/linalg/solver_statistics.hpp"
#include "stickslip/run/carry_out.hpp"

using namespace stickslip;
using namespace stickslip::cli;
using cli::Request;
using test::Given;

namespace {

using Options = std::vector<std::pair<std::string, std::string>>;

Request read(const Options& options) {
  const Given given(options);
  return cli::read_request({});
}

SweepResult result(const Request& request) { return run_sweep(PETSC_COMM_WORLD, request, {}); }

cli::Report report(const Request& request, const SweepResult& sweep) {
  return report_of(PETSC_COMM_SELF, request, sweep, {});
}

bool first_rank() { return linalg::rank(PETSC_COMM_WORLD) == 0; }

void check_equal(const quantities::Results& found, const quantities::Results& expected) {
  REQUIRE(found.size() == expected.size());
  for (std::size_t r = 0; r < found.size(); ++r) {
    INFO(expected[r].key);
    CHECK(found[r].key == expected[r].key);
    CHECK(found[r].unit == expected[r].unit);
    CHECK(found[r].abscissa_name == expected[r].abscissa_name);
    CHECK(found[r].abscissa == expected[r].abscissa);
    CHECK(found[r].value == expected[r].value);
    CHECK(found[r].error == expected[r].error);
    CHECK(found[r].ci95 == expected[r].ci95);
  }
}

SweepPoint made_by_hand(std::size_t point, double value) {
  SweepPoint run;
  run.point = point;
  run.results = {test::scalar("E(max(x,v))", "force", value, 0.125)};
  run.seconds = 1;
  run.entry = "{}";
  return run;
}

}  // namespace

TEST_CASE("sweeps: every point has the bits of a run of its own", "[parallel]") {
  for (const char* quantities : {"sticking,moments,noise_law,entry_law", "laplace,relaxation"}) {
    const Request request = read({{"-delta", "0.5"},
                                  {"-sweep_mu_d", "0.25,0.5,1"},
                                  {"-sweep_tau", "0.5,1"},
                                  {"-lambda", "0,2"},
                                  {"-quantities", quantities}});
    const auto sweep = result(request);
    if (!first_rank()) continue;
    REQUIRE(sweep.runs.size() == 6);
    for (std::size_t n = 0; n < 6; ++n) {
      const auto alone = run::carry_out(PETSC_COMM_SELF, request.sweep->request(n), {});
      CHECK(sweep.runs[n].point == n);
      CHECK(sweep.runs[n].status == Status::reached);
      check_equal(sweep.runs[n].results, alone.results);
    }
    CHECK(exit_status(sweep.runs) == 0);
  }
}

TEST_CASE("sweeps: simulated points too, with their intervals", "[parallel]") {
  const Request request = read({{"-delta", "0.5"},
                                {"-sweep_mu_d", "0.25,0.5"},
                                {"-route", "monte_carlo"},
                                {"-excursions", "2000"}});
  const auto sweep = result(request);
  if (!first_rank()) return;
  const auto alone = run::carry_out(PETSC_COMM_SELF, request.sweep->request(1), {});
  CHECK_FALSE(alone.results[0].ci95.empty());
  check_equal(sweep.runs[1].results, alone.results);
}

TEST_CASE("sweeps: several ranks to a point give the same up to rounding", "[parallel]") {
  if (linalg::ranks(PETSC_COMM_WORLD) == 1) return;
  const Request request =
      read({{"-delta", "0.5"}, {"-sweep_mu_d", "0.25,0.5"}, {"-sweep_ranks", "2"}});
  const auto sweep = result(request);
  if (!first_rank()) return;
  for (std::size_t n = 0; n < 2; ++n) {
    const auto alone = run::carry_out(PETSC_COMM_SELF, request.sweep->request(n), {});
    for (std::size_t r = 0; r < alone.results.size(); ++r) {
      CHECK(sweep.runs[n].results[r].value[0] == Approx(alone.results[r].value[0]).epsilon(1e-12));
    }
  }
}

TEST_CASE("sweeps: what falls short keeps its values and stops no other", "[parallel]") {
  // The truncation velocity of 1 excludes more than the accuracy allows.
  const auto sweep =
      result(read({{"-delta", "0.5"}, {"-accuracy", "1e-4"}, {"-sweep_v_max", "1,3.7"}}));
  if (!first_rank()) return;
  CHECK(sweep.runs[0].status == Status::not_reached);
  CHECK_THAT(sweep.runs[0].message, Catch::Contains("excludes"));
  CHECK(sweep.runs[0].results[0].value[0] > 0);
  CHECK(sweep.runs[1].status == Status::reached);
  CHECK(exit_status(sweep.runs) == 3);
}

TEST_CASE("sweeps: what does not fit in memory stops no other", "[parallel]") {
  const auto sweep =
      result(read({{"-sweep_delta", "4e-5,0.5"}, {"-accuracy", "1e-12"}, {"-noise_degree", "0"}}));
  if (!first_rank()) return;
  CHECK(sweep.runs[0].status == Status::no_memory);
  CHECK(sweep.runs[0].results.empty());
  CHECK_FALSE(sweep.runs[1].results.empty());
  CHECK(exit_status(sweep.runs) == 4);
}

TEST_CASE("sweeps: points that the model refuses stop no other", "[parallel]") {
  const auto sweep = result(read({{"-delta", "0.5"}, {"-sweep_mu_d", "2,0.5"}}));
  if (!first_rank()) return;
  CHECK(sweep.runs[0].status == Status::refused);
  CHECK_THAT(sweep.runs[0].message, Catch::Contains("must be in [0, mu_s]"));
  CHECK(sweep.runs[0].results.empty());
  CHECK(sweep.runs[1].status == Status::reached);
  CHECK(sweep.resumed == 0);
  CHECK(exit_status(sweep.runs) == 3);
}

TEST_CASE("sweeps: what the checkpoint holds is not computed again") {
  const test::TemporaryFolder folder;
  const std::string file = folder / "checkpoint";
  const auto run = [&] {
    return result(read({{"-delta", "0.5"}, {"-sweep_mu_d", "0.25,0.5"}, {"-checkpoint", file}}));
  };
  const auto first = run();
  CHECK(first.resumed == 0);
  const auto second = run();
  CHECK(second.resumed == 2);
  for (std::size_t n = 0; n < 2; ++n) CHECK(second.runs[n].entry == first.runs[n].entry);
  std::ofstream(file, std::ios::app) << "{\"point\":7}\n";
  CHECK_THROWS_AS(run(), BadInput);
}

TEST_CASE("sweeps: points that lacked memory are tried again, those that fell short are not") {
  const test::TemporaryFolder folder;
  const auto resumed = [&](const Options& options) {
    auto all = options;
    all.emplace_back("-checkpoint", folder / options[0].second.c_str());
    (void)result(read(all));
    return result(read(all)).resumed;
  };
  CHECK(resumed({{"-sweep_delta", "4e-5,0.5"}, {"-accuracy", "1e-12"}, {"-noise_degree", "0"}}) ==
        1);
  CHECK(resumed({{"-sweep_v_max", "1,3.7"}, {"-delta", "0.5"}, {"-accuracy", "1e-4"}}) == 2);
}

TEST_CASE("sweeps: the status of the whole is that of the worst point") {
  const auto status = [](std::vector<Status> all) {
    std::vector<SweepPoint> runs(all.size());
    for (std::size_t n = 0; n < all.size(); ++n) runs[n].status = all[n];
    return exit_status(runs);
  };
  CHECK(status({Status::reached, Status::reached}) == 0);
  CHECK(status({Status::reached, Status::not_reached}) == 3);
  CHECK(status({Status::failed, Status::reached}) == 3);
  CHECK(status({Status::failed, Status::no_memory, Status::reached}) == 4);
}

TEST_CASE("sweeps: progress counts points of the checkpoint, and predicts by those done here") {
  const test::TemporaryFolder folder;
  const std::string file = folder / "checkpoint";
  const auto states = [&file] {
    const Request request =
        read({{"-delta", "0.5"}, {"-sweep_mu_d", "0.25,0.5,0.75"}, {"-checkpoint", file}});
    const double start = linalg::wall_seconds();
    std::vector<std::pair<State, double>> all;
    (void)run_sweep(PETSC_COMM_WORLD, request,
                    [&](const State& s) { all.emplace_back(s, linalg::wall_seconds() - start); });
    return all;
  };
  const auto all = states();
  REQUIRE(all.size() == 3);
  double spent = 0;
  for (std::size_t n = 0; n < 3; ++n) {
    const auto& [state, elapsed] = all[n];
    CHECK(state.point == n);
    CHECK(state.done == n + 1);
    CHECK(state.count == 3);
    CHECK(state.status == "reached");
    spent += state.seconds_of_point;
    const double share = (2.0 - static_cast<double>(n)) / static_cast<double>(n + 1);
    CHECK(state.seconds_left >= share * spent);
    CHECK(state.seconds_left <= share * elapsed);
  }
  const std::string text = test::content(file);
  std::ofstream(file) << text.substr(0, text.rfind('\n', text.size() - 2) + 1);
  const auto rest = states();
  REQUIRE(rest.size() == 1);
  CHECK(rest[0].first.done == 3);
}

TEST_CASE("sweeps: CSV quotes what holds a comma and leaves gaps where there is no number") {
  const Request request = read({{"-sweep_mu_d", "0.25,0.5,0.75"}});
  SweepResult sweep;
  sweep.runs = {made_by_hand(0, 2), made_by_hand(1, std::nan("")), made_by_hand(2, 0)};
  sweep.runs[2].results.clear();
  sweep.runs[2].status = Status::failed;
  CHECK(test::written(report(request, sweep), "sweep_csv") ==
        "mu_d,\"E(max(x,v))\",\"E(max(x,v))_error\",status\n"
        "0.25,2,0.125,reached\n"
        "0.5,,0.125,reached\n"
        "0.75,,,failed\n");
  const std::string table = report(request, sweep).text;
  CHECK_THAT(table, Catch::Contains("mu_d = 0.75: failed") &&
                        Catch::Contains("2 of 3 points reached") &&
                        !Catch::Contains("mu_d = swept"));
}

TEST_CASE("sweeps: ten points that fell short are reported, and how many more there are") {
  for (const auto& [count, more] : {std::pair{10, ""}, {12, "and 2 more like these\n"}}) {
    const Request request = read({{"-sweep_mu_d", "0.1:0.9:" + std::to_string(count)}});
    SweepResult sweep;
    for (int n = 0; n < count; ++n) {
      sweep.runs.push_back(made_by_hand(static_cast<std::size_t>(n), 2));
      sweep.runs.back().status = Status::failed;
      sweep.runs.back().message = "why" + std::to_string(n);
    }
    const std::string table = report(request, sweep).text;
    CHECK_THAT(table, Catch::Contains("why9\n") && Catch::Contains(more));
    CHECK((table.find("more like these") != table.npos) == (count == 12));
    CHECK(table.find("why10") == table.npos);
  }
}

TEST_CASE("sweeps: HDF5 keeps both ends of intervals, and gaps where a point has no number") {
  const test::TemporaryFolder folder;
  const std::string file = folder / "out.h5";
  const Request request = read({{"-sweep_mu_d", "0.25,0.5"}});
  SweepResult sweep;
  sweep.runs = {made_by_hand(0, 2), made_by_hand(1, 3)};
  sweep.runs[0].results[0].ci95 = {{1.5, 2.75}};
  sweep.runs[1].results.clear();
  test::write(report(request, sweep), "output", file);
  const Hdf5Id id(H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  const auto first_and_second = [&](const std::string& name) {
    const Hdf5Id data(H5Dopen2(id, ("/sweep/E(max(x,v))" + name).c_str(), H5P_DEFAULT), H5Dclose);
    std::array<double, 2> values{};
    REQUIRE(H5Dread(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) >= 0);
    return values;
  };
  CHECK(first_and_second("")[0] == 2);
  CHECK(first_and_second("_error")[0] == 0.125);
  CHECK(first_and_second("_low")[0] == 1.5);
  CHECK(first_and_second("_high")[0] == 2.75);
  CHECK(std::isnan(first_and_second("")[1]));
}
