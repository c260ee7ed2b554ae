#include "stickslip/quantities/first_passage.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numeric>
#include <utility>

#include "stickslip/catalogue/peak_keys.hpp"
#include "stickslip/quantities/plan.hpp"
#include "stickslip/quantities/stationary.hpp"
#include "stickslip/quantities/until_passage.hpp"

namespace stickslip::quantities {
namespace {

double mean_over(const Starts& starts, const std::vector<double>& by_start) {
  return std::inner_product(starts.shares.begin(), starts.shares.end(), by_start.begin(), 0.0);
}

}  // namespace

FirstPassage first_passage(operators::Systems& systems, const Starts& starts, double speed) {
  const auto& process = systems.process();
  operators::SystemKey key{0, operators::symmetry_of(process)};
  key.speed_limit = speed;
  auto& system = systems.at(key);
  const operators::KolmogorovOperator& a = system.a();
  const StickingPhases sticking(process, starts.levels, process.symmetric());
  const ByLevel at_rest = sticking.stationary();
  const auto nu = occupations_from(system, starts.levels,
                                   a.mean_at_zero(model::stationary_distribution(process.noise)));
  const UntilPassage until(a, sticking, at_rest, nu, &petsc::Solution::x),
      roughly(a, sticking, at_rest, nu, &petsc::Solution::correction);
  const double exceeded = mean_over(starts, until.reached());
  const double rounding = std::abs(exceeded - mean_over(starts, roughly.reached()));
  if (!(exceeded > 2 * rounding)) return {kNoValue, kNoValue, kNoValue};
  const auto one = a.values([](double, double, double) { return 1.0; });
  const auto times = [&](const UntilPassage& by) {
    const auto time = by.integral(one, sticking.each(1));
    return std::pair{mean_over(starts, time.at_starts), time.overall};
  };
  const auto [from_slide, from_rest] = times(until);
  const auto [roughly_from_slide, roughly_from_rest] = times(roughly);
  return {{exceeded, rounding},
          {from_slide, std::abs(from_slide - roughly_from_slide)},
          {from_rest, std::abs(from_rest - roughly_from_rest)}};
}

namespace {

void append_first_passages(const Computation& computation,
                           const std::vector<FirstPassage>& passages) {
  append_by_speed(computation, catalogue::kPPeak, passages, &FirstPassage::exceeded);
  append_by_speed(computation, catalogue::kFirstPassage, passages, &FirstPassage::from_slide);
  append_by_speed(computation, catalogue::kFirstPassageRest, passages, &FirstPassage::from_rest);
}

}  // namespace

// From each start, and from rest.
void peak_tasks(Planner& planner) {
  planner.resolve_speeds();
  const bool symmetric = planner.symmetric();
  if (!symmetric) planner.need_distribution();  // which has the shares of starts
  const auto found = planner.collect<FirstPassage>(append_first_passages);
  for (double speed : planner.question().velocity) {
    auto system = planner.system();
    system.speed_limit = speed;
    const auto find = [=](Computation& computation) {
      const Starts starts =
          symmetric ? Starts::upwards(computation.process()) : computation.distribution().starts();
      found->push_back(computation.value_or(FirstPassage{kNoValue, kNoValue, kNoValue}, [&] {
        return first_passage(computation.systems, starts, speed);
      }));
    };
    planner.add({fmt::format("first passage to |v| = {:g}", speed),
                 {{system, 0, planner.starts() + 1}},
                 find});
  }
}

}  // namespace stickslip::quantities
