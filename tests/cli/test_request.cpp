#include <petscsys.h>

#include <algorithm>
#include <cstdio>
#include <fstream>

#include "../common/catch.hpp"
#include "../common/temporary.hpp"
#include "stickslip/base/errors.hpp"
#include "stickslip/case/duration_rows.hpp"
#include "stickslip/cli/request.hpp"
#include "stickslip/linalg/petsc.hpp"

using namespace stickslip;
using namespace stickslip::cli;

namespace {

/// Puts a command line into PETSc's options database for the life of the object.
class Given {
 public:
  explicit Given(const std::string& line) {
    linalg::check(PetscOptionsInsertString(nullptr, line.c_str()));
    for (std::size_t begin = 0; begin < line.size();) {
      const std::size_t end = std::min(line.find(' ', begin), line.size());
      words_.push_back(line.substr(begin, end - begin));
      begin = end + 1;
    }
  }
  ~Given() {
    for (const auto& word : words_) {
      if (word[0] == '-') (void)PetscOptionsClearValue(nullptr, word.c_str());
    }
  }
  Given(const Given&) = delete;
  Given& operator=(const Given&) = delete;
  [[nodiscard]] Request read() const { return read_request(words_); }

 private:
  std::vector<std::string> words_;
};

std::string complaint(const std::string& line) {
  const Given given(line);
  try {
    (void)given.read();
  } catch (const BadInput& bad) {
    CHECK(bad.status() == ExitStatus::bad_input);
    return bad.what();
  }
  return "nothing";
}

struct Refusal {
  std::string line;
  std::vector<std::string> reported;  // parts of the message
};

void check_refusal(const Refusal& refusal) {
  const std::string reported = complaint(refusal.line);
  for (const auto& part : refusal.reported) {
    INFO(refusal.line);
    CHECK_THAT(reported, Catch::Contains(part));
  }
}

}  // namespace

TEST_CASE("request: defaults of the command-line contract") {
  const Request r = Given("").read();
  CHECK(r.scene.friction.mu_s == 1);
  CHECK(r.scene.friction.mu_d == 1);
  CHECK(r.scene.tau == 1);
  CHECK(r.scene.delta == 0.125);
  CHECK(r.scene.drag.linear == 1);
  CHECK(r.scene.drag.cubic == 0);
  CHECK_FALSE(r.scene.noise_levels);
  CHECK_FALSE(r.scene.v_max);
  CHECK(r.question.accuracy == 1e-6);
  CHECK(r.method.scheme == Scheme::hp);
  CHECK_FALSE(r.method.fixed());
}

TEST_CASE("request: values arrive where they belong") {
  const Request r = Given("-mu_s 0.6 -mu_d 0.3 -tau 2 -delta 0.1 -noise_levels 40 -drag cubic "
                          "-drag_coefficient 0.5 -drag_cubic 3 -v_max 9 -quantities "
                          "moments,entry_law -accuracy 1e-9 -scheme upwind -p 12")
                        .read();
  CHECK(r.scene.friction.mu_d == 0.3);
  CHECK(r.scene.noise_levels == 40);
  CHECK(r.scene.drag.cubic == 3);
  CHECK(r.scene.v_max == 9.0);
  CHECK(r.question.wants(Quantity::entry_law));
  CHECK_FALSE(r.question.wants(Quantity::sticking));
  CHECK(r.method.points == 12);
  CHECK(r.method.fixed());
}

TEST_CASE("request: steps of the noise by how many go up to mu_s") {
  const Request r = Given("-mu_s 1.07 -delta_per_mu_s 8").read();
  CHECK(r.scene.delta == 1.07 / 8);
  CHECK(r.warnings.empty());
  const auto& used = r.resolved;
  CHECK(std::count(used.begin(), used.end(),
                   std::pair<std::string, std::string>{"delta", "mu_s/delta_per_mu_s"}) == 1);
  const std::vector<Refusal> refusals{
      {"-delta_per_mu_s 2.5", {"-delta_per_mu_s = 2.5", "whole number"}},
      {"-delta_per_mu_s 0", {"-delta_per_mu_s = 0", "[1, 1e+06]"}},
      {"-delta_per_mu_s 8 -delta 0.125", {"-delta_per_mu_s = 8", "-delta = 0.125", "leave one"}},
      {"-delta_per_mu_s 8 -noise telegraph -telegraph_amplitude 1 -telegraph_rate 1 -bias 0.3",
       {"-delta_per_mu_s = 8", "-noise is telegraph"}},
      {"-delta_per_mu_s 1 -mu_s 3", {"-delta_per_mu_s = 1: leaves no noise level", "at least 3"}},
      {"-delta_per_mu_s 3 -mu_s 1e9", {"-delta_per_mu_s = 3"}}};
  for (const auto& refusal : refusals) check_refusal(refusal);
}

TEST_CASE("request: the white-noise limit takes half the deviation as its step unless told") {
  const auto uses = [](const Request& r, const char* name, const char* value) {
    return std::count(r.resolved.begin(), r.resolved.end(),
                      std::pair<std::string, std::string>{name, value}) == 1;
  };
  const Request plain = Given("-study tau").read();
  CHECK((plain.scene.delta == 0.5 && uses(plain, "delta", "0.5")));
  CHECK(Given("-study tau -tau 0.25").read().scene.delta == 1);
  CHECK(Given("-study tau -delta 0.25").read().scene.delta == 0.25);
  CHECK(Given("-study tau -delta_per_mu_s 8").read().scene.delta == 0.125);
}

TEST_CASE("request: distributions of displacements are found to two digits unless told") {
  const std::string asked = "-quantities displacement_distribution -time 1 -probability 0.5";
  const Request plain = Given(asked).read();
  CHECK(plain.question.accuracy == 0.01);
  CHECK(std::count(plain.resolved.begin(), plain.resolved.end(),
                   std::pair<std::string, std::string>{"accuracy", "0.01"}) == 1);
  CHECK(Given(asked + " -accuracy 1e-4").read().question.accuracy == 1e-4);
}

