#include "stickslip/run/discretise.hpp"

#include <fmt/format.h>
#include <petscsys.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "stickslip/base/errors.hpp"
#include "stickslip/generator/solver_policy.hpp"
#include "stickslip/linalg/session.hpp"

namespace stickslip::run {
namespace {

generator::MeshRule mesh_rule(const Resolution& resolution) {
  generator::MeshRule rule;
  rule.v_max = resolution.v_max;
  rule.least_degree = resolution.least_degree;
  rule.layers = resolution.layers;
  rule.tolerance = std::pow(10.0, -(resolution.degree + 1));
  rule.whole_tail = resolution.whole_tail;
  rule.rates = resolution.rates;
  rule.integrands = resolution.integrands;
  return rule;
}

double upwind_step(const model::Scene& scene) { return scene.meant().noise.step(); }

// Number of nodes of the upwind velocity discretisation: the first at or beyond v_max is its last.
double upwind_nodes(const model::Scene& scene, const Resolution& resolution) {
  const double ratio = resolution.v_max * resolution.points / upwind_step(scene);
  return std::max(1.0, std::ceil(ratio * (1 - 1e-12)));
}

std::vector<int> hp_degrees(const model::Scene& scene, const Resolution& resolution) {
  return generator::element_degrees(scene.process(resolution.levels), mesh_rule(resolution),
                                    resolution.degree);
}

// Exponential tilt of the distribution of X, per unit of x, that comes with large velocities:
// without drag X conditioned on it is shifted by up to twice mu_d (less where mu_d exceeds the
// noise). Drag that saturates adds to mu_d.
double tilt(const model::Scene& scene) {
  const double mu_d = std::max(scene.friction.mu_d, scene.friction.mirrored().mu_d);
  const auto noise = scene.meant().noise;
  const double drag_time = -scene.drag.slope_at_rest() * noise.intensity() / (mu_d * mu_d);
  const double most = noise.standard_deviation(), variance = most * most;
  if (scene.drag.law && !scene.drag.bounds_velocity()) return 2 * most / variance;
  if (drag_time > 1) return 0;
  return 2 * std::min(mu_d, most) / variance;
}

// Of v > 0, and on the same nodes of v < 0 where the drag is another one there.
std::shared_ptr<generator::VelocityDiscretisation> velocities_of(const model::Scene& scene,
                                                                 const Resolution& resolution) {
  const auto process = scene.process(resolution.levels);
  const auto on_both_branches = [&](const auto& with_drag) {
    std::shared_ptr<generator::VelocityDiscretisation> velocities = with_drag(process.drag);
    if (!process.drag.odd()) velocities->set_mirrored(with_drag(process.drag.mirrored()));
    return velocities;
  };
  if (resolution.scheme == cases::Scheme::upwind) {
    const double spacing = upwind_step(scene) / resolution.points;
    const auto count = static_cast<int>(upwind_nodes(scene, resolution));
    return on_both_branches([&](const model::Drag& drag) {
      return std::make_shared<generator::UpwindDiscretisation>(spacing, count, drag);
    });
  }
  const auto rule = mesh_rule(resolution);
  const auto ends = generator::element_ends(process, rule);
  const auto degrees = generator::element_degrees(process, rule, ends, resolution.degree);
  return on_both_branches([&](const model::Drag& drag) {
    return std::make_shared<generator::HpDiscretisation>(ends, degrees, drag);
  });
}

// Groups keep what stands for each of their levels.
std::shared_ptr<const generator::Nodes> grouped(const model::Process& process,
                                                const generator::Grouping& grouping) {
  if (grouping.degree == 0) return nullptr;
  const double levels = process.noise.count();
  const double need = 24 * levels * (grouping.degree + 2);
  if (need > linalg::available_bytes(PETSC_COMM_SELF, need)) {
    throw NoMemory(fmt::format("{:.3g} noise levels would need {:.2g} GB of memory; take fewer "
                               "-noise_levels or a larger -delta",
                               levels, need / 1e9));
  }
  return std::make_shared<generator::Nodes>(process, grouping);
}

// By how much log of the probability of level i falls from the one before, where paths are weighted
// with exp(s x(t)): as in tail_velocity(), of bodies as fast as the level makes them.
double weighted_fall(const model::Process& process, int i, double step, double tilt) {
  const auto& noise = process.noise;
  const double rate = -std::log(model::weight_ratio(noise, i)) / step;
  const double deviation = noise.standard_deviation(),
               diffusivity = deviation * deviation / noise.correlation_time();
  const double v = process.drag.terminal_velocity(process.net_force(i));
  const double square = rate * rate - 4 * tilt * v / diffusivity;
  return square > 0 ? -step * std::sqrt(square) : kInfinity;
}

void set_levels(const model::Scene& scene, double tolerance, const generator::Rates& rates,
                Resolution& r) {
  if (scene.projector() != nullptr) {
    r.levels = std::max(r.degree, 2);
    r.table_levels = scene.process(r.levels).noise.count();
    return;
  }
  r.levels = scene.noise_levels.value_or(levels_for(scene, tolerance, rates));
  if (scene.noise.table) r.table_levels = scene.process(r.levels).noise.count();
}

// Three times the tolerance where something is cut: 1.2 was seen of the noise for a variance of
// durations, 0.3 of the velocity for that of slips, where the tolerance is a hundredth.
double truncation(const model::Scene& scene, const Resolution& r, double tolerance) {
  constexpr double margin = 3;
  const bool cuts_levels = r.levels < scene.meant().noise.highest();
  const bool cuts_velocities = !scene.v_max && r.v_max < scene.process(r.levels).terminal_speed();
  return cuts_levels || cuts_velocities ? margin * tolerance : 0;
}

// By the solver that will serve it.
generator::FactorCost factor_cost(const model::Scene& scene, const Resolution& r,
                                  cases::Factors factors, int ranks) {
  const auto n = static_cast<double>(unknowns(scene, r));
  constexpr double countable = 1e8;  // beyond, the matrix alone fills a machine
  if (factors != cases::Factors::elements || n > countable) {
    return generator::sparse_cost(factors, r.scheme, n, static_cast<double>(r.noise_nodes()));
  }
  const auto velocities = velocities_of(scene, r);
  const auto process = scene.process(r.levels);
  const auto noise = r.noise ? r.noise : std::make_shared<const generator::Nodes>(process);
  const auto cost = generator::elimination_cost(
      process, dynamic_cast<const generator::HpDiscretisation&>(*velocities), *noise, ranks);
  const bool alike = generator::branches_share_factors(process, r.noise == nullptr, *velocities);
  const int branches = alike ? 1 : r.branches;
  return {branches * cost.entries, branches * cost.bytes, branches * cost.operations};
}

cases::Factors factors_of(const model::Scene& scene, const Resolution& r) {
  return generator::chosen_factors(r.factors, r.scheme, r.noise_nodes(), r.noise == nullptr,
                                   scene.process(r.levels).noise.neighbours_only());
}

}  // namespace

int levels_for(const model::Scene& scene, double tolerance, const generator::Rates& rates) {
  const auto process = scene.meant();
  const double per_force = tilt(scene);
  const auto last = [&](const model::Process& side) {
    const auto& noise = side.noise;
    // Each counts.
    if (!noise.neighbours_only() || (noise.table && rates.tilt > 0)) return noise.highest();
    const bool both = side.starts_downwards();
    // Where bodies do not start on this side, the other one decides.
    if (!side.starts_upwards()) return noise.table ? noise.highest() : 1;
    const double needed =
        rates.speed > 0 ? side.friction.at_rest() - side.bias - side.drag(rates.speed) : -HUGE_VAL;
    double log_weight = 0;  // of level i against the first that does not stick and has the force
    int end = side.highest_static() + 1;
    if (noise.symmetric() && both) end = std::max(end, 1 - side.lowest_static());
    end = std::min(end, noise.highest());
    for (int i = end + 1; i <= noise.highest(); ++i) {
      const double below = noise.level(i - 1), step = noise.level(i) - below;
      log_weight += (rates.tilt > 0 ? weighted_fall(side, i, step, rates.tilt)
                                    : std::log(model::weight_ratio(noise, i))) +
                    per_force * step +
                    2 * std::log1p(step / std::max(std::abs(below), noise.step()));
      if (noise.level(i) <= needed || std::isinf(log_weight)) log_weight = 0;
      if (log_weight > std::log(tolerance)) {
        end = i;
      } else if (!noise.table) {
        break;
      }
    }
    return std::min(end + 1, noise.highest());
  };
  return std::max(last(process), last(process.mirrored()));
}

double velocity_end(const model::Scene& scene, int levels, double tolerance, double tilt) {
  const auto process = scene.process(levels);
  const double terminal = process.terminal_speed();
  if (scene.v_max) return std::min(*scene.v_max, terminal);
  const double tail = generator::tail_velocity(process, tolerance, tilt);
  // Holding states cost a little: a truncation must save something.
  return tail < 0.8 * terminal ? tail : terminal;
}

Resolution hp_resolution(const model::Scene& scene, int degree, int layers, double tolerance,
                         const generator::Rates& rates, const generator::Grouping& grouping) {
  Resolution r;
  r.scheme = cases::Scheme::hp;
  r.degree = degree;
  r.rates = rates;
  set_levels(scene, tolerance, rates, r);
  constexpr double of_velocities = 1e-2;
  r.v_max = velocity_end(scene, r.levels, of_velocities * tolerance, rates.tilt);
  r.truncation = truncation(scene, r, tolerance);
  r.layers = layers > 0 ? layers : generator::natural_layers(scene.process(r.levels), mesh_rule(r));
  r.grouping = grouping;
  r.noise = grouped(scene.process(r.levels), grouping);
  return r;
}

Resolution upwind_resolution(const model::Scene& scene, int points, double tolerance,
                             const generator::Rates& rates) {
  Resolution r;
  r.scheme = cases::Scheme::upwind;
  r.points = points;
  set_levels(scene, tolerance, rates, r);
  r.v_max = velocity_end(scene, r.levels, tolerance, rates.tilt);
  return r;
}

Resolution exact_resolution(const model::Scene& scene, double tolerance) {
  Resolution r;
  r.scheme = cases::Scheme::none;
  set_levels(scene, tolerance, {}, r);
  return r;
}

Resolution following(const Resolution& resolution, double omega) {
  Resolution r = resolution;
  r.waves.clear();
  r.rates.omega = omega;
  return r;
}

generator::Discretisation discretise(const model::Scene& scene, const Resolution& resolution) {
  std::shared_ptr<generator::VelocityDiscretisation> velocities;
  if (resolution.scheme != cases::Scheme::none) velocities = velocities_of(scene, resolution);
  return {scene.process(resolution.levels), std::move(velocities), resolution.noise};
}

std::int64_t unknowns(const model::Scene& scene, const Resolution& resolution) {
  double nodes = 1;
  if (resolution.scheme == cases::Scheme::hp) {
    const auto degrees = hp_degrees(scene, resolution);
    nodes = std::accumulate(degrees.begin(), degrees.end(), static_cast<double>(degrees.size()));
  } else if (resolution.scheme == cases::Scheme::upwind) {
    nodes = upwind_nodes(scene, resolution);
  }
  const double total = static_cast<double>(resolution.noise_nodes()) * nodes * resolution.branches;
  constexpr double most = 9e18;
  return static_cast<std::int64_t>(std::min(total, most));
}

// The matrix, its magnitudes and what a solver copies come on top of the factors.
double predicted_bytes(const model::Scene& scene, const Resolution& resolution, int ranks) {
  if (!resolution.waves.empty()) {
    // The most frequent ones have most elements.
    constexpr double complex_factors = 2;
    const double omega = *std::max_element(resolution.waves.begin(), resolution.waves.end());
    return complex_factors * predicted_bytes(scene, following(resolution, omega), ranks);
  }
  const auto n = static_cast<double>(unknowns(scene, resolution));
  if (resolution.scheme == cases::Scheme::none) {
    constexpr double dense_matrices = 30;
    return 8 * dense_matrices * n * n;
  }
  const bool upwind = resolution.scheme == cases::Scheme::upwind;
  const double row = upwind ? 4 : resolution.degree + 2.0 * resolution.grouping.degree + 6;
  const cases::Factors factors = factors_of(scene, resolution);
  double copies = 60;
  if (factors == cases::Factors::elements) copies = 40;
  if (factors == cases::Factors::incomplete) copies = 120;
  const double scalars = linalg::complex_scalars() ? 2 : 1;
  return factor_cost(scene, resolution, factors, ranks).bytes + scalars * copies * row * n;
}

double relative_work(const model::Scene& scene, const Resolution& resolution) {
  const auto n = static_cast<double>(unknowns(scene, resolution));
  if (resolution.scheme == cases::Scheme::none) return n * n * n;
  double work = factor_cost(scene, resolution, factors_of(scene, resolution), 1).operations;
  constexpr double real_and_complex = 5;
  for (double omega : resolution.waves) {
    work += real_and_complex * relative_work(scene, following(resolution, omega));
  }
  return work;
}

namespace {

void require_position_within(const cases::Case& given, const model::NoiseChain& noise,
                             double v_max) {
  const model::Start& start = given.question.start;
  const auto shares = model::levels_at(noise, start);
  const bool known = std::ranges::any_of(shares, [](double share) { return share != 0; });
  if (known && std::abs(start.v) <= v_max) return;
  double low = kInfinity, high = -kInfinity, force = 0;
  for (int i = noise.lowest(); i <= noise.highest(); ++i) {
    low = std::min(low, noise.position(i));
    high = std::max(high, noise.position(i));
    force = std::max(force, std::abs(noise.level(i)));
  }
  throw BadInput(fmt::format(
      "-start: is further out than bodies are followed at -accuracy {:g}; take p in [{:.3g}, "
      "{:.3g}] with |x - K (p - g/K)| at most {:.3g}, and |v| at most {:.3g}",
      given.question.accuracy, low, high, force, v_max));
}

}  // namespace

void require_start_within(const cases::Case& given, const Resolution& first) {
  const cases::Question& question = given.question;
  const auto starts = [&](const cases::Entry* entry) {
    return question.wants(entry->quantity) && entry->takes("start") && !entry->of_one_run;
  };
  if (std::ranges::none_of(cases::entries(), starts)) return;
  const auto noise = given.scene.process(first.levels).noise;
  const model::Start& start = question.start;
  const int level = start.level;
  const double v = start.v;
  if (start.p) return require_position_within(given, noise, first.v_max);
  const double x = given.scene.meant().noise.level(level);
  const auto refuse = [&](const char* what, double largest, const char* more) {
    throw BadInput(fmt::format("-start = {:g},{:g}: starts beyond the largest {} on which the mean "
                               "is computed at -accuracy {:g}; take |{}| at most {:g}, or {}",
                               x, v, what, question.accuracy, what, largest, more));
  };
  const char* simulated = "-route monte_carlo, which starts at any state that occurs";
  if (level < noise.lowest() || level > noise.highest()) {
    refuse("x", noise.level(noise.highest()), noise.table ? simulated : "-noise_levels full");
  }
  if (std::abs(v) > first.v_max) refuse("v", first.v_max, simulated);
}

}  // namespace stickslip::run
