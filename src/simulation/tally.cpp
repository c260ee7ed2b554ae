#include "stickslip/simulation/tally.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <stdexcept>

#include "stickslip/catalogue/displacement_distribution_keys.hpp"
#include "stickslip/catalogue/displacement_transform_keys.hpp"
#include "stickslip/catalogue/first_passage_keys.hpp"
#include "stickslip/catalogue/passage_distribution_keys.hpp"
#include "stickslip/catalogue/phase_durations_keys.hpp"

namespace stickslip::simulation {

using catalogue::Quantity;
using Follow = void(Tally&);

Follow sticking_tally, moments_tally, averages_tally, noise_law_tally, entry_law_tally,
    laplace_tally, stick_transform_tally, duration_density_tally, phase_durations_tally, slip_tally,
    peak_tally, spectrum_tally, resolvent_tally, autocorrelation_tally, displacement_tally,
    expectation_tally, displacement_transform_tally, displacement_distribution_tally,
    first_passage_tally, passage_transform_tally, passage_distribution_tally;

namespace {

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
    {catalogue::kPhaseDurations.quantity, phase_durations_tally},
    {Quantity::slip, slip_tally},
    {Quantity::peak, peak_tally},
    {catalogue::kFirstPassageTime.quantity, first_passage_tally},
    {catalogue::kPassageTimeTransform.quantity, passage_transform_tally},
    {catalogue::kPassageTimeDistribution.quantity, passage_distribution_tally},
    {Quantity::spectrum, spectrum_tally},
    {Quantity::resolvent, resolvent_tally},
    {Quantity::autocorrelation, autocorrelation_tally},
    {Quantity::displacement, displacement_tally},
    {Quantity::expectation, expectation_tally},
    {catalogue::kDisplacementTransform.quantity, displacement_transform_tally},
    {catalogue::kDisplacementDistribution.quantity, displacement_distribution_tally}};

struct Single {
  double x;
};
struct Square {
  double x, xx;
};
struct OverTime {
  double slide, stick, x;
};

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

void Tally::mean(const catalogue::Row& row, const std::vector<double>& abscissa,
                 const std::function<double(const Excursion&, double)>& of) {
  std::vector<Sums<Single>> all;
  for (double s : abscissa) {
    all.push_back(sums([of, s](const Excursion& e) { return Single{of(e, s)}; }));
  }
  report([=, &row](const Tally&) -> Estimates {
    return {array(row, abscissa,
                  [&](std::size_t n) { return all[n].estimate(all[n].overall(&Single::x)); })};
  });
}

void Tally::moments(const catalogue::Row& mean, const catalogue::Row& variance, const Number& of,
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

void Tally::over_time(const catalogue::Row& row, const Number& of, double parity) {
  const auto m = sums([of](const Excursion& e) { return OverTime{e.slide, e.stick, of(e)}; });
  report([=, &row](const Tally&) -> Estimates {
    return {{&row, {m.over_time(m.overall(&OverTime::x, parity))}}};
  });
}

void Tally::distribution(const catalogue::Row& density, const catalogue::Row& distribution,
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
  if (!process_.noise.neighbours_only()) return Sampled::cycles;
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

}  // namespace stickslip::simulation
