#include "stickslip/quantities/correlations.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>

#include "engines/displacement_model.hpp"
#include "stickslip/case/displacement_rows.hpp"

namespace stickslip::quantities {
namespace {

using generator::ComplexVector;
using generator::KolmogorovOperator;
using generator::State;
using generator::StateKind;
using generator::StaticPhase;
using linalg::check;
using linalg::dot;

using Nature = ReducedModel::Nature;

/// u2' = -A2 u2 + f u1, u1' = -A1 u1, f a function of the state, as one vector: u2 and then u1 of
/// each rank.
class CoupledPencil final : public Pencil {
 public:
  CoupledPencil(ProcessPencil& outer, ProcessPencil& inner, Vec f) : outer_(outer), inner_(inner) {
    // Sliding states come in the same order, whatever the symmetry; at rest bodies do not move.
    const auto sliding = [](const KolmogorovOperator& a) {
      std::vector<PetscInt> places;
      PetscInt at = 0;
      a.states().for_each_local([&](const State& state) {
        if (state.kind != StateKind::static_phase || !a.states().symmetry_reduced())
          places.push_back(at);
        ++at;
      });
      return places;
    };
    outer_places_ = sliding(outer.a());
    inner_places_ = sliding(inner.a());
    const linalg::ReadView value(f);
    for (PetscInt place : inner_places_) f_.push_back(value[place]);
  }

  [[nodiscard]] linalg::VecHandle joined(Vec outer, Vec inner) const {
    PetscInt first = 0, second = 0;
    check(VecGetLocalSize(outer, &first));
    check(VecGetLocalSize(inner, &second));
    linalg::VecHandle all;
    check(VecCreateMPI(PetscObjectComm(reinterpret_cast<PetscObject>(outer)), first + second,
                       PETSC_DETERMINE, all.out()));
    join(outer, inner, all);
    return all;
  }

  void multiply(Vec x, Vec y, bool transposed) const override {
    const Parts given = apart(x), image = zeros();
    outer_.multiply(given.outer, image.outer, transposed);
    inner_.multiply(given.inner, image.inner, transposed);
    send(-1, given, image, transposed);
    join(image.outer, image.inner, y);
  }

  void solve(double z, Vec b, Vec x, bool transposed, bool refined) override {
    const Parts given = apart(b), found = zeros();
    const auto by = [&](ProcessPencil& pencil, Part part) {
      pencil.solve(z, given.*part, found.*part, transposed, refined);
    };
    transposed ? by(outer_, &Parts::outer) : by(inner_, &Parts::inner);
    send(1, found, given, transposed);
    transposed ? by(inner_, &Parts::inner) : by(outer_, &Parts::outer);
    join(found.outer, found.inner, x);
  }

  [[nodiscard]] ShiftedInverse shifted(std::complex<double> z) override {
    return [this, outer = outer_.shifted(z), inner = inner_.shifted(z)](const ComplexVector& b,
                                                                        bool transposed) {
      Parts real = apart(b.real), imaginary = apart(b.imaginary);
      const auto by = [&](const ShiftedInverse& inverse, Part part) {
        ComplexVector x = inverse({std::move(real.*part), std::move(imaginary.*part)}, transposed);
        real.*part = std::move(x.real);
        imaginary.*part = std::move(x.imaginary);
      };
      transposed ? by(outer, &Parts::outer) : by(inner, &Parts::inner);
      for (const Parts* parts : {&real, &imaginary}) send(1, *parts, *parts, transposed);
      transposed ? by(inner, &Parts::inner) : by(outer, &Parts::outer);
      ComplexVector x{linalg::copy_of(b.real), linalg::copy_of(b.imaginary)};
      join(real.outer, real.inner, x.real);
      join(imaginary.outer, imaginary.inner, x.imaginary);
      return x;
    };
  }

 private:
  struct Parts {
    linalg::VecHandle outer, inner;
  };
  using Part = linalg::VecHandle Parts::*;

  [[nodiscard]] Parts zeros() const { return {outer_.a().zeros(), inner_.a().zeros()}; }
  [[nodiscard]] Parts apart(Vec all) const {
    Parts parts = zeros();
    const linalg::ReadView from(all);
    linalg::WriteView outer(parts.outer), inner(parts.inner);
    const auto* middle = from.data() + outer.size();
    std::copy(from.data(), middle, outer.data());
    std::copy(middle, middle + inner.size(), inner.data());
    return parts;
  }
  static void join(Vec outer, Vec inner, Vec all) {
    const linalg::ReadView first(outer), second(inner);
    linalg::WriteView to(all);
    std::copy(second.data(), second.data() + second.size(),
              std::copy(first.data(), first.data() + first.size(), to.data()));
  }
  // y += sign f x, from the part of x that is solved for first into the other one of y.
  void send(double sign, const Parts& x, const Parts& y, bool transposed) const {
    const auto &from = transposed ? outer_places_ : inner_places_,
               &to = transposed ? inner_places_ : outer_places_;
    const linalg::ReadView values(transposed ? x.outer : x.inner);
    linalg::WriteView sums(transposed ? y.inner : y.outer);
    for (std::size_t n = 0; n < f_.size(); ++n) sums[to[n]] += sign * f_[n] * values[from[n]];
  }

