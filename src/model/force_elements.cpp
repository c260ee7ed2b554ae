#include "force_elements.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace stickslip::model {

using Dense = linalg::Matrix<double>;

double normal_weight(double z) { return std::exp(-z * z / 2) / std::sqrt(2 * std::numbers::pi); }

double even_weight(double) { return 1; }

LegendreRule::LegendreRule(int size) {
  std::vector<double> beside;
  for (int n = 1; n < size; ++n) beside.push_back(n / std::sqrt(4.0 * n * n - 1));
  linalg::TridiagonalEigen eigen(std::vector<double>(static_cast<std::size_t>(size), 0.0), beside);
  node = std::move(eigen.value);
  for (int n = 0; n < size; ++n) weight.push_back(2 * std::pow(eigen.vectors(0, n), 2));
}

double cardinal(const std::vector<double>& nodes, std::size_t k, double at) {
  double product = 1;
  for (std::size_t l = 0; l < nodes.size(); ++l) {
    if (l != k) product *= (at - nodes[l]) / (nodes[k] - nodes[l]);
  }
  return product;
}

Dense derivatives(const std::vector<double>& nodes) {
  const int size = static_cast<int>(nodes.size());
  std::vector<double> scale(nodes.size(), 1.0);
  for (int k = 0; k < size; ++k) {
    for (int l = 0; l < size; ++l) {
      if (l != k) scale[k] /= nodes[k] - nodes[l];
    }
  }
  Dense d(size, size);
  for (int k = 0; k < size; ++k) {
    for (int l = 0; l < size; ++l) {
      if (l == k) continue;
      d(k, l) = scale[l] / scale[k] / (nodes[k] - nodes[l]);
      d(k, k) -= d(k, l);
    }
  }
  return d;
}

ForceElement::ForceElement(double low, double high, int p, Weight weight) : z{low} {
  static const LegendreRule fine(80);
  const double middle = (low + high) / 2, half = (high - low) / 2;
  std::vector<double> points, weights, inner;
  for (std::size_t n = 0; n < fine.node.size(); ++n) {
    const double x = middle + half * fine.node[n];
    points.push_back(x);
    weights.push_back(half * fine.weight[n] * weight(x));
    inner.push_back(weights.back() * (x - low) * (high - x));
  }
  // The inner nodes are those of Gauss for the weight that vanishes at both ends.
  if (p > 1) {
    const auto found = linalg::GaussRule(points, inner, p - 1).node;
    z.insert(z.end(), found.begin(), found.end());
  }
  z.push_back(high);
  d = derivatives(z);
  // As sums of positive terms: l_k^2 has the degree 2 p, one too many, for inner nodes l_k^2 over
  // a factor that vanishes at an end has not.
  for (int k = 0; k <= p; ++k) {
    const double end = k == 0 ? high : low;
    double sum = 0;
    for (std::size_t n = 0; n < points.size(); ++n) {
      double square = weights[n] * (points[n] - end) / (z[k] - end);
      if (k > 0 && k < p) square *= (high - points[n]) / (high - z[k]);
      for (int l = 1; l < p; ++l) {
        if (l != k) square *= std::pow((points[n] - z[l]) / (z[k] - z[l]), 2);
      }
      sum += square;
    }
    w.push_back(sum);
  }
}

std::vector<SpecialForce> special_forces(const Thresholds& thresholds, double scale, double finest,
                                         double at_starts) {
  std::vector<SpecialForce> special;
  for (int side : {0, 1}) {
    const double start = thresholds.start[side] / scale, balance = thresholds.balance[side] / scale;
    const bool one = std::abs(start - balance) <= kApart, upper = side == 1;
    special.push_back({start, one ? finest : std::max(finest, at_starts), one, upper});
    if (!one) special.push_back({balance, finest, true, upper});
  }
  return special;
}

