#include "stickslip/quantities/engines/excursions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "stickslip/case/sticking_rows.hpp"
#include "stickslip/model/effect.hpp"

namespace stickslip::quantities {
namespace {

using generator::KolmogorovOperator;
using generator::Symmetry;

// `option` is the one that sets the parameter.
Result derivative(const Row& of, std::string_view option, Uncertain value) {
  const auto& by = effects::model_option(option);
  Result result = scalar(cases::kDerivative, value);
  result.key = fmt::format("d{}_d{}", of.key, by.name);
  result.unit = (model::Unit::parse(of.unit) / model::Unit::parse(by.unit)).text();
  return result;
}

/// Differences between neighbouring static levels, those beyond the ends included, of the mean
/// sticking time T and of the probability h of leaving upwards: from Q T = -1 and Q h = 0,
///
///   up_i (T_i - T_{i+1}) = 1/Lambda + down_i (T_{i-1} - T_i),  up_i (h_{i+1} - h_i) = down_i (h_i
///   - h_{i-1}),
///
/// T = 0 at both ends, h = 0 and 1. Sums of positive terms but for one difference for each level,
/// of numbers that are alike only where T is largest.
struct StaticDifferences {
  std::vector<double> fall, rise;  // of T and of h; index i + 1 - lowest of the pair i, i + 1

  explicit StaticDifferences(const model::Process& process) {
    const auto& noise = process.noise;
    std::vector<double> from_below{0}, weight{1};
    for (int i = process.lowest_static(); i <= process.highest_static(); ++i) {
      from_below.push_back((1 / noise.rate() + noise.down(i) * from_below.back()) / noise.up(i));
      weight.push_back(noise.down(i) / noise.up(i) * weight.back());
    }
    const double all = std::accumulate(weight.begin(), weight.end(), 0.0);
    const double first = std::accumulate(from_below.begin(), from_below.end(), 0.0) / all;
    for (std::size_t n = 0; n < weight.size(); ++n) {
      fall.push_back(from_below[n] - first * weight[n]);
      rise.push_back(weight[n] / all);
    }
  }
};

// stick_time . (dQ T) and stick_time . (dQ h) by tau, as
// (dQ s)_i = (dLambda/Lambda) (Q s)_i + Lambda dalpha_i (s_{i+1} - s_{i-1}).
struct ByTau {
  double sticking = 0, upwards = 0;
};
ByTau static_phase_by_tau(const model::Process& process, const std::vector<double>& stick_time) {
  const auto& noise = process.noise;
  const StaticDifferences differences(process);
  ByTau sum;
  for (std::size_t n = 0; n < stick_time.size(); ++n) {
    const double change =
        noise.rate() * noise.up_change(process.lowest_static() + static_cast<int>(n));
    sum.sticking -= stick_time[n] * (noise.rate_change() / noise.rate() +
                                     change * (differences.fall[n] + differences.fall[n + 1]));
    sum.upwards += stick_time[n] * change * (differences.rise[n] + differences.rise[n + 1]);
  }
  return sum;
}

/// The derivatives by all parameters.
class Sensitivity {
 public:
  // Solves for the durations.
  Sensitivity(generator::Systems& systems, const StationaryDistribution& distribution,
              const std::vector<model::Derivative>& parameters)
      : system_(systems.at(0, generator::symmetry_of(systems.process()))),
        distribution_(distribution),
        parameters_(parameters) {
    const auto chain = generator::StaticChain::of(systems.process());
    for (int start : distribution.starts().levels) exits_.push_back(chain.exit_transform_to(start));
    const Symmetry symmetry = generator::symmetry_of(systems.process());
    for (const auto& theta : parameters_) {
      changes_.push_back(generator::assemble(systems.comm(), systems.discretisation(), {}, symmetry,
                                             generator::StaticPhase::killing, systems.statistics(),
                                             theta));
    }
    slide_ = sliding_mean([](double, double, double) { return 1.0; });
    stick_ = sticking_mean();
  }

