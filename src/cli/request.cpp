#include "stickslip/cli/request.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <stdexcept>

#include "reading.hpp"
#include "stickslip/base/text.hpp"
#include "stickslip/case/force_rows.hpp"
#include "stickslip/cli/options.hpp"
#include "stickslip/cli/output.hpp"
#include "stickslip/generator/solver_policy.hpp"
#include "stickslip/generator/velocity_mesh.hpp"
#include "stickslip/linalg/solver_options.hpp"
#include "stickslip/model/effect.hpp"

namespace stickslip::cli {
namespace {

using linalg::is_option_name;

// A formula such as -v*abs(v) where a value is due, which PETSc takes for an option.
bool is_formula(const std::string& option, const std::string& value) {
  const Option* known = option.starts_with('-') ? find(option.substr(1)) : nullptr;
  if (known == nullptr || known->kind != Kind::text || !is_option_name(value)) return false;
  if (std::isalpha(static_cast<unsigned char>(value[1])) == 0) return false;
  const auto names = all_names();
  return std::count(names.begin(), names.end(), value) == 0;
}

// The same in a line of an options file, in quotes or not: how to write it; empty if nothing is
// wrong.
std::string better_formula(const std::string& line) {
  const auto begin = line.find_first_not_of(" \t"), end = line.find_first_of(" \t", begin);
  const auto start = line.find_first_not_of(" \t", end);
  if (start == line.npos) return "";
  const bool quoted = line[start] == '"';
  const auto first = quoted ? start + 1 : start;
  const auto parts = split(line.substr(first), quoted ? '"' : '#');
  const std::string option = line.substr(begin, end - begin);
  if (line[first] != '-' || !is_formula(option, parts.front())) return "";
  return fmt::format("{} \" {}\"", option, parts.front());
}

// What is wrong with the name of an options file, or with the way to it; empty if nothing is.
// `above` are the files that led to it. It is read twice, here and by PETSc: a pipe would be empty
// then.
std::string unfit_file(const std::string& name, const std::vector<std::string>& above) {
  std::error_code error;
  if (std::find(above.begin(), above.end(), name) != above.end()) {
    return "includes itself; take the inner -options_file out";
  }
  if (!std::filesystem::is_regular_file(name, error) && std::ifstream(name).good()) {
    return "is not a regular file; write the options to a regular file";
  }
  if (std::ifstream(name).good()) return "";
  return "cannot be read; check the name and that you may read it";
}

// The file that a line of an options file includes; nothing if it includes none.
std::optional<std::string> included_file(std::string line) {
  line.erase(std::min(line.find('#'), line.size()));
  std::replace_if(
      line.begin(), line.end(), [](char c) { return c == '\t' || c == '\r'; }, ' ');
  std::vector<std::string> words = split(line, ' ');
  std::erase(words, "");
  if (words.empty() || words[0] != "-options_file") return std::nullopt;
  if (words.size() == 1) return "";
  std::erase(words[1], '"');
  return words[1];
}

// What PETSc would do to quotes in silence; empty if nothing is wrong with them.
std::string unfit_quotes(const std::string& line) {
  bool open = false;
  for (const char c : line) {
    if (c == '#' && open) {
      return "has a # in quotes, behind which PETSc takes the rest for a comment; take a name "
             "without #";
    }
    if (c == '#') break;
    open = open != (c == '"');
  }
  return open ? "has a quote that is not closed; write \"...\"" : "";
}

// Remembers where a line states an option.
void check_line(const std::string& line, const std::string& place, Problems& problems) {
  const auto first = line.find_first_not_of(" \t\r");
  if (const auto unfit = unfit_quotes(line); !unfit.empty()) {
    return problems.add(fmt::format("{}: {}", place, unfit));
  }
  if (const auto better = better_formula(line); !better.empty()) {
    problems.add(fmt::format("{}: the value looks like an option; put a blank before it: {}", place,
                             better));
  }
  if (first == line.npos || line[first] == '#') return;
  if (line[first] == '-') {
    const auto name = line.substr(first + 1, line.find_first_of(" \t\r#", first) - first - 1);
    stated_places()[name] = place;
    return;
  }
  problems.add(fmt::format("{}: \"{}\" does not start with -name; put a # before comments", place,
                           line.substr(first, 40)));
}

// What is wrong with the encoding of a line; empty if nothing is.
std::string unfit_text(const std::string& line) {
  if (line.starts_with("\xEF\xBB\xBF")) {
    return "begins with a byte order mark; save the file as UTF-8 without one";
  }
  const auto unprintable = [](unsigned char c) { return c < ' ' && c != '\t' && c != '\r'; };
  if (std::none_of(line.begin(), line.end(), unprintable)) return "";
  return "is no text; an options file is text with one -name value a line";
}

void check_options_file(const std::string& name, std::vector<std::string> above,
                        Problems& problems) {
  const std::string unfit = unfit_file(name, above);
  if (!unfit.empty()) return problems.add(fmt::format("-options_file {}: {}", name, unfit));
  if (name.ends_with(".yml") || name.ends_with(".yaml")) return;  // PETSc's YAML reader
  above.push_back(name);
  std::ifstream file(name);
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    const std::string place = fmt::format("{}:{}", name, number), unfit_line = unfit_text(line);
    if (!unfit_line.empty()) return problems.add(fmt::format("{}: {}", place, unfit_line));
    check_line(line, place, problems);
    if (const auto inner = included_file(line)) check_options_file(*inner, above, problems);
  }
}

// A misspelled name would be left out, and the rest agree.
void check_keys(Settings& settings, const std::vector<cases::Reference>& references) {
  std::vector<std::string> keys;
  for (const auto* entry : cases::entries()) {
    for (const auto* row : entry->rows) {
      if (!row->is_pattern()) keys.emplace_back(row->key);
    }
  }
  std::set<std::string> unknown;
  for (const auto& reference : references) {
    const std::string& key = reference.quantity;
    if (cases::find_row(key) != nullptr || !unknown.insert(key).second) continue;
    const std::string near = nearest_word(key, keys);
    settings.refuse("compare", fmt::format("holds {}, which is no key of a result", key),
                    near.empty() ? "-help lists the keys of every quantity"
                                 : fmt::format("did you mean {}?", near));
  }
}

std::vector<cases::Reference> read_compared(Settings& settings) {
  if (!settings.has("compare")) return {};
  std::vector<cases::Reference> references;
  try {
    references = read_references(settings.text("compare"));
  } catch (const std::invalid_argument& error) {
    settings.refuse("compare", error.what(),
                    "name a file written by -output or -summary, or CSV with the columns "
                    "quantity,argument,value,low,high");
  }
  check_keys(settings, references);
  return references;
}

// The quantities given; else those of the file to compare with; else the default ones. Of those
// that are not given, the ones that the route gives.
void read_quantities(Settings& settings, Request& request) {
  auto& question = request.question;
  const bool given = settings.has("quantities");
  const auto words = asked_quantities(settings);
  const auto asked = [&](const cases::Entry& entry) {
    const auto& known = question.references;
    if (given || known.empty()) return std::count(words.begin(), words.end(), entry.word) > 0;
    return std::any_of(known.begin(), known.end(), [&entry](const cases::Reference& reference) {
      const auto* row = cases::find_row(reference.quantity);
      return row != nullptr && row->asks && cases::entry_of(reference.quantity) == &entry;
    });
  };
  std::vector<std::string> given_by_route, refused;
  for (const auto* entry : cases::entries()) {
    const bool gives = entry->routes.contains(request.method.route);
    if (gives) given_by_route.emplace_back(entry->word);
    if (!asked(*entry)) continue;
    if (gives) question.quantities.insert(entry->quantity);
    if (!gives) refused.emplace_back(entry->word);
  }
  if (refused.empty() || (!given && !question.quantities.empty())) return;
  settings.refuse("quantities",
                  fmt::format("-route {} does not give {} ({}); it gives {}",
                              settings.text("route"), enumerate(refused, "and"),
                              request.method.row().limit, enumerate(given_by_route, "and")),
                  "take -route excursion, or other quantities");
}

// The values given, or those of the file to compare with: of results over that abscissa.
std::vector<double> values_of(const cases::Argument& argument, const Settings& settings,
                              const std::vector<cases::Reference>& references) {
  const std::string option(argument.option);
  std::vector<double> values = settings.numbers(option);
  if (settings.has(option)) return values;
  for (const auto& reference : references) {
    const auto* row = cases::find_row(reference.quantity);
    const bool asks = reference.argument && row != nullptr && row->abscissa == option;
    const double value = reference.argument.value_or(0);
    const bool known = std::count(values.begin(), values.end(), value) > 0;
    if (asks && argument.allows(value) && !known) values.push_back(value);
  }
  return values;
}

std::vector<model::Observable> read_observables(Settings& settings, const model::Friction& friction,
                                                bool on_spring) {
  constexpr const char* example = "write for example \"v^2; x*v; stick\"";
  std::vector<model::Observable> observables;
  const auto texts = split(settings.text("observable"), ';');
  if (settings.has("observable") && texts.empty()) {
    settings.refuse("observable", "must name a function of the state", example);
  }
  for (auto text = texts.begin(); text != texts.end(); ++text) {
    if (std::find(texts.begin(), text, *text) != text) {
      settings.refuse("observable", "names " + *text + " twice", "name it once");
      continue;
    }
    try {
      observables.push_back(model::parse_observable(*text, friction, on_spring));
    } catch (const std::invalid_argument& error) {
      const std::string why = error.what();
      const bool named = texts.size() == 1 || why.starts_with(*text);
      settings.refuse("observable", named ? why : *text + ": " + why, example);
    }
  }
  return observables;
}

// Elements end where functions of the state jump or have kinks, on all levels of x alike. At v = 0
// they end in any case, and x has a level on each of its values. Where there are no elements the
// values seen tell the range of a function.
void examine_observables(Settings& settings, Request& request) {
  if (!request.question.depends_on("observable")) return;
  const bool elements =
      request.method.scheme == Scheme::hp && request.method.row().discretises_velocity;
  const auto& scene = request.scene;
  const double speed = generator::largest_speed(scene);
  for (auto& f : request.question.observables) {
    try {
      model::examine(f, scene, speed);
    } catch (const std::invalid_argument& error) {
      if (!elements) continue;
      settings.refuse("observable", error.what(),
                      "take -scheme upwind, or another formula: elements of -scheme hp end at up "
                      "to 64 jumps and kinks in v that are the same for all x");
    }
  }
}

// A state that can occur: a noise level, and a velocity below the largest terminal one.
model::Start read_state(Settings& settings, const model::Scene& scene, double x, double v) {
  const auto process = scene.meant();
  const auto& noise = process.noise;
  const auto level = noise.find(x);
  if (!level) {
    const double place = std::clamp<double>(noise.place(x), noise.lowest(), noise.highest());
    const double lowest = noise.level(noise.lowest()), highest = noise.level(noise.highest());
    settings.refuse(
        "start",
        noise.table
            ? fmt::format("must start on a noise level; the levels lie in [{:g}, {:g}]", lowest,
                          highest)
            : fmt::format("must start on a noise level; the levels are {:g} apart up to {:g}",
                          scene.delta, highest),
        fmt::format("take x = {:g}", noise.level(static_cast<int>(std::round(place)))));
    return {};
  }
  for (int other : {*level - 1, *level + 1}) {
    if (other < noise.lowest() || other > noise.highest()) continue;
    if (noise.level(other) != noise.level(*level)) continue;
    settings.refuse("start",
                    fmt::format("does not say in which of the states with x = {:g} to start", x),
                    "take -start rest, stationary, s+ or s-");
    return {};
  }
  const auto branch = v < 0 ? process.mirrored() : process;
  const double largest = branch.terminal_velocity() * (v < 0 ? -1 : 1);
  if (std::abs(v) > std::abs(largest)) {
    settings.refuse(
        "start",
        fmt::format("starts at a velocity that no body reaches: the terminal velocity on the "
                    "highest noise level is {:g}",
                    largest),
        fmt::format("take v in [{:g}, {:g}]", std::min(0.0, largest), std::max(0.0, largest)));
  }
  return {*level, v};
}

// On a spring: x,v,p, or a body that is held at p under any force.
void read_start_on_spring(Settings& settings, const model::Scene& scene, const std::string& text,
                          model::Start& start) {
  using enum model::Start::Kind;
  constexpr std::string_view held = "rest,";
  const bool rests = text.starts_with(held);
  const auto numbers = parse_numbers(rests ? text.substr(held.size()) : text);
  if (text == "stationary") {
    start.kind = stationary;
  } else if (numbers && rests && numbers->size() == 1) {
    start = {.kind = rest, .p = (*numbers)[0]};
  } else if (numbers && !rests && numbers->size() == 3) {
    start = {.v = (*numbers)[1], .kind = state, .p = (*numbers)[2], .x = (*numbers)[0]};
    const auto* chain = scene.spring->chain();
    if (chain == nullptr || chain->find(start.x)) return;
    const double place =
        std::clamp<double>(chain->place(start.x), chain->lowest(), chain->highest());
    settings.refuse(
        "start", "must start on a noise level",
        fmt::format("take x = {:g}", chain->level(static_cast<int>(std::round(place)))));
  } else {
    settings.refuse("start",
                    "does not say at which position of the spring the body is: it must be "
                    "stationary, x,v,p or rest,p",
                    "write for example -start 0,0,1 or -start rest,1");
  }
}

// stationary, rest, s+, s- or x,v with x on a noise level.
void read_start(Settings& settings, Request& request) {
  using enum model::Start::Kind;
  const std::string text = settings.text("start");
  model::Start& start = request.question.start;
  if (request.scene.spring) {
    return read_start_on_spring(settings, request.scene, text, start);
  }
  const auto process = request.scene.meant();
  const bool up = process.starts_upwards(), down = process.starts_downwards();
  if ((text == "s+" && !up) || (text == "s-" && !down)) {
    settings.refuse("start", "does not occur: from rest bodies start on the other side alone",
                    up ? "take -start s+" : "take -start s-");
  } else if (text == "s+" || text == "s-") {
    start = {process.exit_level(text == "s+")};
  } else if (text == "rest" || text == "stationary") {
    start.kind = text == "rest" ? rest : stationary;
  } else if (const auto state = parse_numbers(text); state && state->size() == 2) {
    start = read_state(settings, request.scene, (*state)[0], (*state)[1]);
  } else {
    settings.refuse("start", "must be s+, s-, stationary, rest or x,v",
                    "rest is V = 0 under any force; write for example -start 0.5,0");
  }
}

// The velocity at the first sample of a given force, whose noise level means nothing.
void read_start_velocity(Settings& settings, Request& request) {
  const std::string text = settings.text("start");
  const auto state = parse_numbers(text);
  if (state && state->size() == 2 && (*state)[0] == 0) {
    request.question.start = {0, (*state)[1]};
  } else if (settings.has("start") && text != "rest") {
    settings.refuse("start", "must be rest or 0,v under a given force, which is that of the record",
                    state && state->size() == 2 ? fmt::format("take -start 0,{:g}", (*state)[1])
                                                : "write for example -start 0,10");
  }
}

// Bodies under a given force share the velocity of other quantities, but not their noise level.
void read_starts(Settings& settings, Request& request) {
  const auto all = cases::entries();
  const bool noisy = std::ranges::any_of(all, [&](const auto* entry) {
    return entry != &cases::kGivenForce && entry->takes("start") &&
           request.question.wants(entry->quantity);
  });
  if (noisy) return read_start(settings, request);
  if (request.question.depends_on("start")) read_start_velocity(settings, request);
}

// Below the speed to which bodies tend on the highest level of the noise, on either side or on that
// of the passage.
void check_speeds(Settings& settings, const Request& request) {
  const auto& question = request.question;
  if (!question.depends_on("velocity")) return;
  const auto process = request.scene.meant();
  const double up = process.terminal_velocity(), down = process.mirrored().terminal_velocity();
  double reached = std::max({0.0, up, down});
  if (question.depends_on("passage")) {
    if (question.passage == model::Passage::up) reached = std::max(0.0, up);
    if (question.passage == model::Passage::down) reached = std::max(0.0, down);
  }
  const bool limited = request.scene.limits_speed && *request.scene.v_max < reached;
  if (limited) reached = *request.scene.v_max;
  for (double speed : question.velocity) {
    if (speed < reached) continue;
    settings.refuse(
        "velocity",
        fmt::format("holds {:g}, which no body reaches: {} is {:g}", speed,
                    limited ? "-speed_limit" : "the terminal velocity on the highest noise level",
                    reached),
        fmt::format("take speeds below {:g}", reached));
    return;
  }
}

// A state beyond a speed has passed it.
void check_passages(Settings& settings, const Question& question) {
  const auto& start = question.start;
  if (!question.depends_on("passage") || start.kind != model::Start::Kind::state) return;
  for (double speed : question.velocity) {
    if (!model::has_passed(question.passage, start.v, speed)) continue;
    settings.refuse("start",
                    fmt::format("starts at the velocity {:g}, where the speed {:g} of -velocity is "
                                "passed at once",
                                start.v, speed),
                    fmt::format("take speeds above {:g}, or a slower start", std::abs(start.v)));
    return;
  }
}

// A path is kept in memory.
void check_horizon(Settings& settings, const Request& request) {
  const double horizon = request.question.horizon;
  const double jumps = horizon * request.scene.process(1).noise.rate();
  constexpr double most = 5e7;
  if (!request.question.wants(Quantity::trajectory) || jumps <= most) return;
  settings.refuse(
      "horizon",
      fmt::format("means {:.1e} jumps of the noise, and at most {:.0e} are kept", jumps, most),
      fmt::format("take at most {:.3g}", horizon * most / jumps));
}

Method read_method(const Settings& settings) {
  return {.route = cases::method_of(settings.text("route")).route,
          .scheme = meaning(kSchemes, settings.text("scheme")),
          .degree = settings.integer("degree"),
          .layers = settings.integer("layers"),
          .points = settings.integer("p"),
          .noise_degree = settings.integer("noise_degree"),
          .noise_grading = settings.real("noise_grading"),
          .factors = generator::given_factors(),
          .spectrum_solver = meaning(kSpectrumSolvers, settings.text("spectrum_solver")),
          .excursions = settings.real("excursions"),
          .seed = static_cast<std::uint64_t>(settings.real("seed"))};
}

effects::Drive drive_of(const Settings& settings) {
  const auto asked = asked_quantities(settings);
  const auto count = std::ranges::count(asked, cases::kGivenForce.word);
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
      request.question.wants(cases::kGivenForce.quantity) && request.question.start.v == 0;
  for (const auto& said : {effects::step_warning(request.scene),
                           follows ? effects::force_note(request.scene) : std::string()}) {
    if (!said.empty()) request.warnings.push_back(said);
  }
}

// The value of an option as it is used; empty where it belongs to no effect in use.
std::string used_text(const Settings& settings, const Request& request, const Option& option) {
  const std::string& name = option.name;
  if (effects::is_idle(request.scene, name)) return "";
  if (name == "delta" && settings.has("delta_per_mu_s")) return "mu_s/delta_per_mu_s";
  if (request.scene.noise.gaussian && name == "delta") return "0";
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
  const auto wrong_types = linalg::wrong_solver_types();
  for (const auto& message : wrong_types) problems.add(message);
  // Solvers of other types are not tried, so that no option of theirs would count as known.
  if (!wrong_types.empty()) problems.raise();
  for (const auto& message : linalg::wrong_solver_options()) problems.add(message);
  for (const auto& name : linalg::unused_options()) {
    const std::string message = linalg::unknown_solver_option(name);
    problems.add(message.empty() ? fmt::format("-{}: unknown option; {}{}", name,
                                               suggestion_for_option(name), stated_in_file(name))
                                 : message);
  }
}

// Words on the line that are neither an option nor the value of one; PETSc would ignore them.
void check_stray_words(const std::vector<std::string>& argv, Problems& problems) {
  for (std::size_t n = 0; n < argv.size(); ++n) {
    const bool is_value = n > 0 && is_option_name(argv[n - 1]);
    const bool after_sign = n > 0 && argv[n - 1] == "=";  // of which the option complains
    if (is_option_name(argv[n]) || is_value || after_sign) continue;
    const bool in_list = argv[n].starts_with(',') || (n > 0 && argv[n - 1].ends_with(','));
    std::error_code error;
    const bool is_file = std::filesystem::is_regular_file(argv[n], error);
    problems.add(fmt::format("{}: belongs to no option; {}", argv[n],
                             in_list         ? "lists have no spaces, as in a,b"
                             : is_file       ? "did you mean -options_file " + argv[n] + "?"
                             : find(argv[n]) ? "did you mean -" + argv[n] + "?"
                                             : "options look like -name value"));
  }
}

// The quantities and their arguments, for the model and the method that the request holds already.
void read_question(Settings& settings, Request& request) {
  Question& question = request.question;
  question.references = read_compared(settings);
  read_quantities(settings, request);
  const auto& known = question.references;
  for (const auto* argument : cases::arguments()) {
    question.set_values(std::string(argument->option), values_of(*argument, settings, known));
  }
  question.observables =
      read_observables(settings, request.scene.friction, request.scene.spring != nullptr);
  question.accuracy = settings.real("accuracy");
  question.accuracy_given = settings.has("accuracy");
  if (!question.accuracy_given) {
    question.accuracy = std::max(question.accuracy, question.usual_accuracy());
  }
  question.horizon = settings.real("horizon");
  check_horizon(settings, request);
  question.passage = meaning(kPassages, settings.text("passage"));
  check_speeds(settings, request);
  if (!settings.sound()) return;  // the others look at states of the model
  read_starts(settings, request);
  check_passages(settings, question);
  examine_observables(settings, request);
}

}  // namespace

