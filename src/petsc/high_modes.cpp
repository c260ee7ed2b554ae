#include "stickslip/petsc/high_modes.hpp"

#include <petscsys.h>
// After PETSc itself, whose types it uses.
#include <petscblaslapack.h>

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
      ranks_(neighbours(comm_, hierarchy_.levels)),
      stacks_(hierarchy_.strips.size()) {
  check(PetscObjectReference(reinterpret_cast<PetscObject>(matrix)));
  matrix_ = MatHandle(matrix);
  check(MatGetOwnershipRange(matrix_, &first_row_, &end_row_));
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
  return {Arm{0, 0, hierarchy_.below, 1},
          Arm{1, hierarchy_.levels - 1, hierarchy_.below + centre - 1, -1}};
}

PetscScalar HighModes::outwards(const Stack& stack, const Arm& arm, int level) {
  return arm.number == 0 ? stack.down[level] : stack.up[level];
}

PetscScalar HighModes::inwards(const Stack& stack, const Arm& arm, int level) {
  return arm.number == 0 ? stack.up[level] : stack.down[level];
}

// Jumps leave the velocity as it is, at the same rate on all nodes: the row of the first node tells
// all. What lies on other ranks comes before (inwards) or after the local columns.
void HighModes::read_couplings(const Strip& strip, Stack& stack) const {
  const int levels = hierarchy_.levels;
  std::fill(stack.up.begin(), stack.up.end(), 0.0);
  std::fill(stack.down.begin(), stack.down.end(), 0.0);
  const auto [below, above] = arms();
  for (int a = 0; a < levels; ++a) {
    const PetscInt row = first_row_ + strip.first + a;
    const bool lower = a < below.end;
    const bool upper = a > above.end;
    const bool next_up = a + 1 < levels && !(lower && a + 1 == below.end && !hierarchy_.centre);
    const bool next_down = a > 0 && !(upper && a - 1 == above.end && !hierarchy_.centre);
    RowView(parts_.sparse(), row).for_each([&](PetscInt column, PetscScalar value) {
      if (column == row) stack.diagonal[a] = value;
      const bool inner = column < first_row_, outer = column >= end_row_;
      if ((next_up && column == row + 1) || (lower && inner) || (upper && outer)) {
        stack.up[a] += value;
      } else if ((next_down && column == row - 1) || (upper && inner) || (lower && outer)) {
        stack.down[a] += value;
      } else if (hierarchy_.centre && levels == 1 && outer) {
        // Level 0 alone: the columns of level -1 come first.
        (stack.down[a] == 0.0 ? stack.down : stack.up)[a] += value;
      }
    });
  }
}

// S + J_aa of all levels into the pivots. Here A is that of the element alone: the diagonal of the
// sparse part less transport.
bool HighModes::complement(std::size_t n, Stack& stack) const {
  const ElementModes& modes = *hierarchy_.strips[n].modes;
  const Transport& transport = parts_.transport();
  const int q = modes.nodes, c = modes.coarse_nodes, h = modes.high();
  const auto nodal = transport.terms(n);
  const Scalars by_excess = in_modes(modes, nodal.by_excess),
                constant = in_modes(modes, nodal.constant), by_up = in_modes(modes, nodal.by_up),
                by_down = in_modes(modes, nodal.by_down);
  Scalars block(square(q));
  std::vector<PetscBLASInt> exchanges(static_cast<std::size_t>(c));
  bool sound = true;
  for (int a = 0; a < hierarchy_.levels; ++a) {
    const auto [excess, up, down] = transport.speeds(n, a);
    for (std::size_t k = 0; k < block.size(); ++k) {
      block[k] = -(excess * by_excess[k] + constant[k] + up * by_up[k] + down * by_down[k]);
    }
    // Of the jumps, coarse values keep the shift alone.
    const PetscScalar jumps = -(1 - kShift) * (stack.up[a] + stack.down[a]);
    for (int k = 0; k < q; ++k) block[k + q * k] += stack.diagonal[a] - (k < c ? jumps : 0.0);
    PetscScalar* right = block.data() + static_cast<std::ptrdiff_t>(q) * c;
    PetscScalar* s = stack.pivots.data() + square(h) * a;
    for (std::ptrdiff_t k = 0; k < h; ++k) std::copy_n(right + c + q * k, h, s + h * k);
    const PetscBLASInt size = c, count = h, stride = q;
    PetscBLASInt info = 0;
    LAPACKgetrf_(&size, &size, block.data(), &stride, exchanges.data(), &info);
    sound = sound && info == 0;
    LAPACKgetrs_("N", &size, &count, block.data(), &stride, exchanges.data(), right, &stride,
                 &info);
    product("NN", h, h, c, -1, block.data() + c, q, right, q, 1, s, h);
  }
  return sound;
}

