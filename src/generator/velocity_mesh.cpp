#include "stickslip/generator/velocity_mesh.hpp"

#include <boost/math/tools/roots.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <set>
#include <utility>

namespace stickslip::generator {
namespace {

// The white-noise bound of the density of velocities, by which elements, their degrees and the end
// of the velocity discretisation are chosen.

/// log of the stationary density of white noise of intensity D on the positive branch, exp((-slope
/// v + int b)/D) with slope = F(0+) - g, g the mean force, against its largest value. Large speeds
/// make of some noises a stronger one.
struct LogDensity {
  /// At speeds up to `end`.
  LogDensity(const model::Process& process, double end)
      : drag(process.drag), slope(process.friction.at_rest() - process.mean_force()) {
    extrema.push_back(drag.terminal_velocity(-slope));
    if (drag.rises_until > 0) extrema = drag.balances(-slope);
    end = std::min(end, drag.reach);
    // The forces that slow bodies on the way; where drag rises, any.
    if (drag.is_none()) {
      intensity = process.noise.tail_intensity(slope, slope);
    } else if (drag.rises_until == 0 && std::isfinite(end)) {
      intensity = process.noise.tail_intensity(std::max(slope, 0.0), slope - drag(end));
    } else {
      intensity = process.noise.tail_intensity();
    }
    for (double v : extrema) highest = std::max(highest, -slope * v + drag.potential(v));
  }
  /// Raised by `by`.
  [[nodiscard]] double operator()(double v, double by = 0) const {
    return by - (highest + slope * v - drag.potential(v)) / intensity;
  }

