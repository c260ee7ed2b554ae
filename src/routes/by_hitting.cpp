#include <cmath>
#include <cstdlib>
#include <limits>

#include "routes.hpp"
#include "stickslip/operators/static_chain.hpp"
#include "stickslip/operators/systems.hpp"
#include "stickslip/quantities/uncertain.hpp"

namespace stickslip::routes {
namespace {

using operators::StaticPhase;
using operators::Symmetry;
using quantities::Uncertain;

// E_{s+} of the time until `rest` kills.
Uncertain mean_time(const Setting& setting, StaticPhase rest) {
  operators::Systems systems(setting.comm, setting.discretisation, setting.statistics);
  auto& system = systems.at(0, Symmetry::none, rest);
  // Where the process is killed at once the time is 0.
  const auto edge = [&](double x, double y) {
    return rest == StaticPhase::killing_edges && y == 0 &&
           std::abs(std::lround(x / setting.discretisation.process.noise.delta)) ==
               setting.discretisation.process.static_index();
  };
  const petsc::VecHandle source =
      system.a().values([&](double x, double y, double) { return edge(x, y) ? 0.0 : 1.0; });
  return quantities::value_of(system.a().trace_at_exit(), system.factors().solve(source));
}

}  // namespace

Evaluation by_hitting(const Setting& setting) {
  const int k = setting.discretisation.process.static_index();
  const Uncertain slide = mean_time(setting, StaticPhase::killing);
  const Uncertain to_edge = mean_time(setting, StaticPhase::killing_edges);
  const operators::StaticChain chain(setting.discretisation.process.noise, k);
  const std::vector<double> ones(static_cast<std::size_t>(chain.size()), 1.0);
  const Uncertain from_edge{chain.integral(ones).back(), 0};
  const Uncertain excursion = to_edge + from_edge, p_slide = slide / excursion;
  const double rounding = std::numeric_limits<double>::epsilon();
  const Uncertain p_stick{1 - p_slide.value, p_slide.error + rounding};
  Evaluation evaluation;
  evaluation.results = {scalar(quantities::kPStick, p_stick), scalar(quantities::kPSlide, p_slide),
                        scalar(quantities::kMeanStick, excursion - slide),
                        scalar(quantities::kMeanSlide, slide),
                        scalar(quantities::kMeanExcursion, excursion)};
  evaluation.checks = {{"R_hat", slide.value}, {"R_check", to_edge.value}, {"R", from_edge.value}};
  return evaluation;
}

}  // namespace stickslip::routes
