#include "stickslip/simulation/tally.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <stdexcept>

namespace stickslip::simulation {
namespace {

// What the groups hold, after 1{turned}.
enum Total : std::size_t {
  slide = 1,
  stick,
  square_of_slide,
  square_of_stick,
  square_of_excursion,
  square,
  path,
  product,
  within_threshold,
  square_of_noise,
  drift,
  size_of_totals
};
// D, T and products of them, and what of them belongs to excursions that turn.
enum Displacement : std::size_t { d = 1, t, dd, dt, tt, d_turned, t_turned, size_of_displacements };
enum Laplace : std::size_t { of_slide = 1, of_stick, of_excursion, size_of_laplaces };
// Of complex numbers the real and the imaginary part in a row.
enum Transform : std::size_t {
  power = 1,
  c = 2,
  same = 4,
  other = 6,
  c_same = 8,
  c_other = 10,
  time = 12,
  size_of_transforms
};
enum Observed : std::size_t { f_slide = 3, f_stick, size_of_observed };  // after slide, stick
enum Discount : std::size_t { h_same = 1, h_other, w_one, w_f, w_mirrored, size_of_discounts };
enum Expected : std::size_t { weight = 1, weighted, size_of_expected };
enum Lagged : std::size_t { duration_of_lagged = 1, v_start, v_end, v_v, size_of_lagged };

std::array<double, 3> durations(const Excursion& e) {
  return {e.slide, e.stick, e.slide + e.stick};
}

}  // namespace

Tally::Tally(const model::Process& process, const Wanted& wanted)
    : lowest_(process.lowest_static()), wanted_(wanted), symmetric_(process.symmetric()) {
  const auto group = [&](Group which, std::size_t count, std::size_t size, std::size_t sides) {
    groups_[which].assign(count, Sides(sides, Comoments(size)));
  };
  const std::size_t sides = symmetric_ ? 1 : 2, functions = wanted.observables.size();
  const bool chosen = wanted.start && wanted.start->kind != model::Start::Kind::stationary;
  group(totals, 1, size_of_totals, sides);
  group(displacement, wanted.displacement ? 1 : 0, size_of_displacements, sides);
  group(laplaces, wanted.lambda.size(), size_of_laplaces, sides);
  group(spectra, wanted.omega.size(), size_of_transforms, sides);
  group(observed, functions, size_of_observed, sides);
  group(discounted, functions * wanted.discount.size(), size_of_discounts, sides);
  group(expected, wanted.start ? functions * wanted.time.size() : 0, size_of_expected,
        chosen ? 1 : sides);
  group(lagged, wanted.autocorrelation ? wanted.time.size() : 0, size_of_lagged, sides);
  const auto levels = static_cast<std::size_t>(process.static_index() - lowest_ + 1);
  histograms_.emplace_back(symmetric_, levels);
  histograms_.resize(wanted.edges.empty() ? 1 : 4, Histogram(symmetric_, wanted.edges.size() + 1));
}

std::size_t Tally::bin(int level) const {
  const int above = level - lowest_;
  return static_cast<std::size_t>(above);
}

void Tally::add(std::size_t side, const Excursion& e) {
  const double turned = e.turned ? 1 : 0, whole = e.slide + e.stick;
  groups_[totals][0][side].add(std::array{turned, e.slide, e.stick, e.slide * e.slide,
                                          e.stick * e.stick, whole * whole, e.square, e.path,
                                          e.product, e.within, e.noise_square, e.drift});
  jumps_ += e.jumps;
  for (auto& sides : groups_[displacement]) {
    sides[side].add(std::array{turned, e.drift, whole, e.drift * e.drift, e.drift * whole,
                               whole * whole, turned * e.drift, turned * whole});
  }
  for (std::size_t n = 0; n < wanted_.lambda.size(); ++n) {
    const double f = std::exp(-wanted_.lambda[n] * e.slide),
                 s = std::exp(-wanted_.lambda[n] * e.stick);
    groups_[laplaces][n][side].add(std::array{turned, f, s, f * s});
  }
  add_transforms(side, e);
  add_integrals(side, e);
  histograms_[0].add(side, e.turned, bin(e.entry));
  const auto& edges = wanted_.edges;
  for (std::size_t n = 1; n < histograms_.size(); ++n) {
    const auto above = std::upper_bound(edges.begin(), edges.end(), durations(e)[n - 1]);
    histograms_[n].add(side, e.turned, static_cast<std::size_t>(above - edges.begin()));
  }
}

void Tally::add_transforms(std::size_t side, const Excursion& e) {
  const double whole = e.slide + e.stick, turned = e.turned ? 1 : 0, kept = 1 - turned;
  for (std::size_t n = 0; n < wanted_.omega.size(); ++n) {
    const auto c = e.transform[n], turn = std::polar(1.0, -wanted_.omega[n] * whole);
    const auto both = std::conj(c) * turn;
    groups_[spectra][n][side].add(
        std::array{turned, std::norm(c), c.real(), c.imag(), kept * turn.real(), kept * turn.imag(),
                   turned * turn.real(), turned * turn.imag(), kept * both.real(),
                   kept * both.imag(), turned * both.real(), turned * both.imag(), whole});
  }
}

void Tally::add_integrals(std::size_t side, const Excursion& e) {
  const double whole = e.slide + e.stick, turned = e.turned ? 1 : 0;
  const std::size_t functions = wanted_.observables.size();
  for (std::size_t f = 0; f < functions; ++f) {
    groups_[observed][f][side].add(
        std::array{turned, e.slide, e.stick, e.integrals[f].slide, e.integrals[f].stick});
  }
  for (std::size_t n = 0; n < groups_[discounted].size(); ++n) {
    const double lambda = wanted_.discount[n / functions], h = std::exp(-lambda * whole);
    const double one = lambda > 0 ? -std::expm1(-lambda * whole) / lambda : whole;
    groups_[discounted][n][side].add(std::array{turned, (1 - turned) * h, turned * h, one,
                                                e.discounted[n].value, e.discounted[n].mirrored});
  }
}

void Tally::add_path(const std::vector<State>& states) {
  const std::size_t times = states.size();
  for (std::size_t n = 0; n < groups_[expected].size(); ++n) {
    const State& z = states[n % times];
    groups_[expected][n][0].add(
        std::array{0.0, 1.0, wanted_.observables[n / times](z.x, z.y, z.v)});
  }
}

void Tally::add_stationary(std::size_t side, bool turned, double duration, const State& start,
                           const std::vector<State>& states) {
  const std::size_t times = states.size();
  const bool here = wanted_.start && wanted_.start->kind == model::Start::Kind::stationary;
  const double turns = turned ? 1 : 0;
  for (std::size_t n = 0; here && n < groups_[expected].size(); ++n) {
    const auto& f = wanted_.observables[n / times];
    const State& z = states[n % times];
    const double value = symmetric_ ? f.even(z.x, z.y, z.v) : f(z.x, z.y, z.v);
    groups_[expected][n][side].add(std::array{turns, duration, duration * value});
  }
  for (std::size_t n = 0; n < groups_[lagged].size(); ++n) {
    const double first = duration * start.v, last = duration * states[n].v;
    groups_[lagged][n][side].add(std::array{turns, duration, first, last, start.v * last});
  }
}

void Tally::merge(const Tally& other) {
  jumps_ += other.jumps_;
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    for (std::size_t n = 0; n < groups_[g].size(); ++n) {
      auto& sides = groups_[g][n];
      for (std::size_t s = 0; s < sides.size(); ++s) sides[s].merge(other.groups_[g][n][s]);
    }
  }
  for (std::size_t h = 0; h < histograms_.size(); ++h) {
    auto& counts = histograms_[h].counts();
    const auto& more = other.histograms_[h].counts();
    for (std::size_t n = 0; n < counts.size(); ++n) counts[n] += more[n];
  }
}