  model::Drag drag;
  double slope;
  // Rising: where drag balances a bias beyond mu_d; under forces that weaken more, minima too.
  std::vector<double> extrema;
  double highest = 0;  // at v = 0
  double intensity;
};

// Many levels damp waves much faster than the noise. Few do not, as bodies at the speed at which
// the drag holds them all take the same time to come to rest.
bool damps_fast_waves(const model::Process& process) {
  constexpr double jumps = 20;  // while the noise forgets itself
  const auto& noise = process.noise;
  return (!noise.table || !noise.has_levels()) && noise.rate() * noise.correlation_time() > jumps;
}

// The largest frequency whose waves elements follow.
double highest_followed(const model::Process& process) {
  return (damps_fast_waves(process) ? 40 : 4000) * process.noise.rate();
}

// The widest element for the levels of a table, each with its own rate, at the speed v: one wave an
// element. Bodies carry a phase from v = 0 or to it, for as long as their level lasts: none where
// they are beyond a speed at which the drag holds them.
double wave_width_of_table(const model::Process& process, double omega, double v) {
  constexpr int steps = 40;
  constexpr double lives = 20;  // of a level, after which nothing is left of a wave
  double slowest = kInfinity;
  for (const auto& side : {process, process.mirrored()}) {
    const auto& noise = side.noise;
    std::array<double, steps> drag{};  // in the middle of each step from 0 to v
    for (int n = 0; n < steps; ++n) drag[n] = side.drag((n + 0.5) / steps * v);
    const double at_end = side.drag(v);
    for (int i = noise.lowest(); i <= noise.highest(); ++i) {
      const double rate = model::change_rates(noise, i).most;
      if (omega <= rate) continue;
      const double force = side.net_force(i);
      double jumps = 0;
      for (int n = 0; n < steps && jumps < lives; ++n) {
        const double speed = force + drag[n];
        jumps += speed * force > 0 ? rate * v / steps / std::abs(speed) : lives;
      }
      if (jumps < lives) slowest = std::min(slowest, std::abs(force + at_end));
    }
  }
  return 2 * std::numbers::pi * slowest / std::min(omega, highest_followed(process));
}

double end_of_thinnest_waves(const model::Process& process, double gap) {
  return 20 * gap / process.noise.rate();
}

// Widest element that resolves the waves of frequency omega at v. A body that rests after the time
// s sees the phase exp(i omega s): on a level at a distance a from mu_d the wave length is
// 2 pi a/omega, and jumps of the noise damp it as exp(-Lambda v/a). Two waves an element are
// enough at the degrees in use; where Lambda v/a > 20 nothing is left of a wave, and then the next
// level, delta further from mu_d, has the shortest ones. Up to 4 Lambda the
// damping is so strong that graded elements do, and waves much faster than the noise are small
// beside the smooth part, so that they are followed up to highest_followed() only.
double wave_width(const model::Process& process, double omega, double gap, double v) {
  if (process.noise.table && process.noise.has_levels())
    return wave_width_of_table(process, omega, v);
  const double rate = process.noise.rate();
  const double slowest = v < end_of_thinnest_waves(process, gap)
                             ? gap
                             : std::max(gap + process.noise.step(), rate * v / 20);
  return 4 * std::numbers::pi * slowest / std::min(omega, highest_followed(process));
}

// The element ends with those between that the waves need; `gap` is the distance from rest down to
// the nearest level. Splits elements that are too wide for the waves. Those of a level very near to
// mu_d end within the first element: only the part that has them is split for them.
std::vector<double> split_for_waves(const model::Process& process, double omega, double gap,
                                    std::vector<double> ends) {
  const double thinnest = end_of_thinnest_waves(process, gap);
  if (thinnest < ends[1]) ends.insert(ends.begin() + 1, thinnest);
  std::vector<double> split{ends.front()};
  for (std::size_t n = 1; n < ends.size(); ++n) {
    const double start = ends[n - 1], width = ends[n] - start;
    const auto pieces =
        static_cast<int>(std::ceil(width / wave_width(process, omega, gap, start) - 1e-9));
    for (int p = 1; p < pieces; ++p) split.push_back(start + width * p / pieces);
    split.push_back(ends[n]);
  }
  return split;
}

// Of the positive branch, if it is not beyond `most`.
double upper_tail(const model::Process& process, double tolerance, double most) {
  const double drop = -std::log(tolerance) + 5;  // 5: polynomial factors of the moments
  const LogDensity log_density(process, most);
  const double slope = log_density.slope;
  const auto left = [&](double v) { return log_density(v, drop); };
  double last = 0;  // with a density that counts
  for (double v : log_density.extrema) last = left(v) > 0 ? v : last;
  const double force = slope > 0 ? slope : process.noise.standard_deviation();
  double end = std::max(drop * log_density.intensity / force, 2 * last);
  const bool open = slope <= 0 || process.drag.rises_until > 0;
  while (open && left(end) > 0 && end < process.drag.reach) end *= 2;
  end = std::min(end, process.drag.reach);
  if (process.drag.is_none() || !std::isfinite(left(end)) || left(end) > 0) return end;
  std::uintmax_t iterations = 200;
  const auto bracket = boost::math::tools::toms748_solve(
      left, last, end, boost::math::tools::eps_tolerance<double>(20), iterations);
  return bracket.second;
}

// Where bodies are less fast, the forces that slow them are smaller, and of those that pulses of
// the noise overcome only these count.
double upper_tail(const model::Process& process, double tolerance) {
  constexpr int most = 20;
  double end = upper_tail(process, tolerance, kInfinity);
  for (int n = 0; n < most; ++n) {
    const double next = upper_tail(process, tolerance, end);
    if (!(next < 0.99 * end)) break;
    end = next;
  }
  return end;
}

// Of the positive branch, weighted. White noise and the weight make of the density a sum of two
// exponentials in each small range of v, of which the falling one counts.
double weighted_tail(const model::Process& process, double tolerance, double tilt) {
  constexpr double step = 0.02;
  const double drop = -std::log(tolerance) + 5, reach = process.drag.reach;
  const LogDensity log_density(process, kInfinity);
  const double d = log_density.intensity, scale = d / process.noise.standard_deviation(),
               most = std::isfinite(reach) ? reach : 1e12 * scale;
  double v = 1e-3 * scale, fallen = 0;
  while (fallen < drop && v < most) {
    const double force = log_density.slope - process.drag(v), rate = force / d;
    const double square = rate * rate - 4 * tilt * v / d;
    fallen = force > 0 && square > 0 ? fallen + step * v * std::sqrt(square) : 0;
    v *= 1 + step;
  }
  return fallen < drop ? std::max(reach, most) : v;
}

// By which elements are as long as log-density lets them. Noise of continuous paths turns bodies as
// that at the peak of its spectrum does; that at zero frequency, of narrow bands far less, would
// make elements as many times too short.
double intensity_along(const model::Process& process) {
  const auto& noise = process.noise;
  return noise.continuous() ? noise.tail_intensity() : noise.intensity();
}

// Local decay rate of log-density in white noise of intensity D, (F(v) - b(v))/D, or of its growth.
// A mean force g changes it by -g on one velocity branch and by g on the other; elements serve
// both. With weights exp(s x(t)), |s| up to `tilt`, log of E[exp(s x(t))] rises with v by about s
// times the time until a body rests, which may make of a rare branch the one that counts.
double decay_rate(const model::Process& process, double v, double tilt = 0) {
  const double drag =
      process.drag.odd() ? -process.drag(v) : std::max(-process.drag(v), process.drag(-v));
  const double rest = std::max(process.friction.at_rest(), process.friction.mirrored().at_rest());
  const double slowing = std::abs(rest + drag) + std::abs(process.mean_force());
  constexpr double steeper = 4;
  return std::max(slowing / intensity_along(process), steeper * tilt * v / slowing);
}

// Where geometric growth stops because an element would span more than `decay` of log-density.
double graded_end(const model::Process& process, const MeshRule& rule) {
  const double growth = 1 / rule.ratio() - 1;
  const auto spare = [&](double v) {
    return rule.decay - growth * v * decay_rate(process, v, rule.rates.tilt);
  };
  if (spare(rule.v_max) >= 0) return rule.v_max;
  std::uintmax_t iterations = 200;
  const auto bracket = boost::math::tools::toms748_solve(
      spare, 0.0, rule.v_max, boost::math::tools::eps_tolerance<double>(20), iterations);
  return bracket.first;
}

// Distance from F(0+) - g down to the nearest level below it, for levels that can come to rest on
// the positive velocity branch.
double upper_gap_below(const model::Process& process) {
  const auto& noise = process.noise;
  const int level = noise.last_up_to(process.friction.at_rest() - process.bias);
  for (int i = std::min(level + 1, noise.highest()); i >= std::max(level - 1, noise.lowest());
       --i) {
    if (process.net_force(i) < 0) return -process.net_force(i);
  }
  return noise.step();
}

// The smaller one of the two velocity branches.
double gap_below(const model::Process& process) {
  return std::min(upper_gap_below(process), upper_gap_below(process.mirrored()));
}

// Where the drag has changed the speed of the level at the distance `gap` below rest by as much: on
// the scale of its slope at rest c = -b'(0), or where a rising law first balances it.
double speed_of_bend(const model::Drag& drag, double gap) {
  if (drag.rises_until == 0) return gap / std::abs(drag.slope_at_rest());
  const auto balances = drag.balances(-gap);
  return balances.empty() ? kInfinity : balances.front();
}

// At lambda = 0 two layers can form at v = 0. The kinetic layer around x = mu_d mixes levels delta
// apart, at speeds about delta, in the time 1/Lambda between jumps: 0.6 delta/Lambda is fine enough
// at every degree tried. A level at a distance g below mu_d comes to rest
// through the factor (1 + v/s)^(-Lambda/c), s = g/c, c = -b'(0): with fast jumps it is over before
// it matters (the first test), with slow ones it is a feature of its own on the scale s.
double free_layer(const model::Process& process) {
  const auto& noise = process.noise;
  const double kinetic = 0.6 * noise.step() / noise.rate();
  const double gap = gap_below(process);
  double rest = speed_of_bend(process.drag, gap);
  if (!process.drag.odd()) rest = std::min(rest, speed_of_bend(process.drag.mirrored(), gap));
  if (rest >= kinetic) return kinetic;
  const double left = std::log(rest / kinetic) * noise.rate() * rest / gap;
  return left < std::log(1e-16) ? kinetic : rest;
}

// Bodies that rest within about 1/lambda do so through u = exp(-(Lambda + lambda) v/g) on levels at
// a distance g below mu_d. The level nearest to mu_d has the thinnest layer, and a share about
// q = (lambda/Lambda)(g/delta) of what comes to rest: unresolved it was seen in the 12th digit
// where q was 0.1, and not at all below 0.01. Then the layer of the next level decides.
double killed_layer(const model::Process& process, double lambda) {
  const auto& noise = process.noise;
  const double rate = noise.rate(), gap = gap_below(process);
  const bool counts = lambda * gap > 1e-3 * rate * noise.step();
  return (counts ? gap : gap + noise.step()) / (rate + lambda);
}

// Speed that a body which leaves v = 0 has when the noise might turn it back: at the net force g it
// does so after the time g^2/D, D = Lambda delta^2 the diffusivity of the noise. On the branch
// where that is less.
double speed_of_leaving(const model::Process& process) {
  const auto cubed = [](const model::Process& branch) {
    if (!branch.starts_upwards()) return kInfinity;
    return std::pow(branch.net_force(branch.highest_static() + 1), 3);
  };
  const double step = process.noise.step();
  return 0.6 * std::min(cubed(process), cubed(process.mirrored())) /
         (process.noise.rate() * step * step);
}

// Elements graded towards a place where the solution is like |v - v*|^power, for an error below the
// tolerance: that of the smallest one is its length to the power + 1.
int layers_towards(double power, const MeshRule& rule) {
  const double needed = std::log(rule.tolerance) / ((1 + power) * std::log(rule.ratio()));
  return std::max(1, static_cast<int>(std::ceil(needed)));
}

constexpr double kSmooth = 10;  // powers from which on elements of any length do
// The power in v with which solutions are rough below all other scales, kSmooth at most. A level of
// no net force there is left at the speed b'(0) v, or at once where b is like a root of v.
double power_at_rest(const model::Process& process) {
  const auto& [noise, friction, drag, bias, stiffness] = process;
  const double exponent = friction.weakens() ? friction.stribeck->exponent : 1;
  const double power = exponent == std::round(exponent) ? kSmooth : 1 + exponent;
  const double slope = drag.slope_at_rest();
  const int below = noise.last_up_to(friction.at_rest() - bias),
            level = std::clamp(below, noise.lowest(), noise.highest());
  if (drag.rises_until == 0 || process.net_force(level) != 0) return power;
  if (exponent < 1) return 1 - exponent;
  return slope > 0 && exponent == 1 ? std::min(kSmooth, noise.rate() / slope) : power;
}

/// Elements towards a place, by place.
using Layers = std::map<double, int>;

// Where a level does not move but is left for both sides, at speeds beta (v - v*) with beta > 0, on
// either branch: solutions are like |v - v*|^(Lambda/beta).
Layers partings(const model::Process& process, const MeshRule& rule, bool on_both = true) {
  constexpr double smallest = 1e-12;
  const auto& [noise, friction, drag, bias, stiffness] = process;
  const double end = std::min(rule.v_max, drag.rises_until), rest = friction.at_rest() - bias;
  Layers found;
  if (!(end > 0)) return found;
  double next = smallest * end;
  for (double high : drag.speeds(next, end)) {
    const double low = std::exchange(next, high);
    const double from = drag(low), rise = drag(high) - from;
    if (!(rise > 0)) continue;
    for (int i = std::min(noise.last_up_to(rest - from), noise.highest());
         i >= noise.lowest() && process.net_force(i) + from + rise > 0; --i) {
      const double force = process.net_force(i);
      if (force + from > 0) continue;
      const auto speed = [force, &b = drag](double v) { return force + b(v); };
      const boost::math::tools::eps_tolerance<double> rounding(52);
      std::uintmax_t iterations = 200;
      const double v =
          boost::math::tools::toms748_solve(speed, low, high, rounding, iterations).first;
      const double near = 1e-6 * v, slope = (drag(v + near) - drag(v - near)) / (2 * near);
      const double power = slope > 0 ? model::change_rates(noise, i).most / slope : kSmooth;
      if (v < rule.v_max && power < kSmooth) found[v] = layers_towards(power, rule);
    }
  }
  if (on_both && !process.symmetric()) found.merge(partings(process.mirrored(), rule, false));
  return found;
}

// Without regard to what the drag and the integrands are like.
std::vector<double> regular_ends(const model::Process& process, const MeshRule& rule) {
  const double tilt = rule.rates.tilt;
  const LogDensity upper(process, rule.v_max), lower(process.mirrored(), rule.v_max);
  // decay_rate(). Without weights, beyond the speeds that bodies reach on both velocity branches
  // that of the branch on which they do, where the next element may end.
  const auto rate = [&](double v) {
    constexpr double nothing = -45;  // below all rounding
    const double both = decay_rate(process, v, tilt), up = upper(v), down = lower(v);
    if (tilt > 0) return both;
    if (std::max(up, down) < nothing || std::min(up, down) > nothing) return both;
    const LogDensity& counts = up > down ? upper : lower;
    const double own = std::abs(counts.slope - counts.drag(v / rule.ratio()));
    return std::min(both, own / intensity_along(process));
  };
  const int layers = rule.layers > 0 ? rule.layers : natural_layers(process, rule);
  const double graded = graded_end(process, rule);
  std::vector<double> ends{0};
  for (int n = layers - 1; n >= 0; --n) ends.push_back(graded * std::pow(rule.ratio(), n));
  while (ends.back() < rule.v_max) {
    const double width =
        std::min(rule.decay / rate(ends.back()), ends.back() * (1 / rule.ratio() - 1));
    const double next = ends.back() + width;
    // A remainder much shorter than its neighbour is merged into it.
    ends.push_back(next + 0.3 * width >= rule.v_max ? rule.v_max : next);
  }
  return has_waves(process, rule.rates.omega)
             ? split_for_waves(process, rule.rates.omega, gap_below(process), ends)
             : ends;
}

// A regular end that would leave a sliver beside a break gives way to it.
std::set<double> with_breaks(const std::vector<double>& regular, const Layers& breaks) {
  constexpr double sliver = 0.2;
  std::set<double> ends;
  for (const auto& [v, layers] : breaks) ends.insert(v);
  for (std::size_t n = 0; n < regular.size(); ++n) {
    const bool inner = n > 0 && n + 1 < regular.size();
    const double least = inner ? sliver * (regular[n] - regular[n - 1]) : 0;
    const bool gives_way = std::any_of(breaks.begin(), breaks.end(), [&](const auto& b) {
      return std::abs(b.first - regular[n]) < least;
    });
    if (!gives_way) ends.insert(regular[n]);
  }
  return ends;
}

// Beyond a break the drag or the integrand is another one, and what happens within the next jump of
// the noise changes at once: layers as at v = 0, but weak, as nothing comes to rest there. Without
// two elements for them on either side errors fell twofold a degree (tenfold with them), at delta =
// 1/2 as at 1/64. Elements short beside v need none.
constexpr int kLayersAtBreaks = 2;
std::set<double> graded_towards(const Layers& breaks, double ratio, const std::set<double>& ends) {
  constexpr double is_short = 0.5;
  std::set<double> all = ends;
  for (const auto& [b, layers] : breaks) {
    const auto at = ends.find(b);
    for (double neighbour : {*std::prev(at), *std::next(at)}) {
      if (layers == kLayersAtBreaks && std::abs(neighbour - b) < is_short * b) continue;
      for (int n = 1; n <= layers; ++n) all.insert(b + std::pow(ratio, n) * (neighbour - b));
    }
  }
  return all;
}

// Grading makes polynomials of degree d on an element as accurate as 3^-d where functions are
// singular at v = 0 alone. What bends on a scale of its own is no better resolved by higher degrees
// until elements are as short as that scale: they are halved, the worst first, until polynomials of
// degree 7 reach 3^-7 of the largest value, both weighted with the density.
class Halving {
 public:
  Halving(const model::Process& process, const MeshRule& rule)
      : functions_(rule.integrands.functions),
        places_(rule.integrands.places),
        upper_(process, rule.v_max),
        lower_(process.mirrored(), rule.v_max) {
    if (process.drag.law) functions_.emplace_back(process.drag.law);
    if (!process.drag.odd()) functions_.emplace_back(lower_.drag.law);
    model::merge(places_, process.drag.places);
    sizes_.assign(functions_.size(), 0);
  }

