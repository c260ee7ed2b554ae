#include "stickslip/cli/sweep.hpp"

#include <set>

#include "../common/catch.hpp"
#include "../common/options.hpp"
#include "stickslip/base/errors.hpp"

using namespace stickslip;
using namespace stickslip::cli;
using test::Given;

namespace {

using Options = std::vector<std::pair<std::string, std::string>>;

Request read(const Options& options) {
  const Given given(options);
  return read_request({});
}

std::string complaint(const Options& options) {
  try {
    (void)read(options);
  } catch (const BadInput& bad) {
    return bad.what();
  }
  return "nothing";
}

}  // namespace

TEST_CASE("sweep: every number of the model can be swept, and nothing else") {
  for (const auto& group : table()) {
    for (const auto& option : group.options) {
      INFO(option.name);
      const bool number = option.kind == Kind::real || option.kind == Kind::integer;
      CHECK((find("sweep_" + option.name) != nullptr) == (number && group.title == "Model"));
    }
  }
}

TEST_CASE("sweep: the product in the order of the table, the last option fastest") {
  const Request r = read({{"-sweep_tau", "1,2"}, {"-sweep_mu_d", "0.25:0.75:3"}});
  REQUIRE(r.sweep);
  REQUIRE(r.sweep->axes().size() == 2);
  CHECK(r.sweep->axes()[0].option == "mu_d");
  CHECK(r.sweep->axes()[1].option == "tau");
  CHECK(r.sweep->size() == 6);
  using Values = std::vector<double>;
  CHECK(r.sweep->values(0) == Values{0.25, 1});
  CHECK(r.sweep->values(1) == Values{0.25, 2});
  CHECK(r.sweep->values(2) == Values{0.5, 1});
  CHECK(r.sweep->values(5) == Values{0.75, 2});
  CHECK(r.sweep->place(3) == "mu_d = 0.5, tau = 2");
}

TEST_CASE("sweep: a point is what a single run would be") {
  const Request sweep = read({{"-mu_d", "0.9"},
                              {"-delta", "0.25"},
                              {"-sweep_mu_d", "0.1:0.7:4:log"},
                              {"-sweep_noise_levels", "10,20"},
                              {"-accuracy", "1e-9"},
                              {"-quantities", "laplace"},
                              {"-lambda", "1,2"}});
  const Request r = sweep.sweep->request(7);
  CHECK(r.scene.friction.mu_d == 0.7);
  CHECK(r.scene.noise_levels == 20);
  CHECK(r.scene.delta == 0.25);
  CHECK(r.question.accuracy == 1e-9);
  CHECK(r.question.quantities == std::set{Quantity::laplace});
  CHECK(r.question.lambda == std::vector<double>{1, 2});
  CHECK_FALSE(r.sweep);
  // No digit is lost on the way.
  CHECK(sweep.sweep->request(2).scene.friction.mu_d == 0.1 * std::pow(0.7 / 0.1, 1 / 3.0));
}

TEST_CASE("sweep: values need to be valid at their points only") {
  // mu_d = 1 without a sweep, which is above mu_s here.
  CHECK_NOTHROW(read({{"-sweep_mu_s", "0.5,0.75"}, {"-sweep_mu_d", "0.25,0.5"}}));
  CHECK_THAT(complaint({{"-sweep_mu_s", "0.25,0.5"}, {"-sweep_mu_d", "0.75,0.6"}}),
             Catch::StartsWith("at mu_s = 0.25, mu_d = 0.75: -mu_d = 0.75: must be in [0, mu_s]"));
}

TEST_CASE("sweep: points that the model refuses are left out, with a warning") {
  const auto request = read({{"-sweep_mu_s", "0.5,1"}, {"-sweep_mu_d", "0.75,0.25"}});
  const auto& left_out = request.sweep->left_out();
  REQUIRE(left_out.size() == 1);
  CHECK_THAT(left_out.at(0), Catch::StartsWith("-mu_d = 0.75: must be in [0, mu_s]"));
  CHECK(request.scene.friction.mu_d == 0.25);  // of the first point that is computed
  REQUIRE(request.warnings.size() == 1);
  CHECK_THAT(request.warnings[0],
             Catch::StartsWith("1 of 4 points are refused and left out, such as at mu_s = 0.5, "
                               "mu_d = 0.75: -mu_d = 0.75: must be"));
}

TEST_CASE("sweep: a body that never moves at some points stops no other") {
  const auto left_out = read({{"-delta", "0.25"}, {"-sweep_mu_s", "1,8"}}).sweep->left_out();
  REQUIRE(left_out.size() == 1);
  CHECK_THAT(left_out.at(1), Catch::Contains("never slides, P_stick = 1"));
}

