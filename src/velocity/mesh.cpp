#include "stickslip/velocity/mesh.hpp"

#include <algorithm>
#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

namespace stickslip::velocity {
namespace {

// Local decay rate of log-density in white noise, -d/dv log exp(-mu_d v + int b) = mu_d - b(v). A
// bias g changes it by -g on one half line and by g on the other; elements serve both.
double decay_rate(const model::Process& process, double v) {
  const double drag =
      process.drag.odd() ? -process.drag(v) : std::max(-process.drag(v), process.drag(-v));
  const double mu_d = process.friction.mu_d;
  return std::max(mu_d, process.friction.mu_d_minus.value_or(mu_d)) + std::abs(process.bias) + drag;
}

// Where geometric growth stops because an element would span more than `decay` of log-density.
double graded_end(const model::Process& process, const MeshRule& rule) {
  const double growth = 1 / rule.ratio - 1;
  const auto spare = [&](double v) { return rule.decay - growth * v * decay_rate(process, v); };
  if (spare(rule.v_max) >= 0) return rule.v_max;
  std::uintmax_t iterations = 200;
  const auto bracket = boost::math::tools::toms748_solve(
      spare, 0.0, rule.v_max, boost::math::tools::eps_tolerance<double>(20), iterations);
  return bracket.first;
}

// Distance from mu_d - g down to the nearest level below it, for levels that can come to rest on
// the upper half line.
double upper_gap_below(const model::Process& process) {
  const double delta = process.noise.delta;
  const auto level = static_cast<int>(std::floor((process.friction.mu_d - process.bias) / delta));
  for (int i = level + 1; i >= level - 1; --i) {
    if (process.net_force(i) < 0) return -process.net_force(i);
  }
  return delta;
}

// The smaller one of the two half lines.
double gap_below(const model::Process& process) {
  return std::min(upper_gap_below(process), upper_gap_below(process.mirrored()));
}

// At lambda = 0 two layers can form at v = 0. The kinetic layer around x = mu_d mixes levels delta
// apart, at speeds about delta, in the time 1/Lambda = tau^2 delta^2/2 between jumps: 0.3 delta^3
// tau^2 is fine enough at every degree tried. A level at a distance g below mu_d comes to rest
// through the factor (1 + v/s)^(-Lambda/c), s = g/c, c = -b'(0): with fast jumps it is over before
// it matters (the first test), with slow ones it is a feature of its own on the scale s.
double free_layer(const model::Process& process) {
  const auto& noise = process.noise;
  const double kinetic = 0.3 * noise.delta * noise.delta * noise.delta * noise.tau * noise.tau;
  double slope = -process.drag.slope_at_rest();
  if (!process.drag.odd()) slope = std::max(slope, -process.drag.mirrored().slope_at_rest());
  if (slope == 0) return kinetic;
  const double rest = gap_below(process) / slope;
  if (rest >= kinetic) return kinetic;
  const double left = std::log(rest / kinetic) * noise.rate() / slope;
  return left < std::log(1e-16) ? kinetic : rest;
}

// Bodies that rest within about 1/lambda do so through u = exp(-(Lambda + lambda) v/g) on levels at
// a distance g below mu_d. The level nearest to mu_d has the thinnest layer, and a share about
// q = (lambda/Lambda)(g/delta) of what comes to rest: unresolved it was seen in the 12th digit
// where q was 0.1, and not at all below 0.01. Then the layer of the next level decides.
double killed_layer(const model::Process& process, double lambda) {
  const auto& noise = process.noise;
  const double rate = noise.rate(), gap = gap_below(process);
  const bool counts = lambda * gap > 1e-3 * rate * noise.delta;
  return (counts ? gap : gap + noise.delta) / (rate + lambda);
}

// Speed that a body which leaves v = 0 has when the noise might turn it back: at the net force g it
// does so after the time g^2 tau^2/2. On the half line where that is less.
double speed_of_leaving(const model::Process& process) {
  const auto cubed = [](const model::Process& half) {
    return std::pow(half.net_force(half.static_index() + 1), 3);
  };
  const double tau = process.noise.tau;
  return 0.3 * tau * tau * std::min(cubed(process), cubed(process.mirrored()));
}

bool has_waves(const model::Process& process, const MeshRule& rule) {
  return rule.rates.omega > 4 * process.noise.rate();
}

double end_of_thinnest_waves(const model::Process& process) {
  return 20 * gap_below(process) / process.noise.rate();
}

// Widest element that resolves the waves of frequency omega at v. A body that rests after the time
// s sees the phase exp(i omega s): on a level at a distance a from mu_d the wave length is
// 2 pi a/omega, and jumps of the noise damp it as exp(-Lambda v/a). Two waves an element are
// enough at the degrees in use; where Lambda v/a > 20 nothing is left of a wave, and then the next
// level, delta further from mu_d, has the shortest ones. Up to 4 Lambda the
// damping is so strong that graded elements do, and waves much faster than the noise are small
// beside the smooth part, so that they are followed up to 40 Lambda only.
double wave_width(const model::Process& process, double omega, double v) {
  const double rate = process.noise.rate(), gap = gap_below(process);
  const double slowest =
      v < end_of_thinnest_waves(process) ? gap : std::max(gap + process.noise.delta, rate * v / 20);
  return 4 * std::numbers::pi * slowest / std::min(omega, 40 * rate);
}

// Cuts elements that are too wide for the waves. Those of a level very near to mu_d end within the
// first element: only the part that has them is cut for them.
std::vector<double> cut_for_waves(const model::Process& process, double omega,
                                  std::vector<double> ends) {
  const double thinnest = end_of_thinnest_waves(process);
  if (thinnest < ends[1]) ends.insert(ends.begin() + 1, thinnest);
  std::vector<double> cut{ends.front()};
  for (std::size_t n = 1; n < ends.size(); ++n) {
    const double start = ends[n - 1], width = ends[n] - start;
    const auto pieces =
        static_cast<int>(std::ceil(width / wave_width(process, omega, start) - 1e-9));
    for (int p = 1; p < pieces; ++p) cut.push_back(start + width * p / pieces);
    cut.push_back(ends[n]);
  }
  return cut;
}

}  // namespace

// Grading with one ratio down to the finest layer resolves exponentials of every scale alike, so
// that a large lambda asks for more elements at v = 0 and for none above.
double smallest_scale(const model::Process& process, double lambda) {
  const double free = free_layer(process);
  return lambda > 0 ? std::min(free, killed_layer(process, lambda)) : free;
}

int natural_layers(const model::Process& process, const MeshRule& rule) {
  const double span = graded_end(process, rule) / smallest_scale(process, rule.rates.lambda);
  return span <= 1 ? 1 : 1 + static_cast<int>(std::ceil(std::log(span) / -std::log(rule.ratio)));
}

std::vector<double> element_ends(const model::Process& process, const MeshRule& rule) {
  const int layers = rule.layers > 0 ? rule.layers : natural_layers(process, rule);
  const double graded = graded_end(process, rule);
  std::vector<double> ends{0};
  for (int n = layers - 1; n >= 0; --n) ends.push_back(graded * std::pow(rule.ratio, n));
  while (ends.back() < rule.v_max) {
    const double step = rule.decay / decay_rate(process, ends.back());
    const double next = ends.back() + std::min(step, ends.back() * (1 / rule.ratio - 1));
    // A remainder much shorter than its neighbour is merged into it.
    ends.push_back(next + 0.3 * step >= rule.v_max ? rule.v_max : next);
  }
  return has_waves(process, rule) ? cut_for_waves(process, rule.rates.omega, ends) : ends;
}

// An element at v holds a share of what is asked for that falls like v^0.8 to v (levels that it
// concerns times how far the solution is from constant there), half a digit from one element to the
// next, and a degree is worth a digit. One degree for two elements changed no error of seven scenes
// in which one for one made them 10 to 1000 times larger; factors have half the entries. That is
// so for bodies that come to rest. Those that leave it pass all speeds above `speed_of_leaving`,
// where they might turn back, so that errors there multiply: at mu_d = mu_s and delta = 1/256 they
// were 1e4 times larger with degrees falling by eight, and as small as ever with two. With
// less than degree 2 the first refinement levels were wrong by more than they said (mu_d = 0.9).
// Waves are as steep in every element, and what ends within 1/lambda before the noise changes comes
// from small v.
std::vector<int> element_degrees(const model::Process& process, const MeshRule& rule, int degree) {
  constexpr int most_where_left = 2;  // degrees less
  const int layers = rule.layers > 0 ? rule.layers : natural_layers(process, rule);
  const auto ends = element_ends(process, rule);
  std::vector<int> degrees(ends.size() - 1, degree);
  const bool early = rule.rates.lambda * process.noise.tau > 1;
  if (early || has_waves(process, rule)) return degrees;
  const double leaving = speed_of_leaving(process);
  const int graded = std::min(layers, static_cast<int>(degrees.size()));
  const auto slow = std::count_if(ends.begin() + 1, ends.begin() + 1 + graded,
                                  [leaving](double end) { return end < leaving; });
  for (int e = 0; e < graded; ++e) {
    const int below_leaving = std::max(static_cast<int>(slow) - e, 0);
    const int less = std::min((layers - 1 - e) / 2, most_where_left + below_leaving / 2);
    degrees[e] = std::max(std::min(2, degree), degree - less);
  }
  return degrees;
}

namespace {

// Of the upper half line.
double upper_tail(const model::Process& process, double tolerance) {
  const double drop = -std::log(tolerance) + 5;  // 5: polynomial factors of the moments
  // A bias beyond mu_d moves the largest density to where drag balances it.
  const double slope = process.friction.mu_d - process.bias;
  const double peak = process.drag.terminal_velocity(-slope);
  const double highest = -slope * peak + process.drag.potential(peak);
  const auto left = [&](double v) {
    return drop - highest - slope * v + process.drag.potential(v);
  };
  double end = slope > 0 ? drop / slope : std::max(2 * peak, 1.0);
  while (slope <= 0 && left(end) > 0 && end < process.drag.reach) end *= 2;
  end = std::min(end, process.drag.reach);
  if (process.drag.is_none() || !std::isfinite(left(end)) || left(end) > 0) return end;
  std::uintmax_t iterations = 200;
  const auto bracket = boost::math::tools::toms748_solve(
      left, peak, end, boost::math::tools::eps_tolerance<double>(20), iterations);
  return bracket.second;
}

}  // namespace

double tail_velocity(const model::Process& process, double tolerance) {
  const double upper = upper_tail(process, tolerance);
  return process.symmetric() ? upper : std::max(upper, upper_tail(process.mirrored(), tolerance));
}

}  // namespace stickslip::velocity
