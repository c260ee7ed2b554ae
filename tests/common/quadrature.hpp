#pragma once
/// Nodes and weights of composite Gauss rules.

#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <vector>

namespace stickslip::test {

/// sum_n weight[n] f(node[n]) ~ int f.
struct Quadrature {
  std::vector<double> node, weight;

  template <class Values>
  [[nodiscard]] double sum(const Values& value) const {
    double total = 0;
    for (std::size_t n = 0; n < node.size(); ++n) total += weight[n] * value(n);
    return total;
  }
};

/// int_a^b by panels of 10 Gauss points.
inline Quadrature panels(double a, double b, int count) {
  using Rule = boost::math::quadrature::gauss<double, 10>;
  Quadrature q;
  const double half = (b - a) / (2 * count);
  for (int panel = 0; panel < count; ++panel) {
    const double middle = a + (2 * panel + 1) * half;
    for (std::size_t n = 0; n < Rule::abscissa().size(); ++n) {
      for (int side : {-1, 1}) {
        q.node.push_back(middle + side * half * Rule::abscissa()[n]);
        q.weight.push_back(half * Rule::weights()[n]);
      }
    }
  }
  return q;
}

/// int_a^b, 0 < a < b, by panels of equal length in log t.
inline Quadrature logarithmic_panels(double a, double b, int count) {
  Quadrature q = panels(std::log(a), std::log(b), count);
  for (std::size_t n = 0; n < q.node.size(); ++n) {
    q.node[n] = std::exp(q.node[n]);
    q.weight[n] *= q.node[n];
  }
  return q;
}

}  // namespace stickslip::test
