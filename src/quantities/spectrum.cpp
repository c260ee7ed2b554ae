#include "stickslip/quantities/spectrum.hpp"

#include <algorithm>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <complex>
#include <limits>
#include <memory>
#include <numbers>

#include "stickslip/catalogue/spectrum_keys.hpp"
#include "stickslip/exact/transfer_function.hpp"
#include "stickslip/operators/complex_solver.hpp"
#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/vectors.hpp"
#include "stickslip/quantities/plan.hpp"
#include "stickslip/velocity/mesh.hpp"

namespace stickslip::quantities {
namespace {

using operators::KolmogorovOperator;
using operators::StaticPhase;
using petsc::check;

constexpr int kMostPairs = 160;
// The lowest shift, in units of the rate at which the velocity forgets itself.
constexpr double kSlowest = 1e-2;

// Without symmetry L is singular. S_v, an even function of omega, is the same there as at 0 to
// rounding, and what rounding adds to the solution is a multiple of 1, which c does not see.
constexpr double kNearZero = 1e-10;         // of 1/tau
constexpr double kNearZeroOfMemory = 1e-6;  // of the rate at which the velocity forgets itself

/// S_v of a reduced model.
class ReducedFunction {
 public:
  ReducedFunction(const Reduced& r, double turn)
      : turn_(turn),
        near_(r.m, r.gamma, r.beta),
        far_(near_.between(r.gamma * r.m * r.m, r.m * r.beta)) {}

  [[nodiscard]] double operator()(double omega) const {
    const std::complex<double> z(0, omega);
    if (omega <= turn_) return 2 * near_(z).real();
    return -2 * far_(z).imag() / (omega * omega * omega);
  }

 private:
  double turn_;  // where the formulas for large omega take over
  exact::TransferFunction near_, far_;
};

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

using Density = std::function<double(double)>;

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

// (1/pi) int_0^inf S: decade by decade, and C/omega^4 beyond.
Uncertain integral(const Density& s, double tau, double relative_error) {
  using Rule = boost::math::quadrature::gauss_kronrod<double, 21>;
  const double tolerance = std::max(1e-12, 0.01 * relative_error);
  double sum = 0, doubt = 0, low = 0;
  for (double high : geometric(1e-3 / tau, 1e6 / tau, std::sqrt(10))) {
    double error = 0;
    sum += Rule::integrate(s, low, high, 5, tolerance, &error);
    doubt += error;
    low = high;
  }
  sum += s(low) * low / 3;
  return {sum / std::numbers::pi, (doubt + relative_error * sum) / std::numbers::pi};
}

// The integral of the autocorrelation over its value at 0, by one solve next to lambda = 0: without
// symmetry L is singular.
double correlation_time(ProcessPencil& pencil, Vec b, Vec c) {
  const double variance = petsc::dot(c, b);
  const petsc::VecHandle x = petsc::copy_of(b);
  double time = pencil.a().discretisation().process.noise.correlation_time();
  for (double before = 0; before < 0.5 * time;) {
    before = time;
    pencil.solve(kSlowest / time, b, x, false, false);
    time = std::abs(petsc::dot(c, x)) / variance;
  }
  return time;
}

/// S_v at single frequencies by complex solves.
class DirectSpectrum {
 public:
  DirectSpectrum(operators::Systems& systems, const StationaryDistribution& distribution)
      : a_(operators::assemble(systems.comm(), systems.discretisation(), 0,
                               distribution.velocity_symmetry(), StaticPhase::kept,
                               systems.statistics())),
        statistics_(systems.statistics()),
        turn_(1 / systems.process().noise.correlation_time()),
        least_(distribution.process().symmetric() ? 0 : kNearZero * turn_),
        velocity_(distribution.velocity(a_)),
        ab_(a_.zeros()),
        ca_(a_.zeros()) {
    check(MatMult(a_.matrix(), velocity_.b, ab_));
    check(MatMultTranspose(a_.matrix(), velocity_.c, ca_));
  }

  [[nodiscard]] Uncertain operator()(double omega) {
    operators::ComplexSolver solver(a_, std::complex(0.0, std::max(omega, least_)), statistics_);
    const bool far = omega > turn_;
    const auto solution =
        solver.solve({petsc::copy_of(far ? ab_ : velocity_.b), a_.zeros()}, false);
    const Vec c = far ? ca_ : velocity_.c;
    const double factor = far ? -2 / (omega * omega) : 2;
    return {factor * petsc::dot(c, solution.x.real),
            std::abs(factor * petsc::dot(c, solution.correction.real))};
  }

