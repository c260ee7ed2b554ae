#include <cmath>
#include <limits>

#include "routes.hpp"
#include "stickslip/catalogue/sticking_keys.hpp"
#include "stickslip/operators/static_chain.hpp"
#include "stickslip/operators/systems.hpp"
#include "stickslip/quantities/uncertain.hpp"

namespace stickslip::routes {
namespace {

using operators::StaticPhase;
using operators::Symmetry;
using quantities::Uncertain;

/// A mean from s+ and, without symmetry, from s-.
struct Means {
  Uncertain plus, minus;
};

/// Problems on the full grid up to the time at which `static_phase` kills.
class Hitting {
 public:
  Hitting(const Problem& problem, StaticPhase static_phase)
      : process_(problem.discretisation.process),
        static_phase_(static_phase),
        systems_(problem.comm, problem.discretisation, problem.statistics),
        system_(systems_.at(0, Symmetry::none, static_phase)) {}

  /// Means of that time; where the process is killed at once it is 0.
  [[nodiscard]] Means time() {
    return solve([this](double x, bool at_rest) { return at_rest && is_edge(x) ? 0.0 : 1.0; });
  }
  /// Probabilities of reaching the highest static level before the lowest one; 1 if they are one.
  [[nodiscard]] Means upwards() {
    const double rate = process_.noise.rate();
    return solve([this, rate](double x, bool at_rest) {
      return at_rest && x == process_.noise.level(process_.highest_static()) ? rate : 0.0;
    });
  }

 private:
  [[nodiscard]] bool is_edge(double x) const {
    const auto& noise = process_.noise;
    return static_phase_ == StaticPhase::killing_edges &&
           (x == noise.level(process_.highest_static()) ||
            x == noise.level(process_.lowest_static()));
  }

  template <class Source>
  Means solve(Source source) {
    const auto& a = system_.a();
    const auto u = system_.factors().solve(
        a.values([&](double x, double y, double) { return source(x, y == 0); }));
    return {quantities::value_of(a.trace_at_exit(), u),
            quantities::value_of(a.trace_at_exit(operators::Branch::negative), u)};
  }

  const model::Process& process_;
  StaticPhase static_phase_;
  operators::Systems systems_;
  operators::System& system_;
};

}  // namespace

Evaluation by_hitting(const Problem& problem) {
  const auto& process = problem.discretisation.process;
  const auto chain = operators::StaticChain::of(process);
  const auto from_edge = chain.integral(std::vector<double>(chain.size(), 1.0));
  const Means slides = Hitting(problem, StaticPhase::killing).time();
  Hitting edges(problem, StaticPhase::killing_edges);
  const Means to_edge = edges.time();
  // From the edges on the static chain alone decides; s+ and s- are taken in their shares, which
  // with symmetry are equal, as all means are.
  const Means top = process.symmetric() ? Means{{0.5, 0}, {0.5, 0}} : edges.upwards();
  const auto up = chain.upward_exit_transform(), down = chain.downward_exit_transform();
  const auto mean = [](Uncertain at_top, const std::vector<double>& f) {
    return at_top * Uncertain{f.back(), 0} +
           Uncertain{1 - at_top.value, at_top.error} * Uncertain{f.front(), 0};
  };
  const Uncertain falling = mean(top.plus, down), rising = mean(top.minus, up);
  const auto joined = [&](Uncertain plus, Uncertain minus) {
    return (rising * plus + falling * minus) / (rising + falling);
  };
  const Uncertain slide = joined(slides.plus, slides.minus);
  const Uncertain reaching = joined(to_edge.plus, to_edge.minus);
  const Uncertain leaving = joined(mean(top.plus, from_edge), mean(top.minus, from_edge));
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
       "mean time from the onset of sliding to rest at an outermost static level"},
      {"R", leaving.value,
       "mean time from rest at an outermost static level to the onset of sliding"}};
  return evaluation;
}

}  // namespace stickslip::routes
