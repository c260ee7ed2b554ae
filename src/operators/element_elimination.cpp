#include "stickslip/operators/element_elimination.hpp"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <type_traits>

#include "branch_factors.hpp"
#include "static_rows.hpp"
#include "stickslip/operators/solver_policy.hpp"
#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/session.hpp"
#include "stickslip/petsc/vectors.hpp"
#include "stickslip/support/errors.hpp"

namespace stickslip::operators {
namespace {

using petsc::check;

// Sums over all ranks, in place.
template <class Scalar>
void sum_over_ranks(MPI_Comm comm, algebra::Matrix<Scalar>& x) {
  for (int c = 0; c < x.columns() && petsc::ranks(comm) > 1; ++c) {
    MPI_Allreduce(MPI_IN_PLACE, x.column(c), x.rows(), mpi_type<Scalar>(), MPI_SUM, comm);
  }
}

template <class Scalar>
bool is_zero(const algebra::Matrix<Scalar>& a) {
  return std::all_of(a.data(), a.column(a.columns()), [](Scalar entry) { return entry == 0.0; });
}

}  // namespace

template <class Scalar>
auto ElementElimination<Scalar>::read_static_rows(Mat matrix) const -> StaticRows<Scalar> {
  const std::size_t size = static_rows_.size();
  StaticRows<Scalar> at_rest(size, data_->discretisation.process.noise.neighbours_only());
  // From what the matrix has at rest to what the factors have.
  const Scalar more = shift_.at(0) - data_->shift.at(0);
  const petsc::RowsOnAllRanks all(matrix, static_rows_);
  for (std::size_t n = 0; n < size; ++n) {
    at_rest.add(n, n, more);
    const auto [first, end] = at_rest.columns_of(n);
    const auto begin = static_rows_.begin() + static_cast<std::ptrdiff_t>(first),
               last = static_rows_.begin() + static_cast<std::ptrdiff_t>(end);
    all.row(n).for_each([&, begin = begin, last = last](PetscInt column, PetscScalar value) {
      const auto found = std::find(begin, last, column);
      if (found == last) {
        at_rest.add_exit(n, exit_at(column), -value);
      } else {
        at_rest.add(n, static_cast<std::size_t>(found - static_rows_.begin()), value);
      }
    });
  }
  at_rest.factor();
  return at_rest;
}

/// A velocity branch, its rows and its place in w.
template <class Scalar>
struct ElementElimination<Scalar>::Line {
  Branch branch;
  const Factors* factors;
  const noise::Nodes* noise;
  std::vector<StateSpace::NodeLine> nodes;  // of a noise node
  std::vector<PetscInt> holding;            // rows of holding states, of the highest nodes
  std::size_t begin;                        // in w

