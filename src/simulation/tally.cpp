#include "stickslip/simulation/tally.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <stdexcept>

#include "stickslip/catalogue/averages_keys.hpp"
#include "stickslip/catalogue/displacement_keys.hpp"
#include "stickslip/catalogue/peak_keys.hpp"
#include "stickslip/catalogue/resolvent_keys.hpp"
#include "stickslip/catalogue/slip_keys.hpp"
#include "stickslip/support/infinity.hpp"

namespace stickslip::simulation {
namespace {

// What the groups hold, after 1{turned}.
enum Total : std::size_t {
  slide = 1,
  stick,
  square_of_slide,
  square_of_stick,
  square_of_excursion,
  first_integral,  // in the order of Integrand
  path = first_integral + 1,
  drift = first_integral + 5,
  size_of_totals
};
// D, T and products of them, what of them belongs to excursions that turn, path L and its square.
enum Move : std::size_t { d = 1, t, dd, dt, tt, d_turned, t_turned, l, ll, size_of_moves };
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
enum Travel : std::size_t { travelled = 2, travelled_square, size_of_travels };  // after weight
// Until a speed is reached, or until an excursion ends, also of the first one from rest.
enum Passage : std::size_t { reached = 1, crossed, lasted, rest, rest_up, rest_down, passage_size };
enum Lagged : std::size_t { duration_of_lagged = 1, v_start, v_end, v_v, size_of_lagged };

Smooth mean_of(const Means& m, Duration duration) {
  if (duration == Duration::excursion) return m.overall(slide) + m.overall(stick);
  return m.overall(duration == Duration::slide ? slide : stick);
}

Estimate over_time(const Means& m, const Smooth& total) {
  return m.estimate(total / mean_of(m, Duration::excursion));
}

}  // namespace

Tally::Tally(const model::Process& process, const Wanted& wanted)
    : lowest_(process.lowest_static()), wanted_(wanted), symmetric_(process.symmetric()) {
  const auto group = [&](Group which, std::size_t members, std::size_t size, std::size_t sides) {
    places_[which] = {comoments_.size(), members, sides};
    comoments_.insert(comoments_.end(), members * sides, Comoments(size));
  };
  const std::size_t sides = symmetric_ ? 1 : 2, functions = wanted.observables.size();
  group(totals, 1, size_of_totals, sides);
  group(displacement, wanted.displacement ? 1 : 0, size_of_moves, sides);
  group(laplaces, wanted.lambda.size(), size_of_laplaces, sides);
  group(spectra, wanted.omega.size(), size_of_transforms, sides);
  group(observed, functions, size_of_observed, sides);
  group(discounted, functions * wanted.discount.size(), size_of_discounts, sides);
  const std::size_t times = wanted.time.size(), starts = wanted.chosen_paths() ? 1 : sides;
  group(expected, wanted.expectation ? functions * times : 0, size_of_expected, starts);
  group(lagged, wanted.autocorrelation ? times : 0, size_of_lagged, sides);
  group(travels, wanted.travel ? times : 0, size_of_travels, starts);
  group(slip_transforms, wanted.inverse_distance.size(), 2, sides);
  group(passages, wanted.speeds.size(), passage_size, sides);
  edges_ = {{}, wanted.edges, wanted.edges, wanted.edges, wanted.path_edges, wanted.speeds};
  for (const auto& edges : edges_) histograms_.emplace_back(symmetric_, edges.size() + 1);
  histograms_[0] = Histogram(symmetric_, bin(process.static_index()) + 1);
}

std::size_t Tally::bin(int level) const {
  const int above = level - lowest_;
  return static_cast<std::size_t>(above);
}

void Tally::add(std::size_t side, const Excursion& e) {
  const double turned = e.turned ? 1 : 0, whole = e.slide + e.stick;
  keep(totals, 0, side,
       {turned, e.slide, e.stick, e.slide * e.slide, e.stick * e.stick, whole * whole, e.square,
        e.path, e.product, e.within, e.noise_square, e.drift});
  jumps_ += e.jumps;
  if (wanted_.displacement) {
    keep(displacement, 0, side,
         {turned, e.drift, whole, e.drift * e.drift, e.drift * whole, whole * whole,
          turned * e.drift, turned * whole, e.path, e.path * e.path});
  }
  for (std::size_t n = 0; n < wanted_.lambda.size(); ++n) {
    const double f = std::exp(-wanted_.lambda[n] * e.slide),
                 s = std::exp(-wanted_.lambda[n] * e.stick);
    keep(laplaces, n, side, {turned, f, s, f * s});
  }
  add_transforms(side, e);
  add_integrals(side, e);
  for (std::size_t n = 0; n < wanted_.inverse_distance.size(); ++n) {
    keep(slip_transforms, n, side, {turned, std::exp(-wanted_.inverse_distance[n] * e.path)});
  }
  histograms_[0].add(side, e.turned, bin(e.entry));
  const std::array values{e.slide, e.stick, whole, e.path, e.peak};
  for (std::size_t h = 1; h < edges_.size(); ++h) {
    if (edges_[h].empty()) continue;
    const auto above = std::upper_bound(edges_[h].begin(), edges_[h].end(), values[h - 1]);
    histograms_[h].add(side, e.turned, static_cast<std::size_t>(above - edges_[h].begin()));
  }
}

void Tally::add_passages(std::size_t side, const Excursion& e, const Excursion& from_rest) {
  const auto time = [](const Excursion& of, std::size_t n) {
    return n < of.passages.size() ? of.passages[n] : of.slide + of.stick;
  };
  const double turned = e.turned ? 1 : 0, down = from_rest.turned ? 1 : 0;
  for (std::size_t n = 0; n < wanted_.speeds.size(); ++n) {
    const double missed = n < e.passages.size() ? 0 : 1,
                 rest_missed = n < from_rest.passages.size() ? 0 : 1;
    keep(passages, n, side,
         {turned, 1 - missed, missed * turned, time(e, n), time(from_rest, n),
          rest_missed * (1 - down), rest_missed * down});
  }
}

void Tally::add_transforms(std::size_t side, const Excursion& e) {
  const double whole = e.slide + e.stick, turned = e.turned ? 1 : 0, kept = 1 - turned;
  for (std::size_t n = 0; n < wanted_.omega.size(); ++n) {
    const auto c = e.transform[n], turn = std::polar(1.0, -wanted_.omega[n] * whole);
    const auto both = std::conj(c) * turn;
    keep(spectra, n, side,
         {turned, std::norm(c), c.real(), c.imag(), kept * turn.real(), kept * turn.imag(),
          turned * turn.real(), turned * turn.imag(), kept * both.real(), kept * both.imag(),
          turned * both.real(), turned * both.imag(), whole});
  }
}

void Tally::add_integrals(std::size_t side, const Excursion& e) {
  const double whole = e.slide + e.stick, turned = e.turned ? 1 : 0;
  const std::size_t functions = wanted_.observables.size();
  for (std::size_t f = 0; f < functions; ++f) {
    keep(observed, f, side, {turned, e.slide, e.stick, e.integrals[f].slide, e.integrals[f].stick});
  }
  std::size_t n = 0;
  for (double lambda : wanted_.discount) {
    const double h = std::exp(-lambda * whole);
    const double one = lambda > 0 ? -std::expm1(-lambda * whole) / lambda : whole;
    for (std::size_t f = 0; f < functions; ++f, ++n) {
      const auto& w = e.discounted[n];
      keep(discounted, n, side, {turned, (1 - turned) * h, turned * h, one, w.value, w.mirrored});
    }
  }
}

void Tally::add_path(std::size_t side, bool turned, double weight,
                     const std::vector<State>& states) {
  const std::size_t times = states.size();
  const bool even = symmetric_ && !wanted_.chosen_paths();
  for (std::size_t n = 0; n < places_[expected].members; ++n) {
    const auto& f = wanted_.observables[n / times];
    const State& z = states[n % times];
    const double value = even ? f.even(z.x, z.y, z.v) : f(z.x, z.y, z.v);
    keep(expected, n, side, {turned ? 1.0 : 0.0, weight, weight * value});
  }
  for (std::size_t n = 0; n < places_[travels].members; ++n) {
    const double x = states[n].displacement;
    keep(travels, n, side, {turned ? 1.0 : 0.0, weight, weight * x, weight * x * x});
  }
}

void Tally::add_lagged(std::size_t side, bool turned, double duration, const State& start,
                       const std::vector<State>& states) {
  for (std::size_t n = 0; n < places_[lagged].members; ++n) {
    const double first = duration * start.v, last = duration * states[n].v;
    keep(lagged, n, side, {turned ? 1.0 : 0.0, duration, first, last, start.v * last});
  }
}

void Tally::merge(const Tally& other) {
  jumps_ += other.jumps_;
  for (std::size_t n = 0; n < comoments_.size(); ++n) comoments_[n].merge(other.comoments_[n]);
  for (std::size_t h = 0; h < histograms_.size(); ++h) {
    const auto counts = histograms_[h].counts();
    const auto more = other.histograms_[h].counts();
    for (std::size_t n = 0; n < counts.size(); ++n) counts[n] += more[n];
  }
}

// Without differences of nearly equal numbers.
Estimate Tally::share(Duration duration) const {
  const Means m = means(totals);
  const auto other = duration == Duration::slide ? Duration::stick : Duration::slide;
  return m.estimate(1 / (1 + mean_of(m, other) / mean_of(m, duration)));
}

Estimate Tally::mean(Duration duration) const {
  const Means m = means(totals);
  return m.estimate(mean_of(m, duration));
}

Estimate Tally::variance(Duration duration) const {
  const Means m = means(totals);
  const Smooth mean = mean_of(m, duration);
  return m.estimate(m.overall(square_of_slide + static_cast<std::size_t>(duration)) - mean * mean);
}

Estimate Tally::slip_rate() const { return over_time(means(totals), 1); }

Estimate Tally::stationary(Integrand integrand) const {
  const Means m = means(totals);
  const double parity = integrand == Integrand::v ? -1 : 1;
  return over_time(m, m.overall(first_integral + static_cast<std::size_t>(integrand), parity));
}

Estimate Tally::mean_of_speeds(double up, double down) const {
  const Means m = means(totals);
  return over_time(m, (up + down) / 2 * m.overall(path) + (up - down) / 2 * m.overall(drift, -1));
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
  // One side alone renews the process at each of its starts.
  const Smooth turning = m.at(0, 0);
  const Smooth to_come = turning.value == 0.0 ? Smooth(0) : 2 * sum(0, d, t) / turning * up;
  return m.estimate((spread + to_come) / m.overall(t));
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

Estimate Tally::probability(Variable variable, double low, double high) const {
  const std::size_t h = 1 + static_cast<std::size_t>(variable);
  const auto& all = edges_[h];
  const auto bin_from = [&](double edge) {
    return static_cast<std::size_t>(std::lower_bound(all.begin(), all.end(), edge) - all.begin()) +
           1;
  };
  const std::size_t first = low > 0 ? bin_from(low) : 0,
                    last = std::isfinite(high) ? bin_from(high) : all.size() + 1;
  return histograms_[h].mean([&](std::size_t n) { return first <= n && n < last ? 1.0 : 0.0; });
}

Named Tally::slip() const {
  const Means m = means(displacement);
  const Smooth mean = m.overall(l), net = m.overall(d, -1);
  return {{&catalogue::kMeanSlip, m.estimate(mean)},
          {&catalogue::kVarSlip, m.estimate(m.overall(ll) - mean * mean)},
          {&catalogue::kMeanSlipNet, m.estimate(net)},
          {&catalogue::kVarSlipNet, m.estimate(m.overall(dd) - net * net)}};
}

Estimate Tally::slip_transform(std::size_t n) const {
  const Means m = means(slip_transforms, n);
  return m.estimate(m.overall(1));
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
  const std::array diagonal{1 - m.complex_at(0, same), 1 - m.complex_at(1, same)};
  const std::array turns{m.complex_at(0, other), m.complex_at(1, other)};
  const Smooth det = diagonal[0] * diagonal[1] - turns[0] * turns[1];
  std::array to_come{(side[0] * diagonal[1] + turns[0] * side[1]) / det,
                     (side[1] * diagonal[0] + turns[1] * side[0]) / det};
  if (symmetric_)
    to_come = {side[0] / (diagonal[0] + turns[0]), -1 * side[0] / (diagonal[0] + turns[0])};
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
  return {{&catalogue::kPi, over_time(m, sliding + sticking)},
          {&catalogue::kPiStick, m.estimate(sticking / m.overall(stick))},
          {&catalogue::kPiSlide, m.estimate(sliding / m.overall(slide))}};
}

Named Tally::exits(std::size_t l) const {
  const Means m = means(discounted, l * wanted_.observables.size());
  Named all{{&catalogue::kHPlus, m.estimate(m.at(0, h_same))},
            {&catalogue::kHMinus, m.estimate(m.at(0, h_other))},
            {&catalogue::kWOne, m.estimate(m.at(0, w_one))}};
  if (symmetric_) return all;
  all.insert(all.end(), {{&catalogue::kHPlusFromMinus, m.estimate(m.at(1, h_other))},
                         {&catalogue::kHMinusFromMinus, m.estimate(m.at(1, h_same))},
                         {&catalogue::kWOneFromMinus, m.estimate(m.at(1, w_one))}});
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
  Named all{{&catalogue::kWPlus, m.estimate(plus)},
            {&catalogue::kWMinus, m.estimate(minus)},
            {&catalogue::kPiLambda, m.estimate(pi)},
            {&catalogue::kMu, m.estimate(mu)}};
  if (lambda > 0) all.emplace_back(&catalogue::kU, m.estimate(pi / lambda + mu));
  if (symmetric_) return all;
  all.emplace_back(&catalogue::kMuMinus, m.estimate(below));
  if (lambda > 0) all.emplace_back(&catalogue::kUMinus, m.estimate(pi / lambda + below));
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

// With symmetry paths from rest and stationary ones are as likely as their mirror images.
Named Tally::travel(std::size_t n) const {
  const Means m = means(travels, n);
  const bool even = symmetric_ && wanted_.start->kind != model::Start::Kind::state;
  const Smooth all = m.overall(weight), mean = m.overall(travelled, even ? -1 : 1) / all;
  return {{&catalogue::kDisplacementMean, m.estimate(mean)},
          {&catalogue::kDisplacementVariance,
           m.estimate(m.overall(travelled_square) / all - mean * mean)}};
}

// From side s an excursion reaches w with probability p(s), ends before on the other side with
// probability q(s), and takes the mean time a(s) until it does either or ends. The mean time to
// come is m+ = a+ + (1 - p+ - q+) m+ + q+ m-, and so for m-; it is known up to a factor. Where no
// sliding phase reached w, one that as many samples miss with probability 0.025 has the least.
Named Tally::first_passage(double w) const {
  const auto at = std::lower_bound(wanted_.speeds.begin(), wanted_.speeds.end(), w);
  const Means m = means(passages, static_cast<std::size_t>(at - wanted_.speeds.begin()));
  const std::array p{m.at(0, reached), m.at(1, reached)}, q{m.at(0, crossed), m.at(1, crossed)},
      a{m.at(0, lasted), m.at(1, lasted)};
  const Smooth det = p[0] * p[1] + p[0] * q[1] + q[0] * p[1];
  const bool never = det.value == 0.0;
  const Smooth least = samples() / -std::log(0.025) * m.overall(lasted);
  const Smooth up = never ? least : (a[0] * (p[1] + q[1]) + q[0] * a[1]) / det;
  const Smooth down = never ? least : (a[1] * (p[0] + q[0]) + q[1] * a[0]) / det;
  const auto estimate = [&](const Smooth& time) -> Estimate {
    const auto [mean, low, high] = m.estimate(time);
    if (never) return {mean, mean, kInfinity};
    const double factor = std::exp(high / mean - 1);
    return {mean, mean / factor, mean * factor};
  };
  return {{&catalogue::kFirstPassage, estimate(m.share(0) * up + m.share(1) * down)},
          {&catalogue::kFirstPassageRest,
           estimate(m.at(0, rest) + m.at(0, rest_up) * up + m.at(0, rest_down) * down)}};
}

// All that is kept, row by row.
template <class Self, class Action>
void Tally::each_row(Self& tally, const Action& action) {
  action(std::span(&tally.jumps_, 1));
  for (auto& comoments : tally.comoments_) action(comoments.numbers());
  for (auto& histogram : tally.histograms_) action(histogram.counts());
}

std::vector<double> Tally::pack() const {
  std::vector<double> numbers;
  each_row(*this, [&](auto row) { numbers.insert(numbers.end(), row.begin(), row.end()); });
  return numbers;
}

std::size_t Tally::packed_size() const {
  std::size_t size = 0;
  each_row(*this, [&](auto row) { size += row.size(); });
  return size;
}

void Tally::unpack(std::span<const double> numbers) {
  if (numbers.size() != packed_size()) throw std::invalid_argument("a tally of other questions");
  each_row(*this, [&](auto row) {
    std::copy_n(numbers.begin(), row.size(), row.begin());
    numbers = numbers.subspan(row.size());
  });
}

}  // namespace stickslip::simulation
