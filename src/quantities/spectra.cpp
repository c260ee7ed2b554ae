#include "stickslip/quantities/spectra.hpp"

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <boost/math/tools/roots.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <numeric>

#include "stickslip/case/spectrum_rows.hpp"
#include "stickslip/case/sticking_rows.hpp"
#include "stickslip/quantities/engines/inversion.hpp"

namespace stickslip::quantities {
namespace {

using generator::StaticChain;
using generator::StaticPhase;
using generator::Symmetry;
using linalg::check;

constexpr int kMostPairs = 160;
// The lowest shift, in units of the rate at which the velocity forgets itself.
constexpr double kSlowest = 1e-2;

// Without symmetry L is singular. S_v, an even function of omega, is the same there as at 0 to
// rounding, and what rounding adds to the solution is a multiple of 1, which c does not see.
constexpr double kNearZero = 1e-10;         // of 1/tau
constexpr double kNearZeroOfMemory = 1e-6;  // of the rate at which the velocity forgets itself

using Density = std::function<double(double)>;

// S_v of a reduced model; from `turn` the formulas for large omega take over.
Density density_of(const Reduced& r, double turn) {
  const TransferFunction near(r.m, r.gamma, r.beta);
  return [turn, near, far = near.between(r.gamma * r.m * r.m, r.m * r.beta)](double omega) {
    const std::complex<double> z(0, omega);
    if (omega <= turn) return 2 * near(z).real();
    return -2 * far(z).imag() / (omega * omega * omega);
  };
}

// first, first ratio, first ratio^2, ... below last.
std::vector<double> geometric(double first, double last, double ratio) {
  std::vector<double> values;
  while (first < last) {
    values.push_back(first);
    first *= ratio;
  }
  return values;
}

// Frequencies at which a model is judged, rising: those asked for, 0, enough for the half width,
// and a grid up to the largest, where models may agree at single frequencies before they are right.
// `slow` and `fast` are the slowest and the fastest rate that shape the spectrum.
std::vector<double> judged(const std::vector<double>& omega, double slow, double fast) {
  std::vector<double> all = omega;
  all.push_back(0);
  for (double w : geometric(0.1 * slow, 20 * fast, 1.5)) all.push_back(w);
  const double last = omega.empty() ? 0 : *std::max_element(omega.begin(), omega.end());
  for (double w : geometric(1.3 * fast, std::min(last, 100 * fast), 1.1)) all.push_back(w);
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

// First omega at which S falls to half of S(0); NaN if there is none, as where a coarse grid makes
// S(0) negative.
double half_width(const Density& s, double tau) {
  const double half = s(0) / 2;
  if (!(half > 0)) return std::numeric_limits<double>::quiet_NaN();
  constexpr double step = 1.05, most = 1e9;
  double low = 0, high = 1e-3 / tau;
  while (s(high) > half) {
    low = high;
    high *= step;
    if (high * tau > most) return std::numeric_limits<double>::quiet_NaN();
  }
  if (!(s(high) <= half)) return std::numeric_limits<double>::quiet_NaN();
  std::uintmax_t iterations = 100;
  const auto bracket =
      boost::math::tools::toms748_solve([&](double w) { return s(w) - half; }, low, high,
                                        boost::math::tools::eps_tolerance<double>(52), iterations);
  return (bracket.first + bracket.second) / 2;
}

Uncertain full_width(const Density& s, double tau, double relative_error) {
  const double half = half_width(s, tau);
  const double step = 1e-4 * half;
  const double slope = (s(half + step) - s(half - step)) / (2 * step);
  // S at half width and S(0) have that relative error each.
  return {2 * half, 2 * relative_error * std::abs(s(0) / slope)};
}

// (1/pi) int_0^inf S: twice a decade a range, and C/omega^4 beyond. The library does not multiply
// the error by which it judges a range by its length: it sees a length of 2, whatever the unit of
// omega is.
Uncertain integral(const Density& s, double tau, double relative_error) {
  using Rule = boost::math::quadrature::gauss_kronrod<double, 21>;
  const double tolerance = std::max(1e-12, 0.01 * relative_error);
  double sum = 0, doubt = 0, low = 0;
  for (double high : geometric(1e-3 / tau, 1e6 / tau, std::sqrt(10))) {
    double error = 0;
    const double middle = (low + high) / 2, half = (high - low) / 2;
    const auto part = [&](double t) { return half * s(middle + half * t); };
    sum += Rule::integrate(part, -1.0, 1.0, 5, tolerance, &error);
    doubt += error;
    low = high;
  }
  sum += s(low) * low / 3;
  return {sum / std::numbers::pi, (doubt + relative_error * sum) / std::numbers::pi};
}

// The integral of the autocorrelation over its value at 0, by one solve next to lambda = 0: without
// symmetry L is singular.
double correlation_time(ProcessPencil& pencil, Vec b, Vec c) {
  const double variance = linalg::dot(c, b);
  const linalg::VecHandle x = linalg::copy_of(b);
  double time = pencil.a().discretisation().process.noise.correlation_time();
  for (double before = 0; before < 0.5 * time;) {
    before = time;
    pencil.solve(kSlowest / time, b, x, false, false);
    time = std::abs(linalg::dot(c, x)) / variance;
  }
  return time;
}

// Puts values at the frequencies of waves, each found on elements of its own, between the others.
void put_waves(const Computation& computation, Spectrum& spectrum) {
  const auto smooth = std::exchange(spectrum.value, {});
  auto next = smooth.begin();
  for (double omega : computation.question().omega) {
    const auto wave = computation.problem.waves.find(omega);
    if (wave == computation.problem.waves.end()) {
      spectrum.value.push_back(*next++);
      continue;
    }
    generator::Systems systems(computation.systems.comm(), wave->second,
                               computation.systems.statistics());
    const StationaryDistribution distribution(systems);
    systems.release({0, generator::symmetry_of(systems.process())});
    auto& value =
        spectrum.value.emplace_back(direct_spectrum(systems, distribution, {omega}).front());
    // No change between refinement levels shows waves that none of them follows.
    if (generator::has_unfollowed_waves(systems.process(), omega)) {
      value.error = std::max(value.error, std::abs(value.value));
    }
  }
}

void find_spectrum(Computation& computation, bool direct) {
  const auto& omega = computation.question().omega;
  const auto& distribution = computation.distribution();
  std::vector<double> smooth;
  std::ranges::copy_if(omega, std::back_inserter(smooth),
                       [&](double w) { return !computation.problem.waves.contains(w); });
  ReducedSpectrum reduced;
  auto& spectrum = reduced.spectrum;
  if (direct) {
    // A body on a spring does not travel: S_v(0) = 0.
    const bool travels = !computation.process().noise.has_positions();
    if (travels) smooth.push_back(0);
    spectrum.value = direct_spectrum(computation.systems, distribution, smooth);
    if (travels) {
      spectrum.at_zero = spectrum.value.back();
      spectrum.value.pop_back();
    }
  } else {
    reduced = reduced_spectrum(computation.systems, distribution, smooth, computation.tolerance());
  }
  put_waves(computation, spectrum);
  auto& results = computation.results();
  if (!omega.empty()) append_array(array(cases::kSV, omega), spectrum.value, results);
  results.push_back(scalar(cases::kS0, spectrum.at_zero));
  results.push_back(scalar(cases::kDiffusivity, 0.5 * spectrum.at_zero));
  if (direct) return;
  const auto& [full_width, variance] = reduced.shape;
  results.push_back(scalar(cases::kFullWidth, full_width));
  results.push_back(scalar(cases::kCorrelationTime, Uncertain{1, 0} / full_width));
  results.push_back(scalar(cases::kVarianceFromSpectrum, variance));
  results.back().diagnostic = true;
  computation.report("krylov_pairs", reduced.pairs,
                     "pairs of Krylov vectors in the reduced model of the spectrum");
  computation.report("krylov_shifts", static_cast<double>(reduced.shifts.size()),
                     "real shifts of the rational Krylov spaces of the spectrum");
}

using Function = generator::KolmogorovOperator::Observable;

// Values on 1 ... k of an odd function, spread over -k ... k.
std::vector<double> spread_odd(const std::vector<double>& upper) {
  const std::size_t k = upper.size();
  std::vector<double> all(2 * k + 1, 0.0);
  for (std::size_t i = 1; i <= k; ++i) {
    all[k + i] = upper[i - 1];
    all[k - i] = -upper[i - 1];
  }
  return all;
}

Function one() {
  return [](double, double, double) { return 1.0; };
}

/// Excursions from each of some levels by one symmetry: how long, discounted, their sliding phases
/// are in each state, and where these end.
class Sector {
 public:
  Sector(generator::Systems& systems, double lambda, Symmetry symmetry,
         const std::vector<int>& levels)
      : process_(systems.process()),
        lambda_(lambda),
        symmetry_(symmetry),
        system_(systems.at(lambda, symmetry)) {
    for (int level : levels) {
      auto& nu = occupations_.emplace_back(
          system_.factors().solve_transposed(system_.a().trace_at_start(level)));
      if (symmetry != Symmetry::odd) {
        linalg::check(VecAYPX(nu.correction, -1, nu.x));
        for (Vec each : std::array<Vec, 2>{nu.x, nu.correction})
          normalise(system_.a(), each, lambda);
        linalg::check(VecAYPX(nu.correction, -1, nu.x));
      }
      const auto p = system_.a().entry_rates(nu.x), step = system_.a().entry_rates(nu.correction);
      auto& entry = entries_.emplace_back();
      for (std::size_t k = 0; k < p.size(); ++k) {
        entry.push_back({PetscRealPart(p[k]), std::abs(PetscRealPart(step[k]))});
      }
    }
  }

  /// E[exp(-lambda T); the excursion ends in a way] from start t, given that by the first level of
  /// its sticking phase.
  [[nodiscard]] Uncertain exit_transform(std::size_t t, const std::vector<double>& exit) const {
    Uncertain sum;
    for (std::size_t k = 0; k < exit.size(); ++k) sum = sum + exit[k] * entries_[t][k];
    return sum;
  }

  /// w(f), for an f of this symmetry, by start.
  [[nodiscard]] std::vector<Uncertain> integral(const Function& f, bool quadratic,
                                                bool averaged = false) const {
    const auto rest = static_integral(f, averaged);
    const auto& a = system_.a();
    const linalg::VecHandle sliding = a.values(f, averaged);
    linalg::VecHandle overlooked = quadratic ? a.zeros() : a.overlooked(f);
    constexpr double rounding = 1e-12;
    const double size = std::max<double>(linalg::norm(sliding, NORM_INFINITY), largest_size(rest));
    if (linalg::norm(overlooked, NORM_INFINITY) <= rounding * size) overlooked = a.zeros();
    std::vector<Uncertain> w;
    for (std::size_t t = 0; t < occupations_.size(); ++t) {
      const auto& nu = occupations_[t];
      w.push_back(value_of(sliding, nu) + exit_transform(t, rest));
      w.back().error += std::abs(value_of(overlooked, nu).value);
    }
    return w;
  }

 private:
  // int exp(-lambda s) f(X_s, 0, 0) ds over a sticking phase, by its first level from the lowest
  // up.
  [[nodiscard]] std::vector<double> static_integral(const Function& f, bool averaged) const {
    const int lowest = process_.noise.lowest(), highest = process_.highest_static();
    const bool odd = symmetry_ == Symmetry::odd;
    const auto all =
        process_.noise.values([&f](const model::Place& x) { return f(x, 0, 0); }, averaged);
    std::vector<double> values(all.begin() + ((odd ? 1 : process_.lowest_static()) - lowest),
                               all.begin() + (highest + 1 - lowest));
    if (!odd) return StaticChain::of(process_, lambda_).integral(std::move(values));
    return spread_odd(
        StaticChain::odd(process_.noise, highest, lambda_).integral(std::move(values)));
  }

  const model::Process& process_;
  double lambda_;
  Symmetry symmetry_;
  generator::System& system_;
  std::vector<linalg::Solution> occupations_;
  std::vector<std::vector<Uncertain>> entries_;
};

// With symmetry all that s- gives is the same for even functions, and the opposite for odd ones.
Resolvent by_parity(generator::Systems& systems, double lambda,
                    const std::vector<model::Observable>& observables) {
  const auto& process = systems.process();
  const std::vector<int> start{process.exit_level(true)};
  const auto solve = [&](Symmetry parity, const std::vector<double>& exit, Uncertain& h,
                         Uncertain& w_one) {
    const Sector sector(systems, lambda, parity, start);
    h = sector.exit_transform(0, exit);
    if (parity == Symmetry::even) w_one = sector.integral(one(), true)[0];
    std::vector<Uncertain> w;
    for (const auto& f : observables) {
      w.push_back(sector.integral(generator::part_of(f, parity), f.quadratic)[0]);
    }
    systems.release({lambda, parity});
    return w;
  };
  const auto both = StaticChain::of(process, lambda).exit_transform(),
             apart = spread_odd(StaticChain::odd(process.noise, process.highest_static(), lambda)
                                    .upward_exit_transform());
  Uncertain h_even, h_odd, w_one;
  const auto w_even = solve(Symmetry::even, both, h_even, w_one);
  const auto w_odd = solve(Symmetry::odd, apart, h_odd, w_one);
  const Uncertain same = 0.5 * (h_even + h_odd), other = 0.5 * (h_even - h_odd);
  Resolvent r{{same, other, w_one}, {other, same, w_one}, {}};
  for (std::size_t n = 0; n < observables.size(); ++n) {
    // 1 - h_o = (1 - h_e) + 2 h^- and 1 - h_e = lambda w(s+; 1): a positive sum.
    const Uncertain mu = w_odd[n] / (lambda * w_one + 2.0 * other);
    r.of.push_back(
        {w_even[n] + w_odd[n], w_even[n] - w_odd[n], w_even[n] / w_one, mu, -1.0 * mu, {}, {}});
  }
  return r;
}

// The weights of starts in what stands for all on a side: one level, or all by their shares where
// these are given.
std::vector<double> weights_of_side(const model::Process& process, const std::vector<int>& levels,
                                    const std::vector<double>& shares, bool up) {
  const int level = process.exit_level(up), highest = process.highest_static();
  std::vector<double> weights;
  for (std::size_t t = 0; t < levels.size(); ++t) {
    const bool alike = (levels[t] > highest) == (level > highest);
    weights.push_back(shares.empty() ? (levels[t] == level ? 1 : 0) : (alike ? shares[t] : 0));
  }
  const double all = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (double& weight : weights) weight /= all;
  return weights;
}

Uncertain mean(const std::vector<double>& weights, const std::vector<Uncertain>& values) {
  Uncertain sum;
  for (std::size_t t = 0; t < weights.size(); ++t) {
    if (weights[t] != 0) sum = sum + weights[t] * values[t];
  }
  return sum;
}

// From all starts, one after the other.
Resolvent by_start(generator::Systems& systems, double lambda,
                   const std::vector<model::Observable>& observables,
                   const std::vector<double>& shares) {
  const auto& process = systems.process();
  const auto levels = process.starts();
  const Sector all(systems, lambda, Symmetry::none, levels);
  const auto chain = StaticChain::of(process, lambda);
  const std::size_t count = levels.size();
  const auto plus = weights_of_side(process, levels, shares, true),
             minus = weights_of_side(process, levels, shares, false);
  std::vector<std::vector<Uncertain>> h(count);
  for (int level : levels) {
    const auto exit = chain.exit_transform_to(level);
    for (std::size_t t = 0; t < count; ++t) h[t].push_back(all.exit_transform(t, exit));
  }
  const auto w_one = all.integral(one(), true);
  const auto up = chain.upward_exit_transform(), down = chain.downward_exit_transform();
  std::vector<Uncertain> h_up, h_down;
  for (std::size_t t = 0; t < count; ++t) {
    h_up.push_back(all.exit_transform(t, up));
    h_down.push_back(all.exit_transform(t, down));
  }
  const auto from = [&](const std::vector<double>& side) {
    return ExitTransforms{mean(side, h_up), mean(side, h_down), mean(side, w_one)};
  };
  Resolvent r{from(plus), from(minus), {}};
  const DiscountedStarts starts(lambda, w_one, h, shares.empty());
  for (const auto& f : observables) {
    const auto part = [&](Symmetry parity) {
      return all.integral(generator::part_of(f, parity), f.quadratic, f.formula != nullptr);
    };
    const auto w = part(Symmetry::none);
    Uncertain pi = starts.mean(w);
    auto mu = starts.apart(w);
    if (!process.drifts()) {
      // What mirror images make zero is exactly zero.
      pi = starts.mean(part(Symmetry::even));
      if (count == 2) mu = starts.apart(part(Symmetry::odd));
    }
    r.of.push_back({mean(plus, w), mean(minus, w), pi, mean(plus, mu), mean(minus, mu), {}, {}});
  }
  systems.release({lambda, Symmetry::none});
  return r;
}

}  // namespace

SpectrumShape shape_of(const Density& s, double tau, double bulk_error, double error) {
  return {full_width(s, tau, bulk_error), integral(s, tau, error)};
}

ReducedSpectrum reduced_spectrum(generator::Systems& systems,
                                 const StationaryDistribution& distribution,
                                 const std::vector<double>& omega,
                                 const ModelTolerance& tolerance) {
  const auto& noise = systems.process().noise;
  const double turn = 1 / noise.correlation_time();
  ProcessPencil pencil(systems, distribution.velocity_symmetry(), StaticPhase::kept);
  const auto [b, c] = distribution.velocity(pencil.a());
  const linalg::VecHandle d = distribution.weight_on(pencil.a());
  ReducedModel model(pencil, {b, c, d}, ReducedModel::Nature::smooth, kMostPairs);
  const double memory = correlation_time(pencil, b, c);
  const double least = distribution.process().symmetric() ? 0 : kNearZeroOfMemory / memory;
  const std::vector<double> frequencies =
      judged(omega, std::min(turn, 1 / memory), std::max(turn, 1 / memory));
  Questions questions;
  questions.values = [&](const Reduced& reduced) {
    const Density s = density_of(reduced, turn);
    std::vector<Uncertain> values;
    for (double w : frequencies) values.push_back({s(w), 0});
    return values;
  };
  // Beyond all rates S_v and, as moments at infinity agree, its error fall as omega^-4. There the
  // real part of c A (z + A)^-1 A b, which S_v is made of, falls below the rounding of the
  // imaginary one: models are compared where that does not count yet.
  const double end = 1e3 * std::max(turn, 1 / memory);
  for (std::size_t n = 0; n < frequencies.size(); ++n) {
    const double w = std::min(frequencies[n], end);
    questions.points.emplace_back(0, std::max(w, least));
    questions.terms.push_back(
        {{n, frequencies[n] > end ? 2 * std::pow(end / frequencies[n], 4) : 2}});
  }
  questions.each_by_its_size = true;
  questions.tolerance = tolerance.value;
  questions.first = {{kSlowest / memory, 1}, {5 * turn, 8}};
  questions.lowest = kSlowest / memory;
  questions.far = turn;
  const Answers answers = ask(model, questions, tolerance.recipe("spectrum"));

  const auto at = [&](double w) -> Uncertain {
    const auto n = static_cast<std::size_t>(
        std::lower_bound(frequencies.begin(), frequencies.end(), w) - frequencies.begin());
    return {answers.value[n], answers.error[n]};
  };
  ReducedSpectrum result;
  for (double w : omega) result.spectrum.value.push_back(at(w));
  result.spectrum.at_zero = at(0);
  const Density s = density_of(answers.model, turn);
  // What lies far out in the tail does not matter to the width.
  double bulk_error = 0;
  for (std::size_t n = 0; n < frequencies.size(); ++n) {
    if (frequencies[n] > 10 * std::max(turn, 1 / memory)) continue;
    bulk_error = std::max(bulk_error, answers.error[n] / std::abs(answers.value[n]));
  }
  result.shape = shape_of(s, noise.correlation_time(), bulk_error, answers.relative_error);
  // What the integral leaves of c v = E[V^2], known to rounding here, the model has not seen.
  auto& integrated = result.shape.variance;
  integrated.error = std::max(integrated.error, std::abs(integrated.value - linalg::dot(c, b)));
  result.pairs = answers.pairs;
  result.shifts = answers.shifts;
  return result;
}

std::vector<Uncertain> direct_spectrum(generator::Systems& systems,
                                       const StationaryDistribution& distribution,
                                       const std::vector<double>& omega) {
  const auto a = generator::assemble(systems.comm(), systems.discretisation(), 0,
                                     distribution.velocity_symmetry(), StaticPhase::kept,
                                     systems.statistics());
  const double turn = 1 / systems.process().noise.correlation_time(),
               least = distribution.process().symmetric() ? 0 : kNearZero * turn;
  const auto [b, c] = distribution.velocity(a);
  const linalg::VecHandle ab = a.zeros(), ca = a.zeros();
  check(MatMult(a.matrix(), b, ab));
  check(MatMultTranspose(a.matrix(), c, ca));
  std::vector<Uncertain> values;
  for (double w : omega) {
    generator::ComplexSolver solver(a, std::complex(0.0, std::max(w, least)), systems.statistics());
    const bool far = w > turn;
    const auto solution = solver.solve({linalg::copy_of(far ? ab : b), a.zeros()}, false);
    const Vec seen = far ? ca : c;
    const double factor = far ? -2 / (w * w) : 2;
    values.push_back({factor * linalg::dot(seen, solution.x.real),
                      std::abs(factor * linalg::dot(seen, solution.correction.real))});
  }
  return values;
}

void spectrum_tasks(Planner& planner) {
  planner.need_distribution();
  // What vanishes at 0 has no width there, which a reduced model would look for.
  const bool direct = planner.given().method.spectrum_solver == cases::SpectrumSolver::direct ||
                      planner.given().scene.spring;
  planner.needs().omega = planner.question().omega;
  // 0 as well, and the stationary distribution alone.
  const int frequencies = static_cast<int>(planner.question().omega.size()) + 2;
  planner.add_adaptive("spectrum", direct ? frequencies : 2, direct ? frequencies : 18,
                       [=](Computation& computation) { find_spectrum(computation, direct); });
}

// The chain is solved for directly, as it is meant: what is truncated of it differs between
// refinement levels. Levels beyond 40 deviations are below all rounding.
void noise_spectrum_tasks(Planner& planner) {
  const auto& scene = planner.given().scene;
  const auto target = scene.noise.target;
  auto chain = scene.meant().noise;
  const double far = 40 * chain.standard_deviation() / chain.step();
  chain.levels = static_cast<int>(std::min<double>(chain.levels, std::ceil(far)));
  planner.add({"noise spectrum", {}, [target, chain](Computation& computation) {
                 auto found = array(cases::kSX, computation.question().omega),
                      meant = array(cases::kSXTarget, computation.question().omega);
                 for (double omega : computation.question().omega) {
                   found.value.push_back(model::power_spectral_density(chain, omega));
                   if (target) meant.value.push_back(target(omega));
                 }
                 found.error.assign(found.value.size(), 0.0);
                 meant.error.assign(meant.value.size(), 0.0);
                 computation.results().push_back(std::move(found));
                 if (target) computation.results().push_back(std::move(meant));
               }});
}

Resolvent resolvent(generator::Systems& systems, double lambda,
                    const std::vector<model::Observable>& observables,
                    const std::vector<double>& shares) {
  Resolvent r = systems.process().symmetric() ? by_parity(systems, lambda, observables)
                                              : by_start(systems, lambda, observables, shares);
  for (auto& t : r.of) {
    if (lambda == 0) continue;
    t.u = (1 / lambda) * t.pi_lambda + t.mu_lambda;
    t.u_from_minus = (1 / lambda) * t.pi_lambda + t.mu_from_minus;
  }
  return r;
}

void append_resolvent(const std::vector<double>& lambda,
                      const std::vector<model::Observable>& observables,
                      const std::vector<Resolvent>& resolvents, bool symmetric, Results& results) {
  const auto add = [&](Result result, const auto& value) {
    for (const auto& r : resolvents) append_value(result, value(r));
    results.push_back(std::move(result));
  };
  const auto append = [&](const Row& row, const auto& value) { add(array(row, lambda), value); };
  append(cases::kHPlus, [](const Resolvent& r) { return r.from_plus.h_plus; });
  append(cases::kHMinus, [](const Resolvent& r) { return r.from_plus.h_minus; });
  // A difference of the two parities has no accuracy of its own size where they nearly cancel.
  if (symmetric) results.back().each_by_its_size = false;
  append(cases::kWOne, [](const Resolvent& r) { return r.from_plus.w_one; });
  if (!symmetric) {
    append(cases::kHPlusFromMinus, [](const Resolvent& r) { return r.from_minus.h_plus; });
    append(cases::kHMinusFromMinus, [](const Resolvent& r) { return r.from_minus.h_minus; });
    append(cases::kWOneFromMinus, [](const Resolvent& r) { return r.from_minus.w_one; });
  }
  const bool finite = std::all_of(lambda.begin(), lambda.end(), [](double l) { return l > 0; });
  for (std::size_t n = 0; n < observables.size(); ++n) {
    const auto& f = observables[n];
    const auto of = [&](const Row& row, Uncertain ObservableTransforms::*value) {
      add(array(blank(row, f), lambda), [n, value](const Resolvent& r) { return r.of[n].*value; });
    };
    if (finite) of(cases::kU, &ObservableTransforms::u);
    of(cases::kWPlus, &ObservableTransforms::w_plus);
    of(cases::kWMinus, &ObservableTransforms::w_minus);
    // Beside averages it may not take their name.
    const std::string average = cases::kPi.key_of(f.name);
    const bool taken = std::ranges::find(results, average, &Result::key) != results.end();
    of(cases::kPiLambda, &ObservableTransforms::pi_lambda);
    if (!taken) results.back().key = average;
    of(cases::kMu, &ObservableTransforms::mu_lambda);
    if (symmetric) continue;
    if (finite) of(cases::kUMinus, &ObservableTransforms::u_from_minus);
    of(cases::kMuMinus, &ObservableTransforms::mu_from_minus);
  }
}

void resolvent_tasks(Planner& planner) {
  const bool of_nodes = !planner.given().scene.meant().noise.has_levels();
  if (of_nodes) planner.need_distribution();
  const auto found = planner.collect<Resolvent>(
      [](const Computation& computation, const auto& all) {
        const auto& question = computation.question();
        append_resolvent(question.lambda, question.observables, all,
                         !computation.process().drifts(), computation.results());
      },
      true);
  planner.add_at_each_lambda([&](double lambda) {
    Task task{fmt::format("resolvent at lambda = {:g}", lambda)};
    task.uses = {{{lambda, Symmetry::even}, 0, 1}, {{lambda, Symmetry::odd}, 0, 1}};
    if (!planner.symmetric()) task.uses = {{{lambda, Symmetry::none}, 0, planner.starts()}};
    task.carry_out = [=](Computation& computation) {
      found->push_back(
          resolvent(computation.systems, lambda, computation.question().observables,
                    of_nodes ? computation.distribution().starts().shares : std::vector<double>{}));
    };
    return task;
  });
}

}  // namespace stickslip::quantities
