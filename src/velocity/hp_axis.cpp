#include "stickslip/velocity/hp_axis.hpp"

#include <algorithm>
#include <boost/math/special_functions/legendre.hpp>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace stickslip::velocity {
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
  for (int n = 0; n < size; ++n) {
    const double x = zeros[n];
    const double slope = boost::math::legendre_p_prime(size, x);
    const double w = 2 / ((1 - x * x) * slope * slope);
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

HpAxis::HpAxis(std::vector<double> ends, int degree, const model::Drag& drag)
    : reference_(degree), ends_(std::move(ends)) {
  if (ends_.size() < 2 || ends_.front() != 0 || !std::is_sorted(ends_.begin(), ends_.end())) {
    throw std::invalid_argument("element ends must rise from 0");
  }
  for (int e = 0; e < elements(); ++e) {
    const double length = ends_[e + 1] - ends_[e];
    for (int m = 0; m < reference_.size; ++m) {
      nodes_.push_back(ends_[e] + length * reference_.node[m]);
      weights_.push_back(length * reference_.weight[m]);
    }
  }
  for (double v : nodes_) drag_at_nodes_.push_back(drag(v));
  for (double v : ends_) drag_at_ends_.push_back(drag(v));
}

void HpAxis::transport(double excess, int j, TransportRow& row) const {
  const int element = j / reference_.size;
  fill(j, std::max(-(excess + drag_at_ends_[element]), 0.0), excess + drag_at_nodes_[j],
       std::max(excess + drag_at_ends_[element + 1], 0.0), row);
}

void HpAxis::transport_change(double excess, const SpeedChange& change, int j,
                              TransportRow& row) const {
  const int element = j / reference_.size;
  const bool falls = excess + drag_at_ends_[element] < 0;
  const bool rises = excess + drag_at_ends_[element + 1] > 0;
  fill(j, falls ? -change(ends_[element]) : 0, change(nodes_[j]),
       rises ? change(ends_[element + 1]) : 0, row);
}

void HpAxis::fill(int j, double down_speed, double speed_here, double up_speed,
                  TransportRow& row) const {
  const auto& r = reference_;
  const int q = r.size, element = j / q, m = j % q, first = j - m;
  const double length = ends_[element + 1] - ends_[element];
  const double lift = 1 / (r.weight[m] * length);
  const double down = down_speed * r.at_left[m] * lift, up = up_speed * r.at_right[m] * lift;
  const double speed = speed_here / length;
  const bool lowest = element == 0, highest = element == elements() - 1;

  row.entries.clear();
  if (down != 0 && !lowest) {
    for (int n = 0; n < q; ++n) row.entries.push_back({first - q + n, down * r.at_right[n]});
  }
  for (int n = 0; n < q; ++n) {
    if (n == m) continue;
    const double value = speed * r.derivative[m * q + n] - down * r.at_left[n] - up * r.at_right[n];
    row.entries.push_back({first + n, value});
  }
  if (up != 0 && !highest) {
    for (int n = 0; n < q; ++n) row.entries.push_back({first + q + n, up * r.at_left[n]});
  }
  row.inflow = lowest ? down : 0;
  row.outflow = highest ? up : 0;
}

std::vector<Entry> HpAxis::trace_at_zero() const {
  std::vector<Entry> trace;
  for (int n = 0; n < reference_.size; ++n) trace.push_back({n, reference_.at_left[n]});
  return trace;
}

std::vector<Entry> HpAxis::trace_at_top() const {
  std::vector<Entry> trace;
  const int first = (elements() - 1) * reference_.size;
  for (int n = 0; n < reference_.size; ++n) trace.push_back({first + n, reference_.at_right[n]});
  return trace;
}

std::vector<Entry> HpAxis::value_at(double v) const {
  const auto above = std::upper_bound(ends_.begin() + 1, ends_.end() - 1, v);
  const int element = static_cast<int>(above - ends_.begin()) - 1;
  const auto basis = reference_.basis((v - ends_[element]) / (ends_[element + 1] - ends_[element]));
  std::vector<Entry> value;
  for (int n = 0; n < reference_.size; ++n) {
    value.push_back({element * reference_.size + n, basis[n]});
  }
  return value;
}

double HpAxis::mass_below(std::span<const double> mass, double v) const {
  const int q = reference_.size;
  double below = 0;
  for (int e = 0; e < elements() && ends_[e] < v; ++e) {
    const auto element = mass.subspan(static_cast<std::size_t>(e) * q, q);
    if (v >= ends_[e + 1]) {
      below = std::accumulate(element.begin(), element.end(), below);
      continue;
    }
    const auto part = reference_.integral((v - ends_[e]) / (ends_[e + 1] - ends_[e]));
    for (int n = 0; n < q; ++n) below += element[n] / reference_.weight[n] * part[n];
  }
  return below;
}

}  // namespace stickslip::velocity
