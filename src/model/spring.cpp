#include "stickslip/model/spring.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "force_elements.hpp"

namespace stickslip::model {
namespace {

using Dense = linalg::Matrix<double>;

constexpr std::size_t kMostKept = 1000000;  // pairs of what is simulated

/// Functions of the position on discontinuous elements: nodes, and derivatives along a motion to
/// either side, whose rows sum to zero. A body leaves an element at the end to which it moves. The
/// last one has no end, which is exact for polynomials; or, `bounded`, bodies that come there,
/// which none should, are put anywhere in it, so that what happens there stays bounded.
struct Positions {
  std::vector<double> p;
  Dense upwards, downwards;

  Positions(const std::vector<double>& ends, int nodes, bool bounded)
      : bounded_(bounded), ends_(ends) {
    const LegendreRule rule(nodes);
    for (int m = 0; m < nodes; ++m) {
      const int there = nodes - 1 - m;
      node_.push_back((rule.node[m] - rule.node[there]) / 2);
      weight_.push_back((rule.weight[m] + rule.weight[there]) / 2);
    }
    std::vector<double> reversed;
    for (std::size_t e = 0; e + 1 < ends.size(); ++e) {
      for (double t : node_) p.push_back((ends[e] * (1 - t) + ends[e + 1] * (1 + t)) / 2);
    }
    for (std::size_t e = ends.size(); e-- > 0;) reversed.push_back(-ends[e]);
    upwards = derivative(ends);
    const Dense mirrored = derivative(reversed);
    const int count = upwards.rows();
    downwards = Dense(count, count);
    for (int r = 0; r < count; ++r) {
      for (int c = 0; c < count; ++c) downwards(r, c) = mirrored(count - 1 - r, count - 1 - c);
    }
  }

  /// The shares of nodes in the value of a function of the position, seen from that side where
  /// elements meet (0: halfway between both); none beyond the elements.
  [[nodiscard]] std::vector<Shown::Share> value_at(double at, int side) const {
    std::vector<Shown::Share> shares;
    const double close = 1e-9 * (ends_.back() - ends_.front());
    for (std::size_t e = 0; e + 1 < ends_.size(); ++e) {
      if (at < ends_[e] - close || at > ends_[e + 1] + close) continue;
      const bool lower = at < ends_[e] + close && e > 0,
                 upper = at > ends_[e + 1] - close && e + 2 < ends_.size();
      if ((lower && side < 0) || (upper && side > 0)) continue;
      const double part = (lower || upper) && side == 0 ? 0.5 : 1,
                   t = (2 * at - ends_[e] - ends_[e + 1]) / (ends_[e + 1] - ends_[e]);
      for (std::size_t k = 0; k < node_.size(); ++k) {
        shares.push_back({static_cast<int>(e * node_.size() + k), part * cardinal(node_, k, t)});
      }
    }
    return shares;
  }

  /// By the position alone, at even steps; the node of the j-th position with n is node_of(n, j).
  template <class NodeOf>
  [[nodiscard]] Shown shown(double shift, std::size_t count, const NodeOf& node_of) const {
    constexpr int steps = 200;
    const double step = (ends_.back() - ends_.front()) / steps;
    Shown shown;
    std::size_t e = 0;
    for (int i = 0; i < steps; ++i) {
      const double at = ends_.front() + step * (i + 0.5);
      while (e + 2 < ends_.size() && at > ends_[e + 1]) ++e;
      const double half = (ends_[e + 1] - ends_[e]) / 2, t = (at - ends_[e]) / half - 1;
      shown.x.push_back(at + shift);
      auto& shares = shown.of.emplace_back();
      for (std::size_t k = 0; k < node_.size(); ++k) {
        const double share = step * cardinal(node_, k, t) / (weight_[k] * half);
        for (std::size_t n = 0; n < count; ++n) {
          shares.push_back({static_cast<int>(node_of(n, e * node_.size() + k)), share});
        }
      }
    }
    return shown;
  }

