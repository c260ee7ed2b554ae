#include "stickslip/linalg/solver.hpp"

#include <fmt/format.h>
#include <petscsys.h>
#include <petsctime.h>

#include <algorithm>
#include <cstdarg>
#include <cstring>
#include <sstream>

#include "stickslip/linalg/session.hpp"

namespace stickslip::linalg {
namespace {

// Of the largest component of a forward solution: smaller ones need not be right relative to their
// own size. Where an element is thin or a transform has decayed they are tens of orders smaller,
// and the factors mix their rows with others; what that does to a functional shows in the last step
// of iterative refinement.
constexpr double kNegligible = 1e-13;

void take_magnitudes_of_block(Mat block) {
  MatInfo info{};
  check(MatGetInfo(block, MAT_LOCAL, &info));
  PetscScalar* values = nullptr;
  check(MatSeqAIJGetArray(block, &values));
  for (PetscInt n = 0; n < static_cast<PetscInt>(info.nz_used); ++n) {
    values[n] = PetscAbsScalar(values[n]);
  }
  check(MatSeqAIJRestoreArray(block, &values));
}

MatHandle magnitudes(Mat matrix) {
  MatHandle copy;
  check(MatDuplicate(matrix, MAT_COPY_VALUES, copy.out()));
  PetscBool sequential = PETSC_FALSE;
  check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(matrix), MATSEQAIJ, &sequential));
  if (sequential == PETSC_TRUE) {
    take_magnitudes_of_block(copy);
  } else {
    Mat diagonal = nullptr, off_diagonal = nullptr;
    check(MatMPIAIJGetSeqAIJ(copy, &diagonal, &off_diagonal, nullptr));
    take_magnitudes_of_block(diagonal);
    take_magnitudes_of_block(off_diagonal);
  }
  return copy;
}

// Of the rows.
VecHandle magnitude_sums(Mat matrix) {
  VecHandle sums;
  check(MatCreateVecs(matrix, nullptr, sums.out()));
  PetscInt begin = 0, end = 0;
  check(MatGetOwnershipRange(matrix, &begin, &end));
  WriteView local(sums);
  for (PetscInt r = begin; r < end; ++r) {
    double sum = 0;
    RowView(matrix, r).for_each(
        [&sum](PetscInt, PetscScalar value) { sum += PetscAbsScalar(value); });
    local[r - begin] = sum;
  }
  return sums;
}

VecHandle absolute(Vec x) {
  VecHandle size = copy_of(x);
  check(VecAbs(size));
  return size;
}

PetscLogStage stage_named(const char* name) {
  PetscLogStage stage = -1;
  check(PetscLogStageGetId(name, &stage));
  if (stage < 0) check(PetscLogStageRegister(name, &stage));
  return stage;
}

// So far, in the current stage.
double logged_seconds(PetscLogEvent event) {
  PetscEventPerfInfo info{};
  check(PetscLogEventGetPerfInfo(PETSC_DETERMINE, event, &info));
  return info.time;
}

PC preconditioner_of(KSP ksp) {
  PC pc = nullptr;
  check(KSPGetPC(ksp, &pc));
  return pc;
}

PCFailedReason failure_of(KSP ksp) {
  PCFailedReason reason = PC_NOERROR;
  check(PCGetFailedReason(preconditioner_of(ksp), &reason));
  return reason;
}

bool uses_mumps(KSP ksp) {
  MatSolverType type = nullptr;
  check(PCFactorGetMatSolverType(preconditioner_of(ksp), &type));
  return type != nullptr && std::strcmp(type, MATSOLVERMUMPS) == 0;
}

Mat factor_of(KSP ksp) {
  Mat factor = nullptr;
  check(PCFactorGetMatrix(preconditioner_of(ksp), &factor));
  return factor;
}

PetscInt infog(KSP ksp, PetscInt number) {
  PetscInt value = 0;
  check(MatMumpsGetInfog(factor_of(ksp), number, &value));
  return value;
}

// Of the codes of MUMPS that occur in practice.
std::string meaning_of(PetscInt info) {
  switch (info) {
  case -8:
  case -9: return "its workspace was too small, also when it was enlarged (ICNTL(14))";
  case -10: return "the matrix is singular";
  case -13: return "the system gave it no more memory";
  case -19: return "the workspace allowed by ICNTL(23) is too small; allow more, or leave it out";
  case -90: return "it could not write its factors to disk (MUMPS_OOC_TMPDIR)";
  default: return "see INFOG(1) in its users' guide";
  }
}

std::string describe_failure(KSP ksp) {
  if (!uses_mumps(ksp)) return "no factors, as the matrix may be singular";
  const PetscInt info1 = infog(ksp, 1), info2 = infog(ksp, 2);
  return fmt::format("MUMPS stopped with INFOG(1) = {}, INFOG(2) = {}: {}", info1, info2,
                     meaning_of(info1));
}

bool lacks_workspace(KSP ksp) {
  if (failure_of(ksp) == PC_NOERROR || !uses_mumps(ksp)) return false;
  MatFactorType type = MAT_FACTOR_NONE;
  check(MatGetFactorType(factor_of(ksp), &type));
  const PetscInt info = infog(ksp, 1);
  return type == MAT_FACTOR_LU && (info == -8 || info == -9);
}

