#include "stickslip/generator/velocity_methods.hpp"

#include <boost/math/special_functions/legendre.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace stickslip::generator {
namespace {

// Zeros of P_q on [-1, 1] in rising order. Boost.Math: accurate to rounding at every q.
std::vector<double> legendre_zeros(int q) {
  const std::vector<double> half = boost::math::legendre_p_zeros<double>(q);  // the zeros >= 0
  std::vector<double> zeros;
  for (auto it = half.rbegin(); it != half.rend(); ++it) {
    if (*it > 0) zeros.push_back(-*it);
  }
  zeros.insert(zeros.end(), half.begin(), half.end());
  return zeros;
}

}  // namespace

ReferenceElement::ReferenceElement(int degree) : size(degree + 1) {
  if (degree < 0) throw std::invalid_argument("polynomial degree below 0");
  const std::vector<double> zeros = legendre_zeros(size);
  for (double x : zeros) {
    const double slope = boost::math::legendre_p_prime(size, x);
    const double w = 2 / ((1 - x * x) * slope * slope);
    const auto n = node.size();
    node.push_back((1 + x) / 2);
    weight.push_back(w / 2);
    barycentric_.push_back((n % 2 ? -1 : 1) * std::sqrt((1 - x * x) * w));
  }
  derivative.resize(static_cast<std::size_t>(size) * size);
  for (int m = 0; m < size; ++m) {
    for (int n = 0; n < size; ++n) {
      if (n == m) continue;  // fixed by the zero row sum
      derivative[m * size + n] = 2 * barycentric_[n] / barycentric_[m] / (zeros[m] - zeros[n]);
    }
  }
  at_left = basis(0);
  at_right = basis(1);
}

// Second barycentric formula.
std::vector<double> ReferenceElement::basis(double t) const {
  std::vector<double> value(size, 0.0);
  const auto hit = std::find(node.begin(), node.end(), t);
  if (hit != node.end()) {
    value[hit - node.begin()] = 1;
    return value;
  }
  double sum = 0;
  for (int n = 0; n < size; ++n) sum += value[n] = barycentric_[n] / (t - node[n]);
  for (double& v : value) v /= sum;
  return value;
}

std::vector<double> ReferenceElement::integral(double t) const {
  std::vector<double> value(size, 0.0);
  for (int m = 0; m < size; ++m) {
    const auto at = basis(t * node[m]);
    for (int n = 0; n < size; ++n) value[n] += t * weight[m] * at[n];
  }
  return value;
}

HpDiscretisation::HpDiscretisation(const std::vector<double>& ends, int degree,
                                   const model::Drag& drag)
    : HpDiscretisation(ends, std::vector<int>(ends.empty() ? 0 : ends.size() - 1, degree), drag) {}

HpDiscretisation::HpDiscretisation(std::vector<double> ends, const std::vector<int>& degrees,
                                   const model::Drag& drag)
    : VelocityDiscretisation(drag) {
  ends_ = std::move(ends);
  if (ends_.size() < 2 || ends_.front() != 0 || !std::is_sorted(ends_.begin(), ends_.end())) {
    throw std::invalid_argument("element ends must rise from 0");
  }
  if (degrees.size() + 1 != ends_.size()) throw std::invalid_argument("one degree an element");
  std::map<int, std::shared_ptr<const ReferenceElement>> references;
  for (int e = 0; e < elements(); ++e) {
    auto& reference = references[degrees[e]];
    if (!reference) reference = std::make_shared<const ReferenceElement>(degrees[e]);
    finer_.try_emplace(reference->size, 2 * reference->size);
    const double length = ends_[e + 1] - ends_[e];
    elements_.push_back({reference, static_cast<int>(nodes_.size()), length});
    for (int m = 0; m < reference->size; ++m) {
      add_node(ends_[e] + length * reference->node[m], length * reference->weight[m]);
      element_of_.push_back(e);
    }
  }
  for (double v : ends_) drag_at_ends_.push_back(drag(v));
}

