#include "stickslip/petsc/high_modes.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/dense.hpp"
#include "stickslip/petsc/memory.hpp"
#include "stickslip/petsc/session.hpp"
#include "stickslip/petsc/vectors.hpp"
#include "stickslip/support/errors.hpp"

namespace stickslip::petsc {
namespace {

using Scalars = std::vector<PetscScalar>;

// Of the rate of jumps: keeps transport invertible where it ends within an element.
constexpr double kShift = 1e-6;

// y = a x, or a^T x, for a small square matrix by columns.
void multiply(const PetscScalar* a, int size, bool transposed, const PetscScalar* x,
              PetscScalar* y) {
  if (transposed) {
    for (int c = 0; c < size; ++c) {
      PetscScalar sum = 0;
      for (int r = 0; r < size; ++r) sum += a[r + c * size] * x[r];
      y[c] = sum;
    }
    return;
  }
  std::fill(y, y + size, 0.0);
  for (int c = 0; c < size; ++c) {
    for (int r = 0; r < size; ++r) y[r] += a[r + c * size] * x[c];
  }
}

// The half of what is passed for both arms.
template <class Both>
auto* of_arm(Both& both, int arm) {
  return both.data() + (arm == 0 ? 0 : both.size() / 2);
}

std::size_t square(int n) { return static_cast<std::size_t>(n) * n; }

const SplitMatrix& parts_of(Mat matrix) {
  const SplitMatrix* split = SplitMatrix::of(matrix);
  if (split == nullptr) throw std::logic_error("high modes are those of a split matrix");
  return *split;
}

// A matrix on the nodes of an element in the basis of its coarse values and high modes.
Scalars in_modes(const ElementModes& modes, const Scalars& nodal) {
  const int q = modes.nodes, c = modes.coarse_nodes, h = modes.high();
  Scalars half(nodal.size()), modal(nodal.size());
  product("NN", c, q, q, 1, modes.restriction.data(), c, nodal.data(), q, 0, half.data(), q);
  product("NN", h, q, q, 1, modes.to_high.data(), h, nodal.data(), q, 0, half.data() + c, q);
  product("NN", q, c, q, 1, half.data(), q, modes.prolong.data(), q, 0, modal.data(), q);
  product("NN", q, h, q, 1, half.data(), q, modes.from_high.data(), q, 0,
          modal.data() + static_cast<std::ptrdiff_t>(q) * c, q);
  return modal;
}

// Between the coarse nodes of each element and its fine ones, upwards or downwards.
void transfer(const Hierarchy& hierarchy, const PetscScalar* from, PetscScalar* to, bool upwards,
              bool transposed) {
  const int levels = hierarchy.levels;
  for (const Strip& strip : hierarchy.strips) {
    const auto& m = *strip.modes;
    const bool prolongs = upwards != transposed;
    const auto& matrix = prolongs ? m.prolong : m.restriction;
    const PetscInt fine = strip.first, coarse = strip.coarse_first;
    product(transposed ? "NN" : "NT", levels, upwards ? m.nodes : m.coarse_nodes,
            upwards ? m.coarse_nodes : m.nodes, 1, from + (upwards ? coarse : fine), levels,
            matrix.data(), prolongs ? m.nodes : m.coarse_nodes, 0, to + (upwards ? fine : coarse),
            levels);
  }
}

}  // namespace

void restrict_to_coarse(const Hierarchy& hierarchy, Vec b, Vec c, bool transposed) {
  const ReadView from(b);
  WriteView to(c);
  transfer(hierarchy, from.data(), to.data(), false, transposed);
  for (const auto& [fine, own] : hierarchy.others) to[own] = from[fine];
}

void prolong(const Hierarchy& hierarchy, Vec c, Vec x, bool transposed) {
  const ReadView from(c);
  WriteView to(x);
  transfer(hierarchy, from.data(), to.data(), true, transposed);
  for (const auto& [fine, own] : hierarchy.others) to[fine] = from[own];
}

HighModes::HighModes(Mat matrix, Mat coarse, Hierarchy hierarchy)
    : parts_(parts_of(matrix)),
      hierarchy_(std::move(hierarchy)),
      comm_(PetscObjectComm(reinterpret_cast<PetscObject>(matrix))),
      ranks_(neighbours(comm_, hierarchy_.levels)) {
  check(PetscObjectReference(reinterpret_cast<PetscObject>(matrix)));
  matrix_ = MatHandle(matrix);
  check(MatCreateVecs(coarse, coarse_x_.out(), coarse_b_.out()));
  check(MatCreateVecs(matrix_, nullptr, residual_.out()));
}

double HighModes::entries() const {
  double sum = 0;
  for (const Strip& strip : hierarchy_.strips) {
    sum += static_cast<double>(square(strip.modes->high()));
  }
  return hierarchy_.levels * sum;
}

double HighModes::operations() const {
  double sum = 0;
  for (const Strip& strip : hierarchy_.strips) {
    const double high = strip.modes->high(), low = strip.modes->coarse_nodes, all = high + low;
    sum += 8 * all * all + 2 * low * high * all + 2 * high * high * high;
  }
  return hierarchy_.levels * sum;
}

std::array<HighModes::Arm, 2> HighModes::arms() const {
  const int centre = hierarchy_.centre ? 1 : 0;
  const auto& [killing, to_above, to_below, from_above, from_below, gap] =
      parts_.jumps().by_level();
  return {Arm{0, 0, hierarchy_.below, 1, to_below, from_below, to_above, from_above},
          Arm{1, hierarchy_.levels - 1, hierarchy_.below + centre - 1, -1, to_above, from_above,
              to_below, from_below}};
}

// S + J_aa of all levels into the pivots.
bool HighModes::complement(std::size_t n) {
  const ElementModes& modes = *hierarchy_.strips[n].modes;
  const Transport& transport = parts_.transport();
  const LevelJumps& jumps = parts_.jumps().by_level();
  const int q = modes.nodes, c = modes.coarse_nodes, h = modes.high();
  const auto nodal = transport.terms(n);
  const Scalars by_excess = in_modes(modes, nodal.by_excess),
                constant = in_modes(modes, nodal.constant), by_up = in_modes(modes, nodal.by_up),
                by_down = in_modes(modes, nodal.by_down);
  Scalars block(square(q)), solved(static_cast<std::size_t>(c) * h);
  std::vector<int> exchanges(static_cast<std::size_t>(c));
  bool sound = true;
  for (int a = 0; a < hierarchy_.levels; ++a) {
    const auto [excess, up, down] = transport.speeds(n, a);
    for (std::size_t k = 0; k < block.size(); ++k) {
      block[k] = -(excess * by_excess[k] + constant[k] + up * by_up[k] + down * by_down[k]);
    }
    // Of the jumps, coarse values keep the shift alone.
    for (int k = 0; k < q; ++k) {
      block[k + q * k] += jumps.killing + (k < c ? kShift : 1) * jumps.rate(a);
    }
    const PetscScalar* right = block.data() + static_cast<std::ptrdiff_t>(q) * c;
    PetscScalar* s = pivots_[n].data() + square(h) * a;
    for (std::ptrdiff_t k = 0; k < h; ++k) std::copy_n(right + c + q * k, h, s + h * k);
    sound = invert(block.data(), c, q, exchanges) && sound;
    product("NN", c, h, c, 1, block.data(), q, right, q, 0, solved.data(), c);
    product("NN", h, h, c, -1, block.data() + c, q, solved.data(), c, 1, s, h);
  }
  return sound;
}

// Pivots from the outermost level inwards, inverted.
bool HighModes::eliminate(std::size_t n) {
  const int h = hierarchy_.strips[n].modes->high();
  const std::size_t entries = square(h);
  Scalars passed, next(2 * entries, 0.0);  // passed: the last pivots of both arms
  std::vector<int> exchanges(static_cast<std::size_t>(h));
  if (ranks_.has_outer()) passed = receive<PetscScalar>(2 * entries, ranks_.outer, comm_);
  bool sound = true;
  const auto pivot = [&](int level) { return pivots_[n].data() + entries * level; };
  for (const Arm& arm : arms()) {
    const PetscScalar* outer = passed.empty() ? nullptr : of_arm(passed, arm.number);
    const auto subtract = [&](int level) {
      if (outer == nullptr) return;
      const double factor = arm.to_outer[level] * arm.from_outer[level];
      for (std::size_t k = 0; k < entries; ++k) pivot(level)[k] -= factor * outer[k];
    };
    for (int a = arm.begin; a != arm.end; a += arm.step) {
      subtract(a);
      sound = invert(pivot(a), h, h, exchanges) && sound;
      outer = pivot(a);
    }
    if (hierarchy_.centre) subtract(hierarchy_.below);
    if (outer != nullptr) std::copy_n(outer, entries, of_arm(next, arm.number));
  }
  if (hierarchy_.centre) sound = invert(pivot(hierarchy_.below), h, h, exchanges) && sound;
  if (ranks_.has_inner()) send(next, ranks_.inner, comm_);
  return sound;
}

// All large memory.
void HighModes::reserve() {
  const auto levels = static_cast<std::size_t>(hierarchy_.levels);
  const std::size_t strips = hierarchy_.strips.size();
  pivots_.resize(strips);
  high_.resize(strips);
  take_together(comm_, [&] {
    for (std::size_t n = 0; n < strips; ++n) {
      const int h = hierarchy_.strips[n].modes->high();
      pivots_[n].resize(square(h) * levels);
      high_[n].resize(h * levels);
    }
  });
}

void HighModes::factor() {
  reserve();
  bool sound = true;  // on this rank; the others learn of it when all are through
  for (std::size_t n = 0; n < pivots_.size(); ++n) {
    if (hierarchy_.strips[n].modes->high() == 0) continue;
    sound = complement(n) && sound;
    sound = eliminate(n) && sound;
  }
  require_everywhere(comm_, sound ? "" : "a block of the high modes of p-multigrid is singular");
}

void HighModes::cycle(const CoarseSolve& solve, Vec b, Vec x, bool transposed) const {
  restrict_to_coarse(hierarchy_, b, coarse_b_, transposed);
  solve(coarse_b_, coarse_x_, transposed);
  prolong(hierarchy_, coarse_x_, x, transposed);
  check(transposed ? MatMultTranspose(matrix_, x, residual_) : MatMult(matrix_, x, residual_));
  check(VecAYPX(residual_, -1, b));
  add(residual_, x, transposed);
}

void HighModes::add(Vec r, Vec x, bool transposed) const {
  const ReadView right(r);
  WriteView left(x);
  add(right.data(), left.data(), transposed);
}

// Strip after strip, so that ranks work on different ones at the same time.
void HighModes::add(const PetscScalar* r, PetscScalar* x, bool transposed) const {
  const int levels = hierarchy_.levels;
  if (levels == 0) return;
  for (std::size_t n = 0; n < pivots_.size(); ++n) {
    const Strip& strip = hierarchy_.strips[n];
    const auto& m = *strip.modes;
    const int q = m.nodes, h = m.high();
    if (h == 0) continue;
    if (transposed) {
      product("TT", h, levels, q, 1, m.from_high.data(), q, r + strip.first, levels, 0,
              high_[n].data(), h);
    } else {
      product("NT", h, levels, q, 1, m.to_high.data(), h, r + strip.first, levels, 0,
              high_[n].data(), h);
    }
    pass_inwards(n, transposed);
  }
  for (std::size_t n = 0; n < pivots_.size(); ++n) {
    const Strip& strip = hierarchy_.strips[n];
    const auto& m = *strip.modes;
    const int q = m.nodes, h = m.high();
    if (h == 0) continue;
    pass_outwards(n, transposed);
    if (transposed) {
      product("TN", levels, q, h, 1, high_[n].data(), h, m.to_high.data(), h, 1, x + strip.first,
              levels);
    } else {
      product("TT", levels, q, h, 1, high_[n].data(), h, m.from_high.data(), q, 1, x + strip.first,
              levels);
    }
  }
}

// y_a <- z_a = P_a (y_a + r z_outer), P the inverse pivots, r the rate to the level outside; in a
// transposed system, from there.
void HighModes::pass_inwards(std::size_t n, bool transposed) const {
  const int h = hierarchy_.strips[n].modes->high();
  Scalars passed, next(2 * static_cast<std::size_t>(h), 0.0), sum(static_cast<std::size_t>(h));
  if (ranks_.has_outer()) {
    passed = receive<PetscScalar>(2 * static_cast<std::size_t>(h), ranks_.outer, comm_);
  }
  const auto at = [&](int level) {
    return high_[n].data() + static_cast<std::ptrdiff_t>(h) * level;
  };
  const auto finish = [&](int level) {
    multiply(pivots_[n].data() + square(h) * level, h, transposed, at(level), sum.data());
    std::copy(sum.begin(), sum.end(), at(level));
  };
  for (const Arm& arm : arms()) {
    const PetscScalar* outer = passed.empty() ? nullptr : of_arm(passed, arm.number);
    const auto& rate = transposed ? arm.from_outer : arm.to_outer;
    const auto add_outer = [&](int level) {
      if (outer == nullptr) return;
      for (int k = 0; k < h; ++k) at(level)[k] += rate[level] * outer[k];
    };
    for (int a = arm.begin; a != arm.end; a += arm.step) {
      add_outer(a);
      finish(a);
      outer = at(a);
    }
    if (hierarchy_.centre) add_outer(hierarchy_.below);
    if (outer != nullptr) std::copy_n(outer, h, of_arm(next, arm.number));
  }
  if (hierarchy_.centre) finish(hierarchy_.below);
  if (ranks_.has_inner()) send(next, ranks_.inner, comm_);
}

// z_a <- x_a = z_a + P_a r x_inner, r the rate to the level inside, or from there.
void HighModes::pass_outwards(std::size_t n, bool transposed) const {
  const int h = hierarchy_.strips[n].modes->high();
  Scalars passed, next, step(static_cast<std::size_t>(h));
  if (ranks_.has_inner()) {
    passed = receive<PetscScalar>(2 * static_cast<std::size_t>(h), ranks_.inner, comm_);
  }
  const auto at = [&](int level) {
    return high_[n].data() + static_cast<std::ptrdiff_t>(h) * level;
  };
  for (const Arm& arm : arms()) {
    const PetscScalar* inner =
        hierarchy_.centre ? at(hierarchy_.below) : of_arm(passed, arm.number);
    const auto& rate = transposed ? arm.from_inner : arm.to_inner;
    for (int a = arm.end - arm.step; a != arm.begin - arm.step; a -= arm.step) {
      multiply(pivots_[n].data() + square(h) * a, h, transposed, inner, step.data());
      for (int k = 0; k < h; ++k) at(a)[k] += rate[a] * step[k];
      inner = at(a);
    }
    next.insert(next.end(), inner, inner + h);
  }
  if (ranks_.has_outer()) send(next, ranks_.outer, comm_);
}

}  // namespace stickslip::petsc