 private:
  [[nodiscard]] Dense derivative(const std::vector<double>& ends) const {
    const int q = static_cast<int>(node_.size()), elements = static_cast<int>(ends.size()) - 1;
    const Dense inner = derivatives(node_);
    Dense d(q * elements, q * elements);
    std::vector<double> left, right;
    for (std::size_t k = 0; k < node_.size(); ++k) {
      left.push_back(cardinal(node_, k, -1));
      right.push_back(cardinal(node_, k, 1));
    }
    for (int e = 0; e < elements; ++e) {
      const double half = (ends[e + 1] - ends[e]) / 2;
      for (int k = 0; k < q; ++k) {
        const bool last = e + 1 == elements;
        const double lift = last && !bounded_ ? 0 : right[k] / (half * weight_[k]);
        for (int l = 0; l < q; ++l) {
          d(e * q + k, e * q + l) += inner(k, l) / half - lift * right[l];
          if (lift == 0) continue;
          const int there = last ? e : e + 1;
          d(e * q + k, there * q + l) += lift * (last ? weight_[l] / 2 : left[l]);
        }
      }
    }
    return d;
  }

  bool bounded_;
  std::vector<double> ends_;
  std::vector<double> node_, weight_;  // of [-1, 1]
};

void append_row(std::vector<Transition>& to, std::size_t from, std::size_t there, double rate) {
  if (from != there && rate != 0) to.push_back({from, there, rate});
}

// Nodes at -z for those at z, exactly: what the mirror exchanges has the same bits.
void symmetrise(AlongForce& x) {
  const int count = static_cast<int>(x.z.size());
  const Dense stiffness = x.stiffness, slope = x.slope;
  const auto z = x.z, w = x.w;
  for (int a = 0; a < count; ++a) {
    const int there = count - 1 - a;
    x.z[a] = (z[a] - z[there]) / 2;
    x.w[a] = (w[a] + w[there]) / 2;
    for (int b = 0; b < count; ++b) {
      x.stiffness(a, b) = (stiffness(a, b) + stiffness(there, count - 1 - b)) / 2;
      x.slope(a, b) = (slope(a, b) - slope(there, count - 1 - b)) / 2;
    }
  }
}

void normalise(std::vector<double>& p) {
  const double total = std::accumulate(p.begin(), p.end(), 0.0);
  for (double& value : p) value /= total;
}

/// Elements along the force.
struct ForceLayout {
  ForceMesh mesh;
  std::vector<double> cuts;
  double finest;
};

ForceLayout forces_of(const Thresholds& thresholds, double scale, double reach, int order) {
  ForceLayout made{{}, {}, 0.4 * std::pow(0.6, order - 3)};
  constexpr double at_starts = 0.8, longest = 2.5;
  constexpr double beyond = 2.5;
  double end = reach;
  for (double force : thresholds.start) {
    made.cuts.push_back(force / scale);
    end = std::max(end, std::abs(force / scale) + beyond);
  }
  const auto special = special_forces(thresholds, scale, made.finest, at_starts);
  const int degree = 3 + (order - 2) / 2;
  made.mesh = force_mesh(special, end, longest, degree, degree);
  return made;
}

// The shares of nodes in the value at a force; none beyond the elements. Where bodies start, as
// those see it that rest there.
std::vector<Shown::Share> value_at(const AlongForce& x, double z) {
  std::vector<Shown::Share> shares;
  constexpr double inner = 1 - 1e-12;
  if (z < x.z.front() || z > x.z.back()) return shares;
  const auto& [first, element] = x.element_at(inner * z);
  for (std::size_t n = 0; n < element.z.size(); ++n) {
    shares.push_back({first + static_cast<int>(n), element.cardinal(n, z)});
  }
  return shares;
}

// The same on average over normally distributed forces.
std::vector<Shown::Share> mean_over(const AlongForce& x, double mean, double deviation) {
  const auto shares =
      x.means([&](double z) { return normal_weight((z - mean) / deviation) / deviation; });
  std::vector<Shown::Share> all;
  for (std::size_t a = 0; a < shares.size(); ++a) {
    all.push_back({static_cast<int>(a), shares[a] * x.w[a]});
  }
  return all;
}

struct Units {
  double force;  // in units of which elements end
  double stiffness, centre, deviation;
};

using ValueAt = decltype(Projection::value_at);

Means means_of_coloured(std::shared_ptr<const AlongForce> x, std::shared_ptr<const Positions> y,
                        const Units& by) {
  return [x = std::move(x), y = std::move(y), by](const FunctionOfNoise& f) {
    const auto& p = y->p;
    std::vector<double> all(x->w.size() * p.size());
    for (std::size_t j = 0; j < p.size(); ++j) {
      const auto means = x->means([&](double z) {
        return f({by.force * z + by.stiffness * p[j], p[j], by.centre});
      });
      for (std::size_t a = 0; a < means.size(); ++a) all[a * p.size() + j] = means[a];
    }
    return all;
  };
}

ValueAt values_of_coloured(std::shared_ptr<const AlongForce> x, std::shared_ptr<const Positions> y,
                           const Units& by) {
  return
      [x = std::move(x), y = std::move(y), by](std::optional<double> noise, double at, int side) {
        const double p = at - by.centre, held = by.stiffness * p;
        const auto across = static_cast<int>(y->p.size());
        std::vector<Shown::Share> all;
        for (const auto& [a, share] :
             noise ? value_at(*x, (*noise - held) / by.force)
                   : mean_over(*x, -held / by.force, by.deviation / by.force)) {
          for (const auto& [j, part] : y->value_at(p, side)) {
            all.push_back({a * across + j, share * part});
          }
        }
        return all;
      };
}

// A body at rest is seen where it is held: on the side of less force.
ValueAt values_of_chain(std::shared_ptr<const Positions> y, double stiffness, double centre,
                        std::shared_ptr<const NoiseChain> chain, std::vector<std::size_t> place) {
  const auto law = stationary_distribution(*chain);
  return [y = std::move(y), stiffness, centre, chain = std::move(chain), place = std::move(place),
          law](std::optional<double> noise, double at, int side) {
    const double p = at - centre;
    const auto found = noise ? chain->find(*noise) : std::nullopt;
    std::vector<Shown::Share> all;
    for (int n = chain->lowest(); n <= chain->highest(); ++n) {
      if (noise && n != found) continue;
      const auto level = static_cast<std::size_t>(n - chain->lowest());
      const int towards = side != 0 ? side : chain->level(n) > stiffness * p ? 1 : -1;
      for (const auto& [j, part] : y->value_at(p, towards)) {
        const auto node = place[level * y->p.size() + static_cast<std::size_t>(j)];
        all.push_back({static_cast<int>(node), noise ? part : law[level] * part});
      }
    }
    return all;
  };
}

// Of positions, by order.
int nodes_of_element(int order) { return order + 1; }

}  // namespace

Spring::Spring(Body body, const Coloured& noise) : body_(std::move(body)), noise_(noise) {
  scales_ = find_scales();
}

Spring::Spring(Body body, const NoiseChain& chain)
    : body_(std::move(body)),
      noise_{chain.standard_deviation(), chain.correlation_time()},
      chain_(std::make_shared<const NoiseChain>(chain)) {
  const double width = chain.level(chain.highest()) - chain.level(chain.lowest()),
               held = body_.friction.mu_s + body_.friction.mirrored().mu_s;
  if (width <= held) {
    throw UnfitTable(
        0, fmt::format("all levels of the noise, which are {:g} apart from the lowest to the "
                       "highest, hold the body at positions between: it comes to rest there "
                       "for ever, P_stick = 1 and V = 0",
                       width));
  }
  scales_ = find_scales();
}

// The variances of p, v and dv/dt + c v under exponentially correlated noise, in closed form: those
// of a linear equation of third order driven by white noise.
Spring::Scales Spring::find_scales() const {
  const double a = 1 / noise_.tau, k = body_.stiffness,
               white = 2 * a * noise_.deviation * noise_.deviation;
  const auto taken = [&](double v) {
    const auto other = body_.friction.mirrored();
    const double friction = (body_.friction(v) + other(v)) / 2 * std::sqrt(2 / std::numbers::pi),
                 drag = (body_.drag(-v) - body_.drag(v)) / 2;
    return (friction + drag) / v;
  };
  Scales s{0, noise_.deviation / std::sqrt(k), 0, 0};
  constexpr int steps = 300;
  for (int n = 0; n < steps; ++n) {
    s.drag = n == 0 ? taken(s.velocity) : 0.7 * s.drag + 0.3 * taken(s.velocity);
    const double c = s.drag, d0 = k * a, d1 = k + a * c, d2 = a + c, gap = d1 * d2 - d0;
    s.position = std::sqrt(white * d2 / (2 * d0 * gap));
    s.velocity = std::sqrt(white / (2 * gap));
    s.force = std::sqrt(white * (d1 + c * c) / (2 * gap));
  }
  return s;
}

// The amplitude of an oscillation, driven as hard as in the stationary state, loses what drag and
// friction take: its density falls like exp(-(c r^2/2 + 4 F r/(pi s))/c_eq) at r deviations s.
double Spring::reach(int order) const {
  const double s = scales_.velocity, fall = 6 + 1.8 * order,
               friction = std::min(body_.friction(s), body_.friction.mirrored()(s)),
               square =
                   std::max(0.0, scales_.drag - friction * std::sqrt(2 / std::numbers::pi) / s) /
                   (2 * scales_.drag),
               linear = 4 * friction / (std::numbers::pi * s * scales_.drag);
  if (square < 1e-9) return fall / linear;
  return 2 * fall / (linear + std::sqrt(linear * linear + 4 * square * fall));
}

std::vector<double> Spring::ends_of_positions(const Thresholds& thresholds, int order) const {
  const double reach_of_energy = reach(order) * scales_.position;
  if (!chain_) {
    constexpr double longest = 9;  // deviations
    const int half = static_cast<int>(std::ceil(reach(order) / longest));
    std::vector<double> ends;
    for (int e = -half; e <= half; ++e) ends.push_back(reach_of_energy * e / half);
    return ends;
  }
  const double k = body_.stiffness, low = chain_->level(chain_->lowest()),
               high = chain_->level(chain_->highest()), middle = (low + high) / 2;
  double most = reach_of_energy + std::abs(chain_->mean() - middle) / k;
  if (body_.drag.is_linear()) {
    // A body that swings as far as levels drive it which take turns at the worst times.
    const double c = body_.drag.linear, turn = k - c * c / 4,
                 left = turn > 0 ? std::exp(-std::numbers::pi * c / (2 * std::sqrt(turn))) : 0;
    if (left < 1) most = std::min(most, (high - low) / 2 * (1 + left) / (1 - left) / k);
  }
  const double longest = 2 * scales_.position / order, apart = 1e-6 * most;
  std::vector<double> places{middle / k - most, middle / k, middle / k + most};
  for (int n = chain_->lowest(); n <= chain_->highest(); ++n) {
    for (const auto* pair : {&thresholds.start, &thresholds.balance}) {
      for (double threshold : *pair) places.push_back((chain_->level(n) - threshold) / k);
    }
  }
  std::ranges::sort(places);
  std::vector<double> ends;
  for (double place : places) {
    if (std::abs(place - middle / k) > most * (1 + 1e-9)) continue;
    if (!ends.empty() && place - ends.back() < apart) continue;
    if (!ends.empty()) {
      const double from = ends.back();
      const int parts = static_cast<int>(std::ceil((place - from) / longest));
      for (int part = 1; part < parts; ++part) ends.push_back(from + (place - from) * part / parts);
    }
    ends.push_back(place);
  }
  for (std::size_t n = 0; chain_->even() && 2 * n < ends.size(); ++n) {
    const double half = (ends[ends.size() - 1 - n] - ends[n]) / 2;
    ends[n] = -half;
    ends[ends.size() - 1 - n] = half;
  }
  return ends;
}

// By the force of the noise alone, at its even steps: f = X - K p at each position.
Shown Spring::shown_by(const AlongForce& x, const std::vector<double>& positions) const {
  const double scale = scales_.force, k = body_.stiffness;
  const std::size_t across = positions.size();
  Shown shown;
  constexpr int half = 100;
  const double step = 6 * noise_.deviation / half;
  for (int i = -half; i <= half; ++i) {
    shown.x.push_back(step * i);
    auto& shares = shown.of.emplace_back();
    for (std::size_t j = 0; j < across; ++j) {
      const double z = (step * i - k * positions[j]) / scale;
      if (z < x.z.front() || z > x.z.back()) continue;
      const auto& [first, element] = x.element_at(z);
      for (std::size_t n = 0; n < element.z.size(); ++n) {
        const std::size_t node = static_cast<std::size_t>(first) + n;
        shares.push_back({static_cast<int>(node * across + j),
                          step * element.cardinal(n, z) / (x.w[node] * scale)});
      }
    }
  }
  return shown;
}

Projection Spring::of_coloured(const Thresholds& thresholds, int order) const {
  const double scale = scales_.force, k = body_.stiffness;
  const ForceLayout grid = forces_of(thresholds, scale, reach(order), order);
  const auto kept = std::make_shared<AlongForce>(grid.mesh, grid.cuts, even_weight);
  AlongForce& x = *kept;
  const auto kept_y = std::make_shared<const Positions>(ends_of_positions(thresholds, order),
                                                        nodes_of_element(order), false);
  const Positions& y = *kept_y;
  Projection made;
  made.even = made.reversed = thresholds.alike_both_ways();
  if (made.even) symmetrise(x);
  const auto force = x.forces(scale, thresholds.start[1], thresholds.start[0]);
  const std::size_t along = force.size(), across = y.p.size();
  const double diffusion = noise_.deviation * noise_.deviation / noise_.tau / (scale * scale);
  for (std::size_t a = 0; a < along; ++a) {
    const bool first = a == 0, last = a + 1 == along;
    for (std::size_t j = 0; j < across; ++j) {
      const std::size_t from = a * across + j;
      const double noise = force[a] + k * y.p[j];
      double drift = -noise / noise_.tau;
      if (first) drift = std::max(drift, 0.0);
      if (last) drift = std::min(drift, 0.0);
      for (std::size_t b = 0; b < along; ++b) {
        const int r = static_cast<int>(a), c = static_cast<int>(b);
        if (x.stiffness(r, c) == 0 && x.slope(r, c) == 0) continue;
        const double slope = x.slope(r, c) / (x.w[a] * scale);
        append_row(made.transitions, from, b * across + j,
                   drift * slope - diffusion * x.stiffness(r, c) / x.w[a]);
        append_row(made.upwards, from, b * across + j, first ? 0 : -k * slope);
        append_row(made.downwards, from, b * across + j, last ? 0 : k * slope);
      }
      for (std::size_t i = 0; i < across; ++i) {
        const int r = static_cast<int>(j), c = static_cast<int>(i);
        append_row(made.upwards, from, a * across + i, y.upwards(r, c));
        append_row(made.downwards, from, a * across + i, y.downwards(r, c));
      }
      made.x.push_back(force[a]);
      made.position.push_back(y.p[j] + body_.bias / k);
      made.noise.push_back(noise);
      const double there = y.p[j] / scales_.position;
      made.probability.push_back(std::exp(-(x.z[a] * x.z[a] + there * there) / 2) + 1e-9);
    }
  }
  normalise(made.probability);
  made.deviation = noise_.deviation;
  made.intensity = made.peak_intensity = noise_.deviation * noise_.deviation * noise_.tau;
  made.step = grid.finest * scale;
  made.rate = 2 * diffusion / (grid.finest * grid.finest);
  made.centre = body_.bias / k;
  const Units units{scale, k, made.centre, noise_.deviation};
  made.means = means_of_coloured(kept, kept_y, units);
  made.value_at = values_of_coloured(kept, kept_y, units);
  made.shown = shown_by(x, y.p);
  made.by_position = y.shown(made.centre, along,
                             [across](std::size_t a, std::size_t j) { return a * across + j; });
  return made;
}

Projection Spring::of_chain(const Thresholds& thresholds, int order) const {
  const double k = body_.stiffness;
  const auto kept_y = std::make_shared<const Positions>(ends_of_positions(thresholds, order),
                                                        nodes_of_element(order), true);
  const Positions& y = *kept_y;
  const std::size_t levels = static_cast<std::size_t>(chain_->count()), across = y.p.size();
  const auto p = stationary_distribution(*chain_);
  struct Node {
    double x;
    std::size_t level, j;
  };
  std::vector<Node> nodes;
  for (std::size_t n = 0; n < levels; ++n) {
    const double x = chain_->level(chain_->lowest() + static_cast<int>(n));
    for (std::size_t j = 0; j < across; ++j) nodes.push_back({x - k * y.p[j], n, j});
  }
  std::ranges::stable_sort(nodes, [](const Node& a, const Node& b) {
    return std::tie(a.x, a.level) < std::tie(b.x, b.level);
  });
  std::vector<std::size_t> place(nodes.size());
  for (std::size_t m = 0; m < nodes.size(); ++m) place[nodes[m].level * across + nodes[m].j] = m;
  Projection made;
  made.continuous = false;
  made.even = thresholds.alike_both_ways() && chain_->even();
  made.reversed = made.even && chain_->even_in_order();
  for (std::size_t m = 0; m < nodes.size(); ++m) {
    const auto& [x, level, j] = nodes[m];
    const int here = chain_->lowest() + static_cast<int>(level);
    chain_->for_each_jump(here, [&, j = j, m = m](int to, double rate) {
      const auto there = static_cast<std::size_t>(to - chain_->lowest());
      append_row(made.transitions, m, place[there * across + j], rate);
    });
    for (std::size_t i = 0; i < across; ++i) {
      const int r = static_cast<int>(j), c = static_cast<int>(i);
      const std::size_t to = place[level * across + i];
      append_row(made.upwards, m, to, y.upwards(r, c));
      append_row(made.downwards, m, to, y.downwards(r, c));
    }
    made.x.push_back(x);
    made.position.push_back(y.p[j] + body_.bias / k);
    made.noise.push_back(chain_->level(here));
    made.probability.push_back(p[level]);
  }
  normalise(made.probability);
  made.deviation = chain_->standard_deviation();
  made.intensity = chain_->intensity();
  made.peak_intensity = chain_->tail_intensity();
  made.centre = body_.bias / k;
  made.value_at = values_of_chain(kept_y, k, made.centre, chain_, place);
  made.step = chain_->step();
  made.rate = chain_->rate();
  made.by_position = y.shown(made.centre, levels, [&](std::size_t level, std::size_t j) {
    return place[level * across + j];
  });
  return made;
}

bool Spring::fits(const Thresholds& thresholds, int order) const {
  return pairs(thresholds, order) <= kMostPairs;
}

std::size_t Spring::pairs(const Thresholds& thresholds, int order) const {
  const std::size_t across = (ends_of_positions(thresholds, order).size() - 1) *
                             static_cast<std::size_t>(nodes_of_element(order));
  std::size_t along = chain_ ? static_cast<std::size_t>(chain_->count()) : 0;
  if (!chain_) {
    const ForceLayout grid = forces_of(thresholds, scales_.force, reach(order), order);
    along = static_cast<std::size_t>(AlongForce::nodes_of(grid.mesh, grid.cuts));
  }
  return along * across;
}

Projection Spring::projection(const Thresholds& thresholds, int order) const {
  if (pairs(thresholds, order) > kMostKept) {
    throw UnfitTable(0,
                     fmt::format("takes more than {} pairs of a force and a position", kMostKept));
  }
  return chain_ ? of_chain(thresholds, order) : of_coloured(thresholds, order);
}

}  // namespace stickslip::model
