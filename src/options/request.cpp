#include "stickslip/options/request.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>

#include "reading.hpp"
#include "stickslip/model/drag_law.hpp"
#include "stickslip/options/settings.hpp"
#include "stickslip/petsc/session.hpp"
#include "stickslip/support/errors.hpp"
#include "stickslip/support/text.hpp"
#include "stickslip/velocity/mesh.hpp"

namespace stickslip::options {
namespace {

model::Drag read_drag(const Settings& settings, Request& request, Problems& problems) {
  const std::string law = settings.text("drag");
  const auto warn_unused = [&](const std::string& name) {
    if (settings.given(name)) {
      request.warnings.push_back(fmt::format("-{} has no effect with -drag {}", name, law));
    }
  };
  const bool none = law == "none" || law == "expression";
  if (none) warn_unused("drag_coefficient");
  if (law != "cubic") warn_unused("drag_cubic");
  if (law != "expression" && settings.given("drag_expression")) {
    settings.report(problems, "drag_expression",
                    fmt::format("is not the drag, which is that of -drag {}", law),
                    "add -drag expression, or leave it out");
  }
  return {none ? 0 : settings.real("drag_coefficient"),
          law == "cubic" ? settings.real("drag_cubic") : 0};
}

// The largest force that occurs: X passes mu_s by 12 standard deviations with probability e^-72.
double largest_force(const model::Scene& scene) {
  const auto process = scene.meant();
  const double highest = process.noise.level(process.noise.levels);
  const double seen = scene.friction.mu_s + scene.delta + 12 / std::sqrt(scene.tau);
  return std::min(highest, seen) + std::abs(scene.bias) - scene.friction.mu_d;
}

// After check_noise: how fast bodies get depends on the noise.
void read_drag_law(const Settings& settings, model::Scene& scene, Problems& problems) {
  if (scene.drag_name != "expression" || !problems.empty()) return;
  scene.drag_expression = settings.text("drag_expression");
  if (scene.drag_expression.empty()) {
    settings.report(problems, "drag", "needs a law in -drag_expression",
                    "add for example -drag_expression \"-v - 0.1*v*abs(v)\"");
    return;
  }
  try {
    scene.drag = model::parse_drag(scene.drag_expression, scene.friction, scene.tau,
                                   largest_force(scene), scene.bias);
  } catch (const model::UnfitLaw& law) {
    return settings.report(problems, "drag_expression", law.what(), law.fix());
  }
}

// The levels that exist, and that some of them slide.
void check_noise(const Settings& settings, model::Scene& scene, Problems& problems) {
  int full = 0, highest = 0, lowest = 0;
  try {
    full = scene.full_levels();
    highest = scene.process(1).static_index();
    lowest = scene.process(1).lowest_static();
  } catch (const std::out_of_range&) {
    settings.report(problems, "delta", "gives more noise levels than can be counted",
                    "take a larger step");
    return;
  }
  if (settings.text("noise_levels") == "full") scene.noise_levels = full;
  const double tau = scene.tau, delta = scene.delta;
  if (full < 1) {
    settings.report(problems, "delta",
                    fmt::format("leaves no noise level besides 0: tau delta^2 = {:g} must be at "
                                "most 2",
                                tau * delta * delta),
                    fmt::format("take -delta at most {:g}", std::sqrt(2 / tau)));
    return;
  }
  if (scene.noise_levels.value_or(1) > full) {
    settings.report(problems, "noise_levels",
                    fmt::format("gives tau delta L_X = {:g} with L_X = N delta, but jump "
                                "probabilities need at most 2",
                                tau * delta * delta * *scene.noise_levels),
                    fmt::format("take at most {}, or full", full));
    return;
  }
  const int levels = scene.noise_levels.value_or(full), k = std::max(highest, -lowest);
  if (k >= levels && scene.bias == 0) {
    settings.report(problems, "mu_s",
                    fmt::format("is not below the largest noise level {:g}: nothing ever slides",
                                levels * delta),
                    levels < full ? fmt::format("take -noise_levels above {}", k)
                                  : fmt::format("take -mu_s below {:g}, or smaller -tau or -delta",
                                                levels * delta));
  } else if (k >= levels) {
    settings.report(problems, "bias",
                    fmt::format("is never overcome by the noise, which reaches {:g}: no body at "
                                "rest would ever start against it",
                                levels * delta),
                    fmt::format("take |bias| below {:g}, or smaller -tau or -delta",
                                levels * delta - scene.friction.mu_s));
  } else if (lowest > highest) {
    settings.report(
        problems, "mu_s",
        fmt::format("holds the body on no noise level, which are {:g} apart and shifted "
                    "by the bias {:g}: nothing ever sticks",
                    delta, scene.bias),
        "take a smaller -delta");
  }
}

model::Scene read_scene(const Settings& settings, Request& request, Problems& problems) {
  model::Scene scene;
  scene.tau = settings.real("tau");
  scene.delta = settings.real("delta");
  scene.friction = {settings.real("mu_s"), settings.real("mu_d")};
  scene.drag_name = settings.text("drag");
  scene.drag = read_drag(settings, request, problems);
  scene.bias = settings.real("bias");
  scene.noise_levels = settings.integer("noise_levels");
  if (settings.given("v_max")) scene.v_max = settings.real("v_max");
  if (scene.friction.mu_d > scene.friction.mu_s) {
    settings.report(problems, "mu_d",
                    fmt::format("must be in (0, mu_s], and mu_s = {}", settings.text("mu_s")),
                    "friction cannot grow when the body starts to slide");
  }
  const bool no_drag = scene.drag_name != "expression" && scene.drag.is_none();
  if (no_drag && std::abs(scene.bias) >= scene.friction.mu_d) {
    settings.report(problems, "bias",
                    fmt::format("drives a sliding body for ever: without drag only mu_d = {:g} "
                                "holds it back",
                                scene.friction.mu_d),
                    "take a bias smaller than mu_d, or add drag");
  }
  return scene;
}

struct Asked {
  const char* name;
  Quantity quantity;
  std::vector<Route> routes;            // that give it
  std::vector<Route> without_symmetry;  // of these, those that need none
};

const std::vector<Asked>& askable() {
  using enum Route;
  static const std::vector<Asked> all{
      {"sticking",
       Quantity::sticking,
       {excursion, lambda, hitting, null_vector, fluid_queue, monte_carlo},
       {excursion, null_vector, monte_carlo}},
      {"moments",
       Quantity::moments,
       {excursion, lambda, null_vector, fluid_queue, monte_carlo},
       {excursion, null_vector, monte_carlo}},
      {"noise_law",
       Quantity::noise_law,
       {excursion, lambda, null_vector, fluid_queue, monte_carlo},
       {excursion, null_vector, monte_carlo}},
      {"entry_law", Quantity::entry_law, {excursion, fluid_queue, monte_carlo}, {}},
      {"density", Quantity::density, {excursion}, {excursion}},
      {"laplace", Quantity::laplace, {excursion, fluid_queue, monte_carlo}, {}},
      {"F_stick", Quantity::stay_transform, {excursion}, {}},
      {"resolvent", Quantity::resolvent, {excursion}, {}},
      {"relaxation", Quantity::relaxation, {excursion}, {}},
      {"spectrum", Quantity::spectrum, {excursion, monte_carlo}, {excursion, monte_carlo}},
      {"duration_density", Quantity::duration_density, {excursion, monte_carlo}, {}},
      {"autocorrelation", Quantity::autocorrelation, {excursion}, {}},
      {"expectation", Quantity::expectation, {excursion}, {}},
      {"trajectory", Quantity::trajectory, {excursion, monte_carlo}, {excursion, monte_carlo}},
      {"sensitivity", Quantity::sensitivity, {excursion}, {}}};
  return all;
}

Route route_named(const std::string& name) {
  if (name == "lambda") return Route::lambda;
  if (name == "hitting") return Route::hitting;
  if (name == "null_vector") return Route::null_vector;
  if (name == "fluid_queue") return Route::fluid_queue;
  if (name == "monte_carlo") return Route::monte_carlo;
  return Route::excursion;
}

using KeysOfQuantities = std::vector<std::pair<std::string, std::vector<std::string>>>;

// The results that a reference asks for by its name.
const KeysOfQuantities& asking_keys() {
  static const KeysOfQuantities keys{
      {"sticking", {"P_stick", "P_slide", "mean_stick", "mean_slide", "mean_excursion"}},
      {"moments", {"E_V2", "E_absV", "E_XV", "E_V"}},
      {"noise_law", {"P_X_le_mu_s", "E_X2"}},
      {"entry_law", {"entry_law", "f_stick_0"}},
      {"laplace", {"F_slide", "F_stick", "F_excursion"}},
      {"duration_density",
       {"f_slide", "f_stick", "f_excursion", "cdf_slide", "cdf_stick", "cdf_excursion"}},
      {"spectrum", {"S_v", "S_0", "fwhm", "t_corr"}},
      {"autocorrelation", {"C_vv"}}};
  return keys;
}

// The quantity that gives a result of that name; empty if none does.
std::string quantity_of(const std::string& key) {
  for (const auto& [quantity, names] : asking_keys()) {
    if (std::count(names.begin(), names.end(), key) > 0) return quantity;
  }
  return "";
}

// Names of all results but derivatives and those of observables.
std::vector<std::string> plain_keys() {
  std::vector<std::string> keys{"diffusivity",
                                "variance_from_spectrum",
                                "var_slide",
                                "var_stick",
                                "var_excursion",
                                "f_slide_0",
                                "h_plus",
                                "h_minus",
                                "w_one",
                                "relaxation_even",
                                "relaxation_odd",
                                "relaxation_even_frequency",
                                "relaxation_odd_frequency"};
  for (const auto& [quantity, names] : asking_keys()) {
    keys.insert(keys.end(), names.begin(), names.end());
  }
  return keys;
}

// Whether it looks like pi(v^2) or dP_stick_dmu_d.
bool is_composed_key(const std::string& key) {
  const auto open = key.find('(');
  if (open != key.npos && key.ends_with(')')) {
    static const std::set<std::string> of{"u", "w_plus", "w_minus", "pi", "mu", "E", "stationary"};
    return of.contains(key.substr(0, open));
  }
  for (const char* parameter : {"_dmu_d", "_dtau", "_ddrag_coefficient"}) {
    if (!key.starts_with('d') || !key.ends_with(parameter)) continue;
    const std::size_t ends = 1 + std::string_view(parameter).size();
    if (key.size() > ends && !quantity_of(key.substr(1, key.size() - ends)).empty()) return true;
  }
  return false;
}

// A misspelled name would be left out, and the rest agree.
void check_keys(const Settings& settings, const Request& request, Problems& problems) {
  const auto keys = plain_keys();
  std::set<std::string> told;
  for (const auto& reference : request.question.references) {
    const std::string& key = reference.quantity;
    const bool known = std::count(keys.begin(), keys.end(), key) > 0 || is_composed_key(key);
    if (known || !told.insert(key).second) continue;
    const std::string near = nearest_word(key, keys);
    settings.report(problems, "compare", fmt::format("names {}, which is no result", key),
                    near.empty() ? "-help tells the results of each of -quantities"
                                 : fmt::format("did you mean {}?", near));
  }
}

void read_compared(const Settings& settings, Request& request, Problems& problems) {
  request.output.compared = settings.text("compare");
  if (request.output.compared.empty()) return;
  try {
    request.question.references = read_references(request.output.compared);
  } catch (const std::invalid_argument& error) {
    settings.report(problems, "compare", error.what(),
                    "name a file written by -output or -summary, or CSV with the columns "
                    "quantity,argument,value,low,high");
  }
  check_keys(settings, request, problems);
}

// Those named; else those of the file to compare with; else the default ones.
std::vector<std::string> quantity_names(const Settings& settings, const Request& request) {
  if (settings.given("quantities") || request.question.references.empty()) {
    return settings.list("quantities");
  }
  std::vector<std::string> names;
  for (const auto& reference : request.question.references) {
    names.push_back(quantity_of(reference.quantity));
  }
  return names;
}

// The quantities named; of others those that the route gives.
void read_quantities(const Settings& settings, Request& request, Problems& problems) {
  const bool symmetric = request.scene.symmetric();
  std::vector<std::string> given_by_route, refused;
  const auto names = quantity_names(settings, request);
  for (const auto& asked : askable()) {
    const auto& routes = symmetric ? asked.routes : asked.without_symmetry;
    const bool gives = std::count(routes.begin(), routes.end(), request.method.route) > 0;
    const bool named = std::count(names.begin(), names.end(), asked.name) > 0;
    if (gives) given_by_route.emplace_back(asked.name);
    if (named && gives) request.question.quantities.insert(asked.quantity);
    if (named && !gives) refused.emplace_back(asked.name);
  }
  const bool some = !request.question.quantities.empty() && !settings.given("quantities");
  if (refused.empty() || some) return;
  settings.report(
      problems, "quantities",
      fmt::format("{} cannot be had by -route {}{}, which gives {}", enumerate(refused, "and"),
                  settings.text("route"), symmetric ? "" : " without symmetry",
                  given_by_route.empty() ? "nothing" : enumerate(given_by_route, "and")),
      symmetric ? "take -route excursion, or other quantities"
                : "take other quantities, or -bias 0 and an odd drag");
}

void read_observables(const Settings& settings, Request& request, Problems& problems) {
  const auto texts = split(settings.text("observable"), ';');
  if (settings.given("observable") && texts.empty()) {
    settings.report(problems, "observable", "names no function of the state",
                    "write for example \"v^2; x*v; stick\"");
  }
  for (auto text = texts.begin(); text != texts.end(); ++text) {
    if (std::find(texts.begin(), text, *text) != text) {
      settings.report(problems, "observable", "names " + *text + " twice", "name it once");
      continue;
    }
    try {
      request.question.observables.push_back(
          model::parse_observable(*text, request.scene.friction));
    } catch (const std::invalid_argument& error) {
      settings.report(problems, "observable", error.what(),
                      "write for example \"v^2; x*v; stick\"");
    }
  }
}

// Up to 17 levels evenly, and those next to the numbers of f.
std::vector<double> probed_levels(const model::Scene& scene, const model::Observable& f) {
  const auto noise = scene.meant().noise;
  const double seen = (largest_force(scene) + scene.friction.mu_d) / scene.delta;
  const int highest = std::min<int>(noise.levels, static_cast<int>(std::min(seen, 1e9)));
  constexpr int half = 8;
  std::set<int> levels;
  for (int n = -half; n <= half; ++n) levels.insert(static_cast<int>(highest * (n * 1.0 / half)));
  for (double number : f.numbers) {
    const double near = std::min<double>(number / scene.delta, highest - 1);
    for (double level : {std::floor(near), std::ceil(near)}) {
      for (int sign : {1, -1}) levels.insert(sign * static_cast<int>(level));
    }
  }
  std::vector<double> x;
  for (int level : levels) x.push_back(noise.level(level));
  std::sort(x.begin(), x.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
  return x;
}

// |v| beyond which nothing counts.
double largest_speed(const model::Scene& scene) {
  constexpr double rounding = 1e-16;
  const double force = largest_force(scene);
  double speed =
      std::max(scene.drag.terminal_velocity(force), scene.drag.mirrored().terminal_velocity(force));
  speed = std::min(speed, velocity::tail_velocity(scene.meant(), rounding));
  return std::min(speed, scene.v_max.value_or(speed));
}

// Where f jumps within an element, its polynomials are wrong by more than refinement sees. At v = 0
// elements end, and x has a level on each of its values.
void check_observables(const Settings& settings, const Request& request, Problems& problems) {
  const bool used =
      request.question.wants(Quantity::resolvent) || request.question.wants(Quantity::expectation);
  if (!used || request.method.scheme != Scheme::hp || !problems.empty()) return;
  const double speed = largest_speed(request.scene);
  for (const auto& f : request.question.observables) {
    const auto jump = model::velocity_jump(f, probed_levels(request.scene, f), speed);
    if (!jump) continue;
    settings.report(problems, "observable",
                    fmt::format("{} jumps at v = {:.9g} (seen at x = {:g}); -scheme hp takes "
                                "functions that are continuous in v except at v = 0",
                                f.name, jump->v, jump->x),
                    "take -scheme upwind, or a smooth step such as tanh((v - 0.5)/0.2)");
  }
}

// The values given, or those of the file to compare with.
std::vector<double> arguments(const Settings& settings, const Request& request,
                              const std::string& option, const std::string& quantity) {
  std::vector<double> values = settings.numbers(option);
  if (settings.given(option)) return values;
  for (const auto& reference : request.question.references) {
    const bool asks = reference.argument && quantity_of(reference.quantity) == quantity;
    const double value = reference.argument.value_or(0);
    if (asks && value >= 0 && std::count(values.begin(), values.end(), value) == 0) {
      values.push_back(value);
    }
  }
  return values;
}

// What the quantities and the route need besides the scene.
void read_arguments(const Settings& settings, Request& request, Problems& problems) {
  request.question.lambda = arguments(settings, request, "lambda", "laplace");
  request.question.omega = arguments(settings, request, "omega", "spectrum");
  request.question.time = arguments(settings, request, "time", "duration_density");
  read_observables(settings, request, problems);
  const bool transforms = request.question.wants(Quantity::laplace) ||
                          request.question.wants(Quantity::stay_transform) ||
                          request.question.wants(Quantity::resolvent);
  const bool resolvent =
      request.question.wants(Quantity::resolvent) || request.question.wants(Quantity::expectation);
  if (transforms && request.question.lambda.empty()) {
    settings.report(problems, "quantities", "asks for functions of lambda and no values are given",
                    "add for example -lambda 0.1,1,10");
  }
  if (resolvent && request.question.observables.empty() && !settings.given("observable")) {
    settings.report(problems, "quantities", "asks for functions of the state and none are given",
                    "add for example -observable \"v^2; stick\"");
  }
  const bool of_time = request.question.wants(Quantity::duration_density) ||
                       request.question.wants(Quantity::autocorrelation) ||
                       request.question.wants(Quantity::expectation);
  if (of_time && request.question.time.empty()) {
    settings.report(problems, "quantities", "asks for functions of time and no times are given",
                    "add for example -time 0.01:10:31:log");
  }
  const bool by_lambda = request.method.route == Route::lambda;
  if (by_lambda && !request.question.lambda.empty() &&
      (request.question.lambda.size() > 1 || request.question.lambda[0] == 0)) {
    settings.report(problems, "lambda", "must be one positive number with -route lambda",
                    "leave it out to have it chosen from -accuracy");
  }
  const auto warn_unused = [&](const char* name, bool used) {
    if (!used && settings.given(name)) {
      request.warnings.push_back(fmt::format("-{} has no effect on what is asked for", name));
    }
  };
  if (request.question.wants(Quantity::sensitivity) &&
      !request.question.wants(Quantity::sticking) && !request.question.wants(Quantity::moments) &&
      !request.question.wants(Quantity::noise_law)) {
    settings.report(problems, "quantities", "asks for derivatives and for nothing to derive",
                    "add sticking, moments or noise_law");
  }
  warn_unused("lambda", transforms || by_lambda);
  warn_unused("observable", resolvent);
  warn_unused("time", of_time);
  warn_unused("start", request.question.wants(Quantity::expectation) ||
                           request.question.wants(Quantity::trajectory));
  warn_unused("horizon", request.question.wants(Quantity::trajectory));
  const bool simulates = request.method.route == Route::monte_carlo;
  warn_unused("excursions", simulates);
  warn_unused("checkpoint", simulates || sweeps(settings));
  warn_unused("sweep_csv", sweeps(settings));
  warn_unused("sweep_ranks", sweeps(settings));
  warn_unused("seed", simulates || request.question.wants(Quantity::trajectory));
  warn_unused("transient_solver", of_time);
  warn_unused("omega", request.question.wants(Quantity::spectrum));
  warn_unused("spectrum_solver", request.question.wants(Quantity::spectrum));
}

// s+, s- or x,v with x on a noise level.
void read_start(const Settings& settings, Request& request, Problems& problems) {
  const std::string text = settings.text("start");
  const auto process = request.scene.process(1);
  request.question.start_level =
      text == "s-" ? process.lowest_static() - 1 : process.static_index() + 1;
  if (text == "s+" || text == "s-") return;
  const auto numbers = parse_numbers(text);
  if (!numbers || numbers->size() != 2) {
    settings.report(problems, "start", "must be s+, s- or x,v", "write for example -start 0.5,0");
    return;
  }
  const double place = (*numbers)[0] / request.scene.delta, level = std::round(place);
  request.question.start_v = (*numbers)[1];
  const int levels = request.scene.noise_levels.value_or(request.scene.full_levels());
  if (std::abs(place - level) > 1e-9 * std::max(1.0, std::abs(place)) || std::abs(level) > levels) {
    settings.report(problems, "start",
                    fmt::format("starts between the noise levels, which are {:g} apart up to {:g}",
                                request.scene.delta, levels * request.scene.delta),
                    fmt::format("take x = {:g}",
                                std::clamp<double>(level, -levels, levels) * request.scene.delta));
    return;
  }
  request.question.start_level = static_cast<int>(level);
}

// A path is kept in memory.
void read_horizon(const Settings& settings, Request& request, Problems& problems) {
  request.question.horizon = settings.real("horizon");
  const auto& scene = request.scene;
  const double jumps = request.question.horizon * scene.process(1).noise.rate();
  constexpr double most = 5e7;
  if (!request.question.wants(Quantity::trajectory) || jumps <= most) return;
  settings.report(
      problems, "horizon",
      fmt::format("means {:.1e} jumps of the noise, and {:.0e} can be kept", jumps, most),
      fmt::format("take at most {:.3g}", request.question.horizon * most / jumps));
}

void read_spectrum_solver(const Settings& settings, Request& request, Problems& problems) {
  if (settings.text("spectrum_solver") != "direct") return;
  request.method.spectrum_solver = SpectrumSolver::direct;
  if (petsc::complex_scalars()) return;
  settings.report(problems, "spectrum_solver", "needs complex scalars",
                  "run stickslip-complex with the same options, or take krylov");
}

void check_no_grid(const Settings& settings, const Request& request, Problems& problems) {
  if (request.method.route != Route::monte_carlo && request.method.route != Route::fluid_queue)
    return;
  for (const char* name : {"scheme", "degree", "layers", "noise_degree", "noise_grading", "p"}) {
    if (!settings.given(name)) continue;
    settings.report(
        problems, name,
        fmt::format("is no choice of -route {}, which has no grid in v", settings.text("route")),
        "leave it out");
  }
}

// What only some routes can do.
void check_route(const Settings& settings, const Request& request, Problems& problems) {
  if (request.method.route != Route::excursion && request.scene.v_max) {
    settings.report(problems, "v_max", "is no choice of -route " + settings.text("route"),
                    "leave it out, or take -route excursion");
  }
  check_no_grid(settings, request, problems);
  if (request.method.route == Route::monte_carlo) {
    const bool by_omega = request.scene.symmetric();
    if (request.question.wants(Quantity::spectrum) && request.question.omega.empty() && by_omega) {
      settings.report(problems, "quantities", "asks for the spectrum and no frequencies are given",
                      "add for example -omega 0:10:41");
    }
  }
  if (!request.scene.symmetric() && request.question.wants(Quantity::spectrum) &&
      !request.question.omega.empty()) {
    settings.report(problems, "omega", "has no meaning without symmetry, where spectrum gives S_0",
                    "leave it out");
  }
  if (request.method.route != Route::fluid_queue) return;
  if (!request.scene.drag.is_none()) {
    settings.report(problems, "route", "needs b = 0: only then is the model a fluid queue",
                    "add -drag none, or take -route excursion");
  }
}

void read_method(const Settings& settings, Method& method, Problems& problems) {
  method.scheme = settings.text("scheme") == "upwind" ? Scheme::upwind : Scheme::hp;
  method.degree = settings.integer("degree");
  method.layers = settings.integer("layers");
  method.points = settings.integer("p");
  method.noise_degree = settings.integer("noise_degree");
  method.noise_grading = settings.real("noise_grading");
  method.factors = read_factors();
  const bool hp = method.scheme == Scheme::hp;
  for (const char* name : {"degree", "layers", "noise_degree", "noise_grading"}) {
    if (!hp && settings.given(name)) {
      settings.report(problems, name, "belongs to -scheme hp", "leave it out, or take -scheme hp");
    }
  }
  if (hp && settings.given("p")) {
    settings.report(problems, "p", "belongs to -scheme upwind",
                    "leave it out, or take -scheme upwind");
  }
}

StudyKind study_named(const std::string& name) {
  if (name == "p") return StudyKind::points;
  if (name == "delta") return StudyKind::steps;
  if (name == "heuristic") return StudyKind::heuristic;
  return name == "cost" ? StudyKind::cost : StudyKind::none;
}

// A study chooses discretisations and routes itself, and looks at scalars.
void read_study(const Settings& settings, Request& request, Problems& problems) {
  request.study.kind = study_named(settings.text("study"));
  request.study.steps = settings.integer("study_steps");
  request.study.repeats = settings.integer("study_repeats").value_or(3);
  request.output.study_csv = settings.text("study_csv");
  if (request.study.kind == StudyKind::none) {
    for (const char* name : {"study_steps", "study_repeats", "study_csv"}) {
      if (!settings.given(name)) continue;
      request.warnings.push_back(fmt::format("-{} has no effect without -study", name));
    }
    return;
  }
  for (const char* name : {"route", "scheme", "degree", "layers", "noise_degree", "noise_grading",
                           "p", "v_max", "compare", "checkpoint", "noise_levels"}) {
    if (!settings.given(name)) continue;
    settings.report(problems, name, "is chosen by -study itself", "leave it out");
  }
  for (Quantity q : request.question.quantities) {
    const bool scalar =
        q == Quantity::sticking || q == Quantity::moments || q == Quantity::noise_law;
    if (scalar) continue;
    settings.report(problems, "quantities", "of a study are sticking, moments and noise_law",
                    "leave the others out");
    return;
  }
}

void check_writable(const Settings& settings, const std::string& name, Problems& problems) {
  if (!settings.given(name) || settings.text(name).empty()) return;
  const std::filesystem::path file = settings.text(name);
  const std::filesystem::path folder =
      file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error)) {
    settings.report(problems, name, "is in a folder that does not exist", "make the folder first");
  } else if (access(folder.c_str(), W_OK) != 0) {
    settings.report(problems, name, "is in a folder that cannot be written", "name another place");
  } else if (std::filesystem::is_directory(file, error)) {
    settings.report(problems, name, "is a folder", "name a file");
  } else if (std::filesystem::exists(file, error) && access(file.c_str(), W_OK) != 0) {
    settings.report(problems, name, "is a file that cannot be written", "name another file");
  }
}

void read_output(const Settings& settings, Request& request, Problems& problems) {
  check_writable(settings, "summary", problems);
  check_writable(settings, "output", problems);
  check_writable(settings, "trajectory", problems);
  check_writable(settings, "study_csv", problems);
  check_writable(settings, "sweep_csv", problems);
  check_writable(settings, "checkpoint", problems);
  request.output.summary = settings.text("summary");
  request.output.output = settings.text("output");
  request.output.trajectory = settings.text("trajectory");
  request.output.checkpoint = settings.text("checkpoint");
  const std::string progress = settings.text("progress");
  request.output.progress = progress == "on" || (progress == "auto" && isatty(STDERR_FILENO) != 0);
  if (request.question.wants(Quantity::density) && request.output.output.empty()) {
    settings.report(problems, "quantities", "asks for density, a field that needs a file",
                    "add -output FILE.h5");
  }
  if (request.question.wants(Quantity::trajectory) && request.output.output.empty() &&
      request.output.trajectory.empty()) {
    settings.report(problems, "quantities", "asks for a trajectory, which needs a file",
                    "add -output FILE.h5 or -trajectory FILE.csv");
  }
}

}  // namespace

