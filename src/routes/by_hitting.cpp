#include <limits>

#include "routes.hpp"
#include "stickslip/catalogue/sticking_keys.hpp"
#include "stickslip/operators/static_chain.hpp"
#include "stickslip/operators/systems.hpp"
#include "stickslip/petsc/vectors.hpp"
#include "stickslip/quantities/discounted_starts.hpp"

namespace stickslip::routes {
namespace {

using operators::StaticPhase;
using operators::Symmetry;
using quantities::scalar;
using quantities::Uncertain;

/// Means by the levels from which excursions start.
using Means = std::vector<Uncertain>;

/// Problems on the full grid up to the time at which `static_phase` kills.
class Hitting {
 public:
  Hitting(const Problem& problem, StaticPhase static_phase)
      : process_(problem.discretisation.process),
        starts_(process_.starts()),
        exit_rates_(process_.exit_rates()),
        systems_(problem.comm, problem.discretisation, problem.statistics),
        system_(systems_.at(0, Symmetry::none, static_phase)) {}

  /// Means of that time; where the process is killed at once it is 0.
  [[nodiscard]] Means time() {
    return solve(1, [this](std::size_t level) { return is_edge(level) ? 0.0 : 1.0; });
  }
  /// Means of what f is on the level, from the lowest one up, that kills at rest.
  [[nodiscard]] Means at_edge(const std::vector<double>& f) {
    const double rate = process_.noise.rate();
    return solve(0, [&](std::size_t level) { return is_edge(level) ? rate * f[level] : 0.0; });
  }

 private:
  [[nodiscard]] bool is_edge(std::size_t level) const { return exit_rates_[level] > 0; }

  // With a constant on sliding states, and `at_rest` by level.
  template <class AtRest>
  Means solve(double sliding, AtRest at_rest) {
    const auto& a = system_.a();
    petsc::VecHandle source = a.zeros();
    {
      petsc::WriteView local(source);
      PetscInt at = 0;
      a.states().for_each_local([&](const operators::State& state) {
        const bool rests = state.kind == operators::StateKind::static_phase;
        const int level = state.noise - process_.lowest_static();
        local[at++] = rests ? at_rest(static_cast<std::size_t>(level)) : sliding;
      });
    }
    const auto u = system_.factors().solve(source);
    Means means;
    for (int start : starts_) means.push_back(quantities::value_of(a.trace_at_start(start), u));
    return means;
  }

  const model::Process& process_;
  std::vector<int> starts_;
  std::vector<double> exit_rates_;  // by static level
  operators::Systems systems_;
  operators::System& system_;
};

}  // namespace

// From the edges on the static chain alone decides.
Evaluation by_hitting(const Problem& problem) {
  const auto& process = problem.discretisation.process;
  const auto chain = operators::StaticChain::of(process);
  const std::vector<double> ones(chain.size(), 1.0);
  const Means slides = Hitting(problem, StaticPhase::killing).time();
  Hitting edges(problem, StaticPhase::killing_edges);
  const Means to_edge = edges.time(), reached = edges.at_edge(ones);
  // All reach an edge: what rounding makes of that changes nothing else.
  const auto from_edge = [&](const std::vector<double>& f) {
    Means means = edges.at_edge(f);
    for (std::size_t t = 0; t < means.size(); ++t) means[t] = means[t] / reached[t];
    return means;
  };
  std::vector<Means> next(slides.size());
  for (int start : process.starts()) {
    const Means p = from_edge(chain.exit_transform_to(start));
    for (std::size_t t = 0; t < p.size(); ++t) next[t].push_back(p[t]);
  }
  const quantities::DiscountedStarts starts(0, Means(slides.size(), {1, 0}), next);
  const Uncertain slide = starts.mean(slides), reaching = starts.mean(to_edge),
                  leaving = starts.mean(from_edge(chain.integral(ones)));
  const Uncertain excursion = reaching + leaving, p_slide = slide / excursion;
  const double rounding = std::numeric_limits<double>::epsilon();
  const Uncertain p_stick{1 - p_slide.value, p_slide.error + rounding};
  Evaluation evaluation;
  evaluation.results = {scalar(catalogue::kPStick, p_stick), scalar(catalogue::kPSlide, p_slide),
                        scalar(catalogue::kMeanStick, excursion - slide),
                        scalar(catalogue::kMeanSlide, slide),
                        scalar(catalogue::kMeanExcursion, excursion)};
  evaluation.checks = {
      {"R_hat", slide.value, "mean time from the onset of sliding to rest"},
      {"R_check", reaching.value,
       "mean time from the onset of sliding to rest on a level that the noise can leave"},
      {"R", leaving.value, "mean time from rest on such a level to the onset of sliding"}};
  return evaluation;
}

}  // namespace stickslip::routes