TEST_CASE("request: what physicists may try first is answered with a way out") {
  const std::vector<Refusal> refusals{
      {"-noise white", {"-noise = white", "did you mean ou? See -study tau"}},
      {"-noise run_and_tumble", {"did you mean telegraph?"}},
      {"-tau 1e-12", {"such as 125000, an eighth of the deviation", "-study tau"}},
      {"-mu_s 0.2:2:4", {"-mu_s = 0.2:2:4", "-sweep_mu_s 0.2:2:4 takes several values"}},
      {"-study tau -quantities density -output x.h5", {"asks for density", "-observable"}},
      {"-study tau -plan", {"-plan: predicts one run"}}};
  for (const auto& refusal : refusals) check_refusal(refusal);
}

TEST_CASE("request: mu_s that acts as another value is reported with it and a way out") {
  CHECK(Given("-mu_s 1.125").read().warnings.empty());
  CHECK(Given("-mu_s 1.07 -study delta").read().warnings.empty());  // has steps of its own
  const auto plain = Given("-mu_s 1.07").read().warnings;
  REQUIRE(plain.size() == 1);
  CHECK_THAT(plain[0], Catch::StartsWith("mu_s = 1.07 acts as 1 on bodies at rest") &&
                           Catch::Contains("-delta_per_mu_s 9"));
  const auto biased = Given("-bias 0.3").read().warnings;
  REQUIRE(biased.size() == 1);
  CHECK_THAT(biased[0],
             Catch::StartsWith("mu_s = 1 acts as 0.925 and mu_s_minus = 1 acts as 0.95") &&
                 Catch::Contains("-delta of which"));
  const auto by_direction = Given("-mu_s_minus 1.3").read().warnings;
  REQUIRE(by_direction.size() == 1);
  CHECK_THAT(by_direction[0], Catch::StartsWith("mu_s_minus = 1.3 acts as 1.25"));
}

TEST_CASE("request: full stands for the largest noise range") {
  const Request r = Given("-delta 0.25 -noise_levels full").read();
  CHECK(r.scene.noise_levels == 32);
}

TEST_CASE("request: drag as an expression") {
  const Request r = Given("-drag expression -drag_expression 0-mu_s*v-0.1*v*abs(v)").read();
  CHECK(r.scene.drag(2) == Approx(-2.4));
  CHECK(r.scene.drag_expression == "0-mu_s*v-0.1*v*abs(v)");
  CHECK(r.warnings.empty());
  const Request unused =
      Given("-drag expression -drag_expression 0-v -drag_coefficient 2 -drag_cubic 1").read();
  CHECK(unused.warnings.size() == 2);
  CHECK(unused.scene.drag(2) == -2);
  for (const char* other : {"", "-drag linear ", "-drag none "}) {
    check_refusal(
        {other + std::string("-drag_expression 0-2*v"),
         {"-drag_expression = 0-2*v", "belongs to -drag expression", "add -drag expression"}});
  }
}

TEST_CASE("request: drag that is no drag is reported with place and way out") {
  const std::string law = "-drag expression -drag_expression ";
  const std::vector<Refusal> refusals{
      {"-drag expression", {"-drag = expression", "-drag_expression", "add for example"}},
      {law + "v*(", {"-drag_expression = v*(", "for example \"-v - 0.1*v*abs(v)\""}},
      {law + "1-v", {"-drag_expression = 1-v", "is 1 at v = 0", "-mu_d"}},
      {law + "0.1*v", {"-drag_expression", "for ever from about v = 9.9", "check the signs"}},
      {law + "2*v/(1+abs(v))", {"-drag_expression", "for ever", "friction takes 1"}},
      {law + "0-v-sign(v)", {"-drag_expression", "slope", "smooth it"}},
      {law + "0-tanh(v) -bias 3",
       {"-drag_expression", "the mean force 3 drives", "a drag that grows"}},
      {law + "0-tanh(v) -mu_d 0.5 -noise pulses -pulse_height 2 -pulse_rate 1 -pulse_duration 1 "
             "-pulse_sign up",
       {"-drag_expression", "the mean force 2 drives", "of a smaller mean"}},
      {law + "0-v -route fluid_queue", {"-route = fluid_queue", "needs a model without drag"}}};
  for (const auto& refusal : refusals) check_refusal(refusal);
}

TEST_CASE("request: without symmetry") {
  CHECK(Given("-bias 0").read().scene.symmetric());
  CHECK_FALSE(Given("-bias 0.1").read().scene.symmetric());
  CHECK_FALSE(Given("-drag expression -drag_expression (v>0?1:2)*(0-v)").read().scene.symmetric());
  CHECK_FALSE(Given("-mu_s_minus 1.5").read().scene.symmetric());
  CHECK(Given("-mu_s_minus 1 -mu_d_minus 1").read().scene.symmetric());
  for (const char* route : {"lambda", "hitting", "null_vector", "monte_carlo"}) {
    CHECK_NOTHROW(Given(std::string("-bias 0.5 -quantities sticking -route ") + route).read());
  }
  const Request down = Given("-bias 0.3 -delta 0.25 -quantities trajectory -trajectory t.csv "
                             "-start s-")
                           .read();
  CHECK(down.question.start.level == -6);  // x = -1.25 holds, -1.5 does not
  CHECK_NOTHROW(Given("-bias 8 -delta 0.25").read());
  CHECK_NOTHROW(Given("-mu_s_minus 1e12 -delta 0.25").read());
  const std::vector<Refusal> refusals{
      {"-bias 1 -drag none", {"-bias = 1", "for ever", "smaller than mu_d"}},
      {"-bias -0.6 -mu_d_minus 0.5 -drag none",
       {"-bias = -0.6", "mu_d_minus = 0.5 alone", "for ever"}},
      {"-bias 0.5 -mu_s 9 -delta 0.25", {"-mu_s = 9", "never slides", "P_stick = 1", "below 8.5"}},
      {"-mu_s 9 -mu_s_minus 8.5 -delta 0.25", {"-mu_s_minus = 8.5", "never slides", "below 8"}},
      {"-bias 0.5 -mu_s_minus 1e12 -start s- -quantities trajectory -trajectory t.csv",
       {"-start = s-", "other side alone", "s+"}},
      {"-mu_s_minus 0.5 -mu_d 0.75", {"-mu_s_minus = 0.5", "they are 0.75 and 0.5"}},
      {"-mu_d_minus 1.25",
       {"-mu_d_minus = 1.25", "[0, mu_s_minus]", "cannot exceed static friction"}},
      {"-bias 0.2 -mu_s 0.1 -mu_d 0.1 -delta 0.5", {"-mu_s = 0.1", "never sticks"}}};
  for (const auto& refusal : refusals) check_refusal(refusal);
}