// Levels on which bodies hardly move at the last end reach it or turn round there, in layers as
// thin as those at v = 0: elements shrink towards it as they do towards rest.
std::pair<std::vector<double>, std::vector<int>> HpDiscretisation::below(double speed) const {
  constexpr double sliver = 0.2, ratio = 0.3;
  std::vector<double> ends;
  std::vector<int> degrees;
  for (int e = 0; e < elements() && ends_[e] < speed; ++e) {
    const bool last = e + 1 == elements() || ends_[e + 1] >= speed;
    if (last && e > 0 && speed - ends_[e] < sliver * (ends_[e] - ends_[e - 1])) break;
    ends.push_back(ends_[e]);
    degrees.push_back(elements_[e].reference->size - 1);
  }
  degrees.back() = *std::max_element(degrees.begin(), degrees.end());
  double left = ratio * (speed - ends.back());
  while (left > ends_[1]) {
    ends.push_back(speed - left);
    degrees.push_back(degrees.back());
    left *= ratio;
  }
  ends.push_back(speed);
  return {std::move(ends), std::move(degrees)};
}

// Beyond the speed the elements are those there were, but for a sliver.
std::unique_ptr<VelocityDiscretisation> HpDiscretisation::split(double speed, bool beyond) const {
  constexpr double sliver = 0.2;
  auto [ends, degrees] = below(speed);
  const int below_speed = static_cast<int>(degrees.size()) - 1;
  for (int e = 0; e < elements() && beyond; ++e) {
    const bool last = e + 1 == elements();
    if (ends_[e + 1] <= speed) continue;
    if (!last && ends_[e + 1] - speed < sliver * (ends_[e + 2] - ends_[e + 1])) continue;
    ends.push_back(ends_[e + 1]);
    degrees.push_back(elements_[e].reference->size - 1);
  }
  auto split = std::make_unique<HpDiscretisation>(std::move(ends), degrees, drag_);
  split->end_at_speed(below_speed);
  return split;
}

void HpDiscretisation::transport(double net_force, int j, TransportRow& row) const {
  const int element = element_of_[j];
  fill(j, std::max(-(net_force + drag_at_ends_[element]), 0.0), net_force + drag_at_nodes_[j],
       std::max(net_force + drag_at_ends_[element + 1], 0.0), row);
}

void HpDiscretisation::transport_change(double net_force, const SpeedChange& change, int j,
                                        TransportRow& row) const {
  const int element = element_of_[j];
  const bool falls = net_force + drag_at_ends_[element] < 0;
  const bool rises = net_force + drag_at_ends_[element + 1] > 0;
  fill(j, falls ? -change(ends_[element]) : 0, change(nodes_[j]),
       rises ? change(ends_[element + 1]) : 0, row);
}

void HpDiscretisation::fill(int j, double down_speed, double speed_here, double up_speed,
                            TransportRow& row) const {
  const int element = element_of_[j];
  const auto& [reference, first, length] = elements_[element];
  const auto& r = *reference;
  const int q = r.size, m = j - first;
  const double lift = 1 / (r.weight[m] * length);
  const double down = down_speed * r.at_left[m] * lift, up = up_speed * r.at_right[m] * lift;
  const double speed = speed_here / length;
  const bool lowest = element == 0, highest = element == elements() - 1;

  row.entries.clear();
  if (down != 0 && !lowest) append(element - 1, down, &ReferenceElement::at_right, row);
  for (int n = 0; n < q; ++n) {
    if (n == m) continue;
    const double value = speed * r.derivative[m * q + n] - down * r.at_left[n] - up * r.at_right[n];
    row.entries.push_back({first + n, value});
  }
  const bool kills = kills_above(element);
  if (up != 0 && !highest && !kills) append(element + 1, up, &ReferenceElement::at_left, row);
  row.inflow = lowest ? down : 0;
  row.outflow = highest && !kills ? up : 0;
  row.killed = kills ? up : 0;
}

void HpDiscretisation::append(int element, double factor, Trace trace, TransportRow& row) const {
  int node = elements_[element].first;
  for (const double value : (*elements_[element].reference).*trace) {
    row.entries.push_back({node++, factor * value});
  }
}

std::vector<Entry> HpDiscretisation::at_end(int element, Trace trace) const {
  return entries(element, (*elements_[element].reference).*trace);
}

std::vector<Entry> HpDiscretisation::entries(int element, std::span<const double> values) const {
  std::vector<Entry> all;
  for (int n = elements_[element].first; const double value : values) all.push_back({n++, value});
  return all;
}

std::vector<Entry> HpDiscretisation::trace_at_zero() const {
  return at_end(0, &ReferenceElement::at_left);
}

std::vector<Entry> HpDiscretisation::trace_at_top() const {
  return at_end(elements() - 1, &ReferenceElement::at_right);
}