// Pivots from the outermost level inwards, inverted.
bool HighModes::eliminate(const Strip& strip, Stack& stack) {
  const int h = strip.modes->high();
  const std::size_t entries = square(h);
  Scalars work(entries);
  std::vector<PetscBLASInt> exchanges(static_cast<std::size_t>(h));
  Scalars passed;  // of both arms: the last pivot and its coupling inwards
  if (ranks_.has_outer()) {
    passed = receive<PetscScalar>(2 * (entries + 1), ranks_.outer, comm_);
    for (int k : {0, 1}) stack.from_outer[k] = of_arm(passed, k)[entries];
  }
  Scalars next(2 * (entries + 1), 0.0);
  bool sound = true;
  const auto pivot = [&](int level) { return stack.pivots.data() + entries * level; };
  const auto subtract = [&](int level, PetscScalar factor, const PetscScalar* outer) {
    for (std::size_t n = 0; n < entries; ++n) pivot(level)[n] -= factor * outer[n];
  };
  for (const Arm& arm : arms()) {
    const PetscScalar* outer = passed.empty() ? nullptr : of_arm(passed, arm.number);
    PetscScalar back = stack.from_outer[arm.number];
    for (int a = arm.begin; a != arm.end; a += arm.step) {
      if (outer != nullptr) subtract(a, outwards(stack, arm, a) * back, outer);
      sound = invert(pivot(a), h, h, exchanges, work) && sound;
      outer = pivot(a);
      back = inwards(stack, arm, a);
    }
    if (hierarchy_.centre && outer != nullptr) {
      subtract(hierarchy_.below, outwards(stack, arm, hierarchy_.below) * back, outer);
    }
    if (outer == nullptr) continue;
    PetscScalar* to = of_arm(next, arm.number);
    std::copy_n(outer, entries, to);
    to[entries] = back;
  }
  if (hierarchy_.centre) sound = invert(pivot(hierarchy_.below), h, h, exchanges, work) && sound;
  if (ranks_.has_inner()) send(next, ranks_.inner, comm_);
  return sound;
}

// What a transposed solve needs of the couplings of the rank before.
void HighModes::exchange_inner_couplings() {
  if (ranks_.has_inner()) {
    const auto all = receive<PetscScalar>(2 * stacks_.size(), ranks_.inner, comm_);
    for (std::size_t n = 0; n < stacks_.size(); ++n) {
      stacks_[n].from_inner = {all[2 * n], all[2 * n + 1]};
    }
  }
  if (!ranks_.has_outer()) return;
  Scalars all;
  for (const Stack& stack : stacks_) {
    for (const Arm& arm : arms()) {
      const int last = arm.begin == arm.end ? hierarchy_.below : arm.begin;
      all.push_back(outwards(stack, arm, last));
    }
  }
  send(all, ranks_.outer, comm_);
}

// All large memory.
void HighModes::reserve() {
  const auto levels = static_cast<std::size_t>(hierarchy_.levels);
  high_.resize(stacks_.size());
  take_together(comm_, [&] {
    for (std::size_t n = 0; n < stacks_.size(); ++n) {
      const ElementModes& modes = *hierarchy_.strips[n].modes;
      stacks_[n].up.resize(levels);
      stacks_[n].down.resize(levels);
      stacks_[n].diagonal.resize(levels);
      stacks_[n].pivots.resize(square(modes.high()) * levels);
      high_[n].resize(modes.high() * levels);
    }
  });
}

