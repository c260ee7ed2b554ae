#include "stickslip/operators/element_system.hpp"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>

namespace stickslip::operators {
namespace {

using petsc::DenseMatrix;
using petsc::Scalars;

// (c x 1)^T X, c the coefficients of the noise nodes of X.
DenseMatrix contracted(std::span<const double> c, int nodes, const DenseMatrix& x) {
  DenseMatrix y(nodes, x.columns());
  for (int column = 0; column < x.columns(); ++column) {
    for (std::size_t l = 0; l < c.size(); ++l) {
      const PetscScalar* from = x.column(column) + l * static_cast<std::size_t>(nodes);
      for (int m = 0; m < nodes; ++m) y(m, column) += c[l] * from[m];
    }
  }
  return y;
}

// Copies a block beside what is there.
void place(const DenseMatrix& block, int row, int column, DenseMatrix& to) {
  for (int c = 0; c < block.columns(); ++c) {
    std::copy_n(block.column(c), block.rows(), to.column(column + c) + row);
  }
}

DenseMatrix part(const DenseMatrix& a, const std::vector<int>& rows,
                 const std::vector<int>& columns) {
  DenseMatrix result(static_cast<int>(rows.size()), static_cast<int>(columns.size()));
  for (int c = 0; c < result.columns(); ++c) {
    for (int r = 0; r < result.rows(); ++r) result(r, c) = a(rows[r], columns[c]);
  }
  return result;
}

}  // namespace

ElementSystem::ElementSystem(const noise::Nodes& noise, const velocity::HpAxis& axis, int element,
                             std::span<const double> excess, PetscScalar lambda)
    : count_(noise.count()) {
  const auto& [reference, first, length] = axis.element(element);
  nodes_ = reference->size;
  first_ = first;
  at_inner_ = reference->at_left;
  at_outer_ = reference->at_right;
  const auto rising = [&](double drag) {
    return static_cast<int>(std::partition_point(excess.begin(), excess.end(),
                                                 [drag](double e) { return e + drag <= 0; }) -
                            excess.begin());
  };
  rising_inner_ = rising(axis.drag_at_end(element));
  rising_outer_ = rising(axis.drag_at_end(element + 1));
  const Rows rows = rows_of(axis, excess);
  int begin = 0;
  for (const auto& group : noise.groups()) {
    groups_.push_back({&group, begin, group.count, {}, {}, {}});
    begin += group.count;
  }
  eliminate(noise, rows, lambda);
}

ElementSystem::Rows ElementSystem::rows_of(const velocity::HpAxis& axis,
                                           std::span<const double> excess) {
  const auto q = static_cast<std::size_t>(nodes_), all = excess.size() * q;
  Rows rows(all * q, 0.0);
  from_inner_.assign(all, 0.0);
  from_outer_.assign(all, 0.0);
  velocity::TransportRow row;
  for (std::size_t place = 0; place < all; ++place) {
    axis.transport(excess[place / q], first_ + static_cast<int>(place % q), row);
    double& inner = from_inner_[place] = row.inflow;
    double& outer = from_outer_[place] = row.outflow;
    for (const auto& [node, value] : row.entries) {
      if (node < first_) {
        inner += value;
      } else if (node >= first_ + nodes_) {
        outer += value;
      } else {
        rows[place * q + static_cast<std::size_t>(node - first_)] = value;
      }
    }
  }
  return rows;
}

// The rows and columns of a group.
DenseMatrix ElementSystem::block(const noise::Nodes& noise, const Rows& rows, const Group& group,
                                 PetscScalar lambda) const {
  DenseMatrix a(group.count * nodes_, group.count * nodes_);
  for (int l = 0; l < group.count; ++l) {
    const int node = group.noise->begin + l;
    double jumps = 0;
    for (const auto& [to, rate] : noise.jumps(node)) {
      jumps += rate;
      const int column = to - group.noise->begin;
      if (column < 0 || column >= group.count) continue;
      for (int m = 0; m < nodes_; ++m) a(l * nodes_ + m, column * nodes_ + m) -= rate;
    }
    for (int m = 0; m < nodes_; ++m) {
      const int row = l * nodes_ + m;
      const std::size_t place = static_cast<std::size_t>(group.begin + l) * nodes_ + m;
      double sum = from_inner_[place] + from_outer_[place];
      for (int n = 0; n < nodes_; ++n) {
        const double rate = rows[place * nodes_ + n];
        sum += rate;
        a(row, l * nodes_ + n) -= rate;
      }
      a(row, row) += lambda + sum + jumps;
    }
  }
  return a;
}

// rates x 1: the same at each node of the element.
DenseMatrix ElementSystem::spread(std::span<const double> rates) const {
  DenseMatrix columns(static_cast<int>(rates.size()) * nodes_, nodes_);
  for (std::size_t l = 0; l < rates.size(); ++l) {
    for (int m = 0; m < nodes_; ++m) columns(static_cast<int>(l) * nodes_ + m, m) = rates[l];
  }
  return columns;
}

void ElementSystem::eliminate(const noise::Nodes& noise, const Rows& rows, PetscScalar lambda) {
  DenseMatrix returns;  // (d x 1)^T D^-1 (a x 1) of the group before
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    Group& group = groups_[g];
    DenseMatrix a = block(noise, rows, group, lambda);
    const auto& to_below = group.noise->to_below;
    const auto first = group.noise->at_first();
    for (int l = 0; g > 0 && l < group.count; ++l) {
      for (int k = 0; k < group.count; ++k) {
        const double share = to_below[l] * first[k];
        for (int n = 0; n < nodes_; ++n) {
          for (int m = 0; m < nodes_; ++m) {
            a(l * nodes_ + m, k * nodes_ + n) -= share * returns(m, n);
          }
        }
      }
    }
    group.factors = petsc::DenseFactors(std::move(a));
    if (g > 0) {
      group.to_before = spread(to_below);
      group.factors.solve(group.to_before);
    }
    if (g + 1 < groups_.size()) {
      group.to_next = spread(group.noise->to_above);
      group.factors.solve(group.to_next);
      returns = contracted(group.noise->at_last(), nodes_, group.to_next);
    }
  }
}