  void append_sticking(Results& results) const {
    const auto& excursion = distribution_.excursion();
    const double slide = excursion.mean_slide(), stick = excursion.mean_stick();
    const double total = excursion.mean_excursion();
    Gradient sticking, sliding, whole;
    for (std::size_t n = 0; n < parameters_.size(); ++n) {
      const Uncertain up = (slide / total) * stick_[n], down = (stick / total) * slide_[n];
      sticking.push_back((1 / total) * (up - down));
      sliding.push_back((1 / total) * (down - up));
      whole.push_back(slide_[n] + stick_[n]);
    }
    append(cases::kPStick, sticking, results);
    append(cases::kPSlide, sliding, results);
    append(cases::kMeanStick, stick_, results);
    append(cases::kMeanSlide, slide_, results);
    append(cases::kMeanExcursion, whole, results);
  }

  void append_moments(Results& results) const {
    const auto mean = [this](const KolmogorovOperator::Observable& f) {
      return linalg::dot(distribution_.occupation(), system_.a().values(f));
    };
    const auto add = [&](const Row& row, const KolmogorovOperator::Observable& f,
                         const Gradient& of_f = {}) {
      Gradient gradient = sliding_mean(f);
      for (std::size_t n = 0; n < of_f.size(); ++n) gradient[n] = gradient[n] + of_f[n];
      append(row, ratio(mean(f), gradient), results);
    };
    add(cases::kEV2, [](double, double, double v) { return v * v; });
    add(cases::kEAbsV, [](double, double, double v) { return std::abs(v); });
    add(
        cases::kEXV, [](double x, double, double v) { return x * v; }, moved_forces());
    if (distribution_.process().drifts()) {
      add(cases::kEV, [](double, double, double v) { return v; });
    }
  }

 private:
  using Gradient = std::vector<Uncertain>;  // of one mean, by parameter

  [[nodiscard]] Gradient sliding_mean(const KolmogorovOperator::Observable& f) const {
    const std::vector<double> none(exits_[0].size(), 0.0);
    return through(system_.factors().solve(system_.a().values(f)), none);
  }

  [[nodiscard]] Gradient sticking_mean() const {
    const auto& process = distribution_.process();
    const auto& stick_time = distribution_.excursion().stick_time;
    const auto chain = generator::StaticChain::of(process);
    const auto mean = chain.integral(std::vector<double>(stick_time.size(), 1.0));
    // On a single static level all sticking phases have one distribution, whatever the sliding
    // phases.
    Gradient gradient(parameters_.size());
    if (mean.size() > 1) {
      gradient = through(
          system_.factors().solve(system_.a().from_static({mean.begin(), mean.end()})), mean);
    }
    for (std::size_t n = 0; n < parameters_.size(); ++n) {
      if (!parameters_[n].is_of_jumps()) continue;
      const double by_tau = static_phase_by_tau(process, stick_time).sticking;
      const double uncorrected =
          static_phase_by_tau(process, distribution_.uncorrected().stick_time).sticking;
      gradient[n] = gradient[n] + Uncertain{by_tau, std::abs(uncorrected - by_tau)};
    }
    return gradient;
  }

  // What the level from which the next excursion starts adds, by start, of a mean h.
  std::vector<double> worth_of_starts(const linalg::Solution& h) const {
    const auto& starts = distribution_.starts();
    const std::size_t count = starts.size();
    std::vector<Uncertain> means;
    std::vector<std::vector<Uncertain>> next(count);
    for (std::size_t t = 0; t < count; ++t) {
      means.push_back({linalg::dot(system_.a().trace_at_start(starts.levels[t]), h.x), 0});
      for (std::size_t u = 0; u < count; ++u) next[t].push_back({starts.next[t * count + u], 0});
    }
    const std::vector<Uncertain> ones(count, {1, 0});
    std::vector<double> worth;
    const bool positive = distribution_.process().noise.has_levels();
    for (const auto& z : DiscountedStarts(0, ones, next, positive).apart(means)) {
      worth.push_back(z.value);
    }
    return worth;
  }

  // By parameter what an excursion gathers of |v| times the change of the force on its nodes.
  [[nodiscard]] Gradient moved_forces() const {
    const auto& distance = distribution_.excursion().slide_distance;
    Gradient sums;
    for (const auto& theta : parameters_) {
      double sum = 0;
      const std::size_t count = theta.nodes ? theta.nodes->x.size() : 0;
      for (std::size_t n = 0; n < count; ++n) {
        sum += theta.nodes->x[n] * (distance[n] - distance[2 * count - 1 - n]);
      }
      sums.push_back({sum, 0});
    }
    return sums;
  }

