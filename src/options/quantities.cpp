#include "quantities.hpp"

#include <algorithm>

#include "literal_table.hpp"
#include "stickslip/support/text.hpp"
#include "words.hpp"

namespace stickslip::options {
namespace {

// Word, what it is, solution methods that give it, options that it depends on, keys of other
// quantities that come with it, and whether it is a field or a path.
constexpr const char* kRows = R"(
sticking | probability of sticking, mean durations of the phases | excursion, lambda, hitting, null_vector, fluid_queue, monte_carlo | - | - | -
moments | moments of the velocity in the stationary distribution | excursion, lambda, null_vector, fluid_queue, monte_carlo | - | - | -
averages | stationary averages of functions of the state, overall and by phase | excursion, lambda, null_vector, monte_carlo | observable | - | -
noise_law | stationary distribution of the noise | excursion, lambda, null_vector, fluid_queue, monte_carlo | - | - | -
entry_law | hitting distribution at the onset of sticking | excursion, fluid_queue, monte_carlo | - | - | -
density | stationary distribution as a field in the file of -output | excursion | - | - | field
laplace | Laplace transforms and variances of the durations | excursion, fluid_queue, monte_carlo | lambda | mean_slide, mean_stick, mean_excursion, f_stick_0 | -
F_stick | Laplace transform of the sticking duration alone, without a solve for each lambda | excursion, fluid_queue, monte_carlo | lambda | F_stick | -
resolvent | resolvent of the generator, and its parts over one excursion | excursion, monte_carlo | lambda, observable | - | -
relaxation | leading eigenvalues of the generator, by SLEPc | excursion | - | - | -
spectrum | power spectral density of the velocity, diffusivity | excursion, monte_carlo | omega, spectrum_solver | - | -
duration_density | probability densities and distribution functions of the durations | excursion, monte_carlo | time, transient_solver | - | -
autocorrelation | autocovariance of the velocity | excursion, monte_carlo | time, transient_solver | - | -
slip | path length and net displacement of a sliding phase | excursion, monte_carlo | distance, inverse_distance | - | -
peak | largest speed of a sliding phase, mean first-passage times of |V| | excursion, monte_carlo | velocity | - | -
displacement | mean and variance of the displacement from -start | excursion, monte_carlo | time, start | - | -
expectation | expectations from -start (backward Kolmogorov equation) | excursion, monte_carlo | observable, time, start, transient_solver | - | -
trajectory | a simulated path in the file of -output or -trajectory | excursion, monte_carlo | start, horizon, seed | - | path
sensitivity | derivatives of the scalars of sticking, moments and noise_law | excursion | - | - | -
)";

}  // namespace

const std::vector<QuantityRow>& quantity_table() {
  static const auto all = [] {
    std::vector<QuantityRow> rows;
    for (const auto& cells : rows_of(kRows, 6)) {
      rows.push_back({.word = cells[0],
                      .quantity = known(kQuantities, cells[0]),
                      .title = cells[1],
                      .routes = routes_of(cells[2]),
                      .options = split(cells[3], ','),
                      .others = split(cells[4], ','),
                      .of_one_run = !cells[5].empty()});
    }
    return rows;
  }();
  return all;
}

const char* limit_of(Route route) {
  switch (route) {
  case Route::excursion: return "";
  case Route::lambda:
    return "lambda u_lambda tends to stationary averages as lambda -> 0, and gives nothing else";
  case Route::hitting: return "mean hitting times give mean durations, and nothing else";
  case Route::null_vector:
    return "the left null vector of the generator is the stationary distribution, and gives its "
           "averages alone";
  case Route::fluid_queue:
    return "the fluid queue gives the hitting distribution, durations and the moments of V up to "
           "the second";
  case Route::monte_carlo:
    return "a sample has no eigenvalues, no derivatives, and no density at a point (take averages "
           "of indicator functions such as abs(v)>0.5)";
  }
  return "";
}

std::vector<std::string> keys_of(const QuantityRow& row) {
  std::vector<std::string> keys;
  for (const auto& result : result_table()) {
    if (result.quantity == row.quantity) keys.push_back(result.key);
  }
  keys.insert(keys.end(), row.others.begin(), row.others.end());
  return keys;
}

std::optional<Quantity> asked_by(const std::string& key) {
  const ResultRow* row = find_result(key);
  return row != nullptr && row->asks ? std::optional(row->quantity) : std::nullopt;
}

bool depends_on(const Question& question, const std::string& option) {
  const auto& rows = quantity_table();
  return std::any_of(rows.begin(), rows.end(), [&](const QuantityRow& row) {
    return question.wants(row.quantity) &&
           std::count(row.options.begin(), row.options.end(), option) > 0;
  });
}

}  // namespace stickslip::options
