#include "stickslip/model/noise_chain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdlib>
#include <limits>

#include "stickslip/base/text.hpp"
#include "transitions.hpp"

namespace stickslip::model {
namespace {

// Quotients such as 2/(tau delta^2) carry up to three roundings of half a unit each, and their
// operands one each from decimal notation; eight units cover both, and stay far below the 1e-12
// at which two different thresholds must be distinguished.
constexpr double kRounding = 8 * std::numeric_limits<double>::epsilon();

void require_rate(double rate, bool at_end, std::size_t row, const char* name) {
  if (at_end ? rate == 0 : rate > 0 && std::isfinite(rate)) return;
  throw UnfitTable(row, at_end ? fmt::format("{} = {:g} leads to no level; it must be 0 at the end "
                                             "of the levels",
                                             name, rate)
                               : fmt::format("{} = {:g} must be positive: every level must be "
                                             "reached from every other one",
                                             name, rate));
}

void require_chain(const std::vector<Level>& levels) {
  if (levels.size() < 2) throw UnfitTable(0, "there must be at least two levels");
  for (std::size_t n = 0; n < levels.size(); ++n) {
    const auto& [x, up, down] = levels[n];
    if (!std::isfinite(x)) throw UnfitTable(n, fmt::format("x = {:g} must be a number", x));
    if (n > 0 && x <= levels[n - 1].x) {
      throw UnfitTable(
          n, fmt::format("x = {:g} must be above the level before, {:g}", x, levels[n - 1].x));
    }
    require_rate(up, n + 1 == levels.size(), n, "rate_up");
    require_rate(down, n == 0, n, "rate_down");
  }
}

int places_below_zero(const std::vector<Level>& levels) {
  const auto nearest = std::min_element(levels.begin(), levels.end(), [](auto& a, auto& b) {
    return std::abs(a.x) < std::abs(b.x) || (std::abs(a.x) == std::abs(b.x) && a.x > b.x);
  });
  return static_cast<int>(nearest - levels.begin());
}

// Probabilities up to a factor, the largest 1, from the logarithms of their ratios: neither
// overflows.
std::vector<double> weights(const std::vector<Level>& levels) {
  std::vector<double> w{0};
  for (std::size_t n = 1; n < levels.size(); ++n) {
    w.push_back(w.back() + std::log(levels[n - 1].up / levels[n].down));
  }
  const double largest = *std::max_element(w.begin(), w.end());
  for (double& value : w) value = std::exp(value - largest);
  return w;
}

// The first level above x, or also one that equals it; highest + 1 if there is none.
int first_beyond(const LevelTable& table, double x, bool above) {
  int low = table.lowest(), high = table.highest() + 1;
  while (low < high) {
    const int middle = low + (high - low) / 2;
    const double difference = snapped_difference(table.at(middle).x, x);
    if (difference < 0 || (above && difference == 0)) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}

// int_0^infinity Cov(X_0, X_t) dt of the chain of steps as it ends: an edge passes on S_i = sum_(j
// <= i) pi_j x_j, as LevelTable has it, and both halves are alike.
double intensity(const NoiseChain& chain) {
  const auto p = stationary_distribution(chain);
  double below = 0, sum = 0;
  for (int i = chain.lowest(); i < 0; ++i) {
    const double weight = p[i - chain.lowest()], flow = weight * chain.up_rate(i);
    below += weight * chain.level(i);
    if (flow > 0) sum += below * (below / flow);
  }
  return 2 * sum;
}

}  // namespace

int floor_index(double ratio) {
  const double nearest = std::round(ratio);
  const bool is_integer = std::abs(ratio - nearest) <= kRounding * std::max(1.0, std::abs(ratio));
  const double index = is_integer ? nearest : std::floor(ratio);
  if (!(std::abs(index) < std::numeric_limits<int>::max())) {
    throw std::out_of_range("grid index does not fit an integer");
  }
  return static_cast<int>(index);
}

double snapped_difference(double a, double b) {
  const double difference = a - b;
  return std::abs(difference) <= kRounding * std::max(std::abs(a), std::abs(b)) ? 0.0 : difference;
}

LevelTable::LevelTable(std::vector<Level> levels) : levels_(std::move(levels)) {
  require_chain(levels_);
  for (std::size_t n = 0; n < levels_.size(); ++n) {
    const auto &here = levels_[n], &other = levels_[levels_.size() - 1 - n];
    even_ = even_ && here.x == -other.x && here.up == other.down;
  }
  find_moments();
  find_tails();
}

LevelTable::LevelTable(const std::vector<double>& given,
                       const std::vector<Transition>& transitions) {
  require_states(given, transitions);
  const auto x = without_rounding(given);
  const auto order = mirrored_order(x, transitions);
  order_ = order.states;
  std::vector<int> place(x.size());
  bool near = true;
  for (std::size_t n = 0; n < x.size(); ++n) {
    place[order_[n]] = static_cast<int>(n);
    levels_.push_back({x[order_[n]], 0, 0});
    near = near && (n == 0 || levels_[n - 1].x < levels_[n].x);
    even_ = even_ && levels_[n].x == -x[order_[x.size() - 1 - n]];
  }
  jumps_.resize(x.size());
  for (const auto& [from, to, rate] : transitions) {
    const int here = place[from], there = place[to];
    near = near && std::abs(there - here) == 1;
    jumps_[here].push_back({there, rate});
    (there > here ? levels_[here].up : levels_[here].down) += rate;
  }
  for (auto& row : jumps_) {
    std::sort(row.begin(), row.end(), [](const Jump& a, const Jump& b) { return a.to < b.to; });
  }
  even_ = even_ && mirrors_itself(jumps_, order.image);
  reversed_ = order.reversed();
  if (near) jumps_.clear();
  find_moments();
  find_tails();
}

std::shared_ptr<const LevelTable> Projector::projected(const Thresholds& thresholds,
                                                       int order) const {
  auto& known = made_[{thresholds, order}];
  if (!known) {
    known = std::make_shared<const LevelTable>(LevelTable::of(projection(thresholds, order)));
  }
  return known;
}

LevelTable LevelTable::of(const Projection& projection) {
  LevelTable table;
  table.jumps_.resize(projection.x.size());
  table.probability_ = projection.probability;
  table.peak_intensity_ = projection.peak_intensity;
  table.variance_ = projection.deviation * projection.deviation;
  table.intensity_ = projection.intensity;
  table.rate_ = projection.rate;
  table.step_ = projection.step;
  table.even_ = projection.even;
  table.reversed_ = projection.reversed;
  table.projected_ = true;
  table.continuous_ = projection.continuous;
  for (auto [part, of] : {std::pair{&table.shown_, &projection.shown},
                          {&table.by_position_, &projection.by_position}}) {
    if (!of->x.empty()) *part = std::make_shared<const Shown>(*of);
  }
  table.means_ = projection.means;
  table.position_ = projection.position;
  table.noise_ = projection.noise;
  table.centre_ = projection.centre;
  table.value_at_ = projection.value_at;
  if (table.has_positions()) {
    for (auto [part, of] : {std::pair{&table.upwards_, &projection.upwards},
                            {&table.downwards_, &projection.downwards}}) {
      part->resize(projection.x.size());
      for (const auto& [from, to, rate] : *of) {
        (*part)[from].push_back({static_cast<int>(to), rate});
      }
    }
  }
  for (double x : projection.x) table.levels_.push_back({x, 0, 0});
  for (const auto& [from, to, rate] : projection.transitions) {
    table.jumps_[from].push_back({static_cast<int>(to), rate});
    (to > from ? table.levels_[from].up : table.levels_[from].down) += rate;
  }
  const auto& p = table.probability_;
  table.lowest_ = -places_below_zero(table.levels_);
  table.mode_ = table.lowest_ + static_cast<int>(std::ranges::max_element(p) - p.begin());
  table.upper_tail_ = table.lower_tail_ = std::max(table.intensity_, table.peak_intensity_);
  return table;
}

void LevelTable::find_moments() {
  lowest_ = -places_below_zero(levels_);
  step_ = kInfinity;
  if (!neighbours_only()) probability_ = stationary(jumps_);
  const auto w = neighbours_only() ? weights(levels_) : probability_;
  mode_ = lowest_ + static_cast<int>(std::max_element(w.begin(), w.end()) - w.begin());
  double total = 0;
  for (std::size_t n = 0; n < w.size(); ++n) {
    total += w[n];
    mean_ += w[n] * levels_[n].x;
  }
  mean_ = even_ && !neighbours_only() ? 0 : mean_ / total;
  std::vector<double> part, f;
  for (std::size_t n = 0; n < w.size(); ++n) {
    f.push_back(levels_[n].x - mean_);
    part.push_back(w[n] * f[n] / total);
    rate_ = std::max(rate_, levels_[n].up + levels_[n].down);
    variance_ += part[n] * f[n];
    const double step = n > 0 ? levels_[n].x - levels_[n - 1].x : 0;
    if (step > 0) step_ = std::min(step_, step);
  }
  if (neighbours_only()) {
    add_edges(w, part, total);
  } else {
    intensity_ = model::intensity(jumps_, probability_, f);
    peak_intensity_ = model::peak_intensity(jumps_, probability_, f);
  }
  if (!std::isnormal(std::max(intensity_, peak_intensity_)) || !std::isnormal(variance_)) {
    throw UnfitTable(levels_.size(), "the rates lead to probabilities beyond double precision");
  }
}

// With S_i = sum_(j <= i) pi_j (x_j - m), the intensity is sum_i S_i^2/(pi_i up_i): an edge passes
// on all that lies below it. Summed from the end where all terms have one sign.
void LevelTable::add_edges(const std::vector<double>& w, const std::vector<double>& part,
                           double total) {
  const auto add_edge = [&](double sum, double flow) {
    if (flow > 0) intensity_ += sum * sum * total / flow;
  };
  double below = 0, above = 0;
  for (std::size_t n = 0; n + 1 < w.size(); ++n) {
    if (levels_[n].x < mean_) add_edge(below += part[n], w[n] * levels_[n].up);
  }
  for (std::size_t n = w.size() - 1; n > 0 && levels_[n - 1].x >= mean_; --n) {
    add_edge(above += part[n], w[n] * levels_[n].down);
  }
}

void LevelTable::find_tails() {
  if (!neighbours_only()) {
    decays_ = find_decays();
    lower_decays_ = even_ ? decays_ : mirrored().find_decays();
  }
  const auto all_forces = [](const LevelTable& table) {
    const double top = table.levels_.back().x - table.mean_;
    return table.tail_intensity(0.05 * top, 0.95 * top);
  };
  upper_tail_ = all_forces(*this);
  lower_tail_ = even_ ? upper_tail_ : all_forces(mirrored());
}

std::vector<LevelTable::Decay> LevelTable::find_decays() const {
  constexpr int forces = 12;
  const double top = levels_.back().x - mean_;
  std::vector<Decay> all;
  for (int n = 0; n < forces; ++n) {
    // In even ratios, as pulses are much larger than what they overcome.
    const double force = 0.95 * top * std::pow(0.02, 1 - n / (forces - 1.0));
    std::vector<double> f;
    for (const auto& level : levels_) f.push_back(level.x - mean_ - force);
    all.push_back({force, decay(jumps_, f, force / std::max(intensity_, peak_intensity_))});
  }
  return all;
}

// Whether theta (X - m - f) + Q has negative eigenvalues alone: the pivots of its negative are
// positive.
bool LevelTable::decays(double theta, double force) const {
  double pivot = 1, above = 0;  // of the level before, and its rate upwards
  for (const auto& [x, up, down] : levels_) {
    pivot = up + down - theta * (x - mean_ - force) - above * down / pivot;
    if (!(pivot > 0)) return false;
    above = up;
  }
  return true;
}

double LevelTable::tail_intensity(double least, double most) const {
  const double top = levels_.back().x - mean_;
  constexpr int forces = 20, halvings = 12;
  double largest = std::max(intensity_, peak_intensity_);
  for (const auto& [force, theta] : decays_) {
    // With those next to the range.
    constexpr double next = 1.5;
    if (next * force >= least && force <= next * most) largest = std::max(largest, force / theta);
  }
  if (!neighbours_only()) return largest;
  for (int n = 1; n < forces; ++n) {
    // In even ratios, as pulses are much larger than what they overcome.
    const double share = static_cast<double>(n - 1) / (forces - 2),
                 force = least > 0 ? least * std::pow(most / least, share) : share * most;
    if (!(force > 0) || force >= top) continue;
    double low = force / intensity_, high = low;
    while (!decays(low, force) && low > 1e-6 * high) low /= 2;
    while (decays(high, force)) high *= 2;
    for (int k = 0; k < halvings; ++k) {
      const double middle = (low + high) / 2;
      (decays(middle, force) ? low : high) = middle;
    }
    largest = std::max(largest, force / low);
  }
  return largest;
}

LevelTable LevelTable::within(int low, int high) const {
  if (!neighbours_only()) return *this;
  low = std::max(low, lowest());
  high = std::min(high, highest());
  LevelTable part = *this;
  part.lowest_ = low;
  part.levels_.assign(levels_.begin() + (low - lowest_), levels_.begin() + (high - lowest_ + 1));
  part.levels_.front().down = part.levels_.back().up = 0;
  if (!order_.empty()) {
    part.order_.assign(order_.begin() + (low - lowest_), order_.begin() + (high - lowest_ + 1));
  }
  return part;
}

LevelTable LevelTable::mirrored() const {
  LevelTable other = *this;
  for (std::size_t n = 0; n < levels_.size(); ++n) {
    const auto& [x, up, down] = levels_[levels_.size() - 1 - n];
    other.levels_[n] = {-x, down, up};
  }
  const int last = static_cast<int>(levels_.size()) - 1;
  for (auto* jumps : {&other.jumps_, &other.upwards_, &other.downwards_}) {
    std::reverse(jumps->begin(), jumps->end());
    for (auto& row : *jumps) {
      std::reverse(row.begin(), row.end());
      for (auto& jump : row) jump.to = last - jump.to;
    }
  }
  std::swap(other.upwards_, other.downwards_);
  for (auto* values : {&other.position_, &other.noise_}) {
    std::reverse(values->begin(), values->end());
    for (double& value : *values) value = -value;
  }
  if (means_) {
    other.means_ = [means = means_](const FunctionOfNoise& f) {
      auto all = means([&f](const Place& place) { return f(-place); });
      std::reverse(all.begin(), all.end());
      return all;
    };
  }
  std::reverse(other.probability_.begin(), other.probability_.end());
  std::reverse(other.order_.begin(), other.order_.end());
  std::swap(other.decays_, other.lower_decays_);
  other.lowest_ = -highest();
  other.mode_ = -mode_;
  other.mean_ = -mean_;
  other.centre_ = -centre_;
  other.value_at_ = {};  // starts are looked up in the noise as it is given
  std::swap(other.upper_tail_, other.lower_tail_);
  return other;
}

double NoiseChain::up(int i) const {
  if (table) return table->at(i).up / rate(i);
  if (i >= levels) return 0;
  if (i <= -levels) return 1;
  return std::clamp((1 - precision() * delta * level(i) / 2) / 2, 0.0, 1.0);
}

double NoiseChain::down(int i) const { return table ? table->at(i).down / rate(i) : up(-i); }

double NoiseChain::up_change(int i) const {
  return deviation || std::abs(i) >= levels ? 0 : -delta * level(i) / 4;
}

double NoiseChain::standard_deviation() const {
  return table ? std::sqrt(table->variance()) : deviation.value_or(1 / std::sqrt(tau));
}

double NoiseChain::intensity() const {
  if (table) return table->intensity();
  return deviation ? *deviation * *deviation * tau : 1;
}

double NoiseChain::correlation_time() const {
  return table ? table->intensity() / table->variance() : tau;
}

int NoiseChain::last_up_to(double x) const {
  if (table) return first_beyond(*table, x, true) - 1;
  return floor_index(std::clamp<double>(x / delta, -levels - 1.0, levels));
}

int NoiseChain::first_from(double x) const {
  if (table) return first_beyond(*table, x, false);
  return -floor_index(std::clamp<double>(-x / delta, -levels - 1.0, levels));
}

std::optional<int> NoiseChain::find(double x) const {
  // A level far outside the chain need not fit an integer.
  const int i = last_up_to(std::clamp(x, level(lowest()), level(highest())));
  constexpr double rounding = 1e-9;  // of what people write
  for (int near : {i, i + 1}) {
    if (near < lowest() || near > highest()) continue;
    if (std::abs(level(near) - x) <= rounding * std::max(step(), std::abs(x))) return near;
  }
  return std::nullopt;
}

double NoiseChain::place(double x) const {
  if (!table) return x / delta;
  // Several levels at an end may have its force.
  int below = std::clamp(last_up_to(x), lowest(), highest() - 1), above = below + 1;
  while (level(below) == level(above) && below > lowest()) --below;
  while (level(below) == level(above) && above < highest()) ++above;
  const double rise = level(above) - level(below);
  return rise > 0 ? below + (x - level(below)) / rise * (above - below) : below;
}

std::vector<double> NoiseChain::values(const FunctionOfNoise& f, bool averaged) const {
  if (averaged && has_means()) return table->means()(f);
  std::vector<double> values;
  for (int i = lowest(); i <= highest(); ++i) values.push_back(f(place_of(i)));
  return values;
}

NoiseChain NoiseChain::mirrored() const {
  NoiseChain other = *this;
  if (table) other.table = std::make_shared<const LevelTable>(table->mirrored());
  return other;
}

int full_range(double tau, double delta, std::optional<double> deviation) {
  const double inverse = deviation ? 1 / (*deviation * *deviation) : tau;
  return floor_index(2 / (inverse * delta * delta));
}

double weight_ratio(const NoiseChain& chain, int i) {
  return chain.table ? chain.table->weight_ratio(i) : chain.up(i - 1) / chain.down(i);
}

std::vector<double> stationary_distribution(const NoiseChain& chain) {
  const int mode = chain.table ? chain.table->mode() : 0, low = chain.lowest();
  std::vector<double> p(static_cast<std::size_t>(chain.count()));
  p[mode - low] = 1;
  for (int i = mode + 1; i <= chain.highest(); ++i) {
    p[i - low] = p[i - 1 - low] * weight_ratio(chain, i);
  }
  for (int i = mode; i > low; --i) p[i - 1 - low] = p[i - low] / weight_ratio(chain, i);
  double above = 0, below = 0;  // from the small tail weights to the large central one
  for (int i = chain.highest(); i > mode; --i) above += p[i - low];
  for (int i = low; i < mode; ++i) below += p[i - low];
  const double total = above + below + p[mode - low];
  for (double& value : p) value /= total;
  return p;
}

double rounding_of_sums(const NoiseChain& chain) {
  return std::numeric_limits<double>::epsilon() * (4 + std::sqrt(chain.count() / 2));
}

NoiseMoments noise_moments(const NoiseChain& chain, int low, int high) {
  const int mode = chain.table ? chain.table->mode() : 0;
  double within = 0, beyond = 0, square = 0;
  const auto add = [&](int i, double weight) {
    (low <= i && i <= high ? within : beyond) += weight;
    square += weight * chain.level(i) * chain.level(i);
  };
  add(mode, 1);
  double weight = 1;
  for (int i = mode + 1; i <= chain.highest() && weight > 0; ++i) {
    add(i, weight *= weight_ratio(chain, i));
  }
  weight = 1;
  for (int i = mode; i > chain.lowest() && weight > 0; --i) {
    add(i - 1, weight /= weight_ratio(chain, i));
  }
  const double total = within + beyond;
  return {within / total, beyond / total, square / total};
}

double power_spectral_density(const NoiseChain& chain, double omega) {
  // Where i omega - Q is singular, the integral over all times.
  if (omega == 0) return 2 * (chain.table ? chain.intensity() : intensity(chain));
  const int lowest = chain.lowest(), count = chain.count();
  const auto p = stationary_distribution(chain);
  int band = 0;
  for (int n = 0; n < count; ++n) {
    chain.for_each_jump(lowest + n,
                        [&](int to, double) { band = std::max(band, std::abs(to - lowest - n)); });
  }
  using Complex = std::complex<double>;
  const int width = 2 * band + 1;
  std::vector<Complex> a(static_cast<std::size_t>(count) * static_cast<std::size_t>(width)), phi;
  const auto entry = [&](int row, int column) -> Complex& {
    return a[static_cast<std::size_t>(row) * width + static_cast<std::size_t>(column - row + band)];
  };
  double mean = 0;
  for (int n = 0; n < count; ++n) mean += p[n] * chain.level(lowest + n);
  for (int n = 0; n < count; ++n) {
    entry(n, n) = Complex(0, omega);
    chain.for_each_jump(lowest + n, [&](int to, double rate) {
      entry(n, to - lowest) -= rate;
      entry(n, n) += rate;
    });
    phi.emplace_back(chain.level(lowest + n) - mean);
  }
  const auto f = phi;
  // Rows are diagonally dominant, so that no pivot has to be looked for.
  for (int i = 0; i < count; ++i) {
    const int last = std::min(i + band, count - 1);
    for (int j = i + 1; j <= last; ++j) {
      const Complex factor = entry(j, i) / entry(i, i);
      if (factor == Complex(0)) continue;
      for (int k = i + 1; k <= last; ++k) entry(j, k) -= factor * entry(i, k);
      phi[j] -= factor * phi[i];
    }
  }
  Complex sum = 0;
  for (int i = count - 1; i >= 0; --i) {
    for (int k = i + 1; k <= std::min(i + band, count - 1); ++k) phi[i] -= entry(i, k) * phi[k];
    phi[i] /= entry(i, i);
    sum += p[i] * f[i] * phi[i];
  }
  return 2 * sum.real();
}

}  // namespace stickslip::model
