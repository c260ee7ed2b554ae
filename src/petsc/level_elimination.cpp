#include "stickslip/petsc/level_elimination.hpp"

#include <petscsys.h>
// After PETSc itself, whose types it uses.
#include <petscblaslapack.h>

#include <algorithm>
#include <array>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/memory.hpp"
#include "stickslip/petsc/session.hpp"
#include "stickslip/petsc/vectors.hpp"
#include "stickslip/support/errors.hpp"

namespace stickslip::petsc {
namespace {

using Scalars = std::vector<PetscScalar>;

// Least rows of a block of the triangles: below, products are too small to be fast.
constexpr int kLeastBlock = 12;

// y += a x or a^T x for a by columns.
void add_product(const PetscScalar* a, int rows, int columns, bool transposed, const PetscScalar* x,
                 PetscScalar* y) {
  const PetscBLASInt m = rows, n = columns, step = 1;
  const PetscScalar one = 1;
  BLASgemv_(transposed ? "T" : "N", &m, &n, &one, a, &m, x, &step, &one, y, &step);
}

/// Positions first ... last; none if first > last.
struct Extent {
  int first = std::numeric_limits<int>::max(), last = -1;
  void include(const Extent& other) {
    first = std::min(first, other.first);
    last = std::max(last, other.last);
  }
};

void send_extents(const std::vector<Extent>& extents, int to, MPI_Comm comm) {
  std::vector<int> ends;
  for (const auto& [first, last] : extents) ends.insert(ends.end(), {first, last});
  send(ends, to, comm);
}

std::vector<Extent> received_extents(std::size_t count, int from, MPI_Comm comm) {
  const auto ends = receive<int>(2 * count, from, comm);
  std::vector<Extent> extents;
  for (std::size_t n = 0; n < count; ++n) extents.push_back({ends[2 * n], ends[2 * n + 1]});
  return extents;
}

// The finest one that holds all that rows lead to.
Triangle triangle_of(const std::vector<Extent>& leads) {
  const int size = static_cast<int>(leads.size());
  std::vector<int> cuts{size};
  int lowest = size;  // of what the rows from p on lead to
  for (int p = size - 1; p > 0; --p) {
    lowest = std::min(lowest, leads[p].first);
    const bool large = p >= kLeastBlock && cuts.back() - p >= kLeastBlock;
    if (lowest >= p && large) cuts.push_back(p);
  }
  cuts.push_back(0);
  std::reverse(cuts.begin(), cuts.end());
  const int blocks = static_cast<int>(cuts.size()) - 1;
  std::vector<int> reach(static_cast<std::size_t>(blocks));
  for (int b = blocks - 1; b >= 0; --b) {
    int end = cuts[b + 1];
    for (int p = cuts[b]; p < cuts[b + 1]; ++p) end = std::max(end, leads[p].last + 1);
    for (int c = b + 1; c < blocks && cuts[c] < end; ++c) end = std::max(end, reach[c]);
    reach[b] = end;
  }
  return {cuts, reach};
}

}  // namespace

void LevelElimination::Coupling::add(int row, int column, PetscScalar value) {
  const bool extends = !runs.empty() && runs.back().row + runs.back().length == row &&
                       runs.back().column + runs.back().length == column;
  if (!extends) runs.push_back({row, column, 0, values.size()});
  ++runs.back().length;
  values.push_back(value);
}

void LevelElimination::Coupling::clear() {
  runs.clear();
  values.clear();
}

void LevelElimination::Coupling::subtract(const PetscScalar* x, PetscScalar* y,
                                          bool transposed) const {
  for (const Run& run : runs) {
    const int to = transposed ? run.column : run.row, from = transposed ? run.row : run.column;
    for (int n = 0; n < run.length; ++n) y[to + n] -= values[run.first + n] * x[from + n];
  }
}

void LevelElimination::Level::apply(const Scalars& x, Scalars& y, bool transposed) const {
  y.assign(x.size(), 0.0);
  const PetscScalar* panel = panels.get();
  for (int b = 0; b < triangle.blocks(); ++b) {
    const int rows = triangle.rows(b), columns = triangle.columns(b), begin = triangle.cuts[b];
    add_product(panel, rows, columns, transposed, x.data() + begin, y.data() + begin);
    panel += static_cast<std::ptrdiff_t>(rows) * columns;
  }
}

std::size_t LevelElimination::size_of(int block) const {
  if (block < 0) return inner_border_.size();
  return block < chain_.blocks() ? levels_[block].size : outer_border_.size();
}

LevelElimination::LevelElimination(Mat matrix, Chain chain)
    : chain_(std::move(chain)), comm_(PetscObjectComm(reinterpret_cast<PetscObject>(matrix))) {
  check(PetscObjectReference(reinterpret_cast<PetscObject>(matrix)));
  matrix_ = MatHandle(matrix);
  check(MatGetOwnershipRange(matrix_, &first_row_, nullptr));
  local_places_.resize(chain_.rows.size());
  levels_.resize(static_cast<std::size_t>(chain_.blocks()));
  for (int s = 0; s < chain_.blocks(); ++s) {
    levels_[s].size = chain_.size(s);
    for (int p = 0; p < chain_.size(s); ++p) {
      local_places_[chain_.rows[chain_.start[s] + p]] = {s, p};
    }
  }
  exchange_borders();
  find_triangles();
  std::array<double, 3> sums{};
  int largest = 0;
  for (const Level& level : levels_) {
    sums[0] += static_cast<double>(level.triangle.entries());
    sums[1] += DenseInverse::operations(level.triangle);
    largest = std::max(largest, level.size);
  }
  // With a dense block, its work space, and what returns from the block before.
  sums[2] = sizeof(PetscScalar) * (sums[0] + 3.0 * largest * largest);
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM,
                comm_);
  set_cost(sums[0], sums[2], sums[1]);
}

