#include <cmath>
#include <complex>
#include <numbers>

#include "../common/catch.hpp"
#include "stickslip/quantities/engines/inversion.hpp"

using namespace stickslip;
using Complex = std::complex<double>;
using Inversion = quantities::FourierInversion;

namespace {

constexpr double pi = std::numbers::pi;

/// Singular on the right, with a jump on the left, and a bell: x^(-1/2) exp(-x/2) with the mass
/// 0.3, exp(x) with 0.2, and a normal distribution about 1 with 0.4.
struct Mixture {
  static Inversion::Transformed phi(double k) {
    return {0.3 / std::sqrt(Complex(1, -2 * k)) + 0.2 / Complex(1, k) +
                0.4 * std::exp(Complex(-0.245 * k * k, k)),
            1e-12};
  }
  static double density(double x) {
    const double bell = 0.4 * std::exp(-(x - 1) * (x - 1) / 0.98) / std::sqrt(0.98 * pi);
    return bell + (x > 0 ? 0.3 * std::exp(-x / 2) / std::sqrt(2 * pi * x) : 0.2 * std::exp(x));
  }
  static double below(double x) {
    const double bell = 0.2 * std::erfc((1 - x) / std::sqrt(0.98));
    return bell + (x > 0 ? 0.2 + 0.3 * std::erf(std::sqrt(x / 2)) : 0.2 * std::exp(x));
  }
  static constexpr double mass = 0.9, mean = 0.5 / 0.9, square = (0.9 + 0.4 + 0.4 * 1.49) / 0.9;
};

Inversion inverted(double accuracy) {
  return {Mixture::phi,  Mixture::mass,
          Mixture::mean, std::sqrt(Mixture::square - Mixture::mean * Mixture::mean),
          false,         {accuracy, 1e6, 400}};
}

}  // namespace

TEST_CASE("fourier inversion: a singularity, a jump and a bell, within its errors") {
  for (const double accuracy : {1e-4, 1e-6, 1e-8}) {
    const auto f = inverted(accuracy);
    INFO("accuracy " << accuracy << ", " << f.evaluations() << " evaluations");
    for (const double x : {-3.0, -0.1, -0.001, 0.001, 0.01, 0.1, 1.0, 3.0, 6.0}) {
      const auto density = f.density(x), below = f.below(x);
      CHECK(std::abs(below.value - Mixture::below(x)) <= below.error);
      CHECK(below.error < 2 * accuracy);
      CHECK(std::abs(density.value - Mixture::density(x)) <= density.error);
    }
  }
}

TEST_CASE("fourier inversion: wrong transforms are further off than the errors of right ones") {
  const auto phi = [](double k) {
    auto found = Mixture::phi(k);
    found.value *= 1 + 1e-3 * k / (1 + k);
    return found;
  };
  const Inversion f(phi, Mixture::mass, Mixture::mean, 1, false, {1e-6, 1e6, 400});
  const auto below = f.below(1);
  CHECK(std::abs(below.value - Mixture::below(1)) > 10 * below.error);
}

// Half on either side: 1/2 exp(-|x|)/sqrt(pi |x|).
TEST_CASE("fourier inversion: even densities are their own mirror images") {
  const auto phi = [](double k) {
    return Inversion::Transformed{(1.0 / std::sqrt(Complex(1, -k))).real(), 1e-12};
  };
  const Inversion f(phi, 1, 0, std::sqrt(0.75), true, {1e-6, 1e6, 400});
  for (const double x : {0.01, 0.3, 2.0}) {
    CHECK(f.below(x).value == 1 - f.below(-x).value);
    CHECK(f.below(-x).value == Approx(std::erfc(std::sqrt(x)) / 2).margin(1e-7));
    CHECK(f.density(x).value == Approx(std::exp(-x) / std::sqrt(pi * x) / 2).epsilon(1e-5));
  }
}

// Where phi is given up to some k alone, what is beyond is an error and said to be one.
TEST_CASE("fourier inversion: a transform that is cut off has errors that say so") {
  const auto cut = [](double highest) {
    return Inversion(Mixture::phi, Mixture::mass, Mixture::mean, 1, false, {1e-6, highest, 400});
  };
  for (const double x : {-1.0, 0.01, 0.5}) {
    const auto below = cut(8).below(x);
    CHECK(below.error > 1e-6);
    CHECK(std::abs(below.value - Mixture::below(x)) <= below.error);
  }
}

