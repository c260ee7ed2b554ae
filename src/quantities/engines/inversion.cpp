#include "stickslip/quantities/engines/inversion.hpp"

#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/special_functions/gamma.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "stickslip/base/text.hpp"

namespace stickslip::quantities {

using Complex = std::complex<double>;

TransferFunction::TransferFunction(const linalg::Matrix<double>& m, const std::vector<double>& left,
                                   const std::vector<double>& right) {
  linalg::SchurForm schur(m);
  q_ = std::move(schur.q);
  std::for_each(schur.t.data(), schur.t.column(m.columns()), [this](const Complex& entry) {
    t_real_.push_back(entry.real());
    t_imaginary_.push_back(entry.imag());
  });
  set_ends(left, right);
}

TransferFunction TransferFunction::between(const std::vector<double>& left,
                                           const std::vector<double>& right) const {
  TransferFunction other = *this;
  other.set_ends(left, right);
  return other;
}

void TransferFunction::set_ends(const std::vector<double>& left, const std::vector<double>& right) {
  left_ = std::vector<Complex>(left.begin(), left.end()) * q_;
  // Q^H right, the conjugate of right^T Q since right is real.
  right_ = std::vector<Complex>(right.begin(), right.end()) * q_;
  for (Complex& entry : right_) entry = std::conj(entry);
}

// Back substitution, in real arithmetic that compilers turn into vector instructions: this is
// called for every frequency and every point of a quadrature.
std::complex<double> TransferFunction::operator()(std::complex<double> z) const {
  const std::size_t size = right_.size();
  std::vector<double> real(size), imaginary(size);
  for (std::size_t r = 0; r < size; ++r) {
    real[r] = right_[r].real();
    imaginary[r] = right_[r].imag();
  }
  Complex sum = 0;
  for (std::size_t c = size; c-- > 0;) {
    const double* t_real = t_real_.data() + c * size;
    const double* t_imaginary = t_imaginary_.data() + c * size;
    const Complex x = Complex(real[c], imaginary[c]) / (z - Complex(t_real[c], t_imaginary[c]));
    const double a = x.real(), b = x.imag();
    for (std::size_t r = 0; r < c; ++r) {
      real[r] += t_real[r] * a - t_imaginary[r] * b;
      imaginary[r] += t_real[r] * b + t_imaginary[r] * a;
    }
    sum += left_[c] * x;
  }
  return sum;
}

std::vector<Complex> TransferFunction::from_right(Complex z) const {
  const std::size_t size = right_.size();
  std::vector<Complex> x = right_;
  for (std::size_t c = size; c-- > 0;) {
    x[c] /= z - t(c, c);
    for (std::size_t r = 0; r < c; ++r) x[r] += t(r, c) * x[c];
  }
  return q_ * x;
}

// The transpose: forward substitution, and then x Q^H, the conjugate of Q conj(x).
std::vector<Complex> TransferFunction::from_left(Complex z) const {
  const std::size_t size = left_.size();
  std::vector<Complex> x = left_;
  for (std::size_t c = 0; c < size; ++c) {
    for (std::size_t r = 0; r < c; ++r) x[c] += x[r] * t(r, c);
    x[c] /= z - t(c, c);
  }
  for (Complex& entry : x) entry = std::conj(entry);
  x = q_ * x;
  for (Complex& entry : x) entry = std::conj(entry);
  return x;
}

TalbotContour::TalbotContour(int points) {
  constexpr double a = 0.5017, b = 0.6407, c = 0.6122, d = 0.2645;
  for (int n = points / 2; n < points; ++n) {
    const double theta = std::numbers::pi * (2.0 * n + 1 - points) / points;
    const double sine = std::sin(b * theta), cotangent = std::cos(b * theta) / sine;
    const Complex point(a * theta * cotangent - c, d * theta);
    const Complex slope(a * cotangent - a * b * theta / (sine * sine), d);
    z.push_back(static_cast<double>(points) * point);
    // exp(z) dz/(2 pi i), doubled for the lower half
    weight.push_back(2.0 * std::exp(z.back()) * slope * Complex(0, -1));
  }
}

namespace {

constexpr double kPi = std::numbers::pi;

// Degrees of the polynomials on a panel: doubled, so that points serve again, before it is halved.
constexpr int kLeastDegree = 4, kMostDegree = 16;

constexpr double kResolved = 3;       // of phi, in units of the accuracy, which pi divides
constexpr double kUnresolved = 3;     // of errors that follow from what is left, where that is more
constexpr double kShareBeyond = 0.5;  // of the evaluations, for k beyond the highest

/// |x|^(n/2 - 1) on either side. Jumps of what is smooth on both sides are all that shows at large
/// k.
struct Singularity {
  int n;
  double right, left;
};
const std::vector<Singularity>& kinds(bool even) {
  static const std::vector<Singularity> of_even{{1, 1, 1}, {3, 1, 1}, {4, 1, 1}},
      of_any{{1, 1, 0}, {1, 0, 1}, {2, 1, -1}, {3, 1, 0}, {3, 0, 1}, {4, 1, 1}};
  return even ? of_even : of_any;
}

// Extrema of the Chebyshev polynomial, from 1 down to -1.
std::vector<double> nodes(int degree) {
  std::vector<double> x;
  for (int n = 0; n <= degree; ++n) x.push_back(std::cos(kPi * n / degree));
  return x;
}

// Of the polynomial with these values at the extrema.
std::vector<Complex> chebyshev_terms(const std::vector<Complex>& values) {
  const int degree = static_cast<int>(values.size()) - 1;
  std::vector<Complex> terms;
  for (int j = 0; j <= degree; ++j) {
    Complex sum = 0;
    for (int n = 0; n <= degree; ++n) {
      const double end = n == 0 || n == degree ? 0.5 : 1;
      sum += end * std::cos(kPi * j * n / degree) * values[n];
    }
    terms.push_back((j == 0 || j == degree ? 1.0 : 2.0) / degree * sum);
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

constexpr double kShorter = 2.0 / 3;

// 1 up to 0.6 and 0 at 1, with all derivatives.
double window(double x) {
  constexpr double flat = 0.6;
  const double u = (x - flat) / (1 - flat);
  if (u <= 0) return 1;
  return u >= 1 ? 0 : 1 / (1 + std::exp(1 / (1 - u) - 1 / u));
}

}  // namespace

FourierInversion::FourierInversion(const Transform& phi, double mass, double mean, double deviation,
                                   bool even, const Limits& limits)
    : even_(even), mass_(mass), mean_(mean), scale_(deviation), accuracy_(limits.accuracy) {
  const double tolerance = 0.4 * limits.accuracy;
  double low = 0, high = std::min(2 / scale_, limits.highest);
  for (bool open = true; open;) {
    const std::size_t first = panels_.size();
    const int before = evaluations_;
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
    unforeseen_ = falls ? 0 : unforeseen;
    // What falls by itself has no singularity that shows, and no sum needs terms for one.
    for (Sum& sum : sums_) {
      if (falls) sum.singular.clear();
    }
    sums_.push_back(falls ? Sum{panels_.size(), {}} : sum_up_to(panels_.size(), high));
    find_what_is_left(first);
    double degrees = 0;
    for (std::size_t n = first; n < panels_.size(); ++n) degrees += panels_[n].degree();
    if (limits.furthest > 0) closest_ = degrees / (high - low);
    const bool affordable = 3 * evaluations_ - 2 * before < kShareBeyond * limits.evaluations;
    const double next =
        std::min(2 * high, high < limits.highest ? limits.highest : limits.furthest);
    open = !falls && next > high &&
           (next <= limits.highest ? unforeseen > tolerance : !is_resolved() && affordable);
    low = high;
    high = next;
  }
}

bool FourierInversion::is_resolved() const {
  return std::max(left_, unforeseen_) <= kResolved * accuracy_;
}

// Narrow parts of f leave much of phi, added with changing phases. What is left goes on falling as
// it did in the last octave.
void FourierInversion::find_what_is_left(std::size_t first) {
  constexpr double slowest = 0.97;
  const double before = std::exchange(left_, 0);
  for (std::size_t n = first; n < panels_.size(); ++n) {
    for (const double place : nodes(kMostDegree / 2))
      left_ = std::max(left_, std::abs(rest(sums_.back(), panels_[n].at(place))));
  }
  const double ratio = left_ < slowest * before ? left_ / before : slowest;
  further_ = left_ * std::max(1.0, std::numbers::ln2 * ratio / (1 - ratio));
}

// Doubles degrees and halves panels until the polynomials hold. Points are no further apart than
// twice as far as in the octave below, or they miss waves that go on: few of them may look smooth.
void FourierInversion::sample(const Transform& phi, double low, double high, double tolerance,
                              int most) {
  Panel panel{low, high};
  for (int degree = kLeastDegree; degree <= kMostDegree; degree *= 2) {
    if (degree < closest_ / 2 * (high - low)) continue;
    panel = interpolated(phi, low, high, degree);
    if (panel.rough <= tolerance || evaluations_ >= most) {
      panels_.push_back(std::move(panel));
      return;
    }
  }
  sample(phi, low, (low + high) / 2, tolerance, most);
  sample(phi, (low + high) / 2, high, tolerance, most);
}

FourierInversion::Panel FourierInversion::interpolated(const Transform& phi, double low,
                                                       double high, int degree) {
  Panel panel{low, high};
  const auto x = nodes(degree);
  std::vector<Complex> values;
  for (std::size_t n = 0; n < x.size(); ++n) {
    // Ends to the last bit, as neighbours share them.
    const double k = n == 0 ? high : n + 1 == x.size() ? low : panel.at(x[n]);
    if (k == 0) {
      values.emplace_back(mass_);
      continue;
    }
    auto& found = known_[k];
    if (found.error == 0) {
      found = phi(k);
      ++evaluations_;
    }
    values.push_back(found.value);
    panel.doubt = std::max(panel.doubt, found.error);
  }
  panel.rough = kInfinity;
  for (const double shift : {0.0, mean_}) {
    auto moved = values;
    for (std::size_t n = 0; n < x.size(); ++n) {
      moved[n] *= std::polar(1.0, -shift * panel.at(x[n]));
    }
    auto terms = chebyshev_terms(moved);
    const auto end = terms.rbegin();
    const double last = std::abs(end[0]) + std::abs(end[1]);
    const double before = std::abs(end[2]) + std::abs(end[3]);
    const double rough = last * std::min(1.0, 3 * last / before);
    if (rough < panel.rough) {
      panel.shift = shift;
      panel.terms = std::move(terms);
      panel.rough = rough;
    }
  }
  return panel;
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
  for (const auto& [n, right, left] : kinds(even_)) {
    const Complex power = std::pow(root, n);
    terms.push_back(right * power + left * std::conj(power));
  }
  return terms;
}

FourierInversion::Sum FourierInversion::sum_up_to(std::size_t panels, double highest) const {
  static const auto x = nodes(kMostDegree / 2);
  std::vector<double> k;
  for (std::size_t n = 0; n < panels; ++n) {
    if (panels_[n].low < 0.24 * highest) continue;
    for (const double place : x) k.push_back(panels_[n].at(place));
  }
  const int points = static_cast<int>(k.size()), count = static_cast<int>(kinds(even_).size());
  if (points <= count) return {panels, {}};
  // Real and imaginary parts. The last rows keep small what errors of phi leave open: coefficients
  // are about as large as the mass.
  linalg::Matrix<double> a(2 * points + count, count);
  std::vector<double> y;
  for (int n = 0; n < points; ++n) {
    const double weight = std::sqrt(k[n] * scale_);
    const Complex value = weight * sampled(k[n]);
    const auto terms = basis(k[n]);
    y.insert(y.end(), {value.real(), value.imag()});
    for (int j = 0; j < count; ++j) {
      a(2 * n, j) = weight * terms[j].real();
      a(2 * n + 1, j) = weight * terms[j].imag();
    }
  }
  for (int j = 0; j < count; ++j) a(2 * points + j, j) = accuracy_;
  y.resize(static_cast<std::size_t>(a.rows()));
  return {panels, linalg::least_squares(std::move(a), std::move(y))};
}

// In units of the scale, x^(n/2 - 1) exp(-x)/Gamma(n/2).
FourierInversion::Integrals FourierInversion::singular(const Sum& sum, double x) const {
  Integrals found;
  const double u = std::abs(x) / scale_;
  for (std::size_t j = 0; j < sum.singular.size(); ++j) {
    const auto& [n, right, left] = kinds(even_)[j];
    const double c = sum.singular[j], here = c * (x > 0 ? right : left), a = n / 2.0;
    if (u > 0) found.density += here * boost::math::gamma_p_derivative(a, u) / scale_;
    const double within = u > 0 ? here * boost::math::gamma_p(a, u) : 0;
    found.below += c * left + (x > 0 ? within : -within);
  }
  return found;
}

template <class Add>
void FourierInversion::over_panels(std::size_t panels, double x, const Add& add) const {
  using Rule = boost::math::quadrature::gauss<double, 20>;
  constexpr double phase = 8;  // over the points of a rule
  for (std::size_t n = 0; n < panels; ++n) {
    const Panel& p = panels_[n];
    const double width = p.high - p.low;
    const int parts = 1 + static_cast<int>(width * (std::abs(x) + std::abs(p.shift)) / phase);
    for (int part = 0; part < parts; ++part) {
      const double half = width / parts / 2, middle = p.low + (2 * part + 1) * half;
      for (std::size_t m = 0; m < Rule::abscissa().size(); ++m) {
        const double away = half * Rule::abscissa()[m], weight = half * Rule::weights()[m];
        for (const double k : {middle - away, middle + away}) {
          add(k, std::polar(weight / kPi, -k * x));
        }
      }
    }
  }
}

// f(x) = 1/pi int_0^K Re exp(-i k x) phi dk, and half of the mass less 1/pi int_0^K Im exp(-i k x)
// phi dk/k below x.
FourierInversion::Integrals FourierInversion::integrals(const Sum& sum, double x) const {
  Integrals found;
  double mass = mass_;
  for (std::size_t j = 0; j < sum.singular.size(); ++j) {
    const auto& [n, right, left] = kinds(even_)[j];
    mass -= sum.singular[j] * (right + left);
  }
  over_panels(sum.panels, x, [&](double k, Complex weight) {
    const Complex left = rest(sum, k) * weight;
    found.density += left.real();
    found.below -= left.imag() / k;
  });
  const Integrals beside = singular(sum, x);
  return {found.density + beside.density, mass / 2 + found.below + beside.below};
}

// By Vaaler's function H of exponential type 2 pi, |sgn - H| <= (sin(pi x)/(pi x))^2, in units of
// 2 pi/K (Bulletin of the AMS 12, 1985, 183): the error is as much of f as lies within about 2/K.
Uncertain FourierInversion::bounds(double x) const {
  const double highest = panels_.back().high;
  Uncertain found{mass_ / 2, 0};
  over_panels(panels_.size(), x, [&](double k, Complex weight) {
    const Complex seen = sampled(k) * weight;
    const double t = k / highest;
    found.value -= seen.imag() / k * (kPi * t * (1 - t) / std::tan(kPi * t) + t);
    found.error += seen.real() * kPi / highest * (1 - t);
  });
  found.error = std::max(found.error, 0.0);
  for (const Panel& p : panels_) found.error += (p.high - p.low) / highest * (p.rough + p.doubt);
  return found;
}

double FourierInversion::beyond(double x) const {
  constexpr int octaves = 40;
  double k = panels_.back().high, size = std::abs(sampled(k)), sum = 0;
  for (int octave = 1; octave <= octaves; ++octave) {
    k *= 2;
    size /= std::numbers::sqrt2;
    sum += std::numbers::ln2 * std::min((1 + octave) / 2.0 * unforeseen_, size) /
           std::max(1.0, k * std::abs(x));
  }
  return sum;
}

Uncertain FourierInversion::between(double x, double Integrals::*which) const {
  const auto of = [&](std::size_t n) { return integrals(sums_[n], x).*which; };
  double value = of(sums_.size() - 1);
  double error = std::abs(value - (sums_.size() > 1 ? of(sums_.size() - 2) : mass_));
  if (which == &Integrals::below) {
    // A step is off by half of its height.
    error += (std::min(further_, 2 * left_) + beyond(x)) / kPi;
    const Uncertain proven = bounds(x);
    value = std::clamp(value, proven.value - proven.error, proven.value + proven.error);
    const double bound = std::abs(value - proven.value) + proven.error;
    error = std::min(is_resolved() ? error : kUnresolved * error, bound);
  } else {
    if (left_ > accuracy_) error += further_ * panels_.back().high / kPi;
    error += std::max(-value, 0.0);
    value = std::max(value, 0.0);
  }
  for (const Panel& p : panels_) {
    const double width = which == &Integrals::density ? p.high - p.low
                         : p.low > 0                  ? std::log(p.high / p.low)
                                                      : 1;
    error += width / kPi * (p.rough + p.doubt);
  }
  return {value, error};
}

Uncertain FourierInversion::below(double x) const {
  if (!even_ || x <= 0) return between(x, &Integrals::below);
  const Uncertain beyond = between(-x, &Integrals::below);
  return {mass_ - beyond.value, beyond.error};
}

TailInversion::TailInversion(const FourierInversion::Transform& phi, double s, double mean,
                             double deviation, double accuracy, int most)
    : s_(s), step_(0.6 / deviation) {
  for (bool open = true; open;) {
    sample(phi);
    const double here = sum(mean, false, 1, 1);
    // What phi leaves open is no matter of step and range.
    const double enough = std::max(accuracy * std::abs(here), doubt(mean, false));
    const bool coarse = !(aliased(mean, false, here) <= enough),
               cut = !(std::abs(here - sum(mean, false, 1, kShorter)) <= enough);
    open = (coarse || cut) && count_ < most;
    if (open && coarse) step_ /= 2;
    if (open) count_ = coarse ? 2 * count_ : count_ + count_ / 2;
  }
}

void TailInversion::sample(const FourierInversion::Transform& phi) {
  for (int n = 0; n < count_; ++n) {
    const double k = n * step_;
    if (!known_.contains(k)) known_[k] = phi(k);
  }
}

Complex TailInversion::weight(double k, double d, bool density) const {
  const Complex turned = std::polar(step_ * (k == 0 ? 0.5 : 1) / std::numbers::pi, -k * d);
  return density ? turned : turned / (s_ > 0 ? Complex(s_, k) : -Complex(s_, k));
}

double TailInversion::sum(double d, bool density, int stride, double share) const {
  double all = 0;
  for (int n = 0; n < count_; n += stride) {
    const double k = n * step_;
    all +=
        stride * window(n / (share * count_)) * (weight(k, d, density) * known_.at(k).value).real();
  }
  return all;
}

double TailInversion::aliased(double d, bool density, double value) const {
  const double change = value - sum(d, density, 2, 1);
  return std::abs(change * std::min(1.0, 3 * change / value));
}

double TailInversion::doubt(double d, bool density) const {
  double all = 0;
  for (int n = 0; n < count_; ++n) {
    all += std::abs(weight(n * step_, d, density)) * known_.at(n * step_).error;
  }
  return all;
}

Uncertain TailInversion::with_error(double d, bool density) const {
  const double value = sum(d, density, 1, 1);
  return {value, aliased(d, density, value) + std::abs(value - sum(d, density, 1, kShorter)) +
                     doubt(d, density)};
}

}  // namespace stickslip::quantities
