#include "stickslip/simulation/tally.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <set>
#include <stdexcept>

#include "stickslip/base/errors.hpp"
#include "stickslip/case/displacement_rows.hpp"
#include "stickslip/case/duration_rows.hpp"
#include "stickslip/case/passage_rows.hpp"

namespace stickslip::simulation {

using Follow = void(Tally&);

Follow sticking_tally, moments_tally, averages_tally, noise_law_tally, entry_law_tally,
    laplace_tally, stick_transform_tally, duration_density_tally, phase_durations_tally, slip_tally,
    peak_tally, spectrum_tally, resolvent_tally, autocorrelation_tally, displacement_tally,
    expectation_tally, displacement_transform_tally, displacement_distribution_tally,
    first_passage_tally, passage_transform_tally, passage_distribution_tally;

namespace {

using cases::Quantity;

// All that can be simulated, in the order of results.
constexpr std::pair<Quantity, Follow*> kAll[] = {
    {Quantity::sticking, sticking_tally},
    {Quantity::moments, moments_tally},
    {Quantity::averages, averages_tally},
    {Quantity::noise_law, noise_law_tally},
    {Quantity::entry_law, entry_law_tally},
    {Quantity::laplace, laplace_tally},
    {Quantity::stick_duration_transform, stick_transform_tally},
    {Quantity::duration_density, duration_density_tally},
    {cases::kPhaseDurations.quantity, phase_durations_tally},
    {Quantity::slip, slip_tally},
    {Quantity::peak, peak_tally},
    {cases::kFirstPassageTime.quantity, first_passage_tally},
    {cases::kPassageTimeTransform.quantity, passage_transform_tally},
    {cases::kPassageTimeDistribution.quantity, passage_distribution_tally},
    {Quantity::spectrum, spectrum_tally},
    {Quantity::resolvent, resolvent_tally},
    {Quantity::autocorrelation, autocorrelation_tally},
    {Quantity::displacement, displacement_tally},
    {Quantity::expectation, expectation_tally},
    {cases::kDisplacementTransform.quantity, displacement_transform_tally},
    {cases::kDisplacementDistribution.quantity, displacement_distribution_tally}};

struct Single {
  double x;
};
struct Square {
  double x, xx;
};
struct OverTime {
  double slide, stick, x;
};

// By side; of cycles, which are the shorter the more often their start occurs.
std::vector<int> starts_of(const model::Process& process, Sampled sampled) {
  if (follows_paths(process)) return {kPathBegins};
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

std::vector<Tally::Range> cells_around(const std::vector<double>& at) {
  const std::set<double> sorted(at.begin(), at.end());
  std::vector<Tally::Range> cells;
  for (double t : at) {
    const auto place = sorted.find(t);
    const bool first = place == sorted.begin(), last = std::next(place) == sorted.end();
    const double alone = t != 0 ? 0.05 * std::abs(t) : 1;
    double below = first ? alone : (t - *std::prev(place)) / 2;
    double above = last ? alone : (*std::next(place) - t) / 2;
    if (first && !last) below = above;
    if (last && !first) above = below;
    cells.push_back({t - below, t + above});
    double& beyond = t < 0 ? cells.back().high : cells.back().low;
    beyond = t < 0 ? std::min(0.0, beyond) : std::max(0.0, beyond);
  }
  return cells;
}

Tally::Tally(const cases::Question& question, const model::Process& process)
    : question_(question), process_(process) {
  for (const auto& [quantity, follow] : kAll) {
    if (question.wants(quantity)) follow(*this);
  }
}

void Tally::mean(const cases::Row& row, const std::vector<double>& abscissa,
                 const std::function<double(const Excursion&, double)>& of) {
  std::vector<Sums<Single>> all;
  for (double s : abscissa) {
    all.push_back(sums([of, s](const Excursion& e) { return Single{of(e, s)}; }));
  }
  report([=, &row](const Tally&) -> Estimates {
    return {array(row, abscissa, [&](std::size_t n) {
      return all[n].estimate(all[n].overall(&Single::x), {&Single::x});
    })};
  });
}

void Tally::moments(const cases::Row& mean, const cases::Row& variance, const Number& of,
                    double parity) {
  const auto m = sums([of](const Excursion& e) {
    const double x = of(e);
    return Square{x, x * x};
  });
  report([=, &mean, &variance](const Tally& t) -> Estimates {
    const bool zero = parity < 0 && !t.process().drifts();
    const Smooth x = m.overall(&Square::x, parity);
    return {{&mean, {zero ? Estimate{} : m.estimate(x)}},
            {&variance, {m.estimate(m.overall(&Square::xx) - x * x)}}};
  });
}

void Tally::over_time(const cases::Row& row, const Number& of, double parity) {
  const auto m = sums([of](const Excursion& e) { return OverTime{e.slide, e.stick, of(e)}; });
  report([=, &row](const Tally&) -> Estimates {
    return {{&row, {m.over_time(m.overall(&OverTime::x, parity))}}};
  });
}

void Tally::distribution(const cases::Row& density, const cases::Row& distribution,
                         const std::vector<double>& at, const Number& of) {
  const auto cells = cells_around(at);
  auto ranges = cells;
  for (double t : at) ranges.push_back({0, t});
  report([=, &density, &distribution, of = shares(ranges, of)](const Tally&) -> Estimates {
    const auto average = [&](std::size_t n) { return of(n) / (cells[n].high - cells[n].low); };
    const auto below = [&](std::size_t n) { return of(cells.size() + n); };
    return {array(density, at, average), array(distribution, at, below)};
  });
}

Tally::Shares Tally::shares(const std::vector<Range>& ranges, const Number& of) {
  if (sampled() == Sampled::cycles) {
    // Excursions of a cycle depend on one another, so that counts alone have no intervals.
    std::vector<Sums<Single>> all;
    for (const auto& [low, high] : ranges) {
      all.push_back(sums([of, low = low, high = high](const Excursion& e) {
        const double x = of(e);
        return Single{low <= x && x < high ? 1.0 : 0.0};
      }));
    }
    return [all](std::size_t n) {
      return jeffreys(all[n], all[n].overall(&Single::x), 1, all[n].count());
    };
  }
  std::set<double> edges;
  for (const auto& [low, high] : ranges) {
    if (low > 0) edges.insert(low);
    if (std::isfinite(high)) edges.insert(high);
  }
  const Histogram& all = histogram({edges.begin(), edges.end()}, of);
  return [&all, ranges](std::size_t n) { return all.probability(ranges[n].low, ranges[n].high); };
}

const Histogram& Tally::histogram(std::vector<double> edges, const Number& of) {
  Histogram& all = histograms_.emplace_back(sampled() != Sampled::sides, std::move(edges));
  of_excursions_.emplace_back(
      [&all, of](std::size_t side, const Excursion& e) { all.add(side, e.turned, of(e)); });
  return all;
}

Sampled Tally::sampled() const {
  if (follows_paths(process_) || !process_.noise.neighbours_only()) return Sampled::cycles;
  return process_.symmetric() ? Sampled::one_side : Sampled::sides;
}

Sampled Tally::sampled_from(const model::Start& start) const {
  const bool stationary = start.kind == model::Start::Kind::stationary;
  return stationary || sampled() == Sampled::cycles ? sampled() : Sampled::one_side;
}

void Tally::follow(const model::Start& start,
                   std::function<void(const FollowedPath&, bool turned)> take) {
  const bool stationary = start.kind == model::Start::Kind::stationary;
  if (stationary) wanted_.stationary_paths = true;
  if (!stationary) wanted_.start = start;
  const bool cycles = sampled() == Sampled::cycles;
  of_paths_.emplace_back([=, take = std::move(take)](const FollowedPath& path) {
    if (path.stationary == stationary) take(path, path.turned || cycles);
  });
}

// Stationary paths have weights, and keep more numbers in fewer bins.
std::vector<const PathBins*> Tally::bins_along(const model::Start& start, bool both_signs,
                                               const std::function<double(double)>& of) {
  const auto& noise = process_.noise;
  const double step = start.kind == model::Start::Kind::stationary ? 0.01 : 0.002;
  wanted_.time = question_.time;
  std::vector<const PathBins*> all;
  for (std::size_t n = 0; n < question_.time.size(); ++n) {
    const double t = question_.time[n],
                 scale = noise.standard_deviation() * t * std::min(t, noise.correlation_time());
    PathBins& bins = bins_.emplace_back(sampled_from(start), both_signs, scale, step);
    all.push_back(&bins);
    follow(start, [&bins, of, n](const FollowedPath& path, bool turned) {
      bins.add(path.side, turned, path.weight, of(path.states[n].displacement));
    });
  }
  return all;
}

void Tally::add_cycle(const Excursion& cycle) {
  for (const auto& take : of_cycles_) take(cycle);
}

void Tally::add(std::size_t side, const Excursion& excursion) {
  counts_[0] += side == 0 && excursion.ends_cycle ? 1 : 0;
  counts_[1] += excursion.jumps;
  for (const auto& take : of_excursions_) take(side, excursion);
}

void Tally::add(const FollowedPath& path) {
  for (const auto& take : of_paths_) take(path);
}

Estimates Tally::estimates() const {
  Estimates all;
  for (const auto& report : reports_) std::ranges::move(report(*this), std::back_inserter(all));
  for (auto& estimated : all) {
    for (auto& [value, low, high] : estimated.values) {
      const double by_steps = process_.noise.gaussian ? kStepError * std::abs(value) : 0;
      low -= by_steps;
      high += by_steps;
    }
  }
  return all;
}

// All that is kept, row by row.
template <class Self, class Action>
void Tally::each_row(Self& tally, const Action& action) {
  action(std::span(tally.counts_));
  for (auto& sides : tally.comoments_) {
    for (auto& comoments : sides) action(comoments.numbers());
  }
  for (auto& histogram : tally.histograms_) action(histogram.counts());
  for (auto& bins : tally.bins_) action(bins.numbers());
}

void Tally::clear() {
  each_row(*this, [](std::span<double> row) { std::ranges::fill(row, 0.0); });
}

std::size_t Tally::size() const {
  std::size_t size = 0;
  each_row(*this, [&](auto row) { size += row.size(); });
  return size;
}

std::vector<double> Tally::pack() const {
  std::vector<double> numbers;
  numbers.reserve(size());
  each_row(*this, [&](auto row) { numbers.insert(numbers.end(), row.begin(), row.end()); });
  return numbers;
}

void Tally::merge(std::span<const double> packed) {
  if (packed.size() != size()) throw std::invalid_argument("a tally of other questions");
  const auto next = [&](std::size_t size) {
    return std::exchange(packed, packed.subspan(size)).first(size);
  };
  for (double& count : counts_) count += next(1)[0];
  for (auto& sides : comoments_) {
    for (auto& comoments : sides) comoments.merge(next(comoments.numbers().size()));
  }
  const auto add_to = [&](std::span<double> numbers) {
    std::ranges::transform(numbers, next(numbers.size()), numbers.begin(), std::plus<>());
  };
  for (auto& histogram : histograms_) add_to(histogram.counts());
  for (auto& bins : bins_) add_to(bins.numbers());
}

Sampler::Sampler(const cases::Question& question, const model::Process& process)
    : tally_(question, process),
      process_(process),
      sampled_(tally_.sampled()),
      starts_(starts_of(process, sampled_)),
      wanted_(tally_.wanted()),
      source_(make_source(process, wanted_)),
      order_(wanted_.time.size()),
      states_(wanted_.time.size()) {
  if (wanted_.start || wanted_.stationary_paths) walk_ = make_walk(process, wanted_.travel);
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  std::ranges::sort(order_, {}, [&](std::size_t n) { return wanted_.time[n]; });
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
