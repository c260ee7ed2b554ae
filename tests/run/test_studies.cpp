#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <stdexcept>
#include <string_view>

#include "../common/catch.hpp"
#include "../common/made_results.hpp"
#include "../common/written.hpp"
#include "stickslip/base/errors.hpp"
#include "stickslip/base/text.hpp"
#include "stickslip/cli/reports.hpp"
#include "stickslip/linalg/dense.hpp"
#include "stickslip/run/study.hpp"

using namespace stickslip;
using cases::Quantity;
using cli::Request;
using run::Study;
using run::StudyKind;
using run::Table;

namespace {

Request request(StudyKind kind, double mu_d, double delta, int steps) {
  Request r;
  r.scene.friction = {1, mu_d};
  r.scene.delta = delta;
  r.question.quantities = {Quantity::sticking, Quantity::moments};
  r.study.kind = kind;
  r.study.steps = steps;
  r.study.repeats = 1;
  return r;
}

Study result(const Request& r) { return run::run_study(PETSC_COMM_WORLD, r, r.study, {}); }

const Table& table(const Study& study, std::string_view name) {
  for (const auto& t : study.tables) {
    if (t.name == name) return t;
  }
  throw std::invalid_argument(std::string(name));
}

std::vector<double> column(const Table& t, const std::string& name) {
  for (std::size_t c = 0; c < t.columns.size(); ++c) {
    if (t.columns[c].name != name) continue;
    std::vector<double> values;
    for (const auto& row : t.rows) values.push_back(row[c]);
    return values;
  }
  throw std::invalid_argument(name);
}

}  // namespace

TEST_CASE("studies: the upwind scheme is of order 1, and Richardson's limit is better",
          "[parallel]") {
  const Study study = result(request(StudyKind::points, 0.25, 0.5, 7));
  for (const char* key : {"P_stick", "E_V2"}) {
    const Table& t = table(study, key);
    const auto kappa = column(t, "kappa"), error = column(t, "error"),
               extrapolated = column(t, "richardson_error");
    INFO(key);
    REQUIRE(t.rows.size() == 7);
    CHECK(std::isnan(kappa.front()));
    CHECK(std::isnan(kappa.back()));
    CHECK(std::abs(kappa[5] - 1) < 0.06);
    CHECK(std::abs(kappa[5] - 1) < std::abs(kappa[4] - 1));
    CHECK(extrapolated.back() < 0.1 * error.back());
    CHECK(error.back() < 0.02);
    CHECK(error.back() > 1e-3);
  }
  CHECK(study.runs.size() == 8);
  CHECK(study.runs.back().method == "hp");
}

TEST_CASE("studies: the table of p holds differences of its values, and errors against hp") {
  const Study study = result(request(StudyKind::points, 0.25, 0.5, 4));
  const auto& hp = study.runs.back();
  CHECK(hp.seconds >= hp.statistics.seconds());  // of all steps
  for (std::size_t r = 0; r < hp.results.size(); ++r) {
    const double limit = hp.results[r].value[0];
    CHECK(hp.results[r].error[0] <= 1e-10 * std::abs(limit));
    const Table& t = table(study, hp.results[r].key);
    const auto value = column(t, "value"), kappa = column(t, "kappa"),
               richardson = column(t, "richardson"), error = column(t, "error"),
               richardson_error = column(t, "richardson_error");
    INFO(t.name);
    CHECK(column(t, "p") == std::vector<double>{2, 4, 8, 16});
    for (std::size_t n = 0; n < 4; ++n) {
      const auto& of_run = study.runs[n].results[r];
      CHECK(value[n] == of_run.value[0]);
      CHECK(of_run.error[0] == std::abs(value[n] - limit));
      CHECK(error[n] == Approx(std::abs(value[n] - limit) / limit));
      if (n > 0) CHECK(richardson[n] == Approx(value[n] + (value[n] - value[n - 1])));
      if (n > 0) CHECK(richardson_error[n] == Approx(std::abs(richardson[n] - limit) / limit));
      if (n == 0 || n == 3) continue;
      const double before = value[n] - value[n - 1], after = value[n + 1] - value[n];
      CHECK(kappa[n] == Approx(std::log2(std::abs(before / after))));
    }
    const double change = std::abs(richardson[3] - richardson[2]);
    const auto& converged = study.runs.back().results[r];
    CHECK_THAT(study.conclusions[r],
               Catch::Contains(fmt::format(": order {:.3f}; Richardson {} +- {:.1e}; hp {} +- ",
                                           kappa[2], number_text(richardson[3], change), change,
                                           number_text(limit, converged.error[0]))));
  }
}