TEST_CASE("request: formulas that begin with a sign are no options") {
  std::vector<std::string> words{
      "-drag_expression", "-v - v^3", "-observable", "-v", "-start", "-1,0",
      "-drag_expression", "-mu_s",    "-mu_d",       "-v"};
  shield_formulas(words);
  CHECK(words[1] == " -v - v^3");
  CHECK(words[3] == " -v");
  CHECK(words[5] == "-1,0");   // PETSc reads numbers
  CHECK(words[7] == "-mu_s");  // an option: the formula is missing
  CHECK(words[9] == "-v");
}

TEST_CASE("request: dynamic friction that is not given stays below static friction") {
  const Request small = Given("-mu_s 0.3").read(), large = Given("-mu_s 3").read();
  CHECK(small.scene.friction.mu_d == 0.3);
  CHECK(small.scene.symmetric());
  CHECK(large.scene.friction.mu_d == 1);
  const auto used = [](const Request& r) {
    return std::find_if(r.resolved.begin(), r.resolved.end(),
                        [](const auto& option) { return option.first == "mu_d"; })
        ->second;
  };
  CHECK(used(small) == "0.3");
  CHECK(used(large) == "1");
  for (const char* options : {"-mu_s_minus 0.5", "-mu_s 0.3 -mu_s_minus 0.5"}) {
    CHECK(Given(options).read().scene.friction.mirrored().mu_d == 0.5);
  }
  CHECK(Given("-mu_s 0.3 -mu_s_minus 3").read().scene.friction.mirrored().mu_d == 1);
  CHECK(Given("-mu_s 3 -mu_s_minus 2").read().scene.friction.mirrored().mu_d == 1);
}

TEST_CASE("request: every refusal names option, value, range and a way out") {
  const std::vector<Refusal> refusals{
      {"-delta -0.5", {"-delta = -0.5", "[0, inf)", "0.125"}},
      {"-noise filtered -ground_frequency 15 -ground_damping 0.6 -delta 1",
       {"-delta = 1", "filtered has none", "leave it out"}},
      {"-tau nan", {"-tau = nan", "(0, inf)"}},
      {"-tau 1e400", {"-tau = 1e400", "(0, inf)"}},
      {"-mu_s 1 -mu_d 2", {"-mu_d = 2", "[0, mu_s]", "mu_s = 1"}},
      {"-drag_coefficient -1", {"-drag_coefficient = -1", "[0, inf)", "must not grow"}},
      {"-delta 0.25 -noise_levels 99", {"-noise_levels = 99", "at most 2", "at most 32"}},
      {"-delta 0.25 -mu_s 8", {"-mu_s = 8", "never slides", "below 8"}},
      {"-delta 0.25 -noise_levels 4", {"-mu_s = ", "never slides", "above 4"}},
      {"-delta 1.5", {"-delta = 1.5", "no noise level", "at most 1.41421"}},
      {"-delta 1e-300", {"-delta = 1e-300", "larger step"}},
      {"-detla 0.5", {"-detla", "did you mean -delta"}},
      {"-quantities stiking", {"-quantities = stiking", "did you mean sticking"}},
      {"-quantities moments,moments", {"-quantities", "twice"}},
      {"-quantities density", {"-quantities = density", "-output"}},
      {"-scheme hp -p 4", {"-p = 4", "-scheme upwind"}},
      {"-scheme upwind -degree 4", {"-degree = 4", "-scheme hp"}},
      {"-degree 2.5", {"-degree = 2.5", "whole number"}},
      {"-noise_levels 99999999999", {"-noise_levels = 99999999999", "full"}},
      {"-accuracy 0", {"-accuracy = 0", "[1e-15, 0.1]"}},
      {"-summary /no/such/folder/x.json", {"-summary", "folder", "make the folder"}},
      {"-slide_mat_mumps_icntl_77 1", {"-slide_mat_mumps_icntl_77", "-slide_ksp_view"}},
      {"-slide_ksp_type nonsense", {"-slide_", "nonsense"}},
  };
  for (const auto& refusal : refusals) check_refusal(refusal);
}

