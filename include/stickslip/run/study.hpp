#pragma once
/// Series of runs that show how results depend on the discretisation, and what accuracy costs.

#include <functional>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "stickslip/base/uncertain.hpp"
#include "stickslip/case/case.hpp"
#include "stickslip/run/carry_out.hpp"

namespace stickslip::run {

/// -study: series of runs.
enum class StudyKind { none, points, steps, white_noise, heuristic, cost };

/// Choices of a study.
struct StudyOptions {
  StudyKind kind = StudyKind::none;
  std::optional<int> steps;  ///< length of a series, if fixed by the user
  int repeats = 3;           ///< runs of which the median time is taken
};

/// One run of a series.
struct Run {
  std::string method;                                      ///< hp, upwind, monte_carlo
  std::vector<std::pair<std::string, double>> parameters;  ///< what sets it apart, by option
  quantities::Results results = {};                        ///< scalars
  double seconds = 0;                                      ///< median of the repeated runs
  linalg::SolverStatistics statistics =
      {};                    ///< of the run that took this long, none of a simulation
  std::string failure = {};  ///< why some of its results have no values
};

/// How many digits of a column are printed; files hold all.
enum class Digits {
  parameter,   ///< those that it was given with
  supported,   ///< those that its error supports, which the next column holds
  compared,    ///< ten, of which differences are looked at
  error,       ///< two
  order,       ///< three behind the point
  measurement  ///< three
};

struct Column {
  std::string name;
  Digits digits;
};

/// Numbers in rows and named columns; NaN where there is none.
struct Table {
  std::string name;   ///< such as "P_stick" or "cost hp"
  std::string title;  ///< a line for people
  std::vector<Column> columns;
  std::vector<std::vector<double>> rows;
};

struct Study {
  std::string kind;
  std::vector<Run> runs;
  std::vector<Table> tables;
  std::vector<std::string> conclusions;  ///< in words
  bool complete = true;                  ///< whether no run failed
};

/// Called on all ranks before each run with its number, how many there are, and what it is.
using StudyProgress = std::function<void(int, int, const std::string&)>;

/// -study, by its kind:
///
/// p: the upwind scheme on p = 2, 4, ... points per noise step, observed order
///   kappa(p) = log2(|u^p - u^(p/2)|/|u^2p - u^p|), Richardson's extrapolation 2 u^2p - u^p, and
///   the distances of both from the converged hp value.
/// delta: the converged values for falling noise steps, in two families: mu_s on a noise level, and
/// halfway between two; observed order and limit. tau: the same for falling correlation times, with
/// delta a fixed share of the deviation. heuristic: the extrapolation in (p, delta) of the
/// paper, with its index sets, beside converged
///   values.
/// cost: error against time for upwind, Richardson, hp and Monte Carlo.
///
/// A run that fails leaves the others alone, but on several ranks. Collective. Throws what such
/// runs throw.
[[nodiscard]] Study run_study(MPI_Comm comm, const cases::Case& given, const StudyOptions& study,
                              const StudyProgress& progress);

// Limits of values at falling noise steps or correlation times.

/// A value and the delta or tau it belongs to.
struct Sample {
  double at, value, error;
};

/// q for which the last three samples fit u + C delta^q; NaN if there is none, or their changes are
/// within their errors.
[[nodiscard]] double observed_order(std::span<const Sample> samples);

/// u of u + C_1 delta^p_1 + C_2 delta^p_2 + ..., through as many of the last samples as make the
/// error smallest: the change that leaving the last sample out would make, and the errors of the
/// samples as they are weighted. The powers are 1, 2, 3, ... for mu_d < mu_s, and go by halves from
/// 3/2 or 2 on, whichever is nearer to the observed order, for mu_d = mu_s, where a layer of
/// grazing bodies is sqrt(delta) wide; so it was found of all means and probabilities. An observed
/// order more than 1/4 away from the first power stands for itself: then the last two samples are
/// extrapolated with it, and the error is the change from one such limit to the next. NaN where
/// they fit no order. O(n^4) for n samples.
[[nodiscard]] Uncertain limit_of(std::span<const Sample> samples, double order, bool grazing);

/// u of u + C_1 tau^(1/2) + C_2 tau + C_3 tau^(3/2) + ..., whichever of them are 0. The error is
/// the larger of the changes that the last sample and the last power make, and the errors of the
/// samples as they are weighted; as many powers are taken as make it smallest. None where the
/// changes of the samples grow.
[[nodiscard]] Uncertain limit_in_half_powers(std::span<const Sample> samples);

// The extrapolation in p and delta of the paper.

/// p = 2^k, delta = 2^-l.
using Place = std::pair<int, int>;
constexpr int kMostPoints = 9, kMostSteps = 6;  // k and l go from 1 up to these

/// Whether (k, l) lies in the set that the paper's memory allows to compute.
[[nodiscard]] bool is_computed(const Place& place);

/// Fills the places that are not computed: S = (S_V + S_H)/2, where S_V continues the three values
/// at l - 1, l - 2, l - 3 by the ratio of their changes, and S_H those at k - 1, k - 2, k - 3.
void extrapolate(std::map<Place, double>& values);

}  // namespace stickslip::run