// Global rows of the blocks next to those of this rank, with their positions.
void LevelElimination::exchange_borders() {
  const int own = chain_.blocks();
  ranks_ = neighbours(comm_, own);
  if (own == 0) return;
  const auto rows_of = [&](int s) {
    std::vector<PetscInt> rows(chain_.rows.begin() + chain_.start[s],
                               chain_.rows.begin() + chain_.start[s + 1]);
    for (PetscInt& row : rows) row += first_row_;
    return rows;
  };
  const auto exchange = [&](const std::vector<PetscInt>& ours, int to, int from) {
    int count = static_cast<int>(ours.size()), others = 0;
    MPI_Sendrecv(&count, 1, MPI_INT, to, 0, &others, 1, MPI_INT, from, 0, comm_, MPI_STATUS_IGNORE);
    std::vector<PetscInt> rows(static_cast<std::size_t>(others));
    MPI_Sendrecv(ours.data(), count, MPIU_INT, to, 0, rows.data(), others, MPIU_INT, from, 0, comm_,
                 MPI_STATUS_IGNORE);
    std::vector<std::pair<PetscInt, int>> border;
    for (int p = 0; p < others; ++p) border.emplace_back(rows[p], p);
    std::sort(border.begin(), border.end());
    return border;
  };
  outer_border_ = exchange(rows_of(0), ranks_.inner, ranks_.outer);
  inner_border_ = exchange(rows_of(own - 1), ranks_.outer, ranks_.inner);
}

LevelElimination::Place LevelElimination::place_of(PetscInt column) const {
  const PetscInt local = column - first_row_;
  const bool here = local >= 0 && local < static_cast<PetscInt>(local_places_.size());
  if (here) return local_places_[local];
  const bool inner = local < 0;
  const auto& border = inner ? inner_border_ : outer_border_;
  const auto found = std::lower_bound(border.begin(), border.end(), std::pair{column, 0});
  if (found == border.end() || found->first != column) {
    throw std::logic_error("the blocks are no chain");
  }
  return {inner ? -1 : chain_.blocks(), found->second};
}

