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
  t_.assign(m.data(), m.data() + size * size);
  std::vector<Complex> q(size * size), values(size), work(64 * size + 1);
  std::vector<double> real_work(size);
  const int work_size = static_cast<int>(work.size());
  int selected = 0, info = 0;
  zgees_("V", "N", nullptr, &n_, t_.data(), &n_, &selected, values.data(), q.data(), &n_,
         work.data(), &work_size, real_work.data(), nullptr, &info);
  if (info != 0) throw std::runtime_error("the Schur form of a reduced model does not converge");
  left_.assign(size, 0.0);
  right_.assign(size, 0.0);
  for (std::size_t c = 0; c < size; ++c) {
    for (std::size_t r = 0; r < size; ++r) {
      left_[c] += left[r] * q[c * size + r];
      right_[c] += std::conj(q[c * size + r]) * right[r];
    }
  }
}

std::complex<double> TransferFunction::operator()(std::complex<double> z) const {
  std::vector<Complex> x = right_;
  Complex sum = 0;
  for (int c = n_ - 1; c >= 0; --c) {
    const Complex* column = t_.data() + static_cast<std::size_t>(c) * n_;
    x[c] /= z - column[c];
    for (int r = 0; r < c; ++r) x[r] += column[r] * x[c];
    sum += left_[c] * x[c];
  }
  return sum;
}

}  // namespace stickslip::exact
