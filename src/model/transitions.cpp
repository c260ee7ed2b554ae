#include "transitions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

#include "stickslip/linalg/dense.hpp"

namespace stickslip::model {
namespace {

using linalg::RateElimination;

// A state that cannot be reached from state 0; their number if there is none.
std::size_t not_reached(std::size_t count, const std::vector<Transition>& transitions) {
  const auto seen = reached_from(0, count, transitions);
  return static_cast<std::size_t>(std::find(seen.begin(), seen.end(), false) - seen.begin());
}

std::uint64_t mixed(std::uint64_t a, std::uint64_t b) {
  a ^= b + 0x9e3779b97f4a7c15 + (a << 6) + (a >> 2);
  a = (a ^ (a >> 30)) * 0xbf58476d1ce4e5b9;
  return a ^ (a >> 27);
}

// Of what people write or compute.
constexpr double kSameNumber = 1e-12;

// The same for numbers that agree but for rounding, unless they lie at the end of a step.
std::uint64_t bits(double x) {
  int exponent = 0;
  const double steps = std::round(std::frexp(x, &exponent) / kSameNumber);
  return std::bit_cast<std::uint64_t>(std::ldexp(steps, exponent) + 0.0);
}

// A number of each state that says what can be seen around it: equal for states that look alike.
std::vector<std::uint64_t> looks(const std::vector<double>& x,
                                 const std::vector<Transition>& transitions, double sign) {
  std::vector<std::uint64_t> look;
  for (double force : x) look.push_back(mixed(1, bits(sign * force)));
  std::size_t kinds = 0;
  for (std::size_t round = 0; round < x.size(); ++round) {
    std::vector<std::uint64_t> next;
    for (std::uint64_t own : look) next.push_back(mixed(2, own));
    // Sums do not depend on the order of transitions.
    for (const auto& [from, to, rate] : transitions) {
      next[from] += mixed(mixed(3, look[to]), bits(rate));
      next[to] += mixed(mixed(4, look[from]), bits(rate));
    }
    look = std::move(next);
    auto sorted = look;
    std::sort(sorted.begin(), sorted.end());
    const auto different =
        static_cast<std::size_t>(std::unique(sorted.begin(), sorted.end()) - sorted.begin());
    if (different == kinds) break;
    kinds = different;
  }
  return look;
}

int band_of(const Jumps& jumps) {
  int band = 0;
  for (std::size_t n = 0; n < jumps.size(); ++n) {
    for (const auto& jump : jumps[n]) {
      band = std::max(band, std::abs(jump.to - static_cast<int>(n)));
    }
  }
  return band;
}

double weighted(std::span<const double> p, const std::vector<double>& f,
                const std::vector<double>& g) {
  double sum = 0;
  for (std::size_t n = 0; n < f.size(); ++n) sum += p[n] * f[n] * g[n];
  return sum;
}

// -Q f.
std::vector<double> applied(const Jumps& jumps, const std::vector<double>& f) {
  std::vector<double> g(f.size(), 0.0);
  for (std::size_t n = 0; n < f.size(); ++n) {
    for (const auto& [to, rate] : jumps[n]) g[n] += rate * (f[n] - f[to]);
  }
  return g;
}

// Whether theta f + Q has eigenvalues of negative real part alone: the pivots of its negative, an
// M-matrix, are positive.
bool decays(const Jumps& jumps, const std::vector<double>& f, double theta, int band) {
  const int count = static_cast<int>(f.size()), width = 2 * band + 1;
  std::vector<double> a(f.size() * static_cast<std::size_t>(width), 0.0);
  const auto entry = [&](int r, int c) -> double& {
    return a[static_cast<std::size_t>(r) * width + static_cast<std::size_t>(c - r + band)];
  };
  for (int n = 0; n < count; ++n) {
    double leaving = 0;
    for (const auto& [to, rate] : jumps[n]) {
      entry(n, to) -= rate;
      leaving += rate;
    }
    entry(n, n) += leaving - theta * f[n];
  }
  for (int i = 0; i < count; ++i) {
    if (!(entry(i, i) > 0)) return false;
    const int last = std::min(i + band, count - 1);
    for (int j = i + 1; j <= last; ++j) {
      const double factor = entry(j, i) / entry(i, i);
      if (factor == 0) continue;
      for (int k = i + 1; k <= last; ++k) entry(j, k) -= factor * entry(i, k);
    }
  }
  return true;
}

}  // namespace

std::vector<bool> reached_from(std::size_t first, std::size_t states,
                               const std::vector<Transition>& transitions) {
  std::vector<std::vector<std::size_t>> next(states);
  for (const auto& [from, to, rate] : transitions) next[from].push_back(to);
  std::vector<bool> reached(states, false);
  std::vector<std::size_t> open{first};
  reached[first] = true;
  while (!open.empty()) {
    const std::size_t here = open.back();
    open.pop_back();
    for (std::size_t to : next[here]) {
      if (!reached[to]) open.push_back(to);
      reached[to] = true;
    }
  }
  return reached;
}

void require_states(const std::vector<double>& x, const std::vector<Transition>& transitions) {
  if (x.size() < 2) throw UnfitTable(x.size(), "there must be at least two states");
  for (std::size_t n = 0; n < x.size(); ++n) {
    if (!std::isfinite(x[n])) throw UnfitTable(n, fmt::format("x = {:g} must be a number", x[n]));
  }
  for (const auto& [from, to, rate] : transitions) {
    if (rate > 0 && std::isfinite(rate)) continue;
    throw UnfitTable(from, fmt::format("the rate {:g} to state {} must be positive", rate, to));
  }
  std::vector<bool> left(x.size(), false), reached(x.size(), false);
  for (const auto& [from, to, rate] : transitions) left[from] = reached[to] = true;
  for (std::size_t n = 0; n < x.size(); ++n) {
    if (!left[n]) throw UnfitTable(n, fmt::format("state {} is never left", n));
    if (!reached[n]) throw UnfitTable(n, fmt::format("state {} is never reached", n));
  }
  const std::size_t forwards = not_reached(x.size(), transitions);
  if (forwards < x.size()) {
    throw UnfitTable(forwards, fmt::format("state {} is never reached from state 0", forwards));
  }
  auto reversed = transitions;
  for (auto& transition : reversed) std::swap(transition.from, transition.to);
  const std::size_t backwards = not_reached(x.size(), reversed);
  if (backwards < x.size()) {
    throw UnfitTable(backwards, fmt::format("state 0 is never reached from state {}", backwards));
  }
}

std::vector<double> without_rounding(const std::vector<double>& x) {
  std::vector<double> sizes;
  for (double force : x) sizes.push_back(std::abs(force));
  std::sort(sizes.begin(), sizes.end());
  const double rounding = kSameNumber * sizes.back();
  // Each by the smallest of those that follow one another that closely.
  std::vector<double> all;
  for (double force : x) {
    auto size = std::lower_bound(sizes.begin(), sizes.end(), std::abs(force));
    while (size != sizes.begin() && *size - *(size - 1) <= rounding) --size;
    all.push_back(*size <= rounding ? 0 : std::copysign(*size, force));
  }
  return all;
}

bool MirroredOrder::reversed() const {
  for (std::size_t n = 0; n < image.size(); ++n) {
    if (image[n] != image.size() - 1 - n) return false;
  }
  return true;
}

MirroredOrder mirrored_order(const std::vector<double>& x,
                             const std::vector<Transition>& transitions) {
  const auto look = looks(x, transitions, 1), mirrored = looks(x, transitions, -1);
  // Looks are numbers that change with the units: what counts is where each is first seen.
  std::map<std::uint64_t, std::size_t> first;
  for (std::size_t n = 0; n < x.size(); ++n) first.try_emplace(look[n], n);
  const bool may_be_even =
      std::ranges::all_of(mirrored, [&](std::uint64_t image) { return first.contains(image); });
  // Below 0 the mirror decides; at 0 states come before their images, in the images' reverse order,
  // with those between them that are their own images. All others keep their order.
  const auto key = [&](std::size_t n) {
    if (!may_be_even) return std::tuple(0, std::size_t{0});
    const std::size_t own = first.at(look[n]), other = first.at(mirrored[n]);
    if (x[n] > 0) return std::tuple(0, own);
    if (x[n] < 0) return std::tuple(0, x.size() - other);
    if (own < other) return std::tuple(0, own);
    if (own == other) return std::tuple(1, own);
    return std::tuple(2, x.size() - other);
  };
  MirroredOrder order;
  auto& states = order.states;
  states.resize(x.size());
  std::iota(states.begin(), states.end(), std::size_t{0});
  std::stable_sort(states.begin(), states.end(), [&](std::size_t a, std::size_t b) {
    return std::tuple(x[a], key(a)) < std::tuple(x[b], key(b));
  });
  const std::size_t last = x.size() - 1;
  for (std::size_t n = 0; n <= last; ++n) order.image.push_back(last - n);
  const auto alone = [&](std::size_t place) {
    const std::size_t n = states[place];
    const auto same = [&](std::size_t other) { return x[other] == 0 && look[other] == look[n]; };
    return x[n] == 0 && look[n] == mirrored[n] && !(place > 0 && same(states[place - 1])) &&
           !(place < last && same(states[place + 1]));
  };
  for (std::size_t n = 0; n <= last; ++n) {
    if (alone(n)) order.image[n] = n;
  }
  return order;
}

bool mirrors_itself(const Jumps& jumps, const std::vector<std::size_t>& image) {
  for (std::size_t n = 0; n < jumps.size(); ++n) {
    auto seen = jumps[n];
    for (auto& jump : seen) jump.to = static_cast<int>(image[static_cast<std::size_t>(jump.to)]);
    std::sort(seen.begin(), seen.end(), [](const auto& a, const auto& b) { return a.to < b.to; });
    const auto& there = jumps[image[n]];
    const bool same = std::equal(
        seen.begin(), seen.end(), there.begin(), there.end(), [](const auto& a, const auto& b) {
          return a.to == b.to && std::abs(a.rate - b.rate) <= kSameNumber * a.rate;
        });
    if (!same) return false;
  }
  return true;
}

std::vector<double> stationary(const Jumps& jumps) {
  std::vector<RateElimination::Rate> rates;
  for (std::size_t n = 0; n < jumps.size(); ++n) {
    for (const auto& [to, rate] : jumps[n]) rates.push_back({static_cast<int>(n), to, rate});
  }
  return RateElimination(std::vector<double>(jumps.size(), 0.0), rates).stationary();
}

// sum_n p_n f_n phi_n with -Q phi = f, and phi = 0 in the last state.
double intensity(const Jumps& jumps, std::span<const double> p, const std::vector<double>& f) {
  const int last = static_cast<int>(f.size()) - 1;
  std::vector<double> killing(f.size() - 1, 0.0);
  std::vector<RateElimination::Rate> rates;
  for (int n = 0; n < last; ++n) {
    for (const auto& [to, rate] : jumps[n]) {
      if (to == last) {
        killing[n] += rate;
      } else {
        rates.push_back({n, to, rate});
      }
    }
  }
  auto phi = RateElimination(std::move(killing), rates).integral({f.begin(), f.end() - 1});
  phi.push_back(0);
  return weighted(p, f, phi);
}

// With v_1 ... v_k an orthonormal basis of the Krylov space of -Q and f, in the inner product of p,
// and H the projection of -Q, the integral is about E[f^2] Re e_1^T (H + i omega)^-1 e_1.
double peak_intensity(const Jumps& jumps, std::span<const double> p, const std::vector<double>& f) {
  const int most = std::min<int>(60, static_cast<int>(f.size()) - 1);
  const double square = weighted(p, f, f);
  linalg::Matrix<double> h(most + 1, most);
  std::vector<std::vector<double>> basis{f};
  for (double& value : basis[0]) value /= std::sqrt(square);
  int size = 0;
  for (; size < most; ++size) {
    auto next = applied(jumps, basis[size]);
    const double before = std::sqrt(weighted(p, next, next));
    for (int pass = 0; pass < 2; ++pass) {
      for (int k = 0; k <= size; ++k) {
        const double share = weighted(p, basis[k], next);
        h(k, size) += share;
        for (std::size_t n = 0; n < next.size(); ++n) next[n] -= share * basis[k][n];
      }
    }
    const double norm = std::sqrt(weighted(p, next, next));
    if (!(norm > 1e-12 * before)) {
      ++size;
      break;
    }
    h(size + 1, size) = norm;
    for (double& value : next) value /= norm;
    basis.push_back(std::move(next));
  }
  const auto at = [&](double omega) {
    linalg::Matrix<std::complex<double>> shifted(size, size), first(size, 1);
    for (int c = 0; c < size; ++c) {
      for (int r = 0; r < size; ++r) shifted(r, c) = h(r, c);
      shifted(c, c) += std::complex<double>(0, omega);
    }
    first(0, 0) = 1;
    linalg::LuFactors<std::complex<double>>(std::move(shifted)).solve(first);
    return square * first(0, 0).real();
  };
  double largest = at(0);
  const double mean_rate = h(0, 0);
  // In steps of 5 percent, which no band of a few tens of states falls between.
  for (double omega = 1e-3 * mean_rate; omega < 10 * mean_rate; omega *= 1.05) {
    largest = std::max(largest, at(omega));
  }
  return largest;
}

double decay(const Jumps& jumps, const std::vector<double>& f, double guess) {
  const int band = band_of(jumps);
  constexpr int most = 60, halvings = 10;
  double low = guess, high = guess;
  for (int n = 0; n < most && !decays(jumps, f, low, band); ++n) low /= 2;
  high = low;
  for (int n = 0; n < most && decays(jumps, f, high, band); ++n) {
    low = high;
    high *= 2;
  }
  for (int n = 0; n < halvings; ++n) {
    const double middle = (low + high) / 2;
    (decays(jumps, f, middle, band) ? low : high) = middle;
  }
  return low;
}

}  // namespace stickslip::model