/// The response to unit values beyond the ends, all at once: forward over the groups, and back.
/// Columns are inputs and rows outputs, in the order of noise nodes, so that those of the groups up
/// to one come first.
class ElementSystem::Sweep {
 public:
  explicit Sweep(const ElementSystem& system) : s_(system) {
    for (int l = 0; l < s_.count_; ++l) {
      if (l < s_.rising_inner_) inner_in_.push_back(inputs_++);
      if (l >= s_.rising_outer_) outer_in_.push_back(inputs_++);
      if (l >= s_.rising_inner_) inner_out_.push_back(outputs_++);
      if (l < s_.rising_outer_) outer_out_.push_back(outputs_++);
    }
    result_ = DenseMatrix(outputs_, inputs_);
  }

  [[nodiscard]] Response run() {
    forward();
    back();
    return {part(result_, inner_out_, inner_in_), part(result_, inner_out_, outer_in_),
            part(result_, outer_out_, inner_in_), part(result_, outer_out_, outer_in_)};
  }

 private:
  // One end of the element on one noise node, which takes a value there or gives one.
  struct Port {
    int noise;
    bool inner;
  };
  [[nodiscard]] std::vector<Port> inputs_of(const Group& group) const {
    std::vector<Port> ports;
    for (int l = group.begin; l < group.begin + group.count; ++l) {
      if (l < s_.rising_inner_) ports.push_back({l, true});
      if (l >= s_.rising_outer_) ports.push_back({l, false});
    }
    return ports;
  }
  [[nodiscard]] std::vector<Port> outputs_of(const Group& group) const {
    std::vector<Port> ports;
    for (int l = group.begin; l < group.begin + group.count; ++l) {
      if (l >= s_.rising_inner_) ports.push_back({l, true});
      if (l < s_.rising_outer_) ports.push_back({l, false});
    }
    return ports;
  }

  // What the inputs of a group make of it alone.
  [[nodiscard]] DenseMatrix own(const Group& group) const {
    const auto ports = inputs_of(group);
    DenseMatrix columns(group.count * s_.nodes_, static_cast<int>(ports.size()));
    for (int c = 0; c < columns.columns(); ++c) {
      const auto& rates = ports[c].inner ? s_.from_inner_ : s_.from_outer_;
      const auto from = rates.begin() + static_cast<std::ptrdiff_t>(ports[c].noise) * s_.nodes_;
      std::copy_n(from, s_.nodes_, &columns((ports[c].noise - group.begin) * s_.nodes_, c));
    }
    group.factors.solve(columns);
    return columns;
  }