// MUMPS adds ICNTL(14) per cent to the workspace that its analysis foresees. PETSc does not let it
// continue after an error, so it begins anew.
KspHandle with_more_workspace(KSP ksp, Mat matrix, const std::string& prefix) {
  constexpr PetscInt least = 100;
  PetscInt percent = 0;
  check(MatMumpsGetIcntl(factor_of(ksp), 14, &percent));
  const OptionFor more(prefix + "mat_mumps_icntl_14", std::to_string(std::max(least, 2 * percent)));
  KspHandle again = linear_solver(matrix, prefix, PCLU);
  check(KSPSetUp(again));
  return again;
}

// MUMPS counts in millions, negative, what exceeds its integers.
double entries_counted(PetscInt entries) {
  return entries < 0 ? -1e6 * static_cast<double>(entries) : static_cast<double>(entries);
}

// By the number of its counters for entries and megabytes.
Analysis counted_by_mumps(KSP ksp, PetscInt entries, PetscInt megabytes) {
  PetscReal operations = 0;
  check(MatMumpsGetRinfog(factor_of(ksp), 1, &operations));
  return {PCLU, entries_counted(infog(ksp, entries)), static_cast<double>(infog(ksp, megabytes)),
          operations};
}

template <class Function>
Function* own_function(KSP ksp, const char* name) {
  Function* function = nullptr;
  const auto pc = reinterpret_cast<PetscObject>(preconditioner_of(ksp));
  check(PetscObjectQueryFunction(pc, name, &function));
  return function;
}

Analyse* analysis_of(KSP ksp) { return own_function<Analyse>(ksp, kAnalyse); }

// Of PCs of this program; no sizes of others.
Analysis own_analysis(KSP ksp) {
  Analysis analysis;
  if (Analyse* const analyse = analysis_of(ksp)) check(analyse(preconditioner_of(ksp), &analysis));
  return analysis;
}

// Whether the PC is of a type of this program: it needs the matrix of an operator.
bool is_own(KSP ksp) { return analysis_of(ksp) != nullptr; }

// For all of `b` at once, where a KSP is nothing but a PC of this program: others return false.
bool solve_together(KSP ksp, std::span<const Vec> b, std::span<const Vec> x, bool transposed) {
  PetscBool alone = PETSC_FALSE;
  check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(ksp), KSPPREONLY, &alone));
  auto* const apply = own_function<ApplyToColumns>(ksp, kApplyToColumns);
  if (alone == PETSC_FALSE || apply == nullptr) return false;
  check(apply(preconditioner_of(ksp), b, x, transposed));
  check(KSPViewFromOptions(ksp, nullptr, "-ksp_view"));  // as KSPSolve does
  return true;
}

constexpr double kBackwardErrorLimit = 1e-12;
constexpr int kMostRefinementSteps = 2;  // the second only where the first leaves too much
constexpr std::size_t kTogether = 32;    // right-hand sides, in memory at once

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

double BackwardError::forward(Vec residual, Vec b, Vec x) {
  if (magnitude_ == nullptr) magnitude_ = magnitudes(matrix_);
  const VecHandle size = absolute(x), bound = absolute(b);
  check(VecShift(size, kNegligible * norm(x, NORM_INFINITY)));
  check(MatMultAdd(magnitude_, size, bound, bound));
  check(VecPointwiseDivide(residual, residual, bound));  // 0/0 counts as 0 in PETSc
  return norm(residual, NORM_INFINITY);
}

// The sum of |A|^T |x| takes the sums of the rows of |A| alone.
double BackwardError::transposed(Vec residual, Vec b, Vec x) {
  if (magnitude_sums_ == nullptr) magnitude_sums_ = magnitude_sums(matrix_);
  const VecHandle size = absolute(x);
  PetscScalar visits = 0;
  check(VecTDot(magnitude_sums_, size, &visits));
  const double error = norm(residual, NORM_1), b_size = norm(b, NORM_1);
  return error == 0 ? 0 : error / (PetscRealPart(visits) + b_size);
}

double wall_seconds() {
  PetscLogDouble seconds = 0;
  check(PetscTime(&seconds));
  return seconds;
}

SolverStatistics& SolverStatistics::operator+=(const SolverStatistics& other) {
  assemblies += other.assemblies;
  factorizations_real += other.factorizations_real;
  factorizations_complex += other.factorizations_complex;
  solves += other.solves;
  corrections += other.corrections;
  iterations += other.iterations;
  unknowns = std::max(unknowns, other.unknowns);
  nonzeros = std::max(nonzeros, other.nonzeros);
  factor_entries = std::max(factor_entries, other.factor_entries);
  factor_megabytes = std::max(factor_megabytes, other.factor_megabytes);
  backward_error = std::max(backward_error, other.backward_error);
  assembly_seconds += other.assembly_seconds;
  analysis_seconds += other.analysis_seconds;
  factorization_seconds += other.factorization_seconds;
  solve_seconds += other.solve_seconds;
  return *this;
}

