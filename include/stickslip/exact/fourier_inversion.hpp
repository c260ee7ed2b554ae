#pragma once
/// A density and its distribution function from a characteristic function.

#include <complex>
#include <functional>
#include <map>
#include <vector>

#include "stickslip/support/uncertain.hpp"

namespace stickslip::exact {

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

}  // namespace stickslip::exact