void HighModes::factor() {
  reserve();
  bool sound = true;  // on this rank; the others learn of it when all are through
  for (std::size_t n = 0; n < stacks_.size(); ++n) {
    const Strip& strip = hierarchy_.strips[n];
    if (strip.modes->high() == 0) continue;
    read_couplings(strip, stacks_[n]);
    sound = complement(n, stacks_[n]) && sound;
    sound = eliminate(strip, stacks_[n]) && sound;
  }
  exchange_inner_couplings();
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
  for (std::size_t n = 0; n < stacks_.size(); ++n) {
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
    pass_inwards(strip, stacks_[n], high_[n], transposed);
  }
  for (std::size_t n = 0; n < stacks_.size(); ++n) {
    const Strip& strip = hierarchy_.strips[n];
    const auto& m = *strip.modes;
    const int q = m.nodes, h = m.high();
    if (h == 0) continue;
    pass_outwards(strip, stacks_[n], high_[n], transposed);
    if (transposed) {
      product("TN", levels, q, h, 1, high_[n].data(), h, m.to_high.data(), h, 1, x + strip.first,
              levels);
    } else {
      product("TT", levels, q, h, 1, high_[n].data(), h, m.from_high.data(), q, 1, x + strip.first,
              levels);
    }
  }
}

// y_a <- z_a = P_a (y_a - c z_outer), P the inverse pivots.
void HighModes::pass_inwards(const Strip& strip, const Stack& stack, Scalars& y,
                             bool transposed) const {
  const int h = strip.modes->high();
  Scalars passed, next(2 * static_cast<std::size_t>(h), 0.0), sum(static_cast<std::size_t>(h));
  if (ranks_.has_outer()) {
    passed = receive<PetscScalar>(2 * static_cast<std::size_t>(h), ranks_.outer, comm_);
  }
  const auto at = [&](int level) { return y.data() + static_cast<std::ptrdiff_t>(h) * level; };
  const auto add = [&](int level, PetscScalar factor, const PetscScalar* outer) {
    for (int n = 0; n < h; ++n) at(level)[n] -= factor * outer[n];
  };
  const auto finish = [&](int level) {
    multiply(stack.pivots.data() + square(h) * level, h, transposed, at(level), sum.data());
    std::copy(sum.begin(), sum.end(), at(level));
  };
  for (const Arm& arm : arms()) {
    const PetscScalar* outer = passed.empty() ? nullptr : of_arm(passed, arm.number);
    PetscScalar back = stack.from_outer[arm.number];
    const auto subtract = [&](int level) {
      if (outer != nullptr) add(level, transposed ? back : outwards(stack, arm, level), outer);
    };
    for (int a = arm.begin; a != arm.end; a += arm.step) {
      subtract(a);
      finish(a);
      outer = at(a);
      back = inwards(stack, arm, a);
    }
    if (hierarchy_.centre) subtract(hierarchy_.below);
    if (outer != nullptr) std::copy_n(outer, h, of_arm(next, arm.number));
  }
  if (hierarchy_.centre) finish(hierarchy_.below);
  if (ranks_.has_inner()) send(next, ranks_.inner, comm_);
}

// z_a <- x_a = z_a - P_a c x_inner.
void HighModes::pass_outwards(const Strip& strip, const Stack& stack, Scalars& z,
                              bool transposed) const {
  const int h = strip.modes->high();
  Scalars passed, next, step(static_cast<std::size_t>(h));
  if (ranks_.has_inner()) {
    passed = receive<PetscScalar>(2 * static_cast<std::size_t>(h), ranks_.inner, comm_);
  }
  const auto at = [&](int level) { return z.data() + static_cast<std::ptrdiff_t>(h) * level; };
  for (const Arm& arm : arms()) {
    const PetscScalar* inner =
        hierarchy_.centre ? at(hierarchy_.below) : of_arm(passed, arm.number);
    PetscScalar here =
        hierarchy_.centre ? outwards(stack, arm, hierarchy_.below) : stack.from_inner[arm.number];
    for (int a = arm.end - arm.step; a != arm.begin - arm.step; a -= arm.step) {
      multiply(stack.pivots.data() + square(h) * a, h, transposed, inner, step.data());
      const PetscScalar factor = transposed ? here : inwards(stack, arm, a);
      for (int n = 0; n < h; ++n) at(a)[n] -= factor * step[n];
      inner = at(a);
      here = outwards(stack, arm, a);
    }
    next.insert(next.end(), inner, inner + h);
  }
  if (ranks_.has_outer()) send(next, ranks_.outer, comm_);
}

}  // namespace stickslip::petsc
