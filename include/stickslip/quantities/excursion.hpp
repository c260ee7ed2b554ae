#pragma once
/// What follows for the stationary distribution from means over one excursion from s+.

#include <functional>
#include <vector>

#include "stickslip/generator/discretisation.hpp"
#include "stickslip/quantities/results.hpp"

namespace stickslip::quantities {

/// Means over one excursion, which starts at s+ = (x_{k+1}, +1, 0), slides, sticks and ends at
/// the next exit. Positions are symmetry-reduced: (x, y, v) stands for (-x, -y, -v) as well, such
/// that y >= 0. Arrays run over noise nodes and over static levels from the lowest one up. Without
/// symmetry, the means are over excursions from s+, from s- and from all other starts in the shares
/// in which they occur, and what belongs to v < 0 follows what belongs to v > 0, counted along the
/// nodes of -X.
struct Excursion {
  std::vector<double> slide_time;      ///< time spent sliding on node n [time]
  std::vector<double> slide_distance;  ///< int |V| dt on node n [velocity time]
  std::vector<double> slide_square;    ///< int V^2 dt on node n
  std::vector<double> entry;  ///< probability that sliding ends on symmetry-reduced level i
  /// The same of sliding phases upwards alone, by level of the noise; empty unless it is known.
  std::vector<double> entry_plus;
  std::vector<double> entry_minus;  ///< of those downwards; empty if symmetry-reduced
  std::vector<double> stick_time;   ///< time spent sticking on symmetry-reduced level i [time]
  double lost_probability = 0;      ///< sum of entry less 1, before it was scaled to 1

  /// int V dt over a sliding phase [velocity time]; 0 if symmetry-reduced.
  [[nodiscard]] double mean_drift(const generator::Nodes& noise) const;
  [[nodiscard]] double mean_slide() const;      ///< E[tau_hat_1], section 4.3 of the paper [time]
  [[nodiscard]] double mean_stick() const;      ///< E[tau_1 - tau_hat_1] [time]
  [[nodiscard]] double mean_excursion() const;  ///< E[tau_1] [time]

  /// Relative violation of an identity that holds exactly on every discretisation: by renewal,
  /// the time spent on levels that do not stick is their probability times E[tau_1]. What is left
  /// is rounding, of the matrix entries too, which residuals do not see. The square of
  /// lost_probability is added: scaling has removed its first order. Of a body that never rests,
  /// how far the distribution of the noise is from its own.
  [[nodiscard]] double conservation_defect(const generator::Discretisation& discretisation) const;
};

/// The levels from which excursions start, a Markov chain: s+ and s- where the noise jumps to
/// neighbours.
struct Starts {
  std::vector<int> levels;
  std::vector<double> shares;  ///< of excursions that start there
  /// By rows: P(an excursion from this level is followed by one from that level).
  std::vector<double> next;

  /// Those above the static levels alone, which all are with symmetry.
  [[nodiscard]] static Starts upwards(const model::Process& process);
  [[nodiscard]] std::size_t size() const { return levels.size(); }
};

/// That chain, given where sliding phases from each level end. Its shares are found without
/// subtraction. O(starts^3).
[[nodiscard]] Starts chain_of_starts(const model::Process& process, std::vector<int> levels,
                                     const std::vector<Excursion>& from);

/// Means over all excursions from those over excursions from each start.
[[nodiscard]] Excursion joined(const model::Process& process, const Starts& starts,
                               const std::vector<Excursion>& from);

/// What appends results that follow from means over an excursion.
using FunctionOfExcursion =
    std::function<void(const generator::Discretisation&, const Excursion&, Results&)>;

/// P_stick, P_slide, mean_stick, mean_slide, mean_excursion; ratios of positive sums.
void append_sticking(const Excursion& excursion, Results& results);

/// E_V2, E_absV, E_XV and E_V (0 where symmetry makes it so).
void append_moments(const generator::Discretisation& discretisation, const Excursion& excursion,
                    Results& results);

/// entry_law: P(X = x_k when the first sliding phase from s+ ends) on the static levels k, without
/// symmetry entry_law_minus, the same from s-, and f_stick_0.
void append_hitting_distribution(const model::Process& process, const Excursion& excursion,
                                 Results& results);

/// The density of sticking times at 0+ [1/time]: the rate of leaving at once, where sliding phases
/// end on the static levels with these probabilities.
[[nodiscard]] double stick_density_at_zero(const model::Process& process,
                                           const std::vector<double>& entry);

/// P_X_le_mu_s and E_X2 of the noise alone, from its distribution in closed form.
void append_noise_distribution(const model::Process& process, Results& results);

/// dP_X_le_mu_s_dtau and dE_X2_dtau, at the number of levels of the process; nothing for a noise
/// from a table. Local. O(N).
void append_noise_sensitivity(const model::Process& process, Results& results);

/// Leaves out the results that are about excursions from s+ or s- if the noise has no such level.
void leave_out_missing_side(const model::Process& process, Results& results);

/// Leaves out mean durations where Process::starts_at_balance(), and f_stick_0 where the noise has
/// no levels: it is infinite.
void leave_out_uncountable(const model::Process& process, Results& results);

/// The stationary distribution of X as the excursion sees it, summed over the grid, from the lowest
/// level up; with symmetry halved for x and -x.
[[nodiscard]] std::vector<double> marginal_of_noise(const generator::Discretisation& discretisation,
                                                    const Excursion& excursion);

}  // namespace stickslip::quantities