// Far from 0 in units of its width: nothing is singular.
TEST_CASE("fourier inversion: a bell alone") {
  const auto phi = [](double k) {
    return Inversion::Transformed{std::exp(Complex(-k * k / 2, 10 * k)), 1e-12};
  };
  const Inversion f(phi, 1, 10, 1, false, {1e-6, 1e6, 400});
  for (const double x : {0.1, 8.0, 10.0, 11.0}) {
    const auto below = f.below(x);
    CHECK(std::abs(below.value - std::erfc((10 - x) / std::sqrt(2.0)) / 2) <= below.error);
    CHECK(below.error < 2e-6);
  }
}

// A gamma distribution of shape 1/2 with a share of a thirtieth of its scale, as where the shortest
// slips are of another kind: what lies beyond the largest k has not begun to show.
TEST_CASE("fourier inversion: a smaller scale near the singularity is within the errors") {
  for (const double small : {0.03, 0.01}) {
    const auto phi = [small](double k) -> Inversion::Transformed {
      return {0.7 / std::sqrt(Complex(1, -k)) + 0.3 / std::sqrt(Complex(1, -k * small)), 1e-12};
    };
    const Inversion f(phi, 1, 0.36, 0.63, false, {0.01, 12, 200});
    for (const double x : {1e-3, 1e-2, 0.1, 1.0}) {
      const auto below = f.below(x);
      const double known = 0.7 * std::erf(std::sqrt(x)) + 0.3 * std::erf(std::sqrt(x / small));
      INFO(small << " at " << x << ": " << below.value << " +- " << below.error << ", " << known);
      CHECK(std::abs(below.value - known) <= below.error);
    }
  }
}

// Bells of which some are far narrower than the deviation of all: their transforms, added, fall and
// rise again, whether k goes on until nothing is left or not.
TEST_CASE("fourier inversion: narrow parts are within the errors, resolved or not") {
  struct Bell {
    double mass, mean, deviation;
  };
  const std::vector<std::vector<Bell>> mixtures{{{0.86, 2.09, 0.03}, {0.14, 0.7, 0.9}},
                                                {{0.3, 2.1, 0.02}, {0.3, 1.9, 0.02}, {0.4, 0, 0.7}},
                                                {{0.5, 1, 0.02}, {0.5, -1, 0.02}}};
  for (const auto& bells : mixtures) {
    const auto phi = [&](double k) {
      Complex sum = 0;
      for (const auto& [mass, mean, deviation] : bells)
        sum += mass * std::exp(Complex(-k * k * deviation * deviation / 2, k * mean));
      return Inversion::Transformed{sum, 1e-12};
    };
    double mean = 0, square = 0;
    for (const Bell& b : bells) {
      mean += b.mass * b.mean;
      square += b.mass * (b.mean * b.mean + b.deviation * b.deviation);
    }
    const double spread = std::sqrt(square - mean * mean);
    for (const double furthest : {0.0, 500 / spread}) {
      const Inversion f(phi, 1, mean, spread, false, {0.01, 8 / spread, 400, furthest});
      for (double x = -1.497; x < 3; x += 0.01) {
        double density = 0, below = 0;
        for (const Bell& b : bells) {
          const double u = (x - b.mean) / b.deviation;
          density += b.mass * std::exp(-u * u / 2) / b.deviation / std::sqrt(2 * pi);
          below += b.mass * std::erfc(-u / std::sqrt(2.0)) / 2;
        }
        const auto of = f.density(x), up_to = f.below(x);
        INFO("up to " << furthest << ", at " << x << ": " << up_to.value << " +- " << up_to.error
                      << " for " << below << ", density " << of.value << " +- " << of.error
                      << " for " << density);
        CHECK(std::abs(up_to.value - below) <= up_to.error);
        CHECK(std::abs(of.value - density) <= 2 * of.error);
        CHECK(of.value >= 0);
      }
    }
    const Inversion resolved(phi, 1, mean, spread, false, {0.01, 8 / spread, 1000, 500 / spread});
    CHECK(resolved.below(2.1).error < 0.02);
  }
}
