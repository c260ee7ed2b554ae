#pragma once
/// A validated run: the scene, the questions, the method and where the answers go.

#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "stickslip/model/observable.hpp"
#include "stickslip/model/scene.hpp"
#include "stickslip/options/reference.hpp"

namespace stickslip::options {

/// What can be asked for by -quantities.
enum class Quantity {
  sticking,
  moments,
  noise_law,
  entry_law,
  density,
  laplace,
  stay_transform,
  resolvent,
  relaxation,
  spectrum,
  duration_density,
  autocorrelation,
  expectation,
  trajectory,
  sensitivity
};

/// Discretisation in v; `none` for the fluid queue, which needs none.
enum class Scheme { hp, upwind, none };

/// What factors the sliding operator, and where they go; the PETSc options of -slide_ decide.
/// `own`: what fits the discretisation, element by element or by MUMPS in memory.
enum class Factors { own, elements, in_memory, on_disk, incomplete };

/// By which system of equations.
enum class Route { excursion, lambda, hitting, null_vector, fluid_queue, monte_carlo };

/// How functions of time are computed.
enum class TransientSolver { krylov, stepping };

/// How the spectrum is computed.
enum class SpectrumSolver { krylov, direct };

/// -study: series of runs.
enum class StudyKind { none, points, steps, heuristic, cost };

/// Whether a route works on both signs of v, unfolded.
[[nodiscard]] inline bool on_full_grid(Route route) {
  return route == Route::lambda || route == Route::hitting || route == Route::null_vector;
}

/// Choices of the discretisation made by hand; a degree, layers or points switch refinement off.
struct Method {
  Scheme scheme = Scheme::hp;
  std::optional<int> degree, layers;  ///< hp
  std::optional<int> points;          ///< upwind, per noise step
  std::optional<int> noise_degree;    ///< hp; 0: every noise level is a node
  double noise_grading = 2;           ///< hp
  Factors factors = Factors::own;

  [[nodiscard]] bool fixed() const {
    return degree || layers || points || noise_degree.value_or(0) > 0;
  }
};

class Sweep;

struct Request {
  model::Scene scene;
  std::set<Quantity> quantities;
  std::vector<double> lambda;                  ///< of laplace and resolvent; one for -route lambda
  std::vector<model::Observable> observables;  ///< of resolvent and expectation
  std::vector<double> omega;                   ///< of spectrum
  std::vector<double> time;                    ///< of functions of time
  int start_level = 0;                         ///< of expectation: x_i and v at time 0
  double start_v = 0;
  double accuracy = 1e-6;
  bool accuracy_given = false;        ///< by the user
  double excursions = 1e6;            ///< of -route monte_carlo, at most
  std::uint64_t seed = 1;             ///< of whatever is simulated
  double horizon = 100;               ///< end of the trajectory [time]
  std::vector<Reference> references;  ///< of -compare
  bool plan_only = false;
  StudyKind study = StudyKind::none;
  std::optional<int> study_steps;      ///< length of a series, if fixed by the user
  int study_repeats = 3;               ///< runs of which the median time is taken
  std::shared_ptr<const Sweep> sweep;  ///< none for a single run; then this is its first point
  int sweep_ranks = 1;                 ///< that share a point
  SpectrumSolver spectrum_solver = SpectrumSolver::krylov;
  TransientSolver transient_solver = TransientSolver::krylov;
  Route route = Route::excursion;
  Method method;
  std::string summary, output, trajectory;  ///< file names; empty if not asked for
  std::string checkpoint;                   ///< of -route monte_carlo and of sweeps
  std::string compared;                     ///< file of the references
  std::string study_csv;
  std::string sweep_csv;
  bool progress = false;
  std::vector<std::string> warnings;
  /// All options of the table as used, name and value, for the record.
  std::vector<std::pair<std::string, std::string>> resolved;

  [[nodiscard]] bool wants(Quantity q) const { return quantities.contains(q); }
};

/// Reads and validates everything before anything is computed. `argv` is searched for words that
/// belong to no option. Throws BadInput that tells all problems at once: name, value, allowed
/// range, fix; for an unknown option the nearest known one. Local; the same on every rank.
[[nodiscard]] Request read_request(const std::vector<std::string>& argv);

/// Puts a blank before formulas that begin with a sign, such as the value of -drag_expression
/// -v*abs(v), which PETSc would take for an option.
void shield_formulas(std::vector<std::string>& argv);

/// Tells what is wrong with the options files named in `argv`, before PETSc reads them.
/// Throws BadInput with file, line and fix.
void check_options_files(const std::vector<std::string>& argv);

}  // namespace stickslip::options
