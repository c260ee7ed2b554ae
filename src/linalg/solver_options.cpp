#include "stickslip/linalg/solver_options.hpp"

#include <fmt/format.h>
#include <petscsys.h>

#include <algorithm>
#include <iterator>

#include "stickslip/base/text.hpp"
#include "stickslip/linalg/petsc.hpp"

namespace stickslip::linalg {
namespace {

// Options of PETSc itself that it reads later, or reads and does not count as used.
bool belongs_to_petsc(const std::string& name) {
  static const auto exact =
      split("options_left options_view citations skip_petscrc log_view log_view_memory malloc_dump "
            "malloc_debug malloc malloc_view memory_view objects_dump info options_file "
            "no_signal_handler nox log log_trace log_summary on_error_abort fp_trap debug "
            "start_in_debugger on_error_attach_debugger viewfromoptions",
            ' ');
  return std::find(exact.begin(), exact.end(), name) != exact.end();
}

/// A role of a solver, whose PETSc options carry a prefix.
struct SolverRole {
  std::string prefix;
  void (*probe_options)(const std::string& prefix);
  // Options that are read when something is solved, not before, without the prefix and separated by
  // blanks; the first one shows what the solver uses.
  const char* read_later;
  const char* common;  // others that users give
};

constexpr const char* kEpsLater =
    "eps_view eps_view_pre eps_view_values eps_converged_reason eps_error_relative "
    "eps_error_absolute eps_error_backward eps_view_vectors";
constexpr const char* kEpsCommon = "eps_type eps_tol eps_nev eps_ncv eps_max_it eps_monitor";
const SolverRole kRoles[] = {
    {"slide_", probe_linear_solver,
     "ksp_view ksp_view_pre ksp_converged_reason ksp_converged_rate ksp_view_final_residual "
     "mat_view",
     "pc_type pc_elements_share pc_factor_mat_solver_type pc_factor_levels sub_pc_type "
     "sub_pc_factor_levels ksp_type ksp_rtol ksp_atol ksp_max_it ksp_gmres_restart "
     "ksp_monitor"},
    {"null_", probe_eigensolver, kEpsLater, kEpsCommon},
    {"relax_", probe_eigensolver, kEpsLater, kEpsCommon}};

// The role that has options of that name; nullptr if none has.
const SolverRole* role_of(const std::string& name) {
  for (const auto& role : kRoles) {
    if (name.starts_with(role.prefix)) return &role;
  }
  return nullptr;
}

bool is_read_later(const std::string& name) {
  const SolverRole* role = role_of(name);
  const auto names = split(role == nullptr ? "" : role->read_later, ' ');
  return std::ranges::any_of(names,
                             [&](const auto& later) { return name == role->prefix + later; });
}

// The option of a role that the user may have meant, without the dash; empty if there is none.
std::string nearest_option(const SolverRole& role, const std::string& name) {
  const auto names = split(fmt::format("{} {}", role.read_later, role.common), ' ');
  const std::string near = nearest_word(name.substr(role.prefix.size()), names);
  return near.empty() ? "" : role.prefix + near;
}

// What makes a solver read an option, that of the default solver being direct; empty if nothing is
// known to. Both without the prefix of the role.
std::string made_readable_by(const std::string& option) {
  constexpr std::pair<const char*, const char*> known[] = {
      {"ksp_", "ksp_type gmres"}, {"pc_factor_levels", "pc_type ilu"}, {"sub_", "pc_type bjacobi"}};
  for (const auto& [start, choice] : known) {
    if (option.starts_with(start)) return choice;
  }
  return "";
}

// Of the types that PETSc has, those that work from options alone and apply transposes. Others,
// such as shell and mg, need a program that sets them up, and crash without.
constexpr std::pair<const char*, const char*> kSolverTypes[] = {
    {"slide_pc_type", "elements lu cholesky qr svd redundant ksp ilu icc asm gasm bjacobi jacobi "
                      "pbjacobi gamg hypre "
                      "none"},
    {"slide_ksp_type",
     "preonly gmres fgmres lgmres dgmres pgmres pipefgmres gcr bcgs bcgsl ibcgs fbcgs fbcgsr cgs "
     "qmrcgs tfqmr tcqmr pipebcgs"}};

// Numbers of eigenvalues, and of vectors that they are found among, beyond which a run takes hours.
constexpr std::pair<const char*, int> kMost[] = {
    {"relax_eps_nev", 100}, {"relax_eps_ncv", 1000}, {"null_eps_nev", 100}, {"null_eps_ncv", 1000}};

// The option of a role whose value a message names; the prefix alone if there is none.
std::string blamed_option(const SolverRole& role, const std::string& message) {
  for (const auto& name : given_options()) {
    const std::string value = option_value(name).value_or("");
    const bool named = !value.empty() && message.find(" " + value) != message.npos;
    if (named && name.starts_with(role.prefix)) return fmt::format("-{} = {}", name, value);
  }
  return fmt::format("-{}...", role.prefix);
}

}  // namespace

bool is_option_name(const std::string& word) {
  return word.size() > 1 && word[0] == '-' && !parse_number(word);
}

std::optional<std::string> option_value(const std::string& name) {
  const std::string option = "-" + name;
  PetscBool found = PETSC_FALSE;
  check(PetscOptionsHasName(nullptr, nullptr, option.c_str(), &found));
  if (found == PETSC_FALSE) return std::nullopt;
  std::string value(1 << 20, '\0');  // lists can be long, and PETSc cuts what does not fit
  check(
      PetscOptionsGetString(nullptr, nullptr, option.c_str(), value.data(), value.size(), &found));
  return value.substr(0, value.find('\0'));
}

OptionFor::OptionFor(const std::string& name, const std::string& value)
    : option_("-" + name), before_(option_value(name)) {
  check(PetscOptionsSetValue(nullptr, option_.c_str(), value.c_str()));
}

OptionFor::~OptionFor() {
  (void)(before_ ? PetscOptionsSetValue(nullptr, option_.c_str(), before_->c_str())
                 : PetscOptionsClearValue(nullptr, option_.c_str()));
}

OptionsOf::OptionsOf(std::vector<std::string> words) {
  words.emplace(words.begin(), "stickslip");
  words.emplace_back("-skip_petscrc");
  std::vector<char*> arguments;
  for (auto& word : words) arguments.push_back(word.data());
  auto count = static_cast<int>(arguments.size());
  arguments.push_back(nullptr);
  char** values = arguments.data();
  check(PetscOptionsCreate(&options_));
  const PetscErrorCode code = PetscOptionsInsert(options_, &count, &values, nullptr);
  if (code != 0) (void)PetscOptionsDestroy(&options_);
  check(code);
  check(PetscOptionsPush(options_));
}

OptionsOf::~OptionsOf() {
  (void)PetscOptionsPop();
  (void)PetscOptionsDestroy(&options_);
}

std::string options_text() {
  char* all = nullptr;
  check(PetscOptionsGetAll(nullptr, &all));
  std::string text = all;
  check(PetscFree(all));
  return text;
}

std::vector<std::string> given_options() {
  std::vector<std::string> names;
  for (const auto& word : split(options_text(), ' ')) {
    if (is_option_name(word)) names.push_back(word.substr(1));
  }
  return names;
}

std::vector<std::string> unused_options() {
  std::vector<std::string> unused;
  PetscInt count = 0;
  char** names = nullptr;
  char** values = nullptr;
  check(PetscOptionsLeftGet(nullptr, &count, &names, &values));
  std::copy_if(names, names + count, std::back_inserter(unused), [](const std::string& name) {
    return !belongs_to_petsc(name) && !is_read_later(name);
  });
  check(PetscOptionsLeftRestore(nullptr, &count, &names, &values));
  return unused;
}

std::vector<std::pair<std::string, std::string>> given_solver_options() {
  std::vector<std::pair<std::string, std::string>> found;
  for (const auto& name : given_options()) {
    if (role_of(name) != nullptr) found.emplace_back(name, option_value(name).value_or(""));
  }
  std::sort(found.begin(), found.end());
  return found;
}

std::string types_of(const std::string& option) {
  for (const auto& [name, words] : kSolverTypes) {
    if (name == option) return words;
  }
  return "";
}

std::vector<std::string> wrong_solver_types() {
  std::vector<std::string> messages;
  for (const auto& [name, words] : kSolverTypes) {
    const auto types = split(words, ' ');
    const std::string type = option_value(name).value_or("");
    if (type.empty() || std::count(types.begin(), types.end(), type) > 0) continue;
    const std::string near = nearest_word(type, types);
    messages.push_back(fmt::format("-{} = {}: must be {}{}", name, type, enumerate(types, "or"),
                                   near.empty() ? "" : fmt::format("; did you mean {}?", near)));
  }
  return messages;
}

std::vector<std::string> wrong_solver_options() {
  std::vector<std::string> messages;
  for (const auto& [name, most] : kMost) {
    const auto number = parse_number(option_value(name).value_or("1"));
    if (!number || *number <= most) continue;
    messages.push_back(fmt::format("-{} = {:g}: must be at most {}, as each eigenvalue takes "
                                   "solutions and vectors of its own; take for example {}",
                                   name, *number, most, most / 10));
  }
  if (!messages.empty()) return messages;
  const auto names = given_options();
  for (const auto& role : kRoles) {
    const bool used = std::any_of(names.begin(), names.end(), [&role](const std::string& name) {
      return role_of(name) == &role;
    });
    if (!used) continue;
    try {
      role.probe_options(role.prefix);
    } catch (const PetscFailure& failure) {
      const std::string text = failure.what(), message = text.substr(0, text.find('\n'));
      messages.push_back(fmt::format("{}: {}", blamed_option(role, message), message));
    }
  }
  return messages;
}

std::string unknown_solver_option(const std::string& name) {
  const SolverRole* role = role_of(name);
  if (role == nullptr) return "";
  const std::string near = nearest_option(*role, name), prefix = role->prefix;
  if (near == name) {
    const std::string choice = made_readable_by(name.substr(prefix.size()));
    return fmt::format("-{}: the solver chosen does not read it; {}leave it out", name,
                       choice.empty() ? "" : fmt::format("add -{}{}, or ", prefix, choice));
  }
  return fmt::format("-{}: this solver has no such option; {}-{}{} shows its options", name,
                     near.empty() ? "" : fmt::format("did you mean -{}? ", near), prefix,
                     split(role->read_later, ' ').front());
}

}  // namespace stickslip::linalg
