#include "stickslip/quantities/state_averages.hpp"

#include <cmath>

#include "stickslip/catalogue/averages_keys.hpp"
#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/vectors.hpp"
#include "stickslip/quantities/plan.hpp"
#include "stickslip/quantities/uncertain.hpp"

namespace stickslip::quantities {
namespace {

using operators::KolmogorovOperator;
using operators::Symmetry;

/// Integrals of f over an excursion.
struct Integral {
  Uncertain stick, slide;
};

// Rounding is the effect of iterative refinement, and the defect of an exact identity, relative to
// the size of what is summed.
Integral integral(const StationaryDistribution& distribution, double defect,
                  const KolmogorovOperator& a, const model::Observable& f) {
  const auto& process = distribution.process();
  const auto part = operators::part_with_mean(f, process);
  Integral sum;
  const auto &now = distribution.excursion().stick_time,
             &before = distribution.uncorrected().stick_time;
  double change = 0, size = 0;
  for (std::size_t n = 0; n < now.size(); ++n) {
    const int level = process.lowest_static() + static_cast<int>(n);
    const double at_rest = part(process.noise.level(level), 0, 0);
    sum.stick.value += now[n] * at_rest;
    change += (now[n] - before[n]) * at_rest;
    size += now[n] * std::abs(at_rest);
  }
  sum.stick.error = std::abs(change) + defect * size;
  const petsc::VecHandle sliding = a.values(part), product = a.zeros();
  petsc::check(VecPointwiseMult(product, sliding, distribution.occupation()));
  PetscReal sliding_size = 0;
  petsc::check(VecNorm(product, NORM_1, &sliding_size));
  sum.slide.value = petsc::dot(sliding, distribution.occupation());
  sum.slide.error =
      std::abs(sum.slide.value - petsc::dot(sliding, distribution.uncorrected_occupation())) +
      defect * sliding_size;
  if (!f.quadratic) {
    sum.slide.error += std::abs(petsc::dot(a.overlooked(part), distribution.occupation()));
  }
  return sum;
}

}  // namespace

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
    const Integral sum = integral(distribution, defect, a, f);
    const auto append = [&](const Row& row, Uncertain value) {
      results.push_back(scalar(blank(row, f), value));
    };
    append(catalogue::kPi, (sum.stick + sum.slide) / excursion);
    if (!distribution.process().sticks()) continue;
    append(catalogue::kPiStick, sum.stick / stick);
    append(catalogue::kPiSlide, sum.slide / slide);
  }
  const Integral power =
      integral(distribution, defect, a, model::friction_power(distribution.process().friction));
  results.push_back(scalar(catalogue::kFrictionPower, power.slide / excursion));
  if (distribution.process().sticks()) {
    results.push_back(scalar(catalogue::kSlipRate, Uncertain{1, 0} / excursion));
  }
}

void averages_tasks(Planner& planner) {
  planner.need_distribution();
  const auto system = planner.system();
  planner.add({"averages", {{system, 0, 0}}, [system](Computation& computation) {
                 append_averages(computation.distribution(), computation.systems.at(system).a(),
                                 computation.question().observables, computation.results());
               }});
}

}  // namespace stickslip::quantities