TEST_CASE("studies: without -study_steps there are eight values of p") {
  Request r = request(StudyKind::points, 0.25, 1, 8);
  r.study.steps.reset();
  CHECK(result(r).runs.size() == 9);
}

TEST_CASE(
    "studies: steps put mu_s on a level or halfway between two, and extrapolate what they found") {
  for (double mu_d : {1.0, 0.5}) {
    Request r = request(StudyKind::steps, mu_d, 0.45, 3);
    r.question.accuracy = 1e-6;
    const Study study = result(r);
    REQUIRE(study.runs.size() == 6);
    const std::vector<double> places{2, 4, 8, 2.5, 4.5, 8.5};  // mu_s/delta, nearest to 1/0.45
    for (std::size_t n = 0; n < 6; ++n) {
      CHECK(1 / study.runs[n].parameters[0].second == Approx(places[n]).epsilon(1e-14));
      CHECK(study.runs[n].parameters[1].second == 1e-9);
    }
    for (std::size_t family : {0U, 3U}) {
      const Table& t = table(study, family == 0 ? "P_stick on a level" : "P_stick between levels");
      std::vector<run::Sample> samples;
      for (std::size_t n = 0; n < 3; ++n) {
        const auto& run = study.runs[family + n];
        samples.push_back(
            {run.parameters[0].second, run.results[0].value[0], run.results[0].error[0]});
        CHECK(t.rows[n][1] == samples[n].value);
        CHECK(t.rows[n][2] == samples[n].error);
        CHECK(samples[n].error > 0);
        const double order = run::observed_order(samples);
        const auto limit = run::limit_of(samples, order, mu_d == 1);
        CHECK(std::isnan(t.rows[n][3]) == (n < 2));
        if (std::isnan(order)) continue;
        CHECK(t.rows[n][3] == order);
        CHECK(t.rows[n][4] == limit.value);
        CHECK(t.rows[n][5] == limit.error);
      }
    }
  }
}

// Grazing sliding phases: the order in delta is 2 for E_V2 and 3/2 for P_stick where mu_d = mu_s,
// else 1.
TEST_CASE("studies: orders in delta, with mu_s on a level and between two", "[slow][real]") {
  struct Case {
    double mu_d;
    const char* key;
    double order, tolerance;
  };
  for (double mu_d : {1.0, 0.25}) {
    const Study study = result(request(StudyKind::steps, mu_d, 0.25, 4));
    for (const Case& c : {Case{1, "E_V2", 2, 0.1},
                          {1, "P_stick", 1.5, 0.15},
                          {0.25, "E_V2", 1, 0.2},
                          {0.25, "P_stick", 1, 0.1}}) {
      if (c.mu_d != mu_d) continue;
      for (const char* place : {" on a level", " between levels"}) {
        INFO(c.key << place << " mu_d " << mu_d);
        CHECK(std::abs(column(table(study, std::string(c.key) + place), "order").back() - c.order) <
              c.tolerance);
      }
    }
  }
}

