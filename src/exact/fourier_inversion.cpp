#include "stickslip/exact/fourier_inversion.hpp"

#include <algorithm>
#include <array>
#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>

namespace stickslip::exact {

using Complex = std::complex<double>;

namespace {

constexpr double kPi = std::numbers::pi;

constexpr int kDegree = 8;  // of the polynomials

/// |x|^(n/2 - 1) on either side. Jumps of what is smooth on both sides are all that shows at large
/// k.
struct Singularity {
  int n;
  double right, left;
};
const std::vector<Singularity> kAny{{1, 1, 0}, {1, 0, 1}, {2, 1, -1},
                                    {3, 1, 0}, {3, 0, 1}, {4, 1, 1}};
const std::vector<Singularity> kEven{{1, 1, 1}, {3, 1, 1}, {4, 1, 1}};

using Nodes = std::array<double, kDegree + 1>;

// Extrema of the Chebyshev polynomial, from 1 down to -1.
Nodes nodes() {
  Nodes x{};
  for (int n = 0; n <= kDegree; ++n) x[n] = std::cos(kPi * n / kDegree);
  return x;
}

std::vector<Complex> chebyshev_terms(const std::array<Complex, kDegree + 1>& values) {
  std::vector<Complex> terms;
  for (int j = 0; j <= kDegree; ++j) {
    Complex sum = 0;
    for (int n = 0; n <= kDegree; ++n) {
      const double end = n == 0 || n == kDegree ? 0.5 : 1;
      sum += end * std::cos(kPi * j * n / kDegree) * values[n];
    }
    terms.push_back((j == 0 || j == kDegree ? 1.0 : 2.0) / kDegree * sum);
  }
  return terms;
}

// Clenshaw's sum.
Complex polynomial(const std::vector<Complex>& terms, double x) {
  Complex one = 0, two = 0;
  for (std::size_t j = terms.size(); j-- > 1;) {
    const Complex next = terms[j] + 2 * x * one - two;
    two = one;
    one = next;
  }
  return terms[0] + x * one - two;
}

// The coefficients c for which |A c - y| is least; columns that others make up count for nothing.
std::vector<double> least_squares(std::vector<std::vector<double>> a, std::vector<double> y) {
  constexpr double dependent = 1e-9;
  const auto dot = [](const auto& p, const auto& q) {
    double sum = 0;
    for (std::size_t n = 0; n < p.size(); ++n) sum += p[n] * q[n];
    return sum;
  };
  const std::size_t count = a.size();
  std::vector<std::vector<double>> r(count, std::vector<double>(count, 0.0));
  std::vector<double> z(count, 0.0), c(count, 0.0);
  for (std::size_t j = 0; j < count; ++j) {
    const double size = std::sqrt(dot(a[j], a[j]));
    for (int pass = 0; pass < 2; ++pass) {
      for (std::size_t i = 0; i < j; ++i) {
        const double share = dot(a[i], a[j]);
        r[i][j] += share;
        for (std::size_t n = 0; n < y.size(); ++n) a[j][n] -= share * a[i][n];
      }
    }
    const double left = std::sqrt(dot(a[j], a[j]));
    r[j][j] = left > dependent * size ? left : 0;
    for (double& entry : a[j]) entry = r[j][j] > 0 ? entry / left : 0;
    z[j] = dot(a[j], y);
    for (std::size_t n = 0; n < y.size(); ++n) y[n] -= z[j] * a[j][n];
  }
  for (std::size_t j = count; j-- > 0;) {
    if (r[j][j] == 0) continue;
    for (std::size_t i = j + 1; i < count; ++i) z[j] -= r[j][i] * c[i];
    c[j] = z[j] / r[j][j];
  }
  return c;
}

}  // namespace

FourierInversion::FourierInversion(const Transform& phi, double mass, double mean, double deviation,
                                   bool even, const Limits& limits)
    : even_(even), mass_(mass), mean_(mean), scale_(deviation), accuracy_(limits.accuracy) {
  const double tolerance = 0.3 * limits.accuracy;
  double low = 0, high = std::min(2 / scale_, limits.highest);
  for (bool open = true; open; high = std::min(2 * high, limits.highest)) {
    const std::size_t first = panels_.size();
    sample(phi, low, high, tolerance, limits.evaluations);
    if (evaluations_ >= limits.evaluations && sums_.size() > 1) {
      panels_.resize(first);
      break;
    }
    double left = 0, unforeseen = 0;
    for (std::size_t n = first; n < panels_.size(); ++n) {
      for (const Complex term : panels_[n].terms) left = std::max(left, std::abs(term));
      for (const double k : {panels_[n].low, (panels_[n].low + panels_[n].high) / 2}) {
        const bool foreseen = !sums_.empty() && !sums_.back().singular.empty();
        unforeseen = std::max(unforeseen, foreseen ? std::abs(rest(sums_.back(), k)) : 1);
      }
    }
    // The last octave has to be foreseen by the terms found below it.
    const bool falls = left < tolerance;
    open = !falls && unforeseen > tolerance && high < limits.highest;
    // What falls by itself has no singularity that shows, and no sum needs terms for one.
    for (Sum& sum : sums_) {
      if (falls) sum.singular.clear();
    }
    sums_.push_back(falls ? Sum{panels_.size(), {}} : sum_up_to(panels_.size(), high));
    low = high;
  }
}

// Halves panels until the polynomials hold.
void FourierInversion::sample(const Transform& phi, double low, double high, double tolerance,
                              int most) {
  static const Nodes x = nodes();
  std::array<Complex, kDegree + 1> values;
  Panel panel{low, high, 0, {}, 0, 0};
  for (int n = 0; n <= kDegree; ++n) {
    const double k = panel.at(x[n]);
    if (k == 0) {
      values[n] = mass_;
      continue;
    }
    auto& found = known_[k];
    if (found.error == 0) {
      found = phi(k);
      ++evaluations_;
    }
    values[n] = found.value;
    panel.doubt = std::max(panel.doubt, found.error);
  }
  panel.rough = 1e300;
  for (const double shift : {0.0, mean_}) {
    auto moved = values;
    for (int n = 0; n <= kDegree; ++n) {
      moved[n] *= std::polar(1.0, -shift * panel.at(x[n]));
    }
    auto terms = chebyshev_terms(moved);
    const double last = std::abs(terms[kDegree]) + std::abs(terms[kDegree - 1]);
    const double before = std::abs(terms[kDegree - 2]) + std::abs(terms[kDegree - 3]);
    const double rough = last * std::min(1.0, 3 * last / before);
    if (rough < panel.rough) {
      panel.shift = shift;
      panel.terms = std::move(terms);
      panel.rough = rough;
    }
  }
  if (panel.rough <= tolerance || evaluations_ >= most) {
    panels_.push_back(std::move(panel));
    return;
  }
  sample(phi, low, (low + high) / 2, tolerance, most);
  sample(phi, (low + high) / 2, high, tolerance, most);
}

Complex FourierInversion::sampled(double k) const {
  const auto after = std::upper_bound(panels_.begin(), panels_.end(), k,
                                      [](double at, const Panel& p) { return at < p.high; });
  const Panel& p = after == panels_.end() ? panels_.back() : *after;
  const double x = (2 * k - p.low - p.high) / (p.high - p.low);
  return std::polar(1.0, k * p.shift) * polynomial(p.terms, x);
}

Complex FourierInversion::rest(const Sum& sum, double k) const {
  const auto terms = sum.singular.empty() ? std::vector<Complex>{} : basis(k);
  return std::inner_product(terms.begin(), terms.end(), sum.singular.begin(), sampled(k),
                            std::minus<>(), std::multiplies<>());
}

std::vector<Complex> FourierInversion::basis(double k) const {
  std::vector<Complex> terms;
  const Complex root = 1.0 / std::sqrt(Complex(1, -k * scale_));
  for (const auto& [n, right, left] : even_ ? kEven : kAny) {
    const Complex power = std::pow(root, n);
    terms.push_back(right * power + left * std::conj(power));
  }
  return terms;
}

FourierInversion::Sum FourierInversion::sum_up_to(std::size_t panels, double highest) const {
  static const Nodes x = nodes();
  Sum sum{panels, {}};
  std::vector<std::vector<double>> columns((even_ ? kEven : kAny).size());
  std::vector<double> y;
  for (std::size_t n = 0; n < panels; ++n) {
    const Panel& p = panels_[n];
    if (p.low < 0.24 * highest) continue;
    for (const double at : x) {
      const double k = p.at(at);
      const double weight = std::sqrt(k * scale_);
      const Complex value = weight * sampled(k);
      const auto terms = basis(k);
      y.insert(y.end(), {value.real(), value.imag()});
      for (std::size_t j = 0; j < terms.size(); ++j) {
        columns[j].insert(columns[j].end(), {weight * terms[j].real(), weight * terms[j].imag()});
      }
    }
  }
  // What errors of phi leave open is small: coefficients are about as large as the mass.
  for (std::size_t j = 0; j < columns.size(); ++j) {
    for (std::size_t i = 0; i < columns.size(); ++i) columns[i].push_back(i == j ? accuracy_ : 0);
    y.push_back(0);
  }
  if (y.size() > 3 * columns.size()) sum.singular = least_squares(std::move(columns), std::move(y));
  return sum;
}

// In units of the scale, x^(n/2 - 1) exp(-x)/Gamma(n/2).
FourierInversion::Integrals FourierInversion::singular(const Sum& sum, double x) const {
  Integrals found;
  const double u = std::abs(x) / scale_;
  for (std::size_t j = 0; j < sum.singular.size(); ++j) {
    const auto& [n, right, left] = (even_ ? kEven : kAny)[j];
    const double c = sum.singular[j], here = c * (x > 0 ? right : left), a = n / 2.0;
    if (u > 0) found.density += here * boost::math::gamma_p_derivative(a, u) / scale_;
    const double within = u > 0 ? here * boost::math::gamma_p(a, u) : 0;
    found.below += c * left + (x > 0 ? within : -within);
  }
  return found;
}

// f(x) = 1/pi int_0^K Re exp(-i k x) phi dk, and half of the mass less 1/pi int_0^K Im exp(-i k x)
// phi dk/k below x.
FourierInversion::Integrals FourierInversion::integrals(const Sum& sum, double x) const {
  using Rule = boost::math::quadrature::gauss<double, 20>;
  constexpr double phase = 8;  // over the points of a rule
  Integrals found;
  double mass = mass_;
  for (std::size_t j = 0; j < sum.singular.size(); ++j) {
    const auto& [n, right, left] = (even_ ? kEven : kAny)[j];
    mass -= sum.singular[j] * (right + left);
  }
  for (std::size_t n = 0; n < sum.panels; ++n) {
    const Panel& p = panels_[n];
    const double width = p.high - p.low;
    const int parts = 1 + static_cast<int>(width * (std::abs(x) + std::abs(p.shift)) / phase);
    const auto add = [&](double k, double weight) {
      const Complex left = rest(sum, k) * std::polar(weight / kPi, -k * x);
      found.density += left.real();
      found.below -= left.imag() / k;
    };
    for (int part = 0; part < parts; ++part) {
      const double half = width / parts / 2, middle = p.low + (2 * part + 1) * half;
      for (std::size_t m = 0; m < Rule::abscissa().size(); ++m) {
        const double away = half * Rule::abscissa()[m], weight = half * Rule::weights()[m];
        add(middle - away, weight);
        add(middle + away, weight);
      }
    }
  }
  const Integrals beside = singular(sum, x);
  return {found.density + beside.density, mass / 2 + found.below + beside.below};
}

FourierInversion::Value FourierInversion::between(double x, double Integrals::*which) const {
  const auto of = [&](std::size_t n) { return integrals(sums_[n], x).*which; };
  const double value = of(sums_.size() - 1);
  double error = std::abs(value - (sums_.size() > 1 ? of(sums_.size() - 2) : mass_));
  for (const Panel& p : panels_) {
    const double width = which == &Integrals::density ? p.high - p.low
                         : p.low > 0                  ? std::log(p.high / p.low)
                                                      : 1;
    error += width / kPi * (p.rough + p.doubt);
  }
  return {value, error};
}

FourierInversion::Value FourierInversion::below(double x) const {
  if (!even_ || x <= 0) return between(x, &Integrals::below);
  const Value beyond = between(-x, &Integrals::below);
  return {mass_ - beyond.value, beyond.error};
}

}  // namespace stickslip::exact
