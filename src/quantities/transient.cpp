#include "stickslip/quantities/transient.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/time_stepper.hpp"
#include "stickslip/petsc/vectors.hpp"
#include "stickslip/quantities/time_functions.hpp"

namespace stickslip::quantities {
namespace {

using operators::KolmogorovOperator;
using operators::StaticPhase;
using operators::Symmetry;
using petsc::check;
using petsc::dot;

KolmogorovOperator kept(operators::Systems& systems, Symmetry symmetry) {
  return operators::assemble(systems.comm(), systems.discretisation(), 0, symmetry,
                             StaticPhase::kept, systems.statistics());
}

std::vector<std::size_t> rising(const std::vector<double>& time) {
  std::vector<std::size_t> order(time.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return time[a] < time[b]; });
  return order;
}

std::vector<double> stepped(operators::Systems& systems, const KolmogorovOperator& a, Vec b, Vec c,
                            const std::vector<double>& time, double tolerance) {
  petsc::VecHandle u;
  check(VecDuplicate(b, u.out()));
  check(VecCopy(b, u));
  petsc::TimeStepper stepper(a.matrix(), u, kBackwardPrefix, tolerance, systems.statistics());
  std::vector<double> values(time.size());
  for (std::size_t n : rising(time)) {
    stepper.advance(time[n]);
    values[n] = dot(c, u);
  }
  return values;
}

// c exp(L t) b; errors in units of `unit`.
std::vector<Uncertain> curve(operators::Systems& systems,
                             const StationaryDistribution& distribution, KolmogorovOperator a,
                             Vec b, Vec c, ReducedModel::Nature nature,
                             const std::vector<double>& time, double unit, TransientMethod method,
                             double tolerance) {
  if (method == TransientMethod::krylov) {
    const petsc::VecHandle weight = distribution.weight_on(a);
    return time_curve(systems, std::move(a), StaticPhase::kept, {b, c, weight}, nature,
                      Integral::left_out, time, unit, tolerance)
        .value;
  }
  // Errors of steps add up; a run with coarser steps shows how far.
  const double fine = 0.03 * tolerance * unit, coarse = 10 * fine;
  const auto values = stepped(systems, a, b, c, time, fine);
  const auto others = stepped(systems, a, b, c, time, coarse);
  std::vector<Uncertain> result;
  for (std::size_t n = 0; n < time.size(); ++n) {
    result.push_back({values[n], std::max(fine, std::abs(values[n] - others[n]))});
  }
  return result;
}

}  // namespace

std::vector<Uncertain> autocorrelation(operators::Systems& systems,
                                       const StationaryDistribution& distribution,
                                       const std::vector<double>& time, TransientMethod method,
                                       double tolerance) {
  KolmogorovOperator a = kept(systems, Symmetry::odd);
  const petsc::VecHandle b = a.values([](double, double, double v) { return v; }),
                         c = distribution.weighted_velocity(a);
  const double variance = dot(c, b);
  return curve(systems, distribution, std::move(a), b, c, ReducedModel::Nature::smooth, time,
               variance, method, tolerance);
}

Expectation expectation(operators::Systems& systems, const StationaryDistribution& distribution,
                        const model::Observable& f, const StartState& start,
                        const std::vector<double>& time, TransientMethod method, double tolerance) {
  Expectation result;
  result.value.resize(time.size());
  for (Symmetry symmetry : {Symmetry::even, Symmetry::odd}) {
    KolmogorovOperator a = kept(systems, symmetry);
    const auto part_of = [&](double x, double y, double v) {
      return symmetry == Symmetry::even ? f.even(x, y, v) : f.odd(x, y, v);
    };
    const petsc::VecHandle b = a.values(part_of);
    const petsc::VecHandle pi = distribution.occupation_on(a), square = a.zeros();
    check(VecScale(pi, 1 / distribution.excursion().mean_excursion()));
    check(VecPointwiseMult(square, b, b));
    const double unit = std::sqrt(std::abs(dot(pi, square)));
    if (symmetry == Symmetry::even) result.stationary = dot(pi, b);
    result.unseen += std::abs(dot(pi, a.overlooked(part_of)));
    if (unit == 0) continue;
    const petsc::VecHandle c = a.value_at(start.level, start.v);
    PetscReal seen = 0;
    check(VecNorm(c, NORM_INFINITY, &seen));
    if (seen == 0) continue;  // odd functions vanish at rest at x = 0
    const auto part = curve(systems, distribution, std::move(a), b, c, ReducedModel::Nature::rough,
                            time, unit, method, tolerance);
    for (std::size_t n = 0; n < time.size(); ++n) result.value[n] = result.value[n] + part[n];
  }
  for (auto& value : result.value) value.error += result.unseen;
  return result;
}

}  // namespace stickslip::quantities