namespace {

// Towards a special point elements shrink by one factor, of about six, that ends at its size. So
// the smallest shrinks from each order to the next, and changes show its error. What spans more
// than a factor of eight in the distance to a special point is split there, what is long is cut
// into equal parts.
void split_element(const std::vector<SpecialForce>& special, double low, double high,
                   double longest, std::vector<double>& ends) {
  constexpr double usual = 6, most = 8, enough = 1.5;
  const double length = high - low;
  int graded = 0;
  double at = 0;
  for (const auto& s : special) {
    if ((s.z != low && s.z != high) || length <= enough * s.size) continue;
    ++graded;
    const double shrinks = std::log(length / s.size),
                 steps = std::max(1.0, std::round(shrinks / std::log(usual))),
                 ratio = std::exp(shrinks / steps);
    at = s.z == low ? low + length / ratio : high - length / ratio;
  }
  if (graded > 1) at = (low + high) / 2;
  for (const auto& s : special) {
    if (graded > 0 || s.z == low || s.z == high) continue;
    const double near = std::min(std::abs(low - s.z), std::abs(high - s.z)),
                 far = std::max(std::abs(low - s.z), std::abs(high - s.z));
    if (far <= most * near) continue;
    graded = 1;
    at = s.z + std::copysign(std::sqrt(near * far), low - s.z);
  }
  if (graded == 0 && length > longest) {
    graded = 1;
    at = low + length / std::ceil(length / longest);
  }
  if (graded == 0) return ends.push_back(high);
  split_element(special, low, at, longest, ends);
  split_element(special, at, high, longest, ends);
}

}  // namespace

// Far from the balance points and the end points functions are smooth. What has just come to rest
// beside a start is about to leave: times at rest need digits there.
ForceMesh force_mesh(const std::vector<SpecialForce>& special, double reach, double longest,
                     int degree, int at_rest) {
  std::vector<double> points{-reach};
  for (const auto& s : special) {
    if (std::abs(s.z) < reach) points.push_back(s.z);
  }
  points.push_back(reach);
  std::sort(points.begin(), points.end());
  ForceMesh mesh{{-reach}, {}};
  for (std::size_t n = 1; n < points.size(); ++n) {
    if (points[n] > points[n - 1])
      split_element(special, points[n - 1], points[n], longest, mesh.ends);
  }
  // What is short beside a balance point needs few digits. By distances, and not by their numbers,
  // elements gain a degree at one order or another, and never all at once.
  constexpr double least = 3, rise = 3.3;  // a degree for each such factor in the distance
  const int count = static_cast<int>(mesh.ends.size()) - 1;
  mesh.degrees.assign(static_cast<std::size_t>(count), degree);
  for (const auto& s : special) {
    for (int e = 0; e < count && s.balance; ++e) {
      const double far = std::max(std::abs(mesh.ends[e] - s.z), std::abs(mesh.ends[e + 1] - s.z)),
                   enough = least + std::max(0.0, std::log(far / s.size) / std::log(rise));
      mesh.degrees[e] = std::min(mesh.degrees[e], static_cast<int>(std::ceil(enough - 1e-9)));
    }
  }
  for (const auto& s : special) {
    for (int e = 0; e < count && !s.balance; ++e) {
      if (s.z == mesh.ends[s.upper ? e + 1 : e]) mesh.degrees[e] = at_rest;
    }
  }
  return mesh;
}

AlongForce::AlongForce(const ForceMesh& mesh, const std::vector<double>& at, Weight weight)
    : stiffness(nodes_of(mesh, at), nodes_of(mesh, at)),
      slope(stiffness.rows(), stiffness.rows()),
      weight_(weight) {
  std::vector<double> lengths;
  for (std::size_t e = 0; e < mesh.degrees.size(); ++e) {
    const bool cut = std::find(at.begin(), at.end(), mesh.ends[e]) != at.end();
    if (cut) {
      cuts.push_back(static_cast<int>(z.size()));
      lengths.push_back(mesh.ends[e + 1] - mesh.ends[e]);
    }
    append({mesh.ends[e], mesh.ends[e + 1], mesh.degrees[e], weight}, cut || e == 0);
  }
  for (std::size_t n = 0; n < cuts.size(); ++n) tie(cuts[n], lengths[n]);
}

namespace {

/// Integrals of f times each function of an element and the weight, by halves until both agree with
/// the whole. Halves of a jump never do: they end where they are too small to count.
class Halving {
 public:
  Halving(const ForceElement& element, Weight weight, const FunctionOfNoise& f)
      : element_(element), weight_(weight), f_(f) {}
  [[nodiscard]] std::vector<double> integrals() {
    constexpr int pieces = 8;  // so that what is narrower than an element is met
    const double low = element_.z.front(), length = (element_.z.back() - low) / pieces;
    std::vector<std::vector<double>> known;
    for (int n = 0; n < pieces; ++n)
      known.push_back(rule(low + n * length, low + (n + 1) * length));
    tolerance_ = 1e-10 * size_ * length;
    std::vector<double> sums(element_.z.size(), 0.0);
    for (int n = 0; n < pieces; ++n) {
      const auto piece = refined(low + n * length, low + (n + 1) * length, known[n]);
      for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += piece[k];
    }
    return sums;
  }

