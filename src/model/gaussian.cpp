#include "stickslip/model/gaussian.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <numeric>

#include "stickslip/base/text.hpp"

namespace stickslip::model {
namespace {

using Dense = linalg::Matrix<double>;

Dense transposed(const Dense& m) {
  Dense t(m.columns(), m.rows());
  for (int r = 0; r < m.rows(); ++r) {
    for (int c = 0; c < m.columns(); ++c) t(c, r) = m(r, c);
  }
  return t;
}

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

// Two passes, as one leaves rounding where vectors are nearly parallel.
void take_out(std::vector<double>& r, const std::vector<std::vector<double>>& along,
              const std::vector<std::vector<double>>& by) {
  for (int pass = 0; pass < 2; ++pass) {
    for (std::size_t k = 0; k < along.size(); ++k) {
      const double part = dot(by[k], r);
      for (std::size_t n = 0; n < r.size(); ++n) r[n] -= part * along[k][n];
    }
  }
}

}  // namespace

double power_spectral_density(const std::vector<CovarianceTerm>& terms, double omega) {
  using Complex = std::complex<double>;
  Complex sum = 0;
  for (const auto& [amplitude, decay, frequency, sine] : terms) {
    const Complex s(decay, omega);
    sum += amplitude * (s + sine * frequency) / (s * s + frequency * frequency);
  }
  return 2 * sum.real();
}

GaussianNoise::GaussianNoise(std::vector<CovarianceTerm> terms) : terms_(std::move(terms)) {
  if (terms_.empty()) throw UnfitTable(terms_.size(), "there must be at least one term");
  double variance = 0;
  for (std::size_t n = 0; n < terms_.size(); ++n) {
    const auto& [amplitude, decay, frequency, sine] = terms_[n];
    for (double value : {amplitude, decay, frequency, sine}) {
      if (!std::isfinite(value)) throw UnfitTable(n, fmt::format("{:g} must be a number", value));
    }
    if (!(decay > 0)) {
      throw UnfitTable(n, fmt::format("decay = {:g} must be positive: the noise has to forget "
                                      "itself",
                                      decay));
    }
    if (frequency < 0) {
      throw UnfitTable(n, fmt::format("frequency = {:g} must not be negative", frequency));
    }
    variance += amplitude;
  }
  if (!(variance > 0) || !std::isnormal(variance)) {
    throw UnfitTable(terms_.size(),
                     fmt::format("the amplitudes add up to the variance {:g}, which must be "
                                 "positive",
                                 variance));
  }
  deviation_ = std::sqrt(variance);
  require_spectrum();
  find_matrix();
}

// Of a rational function of few poles: a few hundred values in each decade around these show where
// it is negative.
void GaussianNoise::require_spectrum() {
  std::vector<double> places{0};
  double least = kInfinity, most = 0;
  for (const auto& term : terms_) {
    const double size = std::hypot(term.decay, term.frequency);
    least = std::min(least, term.decay);
    most = std::max(most, size);
    for (int n = -200; n <= 200; ++n) {
      places.push_back(std::abs(term.frequency + term.decay * n / 20.0));
    }
  }
  for (double omega = 1e-3 * least; omega < 1e3 * most; omega *= 1.01) places.push_back(omega);
  const double scale = deviation_ * deviation_ / most;
  for (double omega : places) {
    const double value = power_spectral_density(omega);
    peak_ = std::max(peak_, value);
    const double rounding = 1e-12 * scale / (1 + std::pow(omega / most, 2));
    if (value >= -rounding) continue;
    throw UnfitTable(
        terms_.size(),
        fmt::format("the terms have the power spectral density {:.3g} at the frequency "
                    "{:.3g}, which must not be negative",
                    value, omega));
  }
}

void GaussianNoise::find_matrix() {
  int size = 0;
  for (const auto& term : terms_) size += term.frequency > 0 ? 2 : 1;
  Dense rates(size, size);
  std::vector<double> v(static_cast<std::size_t>(size), 0.0), w = v;
  int at = 0;
  for (const auto& [amplitude, decay, frequency, sine] : terms_) {
    const double share = amplitude / (deviation_ * deviation_);
    rates(at, at) = decay;
    v[at] = 1;
    w[at++] = share;
    if (frequency == 0) continue;
    rates(at - 1, at) = -frequency;
    rates(at, at - 1) = frequency;
    rates(at, at) = decay;
    w[at++] = -share * sine;
  }
  std::vector<std::vector<double>> right{v}, left{w};
  const double fastest = rates.largest();
  while (static_cast<int>(right.size()) < size) {
    auto r = rates * right.back(), l = left.back() * rates;
    take_out(r, right, left);
    take_out(l, left, right);
    const double product = dot(r, l);
    // Terms of one decay are one term.
    if (!(std::abs(product) > 1e-24 * fastest * fastest)) break;
    const double root = std::sqrt(std::abs(product));
    for (double& value : r) value /= root;
    for (double& value : l) value *= root / product;
    right.push_back(std::move(r));
    left.push_back(std::move(l));
  }
  const int used = static_cast<int>(right.size());
  a_ = Dense(used, used);
  for (int i = 0; i < used; ++i) {
    for (int j = std::max(i - 1, 0); j <= std::min(i + 1, used - 1); ++j) {
      a_(i, j) = dot(left[i], rates * right[j]);
    }
  }
  constexpr double least = 0.005;
  const double beside = used > 1 ? std::abs(a_(0, 1)) : 0;
  if (a_(0, 0) < least * beside) {
    throw UnfitTable(
        terms_.size(),
        fmt::format("the covariance falls as {:.3g} t from t = 0, {:.2g} of what turns "
                    "the force: paths are too smooth for what is solved here. Less "
                    "than {:g} is refused",
                    a_(0, 0), a_(0, 0) / beside, least));
  }
}

namespace {

// Gauss-Lobatto rules for the normal density.

struct LegendreRule {
  std::vector<double> node, weight;  // on [-1, 1]