 private:
  KolmogorovOperator a_;
  petsc::SolverStatistics& statistics_;
  double turn_, least_;
  StationaryDistribution::Velocity velocity_;
  petsc::VecHandle ab_, ca_;
};

}  // namespace

SpectrumShape shape_of(const Density& s, double tau, double bulk_error, double error) {
  return {full_width(s, tau, bulk_error), integral(s, tau, error)};
}

ReducedSpectrum reduced_spectrum(operators::Systems& systems,
                                 const StationaryDistribution& distribution,
                                 const std::vector<double>& omega,
                                 const ModelTolerance& tolerance) {
  const auto& noise = systems.process().noise;
  const double turn = 1 / noise.correlation_time();
  ProcessPencil pencil(systems, distribution.velocity_symmetry(), StaticPhase::kept);
  const auto [b, c] = distribution.velocity(pencil.a());
  const petsc::VecHandle d = distribution.weight_on(pencil.a());
  ReducedModel model(pencil, {b, c, d}, ReducedModel::Nature::smooth, kMostPairs);
  const double memory = correlation_time(pencil, b, c);
  const double least = distribution.process().symmetric() ? 0 : kNearZeroOfMemory / memory;
  const std::vector<double> frequencies =
      judged(omega, std::min(turn, 1 / memory), std::max(turn, 1 / memory));
  Questions questions;
  questions.values = [&](const Reduced& reduced) {
    const ReducedFunction s(reduced, turn);
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
  const ReducedFunction s(answers.model, turn);
  // What lies far out in the tail does not matter to the width.
  double bulk_error = 0;
  for (std::size_t n = 0; n < frequencies.size(); ++n) {
    if (frequencies[n] > 10 * std::max(turn, 1 / memory)) continue;
    bulk_error = std::max(bulk_error, answers.error[n] / std::abs(answers.value[n]));
  }
  result.shape = shape_of(s, noise.correlation_time(), bulk_error, answers.relative_error);
  // What the integral leaves of c v = E[V^2], known to rounding here, the model has not seen.
  auto& integrated = result.shape.variance;
  integrated.error = std::max(integrated.error, std::abs(integrated.value - petsc::dot(c, b)));
  result.pairs = answers.pairs;
  result.shifts = answers.shifts;
  return result;
}

std::vector<Uncertain> direct_spectrum(operators::Systems& systems,
                                       const StationaryDistribution& distribution,
                                       const std::vector<double>& omega) {
  DirectSpectrum direct(systems, distribution);
  std::vector<Uncertain> values;
  for (double w : omega) values.push_back(direct(w));
  return values;
}

void append_spectrum(const std::vector<double>& omega, const Spectrum& spectrum, Results& results) {
  if (!omega.empty()) append_array(array(catalogue::kSV, omega), spectrum.value, results);
  results.push_back(scalar(catalogue::kS0, spectrum.at_zero));
  results.push_back(scalar(catalogue::kDiffusivity, 0.5 * spectrum.at_zero));
}

void append_shape(const SpectrumShape& shape, Results& results) {
  results.push_back(scalar(catalogue::kFullWidth, shape.full_width));
  results.push_back(scalar(catalogue::kCorrelationTime, Uncertain{1, 0} / shape.full_width));
  results.push_back(scalar(catalogue::kVarianceFromSpectrum, shape.variance));
  results.back().diagnostic = true;
}

namespace {

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
    operators::Systems systems(computation.systems.comm(), wave->second,
                               computation.systems.statistics());
    const StationaryDistribution distribution(systems);
    systems.release({0, operators::symmetry_of(systems.process())});
    auto& value =
        spectrum.value.emplace_back(direct_spectrum(systems, distribution, {omega}).front());
    // No change between refinement levels shows waves that none of them follows.
    if (velocity::has_unfollowed_waves(systems.process(), omega)) {
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
    smooth.push_back(0);
    spectrum.value = direct_spectrum(computation.systems, distribution, smooth);
    spectrum.at_zero = spectrum.value.back();
    spectrum.value.pop_back();
  } else {
    reduced = reduced_spectrum(computation.systems, distribution, smooth, computation.tolerance());
  }
  put_waves(computation, spectrum);
  append_spectrum(omega, spectrum, computation.results());
  if (direct) return;
  append_shape(reduced.shape, computation.results());
  computation.report("krylov_pairs", reduced.pairs,
                     "pairs of Krylov vectors in the reduced model of the spectrum");
  computation.report("krylov_shifts", static_cast<double>(reduced.shifts.size()),
                     "real shifts of the rational Krylov spaces of the spectrum");
}

}  // namespace

void spectrum_tasks(Planner& planner) {
  planner.need_distribution();
  const bool direct = planner.given().method.spectrum_solver == cases::SpectrumSolver::direct;
  planner.needs().omega = planner.question().omega;
  // 0 as well, and the stationary distribution alone.
  const int frequencies = static_cast<int>(planner.question().omega.size()) + 2;
  planner.add_adaptive("spectrum", direct ? frequencies : 2, direct ? frequencies : 18,
                       [=](Computation& computation) { find_spectrum(computation, direct); });
}

}  // namespace stickslip::quantities