TEST_CASE("request: a route refuses what it does not give, and names what it gives") {
  const std::string excursion = "take -route excursion";
  const std::vector<Refusal> refusals{
      {"-route hitting -quantities sticking,moments",
       {"-quantities = sticking,moments", "-route hitting does not give moments (",
        "mean hitting times give mean durations", "it gives sticking;", excursion}},
      {"-route lambda -quantities sticking,entry_law,density",
       {"-route lambda does not give entry_law and density (", "tends to stationary averages",
        "it gives sticking, moments, averages and noise_law;", excursion}},
      {"-route null_vector -quantities laplace -lambda 1",
       {"-route null_vector does not give laplace (", "is the stationary distribution",
        "it gives sticking, moments, averages and noise_law;"}},
      {"-route null_vector -quantities relaxation",
       {"-route null_vector does not give relaxation ("}},
      {"-drag none -route fluid_queue -quantities resolvent -lambda 1 -observable v",
       {"-route fluid_queue does not give resolvent (", "up to the second",
        "it gives sticking, moments, noise_law, entry_law, laplace and F_stick;"}},
      {"-route nul_vector", {"-route = nul_vector", "did you mean null_vector?"}}};
  for (const auto& refusal : refusals) check_refusal(refusal);
}

TEST_CASE("request: a route takes the default quantities that it gives") {
  using Quantities = std::set<Quantity>;
  const Quantities all{Quantity::sticking, Quantity::moments, Quantity::noise_law};
  CHECK(Given("").read().question.quantities == all);
  CHECK(Given("-route lambda").read().question.quantities == all);
  CHECK(Given("-route null_vector").read().question.quantities == all);
  CHECK(Given("-route fluid_queue -drag none").read().question.quantities == all);
  CHECK(Given("-route hitting").read().question.quantities == Quantities{Quantity::sticking});
}

TEST_CASE("request: routes and what they need arrive where they belong") {
  CHECK(Given("").read().method.route == Route::excursion);
  const Request by_lambda = Given("-route lambda -lambda 1e-4 -scheme upwind -p 3").read();
  CHECK(by_lambda.method.route == Route::lambda);
  CHECK(by_lambda.question.lambda == std::vector<double>{1e-4});
  CHECK(by_lambda.warnings.empty());
  CHECK(Given("-route lambda").read().question.lambda.empty());
  const Request queue = Given("-route fluid_queue -drag none").read();
  CHECK(queue.method.route == Route::fluid_queue);
  CHECK(queue.method.scheme == Scheme::none);
  const Request transforms =
      Given("-quantities laplace,resolvent -lambda 0:1:3 -observable x*v;stick;abs(v)^3").read();
  CHECK(transforms.question.lambda == std::vector<double>{0, 0.5, 1});
  REQUIRE(transforms.question.observables.size() == 3);
  CHECK(transforms.question.observables[0].name == "x*v");
  CHECK(transforms.question.observables[0](2, 1, 3) == 6);
  CHECK(transforms.question.observables[2](2, -1, -3) == 27);
}

TEST_CASE("request: arguments that are missing or make no sense are reported") {
  const std::vector<Refusal> refusals{
      {"-quantities laplace",
       {"-quantities = laplace", "no values of -lambda", "-lambda 0.1,1,10"}},
      {"-quantities resolvent -observable v",
       {"no values of -lambda are given", "add for example -lambda"}},
      {"-quantities resolvent -lambda 1", {"none are given", "-observable"}},
      {"-quantities laplace -lambda 1,-2", {"-lambda = -2", "[0, inf)"}},
      {"-quantities laplace -lambda 1:2", {"-lambda = 1:2", "first:last:count", "0.01:10:31:log"}},
      {"-quantities resolvent -lambda 1 -observable v;x*(",
       {"-observable = v;x*(", "write for example"}},
      {"-quantities resolvent -lambda 1 -observable velocity", {"-observable = velocity"}},
      {"-quantities resolvent -lambda 1 -observable",
       {"-observable: ", "must name a function of the state", "write for example"}},
      {"-quantities expectation -time 1 -observable", {"must name a function of the state"}},
      {"-quantities resolvent -lambda 1 -observable v;stick;v",
       {"-observable = v;stick;v", "names v twice", "name it once"}},
      {"-route lambda -lambda 1e-3,1e-4", {"-lambda = 1e-3,1e-4", "one positive number"}},
      {"-route lambda -lambda 0", {"-lambda = 0", "one positive number", "leave it out"}},
  };
  for (const auto& refusal : refusals) check_refusal(refusal);
}

TEST_CASE("request: arguments that nothing needs are reported, and harmless") {
  for (const std::string line : {"-lambda 1", "-observable v", "-route hitting -lambda 1"}) {
    const Request r = Given(line).read();
    REQUIRE(r.warnings.size() == 1);
    CHECK_THAT(r.warnings[0], Catch::Contains(" has no effect "));
  }
}

TEST_CASE("request: an option that serves one purpose is reported where it serves none") {
  const std::vector<std::pair<std::string, std::string>> useless{
      {"-drag none -drag_coefficient 2", "-drag_coefficient = 2 has no effect with -drag none"},
      {"-drag_cubic 2", "-drag_cubic = 2 has no effect with -drag linear"},
      {"-quantities laplace -lambda 1 -omega 1",
       "-omega = 1 has no effect on the quantities asked for"},
      {"-time 1", "-time = 1 has no effect on the quantities asked for"},
      {"-start s-", "-start = s- has no effect on the quantities asked for"},
      {"-horizon 5", "-horizon = 5 has no effect on the quantities asked for"},
      {"-spectrum_solver krylov",
       "-spectrum_solver = krylov has no effect on the quantities asked for"},
      {"-excursions 9", "-excursions = 9 has no effect without -route monte_carlo"},
      {"-checkpoint c", "-checkpoint = c has no effect without -route monte_carlo or a sweep"},
      {"-sweep_csv c", "-sweep_csv = c has no effect without a sweep"},
      {"-sweep_ranks 2", "-sweep_ranks = 2 has no effect without a sweep"},
      {"-study_steps 4", "-study_steps = 4 has no effect without -study"},
      {"-study_repeats 3", "-study_repeats = 3 has no effect without -study"},
      {"-study_csv c", "-study_csv = c has no effect without -study"},
      {"-study p -trajectory t.csv", "-trajectory = t.csv has no effect with -study"},
      {"-plan -trajectory t.csv", "-trajectory = t.csv has no effect with -plan"},
      {"-plan -output o.h5", "-output = o.h5 has no effect with -plan"},
      {"-plan -study_csv c", "-study_csv = c has no effect without -study"}};
  for (const auto& [line, warning] : useless) {
    CHECK(Given(line).read().warnings == std::vector<std::string>{warning + "; leave it out"});
  }
  for (const std::string line :
       {"-route monte_carlo -excursions 9 -seed 7 -checkpoint c", "-study p -study_steps 4",
        "-study p -output o.h5 -summary s.json", "-plan -summary s.json",
        "-plan -quantities density -output o.h5", "-plan -quantities trajectory -trajectory t.csv",
        "-drag cubic -drag_coefficient 2 -drag_cubic 2",
        "-quantities spectrum -omega 1 -spectrum_solver krylov",
        "-quantities trajectory -output t.h5 -start s- -horizon 5 -seed 7"}) {
    INFO(line);
    CHECK(Given(line).read().warnings.empty());
  }
}

