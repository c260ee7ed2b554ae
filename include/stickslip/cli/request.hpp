#pragma once
/// A validated run: what computes its results, and where they go.

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "stickslip/case/case.hpp"
#include "stickslip/run/study.hpp"

namespace stickslip::cli {

using cases::Case;
using cases::Method;
using cases::Quantity;
using cases::Question;
using cases::Route;
using cases::Scheme;
using cases::SpectrumSolver;
using run::StudyKind;
using run::StudyOptions;

/// Names of files, and what is shown on the way.
struct Files {
  std::map<std::string, std::string> written;  ///< those asked for, by the option of the output
  std::string checkpoint;  ///< of -route monte_carlo and of sweeps; empty if not asked for
  std::string compared;    ///< file of the references; empty if there is none
  bool progress = false;

  /// Those that will hold a quantity that is no number of a table.
  [[nodiscard]] std::vector<std::string> holding(Quantity field) const;
};

class Sweep;

/// A case, whether it is one of a series, and where the results go.
struct Request : Case {
  StudyOptions study;
  Files files;
  std::shared_ptr<const Sweep> sweep;  ///< none for a single run; then this is its first point
  int sweep_ranks = 1;                 ///< that share a point
  bool plan_only = false;
  std::vector<std::string> warnings;
  /// All options of the table as used, name and value, for the provenance.
  std::vector<std::pair<std::string, std::string>> resolved;
};

/// Reads and validates everything before anything is computed. `argv` is searched for words that
/// belong to no option. Throws BadInput with all problems at once: name, value, allowed range,
/// fix; for an unknown option the nearest known one. Local; the same on every rank.
[[nodiscard]] Request read_request(const std::vector<std::string>& argv);

/// Puts a blank before formulas that begin with a sign, such as the value of -drag_expression
/// -v*abs(v), which PETSc would take for an option.
void shield_formulas(std::vector<std::string>& argv);

/// Reports what is wrong with the options files named in `argv`, before PETSc reads them.
/// Throws BadInput with file, line and fix.
void check_options_files(const std::vector<std::string>& argv);

}  // namespace stickslip::cli