// A cut at c is possible where no row from c on leads to a position before c, neither within the
// block nor on a way through the blocks that are eliminated before it.
void LevelElimination::find_triangles() {
  if (levels_.empty()) return;
  // Positions in this block to which one in the block after returns.
  std::vector<Extent> returns;
  if (ranks_.has_outer()) returns = received_extents(size_of(chain_.blocks()), ranks_.outer, comm_);
  for (int s = chain_.blocks() - 1; s >= 0; --s) {
    Level& level = levels_[s];
    const auto size = static_cast<std::size_t>(level.size);
    std::vector<Extent> leads(size), leaves(size);  // within the block; to the block before
    for (int p = 0; p < level.size; ++p) {
      leads[p].include({p, p});
      const RowView row(matrix_, first_row_ + chain_.rows[chain_.start[s] + p]);
      row.for_each([&](PetscInt column, PetscScalar) {
        const Place to = place_of(column);
        if (to.block == s) leads[p].include({to.position, to.position});
        if (to.block == s + 1) leads[p].include(returns[to.position]);
        if (to.block == s - 1) leaves[p].include({to.position, to.position});
      });
    }
    level.triangle = triangle_of(leads);
    const auto& [cuts, reach] = level.triangle;
    returns.assign(size, {});
    for (int b = 0; b < level.triangle.blocks(); ++b) {
      // All of a block of rows leads on to all of its columns.
      Extent all;
      for (int p = cuts[b]; p < reach[b]; ++p) all.include(leaves[p]);
      std::fill(returns.begin() + cuts[b], returns.begin() + cuts[b + 1], all);
    }
  }
  if (ranks_.has_inner()) send_extents(returns, ranks_.inner, comm_);
}

// The diagonal block into `dense`, the rest of its rows into the couplings.
void LevelElimination::read_block(int s, Scalars& dense) {
  Level& level = levels_[s];
  const std::ptrdiff_t size = level.size;
  dense.assign(static_cast<std::size_t>(size * size), 0.0);
  level.outwards.clear();
  level.inwards.clear();
  for (int p = 0; p < level.size; ++p) {
    const RowView row(matrix_, first_row_ + chain_.rows[chain_.start[s] + p]);
    row.for_each([&](PetscInt column, PetscScalar value) {
      const Place to = place_of(column);
      if (to.block == s) {
        dense[p + size * to.position] = value;
      } else if (to.block == s + 1) {
        level.outwards.add(p, to.position, value);
      } else if (to.block == s - 1) {
        level.inwards.add(p, to.position, value);
      } else {
        throw std::logic_error("the blocks are no chain");
      }
    });
  }
}

// dense -= D W.
void LevelElimination::subtract_return(const Level& level, const Scalars& back, Scalars& dense) {
  const std::ptrdiff_t size = level.size, outer = static_cast<std::ptrdiff_t>(back.size()) / size;
  for (std::ptrdiff_t c = 0; c < size; ++c) {
    level.outwards.subtract(back.data() + outer * c, dense.data() + size * c);
  }
}

// W = S^-1 E, by columns.
void LevelElimination::multiply_inwards(const Level& level, const Scalars& inverse,
                                        std::size_t columns, Scalars& product) {
  const std::ptrdiff_t size = level.size;
  product.assign(size * columns, 0.0);
  // Rows of each column of the inverse.
  std::vector<Extent> rows(static_cast<std::size_t>(size));
  const auto& [cuts, reach] = level.triangle;
  for (int b = 0; b < level.triangle.blocks(); ++b) {
    for (int c = cuts[b]; c < reach[b]; ++c) rows[c].include({cuts[b], cuts[b + 1] - 1});
  }
  for (const Run& run : level.inwards.runs) {
    for (int n = 0; n < run.length; ++n) {
      const PetscScalar factor = level.inwards.values[run.first + n];
      const PetscScalar* from = inverse.data() + size * (run.row + n);
      PetscScalar* to = product.data() + size * (run.column + n);
      const auto [first, last] = rows[run.row + n];
      for (int r = first; r <= last; ++r) to[r] += factor * from[r];
    }
  }
}

void LevelElimination::store(Level& level, const Scalars& inverse) {
  const std::ptrdiff_t size = level.size;
  const auto& [cuts, reach] = level.triangle;
  PetscScalar* to = level.panels.get();
  for (int b = 0; b < level.triangle.blocks(); ++b) {
    for (int c = cuts[b]; c < reach[b]; ++c) {
      const PetscScalar* column = inverse.data() + size * c;
      to = std::copy(column + cuts[b], column + cuts[b + 1], to);
    }
  }
}

// All large memory.
void LevelElimination::reserve(Scalars& dense, Scalars& back) {
  std::size_t largest = 0;
  for (int s = -1; s <= chain_.blocks(); ++s) largest = std::max(largest, size_of(s));
  take_together(comm_, [&] {
    dense.reserve(largest * largest);
    back.reserve(largest * largest);
    invert_.reserve(static_cast<int>(largest));
    for (Level& level : levels_) {
      if (level.panels) continue;
      level.panels = std::make_unique_for_overwrite<PetscScalar[]>(level.triangle.entries());
    }
  });
}