  [[nodiscard]] std::vector<double> halved(const std::set<double>& given) {
    std::vector<double> ends(given.begin(), given.end());
    std::vector<Element> elements;
    for (int pass = 0; pass < 2; ++pass) {  // sizes are known after the first
      elements.clear();
      for (std::size_t e = 1; e < ends.size(); ++e) elements.push_back(seen(ends[e - 1], ends[e]));
    }
    constexpr int most = 100;
    for (int n = 0; n < most; ++n) {
      const auto worst = std::max_element(elements.begin(), elements.end());
      if (!(worst->misfit > 1)) break;
      const auto [misfit, low, high] = *worst;
      ends.push_back(low + (high - low) / 2);
      *worst = seen(low, ends.back());
      elements.push_back(seen(ends.back(), high));
    }
    std::sort(ends.begin(), ends.end());
    return ends;
  }

 private:
  struct Element {
    double misfit;  // above 1 where it is to be halved
    double low, high;
    bool operator<(const Element& other) const { return misfit < other.misfit; }
  };

  // Of the side with the larger density.
  [[nodiscard]] double weight(double v) const { return std::exp(std::max(upper_(v), lower_(v))); }

  // Inside: at a jump f has the value of one side. An error shows values between the places.
  Element seen(double low, double high) {
    static const double accepted = std::pow(3, -7);
    const double margin = 1e-6 * (high - low), middle = (low + high) / 2;
    const double at_middle = weight(middle), at_low = weight(low);
    Element element{0, low, high};
    for (std::size_t n = 0; n < functions_.size(); ++n) {
      const auto& f = functions_[n];
      const double error = model::interpolation_error(f, low + margin, high - margin, places_);
      sizes_[n] = std::fmax(sizes_[n], at_middle * std::fmax(std::abs(f(middle)), error));
      element.misfit = std::fmax(element.misfit, at_low * error / (accepted * sizes_[n]));
    }
    return element;
  }

