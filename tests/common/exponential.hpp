#pragma once
/// exp(M t) of small dense matrices, by squaring a Taylor polynomial in long double.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace stickslip::test {

/// Square, by rows.
class SmallMatrix {
 public:
  explicit SmallMatrix(std::size_t size, double diagonal = 0)
      : size_(size), entries_(size * size, 0.0L) {
    for (std::size_t r = 0; r < size; ++r) (*this)(r, r) = diagonal;
  }
  /// `entries` by rows.
  explicit SmallMatrix(const std::vector<double>& entries)
      : size_(static_cast<std::size_t>(std::lround(std::sqrt(entries.size())))),
        entries_(entries.begin(), entries.end()) {}
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] long double& operator()(std::size_t r, std::size_t c) {
    return entries_[r * size_ + c];
  }
  [[nodiscard]] long double operator()(std::size_t r, std::size_t c) const {
    return entries_[r * size_ + c];
  }
  /// Largest sum of the magnitudes of a row.
  [[nodiscard]] long double norm() const {
    long double largest = 0;
    for (std::size_t r = 0; r < size_; ++r) {
      long double sum = 0;
      for (std::size_t c = 0; c < size_; ++c) sum += std::abs((*this)(r, c));
      largest = std::max(largest, sum);
    }
    return largest;
  }
  SmallMatrix& operator*=(long double factor) {
    for (auto& entry : entries_) entry *= factor;
    return *this;
  }

 private:
  std::size_t size_;
  std::vector<long double> entries_;
};

inline SmallMatrix operator*(const SmallMatrix& a, const SmallMatrix& b) {
  SmallMatrix product(a.size());
  for (std::size_t r = 0; r < a.size(); ++r) {
    for (std::size_t s = 0; s < a.size(); ++s) {
      const long double factor = a(r, s);
      if (factor == 0) continue;
      for (std::size_t c = 0; c < a.size(); ++c) product(r, c) += factor * b(s, c);
    }
  }
  return product;
}

/// exp(M t). O(size^3 log |M t|).
inline SmallMatrix exponential(SmallMatrix m, double t) {
  m *= t;
  int squarings = 0;
  for (long double size = m.norm(); size > 0.5L; size /= 2) ++squarings;
  m *= std::pow(0.5L, squarings);
  // Horner: 1 + M (1 + M/2 (1 + M/3 (...))).
  SmallMatrix sum(m.size(), 1);
  for (int n = 20; n >= 1; --n) {
    sum = m * sum;
    sum *= 1.0L / n;
    for (std::size_t r = 0; r < m.size(); ++r) sum(r, r) += 1;
  }
  for (int n = 0; n < squarings; ++n) sum = sum * sum;
  return sum;
}

/// M x.
inline std::vector<double> times(const SmallMatrix& m, const std::vector<double>& x) {
  std::vector<double> y;
  for (std::size_t r = 0; r < m.size(); ++r) {
    long double sum = 0;
    for (std::size_t c = 0; c < m.size(); ++c) sum += m(r, c) * x[c];
    y.push_back(static_cast<double>(sum));
  }
  return y;
}

}  // namespace stickslip::test
