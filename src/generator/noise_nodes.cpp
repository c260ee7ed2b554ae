#include "stickslip/generator/noise_nodes.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>

namespace stickslip::generator {
namespace {

/// Where groups of the levels i >= 1 end and towards which they shrink, in levels.
class SpecialPoints {
 public:
  SpecialPoints(const model::Process& process, const std::vector<double>& more) {
    const auto& noise = process.noise;
    const auto mirrored = process.mirrored();
    const auto standing = [](const model::Process& branch) {
      return branch.noise.place(branch.friction.at_rest() - branch.bias);
    };
    const double mu_s = process.friction.mu_s;
    graded_ = {standing(process), -standing(mirrored), process.highest_static() + 0.5,
               process.lowest_static() - 0.5};
    for (double x : more) graded_.push_back(noise.place(x));
    ends_ = {noise.last_up_to(mu_s) + 0.5, noise.first_from(-mu_s) - 0.5};
    for (auto* points : {&graded_, &ends_}) {
      for (double& s : *points) {
        if (noise.symmetric()) s = std::abs(s);
      }
    }
    ends_.insert(ends_.end(), graded_.begin(), graded_.end());
  }

  /// Whether the levels first ... last may be one group.
  [[nodiscard]] bool allow(int first, int last, double grading) const {
    const double low = first - 0.5, high = last + 0.5;
    for (double s : ends_) {
      if (low < s && s < high) return false;
    }
    double distance = kInfinity;
    for (double s : graded_) {
      distance = std::min({distance, std::abs(low - s), std::abs(high - s)});
    }
    return last - first + 1 <= grading * distance;
  }

 private:
  std::vector<double> graded_, ends_;
};

// The weights of the levels first ... last, the largest 1: by sums of logarithms of their ratios,
// which neither overflow nor lose digits.
std::vector<double> weights_within(const model::NoiseChain& noise, int first, int last) {
  std::vector<double> w{0};
  for (int i = first + 1; i <= last; ++i) {
    w.push_back(w.back() + std::log(model::weight_ratio(noise, i)));
  }
  const double largest = *std::max_element(w.begin(), w.end());
  constexpr double least = 1e-280;
  for (double& value : w) value = std::max(std::exp(value - largest), least);
  return w;
}

std::vector<double> reversed(const std::vector<double>& values) {
  return {values.rbegin(), values.rend()};
}

}  // namespace

/// The levels i >= 1 in groups.
struct Nodes::Upper {
  Upper(const model::Process& process, const Grouping& grouping) : noise(process.noise) {
    const SpecialPoints special(process, grouping.special);
    constexpr double rounding = 1e-9;
    const double widest = (1 - rounding) * grouping.width * noise.standard_deviation();
    const int size = grouping.degree == 0 ? std::numeric_limits<int>::max() : grouping.degree + 1;
    // What starts far out in the tail passes levels of very different weights alike, and against
    // these it is a polynomial on short groups alone.
    constexpr double far = -32, most_of_weight = 8;
    double weight = 0;  // of a level, in the logarithm
    for (int first = 1; first <= noise.highest();) {
      int last = first;
      const double at_first = weight;
      while (grouping.degree > 0 && last < noise.highest() &&
             noise.level(last + 1) - noise.level(first) < widest &&
             special.allow(first, last + 1, grouping.grading)) {
        const double step = std::log(model::weight_ratio(noise, last + 1));
        if (weight < far && weight - at_first + step < -most_of_weight) break;
        weight += step;
        ++last;
      }
      last - first + 1 <= size ? add_levels(first, last) : add_group(first, last, size);
      first = last + 1;
      if (first <= noise.highest()) weight += std::log(model::weight_ratio(noise, first));
    }
  }

  void add_levels(int first, int last) {
    for (int i = first; i <= last; ++i) {
      groups.push_back({i, i, 0, 1, {1}, {1}, {noise.up_rate(i)}, {noise.down_rate(i)}});
      inner.emplace_back();
      x.push_back(noise.level(i));
    }
  }

  void add_group(int first, int last, int size) {
    const std::vector<double> w = weights_within(noise, first, last);
    std::vector<double> points;
    for (int i = first; i <= last; ++i) points.push_back(noise.level(i));
    linalg::GaussRule rule(points, w, size);
    const auto n = static_cast<std::size_t>(size);
    Group g{first, last, 0, size, std::move(rule.cardinal), {}, {}, {}};
    g.weight = g.value;
    for (std::size_t i = 0; i < w.size(); ++i) {
      for (std::size_t l = 0; l < n; ++l) g.weight[i * n + l] *= w[i] / rule.weight[l];
    }
    for (double t : g.row(g.weight, last)) g.to_above.push_back(t * noise.up_rate(last));
    for (double t : g.row(g.weight, first)) g.to_below.push_back(t * noise.down_rate(first));
    std::vector<double> within(n * n, 0.0);
    for (std::size_t i = 0; i + 1 < w.size(); ++i) {
      const double* step = rule.step.data() + i * n;
      const double flow = w[i] * noise.up_rate(first + static_cast<int>(i));
      for (std::size_t l = 0; l < n; ++l) {
        for (std::size_t m = 0; m < n; ++m) within[l * n + m] -= flow * step[l] * step[m];
      }
    }
    for (std::size_t l = 0; l < n; ++l) {
      for (std::size_t m = 0; m < n; ++m) within[l * n + m] /= rule.weight[l];
    }
    groups.push_back(std::move(g));
    inner.push_back(std::move(within));
    x.insert(x.end(), rule.node.begin(), rule.node.end());
  }

