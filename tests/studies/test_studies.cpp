#include <catch2/catch.hpp>
#include <cmath>
#include <stdexcept>

#include "stickslip/io/study_report.hpp"
#include "stickslip/studies/extrapolation.hpp"
#include "stickslip/studies/study.hpp"
#include "stickslip/support/errors.hpp"

using namespace stickslip;
using options::Quantity;
using options::Request;
using options::StudyKind;
using studies::Study;
using studies::Table;

namespace {

Request request(StudyKind kind, double mu_d, double delta, int steps) {
  Request r;
  r.scene.friction = {1, mu_d};
  r.scene.delta = delta;
  r.quantities = {Quantity::sticking, Quantity::moments};
  r.study = kind;
  r.study_steps = steps;
  r.study_repeats = 1;
  return r;
}

Study conducted(const Request& r) { return studies::conduct(PETSC_COMM_WORLD, r, {}); }

const Table& table(const Study& study, const std::string& name) {
  for (const auto& t : study.tables) {
    if (t.name == name) return t;
  }
  throw std::invalid_argument(name);
}

std::vector<double> column(const Table& t, const std::string& name) {
  for (std::size_t c = 0; c < t.columns.size(); ++c) {
    if (t.columns[c] != name) continue;
    std::vector<double> values;
    for (const auto& row : t.rows) values.push_back(row[c]);
    return values;
  }
  throw std::invalid_argument(name);
}

}  // namespace

TEST_CASE("studies: the upwind scheme is of order 1, and Richardson's limit is better",
          "[parallel]") {
  const Study study = conducted(request(StudyKind::points, 0.25, 0.5, 7));
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

// Grazing slides: the order in delta is 2 for E_V2 and 3/2 for P_stick where mu_d = mu_s, else 1.
TEST_CASE("studies: orders in delta, with mu_s on a level and between two", "[slow][real]") {
  struct Case {
    double mu_d;
    const char* key;
    double order, tolerance;
  };
  for (double mu_d : {1.0, 0.25}) {
    const Study study = conducted(request(StudyKind::steps, mu_d, 0.25, 4));
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

TEST_CASE("studies: both families have the same limit in delta", "[slow][real]") {
  const Study study = conducted(request(StudyKind::steps, 0.5, 0.25, 5));
  for (const std::string key : {"P_stick", "E_V2"}) {
    const Table &on = table(study, key + " on a level"),
                &off = table(study, key + " between levels");
    const double apart = std::abs(column(on, "limit").back() - column(off, "limit").back());
    INFO(key << " apart " << apart);
    CHECK(apart < column(on, "limit_error").back() + column(off, "limit_error").back());
  }
}

TEST_CASE("studies: what accuracy costs", "[slow][real]") {
  const Study study = conducted(request(StudyKind::cost, 0.25, 0.5, 4));
  const auto hp = column(table(study, "hp"), "error"),
             upwind = column(table(study, "upwind"), "error"),
             extrapolated = column(table(study, "richardson"), "error"),
             simulated = column(table(study, "monte_carlo"), "error");
  CHECK(hp.front() > 1e-4);
  CHECK(hp.back() < 1e-11);
  for (std::size_t n = 1; n < upwind.size(); ++n) CHECK(upwind[n] < upwind[n - 1]);
  CHECK(extrapolated.back() < upwind.back());
  // Four times the excursions, half the error.
  CHECK(simulated.back() < 0.6 * simulated[simulated.size() - 2]);
  for (const auto& t : study.tables) {
    for (double seconds : column(t, "seconds")) CHECK(seconds > 0);
  }
  CHECK(study.conclusions.size() == 4);
}

TEST_CASE("studies: the extrapolation of the paper goes on with geometric changes") {
  std::map<studies::Place, double> values;
  const auto truth = [](int k, int l) { return 0.3 + 0.2 * std::pow(0.5, l) + std::pow(0.4, k); };
  for (int l = 1; l <= studies::kMostSteps; ++l) {
    for (int k = 1; k <= studies::kMostPoints; ++k) {
      if (studies::is_computed({k, l})) values[{k, l}] = truth(k, l);
    }
  }
  CHECK(values.size() == 46);
  studies::extrapolate(values);
  CHECK(values.size() == 54);
  for (const auto& [place, value] : values) {
    CHECK(value == Approx(truth(place.first, place.second)).epsilon(1e-12));
  }
}

TEST_CASE("studies: reports name every run and leave gaps where there is no number") {
  Study study;
  study.kind = "p";
  study.runs.push_back({"upwind",
                        {{"delta", 0.5}, {"p", 4}},
                        {quantities::scalar("P_stick", "", 0.25, 0.125)},
                        2.0,
                        {}});
  study.tables.push_back({"P_stick", "of p", {"p", "kappa"}, {{4, std::nan("")}}});
  study.conclusions = {"so it is"};
  const Request r = request(StudyKind::points, 0.25, 0.5, 3);
  const std::string text = io::study_table(r, study, {});
  CHECK(text.find("nan") == std::string::npos);
  CHECK(text.find("so it is") != std::string::npos);
  CHECK(io::study_csv(study).find("upwind,delta=0.5;p=4,P_stick,0.25,0.125,2,") !=
        std::string::npos);
  const std::string json = io::study_summary(PETSC_COMM_WORLD, r, study, {});
  CHECK(json.find("\"runs\"") != std::string::npos);
  CHECK(json.find("null") != std::string::npos);
}

TEST_CASE("studies: one whose largest run would not fit is refused before the first") {
  for (StudyKind kind : {StudyKind::points, StudyKind::cost}) {
    int runs = 0;
    const auto count = [&runs](int, int, const std::string&) { ++runs; };
    const Request r = request(kind, 0.25, 1.0 / 64, 20);
    CHECK_THROWS_AS(studies::conduct(PETSC_COMM_WORLD, r, count), NoMemory);
    CHECK(runs == 0);
  }
}