Estimate Tally::over_time(std::size_t total, double parity) const {
  const Means m = means(totals);
  return m.estimate(m.overall(total, parity) / (m.overall(slide) + m.overall(stick)));
}

// Without differences of nearly equal numbers.
Estimate Tally::sliding() const {
  const Means m = means(totals);
  return m.estimate(1 / (1 + m.overall(stick) / m.overall(slide)));
}

Estimate Tally::sticking() const {
  const Means m = means(totals);
  return m.estimate(1 / (1 + m.overall(slide) / m.overall(stick)));
}

Estimate Tally::mean(Duration duration) const {
  const Means m = means(totals);
  const Smooth sum = m.overall(slide) + m.overall(stick);
  if (duration == Duration::excursion) return m.estimate(sum);
  return m.estimate(m.overall(duration == Duration::slide ? slide : stick));
}

Estimate Tally::variance(Duration duration) const {
  const Means m = means(totals);
  const auto which = static_cast<std::size_t>(duration);
  const Smooth of_slide = m.overall(slide), of_stick = m.overall(stick);
  const std::array mean{of_slide, of_stick, of_slide + of_stick};
  return m.estimate(m.overall(square_of_slide + which) - mean[which] * mean[which]);
}

Estimate Tally::slip_rate() const {
  const Means m = means(totals);
  return m.estimate(1 / (m.overall(slide) + m.overall(stick)));
}

