#include "stickslip/catalogue/noise_law_keys.hpp"
#include "stickslip/exact/fluid_queue.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "routes.hpp"
#include "stickslip/operators/static_chain.hpp"
#include "stickslip/quantities/excursion.hpp"
#include "stickslip/quantities/laplace.hpp"
#include "stickslip/support/errors.hpp"

namespace stickslip::routes {
namespace {

using catalogue::Quantity;
using exact::FluidQueue;
using quantities::Excursion;
using quantities::Uncertain;

FluidQueue solve(const model::Process& process, double lambda) {
  try {
    return FluidQueue(process, lambda);
  } catch (const std::runtime_error& error) {
    throw NotReached(std::string(error.what()) +
                     "; sliding phases last too long against the noise, take a larger -mu_d");
  }
}

double sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

Excursion excursion_of(const model::Process& process, const exact::SlidingMeans& slide) {
  Excursion e;
  e.slide_time = slide.time;
  e.slide_distance = slide.distance;
  e.slide_square = slide.square;
  e.entry = e.entry_plus = slide.entry;
  e.lost_probability = sum(e.entry) - 1;
  e.stick_time = operators::StaticChain::of(process).occupation(e.entry);
  return e;
}

// What is left of sum P = 1 and of the Riccati equation is rounding, and grows with the length of
// sliding phases, whose moments it changes by about that factor.
double relative_rounding(const Excursion& e, const FluidQueue& queue) {
  const double speed = sum(e.slide_distance) / e.mean_slide();
  const double defect = std::abs(e.lost_probability) + std::abs(queue.residual()) +
                        std::numeric_limits<double>::epsilon();
  return 4 * defect * (1 + speed);
}

// From the distribution of X as the queue has it, not from its closed form.
void append_noise_distribution(const model::Process& process,
                               const std::vector<double>& distribution,
                               quantities::Results& results) {
  const auto& noise = process.noise;
  const double mu_s = process.friction.mu_s;
  const int low = noise.first_from(-mu_s), high = noise.last_up_to(mu_s);
  double within = 0, square = 0;
  for (int i = noise.lowest(); i <= noise.highest(); ++i) {
    const double p = distribution[i - noise.lowest()];
    if (low <= i && i <= high) within += p;
    square += p * noise.level(i) * noise.level(i);
  }
  results.push_back(quantities::scalar(catalogue::kPWithin, within, 0));
  results.push_back(quantities::scalar(catalogue::kEX2, square, 0));
}

/// What the queue gives of excursions as they follow one another.
struct Excursions {
  Excursion mean;
  quantities::Starts starts;
};

Excursions excursions_of(const model::Process& process, const FluidQueue& queue) {
  if (process.symmetric()) {
    return {excursion_of(process, queue.plus()), quantities::Starts::upwards(process)};
  }
  const std::vector<int> levels = process.starts();
  std::vector<Excursion> from;
  for (int level : levels) from.push_back(excursion_of(process, queue.from(level)));
  const auto starts = quantities::chain_of_starts(process, levels, from);
  return {quantities::joined(process, starts, from), starts};
}

std::vector<Uncertain> uncertain(const std::vector<double>& p, double rounding) {
  std::vector<Uncertain> all;
  for (double value : p) all.push_back({value, rounding * value});
  return all;
}

void append_laplace(const Problem& problem, const Excursions& excursions, double rounding,
                    quantities::Results& results) {
  const auto& process = problem.discretisation.process;
  const auto transform = [&](double lambda, const std::vector<double>& entry) {
    return quantities::stick_transform(process, lambda, uncertain(entry, rounding));
  };
  std::vector<quantities::DurationTransforms> transforms;
  for (double lambda : problem.given.question.lambda) {
    const FluidQueue killed = solve(process, lambda);
    double slide = 0;
    Uncertain excursion;
    const auto& [levels, shares, next] = excursions.starts;
    for (std::size_t t = 0; t < levels.size(); ++t) {
      const auto& entry = killed.from(levels[t]).entry;
      slide += shares[t] * sum(entry);
      excursion = excursion + shares[t] * transform(lambda, entry);
    }
    transforms.push_back(
        {{slide, rounding * slide}, transform(lambda, excursions.mean.entry), excursion});
  }
  quantities::append_laplace(problem.given.question.lambda, transforms, results);
}

}  // namespace

Evaluation by_fluid_queue(const Problem& problem) {
  const auto& question = problem.given.question;
  const auto& process = problem.discretisation.process;
  const petsc::PhaseTimer timer("fluid queue", problem.statistics.factorization_seconds);
  const FluidQueue queue = solve(process, 0);
  const Excursions excursions = excursions_of(process, queue);
  const Excursion& excursion = excursions.mean;
  const double rounding = relative_rounding(excursion, queue);
  Evaluation evaluation;
  auto& results = evaluation.results;
  if (question.wants(Quantity::sticking)) quantities::append_sticking(excursion, results);
  if (question.wants(Quantity::moments))
    quantities::append_moments(problem.discretisation, excursion, results);
  if (question.wants(Quantity::entry_law)) {
    quantities::append_hitting_distribution(process, excursion, results);
  }
  if (question.wants(Quantity::noise_law)) {
    append_noise_distribution(
        process, quantities::marginal_of_noise(problem.discretisation, excursion), results);
  }
  for (auto& r : results) {
    // E_V is a difference of the two velocity branches.
    const double least = r.kind == quantities::Kind::drift && process.drifts()
                             ? sum(excursion.slide_distance) / excursion.mean_excursion()
                             : 0;
    for (std::size_t n = 0; n < r.value.size(); ++n) {
      r.error[n] = rounding * std::max(std::abs(r.value[n]), least);
    }
  }
  if (question.wants(Quantity::laplace)) {
    quantities::attempt(problem, evaluation, Quantity::laplace,
                        [&] { append_laplace(problem, excursions, rounding, results); });
  }
  if (question.wants(Quantity::stick_duration_transform) && !question.wants(Quantity::laplace)) {
    quantities::append_stick_transform(process, question.lambda,
                                       uncertain(excursion.entry, rounding), results);
  }
  evaluation.checks = {
      {"riccati_residual", queue.residual(), "relative residual of the Riccati equations"},
      {"lost_probability", excursion.lost_probability, "sum of the hitting distribution less 1"}};
  return evaluation;
}

}  // namespace stickslip::routes