  std::vector<model::FunctionOfSpeed> functions_;
  std::vector<double> places_;  // between which they have no features
  std::vector<double> sizes_;   // largest weighted values
  LogDensity upper_, lower_;
};

// An element at v holds a share of what is asked for that falls like v^0.8 to v (levels that it
// concerns times how far the solution is from constant there), half a digit from one element to the
// next, and a degree is worth a digit. One degree for two elements changed no error of seven cases
// in which one for one made them 10 to 1000 times larger; factors have half the entries. That is so
// for bodies that come to rest. Those that leave it pass all speeds above `speed_of_leaving`, where
// they might turn back, so that errors there multiply: at mu_d = mu_s and delta = 1/256 they were
// 1e4 times larger with degrees falling by eight, and unchanged with two. With less than degree 2
// the first refinement levels had errors above their estimates (mu_d = 0.9). Waves are as steep in
// every element, and what ends within 1/lambda before the noise changes comes from small v.
//
// In functions of path lengths bodies follow v^2 instead of v: elements graded with 0.5 instead of
// 0.3 have a hundredth of their errors at the same degree, and half as many factors again. One
// degree for three of these changed no error of four cases, one for two made some 100 times larger.
void lower_towards_rest(const model::Process& process, const MeshRule& rule,
                        const std::vector<double>& ends, std::vector<int>& degrees) {
  constexpr int most_where_left = 2;  // degrees less
  const int layers = rule.layers > 0 ? rule.layers : natural_layers(process, rule);
  const double leaving = speed_of_leaving(process);
  const int graded = std::min(layers, static_cast<int>(degrees.size()));
  const auto slow = std::count_if(ends.begin() + 1, ends.begin() + 1 + graded,
                                  [leaving](double end) { return end < leaving; });
  for (int e = 0; e < graded; ++e) {
    const int below_leaving = std::max(static_cast<int>(slow) - e, 0);
    const int less = std::min((layers - 1 - e) / rule.elements_per_degree(),
                              most_where_left + below_leaving / rule.elements_per_degree());
    degrees[e] = std::max(std::min(rule.least_degree, degrees[e]), degrees[e] - less);
  }
}

// Errors in the tail count as much as its density: half a degree for each digit below 1e-3. One for
// each, or from the first digit on, took another refinement level in every third case of weak drag.
void lower_in_tail(const model::Process& process, const MeshRule& rule,
                   const std::vector<double>& ends, std::vector<int>& degrees) {
  constexpr double free_digits = 3, degrees_per_digit = 0.5;
  constexpr int more = 2;  // than least_degree: elements are long there
  const LogDensity upper(process, rule.v_max), lower(process.mirrored(), rule.v_max);
  for (std::size_t e = 0; e < degrees.size(); ++e) {
    const double digits = -std::max(upper(ends[e]), lower(ends[e])) / std::numbers::ln10;
    const int less = std::max(0, static_cast<int>(degrees_per_digit * (digits - free_digits)));
    degrees[e] = std::max(std::min(rule.least_degree + more, degrees[e]), degrees[e] - less);
  }
}

std::vector<int> regular_degrees(const model::Process& process, const MeshRule& rule,
                                 const std::vector<double>& ends, int degree) {
  std::vector<int> degrees(ends.size() - 1, degree);
  if (has_waves(process, rule.rates.omega)) return degrees;
  const bool early = rule.rates.lambda * process.noise.correlation_time() > 1;
  if (!early) lower_towards_rest(process, rule, ends, degrees);
  if (!rule.whole_tail) lower_in_tail(process, rule, ends, degrees);
  return degrees;
}

}  // namespace

bool has_unfollowed_waves(const model::Process& process, double omega) {
  return !damps_fast_waves(process) && omega > highest_followed(process);
}

bool has_waves(const model::Process& process, double omega) {
  const auto& noise = process.noise;
  double slowest = 4 * noise.rate();
  for (int i = noise.lowest(); noise.table && i <= noise.highest(); ++i) {
    slowest = std::min(slowest, model::change_rates(noise, i).most);
  }
  return omega > slowest;
}

double tail_velocity(const model::Process& process, double tolerance, double tilt) {
  const auto of = [&](const model::Process& branch) {
    const double tail = upper_tail(branch, tolerance);
    return tilt > 0 ? std::max(tail, weighted_tail(branch, tolerance, tilt)) : tail;
  };
  const double upper = of(process);
  return process.symmetric() ? upper : std::max(upper, of(process.mirrored()));
}

double largest_speed(const model::Scene& scene) {
  constexpr double rounding = 1e-16;
  const double force = model::largest_force(scene);
  double speed =
      std::max(scene.drag.terminal_velocity(force), scene.drag.mirrored().terminal_velocity(force));
  speed = std::min(speed, tail_velocity(scene.meant(), rounding));
  return std::min(speed, scene.v_max.value_or(speed));
}

// Grading with one ratio down to the finest layer resolves exponentials of every scale alike, so
// that a large lambda asks for more elements at v = 0 and for none above.
double smallest_scale(const model::Process& process, double lambda) {
  const double free = free_layer(process);
  return lambda > 0 ? std::min(free, killed_layer(process, lambda)) : free;
}

int natural_layers(const model::Process& process, const MeshRule& rule) {
  const double span = graded_end(process, rule) / smallest_scale(process, rule.rates.lambda);
  const double power = std::min(power_at_rest(process), power_at_rest(process.mirrored()));
  const int more = power < kSmooth ? layers_towards(power, rule) : 0;
  if (span <= 1) return 1 + more;
  return 1 + more + static_cast<int>(std::ceil(std::log(span) / -std::log(rule.ratio())));
}

std::vector<double> element_ends(const model::Process& process, const MeshRule& rule) {
  Layers breaks = partings(process, rule);
  for (const auto& kinks : {rule.integrands.breaks, process.drag.breaks}) {
    for (double v : kinks) breaks.try_emplace(v, kLayersAtBreaks);
  }
  // Weights grow on beyond the speeds that bodies reach on one velocity branch alone.
  const double slower =
      std::min(process.terminal_velocity(), process.mirrored().terminal_velocity());
  if (rule.rates.tilt > 0 && slower > 0) breaks.try_emplace(slower, 1);
  const auto regular = regular_ends(process, rule);
  constexpr double rounding = 1e-9;
  std::erase_if(breaks, [&](const auto& b) { return b.first >= (1 - rounding) * regular.back(); });
  const auto ends = with_breaks(regular, breaks);
  return Halving(process, rule).halved(graded_towards(breaks, rule.ratio(), ends));
}

std::vector<int> element_degrees(const model::Process& process, const MeshRule& rule, int degree) {
  return element_degrees(process, rule, element_ends(process, rule), degree);
}

// Of the regular element in which an element ends; towards a parting degrees fall as towards v = 0.
std::vector<int> element_degrees(const model::Process& process, const MeshRule& rule,
                                 const std::vector<double>& ends, int degree) {
  const auto regular = regular_ends(process, rule);
  const auto of_regular = regular_degrees(process, rule, regular, degree);
  std::vector<int> degrees;
  for (std::size_t e = 1; e < ends.size(); ++e) {
    const auto end = std::lower_bound(regular.begin() + 1, regular.end(), ends[e]);
    degrees.push_back(of_regular[end - regular.begin() - 1]);
  }
  const int most = degree - std::min(rule.least_degree, degree),
            all = static_cast<int>(degrees.size());
  for (const auto& [v, layers] : partings(process, rule)) {
    const auto at = static_cast<int>(std::lower_bound(ends.begin(), ends.end(), v) - ends.begin());
    for (int n = 0; n < layers; ++n) {
      const int at_most = degree - std::min((layers - n) / rule.elements_per_degree(), most);
      if (at + n < all) degrees[at + n] = std::min(degrees[at + n], at_most);
      if (at - 1 - n >= 0) degrees[at - 1 - n] = std::min(degrees[at - 1 - n], at_most);
    }
  }
  return degrees;
}

}  // namespace stickslip::generator