  // Rows of the outputs of a group.
  [[nodiscard]] DenseMatrix outputs(const Group& group, const DenseMatrix& x) const {
    const auto ports = outputs_of(group);
    DenseMatrix y(static_cast<int>(ports.size()), x.columns());
    for (int c = 0; c < x.columns(); ++c) {
      for (int r = 0; r < y.rows(); ++r) {
        const auto& trace = ports[r].inner ? s_.at_inner_ : s_.at_outer_;
        const int from = (ports[r].noise - group.begin) * s_.nodes_;
        for (int m = 0; m < s_.nodes_; ++m) y(r, c) += trace[m] * x(from + m, c);
      }
    }
    return y;
  }

  void forward() {
    DenseMatrix last;  // values on the last level of the group before
    int column = 0, row = 0;
    for (const Group& group : s_.groups_) {
      const DenseMatrix alone = own(group);
      const int inputs = alone.columns();
      const auto extended = [&](const DenseMatrix& through, const DenseMatrix& here) {
        DenseMatrix all(here.rows(), column + inputs);
        if (column > 0) add_product(1, through, last, column, all);
        place(here, 0, column, all);
        return all;
      };
      const bool begins = group.begin == 0;
      const auto map = [&](const auto& functional) {
        const DenseMatrix through = begins ? DenseMatrix() : functional(group.to_before);
        return extended(through, functional(alone));
      };
      const auto on = [&](std::span<const double> c) {
        return map([&](const DenseMatrix& x) { return contracted(c, s_.nodes_, x); });
      };
      const DenseMatrix given = map([&](const DenseMatrix& x) { return outputs(group, x); });
      place(given, row, 0, result_);
      DenseMatrix next = on(group.noise->at_last());
      first_.push_back(group.count == 1 ? next : on(group.noise->at_first()));
      last = std::move(next);
      column += inputs;
      row += given.rows();
      rows_.push_back(row);
    }
  }

  void back() {
    DenseMatrix next(s_.nodes_, inputs_);  // values on the first level of the group above
    for (std::size_t g = s_.groups_.size(); g-- > 0;) {
      const Group& group = s_.groups_[g];
      DenseMatrix here(s_.nodes_, inputs_);
      place(first_[g], 0, 0, here);
      if (g + 1 < s_.groups_.size()) {
        const DenseMatrix given = outputs(group, group.to_next) * next;
        const int row = rows_[g] - given.rows();
        for (int c = 0; c < inputs_; ++c) {
          for (int r = 0; r < given.rows(); ++r) result_(row + r, c) += given(r, c);
        }
        const auto first = group.noise->at_first();
        add_product(1, contracted(first, s_.nodes_, group.to_next), next, inputs_, here);
      }
      next = std::move(here);
    }
  }

  const ElementSystem& s_;
  int inputs_ = 0, outputs_ = 0;
  std::vector<int> inner_in_, outer_in_, inner_out_, outer_out_;
  DenseMatrix result_;
  std::vector<DenseMatrix> first_;  // by group: values on its first level, before those above count
  std::vector<int> rows_;           // by group: outputs up to it
};

ElementSystem::Response ElementSystem::response() const { return Sweep(*this).run(); }

void ElementSystem::solve(Scalars& x, bool transposed) const {
  transposed ? solve_transposed(x) : solve_plain(x);
}

