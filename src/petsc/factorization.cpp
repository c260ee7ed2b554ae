#include "stickslip/petsc/factorization.hpp"

#include <fmt/format.h>
#include <petscsys.h>

#include <algorithm>
#include <cstdarg>
#include <sstream>
#include <string>
#include <utility>

#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/linear_solver.hpp"
#include "stickslip/petsc/scalars.hpp"
#include "stickslip/petsc/solver_options.hpp"
#include "stickslip/petsc/vectors.hpp"
#include "stickslip/support/errors.hpp"

namespace stickslip::petsc {
namespace {

constexpr double kBackwardErrorLimit = 1e-12;
constexpr int kMostRefinementSteps = 2;  // the second only where the first leaves too much
constexpr std::size_t kTogether = 32;    // right-hand sides, in memory at once

}  // namespace

Factorization::Factorization(Mat matrix, const std::string& prefix, SolverStatistics& statistics,
                             PCType pc_type)
    : measure_(matrix), prefix_(prefix), statistics_(statistics) {
  check(PetscObjectReference(reinterpret_cast<PetscObject>(matrix)));
  matrix_ = MatHandle(matrix);
  ksp_ = linear_solver(matrix_, prefix_, pc_type);
  factor();
}

void Factorization::factor() {
  double total = 0, symbolic = 0;
  {
    const PhaseTimer timer("factorisation", total);
    const EventTimer analysis("MatLUFactorSym");
    petsc::factor(ksp_, matrix_, prefix_);
    symbolic = analysis.seconds();
  }
  statistics_.analysis_seconds += symbolic;
  statistics_.factorization_seconds += total - symbolic;
  record_factors(ksp_, statistics_);
  ++(kComplex ? statistics_.factorizations_complex : statistics_.factorizations_real);
}

void Factorization::solve_once(Vec b, Vec x) {
  const PhaseTimer timer("solve", statistics_.solve_seconds);
  apply(b, x, false);
  ++statistics_.solves;
}

void Factorization::solve_transposed_once(Vec b, Vec x) {
  const PhaseTimer timer("solve", statistics_.solve_seconds);
  apply(b, x, true);
  ++statistics_.solves;
}

void Factorization::apply(Vec b, Vec x, bool transposed) {
  check(transposed ? KSPSolveTranspose(ksp_, b, x) : KSPSolve(ksp_, b, x));
  PetscInt iterations = 0;
  check(KSPGetIterationNumber(ksp_, &iterations));
  if (iterations > 1) statistics_.iterations += static_cast<int>(iterations);
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  check(KSPGetConvergedReason(ksp_, &reason));
  if (reason < 0) {
    throw NotReached(fmt::format("the solver -{} stopped: {}{}", prefix_,
                                 KSPConvergedReasons[reason], advice()));
  }
}

void Factorization::apply(std::span<const Vec> b, std::span<const Vec> x, bool transposed) {
  if (b.size() > 1 && solve_together(ksp_, b, x, transposed)) return;
  for (std::size_t n = 0; n < b.size(); ++n) apply(b[n], x[n], transposed);
}

std::vector<Solution> Factorization::solve(std::span<const Vec> b, bool transposed) {
  const PhaseTimer timer("solve", statistics_.solve_seconds);
  std::vector<Solution> all(b.size());
  for (std::size_t n = 0; n < b.size(); n += kTogether) {
    const std::size_t count = std::min(kTogether, b.size() - n);
    solve_some(b.subspan(n, count), std::span(all).subspan(n, count), transposed);
  }
  return all;
}

void Factorization::solve_some(std::span<const Vec> b, std::span<Solution> solutions,
                               bool transposed) {
  // One right-hand side, and its solution when it is sound.
  struct Column {
    Vec b;
    Solution* s;
    VecHandle residual, step;
  };
  std::vector<Column> open(b.size());
  std::vector<Vec> from(b.begin(), b.end()), to;
  for (std::size_t n = 0; n < b.size(); ++n) {
    Column& c = open[n];
    c.b = b[n];
    c.s = &solutions[n];
    for (VecHandle* vector : {&c.s->x, &c.s->correction, &c.residual, &c.step}) {
      check(VecDuplicate(c.b, vector->out()));
    }
    check(VecSet(c.s->correction, 0));
    to.push_back(c.s->x);
  }
  const auto compute_residual = [&](const Column& c) {
    check(transposed ? MatMultTranspose(matrix_, c.s->x, c.residual)
                     : MatMult(matrix_, c.s->x, c.residual));
    check(VecAYPX(c.residual, -1, c.b));
  };
  apply(from, to, transposed);
  statistics_.solves += static_cast<int>(b.size());
  for (int n = 0; n < kMostRefinementSteps && !open.empty(); ++n) {
    from.clear();
    to.clear();
    for (const Column& c : open) {
      compute_residual(c);  // again, as backward_error may overwrite it
      from.push_back(c.residual);
      to.push_back(c.step);
    }
    apply(from, to, transposed);
    for (Column& c : open) {
      check(VecAXPY(c.s->x, 1, c.step));
      check(VecAXPY(c.s->correction, 1, c.step));
      compute_residual(c);
      c.s->backward_error = transposed ? measure_.transposed(c.residual, c.b, c.s->x)
                                       : measure_.forward(c.residual, c.b, c.s->x);
      ++statistics_.corrections;
    }
    std::erase_if(open, [](const Column& c) { return c.s->backward_error <= kBackwardErrorLimit; });
  }
  if (!open.empty()) {
    throw NotReached(fmt::format("the solver -{} left a backward error of {:.1e} (limit {:.0e}){}",
                                 prefix_, open[0].s->backward_error, kBackwardErrorLimit,
                                 advice()));
  }
  for (const Solution& s : solutions) {
    statistics_.backward_error = std::max(statistics_.backward_error, s.backward_error);
  }
}

std::string Factorization::advice() const {
  if (is_own(ksp_)) return fmt::format("; -{}pc_type lu exchanges more rows", prefix_);
  PetscBool direct = PETSC_FALSE;
  check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(static_cast<KSP>(ksp_)), KSPPREONLY,
                               &direct));
  if (direct == PETSC_TRUE) {
    return fmt::format("; -{0}ksp_type gmres iterates around what -{0}pc_type chooses", prefix_);
  }
  return fmt::format("; try another -{0}pc_type, a smaller -{0}ksp_rtol or a larger -{0}ksp_max_it",
                     prefix_);
}

