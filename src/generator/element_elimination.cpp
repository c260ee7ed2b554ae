#include "stickslip/generator/element_elimination.hpp"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <utility>

#include <fmt/format.h>
// The only private header of PETSc in this project. A PC type fills the structure of its
// operations, which PETSc declares here and installs for this purpose; its public interface has
// PCSHELL alone, which is no type of its own in options and views, and is not told of a reset.
#include <petsc/private/pcimpl.h>

#include "branch_factors.hpp"
#include "stickslip/generator/solver_policy.hpp"
#include "stickslip/linalg/session.hpp"
#include "stickslip/linalg/solver.hpp"

namespace stickslip::generator {
namespace {

using linalg::check;
using linalg::guarded;

}  // namespace

// The rows of static states in the elimination of elements.

/// The matrix of the static states among each other, tridiagonal where the noise jumps to
/// neighbours, and what leaves them. Local.
template <class Scalar>
class StaticRows {
 public:
  using Steps = LinearSteps<Scalar>;

  StaticRows(std::size_t size, bool neighbours_only) : size_(size), near_(neighbours_only) {
    for (auto* band : {&chain_.diagonal, &chain_.below, &chain_.above}) {
      band->assign(near_ ? size : 0, 0.0);
    }
    if (!near_) dense_ = linalg::Matrix<Scalar>(static_cast<int>(size), static_cast<int>(size));
  }

  /// The states among which a row may have entries.
  [[nodiscard]] std::pair<std::size_t, std::size_t> columns_of(std::size_t row) const {
    if (!near_) return {0, size_};
    return {row > 0 ? row - 1 : 0, std::min(row + 2, size_)};
  }
  void add(std::size_t row, std::size_t column, Scalar value) {
    if (!near_) {
      dense_(static_cast<int>(row), static_cast<int>(column)) += value;
    } else if (row == column) {
      chain_.diagonal[row] += value;
    } else {
      (column < row ? chain_.below : chain_.above)[row] += value;
    }
  }
  /// A rate of leaving for what lies at a place outside.
  void add_exit(std::size_t row, std::size_t place, Scalar rate) {
    auto& rates = exits_[place];
    rates.resize(size_);
    rates[row] += rate;
  }

  /// Throws NotReached if the matrix is singular.
  void factor() {
    if (near_) chain_.factor();
    if (!near_) factors_.emplace(std::move(dense_));
  }
  /// x <- A^-1 x.
  void solve(Scalar* x) const {
    const linalg::Columns<Scalar> one{x};
    if (near_) chain_.solve(one, false);
    if (!near_) factors_->solve(one, false);
  }
  /// Rates by state, by place outside.
  [[nodiscard]] const std::map<std::size_t, std::vector<Scalar>>& exits() const { return exits_; }
  /// Hands the factors over as a step on the states at a place of a list.
  void move_to(Steps& steps, std::size_t at) {
    if (near_) steps.solve(std::move(chain_), at);
    if (!near_) steps.solve(*std::move(factors_), at);
  }

