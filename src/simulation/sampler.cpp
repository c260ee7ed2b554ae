#include "stickslip/simulation/sampler.hpp"

#include <algorithm>
#include <numeric>

namespace stickslip::simulation {
namespace {

using Kind = model::Start::Kind;

// Excursions take the streams from 0 on.
std::uint64_t places_stream(std::uint64_t batch) { return std::uint64_t{1} << 62 | batch; }
std::uint64_t path_stream(std::uint64_t batch, int sample, std::uint64_t which) {
  return std::uint64_t{1} << 63 | batch << 18 | static_cast<std::uint64_t>(sample) << 2 | which;
}

}  // namespace

Sampler::Sampler(const model::Process& process, const Wanted& wanted)
    : process_(process),
      wanted_(wanted),
      chosen_(wanted.start && wanted.start->kind != Kind::stationary),
      stationary_(wanted.autocorrelation || (wanted.start && !chosen_)),
      source_(make_source(process, wanted)),
      walk_(make_walk(process)),
      order_(wanted.time.size()),
      states_(wanted.time.size()) {
  if (chosen_ && wanted.start->kind == Kind::rest) noise_.emplace(process.noise);
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  std::sort(order_.begin(), order_.end(),
            [&](std::size_t a, std::size_t b) { return wanted_.time[a] < wanted_.time[b]; });
}

Tally Sampler::batch(std::uint64_t seed, std::uint64_t batch, int count) {
  RandomStream random(seed, batch), places(seed, places_stream(batch));
  Tally tally = empty();
  Excursion excursion;
  const std::size_t sides = process_.symmetric() ? 1 : 2;
  for (int n = 0; n < count; ++n) {
    for (std::size_t side = 0; side < sides; ++side) {
      source_->draw(random, side, places.uniform(), excursion);
      tally.add(side, excursion);
      if (!stationary_) continue;
      add_stationary({seed, path_stream(batch, n, side)}, side, places.uniform(), tally);
    }
    if (chosen_) add_chosen({seed, path_stream(batch, n, 2)}, tally);
  }
  return tally;
}

void Sampler::follow(double begun) {
  for (std::size_t n : order_) states_[n] = walk_->advance(begun + wanted_.time[n]);
}

void Sampler::add_chosen(const RandomStream& random, Tally& tally) {
  RandomStream rest = random;
  const double place = noise_ ? rest.uniform() : 0;
  walk_->begin(rest, noise_ ? noise_->draw(place) : wanted_.start->level, wanted_.start->v);
  follow(0);
  tally.add_path(states_);
  tally.add_jumps(walk_->jumps());
}

// Twice by the same numbers: until the duration is known, and from a time within it on.
void Sampler::add_stationary(const RandomStream& random, std::size_t side, double place,
                             Tally& tally) {
  const int sign = side == 0 ? 1 : -1;
  const int level = side == 0 ? process_.static_index() + 1 : process_.lowest_static() - 1;
  walk_->begin(random, level, 0);
  const double duration = walk_->end_excursion();
  const bool turned = walk_->state().y != sign;
  double jumps = walk_->jumps();
  walk_->begin(random, level, 0);
  const State start = walk_->advance(place * duration);
  follow(place * duration);
  tally.add_stationary(side, turned, duration, start, states_);
  tally.add_jumps(jumps + walk_->jumps());
}

}  // namespace stickslip::simulation
