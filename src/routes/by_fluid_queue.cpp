#include "stickslip/exact/fluid_queue.hpp"

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

using exact::FluidQueue;
using options::Quantity;
using quantities::Excursion;
using quantities::Uncertain;

FluidQueue solve(const model::Process& process, double lambda) {
  try {
    return FluidQueue(process, lambda);
  } catch (const std::runtime_error& error) {
    throw NotReached(std::string(error.what()) +
                     "; slides last too long against the noise, take a larger -mu_d");
  }
}

double sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

Excursion excursion_of(const model::Process& process, const FluidQueue& queue) {
  Excursion e;
  e.slide_time = queue.time();
  e.slide_distance = queue.distance();
  e.slide_square = queue.square();
  e.entry = queue.entry();
  e.entry_orientation = queue.entry_orientation();
  e.lost_probability = sum(e.entry) - 1;
  e.stick_time = operators::StaticChain(process.noise, process.static_index()).occupation(e.entry);
  return e;
}

// What is left of sum P = 1 and of the Riccati equation is rounding, and grows with the length of
// slides, whose moments it changes by about that factor.
double relative_rounding(const Excursion& e, const FluidQueue& queue) {
  const double speed = sum(e.slide_distance) / e.mean_slide();
  const double defect = std::abs(e.lost_probability) + std::abs(queue.residual()) +
                        std::numeric_limits<double>::epsilon();
  return 4 * defect * (1 + speed);
}

// From the law of X as the queue sees it, not from its closed form.
void append_noise_distribution(const model::Process& process,
                               const std::vector<double>& distribution,
                               quantities::Results& results) {
  const int n = process.noise.levels, k = process.static_index();
  double within = 0, square = 0;
  for (int i = -n; i <= n; ++i) {
    if (std::abs(i) <= k) within += distribution[n + i];
    square += distribution[n + i] * process.noise.level(i) * process.noise.level(i);
  }
  results.push_back(quantities::scalar(quantities::kPWithin, within, 0));
  results.push_back(quantities::scalar(quantities::kEX2, square, 0));
}

void append_laplace(const Setting& setting, const Excursion& excursion, double rounding,
                    quantities::Results& results) {
  const auto uncertain = [rounding](const std::vector<double>& p) {
    std::vector<Uncertain> all;
    for (double value : p) all.push_back({value, rounding * value});
    return all;
  };
  std::vector<quantities::DurationTransforms> transforms;
  for (double lambda : setting.given.question.lambda) {
    const FluidQueue killed = solve(setting.discretisation.process, lambda);
    const double slide = killed.slide_transform();
    transforms.push_back({{slide, rounding * slide},
                          quantities::stick_transform(setting.discretisation.process, lambda,
                                                      uncertain(excursion.entry)),
                          quantities::stick_transform(setting.discretisation.process, lambda,
                                                      uncertain(killed.entry()))});
  }
  quantities::append_laplace(setting.given.question.lambda, transforms, results);
}

}  // namespace

Evaluation by_fluid_queue(const Setting& setting) {
  const auto& question = setting.given.question;
  const auto& process = setting.discretisation.process;
  const petsc::PhaseTimer timer("fluid queue", setting.statistics.factorization_seconds);
  const FluidQueue queue = solve(process, 0);
  const Excursion excursion = excursion_of(process, queue);
  const double rounding = relative_rounding(excursion, queue);
  Evaluation evaluation;
  auto& results = evaluation.results;
  if (question.wants(Quantity::sticking)) quantities::append_sticking(excursion, results);
  if (question.wants(Quantity::moments))
    quantities::append_moments(setting.discretisation, excursion, results);
  if (question.wants(Quantity::entry_law)) {
    quantities::append_hitting_distribution(process, excursion, results);
  }
  if (question.wants(Quantity::noise_law)) {
    append_noise_distribution(
        process, quantities::marginal_of_noise(setting.discretisation, excursion), results);
  }
  for (auto& r : results) {
    for (std::size_t n = 0; n < r.value.size(); ++n) r.error[n] = rounding * std::abs(r.value[n]);
  }
  if (question.wants(Quantity::laplace)) append_laplace(setting, excursion, rounding, results);
  evaluation.checks = {{"riccati_residual", queue.residual()},
                       {"lost_probability", excursion.lost_probability}};
  return evaluation;
}

}  // namespace stickslip::routes