 private:
  std::vector<double> rule(double low, double high) {
    static const LegendreRule gauss(9);
    std::vector<double> sums(element_.z.size(), 0.0);
    for (std::size_t n = 0; n < gauss.node.size(); ++n) {
      const double z = (low + high) / 2 + gauss.node[n] * (high - low) / 2,
                   value = f_(z) * weight_(z);
      size_ = std::max(size_, std::abs(value));
      const double part = gauss.weight[n] * value * (high - low) / 2;
      for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += part * element_.cardinal(k, z);
    }
    return sums;
  }
  std::vector<double> refined(double low, double high, const std::vector<double>& whole) {
    const double middle = (low + high) / 2;
    auto lower = rule(low, middle), upper = rule(middle, high);
    double change = 0;
    for (std::size_t k = 0; k < whole.size(); ++k) {
      change = std::max(change, std::abs(lower[k] + upper[k] - whole[k]));
    }
    if (change > tolerance_ && --left_ >= 0) {
      lower = refined(low, middle, lower);
      upper = refined(middle, high, upper);
    }
    for (std::size_t k = 0; k < whole.size(); ++k) lower[k] += upper[k];
    return lower;
  }

  const ForceElement& element_;
  Weight weight_;
  const FunctionOfNoise& f_;
  double size_ = 0, tolerance_ = 0;
  int left_ = 300;  // halves, for what no piece is smooth of
};

}  // namespace

std::vector<double> AlongForce::means(const FunctionOfNoise& f) const {
  std::vector<double> sums(w.size(), 0.0);
  for (const auto& [first, element] : elements) {
    int node = first;
    for (double part : Halving(element, weight_, f).integrals()) sums[node++] += part;
  }
  for (std::size_t k = 0; k < w.size(); ++k) sums[k] /= w[k];
  return sums;
}

int AlongForce::nodes_of(const ForceMesh& mesh, const std::vector<double>& cuts) {
  return std::accumulate(mesh.degrees.begin(), mesh.degrees.end(), 1) +
         static_cast<int>(cuts.size());
}

const std::pair<int, ForceElement>& AlongForce::element_at(double force) const {
  const auto found = std::ranges::find_if(
      elements, [force](const auto& each) { return each.second.z.back() >= force; });
  return found == elements.end() ? elements.back() : *found;
}

std::vector<double> AlongForce::forces(double scale, double upper_start, double lower_start) const {
  std::vector<double> all;
  for (double place : z) all.push_back(scale * place);
  for (int node : cuts) {
    const bool upper = upper_start / scale == z[node];
    const double start = upper ? upper_start : lower_start, beyond = kApart * scale;
    all[node - 1] = upper ? start : start - beyond;
    all[node] = upper ? start + beyond : start;
  }
  return all;
}

// With a first node of its own, or that of the element before.
void AlongForce::append(const ForceElement& element, bool own) {
  const int p = element.d.rows() - 1, shared = own ? 0 : 1,
            first = static_cast<int>(z.size()) - shared;
  if (!own) w.back() += element.w[0];
  z.insert(z.end(), element.z.begin() + shared, element.z.end());
  w.insert(w.end(), element.w.begin() + shared, element.w.end());
  for (int k = 0; k <= p; ++k) {
    for (int l = 0; l <= p; ++l) {
      slope(first + k, first + l) += element.w[k] * element.d(k, l);
      for (int n = 0; n <= p; ++n) {
        stiffness(first + l, first + n) += element.w[k] * element.d(k, l) * element.d(k, n);
      }
    }
  }
  elements.emplace_back(first, element);
}

// A jump costs that much more than a change within the element: results are off by its inverse,
// and rounding grows with it.
void AlongForce::tie(int node, double length) {
  constexpr double penalty = 1e9;
  const double rate = penalty / length * std::sqrt(w[node] * w[node - 1]);
  for (const auto& [r, c] : {std::pair{node, node - 1}, {node - 1, node}}) {
    stiffness(r, c) -= rate;
    stiffness(r, r) += rate;
  }
}

}  // namespace stickslip::model
