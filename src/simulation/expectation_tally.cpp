#include "stickslip/catalogue/expectation_keys.hpp"

#include "observed_phases.hpp"

namespace stickslip::simulation {
namespace {

void expectation_of(Tally& tally, std::size_t n) {
  struct Value {
    double weight, of_f;
  };
  const auto& f = tally.question().observables[n];
  const auto stationary = observe(tally, f);
  const auto& start = tally.question().start;
  const bool even = tally.process().symmetric() && start.kind == model::Start::Kind::stationary;
  const auto sums = tally.sums_along(start, [f, even](const FollowedPath& path, const State& z) {
    const double value = even ? f.even(z.x, z.y, z.v) : f(z.x, z.y, z.v);
    return Value{path.weight, path.weight * value};
  });
  tally.report([=](const Tally& t) -> Estimates {
    const auto& of = t.question().observables[n];
    const auto mean = [&](std::size_t at) {
      const auto& m = sums[at];
      const Estimate e = m.estimate(m.overall(&Value::of_f) / m.overall(&Value::weight));
      return widened(t, of, e);
    };
    const Estimate in_the_end = widened(t, of, stationary_mean(stationary));
    return {array(catalogue::kExpectationOf, t.question().time, mean, &of),
            {&catalogue::kStationaryOf, {in_the_end}, {}, &of}};
  });
}

}  // namespace

void expectation_tally(Tally& tally) {
  for (std::size_t n = 0; n < tally.question().observables.size(); ++n) expectation_of(tally, n);
}

}  // namespace stickslip::simulation
