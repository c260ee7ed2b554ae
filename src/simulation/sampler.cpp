#include "stickslip/simulation/sampler.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "stickslip/support/errors.hpp"
#include "stickslip/support/infinity.hpp"

namespace stickslip::simulation {
namespace {

// By side; of cycles, which are the shorter the more often their start occurs.
std::vector<int> starts_of(const model::Process& process, Sampled sampled) {
  if (!process.sticks()) return {};
  if (sampled != Sampled::cycles) return {process.exit_level(true), process.exit_level(false)};
  const auto flows = process.flows_to_starts();
  return {std::ranges::max_element(flows, {}, [](const auto& each) { return each.second; })->first};
}

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
      sampled_(tally_.sampled()),
      starts_(starts_of(process, sampled_)),
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
  const std::size_t sides = sampled_ == Sampled::sides ? 2 : 1;
  for (int n = 0; n < count; ++n) {
    if (at_rest_) draw_from_rest(rests, from_rest);
    for (std::size_t side = 0; side < sides; ++side) {
      source_->draw(random, starts_[side], places.uniform(), excursion);
      excursion.from_rest = &from_rest;
      // Where all start on one side, those that stand for the other one always turn.
      const bool below = excursion.next < process_.lowest_static();
      excursion.turned = below == (side == 0);
      if (sampled_ == Sampled::cycles) {
        add_cycle(random, places, excursion);
      } else {
        tally_.add(side, excursion);
      }
      if (!wanted_.stationary_paths) continue;
      // With symmetry every other one stands for its mirror image.
      const bool mirrored = process_.symmetric() && n % 2 == 1;
      add_stationary({seed, path_stream(batch, n, side)}, side, places.uniform(), mirrored);
    }
    if (!wanted_.start) continue;
    const RandomStream of_path(seed, path_stream(batch, n, 2));
    walk_->begin(of_path, *wanted_.start);
    FollowedPath path;
    std::tie(path.first, path.states) = follow();
    tally_.add_jumps(walk_->jumps());
    if (!wanted_.passages.empty()) {
      walk_->begin(of_path, *wanted_.start);
      path.passages = pass(false);
      tally_.add_jumps(walk_->jumps());
    }
    tally_.add(path);
  }
  return tally_;
}

// One excursion; before a cycle as many as it takes to its start, or to all speeds.
void Sampler::draw_from_rest(RandomStream& random, Excursion& all) {
  from_rest_->draw_from(at_rest_->draw(random.uniform()), random, all);
  tally_.add_jumps(all.jumps);
  Excursion e;
  while (sampled_ == Sampled::cycles && all.next != starts_[0] &&
         all.passages.size() < wanted_.speeds.size()) {
    from_rest_->draw_from(all.next, random, e);
    tally_.add_jumps(e.jumps);
    for (std::size_t n = all.passages.size(); n < e.passages.size(); ++n) {
      all.passages.push_back(all.slide + all.stick + e.passages[n]);
    }
    all.slide += e.slide;
    all.stick += e.stick;
    all.next = e.next;
  }
}

// The rest of a cycle after its first excursion, and all of it as one.
void Sampler::add_cycle(RandomStream& random, RandomStream& places, Excursion& e) {
  Excursion cycle;
  cycle.transform.assign(wanted_.omega.size(), 0.0);
  for (;; source_->draw(random, e.next, places.uniform(), e)) {
    e.ends_cycle = e.next == starts_[0];
    tally_.add(0, e);
    for (std::size_t n = 0; n < cycle.transform.size(); ++n) {
      cycle.transform[n] +=
          std::polar(1.0, -wanted_.omega[n] * (cycle.slide + cycle.stick)) * e.transform[n];
    }
    cycle.slide += e.slide;
    cycle.stick += e.stick;
    cycle.drift += e.drift;
    if (e.ends_cycle) break;
  }
  tally_.add_cycle(cycle);
}

std::pair<State, std::span<const State>> Sampler::follow() {
  const State first = walk_->state();
  for (std::size_t n : order_) {
    states_[n] = walk_->advance(first.time + wanted_.time[n]);
    states_[n].displacement -= first.displacement;
  }
  return {first, states_};
}

// When the speeds are passed, from the state of the walk on.
std::span<const double> Sampler::pass(bool mirrored) {
  using enum model::Passage;
  constexpr double most = 1e9;
  const auto& speeds = wanted_.passages;
  auto passage = wanted_.passage;
  if (mirrored && passage != both) passage = passage == up ? down : up;
  const double begun = walk_->state().time;
  for (passages_.clear(); passages_.size() < speeds.size();) {
    const double speed = speeds[passages_.size()], time = walk_->passes(passage, speed);
    if (std::isfinite(time)) {
      passages_.push_back(time - begun);
    } else if (walk_->jumps() < most) {
      walk_->step(kInfinity);
    } else {
      throw BadInput(fmt::format("-velocity = {:g}: not reached by a path of {:.0e} jumps of the "
                                 "noise; take smaller speeds, or -route excursion",
                                 speed, most));
    }
  }
  return passages_;
}

// Twice by the same numbers: until the duration is known, and from a time within it on.
void Sampler::add_stationary(const RandomStream& random, std::size_t side, double place,
                             bool mirrored) {
  const int sign = side == 0 ? 1 : -1;
  const model::Start start{starts_[side]};
  walk_->begin(random, start);
  double duration = walk_->end_excursion();
  while (sampled_ == Sampled::cycles && walk_->level() != start.level) {
    duration = walk_->end_excursion();
  }
  const bool turned = walk_->state().y != sign;
  const double jumps = walk_->jumps();
  walk_->begin(random, start);
  walk_->advance(place * duration);
  const auto [first, states] = follow();
  FollowedPath path{first, states, true, side, turned, duration};
  tally_.add_jumps(jumps + walk_->jumps());
  if (!wanted_.passages.empty()) {
    walk_->begin(random, start);
    walk_->advance(place * duration);
    path.passages = pass(mirrored);
    tally_.add_jumps(walk_->jumps());
  }
  tally_.add(path);
}

}  // namespace stickslip::simulation