std::vector<Entry> HpDiscretisation::value_at(double v) const {
  const auto above = std::upper_bound(ends_.begin() + 1, ends_.end() - 1, v);
  const int e = static_cast<int>(above - ends_.begin()) - 1;
  const auto& [reference, first, length] = elements_[e];
  return entries(e, reference->basis((v - ends_[e]) / length));
}

// Nodes on which a jump within an element lies otherwise than on its own see another integral.
std::vector<double> HpDiscretisation::overlooked(const std::function<double(double)>& f) const {
  std::vector<double> by_node;
  for (double v : nodes_) by_node.push_back(-f(v));
  for (int e = 0; e < elements(); ++e) {
    const auto& [reference, first, length] = elements_[e];
    const ReferenceElement& other = finer_.at(reference->size);
    for (int k = 0; k < other.size; ++k) {
      const double value = f(ends_[e] + length * other.node[k]) * other.weight[k];
      const auto basis = reference->basis(other.node[k]);
      for (int m = 0; m < reference->size; ++m) {
        by_node[first + m] += value * basis[m] / reference->weight[m];
      }
    }
  }
  return by_node;
}

double HpDiscretisation::mass_below(std::span<const double> mass, double v) const {
  double below = 0;
  for (int e = 0; e < elements() && ends_[e] < v; ++e) {
    const auto& [reference, first, length] = elements_[e];
    const auto element = mass.subspan(static_cast<std::size_t>(first), reference->size);
    if (v >= ends_[e + 1]) {
      below = std::accumulate(element.begin(), element.end(), below);
      continue;
    }
    const auto part = reference->integral((v - ends_[e]) / length);
    for (int n = 0; n < reference->size; ++n) {
      below += element[n] / reference->weight[n] * part[n];
    }
  }
  return below;
}

UpwindDiscretisation::UpwindDiscretisation(double spacing, int count, const model::Drag& drag)
    : VelocityDiscretisation(drag), spacing_(spacing) {
  if (!(spacing > 0) || count < 1)
    throw std::invalid_argument("upwind velocity discretisation without nodes");
  ends_.push_back(0);
  for (int j = 1; j <= count; ++j) {
    add_node(j * spacing, spacing);
    ends_.push_back((j + 0.5) * spacing);
  }
}

std::unique_ptr<VelocityDiscretisation> UpwindDiscretisation::split(double speed,
                                                                    bool beyond) const {
  const int steps = std::max(2, static_cast<int>(std::lround(speed / spacing_)));
  const double spacing = speed / steps;
  const int all = beyond ? static_cast<int>(std::lround(v_max() / spacing)) : 0;
  auto split = std::make_unique<UpwindDiscretisation>(spacing, std::max(steps - 1, all), drag_);
  split->end_at_speed(steps - 2);
  return split;
}

void UpwindDiscretisation::transport(double net_force, int j, TransportRow& row) const {
  const double speed = net_force + drag_at_nodes_[j];
  fill(j, speed, speed / spacing_, row);
}

void UpwindDiscretisation::transport_change(double net_force, const SpeedChange& change, int j,
                                            TransportRow& row) const {
  fill(j, net_force + drag_at_nodes_[j], change(nodes_[j]) / spacing_, row);
}

void UpwindDiscretisation::fill(int j, double direction, double rate, TransportRow& row) const {
  row.entries.clear();
  row.inflow = row.outflow = row.killed = 0;
  if (direction < 0 && j > 0) row.entries.push_back({j - 1, -rate});
  if (direction < 0 && j == 0) row.inflow = -rate;
  if (direction > 0 && j < size() - 1 && !kills_above(j)) row.entries.push_back({j + 1, rate});
  if (direction > 0 && kills_above(j)) row.killed = rate;
}

// Between two nodes; below the first one, where a cell of its own begins, its value.
std::vector<Entry> UpwindDiscretisation::value_at(double v) const {
  const double place = std::clamp(v / spacing_ - 1, 0.0, size() - 1.0);
  const int below = std::min(static_cast<int>(place), size() - 2);
  if (below < 0) return {{0, 1.0}};
  return {{below, 1 - (place - below)}, {below + 1, place - below}};
}

// A node stands for the cell around it; the mass is spread evenly over the cell.
double UpwindDiscretisation::mass_below(std::span<const double> mass, double v) const {
  double below = 0;
  for (int j = 0; j < size(); ++j) {
    const double share = (v - nodes_[j]) / spacing_ + 0.5;
    below += mass[j] * std::clamp(share, 0.0, 1.0);
  }
  return below;
}

}  // namespace stickslip::generator