TEST_CASE("request: the limit of white noise refuses what fixes the noise or the chain") {
  CHECK(Given("-study tau -quantities spectrum,moments -omega 1").read().warnings.empty());
  CHECK_THAT(complaint("-tau 0"), Catch::Contains("-study tau"));
  CHECK_THAT(complaint("-study tau -noise_deviation 1"),
             Catch::Contains("-noise_deviation = 1") && Catch::Contains("vanishes with tau"));
  CHECK_THAT(complaint("-study tau -noise narrow_band"),
             Catch::Contains("-study = tau") && Catch::Contains("take -noise ou"));
  CHECK_THAT(complaint("-study tau -quantities moments,entry_law"),
             Catch::Contains("asks for entry_law"));
  CHECK_THAT(complaint("-study tau -bias 1.5 -quantities sticking"),
             Catch::Contains("bias 1.5 exceeds static friction"));
}

TEST_CASE("request: a study chooses route, discretisation and noise levels itself") {
  const std::string compared = std::string("-compare ") + STICKSLIP_SOURCE + "/no.csv";
  for (const std::string chosen : {"-route excursion", "-scheme hp", "-degree 4", "-layers 4",
                                   "-noise_degree 2", "-noise_grading 2", "-p 4", "-v_max 5",
                                   "-checkpoint c", "-noise_levels 8", "-plan", compared.c_str()}) {
    const std::string message = complaint("-study delta -delta 0.5 " + chosen);
    INFO(message);
    CHECK_THAT(message, Catch::Contains(chosen.substr(0, chosen.find(' '))));
    CHECK_THAT(message,
               Catch::Contains("is chosen by -study itself") || Catch::Contains("one run"));
  }
  check_refusal({"-study p -quantities sticking,density -output d.h5",
                 {"-quantities = sticking,density", "must be sticking, moments and noise_law",
                  "in a study"}});
}

TEST_CASE("request: quantities that need a file or times, or derive nothing, are refused") {
  const std::vector<Refusal> refusals{
      {"-quantities trajectory", {"needs a file", "-trajectory FILE.csv"}},
      {"-quantities sensitivity,relaxation", {"no scalars to differentiate", "add sticking"}},
      {"-quantities relaxation -drag none", {"the generator is continuous", "a drag that grows"}},
      {"-quantities relaxation -drag expression -drag_expression 0-v/(1+abs(v))",
       {"the generator is continuous"}},
      {"-quantities large_deviation -tilt 1 -drag none",
       {"theta is infinite", "take displacement and diffusivity"}},
      {"-quantities large_deviation",
       {"no values of -tilt are given", "add for example -tilt -0.5"}},
      {"-quantities large_deviation -tilt 1,x", {"-tilt = 1,x: must be numbers in (-inf, inf)"}},
      {"-quantities large_deviation -tilt 1 -route monte_carlo", {"a sample has no eigenvalues"}},
      {"-quantities displacement_distribution -time 1",
       {"neither distances nor probabilities", "-probability 0.05"}},
      {"-quantities displacement_distribution -time 1 -distance 0,1",
       {"densities are not defined there", "leave 0 out"}},
      {"-quantities displacement_distribution -time 1 -probability 50%,84%",
       {"-probability = 50%,84%: must be numbers in (0, 1)", "; write 0.5 for 50 %"}},
      {"-mu_d 0,5", {"-mu_d = 0,5: must be a number", "; write the number with a decimal point"}},
      {"-mu_d 0.5g", {"-mu_d = 0.5g: must be a number", "; write the number alone: units are"}},
      {"-mu_d g", {"-mu_d = g: must be a number", "; friction must not drive the body"}},
      {"-quantities displacement_distribution -time 1 -probability 1.5",
       {"-probability = 1.5: must be numbers in (0, 1)"}},
      {"-quantities slip -distance -1,1", {"paths have no negative lengths"}},
      {"-quantities expectation -observable v",
       {"no values of -time are given", "add for example -time"}}};
  for (const auto& refusal : refusals) check_refusal(refusal);
}

TEST_CASE("request: results in a file to compare with have names of this program") {
  const test::TemporaryFolder folder;
  const std::string file = folder / "known.csv";
  const auto complaint_about = [&](const std::string& key) {
    std::ofstream(file) << "quantity,argument,value,low,high\n" << key << ",,1,,\n";
    return complaint("-compare " + file);
  };
  for (const char* known : {"P_stick", "var_slide", "relaxation_odd", "h_plus", "pi(v^2)",
                            "stationary(x)", "dP_stick_dmu_d", "dE_V2_ddrag_coefficient"}) {
    INFO(known);
    CHECK(complaint_about(known) == "nothing");
  }
  CHECK_THAT(complaint_about("P_stik"),
             Catch::Contains("holds P_stik") && Catch::Contains("P_stick?"));
  for (const char* unknown : {"foo(v)", "dP_stick_dmu", "dfoo_dtau", "d_dtau", "P_stick_dtau"}) {
    CHECK_THAT(complaint_about(unknown), Catch::Contains("which is no key of a result"));
  }
}