  model::NoiseChain noise;
  std::vector<Group> groups;
  std::vector<std::vector<double>> inner;
  std::vector<double> x;
};

Nodes::Nodes(const model::Process& process, const Grouping& grouping)
    : Nodes(process, grouping, Mirror::made) {}

Nodes::Nodes(const model::Process& process, const Grouping& grouping, Mirror mirror)
    : noise_(process.noise), grouping_(grouping) {
  if (grouping.degree > 0 && !process.noise.neighbours_only()) {
    throw std::invalid_argument("noise groups need a noise that jumps to neighbouring levels");
  }
  if (grouping.degree < 0 || !(grouping.grading > 0) || !(grouping.width > 0)) {
    throw std::invalid_argument("noise groups need a degree >= 0, a grading and a width > 0");
  }
  if (!noise_.neighbours_only()) {
    take_all_levels();
    if (mirror == Mirror::made) {
      mirrored_.reset(new Nodes(process.mirrored(), grouping, Mirror::left_out));
    }
    return;
  }
  const Upper above(process, grouping);
  if (noise_.symmetric()) {
    join(above, above);
  } else {
    Grouping seen = grouping;
    for (double& x : seen.special) x = -x;
    join(above, Upper(process.mirrored(), seen));
    if (mirror == Mirror::made) {
      mirrored_.reset(new Nodes(process.mirrored(), seen, Mirror::left_out));
    }
  }
  find_jumps();
}

// A group ends where the jumps from and to those before it do.
void Nodes::take_all_levels() {
  const int count = noise_.count();
  first_ = noise_.lowest();
  jumps_.resize(static_cast<std::size_t>(count));
  std::vector<int> reach(static_cast<std::size_t>(count));  // the furthest place either way
  for (int n = 0; n < count; ++n) {
    x_.push_back(noise_.level(first_ + n));
    const auto take = [&](std::vector<Rate>& rates, int to, double rate) {
      rates.push_back({to, rate});
      const int low = std::min(n, to - first_), high = std::max(n, to - first_);
      reach[low] = std::max(reach[low], high);
    };
    noise_.for_each_jump(first_ + n, [&](int to, double rate) { take(jumps_[n], to, rate); });
    if (!noise_.has_positions()) continue;
    carried_.emplace_back();
    noise_.for_each_carried(first_ + n, [&](int to, double rate) { take(carried_[n], to, rate); });
  }
  for (int begin = 0, furthest = 0; begin < count;) {
    int end = std::max(begin, furthest) + 1;
    const int size = end - begin;
    Group g{first_ + begin, first_ + end - 1, first_ + begin, size, {}, {}, {}, {}};
    g.value.assign(static_cast<std::size_t>(size) * static_cast<std::size_t>(size), 0.0);
    for (int l = 0; l < size; ++l) g.value[static_cast<std::size_t>(l) * (size + 1)] = 1;
    g.weight = g.value;
    group_of_.insert(group_of_.end(), static_cast<std::size_t>(size), groups_.size());
    groups_.push_back(std::move(g));
    for (int n = begin; n < end; ++n) furthest = std::max(furthest, reach[n]);
    begin = end;
  }
  for (std::size_t g = 0; g + 1 < groups_.size(); ++g) {
    Group &below = groups_[g], &above = groups_[g + 1];
    couple(below, above, below.to_above, below.carried_above, above.from_below);
    couple(above, below, above.to_below, above.carried_below, below.from_above);
  }
}

// The rates from one group to the levels of another one to which it jumps, and these levels.
void Nodes::couple(const Group& from, const Group& to, std::vector<double>& rates,
                   std::vector<double>& per_distance, std::vector<double>& levels) const {
  std::vector<int> place(static_cast<std::size_t>(to.count), -1);
  int reached = 0;
  const auto for_each = [&](auto row, auto visit) {
    for (int l = 0; l < from.count; ++l) {
      for (const auto& [node, rate] : (this->*row)(from.begin + l)) {
        if (node >= to.begin && node < to.begin + to.count) visit(l, node - to.begin, rate);
      }
    }
  };
  const auto mark = [&](int, int there, double) { place[there] = 0; };
  for_each(&Nodes::jumps, mark);
  for_each(&Nodes::carried, mark);
  for (int& p : place) p = p < 0 ? p : reached++;
  levels.assign(static_cast<std::size_t>(reached) * place.size(), 0.0);
  const auto collect = [&](auto row, std::vector<double>& sums) {
    sums.assign(static_cast<std::size_t>(from.count) * reached, 0.0);
    for_each(row, [&](int l, int there, double rate) {
      sums[static_cast<std::size_t>(l) * reached + place[there]] += rate;
      levels[static_cast<std::size_t>(place[there]) * place.size() + there] = 1;
    });
  };
  collect(&Nodes::jumps, rates);
  if (!carried_.empty()) collect(&Nodes::carried, per_distance);
}

// Around level 0, those below as the mirror shows them.
void Nodes::join(const Upper& above, const Upper& below) {
  first_ = -static_cast<int>(below.x.size());
  x_ = reversed(below.x);
  for (double& x : x_) x = -x;
  for (std::size_t g = below.groups.size(); g-- > 0;) {
    const Group& other = below.groups[g];
    groups_.push_back({-other.last, -other.first, 0, other.count, reversed(other.value),
                       reversed(other.weight), reversed(other.to_below), reversed(other.to_above)});
    inner_.push_back(reversed(below.inner[g]));
  }
  groups_.push_back({0, 0, 0, 1, {1}, {1}, {noise_.up_rate(0)}, {noise_.down_rate(0)}});
  inner_.emplace_back();
  groups_.insert(groups_.end(), above.groups.begin(), above.groups.end());
  inner_.insert(inner_.end(), above.inner.begin(), above.inner.end());
  x_.push_back(noise_.level(0));
  x_.insert(x_.end(), above.x.begin(), above.x.end());
  int next = first_;
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    groups_[g].begin = next;
    next += groups_[g].count;
    group_of_.insert(group_of_.end(), static_cast<std::size_t>(groups_[g].count), g);
  }
}

