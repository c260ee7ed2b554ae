#pragma once
/// A density and its distribution function from a characteristic function.

#include <complex>
#include <functional>
#include <map>
#include <vector>

#include "stickslip/base/uncertain.hpp"
#include "stickslip/linalg/dense.hpp"

namespace stickslip::quantities {

// left (z - M)^-1 right for many z, M small and dense.

/// H(z) = left (z - M)^-1 right through the Schur form M = Q T Q^H (linalg::SchurForm), backward
/// stable for matrices far from normal too. O(n^3) once, O(n^2) a value.
class TransferFunction {
 public:
  /// Throws NotReached when the Schur form does not converge.
  TransferFunction(const linalg::Matrix<double>& m, const std::vector<double>& left,
                   const std::vector<double>& right);
  /// The same M between other vectors; shares no work but the Schur form. O(n^2).
  [[nodiscard]] TransferFunction between(const std::vector<double>& left,
                                         const std::vector<double>& right) const;

  /// Infinite at an eigenvalue of M.
  [[nodiscard]] std::complex<double> operator()(std::complex<double> z) const;
  /// (z - M)^-1 right, and left (z - M)^-1.
  [[nodiscard]] std::vector<std::complex<double>> from_right(std::complex<double> z) const;
  [[nodiscard]] std::vector<std::complex<double>> from_left(std::complex<double> z) const;

 private:
  [[nodiscard]] std::complex<double> t(std::size_t row, std::size_t column) const {
    const std::size_t at = column * right_.size() + row;
    return {t_real_[at], t_imaginary_[at]};
  }
  void set_ends(const std::vector<double>& left, const std::vector<double>& right);

  linalg::Matrix<std::complex<double>> q_;
  std::vector<double> t_real_, t_imaginary_;        // upper triangle, by columns
  std::vector<std::complex<double>> left_, right_;  // left Q, Q^H right
};

/// Points z and weights w, on the upper half of Talbot's contour with the parameters of Weideman
/// (SIAM J. Numer. Anal. 44, 2006): f(t) = sum Re w F(z/t)/t from its Laplace transform F, whose
/// singularities are near the negative axis. exp(-x) is right to 3e-14 for all x >= 0 at 28 to 32
/// points of both halves; rounding grows by exp(0.17 points).
struct TalbotContour {
  std::vector<std::complex<double>> z, weight;

  explicit TalbotContour(int points);
};

/// f with phi(k) = int f(x) exp(i k x) dx, of a mass that need not be 1 and with a singularity at
/// x = 0 where f is a series in |x|^(1/2) from |x|^(-1/2) on, another one on either side.
///
/// phi is sampled on panels in k until Chebyshev polynomials of degree 4, 8 or 16 hold it, with the
/// phase of the mean drift taken out where that is smoother. What does not fall fast comes from the
/// singularity,
///
///   phi(k) ~ sum_n c_n+ (b - i k)^(-n/2) + c_n- (b + i k)^(-n/2),   n = 1 ... 4,
///
/// transforms of x^(n/2 - 1) exp(-b x)/Gamma(n/2), with c_n+ = +-c_n- for even n: the coefficients
/// are those of least squares over the upper two octaves of k. Only what is left of phi is
/// integrated numerically.
///
/// Beyond the highest k of the limits it goes on to the furthest while more is left than was asked
/// for, with points at least half as close as in the octave below. Densities are >= 0, and the
/// distribution function lies within the bounds that phi up to the largest k leaves for any f >= 0.
///
/// Errors have five parts: those of phi; the last Chebyshev coefficients of each panel; how far off
/// the sum is that ends an octave of k below, with coefficients of its own; and, of the
/// distribution function, what is left of phi at the largest k, as edges of f elsewhere leave it,
/// and what the coefficients do not foresee of larger k, where f near 0 has a smaller scale. Local.
class FourierInversion {
 public:
  struct Transformed {
    std::complex<double> value;
    double error = 0;  ///< of the modulus
  };
  using Transform = std::function<Transformed(double k)>;

  struct Limits {
    double accuracy = 1e-6;  ///< absolute, of the distribution function
    double highest = 0;      ///< of k
    int evaluations = 200;   ///< of phi, about
    double furthest = 0;     ///< of k, where more of phi than the accuracy is left at the highest
  };
  /// `even`: whether f is. Takes `mass` = phi(0), and mean and standard deviation of f/mass for the
  /// scales.
  FourierInversion(const Transform& phi, double mass, double mean, double deviation, bool even,
                   const Limits& limits);

  /// f(x), x not 0. O(highest |x|).
  [[nodiscard]] Uncertain density(double x) const { return between(x, &Integrals::density); }
  /// int f from -infinity to x. O(highest |x|).
  [[nodiscard]] Uncertain below(double x) const;
  /// Whether little enough is left of phi. Otherwise what follows from it says less of errors.
  [[nodiscard]] bool is_resolved() const;
  /// How often phi has been asked for.
  [[nodiscard]] int evaluations() const { return evaluations_; }