PhaseTimer::PhaseTimer(const char* stage, double& seconds)
    : seconds_(seconds), start_(wall_seconds()) {
  check(PetscLogStagePush(stage_named(stage)));
}

PhaseTimer::~PhaseTimer() {
  PetscLogDouble end = start_;
  (void)PetscTime(&end);
  seconds_ += end - start_;
  (void)PetscLogStagePop();
}

EventTimer::EventTimer(const char* event) {
  check(PetscLogEventGetId(event, &event_));
  before_ = logged_seconds(event_);
}

double EventTimer::seconds() const { return logged_seconds(event_) - before_; }

std::string implied_pc_type(const std::string& prefix) {
  const std::string pc = prefix + "pc_", own = pc + kElementsPc, mat = prefix + "mat_";
  bool others = false;
  for (const auto& name : given_options()) {
    if (name.starts_with(own)) return kElementsPc;
    others = others || name.starts_with(pc) || (name.starts_with(mat) && name != mat + "view");
  }
  return others ? PCLU : "";
}

void set_direct_solver(KSP ksp) {
  check(KSPSetType(ksp, KSPPREONLY));
  PC pc = preconditioner_of(ksp);
  check(PCSetType(pc, PCLU));
  check(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
}

std::unique_ptr<OptionFor> default_ordering(const std::string& prefix) {
  constexpr const char* amf = "2";
  const std::string name = prefix + "mat_mumps_icntl_7";
  return option_value(name) ? nullptr : std::make_unique<OptionFor>(name, amf);
}

KspHandle linear_solver(Mat matrix, const std::string& prefix, PCType pc_type) {
  KspHandle ksp;
  check(KSPCreate(PetscObjectComm(reinterpret_cast<PetscObject>(matrix)), ksp.out()));
  check(KSPSetOptionsPrefix(ksp, prefix.c_str()));
  check(KSPSetOperators(ksp, matrix, matrix));
  set_direct_solver(ksp);
  const std::string implied = implied_pc_type(prefix);
  check(PCSetType(preconditioner_of(ksp), implied.empty() ? pc_type : implied.c_str()));
  check(KSPSetFromOptions(ksp));
  return ksp;
}

void require_factored(KSP ksp, const std::string& prefix) {
  const PCFailedReason reason = failure_of(ksp);
  if (reason == PC_NOERROR) return;
  const std::string what = describe_failure(ksp);
  if (reason == PC_FACTOR_OUTMEMORY) {
    throw NoMemory(fmt::format("{}; {}", what, kFactorsTooLarge));
  }
  throw NotReached(fmt::format("the solver -{} failed: {}", prefix, what));
}

void record_factors(KSP ksp, SolverStatistics& statistics) {
  constexpr PetscInt entries = 29, megabytes = 22;  // of all ranks
  const Analysis sizes =
      uses_mumps(ksp) ? counted_by_mumps(ksp, entries, megabytes) : own_analysis(ksp);
  SolverStatistics seen;
  seen.factor_entries = static_cast<std::int64_t>(sizes.factor_entries);
  seen.factor_megabytes = sizes.megabytes;
  statistics += seen;
}

Factorization::Factorization(Mat matrix, const std::string& prefix, SolverStatistics& statistics,
                             PCType pc_type)
    : measure_(matrix), prefix_(prefix), statistics_(statistics) {
  check(PetscObjectReference(reinterpret_cast<PetscObject>(matrix)));
  matrix_ = MatHandle(matrix);
  ksp_ = linear_solver(matrix_, prefix_, pc_type);
  double total = 0, symbolic = 0;
  {
    const PhaseTimer timer("factorisation", total);
    const EventTimer analysis("MatLUFactorSym");
    const auto amf = default_ordering(prefix_);
    const auto owner = reinterpret_cast<PetscObject>(static_cast<KSP>(ksp_));
    check(PetscObjectViewFromOptions(reinterpret_cast<PetscObject>(matrix), owner, "-mat_view"));
    check(KSPSetUp(ksp_));
    if (lacks_workspace(ksp_)) ksp_ = with_more_workspace(ksp_, matrix_, prefix_);
    require_factored(ksp_, prefix_);
    symbolic = analysis.seconds();
  }
  statistics_.analysis_seconds += symbolic;
  statistics_.factorization_seconds += total - symbolic;
  record_factors(ksp_, statistics_);
  ++(kComplex ? statistics_.factorizations_complex : statistics_.factorizations_real);
}

void Factorization::solve_once(Vec b, Vec x, bool transposed) {
  const PhaseTimer timer("solve", statistics_.solve_seconds);
  apply(b, x, transposed);
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
  if (!uses_mumps(ksp)) return own_analysis(ksp);
  const auto amf = default_ordering(prefix);
  check(PCFactorSetUpMatSolverType(preconditioner_of(ksp)));
  MatFactorInfo info{};
  check(MatFactorInfoInitialize(&info));
  check(MatLUFactorSymbolic(factor_of(ksp), matrix, nullptr, nullptr, &info));
  constexpr PetscInt entries = 3, megabytes = 17;
  return counted_by_mumps(ksp, entries, megabytes);
}

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

}  // namespace stickslip::linalg