namespace {

/// -study tau of coarse noise without drag, whose limits are closed forms: the density of V is
/// a b/(a + b) exp(-a v) for v > 0, the same with b for v < 0, with D = 1 and slopes a, b of
/// friction and bias.
Study white(const model::Friction& friction, double bias, int steps = 7) {
  Request r = request(StudyKind::white_noise, friction.mu_d, 0.5, steps);
  r.scene.friction = friction;
  r.scene.bias = bias;
  r.scene.drag_name = "none";
  r.scene.drag = {0, 0};
  return result(r);
}

void check_limit(const Study& study, const std::string& key, double limit, double accuracy) {
  const Table& t = table(study, key);
  const double value = column(t, "limit").back(), error = column(t, "limit_error").back();
  INFO(key << " " << value << " +- " << error);
  CHECK(std::abs(value - limit) <= error);
  CHECK(error < accuracy);
}

}  // namespace

TEST_CASE("studies: the limit of white noise is that of the Fokker-Planck equation") {
  const Study study = white({1, 1}, 0);
  check_limit(study, "E_V2", 2, 1e-5);
  check_limit(study, "E_absV", 1, 1e-5);
  check_limit(study, "P_stick", 0, 1e-5);
  CHECK(std::abs(column(table(study, "E_V2"), "order").back() - 1) < 0.05);
  const auto& first = study.runs[0].parameters;
  CHECK(first[0] == std::pair<std::string, double>{"tau", 0.0625});  // delta = 2 mu_s
  CHECK(first[1].second == Approx(2).epsilon(1e-12));
  CHECK(study.runs[1].parameters[0].second == 0.0625 / 4);
  CHECK(study.runs[1].parameters[1].second == Approx(4).epsilon(1e-12));
  const auto said = [&](const std::string& text) {
    return std::any_of(study.conclusions.begin(), study.conclusions.end(),
                       [&](const auto& line) { return line.rfind(text, 0) == 0; });
  };
  CHECK(said("E_V2: order 1.0"));
  CHECK(said("P_stick: order "));
}

TEST_CASE("studies: white noise with a bias, or with friction that differs by direction",
          "[slow][real]") {
  const Study biased = white({1, 1}, 0.5);
  check_limit(biased, "E_V", 4.0 / 3, 1e-5);
  check_limit(biased, "E_V2", 56.0 / 9, 1e-5);
  model::Friction uneven{1, 1};
  uneven.mu_s_minus = uneven.mu_d_minus = 2;
  const Study drifting = white(uneven, 0);
  check_limit(drifting, "E_V", 0.5, 1e-5);
  check_limit(drifting, "E_V2", 1.5, 1e-5);
}

// Functions of an argument have a table for each value. A speed that is reached cuts the law of V,
// which brings a term in tau^(1/2); that of the spectrum at 0 is of first order.
TEST_CASE("studies: first passages and the spectrum in white noise", "[slow][real]") {
  Request r = request(StudyKind::white_noise, 1, 0.5, 6);
  r.scene.drag_name = "none";
  r.scene.drag = {0, 0};
  r.question.quantities = {Quantity::peak, Quantity::spectrum};
  r.question.velocity = {1, 1.5};
  r.question.omega = {1};
  const Study study = result(r);
  for (double w : {1.0, 1.5}) {
    const std::string key = fmt::format("mean_first_passage_rest velocity={:g}", w);
    check_limit(study, key, std::exp(w) - 1 - w, 3e-5);
    CHECK(std::abs(column(table(study, key), "order").back() - 0.5) < 0.05);
  }
  check_limit(study, "S_0", 10, 3e-5);
  // S_v = (2/omega^2) Re[1 - 4/(1 + sqrt(1 + 4 i omega))^2]
  const std::complex<double> root = 1.0 + std::sqrt(std::complex<double>(1, 4));
  check_limit(study, "S_v omega=1", 2 * (1.0 - 4.0 / (root * root)).real(), 3e-5);
}

// Whatever mu_s, bodies move as with mu_d.
TEST_CASE("studies: static friction does not act in white noise", "[slow][real]") {
  const Study study = white({1.5, 1}, 0);
  check_limit(study, "E_V2", 2, 3e-5);
  check_limit(study, "P_stick", 0, 1e-5);
  CHECK(std::count_if(study.conclusions.begin(), study.conclusions.end(), [](const auto& line) {
          return line.rfind("P_stick: ", 0) == 0 && line.find("vanishes") != line.npos;
        }) == 1);
}