void shield_formulas(std::vector<std::string>& argv) {
  for (std::size_t n = 1; n < argv.size(); ++n) {
    if (is_formula(argv[n - 1], argv[n])) argv[n].insert(0, " ");
  }
}

void check_options_files(const std::vector<std::string>& argv) {
  Problems problems;
  stated_places().clear();
  for (std::size_t n = 0; n < argv.size(); ++n) {
    if (argv[n] != "-options_file") continue;
    if (n + 1 == argv.size()) {
      problems.add("-options_file: names no file; write -options_file scene.opts");
      break;
    }
    check_options_file(argv[n + 1], {}, problems);
  }
  for (const auto& word : argv) {  // which takes the place of what files say
    if (is_option_name(word)) stated_places().erase(word.substr(1));
  }
  problems.raise();
}

std::vector<std::string> asked_quantities(const Settings& settings) {
  auto words = settings.list("quantities");
  if (settings.has("force_file")) {
    std::ranges::replace(words, std::string(cases::kTrajectory.word),
                         std::string(cases::kGivenForce.word));
  }
  return words;
}

Files read_files(const Settings& settings) {
  const bool terminal = isatty(STDERR_FILENO) != 0;
  Files files{.written = {},
              .checkpoint = settings.text("checkpoint"),
              .compared = settings.text("compare"),
              .progress = meaning(kProgress, settings.text("progress")).value_or(terminal)};
  for (const auto* output : all()) {
    const auto& name = output->option;
    if (settings.has(name)) files.written[name] = settings.text(name);
  }
  return files;
}

std::vector<std::string> Files::holding(Quantity field) const {
  std::vector<std::string> names;
  for (const auto* output : all()) {
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

}  // namespace stickslip::cli