  // What changes of rates between nodes at rest add to a mean of values at rest, and at starts.
  [[nodiscard]] double static_phase_by(const model::NodeChange& change,
                                       const std::vector<PetscScalar>& at_rest,
                                       const std::vector<double>& at_starts) const {
    const auto& process = distribution_.process();
    const auto& starts = distribution_.starts().levels;
    const int lowest = process.lowest_static(), first = process.noise.lowest();
    const auto value = [&](int level) {
      if (process.sticks(level)) return PetscRealPart(at_rest[level - lowest]);
      const auto start = std::ranges::find(starts, level);
      return start == starts.end() || at_starts.empty() ? 0.0 : at_starts[start - starts.begin()];
    };
    const auto& stick_time = distribution_.excursion().stick_time;
    double sum = 0;
    for (std::size_t n = 0; n < stick_time.size(); ++n) {
      const int level = lowest + static_cast<int>(n);
      for (const auto& [to, rate] : change.rates[level - first]) {
        sum += stick_time[n] * rate * (value(first + to) - value(level));
      }
    }
    return sum;
  }

  // nu dL (h, s) by parameter, and what the starts change.
  [[nodiscard]] Gradient through(linalg::Solution h, const std::vector<double>& s) const {
    std::vector<PetscScalar> values(s.begin(), s.end());
    std::vector<double> worth;
    double upper_side = 0;
    if (exits_.size() > 1) {
      worth = worth_of_starts(h);
      upper_side = worth.back() - worth.front();
      std::vector<PetscScalar> next(s.size(), 0.0);
      for (std::size_t t = 0; t < worth.size(); ++t) {
        for (std::size_t n = 0; n < next.size(); ++n) next[n] += worth[t] * exits_[t][n];
      }
      const auto more = system_.factors().solve(system_.a().from_static(next));
      linalg::check(VecAXPY(h.x, 1, more.x));
      linalg::check(VecAXPY(h.correction, 1, more.correction));
      for (std::size_t n = 0; n < next.size(); ++n) values[n] += next[n];
    }
    Gradient gradient;
    for (std::size_t n = 0; n < changes_.size(); ++n) {
      const auto& change = changes_[n];
      linalg::VecHandle image = change.zeros();
      const auto flux = [&](Vec function) {
        linalg::check(MatMult(change.matrix(), function, image));
        return -linalg::dot(distribution_.occupation(), image);
      };
      const double moved = linalg::dot(distribution_.occupation(), change.from_static(values));
      const auto& theta = parameters_[n];
      const double chain =
          theta.nodes ? static_phase_by(*theta.nodes, values, worth)
          : !theta.is_of_jumps()
              ? 0
              : upper_side * static_phase_by_tau(distribution_.process(),
                                                 distribution_.excursion().stick_time)
                                 .upwards;
      gradient.push_back({flux(h.x) + moved + chain, std::abs(flux(h.correction))});
    }
    return gradient;
  }

  // value and mean of an integral over an excursion: the derivative of its ratio to
  // mean_excursion.
  [[nodiscard]] Gradient ratio(double mean, const Gradient& of_mean) const {
    const double total = distribution_.excursion().mean_excursion();
    Gradient gradient;
    for (std::size_t n = 0; n < of_mean.size(); ++n) {
      gradient.push_back((1 / total) * (of_mean[n] - (mean / total) * (slide_[n] + stick_[n])));
    }
    return gradient;
  }

  void append(const Row& row, const Gradient& gradient, Results& results) const {
    for (std::size_t n = 0; n < parameters_.size(); ++n) {
      results.push_back(derivative(row, parameters_[n].option, gradient[n]));
    }
  }

