#include "stickslip/options/result_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "literal_table.hpp"
#include "words.hpp"

namespace stickslip::options {
namespace {

// Quantity, key, symbol, definition, unit, abscissa, convention, equation of the paper, solution
// methods that give the quantity without it, and whether it asks for its quantity.
constexpr const char* kRows = R"(
sticking | P_stick | P_stick | probability of sticking: share of the time at rest | - | - | average per time | (4.5), (4.6), S^1 in (5.1) | - | asks
sticking | P_slide | 1 - P_stick | share of the time in sliding phases, computed without the subtraction | - | - | average per time | (4.10) | - | asks
sticking | mean_stick | E_exc[T_stick] | mean duration of a sticking phase | time | - | average per excursion | (4.6) | lambda | asks
sticking | mean_slide | E_exc[T_slide] | mean duration of a sliding phase | time | - | average per excursion | R^(s+) in (4.7) | lambda | asks
sticking | mean_excursion | E_exc[T], T = T_slide + T_stick | mean duration of an excursion | time | - | average per excursion; T is tau_1 of the paper | Prop. 3.1, (4.8), (4.9) | lambda | asks
moments | E_V2 | E[V^2] | second moment of the velocity | velocity^2 | - | about 0: Var V = E_V2 - E_V^2 | S^2 in (5.1) | - | asks
moments | E_absV | E[|V|] | mean speed | velocity | - | average per time | - | - | asks
moments | E_XV | E[X V] | mean power of the noise, per unit mass | force*velocity | - | X without the bias g: E[(X + g) V] = E[F|V|] - E[b(V) V] | - | - | asks
moments | E_V | E[V] | mean velocity | velocity | - | exactly 0 with symmetry | - | - | asks
averages | pi(f) | pi(f) = E[f(Z)] | stationary average of each observable f of -observable | [f] | - | average per time; Z = (X, Y, V) | (3.17), (4.1) | - | -
averages | pi(f|stick) | E[f(Z) given Y = 0] | average of f over the time at rest | [f] | - | average per time at rest | - | - | -
averages | pi(f|slide) | E[f(Z) given Y != 0] | average of f over the time in sliding phases | [f] | - | average per time in motion | - | - | -
averages | slip_rate | 1/E_exc[T] | mean number of sliding phases per unit time | 1/time | - | average per time | - | lambda | asks
averages | friction_power | E[F|V|] | mean power dissipated by dry friction, per unit mass | force*velocity | - | average per time | - | - | asks
noise_law | P_X_le_mu_s | P(|X| <= mu_s) | probability that the noise alone is within the static threshold, in motion or at rest | - | - | X without the bias, mu_s that of -mu_s | S^3 in (5.1) | - | asks
noise_law | E_X2 | E[X^2] | second moment of the noise | force^2 | - | about 0; 1/tau for -noise ou with all levels | sec. 2 | - | asks
entry_law | entry_law | P^_k(s+) | hitting distribution at the onset of sticking: probability that X = x_k when the sliding phase from s+ ends | - | k | sums to 1 over the levels that stick | (4.13) | - | asks
entry_law | entry_law_minus | P^_k(s-) | the same as entry_law for the sliding phase from s- | - | k | without symmetry only | - | - | -
entry_law | f_stick_0 | f_stick(0+) | limit of the probability density of sticking durations at t -> 0+ | 1/time | - | average per excursion | sec. 5.3 | - | asks
laplace | F_slide | E_exc[exp(-lambda T_slide)] | Laplace transform of the sliding duration | - | lambda | 1 at lambda = 0 | (4.16) to (4.19) | - | asks
laplace | F_stick | E_exc[exp(-lambda T_stick)] | Laplace transform of the sticking duration | - | lambda | 1 at lambda = 0 | (4.12) to (4.15) | - | asks
laplace | F_excursion | E_exc[exp(-lambda T)] | Laplace transform of the duration of an excursion | - | lambda | h_plus + h_minus, with symmetry | (3.5) | - | asks
laplace | var_slide | Var T_slide | variance of the sliding duration | time^2 | - | average per excursion | - | fluid_queue | -
laplace | var_stick | Var T_stick | variance of the sticking duration | time^2 | - | average per excursion | - | fluid_queue | -
laplace | var_excursion | Var T | variance of the duration of an excursion | time^2 | - | average per excursion | - | fluid_queue | -
laplace | f_slide_0 | f_slide(0+) | limit of the probability density of sliding durations at t -> 0+ | 1/time | - | 0 unless one jump of the noise from x_(k+1) reverses the force | sec. 5.3 | fluid_queue, monte_carlo | -
resolvent | h_plus | h+_lambda(s+) | E_s+[exp(-lambda T) 1{end at s+}]: transform of the duration of the excursion from s+, on the event that it ends at s+ | - | lambda | probability of that event at lambda = 0 | (3.5), (3.10) | - | -
resolvent | h_minus | h-_lambda(s+) | E_s+[exp(-lambda T) 1{end at s-}]: the same on the event that it ends at s- | - | lambda | probability of that event at lambda = 0 | (3.5), (3.11) | - | -
resolvent | w_one | w_lambda(s+; 1) | E_s+[int_0^T exp(-lambda t) dt]: discounted duration of the excursion from s+ | time | lambda | its mean duration at lambda = 0 | (3.6), (3.12) | - | -
resolvent | h_plus_from_minus | h+_lambda(s-) | the same as h_plus for the excursion from s- | - | lambda | without symmetry only | (3.5) | - | -
resolvent | h_minus_from_minus | h-_lambda(s-) | the same as h_minus for the excursion from s- | - | lambda | without symmetry only | (3.5) | - | -
resolvent | w_one_from_minus | w_lambda(s-; 1) | the same as w_one for the excursion from s- | time | lambda | without symmetry only | (3.6) | - | -
resolvent | u(f) | u_lambda(s+; f) | resolvent (lambda - L)^-1 f at s+: E_s+[int_0^inf exp(-lambda t) f(Z_t) dt] | [f]*time | lambda | not given where a lambda is 0 | (3.1), (3.2), (3.15) | - | -
resolvent | w_plus(f) | w_lambda(s+; f) | E_s+[int_0^T exp(-lambda t) f(Z_t) dt]: discounted integral of f over the excursion from s+ | [f]*time | lambda | finite at lambda = 0 | (3.6), (3.12) | - | -
resolvent | w_minus(f) | w_lambda(s-; f) | the same as w_plus(f) for the excursion from s- | [f]*time | lambda | finite at lambda = 0 | (3.6), (3.12) | - | -
resolvent | pi_lambda(f) | pi_lambda(f) | discounted average, which tends to pi(f) as lambda -> 0 | [f] | lambda | its key is pi(f) where averages is not asked for | (3.16) | - | -
resolvent | mu(f) | mu_lambda(f) | u_lambda(s+; f) - pi_lambda(f)/lambda | [f]*time | lambda | finite at lambda = 0 | (3.16) | - | -
resolvent | u_minus(f) | u_lambda(s-; f) | the same as u(f) at s- | [f]*time | lambda | without symmetry only | (3.1) | - | -
resolvent | mu_minus(f) | u_lambda(s-; f) - pi_lambda(f)/lambda | the same as mu(f) at s- | [f]*time | lambda | without symmetry only | - | - | -
relaxation | relaxation_even | Re lambda_n, even | relaxation rates: real parts of the leading eigenvalues of -L on even functions of the state | 1/time | mode | slowest first; with symmetry only | - | - | -
relaxation | relaxation_even_frequency | Im lambda_n, even | angular frequencies of these modes | 1/time | mode | >= 0: one of each conjugate pair | - | - | -
relaxation | relaxation_odd | Re lambda_n, odd | relaxation rates on odd functions of the state | 1/time | mode | slowest first; with symmetry only | - | - | -
relaxation | relaxation_odd_frequency | Im lambda_n, odd | angular frequencies of these modes | 1/time | mode | >= 0: one of each conjugate pair | - | - | -
relaxation | relaxation | Re lambda_n | relaxation rates on all functions of the state | 1/time | mode | slowest first; without symmetry only | - | - | -
relaxation | relaxation_frequency | Im lambda_n | angular frequencies of these modes | 1/time | mode | >= 0: one of each conjugate pair | - | - | -
spectrum | S_v | S_v(omega) | power spectral density of V - E[V] | velocity^2*time | omega | two-sided, angular frequency: int C_vv(t) exp(-i omega t) dt over all t; Var V = (1/2 pi) int S_v domega | (4.2) to (4.4) | - | asks
spectrum | S_0 | S_v(0) | power spectral density at frequency 0 | velocity^2*time | - | as S_v | sec. 5.3 | - | asks
spectrum | diffusivity | D = S_v(0)/2 | diffusivity: the variance of the displacement grows like 2 D t | velocity^2*time | - | about the drift E[V] t | - | - | -
spectrum | fwhm | Delta omega | full width at half maximum: twice the omega where S_v = S_0/2 | 1/time | - | angular frequency | sec. 5.3 | monte_carlo | asks
spectrum | t_corr | 1/Delta omega | correlation time of the velocity | time | - | inverse of fwhm | sec. 5.3 | monte_carlo | asks
spectrum | variance_from_spectrum | (1/2 pi) int S_v domega | variance of V from the spectrum (Wiener-Khinchin) | velocity^2 | - | compare with E_V2 - E_V^2 | - | monte_carlo | -
duration_density | f_slide | f_slide(t) | probability density of the sliding duration | 1/time | time | monte_carlo: average over a cell | sec. 5.3 | - | asks
duration_density | cdf_slide | P(T_slide <= t) | distribution function of the sliding duration | - | time | average per excursion | - | - | asks
duration_density | f_stick | f_stick(t) | probability density of the sticking duration | 1/time | time | monte_carlo: average over a cell | sec. 5.3 | - | asks
duration_density | cdf_stick | P(T_stick <= t) | distribution function of the sticking duration | - | time | average per excursion | - | - | asks
duration_density | f_excursion | f(t) | probability density of the duration of an excursion | 1/time | time | monte_carlo: average over a cell | sec. 5.3 | - | asks
duration_density | cdf_excursion | P(T <= t) | distribution function of the duration of an excursion | - | time | average per excursion | - | - | asks
autocorrelation | C_vv | E[(V_0 - m)(V_t - m)] | autocovariance of the velocity, m = E[V] | velocity^2 | time | stationary start; C_vv(0) = Var V | sec. 4.2 | - | asks
slip | mean_slip | E_exc[S], S = int |V| dt | mean path length of a sliding phase | velocity*time | - | average per excursion: E_exc[S] = E_absV mean_excursion | - | - | asks
slip | var_slip | Var S | variance of the path length | velocity^2*time^2 | - | average per excursion | - | - | asks
slip | mean_slip_net | E_exc[int V dt] | mean net displacement of a sliding phase | velocity*time | - | exactly 0 with symmetry | - | - | asks
slip | var_slip_net | Var int V dt | variance of the net displacement | velocity^2*time^2 | - | average per excursion | - | - | asks
slip | f_slip | f_slip(d) | probability density of the path length | 1/(velocity*time) | distance | monte_carlo: average over a cell | - | - | asks
slip | cdf_slip | P(S <= d) | distribution function of the path length | - | distance | average per excursion | - | - | asks
slip | F_slip | E_exc[exp(-s S)] | Laplace transform of the path length | - | inverse_distance | 1 at s = 0 | - | - | -
peak | P_peak | P(max|V| > w) | probability that a sliding phase exceeds the speed w | - | velocity | average per excursion | - | - | asks
peak | mean_first_passage | E[inf{t: |V_t| = w}] | mean first-passage time of the speed to w, from the start of a sliding phase | time | velocity | sticking phases on the way count | - | - | asks
peak | mean_first_passage_rest | E[inf{t: |V_t| = w}] | mean first-passage time of the speed to w, from V = 0 with X in its stationary distribution | time | velocity | as with -start rest | - | - | asks
displacement | displacement_mean | E[x(t)], x(t) = int_0^t V ds | mean displacement from the state of -start | velocity*time | time | E[V] t with -start stationary | - | - | asks
displacement | displacement_variance | Var x(t) | variance of the displacement from the state of -start | velocity^2*time^2 | time | about its mean; grows like 2 D t | - | - | asks
expectation | E(f) | E[f(Z_t) given Z_0] | expectation of each observable f at time t, from the state of -start | [f] | time | solution of the backward Kolmogorov equation | (2.21), (2.22) | - | -
expectation | stationary(f) | pi(f) | limit of E(f) for t -> infinity | [f] | - | average per time | (3.17) | - | -
sensitivity | dA_dp | dA/dp | derivative of each scalar A of sticking, moments and noise_law that is asked for, such as dP_stick_dtau | [A]/[p] | - | p: mu_d, mu_d_minus if given, tau at fixed N, drag_coefficient, with -friction stribeck also mu_s and stribeck_velocity; the static levels are held fixed | - | - | -
)";

ResultRow row_from(const std::vector<std::string>& cells) {
  return {.key = cells[1],
          .quantity = known(kQuantities, cells[0]),
          .symbol = cells[2],
          .definition = cells[3],
          .unit = cells[4],
          .abscissa = cells[5],
          .convention = cells[6],
          .paper = cells[7],
          .without = routes_of(cells[8]),
          .asks = cells[9] == "asks"};
}

// Whether `key` is the derivative of a scalar by a parameter, such as dP_stick_dtau.
bool is_derivative(std::string_view key) {
  const auto derivable = [](const ResultRow* of) {
    using enum Quantity;
    return of != nullptr &&
           (of->quantity == sticking || of->quantity == moments || of->quantity == noise_law);
  };
  if (!key.starts_with('d')) return false;
  for (const std::string_view by :
       {"_dmu_d", "_dmu_d_minus", "_dmu_s", "_dstribeck_velocity", "_dtau", "_ddrag_coefficient"}) {
    const std::size_t ends = 1 + by.size();
    const bool has_both = key.size() > ends && key.ends_with(by);
    if (has_both && derivable(find_result(key.substr(1, key.size() - ends)))) return true;
  }
  return false;
}

// pi(f|stick) for pi(v^2|stick), dA_dp for dP_stick_dtau, and any other key as it is.
std::string pattern_of(std::string_view key) {
  const auto open = key.find('(');
  if (open == key.npos || !key.ends_with(')')) {
    return is_derivative(key) ? "dA_dp" : std::string(key);
  }
  for (const std::string_view phase : {"|stick)", "|slide)"}) {
    if (key.ends_with(phase)) return fmt::format("{}(f{}", key.substr(0, open), phase);
  }
  return fmt::format("{}(f)", key.substr(0, open));
}

const ResultRow& row_of(std::string_view key) {
  const ResultRow* row = find_result(key);
  if (row == nullptr) throw std::logic_error(fmt::format("{} is no result of the table", key));
  return *row;
}

}  // namespace

bool ResultRow::is_pattern() const { return unit.find('[') != unit.npos; }

std::span<const ResultRow> result_table() {
  static const auto all = [] {
    std::vector<ResultRow> rows;
    for (const auto& cells : rows_of(kRows, 10)) rows.push_back(row_from(cells));
    return rows;
  }();
  return all;
}

const ResultRow* find_result(std::string_view key) {
  const std::string pattern = pattern_of(key);
  const auto all = result_table();
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&](const ResultRow& row) { return row.key == pattern; });
  return found == all.end() ? nullptr : &*found;
}

std::string unit_of(std::string_view key) {
  const ResultRow& row = row_of(key);
  return row.is_pattern() ? "" : row.unit;
}

std::string abscissa_of(std::string_view key) { return row_of(key).abscissa; }

}  // namespace stickslip::options
