#pragma once
/// left (z - M)^-1 right for many z, M small and dense.

#include <complex>
#include <vector>

#include "stickslip/algebra/dense.hpp"

namespace stickslip::exact {

/// H(z) = left (z - M)^-1 right through the Schur form M = Q T Q^H (algebra::SchurForm), backward
/// stable for matrices far from normal too. O(n^3) once, O(n^2) a value.
class TransferFunction {
 public:
  /// Throws NotReached when the Schur form does not converge.
  TransferFunction(const algebra::Matrix<double>& m, const std::vector<double>& left,
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

  algebra::Matrix<std::complex<double>> q_;
  std::vector<double> t_real_, t_imaginary_;        // upper triangle, by columns
  std::vector<std::complex<double>> left_, right_;  // left Q, Q^H right
};

}  // namespace stickslip::exact
