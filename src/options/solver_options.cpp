#include <fmt/format.h>
#include <petscsys.h>

#include <algorithm>
#include <array>

#include "reading.hpp"
#include "stickslip/options/synonyms.hpp"
#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/solver_choice.hpp"
#include "stickslip/support/text.hpp"

namespace stickslip::options {
namespace {

std::string solver_option(const std::string& name) {
  std::array<char, 256> text{};
  PetscBool given = PETSC_FALSE;
  petsc::check(
      PetscOptionsGetString(nullptr, nullptr, name.c_str(), text.data(), text.size(), &given));
  return given == PETSC_TRUE ? text.data() : "";
}

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
  // Options that are read when something is solved, not before, without the prefix; the first one
  // shows what the solver uses.
  std::vector<std::string> read_later;
  std::vector<std::string> common;  // others that users give
};

const std::vector<SolverRole>& solver_roles() {
  static const auto later =
      split("eps_view eps_view_pre eps_view_values eps_converged_reason eps_error_relative "
            "eps_error_absolute eps_error_backward eps_view_vectors",
            ' ');
  static const auto eps = split("eps_type eps_tol eps_nev eps_ncv eps_max_it eps_monitor", ' ');
  static const std::vector<SolverRole> roles{
      {"slide_", petsc::probe_linear_solver,
       split("ksp_view ksp_view_pre ksp_converged_reason ksp_converged_rate "
             "ksp_view_final_residual",
             ' '),
       split("pc_type pc_elements_share pc_factor_mat_solver_type pc_factor_levels sub_pc_type "
             "sub_pc_factor_levels ksp_type ksp_rtol ksp_max_it ksp_monitor",
             ' ')},
      {"null_", petsc::probe_eigensolver, later, eps},
      {"relax_", petsc::probe_eigensolver, later, eps},
      {"backward_", petsc::probe_time_stepper,
       split("ts_view ts_view_pre ts_adapt_view snes_view ksp_view", ' '),
       split("ts_type ts_max_steps ts_monitor ts_rtol ts_atol", ' ')}};
  return roles;
}

// The role that has options of that name; nullptr if none has.
const SolverRole* role_of(const std::string& name) {
  for (const auto& role : solver_roles()) {
    if (name.starts_with(role.prefix)) return &role;
  }
  return nullptr;
}

bool is_read_later(const std::string& name) {
  const SolverRole* role = role_of(name);
  return role != nullptr && std::count(role->read_later.begin(), role->read_later.end(),
                                       name.substr(role->prefix.size())) > 0;
}

// The option of a role that the user may have meant, without the dash; empty if there is none.
std::string nearest_option(const SolverRole& role, const std::string& name) {
  auto names = role.read_later;
  names.insert(names.end(), role.common.begin(), role.common.end());
  const std::string near = nearest_word(name.substr(role.prefix.size()), names);
  return near.empty() ? "" : role.prefix + near;
}

std::string unknown_option(const std::string& name) {
  if (const SolverRole* role = role_of(name)) {
    const std::string near = nearest_option(*role, name);
    return fmt::format("-{}: this solver has no such option; {}-{}{} shows its options", name,
                       near.empty() ? "" : fmt::format("did you mean -{}? ", near), role->prefix,
                       role->read_later.front());
  }
  return fmt::format("-{}: unknown option; {}", name, suggestion_for_option(name));
}

// Names of all options in the database, without the dash.
std::vector<std::string> given_names() {
  std::vector<std::string> names;
  char* all = nullptr;
  petsc::check(PetscOptionsGetAll(nullptr, &all));
  for (const auto& word : split(all, ' ')) {
    if (is_option_name(word)) names.push_back(word.substr(1));
  }
  petsc::check(PetscFree(all));
  return names;
}

// Of the types that PETSc has, those that work from options alone and apply transposes. Others,
// such as shell and mg, need a program that sets them up, and crash without.
const std::vector<std::pair<std::string, std::vector<std::string>>>& solver_types() {
  static const std::vector<std::pair<std::string, std::vector<std::string>>> types{
      {"slide_pc_type", split("elements lu cholesky qr svd redundant ksp ilu icc asm gasm bjacobi "
                              "jacobi pbjacobi gamg hypre none",
                              ' ')},
      {"slide_ksp_type",
       split("preonly gmres fgmres lgmres dgmres pgmres pipefgmres gcr bcgs bcgsl "
             "ibcgs fbcgs fbcgsr cgs qmrcgs tfqmr tcqmr pipebcgs",
             ' ')}};
  return types;
}

// The option of a role whose value a message names; the prefix alone if there is none.
std::string blamed_option(const SolverRole& role, const std::string& message) {
  for (const auto& name : given_names()) {
    const std::string value = solver_option("-" + name);
    const bool named = !value.empty() && message.find(" " + value) != message.npos;
    if (named && name.starts_with(role.prefix)) return fmt::format("-{} = {}", name, value);
  }
  return fmt::format("-{}...", role.prefix);
}

}  // namespace

bool check_solver_types(Problems& problems) {
  bool known = true;
  for (const auto& [name, types] : solver_types()) {
    const std::string type = solver_option("-" + name);
    if (type.empty() || std::count(types.begin(), types.end(), type) > 0) continue;
    known = false;
    const std::string near = nearest_word(type, types);
    problems.add(fmt::format("-{} = {}: must be {}{}", name, type, enumerate(types, "or"),
                             near.empty() ? "" : fmt::format("; did you mean {}?", near)));
  }
  return known;
}

void check_solver_options(Problems& problems) {
  const auto names = given_names();
  for (const auto& role : solver_roles()) {
    const bool used = std::any_of(names.begin(), names.end(), [&role](const std::string& name) {
      return role_of(name) == &role;
    });
    if (!used) continue;
    try {
      role.probe_options(role.prefix);
    } catch (const petsc::PetscFailure& failure) {
      const std::string text = failure.what(), message = text.substr(0, text.find('\n'));
      problems.add(fmt::format("{}: {}", blamed_option(role, message), message));
    }
  }
}

void check_unknown_options(Problems& problems) {
  PetscInt count = 0;
  char** names = nullptr;
  char** values = nullptr;
  petsc::check(PetscOptionsLeftGet(nullptr, &count, &names, &values));
  for (PetscInt n = 0; n < count; ++n) {
    if (!belongs_to_petsc(names[n]) && !is_read_later(names[n]))
      problems.add(unknown_option(names[n]));
  }
  petsc::check(PetscOptionsLeftRestore(nullptr, &count, &names, &values));
}

Factors read_factors() {
  const std::string implied = petsc::implied_pc_type("slide_");
  if (implied.empty()) return Factors::own;
  std::string pc = solver_option("-slide_pc_type");
  if (pc.empty()) pc = implied;
  if (pc == petsc::kElementsPc) return Factors::elements;
  if (!pc.empty() && pc != "lu" && pc != "cholesky") return Factors::incomplete;
  const bool on_disk = solver_option("-slide_mat_mumps_icntl_22") == "1";
  return on_disk ? Factors::on_disk : Factors::in_memory;
}

std::vector<std::pair<std::string, std::string>> solver_options() {
  std::vector<std::pair<std::string, std::string>> found;
  for (const auto& name : given_names()) {
    if (role_of(name) != nullptr) found.emplace_back(name, solver_option("-" + name));
  }
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace stickslip::options
