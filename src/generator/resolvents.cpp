#include "stickslip/generator/resolvents.hpp"

#include <petscsys.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "stickslip/generator/element_elimination.hpp"
#include "stickslip/generator/solver_policy.hpp"
#include "stickslip/linalg/session.hpp"

namespace stickslip::generator {
namespace {

using cases::Factors;
using cases::Scheme;
using linalg::check;

double scalar_bytes() { return linalg::complex_scalars() ? 16 : 8; }

// Nodes of a group, and levels through which others jump to it.
using GroupSize = std::pair<int, int>;

// How many groups have which size.
std::map<GroupSize, double> group_sizes(const Nodes& noise) {
  std::map<GroupSize, double> sizes;
  for (const auto& group : noise.groups()) {
    const std::size_t border = std::max(group.at_first().size(), group.at_last().size());
    sizes[{group.count, static_cast<int>(border) / group.count}] += 1;
  }
  return sizes;
}

// Elements know of no killing in one state.
const char* pc_type_of(const KolmogorovOperator& a) {
  return a.kills_in_one_state() ? "lu" : default_pc_type(a.discretisation());
}

using Complex = std::complex<double>;

// What a solution keeps of its right-hand side after one step of refinement.
constexpr double kLargestCorrection = 1e-3;

bool serves_elements(const KolmogorovOperator& a) {
  const cases::Factors given = given_factors();
  if (given != cases::Factors::own) return given == cases::Factors::elements;
  return std::strcmp(default_pc_type(a.discretisation()), linalg::kElementsPc) == 0;
}

double norm(const ComplexVector& x) {
  return std::hypot(linalg::norm(x.real, NORM_2), linalg::norm(x.imaginary, NORM_2));
}

// The factors of a ComplexSolver, of one kind and of the other.

class ByElements {
 public:
  ByElements(const KolmogorovOperator& a, const Shift<Complex>& shift)
      : factors_(a.matrix(), data_of(a.matrix()), shift), vectors_(a.matrix()) {}

  void solve(const ComplexVector& b, const ComplexVector& x, bool transposed) const {
    const auto real = vectors_.gathered(b.real), imaginary = vectors_.gathered(b.imaginary);
    linalg::Matrix<Complex> all(static_cast<int>(real.size()), 1);
    for (std::size_t n = 0; n < real.size(); ++n) {
      all.data()[n] = {PetscRealPart(real[n]), PetscRealPart(imaginary[n])};
    }
    factors_.solve(all, transposed);
    vectors_.scatter(all.data(), x.real, [](Complex entry) { return entry.real(); });
    vectors_.scatter(all.data(), x.imaginary, [](Complex entry) { return entry.imag(); });
  }

 private:
  ElementElimination<Complex> factors_;
  linalg::WholeVectors vectors_;
};

/// The real and then the imaginary parts of each rank.
class InRealForm {
 public:
  InRealForm(const KolmogorovOperator& a, const ComplexVector& diagonal,
             linalg::SolverStatistics& statistics) {
    check(MatGetOwnershipRange(a.matrix(), &begin_, &end_));
    check(MatGetOwnershipRanges(a.matrix(), &ranges_));
    const PetscInt local = 2 * (end_ - begin_);
    const auto object = reinterpret_cast<PetscObject>(a.matrix());
    check(MatCreate(PetscObjectComm(object), matrix_.out()));
    check(MatSetSizes(matrix_, local, local, PETSC_DETERMINE, PETSC_DETERMINE));
    check(MatSetType(matrix_, MATAIJ));
    PetscInt most = 0;
    for (PetscInt row = begin_; row < end_; ++row) {
      const linalg::RowView view(a.matrix(), row);
      PetscInt count = 2;
      view.for_each([&](PetscInt, PetscScalar) { ++count; });
      most = std::max(most, count);
    }
    check(MatSeqAIJSetPreallocation(matrix_, most, nullptr));
    check(MatMPIAIJSetPreallocation(matrix_, most, nullptr, most, nullptr));
    const linalg::ReadView real(diagonal.real), imaginary(diagonal.imaginary);
    for (PetscInt row = begin_; row < end_; ++row) {
      const PetscInt n = row - begin_;
      add_row(a.matrix(), row, {PetscRealPart(real[n]), PetscRealPart(imaginary[n])});
    }
    check(MatAssemblyBegin(matrix_, MAT_FINAL_ASSEMBLY));
    check(MatAssemblyEnd(matrix_, MAT_FINAL_ASSEMBLY));
    factors_ = std::make_unique<linalg::Factorization>(matrix_, kSlidePrefix, statistics, PCLU);
  }