TEST_CASE("sweep: refusals name the point, the option and a way out") {
  struct Refusal {
    Options options;
    std::vector<std::string> reported;
  };
  const std::vector<Refusal> refusals{
      {{{"-sweep_mu_d", "0.5,-1"}}, {"-sweep_mu_d = -1", "[0, inf)"}},
      {{{"-sweep_mu_d", "a"}}, {"-sweep_mu_d = a", "first:last:count"}},
      {{{"-sweep_mud", "1"}}, {"-sweep_mud", "did you mean -sweep_mu_d?"}},
      {{{"-sweep_seed", "1"}}, {"-sweep_seed", "unknown option"}},
      {{{"-sweep_mu_d", "0.5,0.25,0.5"}}, {"-sweep_mu_d", "names 0.5 twice"}},
      {{{"-delta", "0.25"}, {"-sweep_mu_s", "8,9"}}, {"at mu_s = 8: ", "never slides"}},
      {{{"-sweep_noise_levels", "21.5,20.5"}}, {"at noise_levels = 20.5: ", "whole number"}},
      {{{"-sweep_drag_cubic", "0,1"}},
       {"-sweep_drag_cubic", "no effect with -drag linear", "leave it out"}},
      {{{"-sweep_tau", "1,2"}, {"-study", "p"}}, {"-study = p", "-sweep_"}},
      {{{"-sweep_tau", "1,2"}, {"-compare", "a.csv"}}, {"-compare = a.csv", "one run"}},
      {{{"-sweep_tau", "1,2"}, {"-quantities", "sticking,density"}}, {"asks for density"}},
      {{{"-sweep_tau", "1,2"}, {"-quantities", "trajectory"}}, {"asks for trajectory"}},
      {{{"-sweep_tau", "1,2"}, {"-route", "fluid_queue"}}, {"-route = fluid_queue", "b = 0"}},
      {{{"-sweep_tau", "1,2"}, {"-sweep_ranks", "99"}}, {"-sweep_ranks = 99", "mpiexec"}},
      {{{"-sweep_tau", "1:2:1000"}, {"-sweep_mu_d", "0.1:1:1000"}}, {"1000000 points"}},
      {{{"-sweep_tau", "1,2"}, {"-sweep_csv", "/no/such/x"}}, {"-sweep_csv = /no/such/x"}}};
  for (const auto& refusal : refusals) {
    const std::string reported = complaint(refusal.options);
    for (const auto& part : refusal.reported) CHECK_THAT(reported, Catch::Contains(part));
  }
}

TEST_CASE(
    "sweep: what holds everywhere is reported once, what holds at many points with their number") {
  const std::string everywhere = complaint({{"-sweep_tau", "1,2,3"}, {"-summary", "/no/such/x"}});
  CHECK_THAT(everywhere, Catch::StartsWith("-summary = /no/such/x"));
  CHECK(everywhere.find("-summary", 1) == everywhere.npos);
  CHECK_THAT(complaint({{"-sweep_mu_d", "2,3"}, {"-sweep_tau", "0.5,1,2"}}),
             Catch::StartsWith("at mu_d = 2, tau = 0.5 and 2 more points: "));
}

TEST_CASE("sweep: of many different complaints eight are reported, and how many more there are") {
  const std::string reported = complaint({{"-sweep_mu_d", "2:11:10"}});
  CHECK_THAT(reported, Catch::Contains("-mu_d = 9:") &&
                           Catch::EndsWith("\nand 2 more problems of this kind"));
  CHECK(reported.find("-mu_d = 10:") == reported.npos);
  CHECK(complaint({{"-sweep_mu_d", "2:9:8"}}).find("more problems") == reported.npos);
}

TEST_CASE("sweep: files belong to the whole, and its own options are useless without it") {
  const Request r = read({{"-sweep_tau", "1,2"},
                          {"-summary", "s.json"},
                          {"-checkpoint", "c"},
                          {"-sweep_csv", "s.csv"}});
  CHECK(r.files.written ==
        std::map<std::string, std::string>{{"sweep_csv", "s.csv"}, {"summary", "s.json"}});
  CHECK(r.files.checkpoint == "c");
  CHECK(r.warnings.empty());
  CHECK(r.sweep->request(1).files.written.empty());
  CHECK(r.sweep->request(1).files.checkpoint.empty());
  CHECK(read({{"-sweep_csv", "x.csv"}, {"-checkpoint", "c"}}).warnings.size() == 2);
}

TEST_CASE("sweep: points at which mu_s acts as another value are reported, once") {
  const auto warnings = read({{"-sweep_mu_s", "1,1.07,1.2"}}).warnings;
  REQUIRE(warnings.size() == 1);
  CHECK_THAT(warnings[0], Catch::StartsWith("at mu_s = 1.07 and 1 more points: mu_s = 1.07 acts"));
  const auto fine = read({{"-sweep_mu_s", "1,1.07,1.2"}, {"-delta_per_mu_s", "8"}});
  CHECK(fine.warnings.empty());
  CHECK(fine.sweep->request(1).scene.delta == 1.07 / 8);
  CHECK_THAT(complaint({{"-sweep_delta", "0.25,0.2"}, {"-delta_per_mu_s", "8"}}),
             Catch::Contains("-delta_per_mu_s = 8"));
}

TEST_CASE("sweep: its identity is made of what changes numbers") {
  const auto identity = [](const Options& options) { return read(options).sweep->identity(); };
  const auto one = identity({{"-sweep_tau", "1,2"}});
  CHECK(identity({{"-sweep_tau", "1,2"}, {"-summary", "x.json"}, {"-checkpoint", "c"}}) == one);
  CHECK(identity({{"-sweep_tau", "1,2"}, {"-tau", "3"}}) == one);
  CHECK(identity({{"-sweep_tau", "1,3"}}) != one);
  CHECK(identity({{"-sweep_tau", "1,2"}, {"-mu_d", "0.5"}}) != one);
  CHECK(identity({{"-sweep_tau", "1,2"}, {"-accuracy", "1e-7"}}) != one);
  CHECK(identity({{"-sweep_tau", "1,2"}, {"-slide_mat_mumps_icntl_14", "50"}}) != one);
}

// From the table, so that a new option belongs to it unless it is named here.
TEST_CASE("sweep: every option but those of the output belongs to its identity") {
  std::set<std::string> names;
  const auto request = read({{"-sweep_tau", "1,2"}});
  for (const auto& [name, value] : request.sweep->identity()) names.insert(name);
  for (const auto& group : table()) {
    for (const auto& option : group.options) {
      const bool free =
          group.title == "Output" || option.name == "plan" || option.name == "checkpoint";
      INFO(option.name);
      CHECK(names.contains(option.name) != free);
    }
  }
}