  [[nodiscard]] std::size_t falling_at(int end) const { return begin + factors->falling_at(end); }
  [[nodiscard]] std::size_t rising_at(int end) const { return begin + factors->rising_at(end); }
};

template <class Scalar>
ElementElimination<Scalar>::ElementElimination(Mat matrix, std::shared_ptr<const MatrixData> data,
                                               Shift<Scalar> shift, bool share)
    : data_(std::move(data)), shift_(shift), comm_(share ? data_->states.comm() : PETSC_COMM_SELF) {
  const StateSpace& states = data_->states;
  const auto& process = data_->discretisation.process;
  const bool alike = shift_.tilt == Scalar(0) &&
                     branches_share_factors(process, data_->discretisation.noise->all_levels(),
                                            *data_->discretisation.velocities);
  for (Branch branch : states.branches()) {
    if (!alike || factors_.empty()) factors_.push_back(unfactored(branch));
    lines_.push_back(line_of(branch, *factors_.back()));
    length_ = lines_.back().falling_at(factors_.back()->velocities().elements() + 1);
  }
  for (int i = process.lowest_static(); i <= process.highest_static(); ++i) {
    if (!states.has_static_state(i)) continue;
    if (static_rows_.empty()) lowest_static_ = i;
    static_rows_.push_back(states.index({StateKind::static_phase, Branch::positive, i, 0}));
  }
  static_begin_ = length_;
  length_ += static_rows_.size();
  if (petsc::ranks(comm_) > 1) {
    // All before the first is sent: one that fails ends all ranks alike.
    std::string failure;
    for (auto& factors : factors_) {
      if (failure.empty()) failure = factors->make_shared_elements();
    }
    petsc::require_everywhere(comm_, failure);
  }
  for (auto& factors : factors_) factors->reflect();
  meet(matrix);
}

template <class Scalar>
ElementElimination<Scalar>::~ElementElimination() = default;

template <class Scalar>
auto ElementElimination<Scalar>::unfactored(Branch branch) const -> std::unique_ptr<Factors> {
  const auto& [process, noise, velocities] = data_->discretisation;
  const bool upper = branch == Branch::positive;
  const model::Process along = upper ? process : process.mirrored();
  const noise::Nodes& nodes = upper ? *noise : noise->mirrored();
  std::vector<double> net_force;
  for (int n = nodes.first(); n <= nodes.last(); ++n) {
    const double force = along.net_force_at(nodes.x(n));
    // Where no level holds a body, one at v = 0 passes to this side, however slowly.
    const bool passes = force == 0 && !process.sticks();
    net_force.push_back(passes ? std::numeric_limits<double>::min() : force);
  }
  const auto& on =
      dynamic_cast<const velocity::HpDiscretisation&>(upper ? *velocities : velocities->mirrored());
  const std::size_t before = factors_.empty() ? 0 : factors_.back()->elements().size();
  return std::make_unique<Factors>(nodes, on, std::move(net_force), shift_.along(branch), comm_,
                                   before);
}

template <class Scalar>
auto ElementElimination<Scalar>::line_of(Branch branch, const Factors& factors) const -> Line {
  const StateSpace& states = data_->states;
  const noise::Nodes& noise = *data_->discretisation.noise;
  Line line{branch, &factors, branch == Branch::positive ? &noise : &noise.mirrored(),
            {},     {},       length_};
  for (int n = line.noise->first(); n <= line.noise->last(); ++n) {
    line.nodes.push_back(states.nodes_of(branch, n));
    if (states.has_holding(branch, n)) {
      line.holding.push_back(states.index({StateKind::holding, branch, n, 0}));
    }
  }
  return line;
}

// What a branch finds in the static states, of its nodes that fall to v = 0 from `fall` on.
template <class Scalar>
void ElementElimination<Scalar>::add_shares(const Line& line, std::size_t fall,
                                            Couplings& shares) const {
  const StateSpace& states = data_->states;
  const noise::Nodes& noise = *line.noise;
  const Branch other = states.symmetry_reduced() ? line.branch : opposite(line.branch);
  for (int l = 0; l < line.factors->falling(); ++l) {
    const int node = l + noise.first();
    if (node < -states.last_static(other)) continue;
    const auto& group = noise.group_of(node);
    for (int along = group.first; along <= group.last; ++along) {
      const int i = line.branch == Branch::positive ? along : -along;
      const int kept = states.symmetry_reduced() ? std::abs(i) : i;
      if (!states.has_static_state(kept)) continue;  // an odd function vanishes at x = 0
      const double share = group.row(group.weight, along)[node - group.begin];
      if (share == 0) continue;
      shares.push_back({static_begin_ + static_cast<std::size_t>(kept - lowest_static_),
                        fall + static_cast<std::size_t>(l), kept == i ? share : sign() * share});
    }
  }
}

// What a branch finds on the other one, or reflected.
template <class Scalar>
void ElementElimination<Scalar>::add_crossings(const Line& line, std::size_t fall,
                                               Couplings& found) const {
  const Line& other = lines_[data_->states.symmetry_reduced() || &line != &lines_[0] ? 0 : 1];
  const int crossing = -data_->states.last_static(other.branch) - line.noise->first();
  for (int l = 0; l < crossing; ++l) {
    found.push_back({other.falling_at(1) - 1 - l, fall + static_cast<std::size_t>(l), sign()});
  }
}

// The place in w of the node next to the static levels to which an entry of a static row belongs.
template <class Scalar>
std::size_t ElementElimination<Scalar>::exit_at(PetscInt column) const {
  for (const Line& line : lines_) {
    const PetscInt q = line.factors->velocities().element(0).reference->size;
    for (int node = data_->states.last_static(line.branch) + 1 - line.noise->first();
         node < line.noise->count(); ++node) {
      const auto& [first, stride] = line.nodes[node];
      const PetscInt from = column - first, place = stride == 0 ? 0 : from / stride;
      if (from == place * stride && place >= 0 && place < q) return line.begin + node;
    }
  }
  throw NotReached("a static state is left for one that is no exit");
}

// What falls to v = 0 continues on the other branch, or comes to rest and leaves by an exit. With C
// what falling nodes find there, from the values of rising ones, 1 - C R is left to solve.
template <class Scalar>
void ElementElimination<Scalar>::meet(Mat matrix) {
  const std::size_t fall = length_;  // what falling nodes find
  Couplings shares, found, returned;
  for (const Line& line : lines_) {
    add_shares(line, length_, shares);
    add_crossings(line, length_, found);
    for (int l = 0; l < line.factors->falling(); ++l)
      returned.push_back({length_++, line.begin + l, 1});
  }
  const std::size_t falling = length_ - fall;
  StaticRows<Scalar> at_rest = read_static_rows(matrix);
  for (const auto& [exit, rates] : at_rest.exits()) {
    DenseMatrix left(static_cast<int>(static_rows_.size()), 1);
    std::copy(rates.begin(), rates.end(), left.data());
    at_rest.solve(left.data());
    Scalars passed(falling, 0.0);
    for (const auto& [from, to, share] : shares)
      passed[to - fall] += share * left.data()[from - static_begin_];
    for (std::size_t n = 0; n < falling; ++n) {
      if (passed[n] != 0.0) found.push_back({exit, fall + n, passed[n]});
    }
    leaving_.add(std::move(left), exit, static_begin_);
  }
  DenseMatrix closed = DenseMatrix::identity(static_cast<int>(falling));
  int first = 0;
  for (const Line& line : lines_) {
    for (const auto& [from, to, weight] : found) {
      if (from < line.rising_at(0) || from >= line.falling_at(1)) continue;
      const int n = static_cast<int>(from - line.rising_at(0)), row = static_cast<int>(to - fall);
      for (int c = 0; c < line.factors->falling(); ++c) {
        closed(row, first + c) -= weight * line.factors->reflection()(n, c);
      }
    }
    first += line.factors->falling();
  }
  at_rest.move_to(meeting_, static_begin_);
  meeting_.add(std::move(shares));
  meeting_.add(std::move(found));
  meeting_.solve(DenseFactors(std::move(closed)), fall);
  meeting_.add(std::move(returned));
}

// What static states find at the exits comes last, as what rises there does.
template <class Scalar>
void ElementElimination<Scalar>::solve_between(algebra::Columns<Scalar> w, bool transposed) const {
  const auto on_branches = [&](const Steps& (Factors::*steps)() const) {
    for (const Line& line : lines_) (line.factors->*steps)().run(w.from(line.begin), transposed);
  };
  if (transposed) {
    leaving_.run(w, true);
    on_branches(&Factors::outwards);
    meeting_.run(w, true);
    on_branches(&Factors::inwards);
  } else {
    on_branches(&Factors::inwards);
    meeting_.run(w, false);
    on_branches(&Factors::outwards);
    leaving_.run(w, false);
  }
}

template <class Scalar>
template <class Visit>
void ElementElimination<Scalar>::for_each_own_element(Visit visit) const {
  for (const Line& line : lines_) {
    const auto& elements = line.factors->elements();
    for (int e = 0; e < static_cast<int>(elements.size()); ++e) {
      if (elements[e]) visit(line, e, *elements[e]);
    }
  }
}

// Calls visit(place in a list of the element, row) for its unknowns.
template <class Scalar>
template <class Visit>
void ElementElimination<Scalar>::for_each_unknown(const Line& line, const Element& element,
                                                  Visit visit) {
  std::size_t place = 0;
  for (const auto& [first, stride] : line.nodes) {
    for (int m = 0; m < element.nodes(); ++m) {
      visit(place++, first + stride * (element.first_node() + m));
    }
  }
}

// Calls visit(place in w, row) for the unknowns that are part of w.
template <class Scalar>
template <class Visit>
void ElementElimination<Scalar>::for_each_unknown_between(Visit visit) const {
  for (const Line& line : lines_) {
    std::size_t place = line.rising_at(line.factors->velocities().elements());
    for (PetscInt row : line.holding) visit(place++, row);
  }
  for (std::size_t n = 0; n < static_rows_.size(); ++n) visit(static_begin_ + n, static_rows_[n]);
}

// The part of vectors on an element.
template <class Scalar>
auto ElementElimination<Scalar>::given_on(const Line& line, const Element& element,
                                          const DenseMatrix& x) const -> DenseMatrix {
  DenseMatrix part(element.length(), x.columns());
  for (int c = 0; c < x.columns(); ++c) {
    const Scalar* from = x.column(c);
    Scalar* to = part.column(c);
    for_each_unknown(line, element, [=](std::size_t n, PetscInt row) { to[n] = from[row]; });
  }
  return part;
}

template <class Scalar>
void ElementElimination<Scalar>::solve(DenseMatrix& x, bool transposed) const {
  DenseMatrix w(static_cast<int>(length_), x.columns()), solved(x.rows(), x.columns());
  const auto at = algebra::columns_of(w);
  for_each_own_element([&](const Line& line, int e, const Element& element) {
    DenseMatrix alone = given_on(line, element, x);
    if (is_zero(alone)) return;  // most, where bodies start in one state
    element.solve(algebra::columns_of(alone), transposed);
    element.collect(transposed ? element.taken() : element.given(), algebra::columns_of(alone),
                    at.from(line.falling_at(e)), at.from(line.falling_at(e + 1)));
  });
  sum_over_ranks(comm_, w);
  for (int c = 0; c < x.columns(); ++c) {
    for_each_unknown_between([&](std::size_t n, PetscInt row) { at.column(c)[n] += x(row, c); });
  }
  solve_between(at, transposed);
  for_each_own_element([&](const Line& line, int e, const Element& element) {
    DenseMatrix part = given_on(line, element, x);
    element.distribute(transposed ? element.given() : element.taken(), at.from(line.falling_at(e)),
                       at.from(line.falling_at(e + 1)), algebra::columns_of(part));
    element.solve(algebra::columns_of(part), transposed);
    for (int c = 0; c < x.columns(); ++c) {
      const Scalar* from = part.column(c);
      Scalar* to = solved.column(c);
      for_each_unknown(line, element, [=](std::size_t n, PetscInt row) { to[row] = from[n]; });
    }
  });
  for (int c = 0; c < x.columns() && petsc::rank(comm_) == 0; ++c) {
    for_each_unknown_between(
        [&](std::size_t n, PetscInt row) { solved(row, c) = at.column(c)[n]; });
  }
  sum_over_ranks(comm_, solved);
  x = std::move(solved);
}

template <class Scalar>
double ElementElimination<Scalar>::entries() const {
  double sum = meeting_.entries() + leaving_.entries();
  for (const auto& factors : factors_) sum += factors->entries();
  return sum;
}

template class ElementElimination<std::complex<double>>;
#if !defined(PETSC_USE_COMPLEX)
template class ElementElimination<double>;
#endif

}  // namespace stickslip::operators