namespace {

/// Of some seconds, and needed twice.
const Study& costs() {
  static const Study study = result(request(StudyKind::cost, 0.25, 0.5, 4));
  return study;
}

}  // namespace

namespace {

/// The results of the runs of one method.
std::vector<const run::Run*> runs_of(const Study& study, const std::string& method) {
  std::vector<const run::Run*> runs;
  for (const auto& run : study.runs) {
    if (run.method == method) runs.push_back(&run);
  }
  return runs;
}

double largest_error(const quantities::Results& results, const quantities::Results& known) {
  double largest = 0;
  for (std::size_t n = 0; n < results.size(); ++n) {
    REQUIRE(results[n].key == known[n].key);
    largest = std::max(largest, std::abs(results[n].value[0] / known[n].value[0] - 1));
  }
  return largest;
}

/// log10 of the time against digits: the regression line through points with errors above 1e-12.
std::string cost(const Table& t) {
  std::vector<double> x, y;
  const auto error = column(t, "error"), seconds = column(t, "seconds");
  for (std::size_t n = 0; n < error.size(); ++n) {
    if (error[n] <= 1e-12) continue;
    x.push_back(-std::log10(error[n]));
    y.push_back(std::log10(seconds[n]));
  }
  linalg::Matrix<double> normal(2, 2);
  std::vector<double> line(2);
  for (std::size_t n = 0; n < x.size(); ++n) {
    normal(0, 0) += 1;
    normal(0, 1) += x[n];
    normal(1, 0) += x[n];
    normal(1, 1) += x[n] * x[n];
    line[0] += y[n];
    line[1] += x[n] * y[n];
  }
  linalg::LuFactors(normal).solve(line, false);
  const auto at = [&](double digits) { return std::pow(10, line[0] + line[1] * digits); };
  return fmt::format("{}: one more digit takes {:.3g} times the time; error 1e-6 about {:.2g} s, "
                     "1e-9 {:.2g} s",
                     t.name, std::pow(10, line[1]), at(6), at(9));
}

}  // namespace

TEST_CASE("studies: errors and costs of each method follow from its runs", "[slow][real]") {
  const Study& study = costs();
  const auto hp = runs_of(study, "hp"), upwind = runs_of(study, "upwind"),
             simulated = runs_of(study, "monte_carlo");
  const auto& known = hp.back()->results;  // right to 1e-11
  const auto hp_error = column(table(study, "hp"), "error");
  for (std::size_t n = 0; n < 4; ++n) {
    CHECK(hp_error[n] == Approx(largest_error(hp[n]->results, known)).epsilon(1e-4));
  }
  const Table& richardson = table(study, "richardson");
  REQUIRE(richardson.rows.size() == 3);
  for (std::size_t n = 0; n < 3; ++n) {
    auto extrapolated = upwind[n + 1]->results;
    for (std::size_t r = 0; r < extrapolated.size(); ++r) {
      extrapolated[r].value[0] += extrapolated[r].value[0] - upwind[n]->results[r].value[0];
    }
    CHECK(column(richardson, "error")[n] ==
          Approx(largest_error(extrapolated, known)).epsilon(1e-4));
    CHECK(column(richardson, "seconds")[n] == upwind[n]->seconds + upwind[n + 1]->seconds);
    CHECK(column(richardson, "solve")[n] ==
          upwind[n]->statistics.solve_seconds + upwind[n + 1]->statistics.solve_seconds);
  }
  const Table& monte_carlo = table(study, "monte_carlo");
  for (std::size_t n = 0; n < simulated.size(); ++n) {
    double half = 0;
    for (const auto& r : simulated[n]->results) {
      half = std::max(half, (r.ci95[0].second - r.ci95[0].first) / 2 / std::abs(r.value[0]));
    }
    CHECK(column(monte_carlo, "error")[n] == Approx(half / 1.959963984540054).epsilon(0.02));
    CHECK(column(monte_carlo, "excursions")[n] == 1000 * std::pow(4, n));
  }
  for (std::size_t n = 0; n < study.tables.size(); ++n) {
    const auto error = column(study.tables[n], "error");
    const auto used = std::count_if(error.begin(), error.end(), [](double e) { return e > 1e-12; });
    const std::string too_few = study.tables[n].name + ": too few points for a rate of convergence";
    CHECK(study.conclusions[n] == (used < 3 ? too_few : cost(study.tables[n])));
  }
}