Analysis Factorization::analyse(Mat matrix, const std::string& prefix, SolverStatistics& statistics,
                                PCType pc_type) {
  const PhaseTimer timer("analysis", statistics.analysis_seconds);
  const KspHandle ksp = linear_solver(matrix, prefix, pc_type);
  return petsc::analyse(ksp, matrix, prefix);
}

namespace {

MatHandle small_matrix() {
  MatHandle unit;
  check(MatCreate(PETSC_COMM_SELF, unit.out()));
  check(MatSetSizes(unit, 2, 2, 2, 2));
  check(MatSetType(unit, MATAIJ));
  check(MatSetUp(unit));
  for (PetscInt i = 0; i < 2; ++i) check(MatSetValue(unit, i, i, 1, INSERT_VALUES));
  check(MatAssemblyBegin(unit, MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(unit, MAT_FINAL_ASSEMBLY));
  return unit;
}

// What a solver of that type reads.
void read_all_options(Mat matrix, const std::string& prefix, PCType pc_type) {
  const KspHandle ksp = linear_solver(matrix, prefix, pc_type);
  const auto amf = default_ordering(prefix);
  if (!is_own(ksp)) check(KSPSetUp(ksp));
}

std::string help_of_petsc;

PetscErrorCode collect_help(FILE* /*file*/, const char format[], va_list values) {
  constexpr std::size_t most = 1 << 16;
  std::string text(most, '\0');
  std::size_t size = 0;
  const PetscErrorCode code = PetscVSNPrintf(text.data(), most, format, &size, values);
  if (code == 0) help_of_petsc.append(text, 0, text.find('\0'));
  return code;
}

}  // namespace

void probe_linear_solver(const std::string& prefix) {
  read_all_options(small_matrix(), prefix, PCLU);
}

// Without options and types that this program refuses, and one that needs a known solution.
void print_linear_solver_options(const std::string& prefix) {
  const MatHandle unit = small_matrix();
  const auto usual = std::exchange(PetscVFPrintf, collect_help);
  check(PetscOptionsSetValue(nullptr, "-help", nullptr));
  read_all_options(unit, prefix, kElementsPc);
  check(PetscOptionsClearValue(nullptr, "-help"));
  PetscVFPrintf = usual;
  std::istringstream lines(help_of_petsc);
  for (std::string line; std::getline(lines, line);) {
    const bool option = line.starts_with("  -");
    const bool own = line.starts_with("  -" + prefix) &&
                     !line.starts_with(fmt::format("  -{}ksp_monitor_error", prefix));
    if (option && !own) continue;
    const std::string types = option ? types_of(line.substr(3, line.find(' ', 3) - 3)) : "";
    const auto list = line.find("(one of) ");
    if (!types.empty() && list != line.npos) line.replace(list + 9, line.npos, types);
    fmt::print("{}\n", line);
  }
}

}  // namespace stickslip::petsc
