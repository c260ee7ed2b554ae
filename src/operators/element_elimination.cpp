#include "stickslip/operators/element_elimination.hpp"

#include <algorithm>
#include <cstdlib>

#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/vectors.hpp"
#include "stickslip/support/errors.hpp"

namespace stickslip::operators {
namespace {

using petsc::add_product;
using petsc::check;
using petsc::Scalars;

Scalars times(const petsc::DenseMatrix& a, const Scalars& x, bool transposed = false) {
  Scalars y(static_cast<std::size_t>(transposed ? a.columns() : a.rows()), 0.0);
  add_product(a, x, y, transposed);
  return y;
}

void add(const Scalars& x, Scalars& y) {
  for (std::size_t n = 0; n < x.size(); ++n) y[n] += x[n];
}

// A list over all noise nodes from its lowest or its highest part.
Scalars lowest(const Scalars& part, std::size_t count) {
  Scalars all(count, 0.0);
  std::copy(part.begin(), part.end(), all.begin());
  return all;
}
Scalars highest(const Scalars& part, std::size_t count) {
  Scalars all(count, 0.0);
  std::copy(part.begin(), part.end(), all.end() - static_cast<std::ptrdiff_t>(part.size()));
  return all;
}
Scalars first_part(const Scalars& all, int size) { return {all.begin(), all.begin() + size}; }
Scalars from_part(const Scalars& all, int begin) { return {all.begin() + begin, all.end()}; }

}  // namespace

ElementElimination::ElementElimination(const Discretisation& discretisation,
                                       const StateSpace& states, Mat matrix, PetscScalar lambda)
    : discretisation_(discretisation), states_(states), assembled_at_(lambda) {
  check(PetscObjectReference(reinterpret_cast<PetscObject>(matrix)));
  matrix_ = petsc::MatHandle(matrix);
  for (Half half : states_.halves()) {
    Line line = line_of(half);
    line.falling_at = falling_;
    line.rising_at = rising_;
    line.rising = rising_at(line, 0);
    falling_ += static_cast<std::size_t>(line.rising);
    rising_ += static_cast<std::size_t>(count() - line.rising);
    lines_.push_back(std::move(line));
  }
  predict_cost();
}

const velocity::HpAxis& ElementElimination::axis_of(Half half) const {
  const velocity::Axis& axis = *discretisation_.axis;
  return dynamic_cast<const velocity::HpAxis&>(half == Half::upper ? axis : axis.mirrored());
}

ElementElimination::Line ElementElimination::line_of(Half half) const {
  const model::Process process =
      half == Half::upper ? discretisation_.process : discretisation_.process.mirrored();
  const noise::Nodes& noise = *discretisation_.noise;
  Line line;
  line.half = half;
  for (int n = -noise.half(); n <= noise.half(); ++n) {
    line.excess.push_back(process.excess_at(noise.x(n)));
    const auto nodes = states_.nodes_of(half, n);
    line.first.push_back(nodes.first);
    line.stride = nodes.stride;
    if (states_.has_holding(half, n)) {
      line.holding.push_back(states_.index({StateKind::holding, half, n, 0}));
    }
  }
  return line;
}

// First noise node with a positive speed at an end of elements.
int ElementElimination::rising_at(const Line& line, int end) const {
  const double drag = axis_of(line.half).drag_at_end(end);
  const auto first = std::partition_point(line.excess.begin(), line.excess.end(),
                                          [drag](double e) { return e + drag <= 0; });
  return static_cast<int>(first - line.excess.begin());
}

void ElementElimination::predict_cost() {
  double entries = 0, operations = 0;
  const double all = count();
  for (const Line& line : lines_) {
    const velocity::HpAxis& axis = axis_of(line.half);
    double inner = rising_at(line, 0);
    for (int e = 0; e < axis.elements(); ++e) {
      const double q = axis.element(e).reference->size, outer = rising_at(line, e + 1);
      for (const auto& group : discretisation_.noise->groups()) {
        const double n = group.count * q;
        entries += n * n + 2 * n * q;
        operations += n * n * (2 * n / 3 + 4 * q + 2 * group.count);
        operations += (group.count == 1 ? 4 : 8) * q * q * all;
      }
      const double up = all - outer, up_inner = all - inner;
      entries += up_inner * up + outer * inner + 2 * outer * up + outer * outer;
      operations += 2 * outer * (outer * up + outer * outer / 3 + outer * inner + up * inner) +
                    2 * up_inner * up * inner + 4 * q * all * all;
      inner = outer;
    }
  }
  constexpr double scalar = sizeof(PetscScalar);
  set_cost(entries, scalar * entries, operations);
}

void ElementElimination::factor(PetscScalar shift) {
  lambda_ = assembled_at_ + shift;
  for (Line& line : lines_) factor(line);
  read_rest();
  join();
}

// What holding states make of the values that fall at v_max.
void ElementElimination::hold(Line& line, DenseMatrix& reflection) const {
  const noise::Nodes& noise = *discretisation_.noise;
  const int held = static_cast<int>(line.holding.size()), below = count() - held;
  DenseMatrix own(held, held);
  line.hold_jumps = DenseMatrix(held, below);
  for (int l = 0; l < held; ++l) {
    own(l, l) = lambda_;
    for (const auto& [to, rate] : noise.jumps(below + l - noise.half())) {
      const int place = to + noise.half();
      own(l, l) += rate;
      if (place < below) {
        line.hold_jumps(l, place) = rate;
      } else {
        own(l, place - below) -= rate;
      }
    }
  }
  line.hold = DenseFactors(std::move(own));
  reflection = line.hold_jumps;
  line.hold.solve(reflection);
}

void ElementElimination::factor(Line& line) const {
  const velocity::HpAxis& axis = axis_of(line.half);
  line.links.clear();
  DenseMatrix reflection;
  hold(line, reflection);
  std::vector<Link> links;
  for (int e = axis.elements(); e-- > 0;) {
    Link link{{*discretisation_.noise, axis, e, line.excess, lambda_}, {}, {}, {}, {}, {}};
    auto s = link.element.response();
    link.reflection = std::move(reflection);
    const int falling = link.element.rising_at_outer();
    DenseMatrix turns(falling, falling);
    for (int n = 0; n < falling; ++n) turns(n, n) = 1;
    add_product(-1, s.outer_outer, link.reflection, falling, turns);
    link.turns = DenseFactors(std::move(turns));
    DenseMatrix through = s.outer_inner;
    link.turns.solve(through);
    reflection = std::move(s.inner_inner);
    add_product(1, s.inner_outer, link.reflection * through, reflection.columns(), reflection);
    link.inner_outer = std::move(s.inner_outer);
    link.outer_inner = std::move(s.outer_inner);
    link.outer_outer = std::move(s.outer_outer);
    links.push_back(std::move(link));
  }
  for (auto link = links.rbegin(); link != links.rend(); ++link) {
    line.links.push_back(std::move(*link));
  }
  line.reflection = std::move(reflection);
}

// Of the nodes that rise at v = 0, the one to which an entry of a row at rest belongs.
std::size_t ElementElimination::exit_of(PetscInt column) const {
  for (const Line& line : lines_) {
    const int node = states_.last_static(line.half) + 1 + discretisation_.noise->half();
    const PetscInt from = column - line.first[node], q = line.links.front().element.nodes();
    const PetscInt place = line.stride == 0 ? 0 : from / line.stride;
    if (from == place * line.stride && place >= 0 && place < q) {
      return line.rising_at + static_cast<std::size_t>(node - line.rising);
    }
  }
  throw NotReached("a state at rest is left for one that is no exit");
}

void ElementElimination::read_rest() {
  rest_ = {};
  if (!states_.with_rest()) return;
  const auto& process = discretisation_.process;
  std::vector<std::ptrdiff_t> place(static_cast<std::size_t>(states_.local_size()), -1);
  for (int i = process.lowest_static(); i <= process.static_index(); ++i) {
    if (!states_.has_rest(i)) continue;
    if (rest_.rows.empty()) rest_.lowest = i;
    rest_.rows.push_back(states_.index({StateKind::rest, Half::upper, i, 0}));
    place[rest_.rows.back()] = static_cast<std::ptrdiff_t>(rest_.rows.size()) - 1;
  }
  const std::size_t size = rest_.rows.size();
  for (Scalars* band : {&rest_.diagonal, &rest_.below, &rest_.above}) band->assign(size, 0.0);
  for (std::size_t n = 0; n < size; ++n) {
    petsc::RowView(matrix_, rest_.rows[n]).for_each([&](PetscInt column, PetscScalar value) {
      const std::ptrdiff_t other = place[column];
      if (other < 0) {
        // Traces sum to 1.
        rest_.exits.push_back({n, exit_of(column), -value});
      } else if (other == static_cast<std::ptrdiff_t>(n)) {
        rest_.diagonal[n] += value;
      } else {
        (other < static_cast<std::ptrdiff_t>(n) ? rest_.below : rest_.above)[n] += value;
      }
    });
  }
  rest_.factor();
  for (const Line& line : lines_) {
    const int opposite = states_.last_static(
        states_.folded() ? line.half : (line.half == Half::upper ? Half::lower : Half::upper));
    for (int l = 0; l < line.rising; ++l) {
      const int node = l - discretisation_.noise->half();
      if (node >= -opposite) place_rest_shares(line, node, line.falling_at + l);
    }
  }
}

void ElementElimination::place_rest_shares(const Line& line, int node, std::size_t row) {
  const auto& group = discretisation_.noise->group_of(node);
  const double reflected = states_.symmetry() == Symmetry::odd ? -1 : 1;
  for (int along = group.first; along <= group.last; ++along) {
    const int i = line.half == Half::upper ? along : -along;
    const int kept = states_.folded() ? std::abs(i) : i;
    if (!states_.has_rest(kept)) continue;  // an odd function vanishes at x = 0
    const double share = group.row(group.weight, along)[node - group.begin];
    rest_.shares.push_back({row, static_cast<std::size_t>(kept - rest_.lowest),
                            kept == i ? share : reflected * share});
  }
}

void ElementElimination::RestChain::factor() {
  for (std::size_t n = 1; n < diagonal.size(); ++n) {
    below[n] /= diagonal[n - 1];
    diagonal[n] -= below[n] * above[n - 1];
  }
}

void ElementElimination::RestChain::solve(Scalars& x, bool transposed) const {
  const std::size_t size = diagonal.size();
  if (size == 0) return;
  if (!transposed) {
    for (std::size_t n = 1; n < size; ++n) x[n] -= below[n] * x[n - 1];
    x[size - 1] /= diagonal[size - 1];
    for (std::size_t n = size - 1; n-- > 0;) x[n] = (x[n] - above[n] * x[n + 1]) / diagonal[n];
    return;
  }
  x[0] /= diagonal[0];
  for (std::size_t n = 1; n < size; ++n) x[n] = (x[n] - above[n - 1] * x[n - 1]) / diagonal[n];
  for (std::size_t n = size - 1; n-- > 0;) x[n] -= below[n + 1] * x[n + 1];
}

// What falls to v = 0 goes on at the other side, or comes to rest and leaves by an exit.
void ElementElimination::join() {
  meeting_ = DenseMatrix(static_cast<int>(falling_), static_cast<int>(rising_));
  const int half = discretisation_.noise->half();
  for (std::size_t n = 0; n < lines_.size(); ++n) {
    const Line& line = lines_[n];
    const Line& other = lines_[states_.folded() ? n : 1 - n];
    const double sign = states_.symmetry() == Symmetry::odd ? -1 : 1;
    for (int node = -half; node < -states_.last_static(other.half); ++node) {
      const std::size_t row = line.falling_at + static_cast<std::size_t>(node + half);
      const std::size_t column =
          other.rising_at + static_cast<std::size_t>(half - node - other.rising);
      meeting_(static_cast<int>(row), static_cast<int>(column)) = sign;
    }
  }
  for (const auto& exit : rest_.exits) {
    Scalars left(rest_.rows.size(), 0.0);
    left[exit.level] = exit.rate;
    rest_.solve(left, false);
    for (const auto& share : rest_.shares) {
      meeting_(static_cast<int>(share.node), static_cast<int>(exit.node)) +=
          share.weight * left[share.level];
    }
  }
  DenseMatrix reflected(static_cast<int>(rising_), static_cast<int>(falling_));
  for (const Line& line : lines_) {
    for (int c = 0; c < line.reflection.columns(); ++c) {
      std::copy_n(line.reflection.column(c), line.reflection.rows(),
                  reflected.column(static_cast<int>(line.falling_at) + c) + line.rising_at);
    }
  }
  DenseMatrix closed(static_cast<int>(falling_), static_cast<int>(falling_));
  for (int n = 0; n < closed.rows(); ++n) closed(n, n) = 1;
  add_product(-1, meeting_, reflected, closed.columns(), closed);
  closed_ = DenseFactors(std::move(closed));
}

Scalars ElementElimination::gathered(const Line& line, const ElementSystem& element,
                                     const PetscScalar* b) const {
  Scalars f(static_cast<std::size_t>(element.size()));
  auto to = f.begin();
  for (PetscInt first : line.first) {
    for (int m = 0; m < element.nodes(); ++m) {
      *to++ = b[first + line.stride * (element.first_node() + m)];
    }
  }
  return f;
}

void ElementElimination::scatter(const Line& line, const ElementSystem& element, const Scalars& u,
                                 PetscScalar* x) const {
  auto from = u.begin();
  for (PetscInt first : line.first) {
    for (int m = 0; m < element.nodes(); ++m) {
      x[first + line.stride * (element.first_node() + m)] = *from++;
    }
  }
}

void ElementElimination::apply(Vec b, Vec x, bool transposed) const {
  const petsc::ReadView from(b);
  petsc::WriteView to(x);
  std::vector<Waves> waves;
  for (const Line& line : lines_) {
    waves.push_back(transposed ? inwards_transposed(line, from.data())
                               : inwards(line, from.data()));
  }
  transposed ? meet_transposed(waves, from.data(), to.data()) : meet(waves, from.data(), to.data());
  for (std::size_t n = 0; n < lines_.size(); ++n) {
    transposed ? outwards_transposed(lines_[n], waves[n], to.data())
               : outwards(lines_[n], waves[n], to.data());
  }
}

// up[e] = r_e; down[e + 1] = (1 - S_oo R)^-1 of what falls there from element e alone.
ElementElimination::Waves ElementElimination::inwards(const Line& line,
                                                      const PetscScalar* b) const {
  const std::size_t size = line.links.size(), all = line.first.size();
  Waves waves(size);
  Scalars& held = waves.up[size];
  for (PetscInt row : line.holding) held.push_back(b[row]);
  line.hold.solve(held, false);
  Scalars inner(all), outer(all);
  for (std::size_t e = size; e-- > 0;) {
    const Link& link = line.links[e];
    waves.f[e] = gathered(line, link.element, b);
    Scalars alone = waves.f[e];
    link.element.solve(alone, false);
    link.element.trace(alone, inner, outer);
    Scalars fall = first_part(outer, link.element.rising_at_outer());
    add_product(link.outer_outer, waves.up[e + 1], fall);
    link.turns.solve(fall, false);
    Scalars rise = waves.up[e + 1];
    add_product(link.reflection, fall, rise);
    waves.up[e] = from_part(inner, link.element.rising_at_inner());
    add_product(link.inner_outer, rise, waves.up[e]);
    waves.down[e + 1] = std::move(fall);
  }
  return waves;
}

void ElementElimination::outwards(const Line& line, Waves& waves, PetscScalar* x) const {
  const std::size_t all = line.first.size();
  for (std::size_t e = 0; e < line.links.size(); ++e) {
    const Link& link = line.links[e];
    Scalars fall = times(link.outer_inner, waves.down[e]);
    link.turns.solve(fall, false);
    add(fall, waves.down[e + 1]);
    add_product(link.reflection, waves.down[e + 1], waves.up[e + 1]);
    link.element.lift(lowest(waves.down[e], all), highest(waves.up[e + 1], all), waves.f[e]);
    link.element.solve(waves.f[e], false);
    scatter(line, link.element, waves.f[e], x);
  }
  for (std::size_t n = 0; n < line.holding.size(); ++n) x[line.holding[n]] = waves.up.back()[n];
}

void ElementElimination::meet(std::vector<Waves>& waves, const PetscScalar* b,
                              PetscScalar* x) const {
  Scalars rising(rising_), rest;
  for (std::size_t n = 0; n < lines_.size(); ++n) {
    std::copy(waves[n].up[0].begin(), waves[n].up[0].end(), rising.begin() + lines_[n].rising_at);
  }
  for (PetscInt row : rest_.rows) rest.push_back(b[row]);
  Scalars left = rest;
  rest_.solve(left, false);
  Scalars falling = times(meeting_, rising);
  for (const auto& share : rest_.shares) falling[share.node] += share.weight * left[share.level];
  closed_.solve(falling, false);
  for (std::size_t n = 0; n < lines_.size(); ++n) {
    const Line& line = lines_[n];
    waves[n].down[0].assign(falling.begin() + line.falling_at,
                            falling.begin() + line.falling_at + line.rising);
    add_product(line.reflection, waves[n].down[0], waves[n].up[0]);
    std::copy(waves[n].up[0].begin(), waves[n].up[0].end(), rising.begin() + line.rising_at);
  }
  for (const auto& exit : rest_.exits) rest[exit.level] += exit.rate * rising[exit.node];
  rest_.solve(rest, false);
  for (std::size_t n = 0; n < rest.size(); ++n) x[rest_.rows[n]] = rest[n];
}

// The part of a line in a list of all nodes that rise at v = 0.
Scalars ElementElimination::rising_of(const Line& line, const Scalars& rising) const {
  const auto begin = rising.begin() + static_cast<std::ptrdiff_t>(line.rising_at);
  return {begin, begin + (count() - line.rising)};
}

// The transposed: fluxes go where values came from. down[e]: what falls through v_e; up[e + 1]:
// what rises there from element e alone, with what returns of what falls.
ElementElimination::Waves ElementElimination::inwards_transposed(const Line& line,
                                                                 const PetscScalar* b) const {
  const std::size_t size = line.links.size(), all = line.first.size();
  Waves waves(size);
  for (PetscInt row : line.holding) waves.f[size].push_back(b[row]);
  Scalars held = waves.f[size];
  line.hold.solve(held, true);
  waves.down[size] = times(line.hold_jumps, held, true);
  Scalars inner(all), outer(all);
  for (std::size_t e = size; e-- > 0;) {
    const Link& link = line.links[e];
    waves.f[e] = gathered(line, link.element, b);
    Scalars alone = waves.f[e];
    link.element.solve(alone, true);
    link.element.lift_transposed(alone, inner, outer);
    Scalars rise = from_part(outer, link.element.rising_at_outer());
    add_product(link.outer_outer, waves.down[e + 1], rise, true);
    Scalars fall = times(link.reflection, rise, true);
    link.turns.solve(fall, true);
    add(waves.down[e + 1], fall);
    waves.down[e] = first_part(inner, link.element.rising_at_inner());
    add_product(link.outer_inner, fall, waves.down[e], true);
    waves.up[e + 1] = std::move(rise);
  }
  return waves;
}

void ElementElimination::outwards_transposed(const Line& line, Waves& waves, PetscScalar* x) const {
  const std::size_t size = line.links.size(), all = line.first.size();
  for (std::size_t e = 0; e < size; ++e) {
    const Link& link = line.links[e];
    Scalars& rise = waves.up[e + 1];
    add_product(link.inner_outer, waves.up[e], rise, true);
    Scalars fall = times(link.reflection, rise, true);
    link.turns.solve(fall, true);
    add_product(link.outer_outer, fall, rise, true);
    add(fall, waves.down[e + 1]);
    link.element.trace_transposed(highest(waves.up[e], all), lowest(waves.down[e + 1], all),
                                  waves.f[e]);
    link.element.solve(waves.f[e], true);
    scatter(line, link.element, waves.f[e], x);
  }
  Scalars held = waves.f[size];
  add(waves.up[size], held);
  line.hold.solve(held, true);
  for (std::size_t n = 0; n < held.size(); ++n) x[line.holding[n]] = held[n];
}

void ElementElimination::meet_transposed(std::vector<Waves>& waves, const PetscScalar* b,
                                         PetscScalar* x) const {
  Scalars rest, falling(falling_);
  for (PetscInt row : rest_.rows) rest.push_back(b[row]);
  Scalars left = rest;
  rest_.solve(left, true);
  Scalars rising(rising_, 0.0);
  for (const auto& exit : rest_.exits) rising[exit.node] += exit.rate * left[exit.level];
  for (std::size_t n = 0; n < lines_.size(); ++n) {
    const Line& line = lines_[n];
    Scalars fall = waves[n].down[0];
    add_product(line.reflection, rising_of(line, rising), fall, true);
    std::copy(fall.begin(), fall.end(), falling.begin() + line.falling_at);
  }
  closed_.solve(falling, true);
  for (const auto& share : rest_.shares) rest[share.level] += share.weight * falling[share.node];
  add_product(meeting_, falling, rising, true);
  for (std::size_t n = 0; n < lines_.size(); ++n) {
    const Line& line = lines_[n];
    waves[n].up[0] = rising_of(line, rising);
  }
  rest_.solve(rest, true);
  for (std::size_t n = 0; n < rest.size(); ++n) x[rest_.rows[n]] = rest[n];
}

}  // namespace stickslip::operators