void LevelElimination::factor() {
  factored_ = false;
  Scalars dense, back;  // back: S^-1 E of the block after
  reserve(dense, back);
  const int last = chain_.blocks() - 1;
  std::string failure;  // on this rank; the others learn of it when all are through
  if (ranks_.has_outer()) {
    back = receive<PetscScalar>(size_of(last + 1) * size_of(last), ranks_.outer, comm_);
  }
  for (int s = last; s >= 0; --s) {
    Level& level = levels_[s];
    read_block(s, dense);
    if (!back.empty()) subtract_return(level, back, dense);
    try {
      invert_(dense.data(), level.triangle);
    } catch (const NotReached& singular) {
      failure = singular.what();
    }
    store(level, dense);
    multiply_inwards(level, dense, size_of(s - 1), back);
  }
  if (ranks_.has_inner()) send(back, ranks_.inner, comm_);
  require_everywhere(comm_, failure);
  factored_ = true;
}

void LevelElimination::apply(Vec b, Vec x, bool transposed) const {
  if (levels_.empty()) return;
  auto z = pass_inwards(b, transposed);
  pass_outwards(z, x, transposed);
}

// z_s = S_s^-1 (b_s - D_s z_{s+1}), or z_s = S_s^-T (b_s - E_{s+1}^T z_{s+1}), whose last term is
// made where E_{s+1} is.
std::vector<Scalars> LevelElimination::pass_inwards(Vec b, bool transposed) const {
  const int last = chain_.blocks() - 1;
  std::vector<Scalars> z(levels_.size());
  const ReadView right(b);
  Scalars y, passed;
  const std::size_t border = size_of(transposed ? last : last + 1);
  if (ranks_.has_outer()) passed = receive<PetscScalar>(border, ranks_.outer, comm_);
  for (int s = last; s >= 0; --s) {
    const Level& level = levels_[s];
    y.resize(static_cast<std::size_t>(level.size));
    for (int p = 0; p < level.size; ++p) y[p] = right[chain_.rows[chain_.start[s] + p]];
    if (!passed.empty() && transposed) {
      for (int p = 0; p < level.size; ++p) y[p] += passed[p];
    } else if (!passed.empty()) {
      level.outwards.subtract(passed.data(), y.data());
    }
    level.apply(y, z[s], transposed);
    if (transposed) {
      passed.assign(size_of(s - 1), 0.0);
      level.inwards.subtract(z[s].data(), passed.data(), transposed);
    } else {
      passed = z[s];
    }
  }
  if (ranks_.has_inner()) send(passed, ranks_.inner, comm_);
  return z;
}

// x_s = z_s - S_s^-1 E_s x_{s-1}, or x_s = z_s - S_s^-T D_{s-1}^T x_{s-1}.
void LevelElimination::pass_outwards(std::vector<Scalars>& z, Vec x, bool transposed) const {
  const int last = chain_.blocks() - 1;
  WriteView left(x);
  Scalars y, step, passed;
  const std::size_t border = size_of(transposed ? 0 : -1);
  if (ranks_.has_inner()) passed = receive<PetscScalar>(border, ranks_.inner, comm_);
  for (int s = 0; s <= last; ++s) {
    const Level& level = levels_[s];
    if (!passed.empty()) {
      if (transposed) {
        y = std::move(passed);
      } else {
        y.assign(static_cast<std::size_t>(level.size), 0.0);
        level.inwards.subtract(passed.data(), y.data());
      }
      level.apply(y, step, transposed);
      for (int p = 0; p < level.size; ++p) z[s][p] += step[p];
    }
    for (int p = 0; p < level.size; ++p) left[chain_.rows[chain_.start[s] + p]] = z[s][p];
    if (transposed) {
      passed.assign(size_of(s + 1), 0.0);
      level.outwards.subtract(z[s].data(), passed.data(), transposed);
    } else {
      passed = z[s];
    }
  }
  if (ranks_.has_outer()) send(passed, ranks_.outer, comm_);
}

}  // namespace stickslip::petsc
