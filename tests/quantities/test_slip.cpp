#include <boost/math/quadrature/gauss.hpp>
#include <cmath>

#include "../common/catch.hpp"
#include "../common/solved.hpp"
#include "stickslip/linalg/vectors.hpp"
#include "stickslip/quantities/correlations.hpp"
#include "stickslip/quantities/durations.hpp"
#include "stickslip/quantities/passages.hpp"
#include "stickslip/quantities/spectra.hpp"

using namespace stickslip;
using generator::StaticPhase;
using quantities::FirstPassage;
using test::Solved;

namespace {

model::Scene telegraph(double bias) {
  auto s = test::scene(1, 0.5, 1, 0.25, {0, 0});
  s.noise.name = "telegraph";
  s.noise.table =
      std::make_shared<const model::LevelTable>(std::vector<model::Level>{{-1, 1, 0}, {1, 0, 1}});
  s.bias = bias;
  return s;
}

model::Scene linear(double bias = 0) {
  return test::biased(test::scene(1, 0.5, 1, 0.5, {1, 0}), bias);
}

model::Scene by_direction() { return test::by_direction(linear(0.2)); }

// Without any symmetry being made use of.
constexpr double kNothing = 1e-300;

double mean_slip(const Solved& solved) {
  quantities::Results results;
  quantities::append_mean_slip(solved.distribution.excursion(), results);
  return results.front().value[0];
}

}  // namespace

TEST_CASE("slips: telegraph noise without drag") {
  Solved solved(test::on_hp(telegraph(0.3), 10, 1e-14));
  CHECK(mean_slip(solved) == Approx(12).epsilon(1e-11));
  const auto moments = quantities::slip_moments(solved.systems, solved.distribution);
  CHECK(moments.net_mean.value == Approx(12).epsilon(1e-11));
  CHECK(moments.net_variance.value == Approx(moments.variance.value).epsilon(1e-11));
  constexpr double p = 0.8, q = 1.2, r = 1 / p - 1 / q;
  for (double w : {0.1, 0.6, 2.0, 20.0}) {
    const auto found = quantities::first_passage(solved.systems, solved.distribution.starts(), w);
    CHECK(found.exceeded.value == Approx((q - p) / (q * std::exp(r * w) - p)).epsilon(1e-11));
    // From the higher level at rest at once, else after the noise has switched.
    const double from_rest = found.from_rest.value, from_slide = found.from_slide.value;
    CHECK(from_rest == Approx(0.5 * (1 + from_slide) + 0.5 * from_slide).epsilon(1e-11));
  }
}

// By transforms, of which the clock is a part: F(s) = 1 - s E[S] + s^2 E[S^2]/2 - ...
TEST_CASE("slips: moments are derivatives of the transform", "[parallel]") {
  for (const auto& s : {linear(), by_direction()}) {
    for (const auto& d : {test::on_hp(s, 7), test::on_nodes(s, 7, 4)}) {
      Solved solved(d);
      const double mean = mean_slip(solved), h = 1e-3;
      const auto moments = quantities::slip_moments(solved.systems, solved.distribution);
      const double square = moments.variance.value + mean * mean;
      const auto at = [&](double x) {
        return quantities::slip_transform(solved.systems, solved.distribution, x).value;
      };
      const double once = 1 - at(h), twice = 1 - at(2 * h);
      CHECK((4 * once - twice) / (2 * h) == Approx(mean).epsilon(1e-4));
      CHECK((2 * once - twice) / (h * h) == Approx(square).epsilon(2e-2));
      CHECK(moments.net_variance.value + std::pow(moments.net_mean.value, 2) < square);
    }
  }
}

// The inverse of the transform, from the same systems but with real s alone: int exp(-s x) dF(x).
TEST_CASE("slips: the distribution has that transform") {
  Solved solved(test::on_hp(linear(), 9));
  std::vector<double> distance, weight;
  using Rule = boost::math::quadrature::gauss<double, 20>;
  constexpr double ends[] = {0, 1e-3, 0.01, 0.05, 0.2, 0.6, 1.5, 3, 6, 10, 15};
  for (std::size_t e = 1; e < std::size(ends); ++e) {
    const double half = (ends[e] - ends[e - 1]) / 2, middle = ends[e] - half;
    for (std::size_t n = 0; n < Rule::abscissa().size(); ++n) {
      for (double sign : {-1.0, 1.0}) {
        distance.push_back(middle + sign * half * Rule::abscissa()[n]);
        weight.push_back(half * Rule::weights()[n]);
      }
    }
  }
  const auto slips =
      quantities::slip_distribution(solved.systems, solved.distribution, distance, 1e-8);
  for (double s : {2.0, 10.0}) {
    double sum = 0;
    for (std::size_t n = 0; n < distance.size(); ++n) {
      sum += s * weight[n] * std::exp(-s * distance[n]) * slips.distribution[n].value;
    }
    const auto transform = quantities::slip_transform(solved.systems, solved.distribution, s);
    CHECK(sum == Approx(transform.value).epsilon(1e-6));
  }
}