  ProcessPencil &outer_, &inner_;
  std::vector<PetscInt> outer_places_, inner_places_;
  std::vector<PetscScalar> f_;
};

linalg::VecHandle scaled(Vec x, double factor) {
  linalg::VecHandle copy = linalg::copy_of(x);
  check(VecScale(copy, factor));
  return copy;
}

// The mean velocity, by which all bodies move alike.
void add_drift(const generator::Discretisation& discretisation, const Excursion& excursion,
               const std::vector<double>& time, std::vector<Uncertain>& mean) {
  const double drift = excursion.mean_drift(*discretisation.noise) / excursion.mean_excursion();
  const double defect = excursion.conservation_defect(discretisation);
  for (std::size_t n = 0; n < time.size(); ++n) {
    mean[n] = mean[n] + Uncertain{drift * time[n], defect * std::abs(drift) * time[n]};
  }
}

void find_transform(Computation& computation) {
  const auto& question = computation.question();
  const auto wavenumbers = question.values(cases::kWavenumber.option);
  const bool even = model::mirrors_itself(computation.process(), question.start);
  for (double t : question.time) {
    Result cosine = array_at(cases::kDisplacementCosine, t, wavenumbers),
           sine = array_at(cases::kDisplacementSine, t, wavenumbers);
    DisplacementModel model(computation.systems, computation.distribution(), question.start, t,
                            computation.tolerance().value);
    for (double k : wavenumbers) {
      DisplacementModel::Transform found{1, 0};
      if (t != 0 && k != 0) found = model.at(k);
      append_value(cosine, {found.value.real(), found.error});
      append_value(sine, even ? Uncertain{} : Uncertain{found.value.imag(), found.error});
    }
    for (auto* result : {&cosine, &sine}) computation.results().push_back(std::move(*result));
  }
}

}  // namespace

Displacement displacement(generator::Systems& systems, const StationaryDistribution& distribution,
                          const model::Start& start, const std::vector<double>& time,
                          const ModelTolerance& tolerance) {
  const TimeScales scales = time_scales(systems.process());
  ProcessPencil inner(systems, distribution.velocity_symmetry(), StaticPhase::kept);
  const auto velocity = distribution.velocity(inner.a());
  const Vec v = velocity.b;
  const double variance = dot(velocity.c, v), tau = scales.correlation;
  const double longest = std::max(*std::max_element(time.begin(), time.end()) / tau, 1e-9);
  const double spread = longest * longest / (1 + longest);  // variance of y, in about these units
  const linalg::VecHandle weight = distribution.weight_on(inner.a());
  Displacement x;
  x.mean.resize(time.size());
  x.variance.resize(time.size());
  const bool stationary = start.kind == model::Start::Kind::stationary;
  // From there E[x^2] grows as S_v(0) t, which a model of rough ends does not resolve: beyond the
  // time of memory the model gives only what another start changes, which stays bounded.
  constexpr double memory = 10;  // correlation times
  const bool beside_stationary = !stationary && longest > memory;
  if (stationary || beside_stationary) {
    const double unit = 2 * variance * tau * tau * spread;
    x.variance =
        time_curve(inner, {scaled(v, 2), velocity.c, weight}, Nature::smooth, {{2, unit}}, time,
                   scales, tolerance.value, tolerance.recipe("variance of displacement"))
            .value[0];
  }
  const bool still = model::mirrors_itself(systems.process(), start);
  if (!stationary) {
    // In units of the standard deviation of the velocity and of tau.
    const double unit = 1 / std::sqrt(variance);
    ProcessPencil outer(systems, generator::symmetry_of(systems.process()), StaticPhase::kept);
    const linalg::VecHandle b = scaled(v, unit / tau);
    CoupledPencil both(outer, inner, scaled(b, 2));
    const linalg::VecHandle first = start_on(inner.a(), start), second = start_on(outer.a(), start),
                            none = inner.a().zeros(), nothing = outer.a().zeros();
    if (!still && counts(first)) {
      x.mean = time_curve(inner, {b, first, weight}, nature_of(start), {{1, std::sqrt(spread)}},
                          time, scales, tolerance.value, tolerance.recipe("mean of displacement"))
                   .value[0];
    }
    if (beside_stationary) {
      check(VecAXPY(second, -1 / distribution.excursion().mean_excursion(),
                    distribution.occupation_on(outer.a())));
    }
    const linalg::VecHandle all_b = both.joined(nothing, b), all_c = both.joined(second, none),
                            all = both.joined(distribution.weight_on(outer.a()), weight);
    const auto square =
        time_curve(both, {all_b, all_c, all}, nature_of(start), {{1, spread}}, time, scales,
                   tolerance.value, tolerance.recipe("square of displacement"))
            .value[0];
    for (std::size_t n = 0; n < time.size(); ++n) {
      x.variance[n] = x.variance[n] + variance * tau * tau * (square[n] - x.mean[n] * x.mean[n]);
      x.mean[n] = tau / unit * x.mean[n];
    }
  }
  if (!still) add_drift(systems.discretisation(), distribution.excursion(), time, x.mean);
  return x;
}

void displacement_tasks(Planner& planner) {
  planner.need_distribution();
  const bool stationary = planner.question().start.kind == model::Start::Kind::stationary;
  const auto find = [](Computation& computation) {
    const auto& question = computation.question();
    const auto x = displacement(computation.systems, computation.distribution(), question.start,
                                question.time, computation.tolerance());
    append_array(array(cases::kDisplacementMean, question.time), x.mean, computation.results());
    append_array(array(cases::kDisplacementVariance, question.time), x.variance,
                 computation.results());
  };
  planner.add_adaptive("displacement", stationary ? 6 : 12, stationary ? 36 : 200, find);
}

void displacement_transform_tasks(Planner& planner) {
  planner.need_distribution();
  const auto& question = planner.question();
  const auto& wavenumbers = question.values(cases::kWavenumber.option);
  resolve_displacements(planner, largest_size(wavenumbers));
  const auto count = static_cast<int>(question.time.size() * wavenumbers.size());
  planner.add_adaptive("displacement transform", 2 * count, 50 * count, find_transform);
}

}  // namespace stickslip::quantities