 private:
  std::size_t size_;
  bool near_;
  typename Steps::Tridiagonal chain_;
  linalg::Matrix<Scalar> dense_;
  std::optional<linalg::LuFactors<Scalar>> factors_;
  std::map<std::size_t, std::vector<Scalar>> exits_;
};

namespace {

// Sums over all ranks, in place.
template <class Scalar>
void sum_over_ranks(MPI_Comm comm, linalg::Matrix<Scalar>& x) {
  for (int c = 0; c < x.columns() && linalg::ranks(comm) > 1; ++c) {
    MPI_Allreduce(MPI_IN_PLACE, x.column(c), x.rows(), mpi_type<Scalar>(), MPI_SUM, comm);
  }
}

template <class Scalar>
bool is_zero(const linalg::Matrix<Scalar>& a) {
  return std::all_of(a.data(), a.column(a.columns()), [](Scalar entry) { return entry == 0.0; });
}

}  // namespace

template <class Scalar>
auto ElementElimination<Scalar>::read_static_rows(Mat matrix) const -> StaticRows<Scalar> {
  const std::size_t size = static_rows_.size();
  StaticRows<Scalar> at_rest(size, data_->discretisation.process.noise.neighbours_only());
  // From what the matrix has at rest to what the factors have.
  const Scalar more = shift_.at(0) - data_->shift.at(0);
  const linalg::RowsOnAllRanks all(matrix, static_rows_);
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
  const Nodes* noise;
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
  if (linalg::ranks(comm_) > 1) {
    // All before the first is sent: one that fails ends all ranks alike.
    std::string failure;
    for (auto& factors : factors_) {
      if (failure.empty()) failure = factors->make_shared_elements();
    }
    linalg::require_everywhere(comm_, failure);
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
  const Nodes& nodes = upper ? *noise : noise->mirrored();
  std::vector<double> net_force;
  for (int n = nodes.first(); n <= nodes.last(); ++n) {
    const double force = along.net_force_at(nodes.x(n));
    // Where no level holds a body, one at v = 0 passes to this side, however slowly.
    const bool passes = force == 0 && !process.sticks();
    net_force.push_back(passes ? std::numeric_limits<double>::min() : force);
  }
  const auto& on =
      dynamic_cast<const HpDiscretisation&>(upper ? *velocities : velocities->mirrored());
  const std::size_t before = factors_.empty() ? 0 : factors_.back()->elements().size();
  return std::make_unique<Factors>(nodes, on, std::move(net_force), shift_.along(branch), comm_,
                                   before);
}

template <class Scalar>
auto ElementElimination<Scalar>::line_of(Branch branch, const Factors& factors) const -> Line {
  const StateSpace& states = data_->states;
  const Nodes& noise = *data_->discretisation.noise;
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
  const Nodes& noise = *line.noise;
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
void ElementElimination<Scalar>::solve_between(linalg::Columns<Scalar> w, bool transposed) const {
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
  const auto at = linalg::columns_of(w);
  for_each_own_element([&](const Line& line, int e, const Element& element) {
    DenseMatrix alone = given_on(line, element, x);
    if (is_zero(alone)) return;  // most, where bodies start in one state
    element.solve(linalg::columns_of(alone), transposed);
    element.collect(transposed ? element.taken() : element.given(), linalg::columns_of(alone),
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
                       at.from(line.falling_at(e + 1)), linalg::columns_of(part));
    element.solve(linalg::columns_of(part), transposed);
    for (int c = 0; c < x.columns(); ++c) {
      const Scalar* from = part.column(c);
      Scalar* to = solved.column(c);
      for_each_unknown(line, element, [=](std::size_t n, PetscInt row) { to[row] = from[n]; });
    }
  });
  for (int c = 0; c < x.columns() && linalg::rank(comm_) == 0; ++c) {
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

namespace {

struct Events {
  PetscClassId id = 0;
  PetscLogEvent set_up = 0, solve = 0;
};

Events& events() {
  static Events all;
  return all;
}

/// What a PC of this type owns.
struct Elements {
  std::unique_ptr<ElementElimination<PetscScalar>> factors;
  std::unique_ptr<linalg::WholeVectors> vectors;
  PetscBool share = PETSC_TRUE;
  double entries = 0;  // of this rank, when factored
};

Elements& elements_of(PC pc) { return *static_cast<Elements*>(pc->data); }

/// Shows a scope as an event of -log_view.
class LoggedEvent {
 public:
  LoggedEvent(PetscLogEvent event, PC pc) : event_(event), pc_(pc) {
    (void)PetscLogEventBegin(event_, pc_, 0, 0, 0);
  }
  ~LoggedEvent() { (void)PetscLogEventEnd(event_, pc_, 0, 0, 0); }
  LoggedEvent(const LoggedEvent&) = delete;
  LoggedEvent& operator=(const LoggedEvent&) = delete;

 private:
  PetscLogEvent event_;
  PC pc_;
};

std::shared_ptr<const MatrixData> data_for(PC pc) {
  auto data = data_of(pc->pmat);
  if (data && dynamic_cast<const HpDiscretisation*>(data->discretisation.velocities.get()))
    return data;
  const char* prefix = nullptr;
  check(PCGetOptionsPrefix(pc, &prefix));
  throw BadInput(fmt::format("-{}pc_type: elements needs the matrix of a sliding operator on an hp "
                             "discretisation; leave it out",
                             prefix == nullptr ? "" : prefix));
}

// Of all ranks; those that do not share elements have them all.
FactorCost cost_of(PC pc, const MatrixData& data) {
  const int ranks = linalg::ranks(data.states.comm());
  const bool share = elements_of(pc).share == PETSC_TRUE, reduced = data.states.symmetry_reduced();
  if (share) return elimination_cost(data.discretisation, reduced, ranks);
  const FactorCost one = elimination_cost(data.discretisation, reduced, 1);
  return {ranks * one.entries, ranks * one.bytes, ranks * one.operations};
}

// Called by PETSc.

PetscErrorCode set_up(PC pc) {
  return guarded([pc] {
    const LoggedEvent logged(events().set_up, pc);
    const auto data = data_for(pc);
    Elements& own = elements_of(pc);
    own.factors.reset();  // before there are others
    own.factors =
        std::make_unique<ElementElimination<PetscScalar>>(pc->pmat, data, own.share == PETSC_TRUE);
    own.vectors = std::make_unique<linalg::WholeVectors>(pc->pmat);
    own.entries = own.factors->entries();
    check(PetscLogFlops(cost_of(pc, *data).operations / linalg::ranks(data->states.comm())));
  });
}

PetscErrorCode apply_to_columns(PC pc, std::span<const Vec> b, std::span<const Vec> x,
                                bool transposed) {
  return guarded([=] {
    const LoggedEvent logged(events().solve, pc);
    const Elements& own = elements_of(pc);
    PetscInt size = 0;
    check(VecGetSize(b[0], &size));
    linalg::DenseMatrix all(size, static_cast<int>(b.size()));
    for (int c = 0; c < all.columns(); ++c) {
      const auto column = own.vectors->gathered(b[c]);
      std::copy(column.begin(), column.end(), all.column(c));
    }
    own.factors->solve(all, transposed);
    for (int c = 0; c < all.columns(); ++c) {
      own.vectors->scatter(all.column(c), x[c], [](PetscScalar entry) { return entry; });
    }
    check(PetscLogFlops(2 * own.entries * all.columns()));
  });
}

template <bool transposed>
PetscErrorCode apply(PC pc, Vec b, Vec x) {
  return apply_to_columns(pc, {&b, 1}, {&x, 1}, transposed);
}

// NOLINTNEXTLINE(readability-identifier-naming): the name that PETSc's macros expect
PetscErrorCode set_from_options(PC pc, linalg::OptionItems PetscOptionsObject) {
  PetscBool& share = elements_of(pc).share;
  PetscOptionsHeadBegin(PetscOptionsObject, "Elimination of velocity elements");
  return PetscOptionsBool("-pc_elements_share", "Ranks share the elements, or each factors all",
                          nullptr, share, &share, nullptr);
}

PetscErrorCode compose(PC pc, linalg::Analyse* analyse, linalg::ApplyToColumns* apply) {
  return guarded([=] {
    const auto object = reinterpret_cast<PetscObject>(pc);
    check(PetscObjectComposeFunction(object, linalg::kAnalyse, analyse));
    check(PetscObjectComposeFunction(object, linalg::kApplyToColumns, apply));
  });
}

PetscErrorCode reset(PC pc) {
  elements_of(pc).factors.reset();
  elements_of(pc).vectors.reset();
  return 0;
}

PetscErrorCode destroy(PC pc) {
  delete &elements_of(pc);
  pc->data = nullptr;
  return compose(pc, nullptr, nullptr);
}

PetscErrorCode view(PC pc, PetscViewer viewer) {
  return guarded([=] {
    PetscBool ascii = PETSC_FALSE;
    check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(viewer), PETSCVIEWERASCII, &ascii));
    if (ascii == PETSC_FALSE) return;
    const auto data = data_of(pc->pmat);
    if (!data) return;
    const Discretisation& on = data->discretisation;
    const FactorCost cost = cost_of(pc, *data);
    const auto line = [viewer](const std::string& text) {
      check(PetscViewerASCIIPrintf(viewer, "  %s\n", text.c_str()));
    };
    line("block LU along the velocity, over elements condensed to the values at their ends");
    line(fmt::format("elements {} on {} velocity branch(es), noise nodes {} in {} groups",
                     on.velocities->cells().size() - 1, data->states.branches().size(),
                     on.noise->count(), on.noise->groups().size()));
    line(fmt::format("elements shared by {} rank(s)",
                     elements_of(pc).share == PETSC_TRUE ? linalg::ranks(data->states.comm()) : 1));
    line(fmt::format("entries of the factors {:.4g}, operations of factoring {:.4g}", cost.entries,
                     cost.operations));
  });
}

PetscErrorCode analyse(PC pc, linalg::Analysis* analysis) {
  return guarded([=] {
    const auto data = data_for(pc);
    const FactorCost cost = cost_of(pc, *data);
    *analysis = {linalg::kElementsPc, cost.entries, cost.bytes / 1e6, cost.operations};
  });
}

PetscErrorCode create(PC pc) {
  pc->data = new Elements;
  pc->ops->setup = set_up;
  pc->ops->apply = apply<false>;
  pc->ops->applytranspose = apply<true>;
  pc->ops->setfromoptions = set_from_options;
  pc->ops->reset = reset;
  pc->ops->destroy = destroy;
  pc->ops->view = view;
  return compose(pc, analyse, apply_to_columns);
}

}  // namespace

void register_preconditioners() {
  check(PCRegister(linalg::kElementsPc, create));
  check(PetscClassIdRegister("stickslip", &events().id));
  check(PetscLogEventRegister("PCElementsSetUp", events().id, &events().set_up));
  check(PetscLogEventRegister("PCElementsSolve", events().id, &events().solve));
}

}  // namespace stickslip::generator
