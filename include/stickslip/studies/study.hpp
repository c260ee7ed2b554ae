#pragma once
/// Series of runs that show how results depend on the discretisation, and what accuracy costs.

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "stickslip/accuracy/carry_out.hpp"
#include "stickslip/options/request.hpp"

namespace stickslip::studies {

/// One run of a series.
struct Run {
  std::string method;                                      ///< hp, upwind, monte_carlo
  std::vector<std::pair<std::string, double>> parameters;  ///< what sets it apart, by option
  quantities::Results results = {};                        ///< scalars
  double seconds = 0;                                      ///< median of the repeated runs
  petsc::SolverStatistics statistics =
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
[[nodiscard]] Study run_study(MPI_Comm comm, const cases::Case& given,
                              const options::StudyOptions& study, const StudyProgress& progress);

}  // namespace stickslip::studies
