#include "stickslip/exact/transfer_function.hpp"

#include <algorithm>

namespace stickslip::exact {

using Complex = std::complex<double>;

TransferFunction::TransferFunction(const algebra::Matrix<double>& m,
                                   const std::vector<double>& left,
                                   const std::vector<double>& right) {
  algebra::SchurForm schur(m);
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

}  // namespace stickslip::exact
