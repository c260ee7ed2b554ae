#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "reading.hpp"
#include "stickslip/catalogue/given_force_keys.hpp"
#include "stickslip/catalogue/trajectory_keys.hpp"
#include "stickslip/outputs/reference.hpp"
#include "stickslip/support/number_text.hpp"
#include "stickslip/support/text.hpp"
#include "stickslip/velocity/tail.hpp"
#include "words.hpp"

namespace stickslip::options {
namespace {

// A misspelled name would be left out, and the rest agree.
void check_keys(Settings& settings, const std::vector<cases::Reference>& references) {
  std::vector<std::string> keys;
  for (const auto* entry : catalogue::entries()) {
    for (const auto* row : entry->rows) {
      if (!row->is_pattern()) keys.emplace_back(row->key);
    }
  }
  std::set<std::string> unknown;
  for (const auto& reference : references) {
    const std::string& key = reference.quantity;
    if (catalogue::find_row(key) != nullptr || !unknown.insert(key).second) continue;
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
    references = outputs::read_references(settings.text("compare"));
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
  const auto asked = [&](const catalogue::Entry& entry) {
    const auto& known = question.references;
    if (given || known.empty()) return std::count(words.begin(), words.end(), entry.word) > 0;
    return std::any_of(known.begin(), known.end(), [&entry](const cases::Reference& reference) {
      const auto* row = catalogue::find_row(reference.quantity);
      return row != nullptr && row->asks && catalogue::entry_of(reference.quantity) == &entry;
    });
  };
  std::vector<std::string> given_by_route, refused;
  for (const auto* entry : catalogue::entries()) {
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
std::vector<double> values_of(const catalogue::Argument& argument, const Settings& settings,
                              const std::vector<cases::Reference>& references) {
  const std::string option(argument.option);
  std::vector<double> values = settings.numbers(option);
  if (settings.has(option)) return values;
  for (const auto& reference : references) {
    const auto* row = catalogue::find_row(reference.quantity);
    const bool asks = reference.argument && row != nullptr && row->abscissa == option;
    const double value = reference.argument.value_or(0);
    const bool known = std::count(values.begin(), values.end(), value) > 0;
    if (asks && argument.allows(value) && !known) values.push_back(value);
  }
  return values;
}

std::vector<model::Observable> read_observables(Settings& settings,
                                                const model::Friction& friction) {
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
      observables.push_back(model::parse_observable(*text, friction));
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
  const double speed = velocity::largest_speed(scene);
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

// stationary, rest, s+, s- or x,v with x on a noise level.
void read_start(Settings& settings, Request& request) {
  using enum model::Start::Kind;
  const std::string text = settings.text("start");
  model::Start& start = request.question.start;
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
  const auto all = catalogue::entries();
  const bool noisy = std::ranges::any_of(all, [&](const auto* entry) {
    return entry != &catalogue::kGivenForce && entry->takes("start") &&
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

}  // namespace

std::vector<std::string> asked_quantities(const Settings& settings) {
  auto words = settings.list("quantities");
  if (settings.has("force_file")) {
    std::ranges::replace(words, std::string(catalogue::kTrajectory.word),
                         std::string(catalogue::kGivenForce.word));
  }
  return words;
}

void read_question(Settings& settings, Request& request) {
  Question& question = request.question;
  question.references = read_compared(settings);
  read_quantities(settings, request);
  const auto& known = question.references;
  for (const auto* argument : catalogue::arguments()) {
    question.set_values(std::string(argument->option), values_of(*argument, settings, known));
  }
  question.observables = read_observables(settings, request.scene.friction);
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

}  // namespace stickslip::options
