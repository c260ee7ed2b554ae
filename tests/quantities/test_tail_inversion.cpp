#include <boost/math/special_functions/erf.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <complex>

#include "../common/catch.hpp"
#include "stickslip/quantities/engines/inversion.hpp"

using namespace stickslip;
using Complex = std::complex<double>;
using quantities::TailInversion;

// exp(s x) makes of a normal distribution another one of the same deviation, with the mean s.
TEST_CASE("tail inversion: of a normal distribution") {
  for (const double s : {3.0, -4.5}) {
    const TailInversion found(
        [s](double k) {
          return TailInversion::Transformed{std::exp(Complex(-k * k / 2, k * s)), 0};
        },
        s, s, 1, 1e-6, 200);
    for (const double away : {-0.5, 0.0, 1.0}) {
      const double d = s + away, outside = s > 0 ? d : -d;
      const double tail = boost::math::erfc(outside / std::sqrt(2)) / 2,
                   density = std::exp(-d * d / 2) / std::sqrt(2 * M_PI);
      const auto beyond = found.beyond(d), here = found.density(d);
      const double size = std::exp(s * s / 2 - s * d);
      CHECK(size * beyond.value == Approx(tail).epsilon(1e-6));
      CHECK(std::abs(size * beyond.value - tail) <= size * beyond.error + 1e-12 * tail);
      CHECK(beyond.error < 1e-4 * beyond.value);
      CHECK(size * here.value == Approx(density).epsilon(1e-5));
    }
  }
}

// x exp(-x) becomes (1 - s)^2 x exp(-(1 - s) x), of which the transform falls like 1/k^2.
TEST_CASE("tail inversion: of a gamma distribution, from an edge on") {
  constexpr double s = 0.9, rate = 1 - s;
  const TailInversion found(
      [=](double k) {
        return TailInversion::Transformed{std::pow(rate / Complex(rate, -k), 2), 0};
      },
      s, 2 / rate, std::sqrt(2.0) / rate, 1e-5, 2000);
  for (const double d : {12.0, 20.0, 30.0}) {
    const double tail = boost::math::gamma_q(2, d), size = std::exp(-s * d) / (rate * rate);
    const auto beyond = found.beyond(d);
    INFO(d << ": " << size * beyond.value << " +- " << size * beyond.error << " for " << tail);
    CHECK(std::abs(size * beyond.value - tail) <= size * beyond.error);
    CHECK(beyond.error < 1e-3 * beyond.value);
  }
}

TEST_CASE("tail inversion: errors of the transform count") {
  const TailInversion found(
      [](double k) {
        return TailInversion::Transformed{std::exp(Complex(-k * k / 2, 3 * k)), 1e-3};
      },
      3, 3, 1, 1e-2, 50);
  const auto beyond = found.beyond(3);
  CHECK(beyond.error > 5e-4 * beyond.value);
  CHECK(beyond.error < 0.1 * beyond.value);
}
