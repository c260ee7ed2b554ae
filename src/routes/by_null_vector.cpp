#include <algorithm>
#include <cmath>

#include "averages.hpp"
#include "routes.hpp"
#include "stickslip/catalogue/averages_keys.hpp"
#include "stickslip/catalogue/sticking_keys.hpp"
#include "stickslip/operators/systems.hpp"
#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/eigensolver.hpp"
#include "stickslip/petsc/vectors.hpp"

namespace stickslip::routes {
namespace {

using operators::KolmogorovOperator;
using operators::Symmetry;
using petsc::check;
using quantities::scalar;
using quantities::Uncertain;

// Prefix of the PETSc options of this eigensolver.
constexpr const char* kNullPrefix = "null_";

void normalise(Vec pi) {
  PetscScalar mass = 0;
  check(VecSum(pi, &mass));
  check(VecScale(pi, 1.0 / mass));
}

// Smallest entry, 0 if none is negative; on an upwind grid pi is a probability.
double most_negative(MPI_Comm comm, Vec pi) {
  double smallest = 0;
  {
    const petsc::ReadView local(pi);
    for (PetscInt n = 0; n < local.size(); ++n) {
      smallest = std::min(smallest, static_cast<double>(PetscRealPart(local[n])));
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, &smallest, 1, MPI_DOUBLE, MPI_MIN, comm);
  return smallest;
}

// ||pi M||_1 / max row sum of |M|.
double relative_residual(Mat transposed, Vec pi) {
  petsc::VecHandle residual;
  check(VecDuplicate(pi, residual.out()));
  check(MatMult(transposed, pi, residual));
  PetscReal size = 0, norm = 0;
  check(VecNorm(residual, NORM_1, &size));
  check(MatNorm(transposed, NORM_1, &norm));
  return size / norm;
}

double integral(const KolmogorovOperator& a, Vec pi, const KolmogorovOperator::Observable& f) {
  return petsc::dot(a.values(f), pi);
}

// By renewal, excursions end at the rates at which pi leaves the static levels.
Uncertain mean_excursion(const Problem& problem, const KolmogorovOperator& a, Vec pi, Vec before) {
  const auto& process = problem.discretisation.process;
  const auto rates = process.exit_rates();
  const petsc::VecHandle exits = a.zeros();
  {
    petsc::WriteView local(exits);
    PetscInt at = 0;
    a.states().for_each_local([&](const operators::State& state) {
      const bool rests = state.kind == operators::StateKind::static_phase;
      local[at++] = rests ? rates[state.noise - process.lowest_static()] : 0;
    });
  }
  const double value = 1 / petsc::dot(exits, pi);
  return {value, std::abs(value - 1 / petsc::dot(exits, before))};
}

void append_durations(Uncertain excursion, quantities::Results& results) {
  const auto share = [&](const quantities::Row& row) {
    const auto r = std::find_if(results.begin(), results.end(),
                                [&row](const auto& result) { return result.key == row.key; });
    return Uncertain{r->value[0], r->error[0]};
  };
  const Uncertain stick = share(catalogue::kPStick) * excursion,
                  slide = share(catalogue::kPSlide) * excursion;
  results.push_back(scalar(catalogue::kMeanStick, stick));
  results.push_back(scalar(catalogue::kMeanSlide, slide));
  results.push_back(scalar(catalogue::kMeanExcursion, excursion));
}

}  // namespace

Evaluation by_null_vector(const Problem& problem) {
  const auto a = operators::assemble(problem.comm, problem.discretisation, 0, Symmetry::none,
                                     operators::StaticPhase::kept, problem.statistics);
  petsc::MatHandle transposed;  // of -M; its null vector is pi
  check(MatTranspose(a.matrix(), MAT_INITIAL_MATRIX, transposed.out()));
  // All eigenvalues of -M have real parts >= 0, and 0 is the one nearest to a small negative
  // target.
  const double target = -1e-6 / problem.discretisation.process.noise.correlation_time();
  petsc::Eigensolver solver(transposed, kNullPrefix, target, 1, problem.statistics);
  const Vec before = solver.pairs()[0].real;
  normalise(before);
  petsc::VecHandle pi;
  check(VecDuplicate(before, pi.out()));
  check(VecCopy(before, pi));
  solver.iterate(pi);
  normalise(pi);

  Evaluation evaluation;
  std::vector<Uncertain> values;
  for (const auto& average : averages(problem)) {
    const double value = integral(a, pi, average.f);
    values.push_back({value, std::abs(value - integral(a, before, average.f))});
  }
  append_averages(problem, values, evaluation.results);
  using catalogue::Quantity;
  const auto& question = problem.given.question;
  if (question.wants(Quantity::sticking) || question.wants(Quantity::averages)) {
    const Uncertain excursion = mean_excursion(problem, a, pi, before);
    if (question.wants(Quantity::sticking)) append_durations(excursion, evaluation.results);
    if (question.wants(Quantity::averages)) {
      evaluation.results.push_back(scalar(catalogue::kSlipRate, Uncertain{1, 0} / excursion));
    }
  }
  evaluation.checks = {
      {"norm_pi_M_over_norm_M", relative_residual(transposed, pi),
       "residual of the null vector pi of the generator M"},
      {"most_negative_pi", most_negative(problem.comm, pi), "smallest entry of pi"}};
  return evaluation;
}

}  // namespace stickslip::routes