 private:
  using Complex = std::complex<double>;
  struct Panel {
    double low, high;
    double shift = 0;                 // the phase exp(i k shift) that has been taken out
    std::vector<Complex> terms = {};  // Chebyshev coefficients of the rest
    double rough = 0;                 // of the polynomial
    double doubt = 0;                 // of phi

    [[nodiscard]] int degree() const { return static_cast<int>(terms.size()) - 1; }
    /// k of a place from -1 to 1.
    [[nodiscard]] double at(double place) const {
      return (low + high) / 2 + (high - low) / 2 * place;
    }
  };
  /// Panels up to some k, and the coefficients of what is singular.
  struct Sum {
    std::size_t panels = 0;
    std::vector<double> singular;
  };
  struct Integrals {
    double density = 0, below = 0;
  };
  void sample(const Transform& phi, double low, double high, double tolerance, int most);
  [[nodiscard]] Panel interpolated(const Transform& phi, double low, double high, int degree);
  [[nodiscard]] Complex sampled(double k) const;
  // phi less what is singular.
  [[nodiscard]] Complex rest(const Sum& sum, double k) const;
  [[nodiscard]] std::vector<Complex> basis(double k) const;
  [[nodiscard]] Sum sum_up_to(std::size_t panels, double highest) const;
  // Sums over points k of panels weight exp(-i k x)/pi dk.
  template <class Add>
  void over_panels(std::size_t panels, double x, const Add& add) const;
  [[nodiscard]] Integrals integrals(const Sum& sum, double x) const;
  // int f up to x within an error that holds for whatever f >= 0 has the phi known.
  [[nodiscard]] Uncertain bounds(double x) const;
  void find_what_is_left(std::size_t first);  // on panels from that on, the last octave
  [[nodiscard]] Integrals singular(const Sum& sum, double x) const;
  // How far off int phi dk/k beyond the largest k may be: the terms foresee the next octave but for
  // so much, each further one by half of that more, and phi falls like k^(-1/2) at least.
  [[nodiscard]] double beyond(double x) const;
  [[nodiscard]] Uncertain between(double x, double Integrals::*which) const;

  bool even_;
  double mass_, mean_, scale_, accuracy_;
  int evaluations_ = 0;
  std::vector<Panel> panels_;
  std::vector<Sum> sums_;  // by octave
  double closest_ = 0;     // degrees of the polynomials of the last octave, by k
  double left_ = 0;        // of phi in the last octave
  double further_ = 0;     // of it in all that follow, as it falls
  double unforeseen_ = 0;  // of it by the terms found below that
  std::map<double, Transformed> known_;
};

// Small probabilities from a characteristic function of weighted paths.

/// The tail of a density f on the side of a tilt s, beyond x > 0 for s > 0 and below for s < 0:
/// with phi(k) = int f(x) exp((s + i k) x) dx / int f(x) exp(s x) dx and m that integral,
///
///   P(d) = m exp(-s d) 1/pi int_0^infinity Re exp(-i k d) phi(k)/|s + i k| dk,
///
/// where |s + i k| stands for s + i k or minus that, the sign being that of s. Nothing cancels for
/// d near the mean of the weighted density, so that the tail is as accurate as phi.
///
/// By the trapezoidal rule, which is off by the tails at d + n 2 pi/h, n = +-1, +-2 ..., and a
/// window that falls smoothly to 0 at the largest k, so that edges of f elsewhere do not show. Step
/// and largest k are refined for the mean. Errors are what changes by a step of twice the length
/// show, the changes by a range of two thirds, and those of phi. Local.
class TailInversion {
 public:
  using Transformed = FourierInversion::Transformed;

  /// Takes mean and standard deviation of the weighted density; `accuracy` is relative, `most` the
  /// largest number of wavenumbers.
  TailInversion(const FourierInversion::Transform& phi, double s, double mean, double deviation,
                double accuracy, int most);

  /// exp(s d) P(d)/m. O(wavenumbers).
  [[nodiscard]] Uncertain beyond(double d) const { return with_error(d, false); }
  /// exp(s d) f(d)/m. O(wavenumbers).
  [[nodiscard]] Uncertain density(double d) const { return with_error(d, true); }
  [[nodiscard]] int evaluations() const { return static_cast<int>(known_.size()); }

 private:
  // What is summed at k.
  [[nodiscard]] std::complex<double> weight(double k, double d, bool density) const;
  // With steps of `stride` times the step up to `share` of the range.
  [[nodiscard]] double sum(double d, bool density, int stride, double share) const;
  // By the tails at other d: what falls like exp(-1/h) is, with the step, the square of what it is
  // with twice the step.
  [[nodiscard]] double aliased(double d, bool density, double value) const;
  // By errors of phi.
  [[nodiscard]] double doubt(double d, bool density) const;
  [[nodiscard]] Uncertain with_error(double d, bool density) const;
  void sample(const FourierInversion::Transform& phi);

  double s_, step_;
  int count_ = 8;
  std::map<double, Transformed> known_;
};

}  // namespace stickslip::quantities