void Nodes::find_jumps() {
  jumps_.resize(x_.size());
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    const Group& here = groups_[g];
    const auto last = here.at_last(), first = here.at_first();
    const bool has_below = g > 0, has_above = g + 1 < groups_.size();
    for (int l = 0; l < here.count; ++l) {
      auto& row = jumps_[at(here.begin + l)];
      const double rise = here.to_above[l], fall = here.to_below[l];
      const auto to = [&row](const Group& other, std::span<const double> values, double rate) {
        for (int m = 0; m < other.count; ++m) row.push_back({other.begin + m, rate * values[m]});
      };
      if (has_below) to(groups_[g - 1], groups_[g - 1].at_last(), fall);
      for (int m = 0; m < here.count; ++m) {
        if (m == l) continue;
        double rate = inner_[g][static_cast<std::size_t>(l) * here.count + m];
        if (has_above) rate -= rise * last[m];
        if (has_below) rate -= fall * first[m];
        row.push_back({here.begin + m, rate});
      }
      if (has_above) to(groups_[g + 1], groups_[g + 1].at_first(), rise);
    }
  }
}

const Nodes::Group& Nodes::group_at(int level) const {
  const auto above = std::upper_bound(groups_.begin(), groups_.end(), level,
                                      [](int i, const Group& g) { return i < g.first; });
  return *(above - 1);
}

int Nodes::last_up_to(int level) const {
  if (all_levels()) return level;
  const Group& g = group_at(level);
  return g.begin + g.count - 1;
}

std::vector<Nodes::Rate> Nodes::jumps_by_tau(int node) const {
  const std::size_t number = group_of_[at(node)];
  const Group& here = groups_[number];
  const auto change = [this](double probability, double of_probability) {
    return noise_.rate_change() * probability + noise_.rate() * of_probability;
  };
  std::vector<double> own(static_cast<std::size_t>(here.count), 0.0);
  std::vector<Rate> row;
  // Of T_il times a rate from level i to level j beside it: in the group, a difference of P.
  const auto add = [&](int i, int j, double rate) {
    const double flow = here.row(here.weight, i)[node - here.begin] * rate;
    const auto from = here.row(here.value, i);
    const bool inside = j >= here.first && j <= here.last;
    for (int m = 0; m < here.count; ++m) {
      own[m] += flow * ((inside ? here.row(here.value, j)[m] : 0) - from[m]);
    }
    if (inside) return;
    const Group& other = groups_[j > i ? number + 1 : number - 1];
    const auto values = other.row(other.value, j);
    for (int m = 0; m < other.count; ++m) row.push_back({other.begin + m, flow * values[m]});
  };
  for (int i = here.first; i <= here.last; ++i) {
    if (i > noise_.lowest()) add(i, i - 1, change(noise_.down(i), noise_.down_change(i)));
    if (i < noise_.highest()) add(i, i + 1, change(noise_.up(i), noise_.up_change(i)));
  }
  for (int m = 0; m < here.count; ++m) {
    if (here.begin + m != node) row.push_back({here.begin + m, own[m]});
  }
  return row;
}

std::vector<double> Nodes::spread(std::span<const double> by_node) const {
  std::vector<double> by_level(static_cast<std::size_t>(noise_.count()), 0.0);
  for (const Group& g : groups_) {
    for (int i = g.first; i <= g.last; ++i) {
      double& sum = by_level[i - noise_.lowest()];
      const auto weights = g.row(g.weight, i);
      for (int l = 0; l < g.count; ++l) sum += weights[l] * by_node[at(g.begin + l)];
    }
  }
  return by_level;
}

}  // namespace stickslip::generator
