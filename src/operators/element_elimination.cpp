#include "stickslip/operators/element_elimination.hpp"

#include <algorithm>
#include <cstdlib>
#include <type_traits>

#include "static_rows.hpp"
#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/session.hpp"
#include "stickslip/petsc/vectors.hpp"
#include "stickslip/support/errors.hpp"

namespace stickslip::operators {
namespace {

using algebra::add_product;
using petsc::check;

template <class Scalar>
MPI_Datatype type() {
  return std::is_same_v<Scalar, double> ? MPI_DOUBLE : MPI_C_DOUBLE_COMPLEX;
}

// Sums over all ranks, in place.
template <class Scalar>
void sum_over_ranks(MPI_Comm comm, std::vector<Scalar>& x) {
  const auto size = static_cast<int>(x.size());
  MPI_Allreduce(MPI_IN_PLACE, x.data(), size, type<Scalar>(), MPI_SUM, comm);
}

// Sends a matrix from its owner to all ranks.
template <class Scalar>
void send(MPI_Comm comm, int owner, int rows, int columns, algebra::Matrix<Scalar>& a) {
  if (petsc::rank(comm) != owner) a = algebra::Matrix<Scalar>(rows, columns);
  MPI_Bcast(a.data(), rows * columns, type<Scalar>(), owner, comm);
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

/// A velocity branch; lists by noise node count along it.
template <class Scalar>
struct ElementElimination<Scalar>::Line {
  Branch branch = Branch::positive;
  const velocity::HpDiscretisation* velocities = nullptr;
  const noise::Nodes* noise;
  std::vector<double> net_force;
  std::vector<StateSpace::NodeLine> nodes;  // of a noise node
  std::vector<PetscInt> holding;            // rows of holding states, of the highest nodes
  std::vector<int> rising;                  // by end of elements: first node that rises there
  std::size_t first_element = 0;            // counted over all branches
  std::size_t begin = 0;                    // in w: of the values at v = 0, those at v_1 ...
  std::vector<std::unique_ptr<Element>> elements;  // those of this rank
  std::vector<Response> responses;                 // of shared ones, until they are used
  DenseMatrix reflection;                          // R at v = 0
  Steps outwards;                                  // from the values that fall at v = 0

  [[nodiscard]] int count() const { return static_cast<int>(net_force.size()); }
  [[nodiscard]] std::size_t falling_at(int end) const {
    return begin + static_cast<std::size_t>(end) * net_force.size();
  }
  [[nodiscard]] std::size_t rising_at(int end) const { return falling_at(end) + rising[end]; }
};

template <class Scalar>
ElementElimination<Scalar>::ElementElimination(Mat matrix, std::shared_ptr<const MatrixData> data,
                                               Shift<Scalar> shift, bool share)
    : data_(std::move(data)), shift_(shift), comm_(share ? data_->states.comm() : PETSC_COMM_SELF) {
  const StateSpace& states = data_->states;
  const auto& process = data_->discretisation.process;
  for (Branch branch : states.branches()) {
    lines_.push_back(line_of(branch));
    length_ = lines_.back().falling_at(lines_.back().velocities->elements() + 1);
  }
  for (int i = process.lowest_static(); i <= process.highest_static(); ++i) {
    if (!states.has_static_state(i)) continue;
    if (static_rows_.empty()) lowest_static_ = i;
    static_rows_.push_back(states.index({StateKind::static_phase, Branch::positive, i, 0}));
  }
  static_begin_ = length_;
  length_ += static_rows_.size();
  if (petsc::ranks(comm_) > 1) make_shared_elements();
  for (Line& line : lines_) reflect(line);
  meet(matrix);
}

template <class Scalar>
ElementElimination<Scalar>::~ElementElimination() = default;

template <class Scalar>
auto ElementElimination<Scalar>::line_of(Branch branch) const -> Line {
  const auto& [process, noise, velocities] = data_->discretisation;
  const StateSpace& states = data_->states;
  const bool upper = branch == Branch::positive;
  const model::Process along = upper ? process : process.mirrored();
  Line line;
  line.branch = branch;
  line.velocities = dynamic_cast<const velocity::HpDiscretisation*>(
      upper ? velocities.get() : &velocities->mirrored());
  if (!lines_.empty()) line.first_element = lines_.back().elements.size();
  line.begin = length_;
  line.noise = upper ? noise.get() : &noise->mirrored();
  for (int n = line.noise->first(); n <= line.noise->last(); ++n) {
    line.net_force.push_back(along.net_force_at(line.noise->x(n)));
    line.nodes.push_back(states.nodes_of(branch, n));
    if (states.has_holding(branch, n)) {
      line.holding.push_back(states.index({StateKind::holding, branch, n, 0}));
    }
  }
  const int elements = line.velocities->elements();
  line.elements.resize(static_cast<std::size_t>(elements));
  for (int e = 0; e <= elements; ++e) {
    line.rising.push_back(first_rising(line.net_force, line.velocities->drag_at_end(e)));
  }
  return line;
}

// The rank that has an element.
template <class Scalar>
int ElementElimination<Scalar>::owner(const Line& line, std::size_t e) const {
  return static_cast<int>((line.first_element + e) % static_cast<std::size_t>(petsc::ranks(comm_)));
}

template <class Scalar>
auto ElementElimination<Scalar>::make_element(Line& line, std::size_t e) const -> Response {
  Response response;
  line.elements[e] = std::make_unique<Element>(*line.noise, *line.velocities, static_cast<int>(e),
                                               line.net_force, shift_.along(line.branch), response);
  return response;
}

// All before the first is sent: one that fails ends all ranks alike.
template <class Scalar>
void ElementElimination<Scalar>::make_shared_elements() {
  std::string failure;
  for (Line& line : lines_) {
    line.responses.resize(line.elements.size());
    for (std::size_t e = 0; e < line.elements.size() && failure.empty(); ++e) {
      if (owner(line, e) != petsc::rank(comm_)) continue;
      try {
        line.responses[e] = make_element(line, e);
      } catch (const NotReached& singular) {
        failure = singular.what();
      }
    }
  }
  petsc::require_everywhere(comm_, failure);
}

// What an element makes of the values beyond its ends, on all ranks.
template <class Scalar>
auto ElementElimination<Scalar>::response(Line& line, std::size_t e) const -> Response {
  if (petsc::ranks(comm_) == 1) return make_element(line, e);
  Response s = std::move(line.responses[e]);
  const int all = line.count(), inner = line.rising[e], outer = line.rising[e + 1];
  send(comm_, owner(line, e), all - inner, inner, s.inner_inner);
  send(comm_, owner(line, e), all - inner, all - outer, s.inner_outer);
  send(comm_, owner(line, e), outer, inner, s.outer_inner);
  send(comm_, owner(line, e), outer, all - outer, s.outer_outer);
  return s;
}

// What holding states make of the values that fall at v_max; where bodies are killed, nothing.
template <class Scalar>
auto ElementElimination<Scalar>::hold(const Line& line) -> DenseMatrix {
  const noise::Nodes& noise = *line.noise;
  const int below = line.rising[line.velocities->elements()], held = line.count() - below;
  if (line.velocities->kills_at_top()) return {held, below};
  DenseMatrix own(held, held), jumps(held, below);
  for (int l = 0; l < held; ++l) {
    own(l, l) = shift_.along(line.branch).at(line.velocities->v_max());
    for (const auto& [to, rate] : noise.jumps(noise.first() + below + l)) {
      const int place = to - noise.first();
      own(l, l) += rate;
      if (place < below) {
        jumps(l, place) = rate;
      } else {
        own(l, place - below) -= rate;
      }
    }
  }
  DenseFactors factors(std::move(own));
  factors.solve(jumps);
  between_.solve(std::move(factors), line.rising_at(line.velocities->elements()));
  return jumps;
}

// From v_max down to v = 0: w takes up what each element gives, as it comes back from above.
template <class Scalar>
void ElementElimination<Scalar>::reflect(Line& line) {
  DenseMatrix reflection = hold(line);
  std::vector<std::pair<DenseMatrix, DenseMatrix>> outwards;
  for (int e = line.velocities->elements(); e-- > 0;) {
    auto s = response(line, static_cast<std::size_t>(e));
    const int falling = line.rising[e + 1];
    DenseMatrix turns = DenseMatrix::identity(falling);
    add_product(-1, s.outer_outer, reflection, falling, turns);
    DenseFactors factors(std::move(turns));
    DenseMatrix through = std::move(s.outer_inner);
    factors.solve(through);
    DenseMatrix returned = reflection * through;
    add_product(1, s.inner_outer, returned, returned.columns(), s.inner_inner);
    const std::size_t fall = line.falling_at(e + 1), rise = line.rising_at(e + 1);
    between_.add(std::move(s.outer_outer), rise, fall);
    between_.solve(std::move(factors), fall);
    between_.add(std::exchange(reflection, std::move(s.inner_inner)), fall, rise);
    between_.add(std::move(s.inner_outer), rise, line.rising_at(e));
    outwards.emplace_back(std::move(through), std::move(returned));
  }
  line.reflection = reflection;
  line.outwards.add(std::move(reflection), line.falling_at(0), line.rising_at(0));
  for (int e = 0; e < line.velocities->elements(); ++e) {
    auto& [through, returned] = outwards[outwards.size() - 1 - static_cast<std::size_t>(e)];
    line.outwards.add(std::move(through), line.falling_at(e), line.falling_at(e + 1));
    line.outwards.add(std::move(returned), line.falling_at(e), line.rising_at(e + 1));
  }
}

// What a branch finds in the static states, of its nodes that fall to v = 0 from `fall` on.
template <class Scalar>
void ElementElimination<Scalar>::add_shares(const Line& line, std::size_t fall,
                                            Couplings& shares) const {
  const StateSpace& states = data_->states;
  const noise::Nodes& noise = *line.noise;
  const Branch other = states.symmetry_reduced() ? line.branch : opposite(line.branch);
  for (int l = 0; l < line.rising[0]; ++l) {
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
    const PetscInt q = line.velocities->element(0).reference->size;
    for (int node = data_->states.last_static(line.branch) + 1 - line.noise->first();
         node < line.count(); ++node) {
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
    for (int l = 0; l < line.rising[0]; ++l) returned.push_back({length_++, line.begin + l, 1});
  }
  const std::size_t falling = length_ - fall;
  StaticRows<Scalar> at_rest = read_static_rows(matrix);
  Steps leaving;
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
    leaving.add(std::move(left), exit, static_begin_);
  }
  DenseMatrix closed = DenseMatrix::identity(static_cast<int>(falling));
  int first = 0;
  for (const Line& line : lines_) {
    for (const auto& [from, to, weight] : found) {
      if (from < line.rising_at(0) || from >= line.falling_at(1)) continue;
      const int n = static_cast<int>(from - line.rising_at(0)), row = static_cast<int>(to - fall);
      for (int c = 0; c < line.rising[0]; ++c) {
        closed(row, first + c) -= weight * line.reflection(n, c);
      }
    }
    first += line.rising[0];
  }
  at_rest.move_to(between_, static_begin_);
  between_.add(std::move(shares));
  between_.add(std::move(found));
  between_.solve(DenseFactors(std::move(closed)), fall);
  between_.add(std::move(returned));
  for (Line& line : lines_) between_.append(std::move(line.outwards));
  between_.append(std::move(leaving));
}

template <class Scalar>
template <class Visit>
void ElementElimination<Scalar>::for_each_own_element(Visit visit) const {
  for (const Line& line : lines_) {
    for (int e = 0; e < static_cast<int>(line.elements.size()); ++e) {
      if (line.elements[e]) visit(line, e, *line.elements[e]);
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
    std::size_t place = line.rising_at(line.velocities->elements());
    for (PetscInt row : line.holding) visit(place++, row);
  }
  for (std::size_t n = 0; n < static_rows_.size(); ++n) visit(static_begin_ + n, static_rows_[n]);
}

template <class Scalar>
void ElementElimination<Scalar>::solve(Scalars& x, bool transposed) const {
  Scalars w(length_, 0.0);
  std::vector<Scalars> f;  // by element of this rank
  for_each_own_element([&](const Line& line, int e, const Element& element) {
    Scalars alone(static_cast<std::size_t>(element.size()));
    for_each_unknown(line, element, [&](std::size_t n, PetscInt row) { alone[n] = x[row]; });
    f.push_back(alone);
    element.solve(alone, transposed);
    element.collect(transposed ? element.taken() : element.given(), alone, &w[line.falling_at(e)],
                    &w[line.falling_at(e + 1)]);
  });
  sum_over_ranks(comm_, w);
  for_each_unknown_between([&](std::size_t n, PetscInt row) { w[n] += x[row]; });
  between_.run(w, transposed);
  std::fill(x.begin(), x.end(), 0.0);
  auto own = f.begin();
  for_each_own_element([&](const Line& line, int e, const Element& element) {
    element.distribute(transposed ? element.given() : element.taken(), &w[line.falling_at(e)],
                       &w[line.falling_at(e + 1)], *own);
    element.solve(*own, transposed);
    for_each_unknown(line, element, [&](std::size_t n, PetscInt row) { x[row] = (*own)[n]; });
    ++own;
  });
  if (petsc::rank(comm_) == 0) {
    for_each_unknown_between([&](std::size_t n, PetscInt row) { x[row] = w[n]; });
  }
  sum_over_ranks(comm_, x);
}

template <class Scalar>
double ElementElimination<Scalar>::entries() const {
  double sum = between_.entries();
  for_each_own_element([&](const Line&, int, const Element& element) { sum += element.entries(); });
  return sum;
}

template class ElementElimination<std::complex<double>>;
#if !defined(PETSC_USE_COMPLEX)
template class ElementElimination<double>;
#endif

}  // namespace stickslip::operators
