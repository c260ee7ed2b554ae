#include "stickslip/simulation/tally.hpp"

#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <cmath>
#include <complex>
#include <stdexcept>

#include "stickslip/support/statistics.hpp"

namespace stickslip::simulation {
namespace {

// The last two of cycles only.
enum Total : std::size_t {
  slide,
  stick,
  square,
  path,
  product,
  within,
  noise_square,
  count,
  drift,
  totals
};

std::size_t totals_of(const Wanted& wanted) {
  const Total end = wanted.cycles ? Total::totals : Total::count;
  return end;
}

// D, T, D^2, D T, T^2 of spectrum_at_zero().
enum Displacement : std::size_t {
  moved,
  spent,
  moved_square,
  moved_spent,
  spent_square,
  displacements
};

// |C|^2, C, D, conj(C) D and T of spectrum().
enum Transform : std::size_t {
  power,
  real_c,
  imaginary_c,
  real_d,
  imaginary_d,
  real_cd,
  imaginary_cd,
  time,
  transforms
};

Estimate around(double value, double variance) {
  const double half = kNormalQuantile * std::sqrt(variance);
  return {value, value - half, value + half};
}

Estimate proportion(double successes, double trials) {
  using Binomial = boost::math::binomial_distribution<double>;
  constexpr auto kind = Binomial::jeffreys_prior_interval;
  constexpr double tail = 0.025;
  const double low =
      successes == 0 ? 0 : Binomial::find_lower_bound_on_p(trials, successes, tail, kind);
  const double high =
      successes == trials ? 1 : Binomial::find_upper_bound_on_p(trials, successes, tail, kind);
  return {successes / trials, low, high};
}

double duration_of(const Excursion& e, Duration duration) {
  switch (duration) {
  case Duration::slide: return e.slide;
  case Duration::stick: return e.stick;
  case Duration::excursion: break;
  }
  return e.slide + e.stick;
}

constexpr std::array kDurations{Duration::slide, Duration::stick, Duration::excursion};

}  // namespace

Tally::Tally(const Wanted& wanted, int k)
    : k_(k),
      wanted_(wanted),
      totals_(totals_of(wanted)),
      displacement_(wanted.cycles ? std::size_t{Displacement::displacements} : 0),
      laplace_(wanted.lambda.size(), Comoments(kDurations.size())),
      spectrum_(wanted.omega.size(), Comoments(Transform::transforms)),
      entries_(wanted.cycles ? 0 : 2 * static_cast<std::size_t>(k) + 1, 0.0) {
  for (auto& cells : cells_) cells.assign(wanted.edges.size() + 1, 0.0);
}

std::size_t Tally::place(int level) const {
  const int above = level + k_;
  return static_cast<std::size_t>(above);
}

void Tally::add(const Excursion& e) {
  const std::array<double, Total::totals> sample{
      e.slide, e.stick, e.square, e.path, e.product, e.within, e.noise_square, e.count, e.drift};
  totals_.add(std::span(sample).first(totals_.size()));
  if (wanted_.cycles) {
    const double t = e.slide + e.stick;
    displacement_.add(std::array{e.drift, t, e.drift * e.drift, e.drift * t, t * t});
  } else {
    entries_[place(e.entry)] += 1;
  }
  jumps_ += e.jumps;
  for (std::size_t n = 0; n < laplace_.size(); ++n) {
    const double f = std::exp(-wanted_.lambda[n] * e.slide),
                 s = std::exp(-wanted_.lambda[n] * e.stick);
    laplace_[n].add(std::array{f, s, f * s});
  }
  if (!wanted_.edges.empty()) count_cells(e);
  if (!spectrum_.empty()) add_transforms(e);
}

void Tally::count_cells(const Excursion& e) {
  for (std::size_t n = 0; n < kDurations.size(); ++n) {
    const auto above =
        std::upper_bound(wanted_.edges.begin(), wanted_.edges.end(), duration_of(e, kDurations[n]));
    cells_[n][static_cast<std::size_t>(above - wanted_.edges.begin())] += 1;
  }
}

void Tally::add_transforms(const Excursion& e) {
  const double duration = e.slide + e.stick, sign = e.turned ? -1 : 1;
  for (std::size_t n = 0; n < spectrum_.size(); ++n) {
    const auto c = e.transform[n];
    const auto d = sign * std::polar(1.0, -wanted_.omega[n] * duration);
    const auto cd = std::conj(c) * d;
    spectrum_[n].add(std::array<double, Transform::transforms>{
        std::norm(c), c.real(), c.imag(), d.real(), d.imag(), cd.real(), cd.imag(), duration});
  }
}

void Tally::merge(const Tally& other) {
  totals_.merge(other.totals_);
  displacement_.merge(other.displacement_);
  jumps_ += other.jumps_;
  for (std::size_t n = 0; n < laplace_.size(); ++n) laplace_[n].merge(other.laplace_[n]);
  for (std::size_t n = 0; n < spectrum_.size(); ++n) spectrum_[n].merge(other.spectrum_[n]);
  for (std::size_t n = 0; n < entries_.size(); ++n) entries_[n] += other.entries_[n];
  for (std::size_t d = 0; d < cells_.size(); ++d) {
    for (std::size_t n = 0; n < cells_[d].size(); ++n) cells_[d][n] += other.cells_[d][n];
  }
}

Estimate Tally::ratio(std::size_t total) const {
  const double mean_time = totals_.mean(slide) + totals_.mean(stick);
  const double value = totals_.mean(total) / mean_time;
  std::array<double, Total::totals> weight{};
  weight[slide] -= value;
  weight[stick] -= value;
  weight[total] += 1;
  return around(value, totals_.variance_of_mean(weight) / (mean_time * mean_time));
}

Estimate Tally::sliding() const {
  const double s = totals_.mean(slide), r = totals_.mean(stick), all = s + r;
  // The gradient of s/(s + r), without a difference of nearly equal numbers.
  std::array<double, Total::totals> weight{};
  weight[slide] = r / (all * all);
  weight[stick] = -s / (all * all);
  return around(s / all, totals_.variance_of_mean(weight));
}

Estimate Tally::sticking() const {
  const Estimate other = sliding();
  const double value = totals_.mean(stick) / (totals_.mean(slide) + totals_.mean(stick));
  return {value, value - (other.high - other.value), value + (other.value - other.low)};
}

Estimate Tally::mean(Duration duration) const {
  std::array<double, Total::totals> weight{};
  weight[slide] = duration == Duration::stick ? 0 : 1;
  weight[stick] = duration == Duration::slide ? 0 : 1;
  const double sum = weight[slide] * totals_.mean(slide) + weight[stick] * totals_.mean(stick);
  if (!wanted_.cycles) return around(sum, totals_.variance_of_mean(weight));
  const double number = totals_.mean(count), value = sum / number;
  weight[count] = -value;
  return around(value, totals_.variance_of_mean(weight) / (number * number));
}

Estimate Tally::mean_square() const { return ratio(square); }
Estimate Tally::mean_speed() const { return ratio(path); }
Estimate Tally::mean_product() const { return ratio(product); }
Estimate Tally::mean_velocity() const { return ratio(drift); }
Estimate Tally::within() const { return ratio(Total::within); }
Estimate Tally::noise_square() const { return ratio(Total::noise_square); }

// With D the displacement and T the duration of a cycle and m = E[D]/E[T], the spread of a long
// path about its drift grows at the rate S_v(0) = E[(D - m T)^2]/E[T]. The interval is that of the
// delta method.
Estimate Tally::spectrum_at_zero() const {
  const Comoments& d = displacement_;
  const double mean_time = d.mean(spent), m = d.mean(moved) / mean_time;
  const double spread =
      d.mean(moved_square) - 2 * m * d.mean(moved_spent) + m * m * d.mean(spent_square);
  const double value = spread / mean_time;
  const double by_m = 2 * (m * d.mean(spent_square) - d.mean(moved_spent)) / mean_time;
  const std::array<double, Displacement::displacements> weight{by_m, -value - m * by_m, 1, -2 * m,
                                                               m * m};
  return around(value, d.variance_of_mean(weight) / (mean_time * mean_time));
}

Estimate Tally::entry(int i) const { return proportion(entries_[place(i)], samples()); }

Estimate Tally::entry_of_both(int i, int j, double factor) const {
  double count = entries_[place(i)];
  if (j != i) count += entries_[place(j)];
  // k = 0: one level, left by both ways.
  const double times = i == j ? 2 * factor : factor;
  const Estimate p = proportion(count, samples());
  return {times * p.value, times * p.low, times * p.high};
}

Estimate Tally::laplace(std::size_t n, Duration duration) const {
  std::array<double, kDurations.size()> weight{};
  const auto which = static_cast<std::size_t>(duration);
  weight[which] = 1;
  return around(laplace_[n].mean(which), laplace_[n].variance_of_mean(weight));
}

Estimate Tally::probability(Duration duration, double low, double high) const {
  const auto& cells = cells_[static_cast<std::size_t>(duration)];
  const auto cell_from = [&](double edge) {
    return std::lower_bound(wanted_.edges.begin(), wanted_.edges.end(), edge) -
           wanted_.edges.begin() + 1;
  };
  const auto first = low > 0 ? cells.begin() + cell_from(low) : cells.begin();
  const auto last = std::isfinite(high) ? cells.begin() + cell_from(high) : cells.end();
  double count = 0;
  for (auto cell = first; cell < last; ++cell) count += *cell;
  return proportion(count, samples());
}

// A path is a sequence of independent excursions r = 0, 1, ... with signs. Let C_r be the transform
// of v over one of them, T_r its duration, and D_r = +-exp(-i omega T_r) with the sign by which the
// next one differs. Then the transform of the path is sum_r C_r prod_{q<r} D_q, and
//
//   S_v = (E|C|^2 + 2 Re(E[conj(C) D] E[C]/(1 - E[D])))/E[T]
//
// without any window. The interval is that of the delta method.
Estimate Tally::spectrum(std::size_t n) const {
  using Complex = std::complex<double>;
  const Comoments& s = spectrum_[n];
  const Complex c(s.mean(real_c), s.mean(imaginary_c)), d(s.mean(real_d), s.mean(imaginary_d)),
      cd(s.mean(real_cd), s.mean(imaginary_cd));
  const Complex rest = 1.0 - d, by_c = cd / rest, by_cd = c / rest, by_d = cd * c / (rest * rest);
  const double mean_time = s.mean(time);
  const double value = (s.mean(power) + 2 * (cd * by_cd).real()) / mean_time;
  std::array<double, Transform::transforms> weight{};
  weight[power] = 1;
  const auto set = [&](std::size_t real, const Complex& slope) {
    weight[real] = 2 * slope.real();
    weight[real + 1] = -2 * slope.imag();
  };
  set(real_c, by_c);
  set(real_d, by_d);
  set(real_cd, by_cd);
  weight[time] = -value;
  return around(value, s.variance_of_mean(weight) / (mean_time * mean_time));
}

std::vector<double> Tally::pack() const {
  std::vector<double> numbers{jumps_};
  totals_.pack(numbers);
  displacement_.pack(numbers);
  for (const auto* group : {&laplace_, &spectrum_}) {
    for (const auto& comoments : *group) comoments.pack(numbers);
  }
  numbers.insert(numbers.end(), entries_.begin(), entries_.end());
  for (const auto& cells : cells_) numbers.insert(numbers.end(), cells.begin(), cells.end());
  return numbers;
}

std::size_t Tally::packed_size() const {
  std::size_t size = 1 + totals_.packed_size() + displacement_.packed_size() + entries_.size();
  for (const auto* group : {&laplace_, &spectrum_}) {
    for (const auto& comoments : *group) size += comoments.packed_size();
  }
  for (const auto& cells : cells_) size += cells.size();
  return size;
}

void Tally::unpack(std::span<const double> numbers) {
  if (numbers.size() != packed_size()) throw std::invalid_argument("a tally of other questions");
  jumps_ = numbers[0];
  numbers = numbers.subspan(1);
  totals_.unpack(numbers);
  displacement_.unpack(numbers);
  for (auto* group : {&laplace_, &spectrum_}) {
    for (auto& comoments : *group) comoments.unpack(numbers);
  }
  const auto take = [&](std::vector<double>& part) {
    std::copy_n(numbers.begin(), part.size(), part.begin());
    numbers = numbers.subspan(part.size());
  };
  take(entries_);
  for (auto& cells : cells_) take(cells);
}

Tally simulate_batch(ExcursionSource& source, const Wanted& wanted, int k, std::uint64_t seed,
                     std::uint64_t batch, int count) {
  RandomStream random(seed, batch);
  Tally tally(wanted, k);
  Excursion excursion;
  for (int n = 0; n < count; ++n) {
    source.draw(random, excursion);
    tally.add(excursion);
  }
  return tally;
}

}  // namespace stickslip::simulation