Request request_of(const Settings& settings, Problems& problems) {
  Request request;
  request.scene = read_scene(settings, request, problems);
  check_noise(settings, request.scene, problems);
  read_drag_law(settings, request.scene, problems);
  request.method.route = route_named(settings.text("route"));
  read_compared(settings, request, problems);
  read_quantities(settings, request, problems);
  read_arguments(settings, request, problems);
  read_spectrum_solver(settings, request, problems);
  const bool starts =
      request.question.wants(Quantity::expectation) || request.question.wants(Quantity::trajectory);
  if (starts && problems.empty()) read_start(settings, request, problems);
  if (settings.text("transient_solver") == "stepping") {
    request.method.transient_solver = TransientSolver::stepping;
  }
  request.question.accuracy = settings.real("accuracy");
  request.question.accuracy_given = settings.given("accuracy");
  request.method.excursions = settings.real("excursions");
  request.method.seed = static_cast<std::uint64_t>(settings.real("seed"));
  read_horizon(settings, request, problems);
  read_method(settings, request.method, problems);
  check_observables(settings, request, problems);
  check_route(settings, request, problems);
  if (request.method.route == Route::fluid_queue) request.method.scheme = Scheme::none;
  read_study(settings, request, problems);
  request.plan_only = settings.flag("plan");
  if (request.plan_only && request.study.kind != StudyKind::none) {
    settings.report(problems, "plan", "foretells one run, not a study", "leave -study out");
  }
  read_output(settings, request, problems);
  for (const auto& group : table()) {
    for (const auto& option : group.options) {
      request.resolved.emplace_back(option.name, settings.text(option.name));
    }
  }
  return request;
}

Request read_request(const std::vector<std::string>& argv) {
  Problems problems;
  const Settings settings = Settings::read(problems);
  check_stray_words(argv, problems);
  // Solvers of other types are not tried, so that no option of theirs would count as known.
  if (!check_solver_types(problems)) problems.raise();
  check_solver_options(problems);
  check_unknown_options(problems);
  problems.raise();  // what follows relates values to one another
  if (sweeps(settings)) return read_sweep(settings);
  Request request = request_of(settings, problems);
  problems.raise();
  return request;
}

}  // namespace stickslip::options
