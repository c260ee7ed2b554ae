#include "stickslip/exact/transfer_function.hpp"

#include <stdexcept>

// NOLINTBEGIN(readability-identifier-naming): the names of LAPACK.
extern "C" {
using Complex = std::complex<double>;
void zgees_(const char* vectors, const char* sort, int (*select)(const Complex*), const int* n,
            Complex* a, const int* lda, int* selected, Complex* w, Complex* q, const int* ldq,
            Complex* work, const int* work_size, double* real_work, int* flags, int* info);
}
// NOLINTEND(readability-identifier-naming)

namespace stickslip::exact {

TransferFunction::TransferFunction(const Matrix& m, const std::vector<double>& left,
                                   const std::vector<double>& right)
    : n_(m.rows()) {
  const auto size = static_cast<std::size_t>(n_);
  std::vector<Complex> t(m.data(), m.data() + size * size), values(size), work(64 * size + 1);
  std::vector<double> real_work(size);
  q_.resize(size * size);
  const int work_size = static_cast<int>(work.size());
  int selected = 0, info = 0;
  if (n_ > 0) {
    zgees_("V", "N", nullptr, &n_, t.data(), &n_, &selected, values.data(), q_.data(), &n_,
           work.data(), &work_size, real_work.data(), nullptr, &info);
  }
  if (info != 0) throw std::runtime_error("the Schur form of a reduced model does not converge");
  for (const Complex& entry : t) {
    t_real_.push_back(entry.real());
    t_imaginary_.push_back(entry.imag());
  }
  set_ends(left, right);
}

TransferFunction TransferFunction::between(const std::vector<double>& left,
                                           const std::vector<double>& right) const {
  TransferFunction other = *this;
  other.set_ends(left, right);
  return other;
}

void TransferFunction::set_ends(const std::vector<double>& left, const std::vector<double>& right) {
  const auto size = static_cast<std::size_t>(n_);
  left_.assign(size, 0.0);
  right_.assign(size, 0.0);
  for (std::size_t c = 0; c < size; ++c) {
    for (std::size_t r = 0; r < size; ++r) {
      left_[c] += left[r] * q_[c * size + r];
      right_[c] += std::conj(q_[c * size + r]) * right[r];
    }
  }
}

// Back substitution, in real arithmetic that compilers turn into vector instructions: this is
// called for every frequency and every point of a quadrature.
std::complex<double> TransferFunction::operator()(std::complex<double> z) const {
  const auto size = static_cast<std::size_t>(n_);
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

}  // namespace stickslip::exact
