#include "stickslip/model/gaussian.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <numeric>

#include "force_elements.hpp"
#include "moved_nodes.hpp"
#include "stickslip/base/text.hpp"

namespace stickslip::model {
namespace {

using Dense = linalg::Matrix<double>;

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
Dense rates_of(double decay, const AlongForce& x, const Across& y) {
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
Shown shown_by(const AlongForce& x, int across, double deviation) {
  constexpr int half = 100;
  const double reach = x.z.back(), step = reach / half;
  Shown shown;
  for (int i = -half; i <= half; ++i) {
    const double z = i == half ? reach : step * i;
    const auto& [first, element] = x.element_at(z);
    const double mass = step * normal_weight(z);
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

constexpr int kMostNodes = 6000;
constexpr double kOften = 1.5;

// How far the noise turns until it is damped.
double turns(const Dense& a) { return a.rows() > 1 ? std::abs(a(0, 1)) / a(0, 0) : 0; }

/// Elements along the force, with cuts where bodies start, and modes across.
struct Layout {
  ForceMesh mesh;
  std::vector<double> cuts;
  double finest;  // element
  Modes modes;

  [[nodiscard]] int nodes() const {
    return AlongForce::nodes_of(mesh, cuts) * static_cast<int>(modes.size());
  }
};

// Modes across, and the order of the elements along the force that goes with them. Errors of modes
// fall the more slowly the further the noise turns until it is damped, and elements that were finer
// than that would take most of the time. Where bodies start close to the force that balances
// friction, functions are steep between both, and elements count as much as modes.
struct Counts {
  int across;
  double along;

  Counts(const Dense& a, int order, double gap) : across(order), along(order) {
    const int factors = a.rows() - 1;
    if (factors == 0) {
      across = 1;
      return;
    }
    constexpr double wide = 0.7;  // [deviation]
    double share = 0.5;           // of what one order brings without modes
    if (factors == 1) {
      const int first = 2 + (turns(a) > kOften ? 2 : 0) + (turns(a) > 8 ? 2 : 0);
      across = std::max(1, first + 2 * (order - 3));
      share = std::clamp(1.8 / turns(a), 0.2, 1.0);
    }
    const double steep = std::max(0.0, std::log2(wide / gap));
    along = std::max(2.0, std::min<double>(order, 2 + share * (order - 3) + steep));
  }
};

// For d > 2 results alternate about the limit with the degree, and are compared from one to the
// next. Where bodies start at the force that balances friction, functions are like roots, and
// elements shrink.
Layout layout_of(const Dense& a, double deviation, const Thresholds& thresholds, int order) {
  double gap = kInfinity;
  for (int side : {0, 1}) {
    const double apart = std::abs(thresholds.start[side] - thresholds.balance[side]) / deviation;
    gap = std::min(gap, apart > kApart ? apart : 0);
  }
  const Counts counts(a, order, gap);
  const bool one = a.rows() == 1;
  const int degree = one ? std::min(order, 6 + std::max(0, order - 6) / 2)
                         : static_cast<int>(2 + counts.along / 2),
            at_rest = std::max(static_cast<int>(std::lround(counts.along)) + (one ? 0 : 1), degree);
  // Beside a start of its own nothing steep stands; at one that is a balance point functions are
  // like roots, and down to where both are told apart.
  constexpr double least = 1e-4, at_starts = 0.3;
  const double apart = std::min(0.45 * std::pow(2, 3 - counts.along), gap / counts.along),
               together = 0.1 * std::pow(4, 3 - counts.along);
  Layout made{{}, {}, std::max({apart, together, least}), {}};
  // Beyond 5, 6 and 7 deviations lie 1e-5, 1e-7 and 1e-10 of E[X^2].
  const double reach = std::min(7.0, 3.5 + order / 2.0);
  const auto special = special_forces(thresholds, deviation, made.finest, at_starts);
  for (double force : thresholds.start) {
    const double start = force / deviation;
    if (std::abs(start) < reach) made.cuts.push_back(start);
  }
  constexpr double longest = 5;
  made.mesh = force_mesh(special, reach, longest, degree, at_rest);
  made.modes = modes_below(a.rows() - 1, counts.across);
  return made;
}

// The generator on the nodes of a layout.
Projection projection_on(const Layout& grid, const GaussianNoise& noise,
                         const Thresholds& thresholds) {
  const auto kept = std::make_shared<const AlongForce>(grid.mesh, grid.cuts, normal_weight);
  const AlongForce& x = *kept;
  const Across y(noise.matrix(), grid.modes);
  Projection made;
  made.deviation = noise.deviation();
  made.intensity = noise.power_spectral_density(0) / 2;
  made.peak_intensity = noise.largest_density() / 2;
  made.step = grid.finest * noise.deviation();
  made.rate = 2 * noise.matrix()(0, 0) / (grid.finest * grid.finest);
  made.even = thresholds.alike_both_ways();
  made.reversed = made.even && noise.matrix().rows() <= 2;
  const auto force = x.forces(noise.deviation(), thresholds.start[1], thresholds.start[0]);
  const double total = std::accumulate(x.w.begin(), x.w.end(), 0.0);
  for (std::size_t k = 0; k < x.w.size(); ++k) {
    for (double weight : y.weight) {
      made.x.push_back(force[k]);
      made.probability.push_back(x.w[k] / total * weight);
    }
  }
  made.means = [kept, across = y.weight.size(),
                scale = noise.deviation()](const FunctionOfNoise& f) {
    std::vector<double> all;
    for (double mean : kept->means([&](double z) { return f(scale * z); })) {
      all.insert(all.end(), across, mean);
    }
    return all;
  };
  made.shown = shown_by(x, static_cast<int>(y.weight.size()), noise.deviation());
  const Dense rates = rates_of(noise.matrix()(0, 0), x, y);
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
  return made;
}

// A place among marks, moved in proportion between those beside it.
double moved(double z, const std::vector<std::pair<double, double>>& marks) {
  const auto above = std::ranges::lower_bound(marks, z, {}, &std::pair<double, double>::first);
  if (above->first == z) return above->second;
  const auto& [low, to_low] = above[-1];
  return to_low + (z - low) / (above->first - low) * (above->second - to_low);
}

}  // namespace

bool GaussianNoise::fits(const Thresholds& thresholds, int order) const {
  return layout_of(a_, deviation_, thresholds, order).nodes() <= kMostNodes;
}

Projection GaussianNoise::projection(const Thresholds& thresholds, int order) const {
  const Layout grid = layout_of(a_, deviation_, thresholds, order);
  if (grid.nodes() > kMostNodes) {
    throw UnfitTable(terms_.size(), fmt::format("the terms take {} nodes, and at most {} are taken",
                                                grid.nodes(), kMostNodes));
  }
  return projection_on(grid, *this, thresholds);
}

std::shared_ptr<const LevelTable> moved_nodes(const Thresholded& from, const Thresholded& to,
                                              int order) {
  const double scale = from.noise.deviation(), other = to.noise.deviation();
  Layout grid = layout_of(from.noise.matrix(), scale, from.thresholds, order);
  const double reach = grid.mesh.ends.back();
  std::vector<std::pair<double, double>> marks{{-reach, -reach}, {reach, reach}};
  for (const auto of : {&Thresholds::start, &Thresholds::balance}) {
    for (const int side : {0, 1}) {
      const double z = (from.thresholds.*of)[side] / scale;
      if (std::abs(z) < reach) marks.emplace_back(z, (to.thresholds.*of)[side] / other);
    }
  }
  std::ranges::sort(marks);
  for (auto* places : {&grid.mesh.ends, &grid.cuts}) {
    for (double& z : *places) z = moved(z, marks);
  }
  return std::make_shared<const LevelTable>(
      LevelTable::of(projection_on(grid, to.noise, to.thresholds)));
}

}  // namespace stickslip::model