TEST_CASE("request: the fluid queue has neither drag nor a grid in v") {
  const std::vector<Refusal> refusals{
      {"-route fluid_queue",
       {"-route = fluid_queue", "needs a model without drag, b = 0", "-drag none"}},
      {"-route fluid_queue -drag cubic -drag_coefficient 0 -drag_cubic 1",
       {"needs a model without drag"}},
      {"-route fluid_queue -drag none -degree 4",
       {"-degree = 4", "does not discretise the velocity"}},
      {"-route fluid_queue -drag none -scheme hp",
       {"-scheme = hp", "does not discretise the velocity"}},
      {"-route fluid_queue -drag none -p 8",
       {"-p = 8", "does not discretise the velocity", "leave it out"}}};
  for (const auto& refusal : refusals) check_refusal(refusal);
  CHECK_NOTHROW(Given("-route fluid_queue -drag_coefficient 0").read());
}

TEST_CASE("request: a truncation velocity by hand is for excursions alone") {
  CHECK(Given("-v_max 5").read().scene.v_max == 5.0);
  for (const std::string route : {"lambda", "hitting", "null_vector", "fluid_queue -drag none"}) {
    check_refusal({"-v_max 5 -route " + route, {"-v_max = 5", "does not apply to -route"}});
  }
}

TEST_CASE("request: options of the eigensolvers are known or reported") {
  CHECK_NOTHROW(Given("-relax_eps_nev 10").read());
  CHECK_NOTHROW(Given("-null_eps_tol 1e-10 -null_eps_nev 10 -null_eps_ncv 40").read());
  CHECK_NOTHROW(Given("-null_st_pc_factor_mat_solver_type petsc").read());
  CHECK_NOTHROW(Given("-relax_eps_view -null_eps_converged_reason -slide_ksp_view").read());
  const std::vector<Refusal> refusals{
      {"-null_eps_tolerance 1e-10", {"-null_eps_tolerance", "-null_eps_view"}},
      {"-relax_eps_nev 5000", {"-relax_eps_nev = 5000", "at most 100"}},
      {"-null_eps_ncv 5000", {"-null_eps_ncv = 5000", "at most 1000"}},
      {"-relax_eps_nevs 10", {"-relax_eps_nevs", "-relax_eps_view"}},
      {"-null_eps_type nonsense", {"-null_", "nonsense"}},
      {"-relax_st_mat_mumps_icntl_99 1", {"-relax_st_mat_mumps_icntl_99"}}};
  for (const auto& refusal : refusals) check_refusal(refusal);
}

TEST_CASE("request: all problems are reported at once") {
  const std::string reported = complaint("-delta -1 -tau 0 -nonsense 3");
  for (const char* part : {"-delta", "-tau", "-nonsense"})
    CHECK_THAT(reported, Catch::Contains(part));
}

TEST_CASE("request: words that belong to no option are reported") {
  CHECK_THAT(complaint("-delta 0.5 scene.opts"), Catch::Contains("scene.opts: belongs to no"));
}

TEST_CASE("request: lists with spaces are reported as such") {
  const std::vector<Refusal> refusals{
      {"-quantities sticking, moments",
       {"-quantities = sticking,: ends with a comma; lists have no spaces",
        "moments: belongs to no option; lists have no spaces"}},
      {"-quantities sticking , moments", {",: belongs to no option; lists have no spaces"}},
      {"-quantities sticking ,moments", {",moments: belongs to no option; lists have no spaces"}},
      {"-quantities laplace -lambda 1, 2", {"-lambda = 1,: ends with a comma; lists have no"}}};
  for (const auto& refusal : refusals) check_refusal(refusal);
}

TEST_CASE("options files: unreadable files and lines are reported with their place") {
  const test::TemporaryFolder folder;
  const std::string name = folder / "scene.opts";
  std::ofstream(name) << "-mu_s 1  # fine\n\n# a comment\nmu_d 0.5\n";
  try {
    check_options_files({"-options_file", name});
    FAIL("accepted");
  } catch (const BadInput& bad) {
    CHECK_THAT(bad.what(), Catch::Contains(name + ":4") && Catch::Contains("mu_d 0.5"));
  }
  for (const char* formula : {"\"-v - v^3\"", "-v-v^3   # cubic"}) {
    std::ofstream(name) << "-mu_s 1\n  -drag_expression " << formula << "\n";
    CHECK_THROWS_WITH(check_options_files({"-options_file", name}),
                      Catch::Contains(name + ":2") && Catch::Contains("put a blank before it"));
  }
  std::ofstream(name) << "-drag_expression \" -v - v^3\"\n-start -1,0\n";
  CHECK_NOTHROW(check_options_files({"-options_file", name}));
  std::ofstream(name) << "-mu_s 1\n-observable \"\n";
  CHECK_THROWS_WITH(check_options_files({"-options_file", name}),
                    Catch::Contains(name + ":2") && Catch::Contains("not closed"));
  std::ofstream(name) << "-mu_s 1\n";
  CHECK_NOTHROW(check_options_files({"-options_file", name}));
  std::remove(name.c_str());
  CHECK_THROWS_AS(check_options_files({"-options_file", name}), BadInput);
  CHECK_THROWS_AS(check_options_files({"-options_file"}), BadInput);
  CHECK_THROWS_AS(check_options_files({"-options_file", "/"}), BadInput);
}