  // The transposed real form is that of the transposed matrix for the conjugate of d.
  void solve(const ComplexVector& b, const ComplexVector& x, bool transposed) const {
    const double sign = transposed ? -1 : 1;
    linalg::VecHandle all, solved;
    check(MatCreateVecs(matrix_, all.out(), solved.out()));
    {
      const linalg::ReadView real(b.real), imaginary(b.imaginary);
      linalg::WriteView to(all);
      auto* const next = std::copy_n(real.data(), real.size(), to.data());
      std::transform(imaginary.data(), imaginary.data() + imaginary.size(), next,
                     [sign](PetscScalar value) { return sign * value; });
    }
    factors_->solve_once(all, solved, transposed);
    const linalg::ReadView from(solved);
    linalg::WriteView real(x.real), imaginary(x.imaginary);
    std::copy_n(from.data(), real.size(), real.data());
    const auto* const next = from.data() + real.size();
    std::transform(next, next + imaginary.size(), imaginary.data(),
                   [sign](PetscScalar value) { return sign * value; });
  }

 private:
  // Of the real part; the imaginary one follows after all real ones of its rank.
  [[nodiscard]] PetscInt place(PetscInt index, bool imaginary) const {
    PetscInt rank = 0;
    while (ranges_[rank + 1] <= index) ++rank;
    return ranges_[rank] + index + (imaginary ? ranges_[rank + 1] - ranges_[rank] : 0);
  }

  void add_row(Mat a, PetscInt row, Complex d) const {
    const linalg::RowView view(a, row);
    for (bool imaginary : {false, true}) {
      const PetscInt at = place(row, imaginary);
      const auto add = [&](PetscInt column, PetscScalar value) {
        check(MatSetValue(matrix_, at, column, value, ADD_VALUES));
      };
      view.for_each(
          [&](PetscInt column, PetscScalar value) { add(place(column, imaginary), value); });
      add(at, d.real());
      add(place(row, !imaginary), (imaginary ? 1 : -1) * d.imag());
    }
  }

