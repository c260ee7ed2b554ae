#include "stickslip/simulation/sampler.hpp"

#include <algorithm>
#include <numeric>

namespace stickslip::simulation {
namespace {

// Excursions take the streams from 0 on.
std::uint64_t places_stream(std::uint64_t batch) { return std::uint64_t{1} << 62 | batch; }
std::uint64_t rests_stream(std::uint64_t batch) { return std::uint64_t{1} << 61 | batch; }
std::uint64_t path_stream(std::uint64_t batch, int sample, std::uint64_t which) {
  return std::uint64_t{1} << 63 | batch << 18 | static_cast<std::uint64_t>(sample) << 2 | which;
}

}  // namespace

Sampler::Sampler(const cases::Question& question, const model::Process& process)
    : tally_(question, process),
      process_(process),
      wanted_(tally_.wanted()),
      source_(make_source(process, wanted_)),
      walk_(make_walk(process, wanted_.travel)),
      order_(wanted_.time.size()),
      states_(wanted_.time.size()) {
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  std::sort(order_.begin(), order_.end(),
            [&](std::size_t a, std::size_t b) { return wanted_.time[a] < wanted_.time[b]; });
  if (wanted_.speeds.empty()) return;
  from_rest_ = make_source(process, {.speeds = wanted_.speeds});
  at_rest_ = std::make_unique<NoiseLevels>(process.noise);
}

const Tally& Sampler::batch(std::uint64_t seed, std::uint64_t batch, int count) {
  RandomStream random(seed, batch), places(seed, places_stream(batch)),
      rests(seed, rests_stream(batch));
  tally_.clear();
  Excursion excursion, from_rest;
  const std::size_t sides = process_.symmetric() ? 1 : 2;
  for (int n = 0; n < count; ++n) {
    if (at_rest_) {
      from_rest_->draw_from(at_rest_->draw(rests.uniform()), rests, from_rest);
      tally_.add_jumps(from_rest.jumps);
    }
    for (std::size_t side = 0; side < sides; ++side) {
      source_->draw(random, side, places.uniform(), excursion);
      excursion.from_rest = &from_rest;
      tally_.add(side, excursion);
      if (!wanted_.stationary_paths) continue;
      add_stationary({seed, path_stream(batch, n, side)}, side, places.uniform());
    }
    if (!wanted_.start) continue;
    walk_->begin({seed, path_stream(batch, n, 2)}, *wanted_.start);
    const auto [first, states] = follow();
    tally_.add({first, states});
    tally_.add_jumps(walk_->jumps());
  }
  return tally_;
}

std::pair<State, std::span<const State>> Sampler::follow() {
  const State first = walk_->state();
  for (std::size_t n : order_) {
    states_[n] = walk_->advance(first.time + wanted_.time[n]);
    states_[n].displacement -= first.displacement;
  }
  return {first, states_};
}

// Twice by the same numbers: until the duration is known, and from a time within it on.
void Sampler::add_stationary(const RandomStream& random, std::size_t side, double place) {
  const int sign = side == 0 ? 1 : -1;
  const model::Start start{process_.exit_level(side == 0)};
  walk_->begin(random, start);
  const double duration = walk_->end_excursion();
  const bool turned = walk_->state().y != sign;
  const double jumps = walk_->jumps();
  walk_->begin(random, start);
  walk_->advance(place * duration);
  const auto [first, states] = follow();
  tally_.add({first, states, true, side, turned, duration});
  tally_.add_jumps(jumps + walk_->jumps());
}

}  // namespace stickslip::simulation
