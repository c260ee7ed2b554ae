#include "stickslip/quantities/sensitivity.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numeric>

#include "stickslip/model/noise_chain.hpp"
#include "stickslip/operators/static_chain.hpp"
#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/vectors.hpp"

namespace stickslip::quantities {
namespace {

using operators::KolmogorovOperator;
using operators::Parameter;
using operators::Symmetry;

// Of the option.
struct Naming {
  const char *name, *unit;
};

Naming naming(Parameter parameter) {
  switch (parameter) {
  case Parameter::mu_d: return {"mu_d", "force"};
  case Parameter::tau: return {"tau", "time"};
  case Parameter::drag_coefficient: return {"drag_coefficient", "1/time"};
  }
  return {"", ""};
}

Result derivative(const Name& of, Parameter parameter, Uncertain value) {
  const auto [name, below] = naming(parameter);
  const std::string above = *of.unit == 0 ? "1" : of.unit;
  return scalar(fmt::format("d{}_d{}", of.key, name), fmt::format("{}/({})", above, below), value);
}

// D_i = T_i - T_{i+1} > 0 for 0 <= i <= k, of the mean stays T with T_{k+1} = 0: from level i on,
// up_i D_i = 1 + down_i D_{i-1}, and T is even. Sums of positive terms.
std::vector<double> falls_of_mean_stay(const model::NoiseChain& noise, int k) {
  std::vector<double> fall{1 / noise.rate()};
  for (int i = 1; i <= k; ++i) {
    fall.push_back((1 / noise.rate() + noise.down(i) * fall.back()) / noise.up(i));
  }
  return fall;
}

// stick_time . (dQ T) for the mean stays T, by tau: with Q T = -1,
// (dQ T)_i = -(dLambda/Lambda) + Lambda dalpha_i (T_{i+1} - T_{i-1}), where both terms are >= 0.
double stays_by_tau(const model::Process& process, const std::vector<double>& stick_time) {
  const auto& noise = process.noise;
  const int k = process.static_index();
  const auto fall = falls_of_mean_stay(noise, k);
  double sum = 0;
  for (int i = -k; i <= k; ++i) {
    double change = -noise.rate_change() / noise.rate();
    const int level = std::abs(i);
    if (level > 0) {
      change -= noise.rate() * noise.up_change(level) * (fall[level] + fall[level - 1]);
    }
    sum += stick_time[k + i] * change;
  }
  return sum;
}

}  // namespace

std::vector<Parameter> parameters_of(const model::Scene& scene) {
  std::vector<Parameter> parameters{Parameter::mu_d, Parameter::tau};
  if (scene.drag_name == "linear" || scene.drag_name == "cubic") {
    parameters.push_back(Parameter::drag_coefficient);
  }
  return parameters;
}

Sensitivity::Sensitivity(operators::Systems& systems, const StationaryDistribution& distribution,
                         std::vector<Parameter> parameters)
    : system_(systems.at(0, Symmetry::even)),
      distribution_(distribution),
      parameters_(std::move(parameters)) {
  for (Parameter theta : parameters_) {
    changes_.push_back(operators::assemble_derivative(systems.comm(), systems.discretisation(),
                                                      Symmetry::even, theta, systems.statistics()));
  }
  slide_ = slides([](double, double, double) { return 1.0; });
  stick_ = stays();
}

Sensitivity::Gradient Sensitivity::slides(const KolmogorovOperator::Observable& f) const {
  const std::vector<PetscScalar> none(distribution_.excursion().stick_time.size(), 0.0);
  return through(system_.factors().solve(system_.a().values(f)), none);
}

Sensitivity::Gradient Sensitivity::stays() const {
  const auto& process = distribution_.process();
  const auto& stick_time = distribution_.excursion().stick_time;
  const auto chain = operators::StaticChain::of(process);
  const auto mean = chain.integral(std::vector<double>(stick_time.size(), 1.0));
  const std::vector<PetscScalar> s(mean.begin(), mean.end());
  // On a single static level all stays are alike, whatever the slides do.
  Gradient gradient(parameters_.size());
  if (s.size() > 1) gradient = through(system_.factors().solve(system_.a().from_rest(s)), s);
  for (std::size_t n = 0; n < parameters_.size(); ++n) {
    if (parameters_[n] != Parameter::tau) continue;
    const double by_tau = stays_by_tau(process, stick_time);
    gradient[n].value += by_tau;
    gradient[n].error +=
        std::abs(stays_by_tau(process, distribution_.uncorrected().stick_time) - by_tau);
  }
  return gradient;
}

Sensitivity::Gradient Sensitivity::through(const petsc::Solution& h,
                                           const std::vector<PetscScalar>& s) const {
  Gradient gradient;
  for (const auto& change : changes_) {
    petsc::VecHandle image = change.zeros();
    const auto flux = [&](Vec function) {
      petsc::check(MatMult(change.matrix(), function, image));
      return -petsc::dot(distribution_.occupation(), image);
    };
    const double moved = petsc::dot(distribution_.occupation(), change.from_rest(s));
    gradient.push_back({flux(h.x) + moved, std::abs(flux(h.correction))});
  }
  return gradient;
}

Sensitivity::Gradient Sensitivity::ratio(double mean, const Gradient& of_mean) const {
  const double total = distribution_.excursion().mean_excursion();
  Gradient gradient;
  for (std::size_t n = 0; n < of_mean.size(); ++n) {
    gradient.push_back((1 / total) * (of_mean[n] - (mean / total) * (slide_[n] + stick_[n])));
  }
  return gradient;
}

void Sensitivity::append(const Name& name, const Gradient& gradient, Results& results) const {
  for (std::size_t n = 0; n < parameters_.size(); ++n) {
    results.push_back(derivative(name, parameters_[n], gradient[n]));
  }
}

void Sensitivity::append_sticking(Results& results) const {
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
  append(kPStick, sticking, results);
  append(kPSlide, sliding, results);
  append(kMeanStick, stick_, results);
  append(kMeanSlide, slide_, results);
  append(kMeanExcursion, whole, results);
}

void Sensitivity::append_moments(Results& results) const {
  const auto mean = [this](const KolmogorovOperator::Observable& f) {
    return petsc::dot(distribution_.occupation(), system_.a().values(f));
  };
  const auto add = [&](const Name& name, const KolmogorovOperator::Observable& f) {
    append(name, ratio(mean(f), slides(f)), results);
  };
  add(kEV2, [](double, double, double v) { return v * v; });
  add(kEAbsV, [](double, double, double v) { return std::abs(v); });
  add(kEXV, [](double x, double, double v) { return x * v; });
}

// Weights w_i = prod_{j <= i} alpha_{j-1}/(1 - alpha_j), so that d log w_i/d tau is a sum of
// negative terms; a mean changes by its covariance with that score.
void append_noise_sensitivity(const model::Process& process, Results& results) {
  const auto& noise = process.noise;
  const int k = process.threshold_index();
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
  results.push_back(derivative(kPWithin, Parameter::tau, {by_within, rounding * within_size}));
  results.push_back(derivative(kEX2, Parameter::tau, {by_square, rounding * size}));
}

}  // namespace stickslip::quantities