TEST_CASE("options files: one that includes itself, or is no file, is reported") {
  using Catch::Contains;
  const test::TemporaryFolder folder;
  const std::string outer = folder / "outer.opts", inner = folder / "inner.opts";
  const auto check = [&] { check_options_files({"-options_file", outer}); };
  std::ofstream(outer) << "-mu_d 0.5\n\t-options_file \"" << inner << "\" # more\n";
  CHECK_THROWS_WITH(check(), Contains("inner.opts: cannot be read"));
  std::ofstream(inner) << "-delta 0.5\n";
  CHECK_NOTHROW(check());
  std::ofstream(inner) << "-delta 0.5\n-options_file " << outer << "\r\n";
  CHECK_THROWS_WITH(check(), Contains("outer.opts: includes itself"));
  std::ofstream(inner) << "-options_file\n";
  CHECK_THROWS_WITH(check(), Contains("cannot be read"));
  CHECK_THROWS_WITH(check_options_files({"-options_file", "/dev/null"}),
                    Contains("not a regular file"));
}

TEST_CASE("request: what is simulated, and how well, arrives where it belongs") {
  const Request r = Given("-route monte_carlo -seed 7 -excursions 5000 -accuracy 1e-3").read();
  CHECK(r.method.seed == 7);
  CHECK(r.method.excursions == 5000);
  CHECK(r.question.accuracy_given);
  CHECK(r.warnings.empty());
  const Request usual = Given("").read();
  CHECK_FALSE(usual.question.accuracy_given);
  CHECK(usual.study.repeats == 3);
  CHECK(usual.sweep_ranks == 1);
  CHECK(Given("-seed 7").read().warnings.size() == 1);
}

TEST_CASE("request: starts are states that occur, or distributions") {
  const std::string path = "-quantities trajectory -trajectory t.csv -start ";
  CHECK(Given(path + "s+").read().question.start.level == 9);  // x = 1 holds at delta = 1/8
  CHECK(Given(path + "s-").read().question.start.level == -9);
  const Request r = Given(path + "-0.5,0.25").read();
  CHECK(r.question.start.level == -4);
  CHECK(r.question.start.v == 0.25);
  check_refusal({path + "0.3,0", {"-start = 0.3,0", "0.125 apart", "take x = 0.25"}});
  check_refusal({path + "-99,0", {"up to 16", "take x = -16"}});
  check_refusal({path + "2147483648,0", {"-start = 2147483648,0", "take x = 16"}});
  check_refusal({path + "0.5,100", {"-start = 0.5,100", "no body reaches", "take v in [0, 15]"}});
  check_refusal({path + "0.5,-15.1",
                 {"terminal velocity on the highest noise level is -15", "take v in [-15, 0]"}});
  CHECK_NOTHROW(Given(path + "0.5,100 -drag none").read());
  using enum model::Start::Kind;
  CHECK(Given(path + "rest").read().question.start.kind == rest);
  CHECK(Given(path + "stationary").read().question.start.kind == stationary);
  check_refusal({path + "nowhere", {"-start = nowhere", "stationary, rest or x,v"}});
}

TEST_CASE("request: first passages are of speeds that are reached, and not at once") {
  const std::string passage = "-quantities first_passage -velocity ";
  const Request r = Given(passage + "0.5 -start rest -passage down").read();
  CHECK(r.question.passage == model::Passage::down);
  CHECK(r.warnings.empty());
  CHECK_NOTHROW(Given(passage + "0.5 -passage up -start 0.5,-2").read());
  check_refusal({"-quantities first_passage", {"-quantities", "add for example -velocity"}});
  check_refusal({passage + "0", {"-velocity", "(0, inf)"}});
  check_refusal({passage + "-1", {"-velocity"}});
  check_refusal({passage + "99", {"-velocity", "no body reaches"}});
  check_refusal({passage + "0.5 -start 0.5,0.75", {"-start", "passed at once"}});
  check_refusal({passage + "0.5 -passage down -start 0.5,-2", {"-start", "passed at once"}});
  check_refusal({passage + "0.5 -passage sideways", {"-passage = sideways", "both, up or down"}});
  CHECK(Given("-quantities peak -velocity 0.5 -passage up").read().warnings.size() == 1);
  CHECK(Given(passage + "0.5 -lambda 1 -time 1").read().warnings.size() == 2);
  const std::string transform = "-quantities passage_transform -velocity 0.5 ",
                    distribution = "-quantities passage_distribution -velocity 0.5 ";
  CHECK(Given(transform + "-lambda 0,1 -passage up").read().warnings.empty());
  CHECK(Given(distribution + "-time 0,1 -start stationary").read().warnings.empty());
  check_refusal({transform, {"-lambda", "no values of -lambda are given"}});
  check_refusal({distribution, {"-time", "no values of -time are given"}});
  check_refusal({distribution + "-time -1", {"-time"}});
  check_refusal({"-quantities passage_distribution -time 1", {"add for example -velocity"}});
  check_refusal({transform + "-lambda 1 -start 0.5,0.75", {"-start", "passed at once"}});
  check_refusal({distribution + "-time 1 -velocity 99", {"-velocity", "no body reaches"}});
}

// Lambda = 128 at delta = 1/8.
TEST_CASE("request: a path that memory cannot keep is refused with the longest that it can") {
  const std::string path = "-quantities trajectory -trajectory t.csv -horizon ";
  CHECK_NOTHROW(Given(path + "390000").read());
  check_refusal({path + "400000", {"-horizon = 400000", "5.1e+07 jumps", "at most 3.91e+05"}});
}

TEST_CASE("request: bounds of the noise and of the bias belong to what is allowed, or not") {
  CHECK_NOTHROW(Given("-delta 0.25 -noise_levels 32").read());
  check_refusal({"-delta 0.25 -noise_levels 33", {"at most 32"}});
  CHECK_NOTHROW(Given("-delta 0.25 -noise_levels 5").read());
  CHECK_NOTHROW(Given("-mu_s 0.1 -mu_d 0.1 -delta 0.5").read());  // rests on x = 0 alone
  CHECK_NOTHROW(Given("-bias -0.99 -drag none").read());
  check_refusal({"-bias -1 -drag none", {"-bias = -1", "for ever"}});
}