Estimate Tally::mean_square() const { return over_time(square); }
Estimate Tally::mean_speed() const { return over_time(path); }
Estimate Tally::mean_product() const { return over_time(product); }
Estimate Tally::mean_velocity() const { return over_time(drift, -1); }
Estimate Tally::within() const { return over_time(within_threshold); }
Estimate Tally::noise_square() const { return over_time(square_of_noise); }

Estimate Tally::mean_of_speeds(double up, double down) const {
  const Means m = means(totals);
  const Smooth weighted =
      (up + down) / 2 * m.overall(path) + (up - down) / 2 * m.overall(drift, -1);
  return m.estimate(weighted / (m.overall(slide) + m.overall(stick)));
}

// With D the displacement and T the duration of an excursion, m = E[D]/E[T] and W = D - m T, the
// sum of W over the excursions to come differs by u = E+[W]/P(s+ to s-) between a start at s+ and
// one at s-, and a long path spreads about its drift at the rate
//
//   S_v(0) = (E[W^2] + 2 u E[W; the next one starts at s+])/E[T].
Estimate Tally::spectrum_at_zero() const {
  const Means m = means(displacement);
  const Smooth drift = m.overall(d, -1) / m.overall(t);
  const auto sum = [&](std::size_t side, std::size_t of_d, std::size_t of_t) {
    return m.at(side, of_d, -1) - drift * m.at(side, of_t);
  };
  const Smooth spread =
      m.overall(dd) - 2 * drift * m.overall(dt, -1) + drift * drift * m.overall(tt);
  const Smooth up = m.share(0) * (sum(0, d, t) - sum(0, d_turned, t_turned)) +
                    m.share(1) * sum(1, d_turned, t_turned);
  return m.estimate((spread + 2 * sum(0, d, t) / m.at(0, 0) * up) / m.overall(t));
}

Estimate Tally::entry(std::size_t side, int i) const {
  return histograms_[0].mean(side, [&](std::size_t n) { return n == bin(i) ? 1.0 : 0.0; });
}

Estimate Tally::first_exit(double up, double down) const {
  const std::size_t levels = histograms_[0].bins();
  return histograms_[0].mean(
      [&](std::size_t n) { return (n == 0 ? down : 0) + (n + 1 == levels ? up : 0); });
}

Estimate Tally::laplace(std::size_t n, Duration duration) const {
  const Means m = means(laplaces, n);
  return m.estimate(m.overall(of_slide + static_cast<std::size_t>(duration)));
}

Estimate Tally::probability(Duration duration, double low, double high) const {
  const auto& edges = wanted_.edges;
  const auto bin_from = [&](double edge) {
    return static_cast<std::size_t>(std::lower_bound(edges.begin(), edges.end(), edge) -
                                    edges.begin()) +
           1;
  };
  const std::size_t first = low > 0 ? bin_from(low) : 0,
                    last = std::isfinite(high) ? bin_from(high) : edges.size() + 1;
  return histograms_[1 + static_cast<std::size_t>(duration)].mean(
      [&](std::size_t n) { return first <= n && n < last ? 1.0 : 0.0; });
}

// Let C be the transform of v over an excursion, T its duration, and H(s, s') and K(s, s') the
// means from side s of exp(-i omega T) and of conj(C) exp(-i omega T) where it ends on side s'.
// What is to come from side s has the mean transform G = C + H G, and with p the shares of the
// sides
//
//   S_v = (E|C|^2 + 2 Re(p K G))/E[T]
//
// without any window. With symmetry G(s-) = -G(s+). A constant added to v counts at omega = 0 only.
Estimate Tally::spectrum(std::size_t n) const {
  if (wanted_.omega[n] == 0) return spectrum_at_zero();
  const Means m = means(spectra, n);
  const std::array side{m.complex_at(0, c), m.complex_at(1, c, -1)};
  const std::array stays{1 - m.complex_at(0, same), 1 - m.complex_at(1, same)};
  const std::array turns{m.complex_at(0, other), m.complex_at(1, other)};
  const Smooth det = stays[0] * stays[1] - turns[0] * turns[1];
  std::array to_come{(side[0] * stays[1] + turns[0] * side[1]) / det,
                     (side[1] * stays[0] + turns[1] * side[0]) / det};
  if (symmetric_) to_come = {side[0] / (stays[0] + turns[0]), -1 * side[0] / (stays[0] + turns[0])};
  Smooth sum = m.overall(power);
  for (std::size_t s : {0, 1}) {
    sum = sum + 2 * m.share(s) *
                    (m.complex_at(s, c_same, -1) * to_come[s] +
                     m.complex_at(s, c_other, -1) * to_come[1 - s]);
  }
  return m.estimate(sum / m.overall(time));
}