// Renewal against one backward equation with the sticking phase as unknowns.
TEST_CASE("first passage: the mean time solves its backward equation", "[parallel]") {
  auto one_sided = telegraph(0.2);
  for (const auto& s : {linear(), linear(kNothing), by_direction(), one_sided}) {
    for (const auto& d : {test::on_hp(s, 8), test::on_nodes(s, 7, 3), test::on_upwind(s, 4)}) {
      Solved solved(d);
      const auto& process = solved.systems.process();
      for (double w : {0.02, 0.3, 1.0}) {
        const FirstPassage found =
            quantities::first_passage(solved.systems, solved.distribution.starts(), w);
        generator::SystemKey key{0, generator::symmetry_of(process), StaticPhase::kept};
        key.speed_limit = w;
        auto& whole = solved.systems.at(key);
        const auto ones = whole.a().values([](double, double, double) { return 1.0; });
        const auto time = whole.factors().solve(ones);
        const auto rest = whole.a().mean_at(model::stationary_distribution(process.noise));
        CHECK(linalg::dot(solved.distribution.starts_on(whole.a()), time.x) ==
              Approx(found.from_slide.value).epsilon(1e-9));
        CHECK(linalg::dot(rest, time.x) == Approx(found.from_rest.value).epsilon(1e-9));
        solved.systems.keep({});
      }
    }
  }
}

TEST_CASE("slips: as the asymmetry vanishes everything has its symmetric value") {
  Solved symmetric(test::on_hp(linear(), 8)), nearly(test::on_hp(linear(kNothing), 8));
  const auto a = quantities::slip_moments(symmetric.systems, symmetric.distribution),
             b = quantities::slip_moments(nearly.systems, nearly.distribution);
  CHECK(b.variance.value == Approx(a.variance.value).epsilon(1e-11));
  CHECK(b.net_variance.value == Approx(a.net_variance.value).epsilon(1e-11));
  const std::vector<double> time{0.3, 4};
  for (const auto& start :
       {model::Start{3}, model::Start{1, -0.3}, model::Start{0, 0, model::Start::Kind::rest},
        model::Start{0, 0, model::Start::Kind::stationary}}) {
    const auto x = quantities::displacement(symmetric.systems, symmetric.distribution, start, time,
                                            1e-9),
               y = quantities::displacement(nearly.systems, nearly.distribution, start, time, 1e-9);
    for (std::size_t n = 0; n < time.size(); ++n) {
      for (auto member : {&quantities::Displacement::mean, &quantities::Displacement::variance}) {
        const auto one = (x.*member)[n], other = (y.*member)[n];
        CHECK(std::abs(one.value - other.value) <= one.error + other.error + 1e-9);
        CHECK(one.error + other.error < 2e-5);
      }
    }
  }
}

TEST_CASE("displacement: spreads by the autocovariance, and at last with S_0", "[parallel]") {
  for (const auto& s : {linear(), by_direction()}) {
    Solved solved(test::on_hp(s, 7));
    const auto of = [&](model::Start::Kind kind, const std::vector<double>& time) {
      return quantities::displacement(solved.systems, solved.distribution, {3, 0, kind}, time,
                                      1e-9);
    };
    using enum model::Start::Kind;
    // 2 int_0^1 (1 - s) C(s) ds
    using Rule = boost::math::quadrature::gauss<double, 20>;
    std::vector<double> lag, weight;
    for (std::size_t n = 0; n < Rule::abscissa().size(); ++n) {
      for (double sign : {-1.0, 1.0}) {
        lag.push_back((1 + sign * Rule::abscissa()[n]) / 2);
        weight.push_back(Rule::weights()[n] / 2);
      }
    }
    const auto c = quantities::autocorrelation(solved.systems, solved.distribution, lag, 1e-10);
    double variance = 0;
    for (std::size_t n = 0; n < lag.size(); ++n) {
      variance += 2 * weight[n] * (1 - lag[n]) * c[n].value;
    }
    CHECK(of(stationary, {1}).variance[0].value == Approx(variance).epsilon(1e-7));
    // Far from the start every one spreads alike.
    const auto spectrum =
        quantities::reduced_spectrum(solved.systems, solved.distribution, {}, 1e-9).spectrum;
    const auto& excursion = solved.distribution.excursion();
    const double drift =
        excursion.mean_drift(*solved.systems.discretisation().noise) / excursion.mean_excursion();
    for (auto kind : {stationary, rest, state}) {
      const auto x = of(kind, {60, 100});
      CHECK((x.variance[1].value - x.variance[0].value) / 40 ==
            Approx(spectrum.at_zero.value).epsilon(1e-6));
      CHECK((x.mean[1].value - x.mean[0].value) / 40 == Approx(drift).epsilon(1e-7).margin(1e-8));
    }
  }
}

// Before the noise jumps: x = v t + a t^2/2, and in the variance nothing but jumps.
// The velocity then is a thousand times slower than the noise.
TEST_CASE("displacement: keeps its growth under fast noise") {
  auto s = test::scene(1, 1, 0.01, 2, {0, 0});
  Solved solved(test::on_hp(s, 6));
  const double slope = quantities::reduced_spectrum(solved.systems, solved.distribution, {}, 1e-7)
                           .spectrum.at_zero.value;
  using enum model::Start::Kind;
  for (auto kind : {stationary, rest}) {
    const auto x = quantities::displacement(solved.systems, solved.distribution, {0, 0, kind},
                                            {1, 300, 500}, 1e-7);
    CHECK((x.variance[2].value - x.variance[1].value) / 200 == Approx(slope).epsilon(1e-4));
    CHECK(x.variance[0].value > 0);
    CHECK(x.variance[0].value < slope);
  }
}

TEST_CASE("displacement: begins at the start asked for") {
  const auto s = linear();
  Solved solved(test::on_hp(s, 8));
  const auto& process = solved.systems.process();
  const model::Start start{2, 0.4};
  const double t = 1e-3, force = process.net_force(2) - 0.4;
  const auto x = quantities::displacement(solved.systems, solved.distribution, start, {t}, 1e-9);
  CHECK(x.mean[0].value == Approx(0.4 * t + force * t * t / 2).epsilon(1e-6));
  CHECK(x.variance[0].value < 1e-4 * t * t);
  CHECK(x.variance[0].value > -x.variance[0].error - 1e-13);
}
