#include "quantities.hpp"

#include <algorithm>
#include <set>
#include <string_view>

namespace stickslip::options {
namespace {

using enum Quantity;

/// Names of the results of a quantity, but for those of observables.
struct QuantityKeys {
  Quantity quantity;
  std::vector<std::string> asking;  // that ask for it in a file to compare with
  std::vector<std::string> others = {};
};

const std::vector<QuantityKeys>& key_table() {
  static const std::vector<QuantityKeys> rows{
      {sticking, {"P_stick", "P_slide", "mean_stick", "mean_slide", "mean_excursion"}},
      {averages, {"slip_rate", "friction_power"}},
      {moments, {"E_V2", "E_absV", "E_XV", "E_V"}},
      {noise_law, {"P_X_le_mu_s", "E_X2"}},
      {entry_law, {"entry_law", "f_stick_0"}, {"entry_law_minus"}},
      {laplace, {"F_slide", "F_stick", "F_excursion"}, {"f_slide_0"}},
      {laplace, {}, {"var_slide", "var_stick", "var_excursion"}},
      {resolvent, {}, {"h_plus", "h_minus", "w_one"}},
      {resolvent, {}, {"h_plus_from_minus", "h_minus_from_minus", "w_one_from_minus"}},
      {relaxation, {}, {"relaxation_even", "relaxation_odd"}},
      {relaxation, {}, {"relaxation_even_frequency", "relaxation_odd_frequency"}},
      {relaxation, {}, {"relaxation", "relaxation_frequency"}},
      {spectrum, {"S_v", "S_0", "fwhm", "t_corr"}, {"diffusivity", "variance_from_spectrum"}},
      {duration_density, {"f_slide", "f_stick", "f_excursion"}},
      {duration_density, {"cdf_slide", "cdf_stick", "cdf_excursion"}},
      {slip, {"mean_slip", "var_slip", "f_slip", "cdf_slip"}},
      {slip, {"mean_slip_net", "var_slip_net"}, {"F_slip"}},
      {peak, {"P_peak", "mean_first_passage", "mean_first_passage_rest"}},
      {autocorrelation, {"C_vv"}},
      {displacement, {"displacement_mean", "displacement_variance"}}};
  return rows;
}

}  // namespace

const std::vector<QuantityRow>& quantity_table() {
  using enum Route;
  using Routes = std::vector<Route>;
  static const Routes all{excursion, lambda, hitting, null_vector, fluid_queue, monte_carlo},
      powers{excursion, lambda, null_vector, fluid_queue, monte_carlo},
      means{excursion, lambda, null_vector, monte_carlo},
      renewal{excursion, fluid_queue, monte_carlo}, simulated{excursion, monte_carlo},
      alone{excursion};
  static const std::vector<QuantityRow> rows{
      {"sticking", sticking, all, {}},
      {"moments", moments, powers, {}},
      {"averages", averages, means, {"observable"}},
      {"noise_law", noise_law, powers, {}},
      {"entry_law", entry_law, renewal, {}},
      {"density", density, alone, {}, true},
      {"laplace", laplace, renewal, {"lambda"}},
      {"F_stick", stick_duration_transform, renewal, {"lambda"}},
      {"resolvent", resolvent, simulated, {"lambda", "observable"}},
      {"relaxation", relaxation, alone, {}},
      {"spectrum", spectrum, simulated, {"omega", "spectrum_solver"}},
      {"duration_density", duration_density, simulated, {"time", "transient_solver"}},
      {"autocorrelation", autocorrelation, simulated, {"time", "transient_solver"}},
      {"slip", slip, simulated, {"distance", "inverse_distance"}},
      {"peak", peak, simulated, {"velocity"}},
      {"displacement", displacement, simulated, {"time", "start"}},
      {"expectation", expectation, simulated, {"observable", "time", "start", "transient_solver"}},
      {"trajectory", trajectory, simulated, {"start", "horizon", "seed"}, true},
      {"sensitivity", sensitivity, alone, {}}};
  return rows;
}

const char* limit_of(Route route) {
  switch (route) {
  case Route::excursion: return "";
  case Route::lambda: return "lambda u_lambda tends to stationary averages and to nothing else";
  case Route::hitting: return "mean hitting times hold mean durations and nothing else";
  case Route::null_vector:
    return "a null vector holds averages of the stationary distribution and nothing else";
  case Route::fluid_queue:
    return "the queue tells where and when slides end, and powers of v up to the second";
  case Route::monte_carlo:
    return "a sample has no eigenvalues, no derivatives, and no density at a point (ask for "
           "averages of indicator functions such as abs(v)>0.5)";
  }
  return "";
}

std::optional<Quantity> asked_by(const std::string& key) {
  for (const auto& row : key_table()) {
    if (std::count(row.asking.begin(), row.asking.end(), key) > 0) return row.quantity;
  }
  return std::nullopt;
}

bool depends_on(const Question& question, const std::string& option) {
  const auto& rows = quantity_table();
  return std::any_of(rows.begin(), rows.end(), [&](const QuantityRow& row) {
    return question.wants(row.quantity) &&
           std::count(row.options.begin(), row.options.end(), option) > 0;
  });
}

std::vector<std::string> plain_keys() {
  std::vector<std::string> keys;
  for (const auto& row : key_table()) {
    keys.insert(keys.end(), row.asking.begin(), row.asking.end());
    keys.insert(keys.end(), row.others.begin(), row.others.end());
  }
  return keys;
}

bool is_composed_key(const std::string& key) {
  const auto open = key.find('(');
  if (open != key.npos && key.ends_with(')')) {
    static const std::set<std::string> of{"u", "w_plus",  "w_minus",  "pi",         "mu",
                                          "E", "u_minus", "mu_minus", "stationary", "pi_lambda"};
    return of.contains(key.substr(0, open));
  }
  for (const std::string_view parameter :
       {"_dmu_d", "_dmu_d_minus", "_dmu_s", "_dstribeck_velocity", "_dtau", "_ddrag_coefficient"}) {
    if (!key.starts_with('d') || !key.ends_with(parameter)) continue;
    const std::size_t ends = 1 + parameter.size();
    if (key.size() > ends && asked_by(key.substr(1, key.size() - ends))) return true;
  }
  return false;
}

}  // namespace stickslip::options
