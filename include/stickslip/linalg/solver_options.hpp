#pragma once
/// PETSc's options database, and what is known of the options of its solvers. All of it is local.

#include <optional>
#include <string>
#include <utility>
#include <vector>

struct _n_PetscOptions;  // PETSc's;
                         // NOLINT(bugprone-reserved-identifier,readability-identifier-naming)

namespace stickslip::linalg {

// Which solver the options choose, and what its analysis predicts: plain data for plans.

/// The PC type of this program, which the operators register.
inline constexpr const char* kElementsPc = "elements";

/// What options under the prefix choose of the preconditioner and its matrices, if anything: the
/// default of -<prefix>pc_type is "elements" where its own options are given, and "lu" with others.
[[nodiscard]] std::string implied_pc_type(const std::string& prefix);

/// What an analysis predicts; zeros for solvers that report nothing.
struct Analysis {
  std::string pc_type;
  double factor_entries = 0;
  double megabytes = 0;   ///< of all ranks, while factoring
  double operations = 0;  ///< of factoring
};

/// Prints PETSc's help of a KSP with that prefix, around the PC "elements" unless options choose
/// another, to standard output. Collective on PETSC_COMM_SELF.
void print_linear_solver_options(const std::string& prefix);

/// Each reads all options of a role once, on a small matrix, so that unknown ones can be reported
/// before any work. Collective on PETSC_COMM_SELF only.
void probe_linear_solver(const std::string& prefix);
void probe_eigensolver(const std::string& prefix);

/// Whether a word of a command line names an option, and is no negative number.
[[nodiscard]] bool is_option_name(const std::string& word);

/// The value of an option (a name without dash) as given, which counts as used from then on;
/// nothing if it was not given.
[[nodiscard]] std::optional<std::string> option_value(const std::string& name);

/// A value of an option (a name without dash) for the life of the object; then the option has the
/// value that it had before, or none.
class OptionFor {
 public:
  OptionFor(const std::string& name, const std::string& value);
  ~OptionFor();
  OptionFor(const OptionFor&) = delete;
  OptionFor& operator=(const OptionFor&) = delete;

 private:
  std::string option_;  // with its dash
  std::optional<std::string> before_;
};

/// The options of another command line in the place of those given, for the life of the object. The
/// environment variable PETSC_OPTIONS counts as at the start. Throws PetscFailure when PETSc
/// refuses the words.
class OptionsOf {
 public:
  explicit OptionsOf(std::vector<std::string> words);
  ~OptionsOf();
  OptionsOf(const OptionsOf&) = delete;
  OptionsOf& operator=(const OptionsOf&) = delete;

 private:
  _n_PetscOptions* options_ = nullptr;
};

/// All options given, with their values, in the order of PETSc's table.
[[nodiscard]] std::string options_text();

/// Names of all options given, without the dash.
[[nodiscard]] std::vector<std::string> given_options();

/// Those that nothing has asked for so far, but for PETSc's own and those that solvers ask for only
/// when they solve.
[[nodiscard]] std::vector<std::string> unused_options();

/// Name and value of the options given to the solvers, by name.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> given_solver_options();

/// The types that -slide_pc_type and -slide_ksp_type may name, separated by blanks; empty for other
/// options.
[[nodiscard]] std::string types_of(const std::string& option);

/// Messages about types of solvers that do not work from options alone.
[[nodiscard]] std::vector<std::string> wrong_solver_types();

/// What the solver of each role says to its options, tried on a tiny matrix; to be called once the
/// types are known to work.
[[nodiscard]] std::vector<std::string> wrong_solver_options();

/// What to say of an option with the prefix of a solver that no solver has asked for; empty for any
/// other prefix.
[[nodiscard]] std::string unknown_solver_option(const std::string& name);

}  // namespace stickslip::linalg