void ElementSystem::solve_plain(Scalars& x) const {
  const auto q = static_cast<std::size_t>(nodes_);
  Scalars at_last(q), at_first(q);
  const auto contract = [&](const Group& group, std::span<const double> c, Scalars& y) {
    std::fill(y.begin(), y.end(), 0.0);
    for (std::size_t l = 0; l < c.size(); ++l) {
      for (std::size_t m = 0; m < q; ++m) y[m] += c[l] * x[(group.begin + l) * q + m];
    }
  };
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    const Group& group = groups_[g];
    for (int l = 0; g > 0 && l < group.count; ++l) {
      const double rate = group.noise->to_below[l];
      for (std::size_t m = 0; m < q; ++m) x[(group.begin + l) * q + m] += rate * at_last[m];
    }
    group.factors.solve(&x[group.begin * q], false);
    contract(group, group.noise->at_last(), at_last);
  }
  for (std::size_t g = groups_.size() - 1; g-- > 0;) {
    const Group& above = groups_[g + 1];
    contract(above, above.noise->at_first(), at_first);
    const Group& group = groups_[g];
    for (std::size_t n = 0; n < q; ++n) {
      const PetscScalar* column = group.to_next.column(static_cast<int>(n));
      for (int r = 0; r < group.to_next.rows(); ++r)
        x[group.begin * q + r] += column[r] * at_first[n];
    }
  }
}

void ElementSystem::solve_transposed(Scalars& x) const {
  const auto q = static_cast<std::size_t>(nodes_);
  Scalars sent(q);
  const auto add = [&](const Group& group, std::span<const double> c) {
    for (std::size_t l = 0; l < c.size(); ++l) {
      for (std::size_t m = 0; m < q; ++m) x[(group.begin + l) * q + m] += c[l] * sent[m];
    }
  };
  for (std::size_t g = 1; g < groups_.size(); ++g) {
    const Group& below = groups_[g - 1];
    for (std::size_t n = 0; n < q; ++n) {
      const PetscScalar* column = below.to_next.column(static_cast<int>(n));
      sent[n] = 0;
      for (int r = 0; r < below.to_next.rows(); ++r) sent[n] += column[r] * x[below.begin * q + r];
    }
    add(groups_[g], groups_[g].noise->at_first());
  }
  for (std::size_t g = groups_.size(); g-- > 0;) {
    const Group& group = groups_[g];
    if (g + 1 < groups_.size()) add(group, group.noise->at_last());
    group.factors.solve(&x[group.begin * q], true);
    std::fill(sent.begin(), sent.end(), 0.0);
    for (int l = 0; l < group.count; ++l) {
      const double rate = group.noise->to_below[l];
      for (std::size_t m = 0; m < q; ++m) sent[m] += rate * x[(group.begin + l) * q + m];
    }
  }
}

void ElementSystem::lift(const Scalars& inner, const Scalars& outer, Scalars& f) const {
  const auto q = static_cast<std::size_t>(nodes_);
  for (std::size_t place = 0; place < f.size(); ++place) {
    f[place] += from_inner_[place] * inner[place / q] + from_outer_[place] * outer[place / q];
  }
}

void ElementSystem::lift_transposed(const Scalars& x, Scalars& inner, Scalars& outer) const {
  const auto q = static_cast<std::size_t>(nodes_);
  std::fill(inner.begin(), inner.end(), 0.0);
  std::fill(outer.begin(), outer.end(), 0.0);
  for (std::size_t place = 0; place < x.size(); ++place) {
    inner[place / q] += from_inner_[place] * x[place];
    outer[place / q] += from_outer_[place] * x[place];
  }
}

void ElementSystem::trace(const Scalars& u, Scalars& inner, Scalars& outer) const {
  const auto q = static_cast<std::size_t>(nodes_);
  std::fill(inner.begin(), inner.end(), 0.0);
  std::fill(outer.begin(), outer.end(), 0.0);
  for (std::size_t place = 0; place < u.size(); ++place) {
    inner[place / q] += at_inner_[place % q] * u[place];
    outer[place / q] += at_outer_[place % q] * u[place];
  }
}

void ElementSystem::trace_transposed(const Scalars& inner, const Scalars& outer, Scalars& b) const {
  const auto q = static_cast<std::size_t>(nodes_);
  for (std::size_t place = 0; place < b.size(); ++place) {
    b[place] += at_inner_[place % q] * inner[place / q] + at_outer_[place % q] * outer[place / q];
  }
}

double ElementSystem::entries() const {
  return std::accumulate(groups_.begin(), groups_.end(), 0.0, [](double sum, const Group& group) {
    const double n = group.factors.size();
    return sum + n * n + 2.0 * group.to_next.rows() * group.to_next.columns();
  });
}

}  // namespace stickslip::operators