  explicit LegendreRule(int size) {
    std::vector<double> beside;
    for (int n = 1; n < size; ++n) beside.push_back(n / std::sqrt(4.0 * n * n - 1));
    linalg::TridiagonalEigen eigen(std::vector<double>(static_cast<std::size_t>(size), 0.0),
                                   beside);
    node = std::move(eigen.value);
    for (int n = 0; n < size; ++n) weight.push_back(2 * std::pow(eigen.vectors(0, n), 2));
  }
};

/// Nodes z and weights w of the rule with both ends, exact for polynomials of degree 2 p - 1, and
/// the derivatives D_kl of its cardinal functions l at its nodes k.
struct Element {
  std::vector<double> z, w;
  Dense d;

  Element(double low, double high, int p) : z{low}, d(p + 1, p + 1) {
    static const LegendreRule fine(80);
    const double middle = (low + high) / 2, half = (high - low) / 2;
    std::vector<double> points, weights, inner;
    for (std::size_t n = 0; n < fine.node.size(); ++n) {
      const double x = middle + half * fine.node[n];
      points.push_back(x);
      weights.push_back(half * fine.weight[n] * std::exp(-x * x / 2) /
                        std::sqrt(2 * std::numbers::pi));
      inner.push_back(weights.back() * (x - low) * (high - x));
    }
    // The inner nodes are those of Gauss for the weight that vanishes at both ends.
    if (p > 1) {
      const auto found = linalg::GaussRule(points, inner, p - 1).node;
      z.insert(z.end(), found.begin(), found.end());
    }
    z.push_back(high);
    find_derivatives();
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

  /// The cardinal function of a node.
  [[nodiscard]] double cardinal(std::size_t k, double at) const {
    double product = 1;
    for (std::size_t l = 0; l < z.size(); ++l) {
      if (l != k) product *= (at - z[l]) / (z[k] - z[l]);
    }
    return product;
  }

 private:
  void find_derivatives() {
    const int size = static_cast<int>(z.size());
    std::vector<double> scale(z.size(), 1.0);
    for (int k = 0; k < size; ++k) {
      for (int l = 0; l < size; ++l) {
        if (l != k) scale[k] /= z[k] - z[l];
      }
    }
    for (int k = 0; k < size; ++k) {
      for (int l = 0; l < size; ++l) {
        if (l == k) continue;
        d(k, l) = scale[l] / scale[k] / (z[k] - z[l]);
        d(k, k) -= d(k, l);
      }
    }
  }
};

/// Ends of elements and their degrees.
struct Mesh {
  std::vector<double> ends;
  std::vector<int> degrees;
};

struct Special {
  double z;
  double size;  // of the elements beside it
  bool balance;
};

// What spans more than a factor of eight in the distance to a special point is split there, what is
// long is cut into equal parts.
void split_element(const std::vector<Special>& special, double low, double high,
                   std::vector<double>& ends) {
  constexpr double longest = 3, ratio = 6, most = 8, enough = 1.5;
  const double length = high - low;
  int graded = 0;
  double at = 0;
  for (const auto& s : special) {
    if ((s.z != low && s.z != high) || length <= enough * s.size) continue;
    ++graded;
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
  split_element(special, low, at, ends);
  split_element(special, at, high, ends);
}

// Far from the balance points and the end points functions are smooth.
Mesh mesh_of(const std::vector<Special>& special, double reach, int degree) {
  std::vector<double> points{-reach};
  for (const auto& s : special) {
    if (std::abs(s.z) < reach) points.push_back(s.z);
  }
  points.push_back(reach);
  std::sort(points.begin(), points.end());
  Mesh mesh{{-reach}, {}};
  for (std::size_t n = 1; n < points.size(); ++n) {
    if (points[n] > points[n - 1]) split_element(special, points[n - 1], points[n], mesh.ends);
  }
  // What is short beside a balance point needs few digits.
  constexpr int least = 3;
  const int count = static_cast<int>(mesh.ends.size()) - 1;
  mesh.degrees.assign(static_cast<std::size_t>(count), degree);
  for (const auto& s : special) {
    if (!s.balance) continue;
    const auto found = std::lower_bound(mesh.ends.begin(), mesh.ends.end(), s.z);
    const int at = static_cast<int>(found - mesh.ends.begin());
    for (int e = 0; e < count; ++e) {
      const int apart = e >= at ? e - at : at - 1 - e;
      mesh.degrees[e] = std::min(mesh.degrees[e], std::max(std::min(least, degree), least + apart));
    }
  }
  return mesh;
}

/// Functions of the force on the nodes of a mesh: weights W, <Du, Dv> and <v, Du>. Nodes at cuts
/// are doubled and tied together.
struct Along {
  std::vector<double> z, w;
  Dense stiffness, slope;
  std::vector<int> cuts;                          // the upper of both nodes
  std::vector<std::pair<int, Element>> elements;  // with the first of their nodes

  Along(const Mesh& mesh, const std::vector<double>& at)
      : stiffness(nodes_of(mesh, at), nodes_of(mesh, at)),
        slope(stiffness.rows(), stiffness.rows()) {
    std::vector<double> lengths;
    for (std::size_t e = 0; e < mesh.degrees.size(); ++e) {
      const bool cut = std::find(at.begin(), at.end(), mesh.ends[e]) != at.end();
      if (cut) {
        cuts.push_back(static_cast<int>(z.size()));
        lengths.push_back(mesh.ends[e + 1] - mesh.ends[e]);
      }
      append({mesh.ends[e], mesh.ends[e + 1], mesh.degrees[e]}, cut || e == 0);
    }
    for (std::size_t n = 0; n < cuts.size(); ++n) tie(cuts[n], lengths[n]);
  }

  [[nodiscard]] static int nodes_of(const Mesh& mesh, const std::vector<double>& cuts) {
    return std::accumulate(mesh.degrees.begin(), mesh.degrees.end(), 1) +
           static_cast<int>(cuts.size());
  }

 private:
  // With a first node of its own, or that of the element before.
  void append(const Element& element, bool own) {
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
  void tie(int node, double length) {
    constexpr double penalty = 1e9;
    const double rate = penalty / length * std::sqrt(w[node] * w[node - 1]);
    for (const auto& [r, c] : {std::pair{node, node - 1}, {node - 1, node}}) {
      stiffness(r, c) -= rate;
      stiffness(r, r) += rate;
    }
  }
};

using Modes = std::vector<std::vector<int>>;

// The degrees of products of so many Hermite polynomials, below a total degree; all zero first.
Modes modes_below(int factors, int degree) {
  Modes modes;
  std::vector<int> mode(static_cast<std::size_t>(factors), 0);
  const std::function<void(int, int)> list = [&](int factor, int left) {
    if (factor == factors) return modes.push_back(mode);
    for (mode[factor] = 0; mode[factor] <= left; ++mode[factor])
      list(factor + 1, left - mode[factor]);
  };
  list(0, degree - 1);
  return modes;
}

// a of one factor.
Dense lowering(const Modes& modes, int factor) {
  const int count = static_cast<int>(modes.size());
  Dense a(count, count);
  for (int column = 0; column < count; ++column) {
    auto lower = modes[column];
    if (lower[factor]-- == 0) continue;
    const auto row = std::find(modes.begin(), modes.end(), lower) - modes.begin();
    a(static_cast<int>(row), column) = std::sqrt(lower[factor] + 1.0);
  }
  return a;
}

// Rows: modes, columns: points; orthogonal, the constant mode first. Of one factor the points are
// those of Gauss and Hermite.
Dense basis_of(int count, bool one_factor) {
  if (one_factor) {
    std::vector<double> beside;
    for (int n = 1; n < count; ++n) beside.push_back(std::sqrt(n));
    return linalg::TridiagonalEigen(std::vector<double>(static_cast<std::size_t>(count), 0.0),
                                    beside)
        .vectors;
  }
  Dense basis(count, count);
  for (int n = 0; n < count; ++n) {
    for (int m = 0; m < count; ++m) {
      basis(n, m) = std::sqrt((n == 0 ? 1.0 : 2.0) / count) *
                    std::cos(std::numbers::pi * n * (m + 0.5) / count);
    }
  }
  return basis;
}

/// The operators in coordinates 2 ... d, on the values at as many points as there are modes.
struct Across {
  Dense within;  ///< sum_ij A_ij a_j^+ a_i
  Dense up;      ///< sum_j A_1j a_j^+
  Dense down;    ///< sum_i A_i1 a_i
  std::vector<double> weight;

  Across(const Dense& a, const Modes& modes)
      : within(static_cast<int>(modes.size()), static_cast<int>(modes.size())),
        up(within),
        down(within) {
    const int factors = a.rows() - 1, count = within.rows();
    for (int i = 0; i < factors; ++i) {
      const Dense lower = lowering(modes, i);
      up += a(0, i + 1) * transposed(lower);
      down += a(i + 1, 0) * lower;
      for (int j = 0; j < factors; ++j) {
        within += a(i + 1, j + 1) * (transposed(lowering(modes, j)) * lower);
      }
    }
    const Dense basis = basis_of(count, factors == 1);
    Dense to(count, count), from(count, count);
    for (int m = 0; m < count; ++m) {
      weight.push_back(basis(0, m) * basis(0, m));
      for (int n = 0; n < count; ++n) {
        to(m, n) = basis(n, m) / basis(0, m);
        from(n, m) = basis(n, m) * basis(0, m);
      }
    }
    for (auto* part : {&within, &up, &down}) *part = to * *part * from;
  }
};

// The generator, by points across within nodes along the force; diagonals without meaning.
Dense rates_of(double decay, const Along& x, const Across& y) {
  const int along = static_cast<int>(x.w.size()), across = static_cast<int>(y.weight.size());
  Dense rates(along * across, along * across);
  for (int l = 0; l < along; ++l) {
    for (int k = 0; k < along; ++k) {
      const double diffusion = decay * x.stiffness(k, l), there = x.slope(k, l),
                   back = x.slope(l, k);
      if (k != l && diffusion == 0 && there == 0 && back == 0) continue;
      for (int n = 0; n < across; ++n) {
        for (int m = 0; m < across; ++m) {
          const double sum = (m == n ? diffusion : 0) + (k == l ? y.within(m, n) * x.w[k] : 0) +
                             y.up(m, n) * there + y.down(m, n) * back;
          rates(k * across + m, l * across + n) = -sum / x.w[k];
        }
      }
    }
  }
  return rates;
}

// A distribution over nodes is a polynomial times the normal density on each element.
Shown shown_by(const Along& x, int across, double deviation) {
  constexpr int half = 100;
  const double reach = x.z.back(), step = reach / half;
  Shown shown;
  std::size_t e = 0;
  for (int i = -half; i <= half; ++i) {
    const double z = i == half ? reach : step * i;
    while (e + 1 < x.elements.size() && x.elements[e].second.z.back() < z) ++e;
    const auto& [first, element] = x.elements[e];
    const double mass = step * std::exp(-z * z / 2) / std::sqrt(2 * std::numbers::pi);
    shown.x.push_back(deviation * z);
    shown.of.emplace_back();
    for (std::size_t k = 0; k < element.z.size(); ++k) {
      const int node = first + static_cast<int>(k);
      for (int m = 0; m < across; ++m) {
        shown.of.back().push_back({node * across + m, mass * element.cardinal(k, z) / x.w[node]});
      }
    }
  }
  return shown;
}

constexpr double kApart = 1e-9;  // of the nodes on both sides of a start, in deviations

constexpr int kMostNodes = 6000;
constexpr double kOften = 1.5;

// How far the noise turns until it is damped.
double turns(const Dense& a) { return a.rows() > 1 ? std::abs(a(0, 1)) / a(0, 0) : 0; }

/// Elements along the force, with cuts where bodies start, and modes across.
struct Layout {
  Mesh mesh;
  std::vector<double> cuts;
  double finest;  // element
  Modes modes;

  [[nodiscard]] int nodes() const {
    return Along::nodes_of(mesh, cuts) * static_cast<int>(modes.size());
  }
};

// How many modes it takes grows with how far the noise turns until it is damped. For d > 2 results
// alternate about the limit with the degree, and are compared from one to the next. Where bodies
// start at the force that balances friction, functions are like roots there, and elements shrink.
Layout layout_of(const Dense& a, double deviation, const Thresholds& thresholds, int order) {
  const int factors = a.rows() - 1;
  const int first = 2 + (turns(a) > kOften ? 2 : 0) + (turns(a) > 8 ? 2 : 0),
            across = factors == 1 ? std::max(1, first + 2 * (order - 3)) : order,
            along = factors == 0 ? std::min(order, 6 + std::max(0, order - 6) / 2)
                                 : 3 + (order - 2) / 2;
  double gap = kInfinity;
  for (int side : {0, 1}) {
    const double apart = std::abs(thresholds.start[side] - thresholds.balance[side]) / deviation;
    gap = std::min(gap, apart > kApart ? apart : 0);
  }
  // Beside a start of its own nothing steep stands; at one that is a balance point functions are
  // like roots, and down to where both are told apart.
  constexpr double least = 1e-4, at_starts = 0.3;
  const double apart = std::min(0.3 * std::pow(2, 3 - order), gap / 4),
               together = 0.1 * std::pow(4, 3 - order);
  Layout made{{}, {}, std::max({apart, together, least}), {}};
  // Beyond 5, 6 and 7 deviations lie 1e-5, 1e-7 and 1e-10 of E[X^2].
  const double reach = std::min(7.0, 3.5 + order / 2.0);
  std::vector<Special> special;
  for (int side : {0, 1}) {
    const double start = thresholds.start[side] / deviation,
                 balance = thresholds.balance[side] / deviation;
    const bool one = std::abs(start - balance) <= kApart;
    special.push_back({start, one ? made.finest : std::max(made.finest, at_starts), one});
    if (!one) special.push_back({balance, made.finest, true});
    if (std::abs(start) < reach) made.cuts.push_back(start);
  }
  made.mesh = mesh_of(special, reach, along);
  made.modes = modes_below(factors, across);
  return made;
}

}  // namespace

bool GaussianNoise::damped() const { return turns(a_) <= kOften; }

bool GaussianNoise::fits(const Thresholds& thresholds, int order) const {
  return layout_of(a_, deviation_, thresholds, order).nodes() <= kMostNodes;
}

std::shared_ptr<const LevelTable> GaussianNoise::projected(const Thresholds& thresholds,
                                                           int order) const {
  auto& known = made_[{thresholds, order}];
  if (known) return known;
  const Layout grid = layout_of(a_, deviation_, thresholds, order);
  if (grid.nodes() > kMostNodes) {
    throw UnfitTable(terms_.size(), fmt::format("the terms take {} nodes, and at most {} are taken",
                                                grid.nodes(), kMostNodes));
  }
  const Along x(grid.mesh, grid.cuts);
  const Across y(a_, grid.modes);
  Projection made;
  made.deviation = deviation_;
  made.intensity = power_spectral_density(0) / 2;
  made.peak_intensity = peak_ / 2;
  made.step = grid.finest * deviation_;
  made.rate = 2 * a_(0, 0) / (grid.finest * grid.finest);
  const auto mirrored = [](const std::array<double, 2>& at) { return at[0] == -at[1]; };
  made.even = mirrored(thresholds.start) && mirrored(thresholds.balance);
  made.reversed = made.even && a_.rows() <= 2;
  std::vector<double> force;
  for (double z : x.z) force.push_back(deviation_ * z);
  for (int node : x.cuts) {
    // The outer node is the one that does not stick.
    const bool upper = thresholds.start[1] / deviation_ == x.z[node];
    const double start = thresholds.start[upper ? 1 : 0], beyond = kApart * deviation_;
    force[node - 1] = upper ? start : start - beyond;
    force[node] = upper ? start + beyond : start;
  }
  const double total = std::accumulate(x.w.begin(), x.w.end(), 0.0);
  for (std::size_t k = 0; k < x.w.size(); ++k) {
    for (double weight : y.weight) {
      made.x.push_back(force[k]);
      made.probability.push_back(x.w[k] / total * weight);
    }
  }
  made.shown = shown_by(x, static_cast<int>(y.weight.size()), deviation_);
  const Dense rates = rates_of(a_(0, 0), x, y);
  const int count = rates.rows();
  for (int r = 0; r < count; ++r) {
    for (int c = 0; c < count; ++c) {
      // The mirror image has the same but for rounding.
      const double rate =
          made.reversed ? (rates(r, c) + rates(count - 1 - r, count - 1 - c)) / 2 : rates(r, c);
      if (r == c || rate == 0) continue;
      made.transitions.push_back({static_cast<std::size_t>(r), static_cast<std::size_t>(c), rate});
    }
  }
  return known = std::make_shared<const LevelTable>(LevelTable::of(made));
}

}  // namespace stickslip::model
