#include "stickslip/quantities/state_averages.hpp"

#include <cmath>

#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/vectors.hpp"
#include "stickslip/quantities/uncertain.hpp"

namespace stickslip::quantities {
namespace {

using operators::KolmogorovOperator;

/// Integrals of f over an excursion.
struct Integral {
  Uncertain stick, slide;
};

/// f on a discretisation: its values, those at rest from the lowest level up, and what the nodes
/// overlook.
struct Function {
  petsc::VecHandle sliding, overlooked;
  std::vector<double> at_rest;
};

Function function_on(const KolmogorovOperator& a, const model::Observable& f) {
  const auto& process = a.discretisation().process;
  KolmogorovOperator::Observable part = f.value;
  if (process.symmetric()) part = [&f](double x, double y, double v) { return f.even(x, y, v); };
  Function function{a.values(part), a.overlooked(part), {}};
  for (int i = process.lowest_static(); i <= process.static_index(); ++i) {
    function.at_rest.push_back(part(process.noise.level(i), 0, 0));
  }
  return function;
}

// Rounding is the effect of the last correction, and the defect of an exact identity, relative to
// the size of what is summed.
Integral integral(const StationaryDistribution& distribution, double defect, const Function& f) {
  const auto &now = distribution.excursion().stick_time,
             &before = distribution.uncorrected().stick_time;
  Integral sum;
  double change = 0, size = 0;
  for (std::size_t n = 0; n < now.size(); ++n) {
    sum.stick.value += now[n] * f.at_rest[n];
    change += (now[n] - before[n]) * f.at_rest[n];
    size += now[n] * std::abs(f.at_rest[n]);
  }
  sum.stick.error = std::abs(change) + defect * size;
  petsc::VecHandle product;
  petsc::check(VecDuplicate(f.sliding, product.out()));
  petsc::check(VecPointwiseMult(product, f.sliding, distribution.occupation()));
  PetscReal sliding_size = 0;
  petsc::check(VecNorm(product, NORM_1, &sliding_size));
  sum.slide.value = petsc::dot(f.sliding, distribution.occupation());
  sum.slide.error =
      std::abs(sum.slide.value - petsc::dot(f.sliding, distribution.uncorrected_occupation())) +
      std::abs(petsc::dot(f.overlooked, distribution.occupation())) + defect * sliding_size;
  return sum;
}

}  // namespace

model::Observable friction_power(const model::Process& process) {
  const double mu_d = process.friction.mu_d, backwards = process.friction.mirrored().mu_d;
  return {"friction_power",
          [=](double, double, double v) { return v > 0 ? mu_d * v : -backwards * v; }};
}

void append_averages(const StationaryDistribution& distribution, const KolmogorovOperator& a,
                     const std::vector<model::Observable>& observables, Results& results) {
  const double defect = distribution.excursion().conservation_defect(distribution.discretisation());
  const auto mean = [&](double (Excursion::*time)() const) {
    const double value = (distribution.excursion().*time)();
    return Uncertain{value,
                     std::abs(value - (distribution.uncorrected().*time)()) + defect * value};
  };
  const Uncertain stick = mean(&Excursion::mean_stick), slide = mean(&Excursion::mean_slide),
                  excursion = mean(&Excursion::mean_excursion);
  for (const auto& f : observables) {
    const Integral sum = integral(distribution, defect, function_on(a, f));
    const Kind kind = f.within_unit() ? Kind::probability : Kind::drift;
    const auto append = [&](const char* given, Uncertain value) {
      const std::string key = "pi(" + f.name + given + ")";
      results.push_back(scalar({key.c_str(), "", kind}, value));
    };
    append("", (sum.stick + sum.slide) / excursion);
    append("|stick", sum.stick / stick);
    append("|slide", sum.slide / slide);
  }
  const Integral power =
      integral(distribution, defect, function_on(a, friction_power(distribution.process())));
  results.push_back(scalar(kFrictionPower, power.slide / excursion));
  results.push_back(scalar(kSlipRate, Uncertain{1, 0} / excursion));
}

}  // namespace stickslip::quantities