// Levels 0 and 1.5 with the mean 0.75: friction of 0.5 does not hold it.
TEST_CASE("request: the bias is judged together with the mean of the noise") {
  const test::TemporaryFolder folder;
  const std::string file = folder / "on_off.csv";
  std::ofstream(file) << "x,rate_up,rate_down\n0,1,0\n1.5,0,1\n";
  const std::string held = "-drag none -mu_d 0.5 -noise file -noise_file " + file,
                    on_off = held + " -mu_s 0.7";
  for (const char* way : {" -bias -0.6", " -bias -1.2", " -drag linear"}) {
    CHECK_NOTHROW(Given(on_off + way).read());
  }
  CHECK_NOTHROW(Given(held + " -mu_d 0.76").read());
  const std::vector<Refusal> refusals{
      {on_off,
       {"-mu_d = 0.5: does not hold the mean 0.75 of the noise", "for ever",
        "add drag, such as -drag linear"}},
      {held, {"add drag, such as -drag linear or take a larger -mu_d, above 0.75"}},
      {on_off + " -route monte_carlo", {"-mu_d = 0.5: does not hold the mean 0.75"}},
      {on_off + " -friction stribeck -stribeck_velocity 0.5", {"-mu_d = 0.5: does not hold"}},
      {on_off + " -bias 0.1", {"-bias = 0.1: with the mean 0.75 of the noise", "add drag"}},
      {on_off + " -bias -1.3", {"-bias = -1.3", "mu_d = 0.5 alone", "above 0.55"}},
      {on_off + " -bias -1.3 -mu_d_minus 0.4", {"-bias = -1.3", "mu_d_minus = 0.4 alone"}},
      {"-mu_d 0.5 -drag none -noise pulses -pulse_height 1.5 -pulse_rate 1 -pulse_sign up "
       "-pulse_duration 1",
       {"-mu_d = 0.5: does not hold the mean 1.5 of the noise", "take -bias -1.5"}}};
  CHECK_NOTHROW(Given(refusals.back().line + " -bias -1.5").read());
  for (const auto& refusal : refusals) check_refusal(refusal);
}

// A law is tried up to twice the terminal velocity of mu_s + delta + 12 deviations + |bias| - mu_d.
TEST_CASE("request: a drag law is tried with the largest force that occurs") {
  const std::string law = "-drag expression -drag_expression 0-10*v -mu_d 0.5 ";
  CHECK(Given(law).read().scene.drag.reach == Approx(2 * 12.625 / 10).epsilon(0.021));
  for (const std::string bias : {"3", "-3"}) {
    CHECK(Given(law + "-bias " + bias).read().scene.drag.reach ==
          Approx(2 * 15.625 / 10).epsilon(0.021));
  }
  CHECK(Given(law + "-noise_levels 16").read().scene.drag.reach ==
        Approx(2 * 1.5 / 10).epsilon(0.021));
}

TEST_CASE("request: arguments come from the file to compare with, each once") {
  const test::TemporaryFolder folder;
  const std::string file = folder / "known.csv";
  std::ofstream(file) << "quantity,argument,value,low,high\n"
                         "F_stick,0.5,1,,\nF_slide,0.5,1,,\nF_excursion,2,1,,\n"
                         "S_v,3,1,,\nf_slide,4,1,,\ncdf_stick,5,1,,\nP_stick,,1,,\n";
  const Request r = Given("-compare " + file).read();
  CHECK(r.question.lambda == std::vector<double>{0.5, 2});
  CHECK(r.question.omega == std::vector<double>{3});
  CHECK(r.question.time == std::vector<double>{4, 5});
  CHECK(r.question.quantities == std::set{Quantity::sticking, Quantity::laplace, Quantity::spectrum,
                                          cases::kPhaseDurations.quantity});
  CHECK(Given("-lambda 7 -compare " + file).read().question.lambda == std::vector<double>{7});
}

TEST_CASE("request: friction that weakens needs its speed, and Coulomb friction has none") {
  const auto friction = Given("-friction stribeck -mu_d 0.5 -stribeck_velocity 0.1").read();
  REQUIRE(friction.scene.friction.stribeck);
  CHECK(friction.scene.friction.stribeck->velocity == 0.1);
  CHECK(friction.scene.friction.stribeck->exponent == 1);
  CHECK_FALSE(Given("-mu_d 0.5").read().scene.friction.stribeck);
  const std::string law = "-friction stribeck -mu_d 0.5 -stribeck_velocity ";
  const std::vector<Refusal> refusals{
      {"-friction stribeck", {"-friction = stribeck", "add for example -stribeck_velocity"}},
      {"-stribeck_velocity 1", {"-stribeck_velocity = 1", "belongs to -friction stribeck"}},
      {"-stribeck_exponent 2 -friction coulomb", {"-stribeck_exponent = 2", "-friction stribeck"}},
      {law + "0", {"-stribeck_velocity = 0", "(0, inf)", "-friction coulomb"}},
      {law + "1 -stribeck_exponent -1", {"-stribeck_exponent = -1", "(0, inf)"}},
      {law + "1 -mu_d 2", {"-mu_d = 2", "[0, mu_s]"}},
      {law + "1 -drag none -bias 0.5", {"-bias = 0.5", "for ever"}},
      {law + "1 -drag none -route fluid_queue",
       {"needs a model without drag, b = 0, and Coulomb friction"}},
      {"-friction viscous", {"-friction = viscous", "coulomb or stribeck"}}};
  for (const auto& refusal : refusals) check_refusal(refusal);
}
