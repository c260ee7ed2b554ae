#include "stickslip/options/request.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "reading.hpp"
#include "stickslip/catalogue/given_force_keys.hpp"
#include "stickslip/effects/read_scene.hpp"
#include "stickslip/operators/solver_policy.hpp"
#include "stickslip/options/synonyms.hpp"
#include "stickslip/outputs/output.hpp"
#include "stickslip/petsc/solver_options.hpp"
#include "words.hpp"

namespace stickslip::options {
namespace {

Method read_method(const Settings& settings) {
  return {.route = catalogue::method_of(settings.text("route")).route,
          .scheme = meaning(kSchemes, settings.text("scheme")),
          .degree = settings.integer("degree"),
          .layers = settings.integer("layers"),
          .points = settings.integer("p"),
          .noise_degree = settings.integer("noise_degree"),
          .noise_grading = settings.real("noise_grading"),
          .factors = operators::given_factors(),
          .spectrum_solver = meaning(kSpectrumSolvers, settings.text("spectrum_solver")),
          .excursions = settings.real("excursions"),
          .seed = static_cast<std::uint64_t>(settings.real("seed"))};
}

effects::Drive drive_of(const Settings& settings) {
  const auto asked = asked_quantities(settings);
  const auto count = std::ranges::count(asked, catalogue::kGivenForce.word);
  if (count == 0) return effects::Drive::noise;
  return asked.size() == 1 ? effects::Drive::given_force : effects::Drive::both;
}

bool is_standard_output(const std::filesystem::path& file) {
  struct stat ours = {};
  struct stat its = {};
  return fstat(STDOUT_FILENO, &ours) == 0 && stat(file.c_str(), &its) == 0 &&
         ours.st_dev == its.st_dev && ours.st_ino == its.st_ino;
}

void check_writable(Settings& settings, const Option& option) {
  const std::string& name = option.name;
  if (option.kind != Kind::path || settings.text(name).empty()) return;
  const std::filesystem::path file = settings.text(name);
  const std::filesystem::path folder =
      file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error)) {
    settings.refuse(name, "is in a folder that does not exist", "make the folder first");
  } else if (access(folder.c_str(), W_OK) != 0) {
    settings.refuse(name, "is in a folder that cannot be written", "name another place");
  } else if (std::filesystem::is_directory(file, error)) {
    settings.refuse(name, "is a folder", "name a file");
  } else if (std::filesystem::exists(file, error) &&
             !std::filesystem::is_regular_file(file, error)) {
    settings.refuse(name, "is a device or a pipe, which a file would replace", "name a file");
  } else if (is_standard_output(file)) {
    settings.refuse(name, "is where standard output goes, with the table", "name another file");
  } else if (std::filesystem::exists(file, error) && access(file.c_str(), W_OK) != 0) {
    settings.refuse(name, "is a file that cannot be written", "name another file");
  }
}

// In the limit of white noise coarse levels are as good as fine ones, and much cheaper.
void choose_step(const Settings& settings, Request& request) {
  const bool given = settings.has("delta") || settings.has("delta_per_mu_s");
  if (given || request.study.kind != StudyKind::white_noise) return;
  request.scene.delta = 0.5 / std::sqrt(request.scene.tau);
}

// What the model says of its parameters.
void add_notes(Request& request) {
  const bool follows =
      request.question.wants(catalogue::kGivenForce.quantity) && request.question.start.v == 0;
  for (const auto& said : {effects::step_warning(request.scene), effects::noise_note(request.scene),
                           follows ? effects::force_note(request.scene) : std::string()}) {
    if (!said.empty()) request.warnings.push_back(said);
  }
}

// The value of an option as it is used; empty where it belongs to no effect in use.
std::string used_text(const Settings& settings, const Request& request, const Option& option) {
  const std::string& name = option.name;
  if (effects::is_idle(request.scene, name)) return "";
  if (name == "delta" && settings.has("delta_per_mu_s")) return "mu_s/delta_per_mu_s";
  const bool chosen = !settings.has(name) && !option.initial.empty();
  const auto given_or = [&](double used) {
    return chosen && used != settings.real(name) ? fmt::format("{}", used) : settings.text(name);
  };
  if (name == "mu_d") return given_or(request.scene.friction.mu_d);
  if (name == "accuracy") return given_or(request.question.accuracy);
  const bool white_noise = request.study.kind == StudyKind::white_noise;
  if (name == "delta" && white_noise) return given_or(request.scene.delta);
  return settings.text(name);
}

// Options of the solvers, and those that nobody knows.
void check_solver_options(Problems& problems) {
  const auto wrong_types = petsc::wrong_solver_types();
  for (const auto& message : wrong_types) problems.add(message);
  // Solvers of other types are not tried, so that no option of theirs would count as known.
  if (!wrong_types.empty()) problems.raise();
  for (const auto& message : petsc::wrong_solver_options()) problems.add(message);
  for (const auto& name : petsc::unused_options()) {
    const std::string message = petsc::unknown_solver_option(name);
    problems.add(message.empty()
                     ? fmt::format("-{}: unknown option; {}", name, suggestion_for_option(name))
                     : message);
  }
}

}  // namespace

Files read_files(const Settings& settings) {
  const bool terminal = isatty(STDERR_FILENO) != 0;
  Files files{.written = {},
              .checkpoint = settings.text("checkpoint"),
              .compared = settings.text("compare"),
              .progress = meaning(kProgress, settings.text("progress")).value_or(terminal)};
  for (const auto* output : outputs::all()) {
    const auto& name = output->option;
    if (settings.has(name)) files.written[name] = settings.text(name);
  }
  return files;
}

std::vector<std::string> Files::holding(Quantity field) const {
  std::vector<std::string> names;
  for (const auto* output : outputs::all()) {
    const auto file = written.find(output->option);
    if (file != written.end() && output->fields.contains(field)) names.push_back(file->second);
  }
  return names;
}

Request request_of(Settings& settings) {
  Request request;
  request.scene = effects::read_scene(settings, drive_of(settings));
  request.study = {meaning(kStudies, settings.text("study")), settings.integer("study_steps"),
                   settings.integer("study_repeats").value_or(3)};
  choose_step(settings, request);
  request.method = read_method(settings);
  read_question(settings, request);
  request.files = read_files(settings);
  request.sweep_ranks = settings.integer("sweep_ranks").value_or(1);
  request.plan_only = settings.flag("plan");
  check_rules(settings, request);
  for (const auto& option : all_options()) check_writable(settings, option);
  const auto& method = request.method.row();
  if (!method.discretises_velocity && !method.simulates) request.method.scheme = Scheme::none;
  for (const auto& option : all_options()) {
    request.resolved.emplace_back(option.name, used_text(settings, request, option));
  }
  if (settings.sound() && request.study.kind == StudyKind::none) add_notes(request);
  return request;
}

Request read_request(const std::vector<std::string>& argv) {
  Settings settings = Settings::read();
  Problems& problems = settings.problems();
  check_stray_words(argv, problems);
  check_solver_options(problems);
  problems.raise();  // what follows relates values to one another
  if (sweeps(settings)) return read_sweep(settings);
  Request request = request_of(settings);
  problems.raise();
  return request;
}

}  // namespace stickslip::options