Named Tally::averages(std::size_t f) const {
  const Means m = means(observed, f);
  const Smooth sliding = m.overall(f_slide), sticking = m.overall(f_stick);
  return {{"", m.estimate((sliding + sticking) / (m.overall(slide) + m.overall(stick)))},
          {"|stick", m.estimate(sticking / m.overall(stick))},
          {"|slide", m.estimate(sliding / m.overall(slide))}};
}

Named Tally::exits(std::size_t l) const {
  const Means m = means(discounted, l * wanted_.observables.size());
  Named all{{"h_plus", m.estimate(m.at(0, h_same))},
            {"h_minus", m.estimate(m.at(0, h_other))},
            {"w_one", m.estimate(m.at(0, w_one))}};
  if (symmetric_) return all;
  all.insert(all.end(), {{"h_plus_from_minus", m.estimate(m.at(1, h_other))},
                         {"h_minus_from_minus", m.estimate(m.at(1, h_same))},
                         {"w_one_from_minus", m.estimate(m.at(1, w_one))}});
  return all;
}

// Both sides alternate; w+ and w- weigh with the chances of going over to them.
Named Tally::resolvent(std::size_t l, std::size_t f) const {
  const Means m = means(discounted, l * wanted_.observables.size() + f);
  const double lambda = wanted_.discount[l];
  const Smooth a = m.at(0, h_other), b = m.at(1, h_other), one_plus = m.at(0, w_one),
               one_minus = m.at(1, w_one), plus = m.at(0, w_f),
               minus = symmetric_ ? m.at(0, w_mirrored) : m.at(1, w_f);
  const Smooth s = b * one_plus + a * one_minus;
  const Smooth pi = (b * plus + a * minus) / s;
  const Smooth apart =
      (one_minus * plus - one_plus * minus) / (s * (s + lambda * one_plus * one_minus));
  const Smooth mu = a * one_minus * apart, below = -1 * b * one_plus * apart;
  Named all{{"w_plus", m.estimate(plus)},
            {"w_minus", m.estimate(minus)},
            {"pi", m.estimate(pi)},
            {"mu", m.estimate(mu)}};
  if (lambda > 0) all.emplace_back("u", m.estimate(pi / lambda + mu));
  if (lambda > 0 && !symmetric_) all.emplace_back("u_minus", m.estimate(pi / lambda + below));
  return all;
}

Estimate Tally::expectation(std::size_t f, std::size_t n) const {
  const Means m = means(expected, f * wanted_.time.size() + n);
  return m.estimate(m.overall(weighted) / m.overall(weight));
}

Estimate Tally::autocorrelation(std::size_t n) const {
  const Means m = means(lagged, n);
  const Smooth duration = m.overall(duration_of_lagged);
  return m.estimate(m.overall(v_v) / duration -
                    m.overall(v_start, -1) * m.overall(v_end, -1) / (duration * duration));
}

std::vector<double> Tally::pack() const {
  std::vector<double> numbers{jumps_};
  for (const auto& group : groups_) {
    for (const auto& sides : group) {
      for (const auto& comoments : sides) comoments.pack(numbers);
    }
  }
  for (const auto& histogram : histograms_) {
    numbers.insert(numbers.end(), histogram.counts().begin(), histogram.counts().end());
  }
  return numbers;
}

std::size_t Tally::packed_size() const {
  std::size_t size = 1;
  for (const auto& group : groups_) {
    for (const auto& sides : group) size += sides.size() * sides[0].packed_size();
  }
  for (const auto& histogram : histograms_) size += histogram.counts().size();
  return size;
}

void Tally::unpack(std::span<const double> numbers) {
  if (numbers.size() != packed_size()) throw std::invalid_argument("a tally of other questions");
  jumps_ = numbers[0];
  numbers = numbers.subspan(1);
  for (auto& group : groups_) {
    for (auto& sides : group) {
      for (auto& comoments : sides) comoments.unpack(numbers);
    }
  }
  for (auto& histogram : histograms_) {
    auto& counts = histogram.counts();
    std::copy_n(numbers.begin(), counts.size(), counts.begin());
    numbers = numbers.subspan(counts.size());
  }
}

}  // namespace stickslip::simulation