  generator::System& system_;
  const StationaryDistribution& distribution_;
  const std::vector<model::Derivative>& parameters_;
  std::vector<std::vector<double>> exits_;  // of leaving for each start, by static level
  std::vector<generator::KolmogorovOperator> changes_;  // dA, by parameter
  Gradient slide_, stick_;
};

// The sizes |A/p| by which derivatives dA/dp without digits are judged.
void set_scales(const model::Scene& scene, const std::vector<model::Derivative>& parameters,
                Results& results) {
  const auto given = effects::parameters_of(scene);
  for (const auto& theta : parameters) {
    const auto p = std::ranges::find(given, theta.option, &model::Parameters::value_type::first);
    if (p == given.end()) continue;
    const double size = std::abs(std::get<double>(p->second));
    for (const Result& a : results) {
      const auto of =
          std::ranges::find(results, fmt::format("d{}_d{}", a.key, theta.option), &Result::key);
      if (of != results.end() && size > 0) of->scale = std::abs(a.value[0]) / size;
    }
  }
}

}  // namespace

void append_sensitivity(generator::Systems& systems, const StationaryDistribution& distribution,
                        const std::vector<model::Derivative>& parameters, bool sticking,
                        bool moments, Results& results) {
  const Sensitivity sensitivity(systems, distribution, parameters);
  if (sticking) sensitivity.append_sticking(results);
  if (moments) sensitivity.append_moments(results);
}

// Weights w_i = prod_{j <= i} alpha_{j-1}/(1 - alpha_j), so that d log w_i/d tau is a sum of
// negative terms; a mean changes by its covariance with that score.
void append_noise_sensitivity(const model::Process& process, Results& results) {
  const auto& noise = process.noise;
  if (noise.table) return;
  const int k = noise.last_up_to(process.friction.mu_s);
  const auto distribution = model::stationary_distribution(noise);
  double score = 0;
  double within = distribution[noise.levels], within_score = 0, beyond = 0, beyond_score = 0;
  double square = 0, square_score = 0;
  for (int i = 1; i <= noise.levels && noise.up(i - 1) > 0; ++i) {
    score += noise.up_change(i - 1) / noise.up(i - 1) - noise.down_change(i) / noise.down(i);
    const double p = 2 * distribution[noise.levels + i], x2 = noise.level(i) * noise.level(i);
    (i <= k ? within : beyond) += p;
    (i <= k ? within_score : beyond_score) += p * score;
    square += p * x2;
    square_score += p * x2 * score;
  }
  const double mean_score = within_score + beyond_score;
  const double by_within = beyond * within_score - within * beyond_score;
  const double by_square = square_score - square * mean_score;
  const double rounding = model::rounding_of_sums(noise);
  const double size = std::abs(square_score) + std::abs(square * mean_score);
  const double within_size = std::abs(beyond * within_score) + std::abs(within * beyond_score);
  results.push_back(derivative(cases::kPWithin, "tau", {by_within, rounding * within_size}));
  results.push_back(derivative(cases::kEX2, "tau", {by_square, rounding * size}));
}

// Adjoints of mean_slide and mean_stick, which every derivative needs, of three moments and of E_V.
// With a single static level mean_stick needs none. Where excursions start from several levels each
// has a second one, by that of the next excursion.
void sensitivity_tasks(Planner& planner) {
  using cases::Quantity;
  const bool sticking = planner.question().wants(Quantity::sticking),
             moments = planner.question().wants(Quantity::moments);
  if (!moments && !sticking) return;
  const auto& scene = planner.given().scene;
  const auto process = scene.meant();
  const int durations = process.highest_static() > process.lowest_static() ? 2 : 1,
            means = durations + (!moments           ? 0
                                 : process.drifts() ? 4
                                                    : 3),
            adjoints = means * (planner.starts() > 1 ? 2 : 1);
  const auto parameters = effects::derivatives_of(scene);
  const auto find = [=](Computation& computation) {
    auto by = parameters;
    for (auto& theta : by) {
      theta.nodes = effects::change_of_nodes(computation.problem.given.scene, theta,
                                             computation.process().noise.levels);
    }
    append_sensitivity(computation.systems, computation.distribution(), by, sticking, moments,
                       computation.results());
    set_scales(computation.problem.given.scene, parameters, computation.results());
  };
  planner.add({"sensitivity",
               {{planner.system(), adjoints, 0}},
               find,
               static_cast<int>(parameters.size())});
}

}  // namespace stickslip::quantities
