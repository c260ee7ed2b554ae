#include "stickslip/quantities/state_averages.hpp"

#include <cmath>

#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/vectors.hpp"

namespace stickslip::quantities {
namespace {

using operators::KolmogorovOperator;

/// Integrals of f over an excursion, and of |f|, which rounding is relative to.
struct Integral {
  double stick = 0, slide = 0, stick_size = 0, slide_size = 0;
};

Integral integral(const KolmogorovOperator& a, Vec f, const std::vector<double>& f_at_rest,
                  const Excursion& excursion, Vec occupation) {
  Integral sum;
  for (std::size_t n = 0; n < f_at_rest.size(); ++n) {
    sum.stick += excursion.stick_time[n] * f_at_rest[n];
    sum.stick_size += excursion.stick_time[n] * std::abs(f_at_rest[n]);
  }
  petsc::VecHandle product = a.zeros();
  petsc::check(VecPointwiseMult(product, f, occupation));
  sum.slide = petsc::dot(f, occupation);
  PetscReal size = 0;
  petsc::check(VecNorm(product, NORM_1, &size));
  sum.slide_size = size;
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
  const auto& process = distribution.process();
  const auto &last = distribution.excursion(), &before = distribution.uncorrected();
  const double defect = last.conservation_defect(distribution.discretisation());
  const auto append = [&](const Name& name, double value, double uncorrected, double size) {
    results.push_back(scalar(name, value, std::abs(value - uncorrected) + defect * size));
  };
  const auto values = [&](const model::Observable& f) {
    KolmogorovOperator::Observable part = f.value;
    if (process.symmetric()) {
      part = [&f](double x, double y, double v) { return f.even(x, y, v); };
    }
    std::vector<double> at_rest;
    for (int i = process.lowest_static(); i <= process.static_index(); ++i) {
      at_rest.push_back(part(process.noise.level(i), 0, 0));
    }
    const petsc::VecHandle sliding = a.values(part);
    return std::pair{integral(a, sliding, at_rest, last, distribution.occupation()),
                     integral(a, sliding, at_rest, before, distribution.uncorrected_occupation())};
  };
  for (const auto& f : observables) {
    const auto [now, then] = values(f);
    const auto key = [&f](const char* given) { return "pi(" + f.name + given + ")"; };
    const std::string all = key(""), stick = key("|stick"), slide = key("|slide");
    append({all.c_str(), "", Kind::drift}, (now.stick + now.slide) / last.mean_excursion(),
           (then.stick + then.slide) / before.mean_excursion(),
           (now.stick_size + now.slide_size) / last.mean_excursion());
    append({stick.c_str(), "", Kind::drift}, now.stick / last.mean_stick(),
           then.stick / before.mean_stick(), now.stick_size / last.mean_stick());
    append({slide.c_str(), "", Kind::drift}, now.slide / last.mean_slide(),
           then.slide / before.mean_slide(), now.slide_size / last.mean_slide());
  }
  const auto [now, then] = values(friction_power(process));
  append(kFrictionPower, now.slide / last.mean_excursion(), then.slide / before.mean_excursion(),
         now.slide_size / last.mean_excursion());
  append(kSlipRate, 1 / last.mean_excursion(), 1 / before.mean_excursion(),
         1 / last.mean_excursion());
}

}  // namespace stickslip::quantities