  PetscInt begin_ = 0, end_ = 0;
  const PetscInt* ranges_ = nullptr;
  linalg::MatHandle matrix_;
  std::unique_ptr<linalg::Factorization> factors_;
};

}  // namespace

Factors given_factors() {
  const std::string implied = linalg::implied_pc_type(kSlidePrefix);
  if (implied.empty()) return Factors::own;
  const auto value = [](const char* name) {
    return linalg::option_value(kSlidePrefix + name).value_or("");
  };
  const std::string given = value("pc_type"), pc = given.empty() ? implied : given;
  if (pc == linalg::kElementsPc) return Factors::elements;
  if (pc != "lu" && pc != "cholesky") return Factors::incomplete;
  return value("mat_mumps_icntl_22") == "1" ? Factors::on_disk : Factors::in_memory;
}

Factors chosen_factors(Factors asked, Scheme scheme, std::int64_t noise_nodes, bool all_levels,
                       bool neighbours_only) {
  if (asked != Factors::own) return asked;
  if (!neighbours_only) return scheme == Scheme::hp ? Factors::elements : Factors::in_memory;
  constexpr std::int64_t most_levels = 700;
  const bool few = !all_levels || noise_nodes <= most_levels;
  return scheme == Scheme::hp && few ? Factors::elements : Factors::in_memory;
}

const char* default_pc_type(const Discretisation& discretisation) {
  const auto& [process, noise, velocities] = discretisation;
  const bool hp = dynamic_cast<const HpDiscretisation*>(velocities.get()) != nullptr;
  const Factors factors =
      chosen_factors(Factors::own, hp ? Scheme::hp : Scheme::upwind, noise->count(),
                     noise->all_levels(), process.noise.neighbours_only());
  return factors == Factors::elements ? linalg::kElementsPc : "lu";
}

// Groups of levels begin at level 0, which need not be its own mirror.
bool branches_share_factors(const model::Process& process, bool all_levels,
                            const VelocityDiscretisation& velocities) {
  return !process.drifts() && process.noise.even_in_order() &&
         (all_levels || process.noise.symmetric()) && &velocities.mirrored() == &velocities;
}

// The blocks and couplings of groups inside of the elements, and those between elements.
FactorCost elimination_cost(const model::Process& process, const HpDiscretisation& velocities,
                            const Nodes& noise, int ranks) {
  const auto sizes = group_sizes(noise);
  std::vector<double> net_force;
  for (int n = noise.first(); n <= noise.last(); ++n) {
    net_force.push_back(process.net_force_at(noise.x(n)));
  }
  const double all = noise.count();
  double inside = 0, between = 0, operations = 0;
  double inner = first_rising(net_force, velocities.drag_at_end(0));
  for (int e = 0; e < velocities.elements(); ++e) {
    const double q = velocities.element(e).reference->size;
    const double outer = first_rising(net_force, velocities.drag_at_end(e + 1));
    for (const auto& [size, groups] : sizes) {
      const auto& [nodes, border] = size;
      const double n = nodes * q, b = border * q;
      inside += groups * (n * n + n * b);
      operations +=
          groups * (n * n * (2 * n / 3 + 4 * b + 2 * nodes) + (nodes == 1 ? 4 : 8) * b * b * all);
    }
    const double up = all - outer, up_inner = all - inner;
    between += up_inner * up + 2 * outer * up + outer * outer + (outer + up) * inner;
    operations += 2 * outer * (outer * up + outer * outer / 3 + outer * inner + up * inner) +
                  2 * up_inner * up * inner + 4 * q * all * all;
    inner = outer;
  }
  const double entries = inside + ranks * between;
  return {entries, scalar_bytes() * entries, operations};
}

FactorCost elimination_cost(const Discretisation& discretisation, bool symmetry_reduced,
                            int ranks) {
  const auto of = [&](const model::Process& along, const Nodes& nodes,
                      const VelocityDiscretisation& side) {
    return elimination_cost(along, dynamic_cast<const HpDiscretisation&>(side), nodes, ranks);
  };
  const auto& [process, noise, velocities] = discretisation;
  FactorCost cost = of(process, *noise, *velocities);
  const bool alike = branches_share_factors(process, noise->all_levels(), *velocities);
  if (symmetry_reduced || alike) return cost;
  const FactorCost other = of(process.mirrored(), noise->mirrored(), velocities->mirrored());
  return {cost.entries + other.entries, cost.bytes + other.bytes,
          cost.operations + other.operations};
}

FactorCost sparse_cost(Factors factors, Scheme scheme, double unknowns, double noise_nodes) {
  const double nodes = unknowns / noise_nodes, shorter = std::min(noise_nodes, nodes);
  const bool upwind = scheme == Scheme::upwind;
  const double operations = unknowns * (upwind ? 1 : nodes) * shorter;
  if (factors == Factors::incomplete) return {0, 0, operations};
  const double entries = unknowns * (upwind ? 4.5 * std::pow(shorter, 0.52) : 3.0 * nodes);
  const double bytes_an_entry = (upwind ? 12 : 10) * (factors == Factors::on_disk ? 0.3 : 1);
  return {entries, scalar_bytes() / 8 * bytes_an_entry * entries, operations};
}

KolmogorovOperator assemble(MPI_Comm comm, const Discretisation& discretisation,
                            Shift<PetscScalar> shift, Symmetry symmetry, StaticPhase static_phase,
                            linalg::SolverStatistics& statistics,
                            const std::optional<model::Derivative>& derivative) {
  const linalg::PhaseTimer timer("assembly", statistics.assembly_seconds);
  KolmogorovOperator a(comm, discretisation, shift, symmetry, static_phase, derivative);
  linalg::SolverStatistics made;
  made.assemblies = 1;
  made.unknowns = a.states().global_size();
  made.nonzeros = a.nonzeros();
  statistics += made;
  return a;
}

System::System(KolmogorovOperator a, linalg::SolverStatistics& statistics)
    : a_(std::move(a)), factors_(a_.matrix(), kSlidePrefix, statistics, pc_type_of(a_)) {}

KolmogorovOperator Systems::assembled(const SystemKey& key) {
  const auto of = [&](const Discretisation& discretisation) {
    return assemble(comm_, discretisation, key.shift(), key.symmetry, key.static_phase,
                    statistics_);
  };
  if (!std::isinf(key.speed_limit)) {
    return of(discretisation_.cut_at(key.speed_limit, key.passage.has_value(),
                                     key.passage.value_or(model::Passage::both)));
  }
  KolmogorovOperator a = of(discretisation_);
  const bool singular = key.lambda == 0 && key.static_phase == StaticPhase::killing;
  if (singular && !process().sticks()) a.kill_in_one_state();
  return a;
}

System& Systems::at(const SystemKey& key) {
  auto& system = systems_[key];
  if (!system) system = std::make_unique<System>(assembled(key), statistics_);
  return *system;
}

linalg::Analysis Systems::analyse(const SystemKey& key) {
  const auto a = assembled(key);
  return linalg::Factorization::analyse(a.matrix(), kSlidePrefix, statistics_, pc_type_of(a));
}

std::complex<double> dot(Vec c, const ComplexVector& x) {
  return {linalg::dot(c, x.real), linalg::dot(c, x.imaginary)};
}

ComplexSolver::ComplexSolver(const KolmogorovOperator& a, Shift<Complex> shift,
                             linalg::SolverStatistics& statistics)
    : a_(a), statistics_(statistics) {
  const auto d = [&](const State& state) {
    return shift.at(velocity_of(state, *a.discretisation().velocities));
  };
  diagonal_ = {a.by_state([&](const State& state) { return d(state).real(); }),
               a.by_state([&](const State& state) { return d(state).imag(); })};
  const auto solve_by = [](const auto& factors) {
    return [factors](const ComplexVector& b, const ComplexVector& x, bool transposed) {
      factors->solve(b, x, transposed);
    };
  };
  if (!serves_elements(a)) {
    factors_ = solve_by(std::make_shared<InRealForm>(a, diagonal_, statistics));
    return;
  }
  const linalg::PhaseTimer timer("factorisation", statistics_.factorization_seconds);
  factors_ = solve_by(std::make_shared<ByElements>(a, shift));
  ++statistics_.factorizations_complex;
}

ComplexVector ComplexSolver::residual(const ComplexVector& b, const ComplexVector& x,
                                      bool transposed) const {
  ComplexVector r{linalg::copy_of(b.real), linalg::copy_of(b.imaginary)};
  const linalg::VecHandle image = a_.zeros();
  const auto subtract = [&](Vec part, Vec d, Vec from, double sign) {
    check(VecPointwiseMult(image, part, d));
    check(VecAXPY(from, -sign, image));
  };
  for (const auto& [part, from] :
       {std::pair{Vec(x.real), Vec(r.real)}, std::pair{Vec(x.imaginary), Vec(r.imaginary)}}) {
    check(transposed ? MatMultTranspose(a_.matrix(), part, image)
                     : MatMult(a_.matrix(), part, image));
    check(VecAXPY(from, -1, image));
  }
  subtract(x.real, diagonal_.real, r.real, 1);
  subtract(x.imaginary, diagonal_.imaginary, r.real, -1);
  subtract(x.imaginary, diagonal_.real, r.imaginary, 1);
  subtract(x.real, diagonal_.imaginary, r.imaginary, 1);
  return r;
}

ComplexVector ComplexSolver::solve_once(const ComplexVector& b, bool transposed) {
  const linalg::PhaseTimer timer("solve", statistics_.solve_seconds);
  ComplexVector x{a_.zeros(), a_.zeros()};
  factors_(b, x, transposed);
  ++statistics_.solves;
  return x;
}

ComplexSolver::Solution ComplexSolver::solve(const ComplexVector& b, bool transposed) {
  Solution s{solve_once(b, transposed), {a_.zeros(), a_.zeros()}};
  const linalg::PhaseTimer timer("solve", statistics_.solve_seconds);
  factors_(residual(b, s.x, transposed), s.correction, transposed);
  check(VecAXPY(s.x.real, 1, s.correction.real));
  check(VecAXPY(s.x.imaginary, 1, s.correction.imaginary));
  ++statistics_.corrections;
  const double size = norm(s.x);
  s.change = size > 0 ? norm(s.correction) / size : 0;
  if (!(s.change <= kLargestCorrection)) {
    throw NotReached("complex factors of z - L are too inaccurate for iterative refinement");
  }
  return s;
}

}  // namespace stickslip::generator