TEST_CASE("studies: the extrapolation of the paper is the mean of both directions") {
  std::map<run::Place, double> values;
  for (int l = 1; l <= run::kMostSteps; ++l) {
    for (int k = 1; k <= run::kMostPoints; ++k) {
      if (run::is_computed({k, l})) values[{k, l}] = 1.0 / (k * k + 3 * l);
    }
  }
  const auto known = values;
  run::extrapolate(values);
  // a + R (a - b), R = (a - b)/(b - c), at the first place that is open: p = 2^7, delta = 2^-5.
  const auto on = [&](run::Place a, run::Place b, run::Place c) {
    const double last = known.at(a) - known.at(b), before = known.at(b) - known.at(c);
    return known.at(a) + last * last / before;
  };
  CHECK(values.at({7, 5}) ==
        Approx((on({7, 4}, {7, 3}, {7, 2}) + on({6, 5}, {5, 5}, {4, 5})) / 2).epsilon(1e-13));
}

TEST_CASE("studies: the extrapolation of the paper continues with geometric changes") {
  std::map<run::Place, double> values;
  const auto truth = [](int k, int l) { return 0.3 + 0.2 * std::pow(0.5, l) + std::pow(0.4, k); };
  for (int l = 1; l <= run::kMostSteps; ++l) {
    for (int k = 1; k <= run::kMostPoints; ++k) {
      if (run::is_computed({k, l})) values[{k, l}] = truth(k, l);
    }
  }
  CHECK(values.size() == 46);
  run::extrapolate(values);
  CHECK(values.size() == 54);
  for (const auto& [place, value] : values) {
    CHECK(value == Approx(truth(place.first, place.second)).epsilon(1e-12));
  }
}

TEST_CASE("studies: reports name every run and leave gaps where there is no number") {
  Study study;
  study.kind = "p";
  study.runs.push_back(
      {"upwind", {{"delta", 0.5}, {"p", 4}}, {test::scalar("P_stick", "", 0.25, 0.125)}, 2.0, {}});
  study.tables.push_back({"P_stick",
                          "of p",
                          {{"p", run::Digits::parameter}, {"kappa", run::Digits::order}},
                          {{4, std::nan("")}}});
  study.conclusions = {"so it is"};
  const Request r = request(StudyKind::points, 0.25, 0.5, 3);
  const auto report = cli::report_of(PETSC_COMM_WORLD, r, study, {});
  const std::string& text = report.text;
  CHECK(text.find("nan") == std::string::npos);
  CHECK(text.find("so it is") != std::string::npos);
  CHECK(test::written(report, "study_csv").find("upwind,delta=0.5;p=4,P_stick,0.25,0.125,2,") !=
        std::string::npos);
  const std::string json = test::written(report, "summary");
  CHECK(json.find("\"runs\"") != std::string::npos);
  CHECK(json.find("null") != std::string::npos);
}

TEST_CASE("studies: one whose largest run would not fit is refused before the first") {
  for (StudyKind kind : {StudyKind::points, StudyKind::cost}) {
    int runs = 0;
    const auto count = [&runs](int, int, const std::string&) { ++runs; };
    const Request r = request(kind, 0.25, 1.0 / 64, 20);
    CHECK_THROWS_AS(run::run_study(PETSC_COMM_WORLD, r, r.study, count), NoMemory);
    CHECK(runs == 0);
  }
}
