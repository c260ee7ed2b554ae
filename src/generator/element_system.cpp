#include "stickslip/generator/element_system.hpp"

#include <algorithm>
#include <complex>
#include <utility>

namespace stickslip::generator {
namespace {

using linalg::add_product;

template <class... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
template <class... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

}  // namespace

template <class Scalar>
void LinearSteps<Scalar>::Tridiagonal::factor() {
  for (std::size_t n = 1; n < diagonal.size(); ++n) {
    below[n] /= diagonal[n - 1];
    diagonal[n] -= below[n] * above[n - 1];
  }
}

template <class Scalar>
void LinearSteps<Scalar>::Tridiagonal::solve(Lists x, bool transposed) const {
  for (int c = 0; c < x.count; ++c) solve_one(x.column(c), transposed);
}

template <class Scalar>
void LinearSteps<Scalar>::Tridiagonal::solve_one(Scalar* x, bool transposed) const {
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

template <class Scalar>
void LinearSteps<Scalar>::add(Matrix a, std::size_t from, std::size_t to) {
  steps_.emplace_back(Product{std::move(a), from, to});
}

template <class Scalar>
void LinearSteps<Scalar>::add(std::vector<Coupling> couplings) {
  steps_.emplace_back(std::move(couplings));
}

template <class Scalar>
void LinearSteps<Scalar>::contract(std::span<const double> c, int block, std::size_t from,
                                   std::size_t to) {
  steps_.emplace_back(Contraction{{c.begin(), c.end()}, block, to, from, false});
}

template <class Scalar>
void LinearSteps<Scalar>::spread(std::span<const double> c, int block, std::size_t from,
                                 std::size_t to) {
  steps_.emplace_back(Contraction{{c.begin(), c.end()}, block, from, to, true});
}

template <class Scalar>
void LinearSteps<Scalar>::Contraction::run(Lists w, bool transposed) const {
  const bool outwards = spreads != transposed;
  for (std::size_t l = 0; l < c.size(); ++l) {
    const double weight = c[l];
    if (weight == 0) continue;  // of levels that are nodes, all but one
    const std::size_t row = many + l * static_cast<std::size_t>(block);
    for (int n = 0; n < w.count; ++n) {
      const Scalar* from = w.column(n) + (outwards ? one : row);
      Scalar* to = w.column(n) + (outwards ? row : one);
      for (int m = 0; m < block; ++m) to[m] += weight * from[m];
    }
  }
}

template <class Scalar>
void LinearSteps<Scalar>::solve(Factors a, std::size_t at) {
  steps_.emplace_back(Solve<Factors>{std::move(a), at});
}

template <class Scalar>
void LinearSteps<Scalar>::solve(Tridiagonal a, std::size_t at) {
  steps_.emplace_back(Solve<Tridiagonal>{std::move(a), at});
}

template <class Scalar>
void LinearSteps<Scalar>::add(const std::vector<Coupling>& couplings, Scalar* w, bool transposed) {
  if (!transposed) {
    for (const auto& [from, to, weight] : couplings) w[to] += weight * w[from];
    return;
  }
  for (auto c = couplings.rbegin(); c != couplings.rend(); ++c) w[c->from] += c->weight * w[c->to];
}

template <class Scalar>
void LinearSteps<Scalar>::run(Lists w, bool transposed) const {
  const Overloaded carry_out{
      [&](const Product& p) {
        const std::size_t from = transposed ? p.to : p.from, to = transposed ? p.from : p.to;
        linalg::add_product(p.a, w.from(from), w.from(to), transposed);
      },
      [&](const std::vector<Coupling>& couplings) {
        for (int n = 0; n < w.count; ++n) add(couplings, w.column(n), transposed);
      },
      [&](const Contraction& contraction) { contraction.run(w, transposed); },
      [&](const auto& solve) { solve.a.solve(w.from(solve.at), transposed); }};
  if (transposed) {
    for (auto step = steps_.rbegin(); step != steps_.rend(); ++step) std::visit(carry_out, *step);
  } else {
    for (const Step& step : steps_) std::visit(carry_out, step);
  }
}

template <class Scalar>
double LinearSteps<Scalar>::entries() const {
  double count = 0;
  const Overloaded add{
      [&](const Product& p) { count += 1.0 * p.a.rows() * p.a.columns(); },
      [&](const std::vector<Coupling>& couplings) {
        count += static_cast<double>(2 * couplings.size());
      },
      [&](const Contraction& contraction) { count += static_cast<double>(contraction.c.size()); },
      [&](const Solve<Factors>& s) { count += 1.0 * s.a.size() * s.a.size(); },
      [&](const Solve<Tridiagonal>& s) { count += static_cast<double>(3 * s.a.diagonal.size()); }};
  for (const Step& step : steps_) std::visit(add, step);
  return count;
}

template class LinearSteps<double>;
template class LinearSteps<std::complex<double>>;

namespace {

template <class Scalar>
using DenseMatrix = linalg::Matrix<Scalar>;

// (c x 1) X, c by rows over the noise nodes of X.
template <class Scalar>
DenseMatrix<Scalar> contracted(std::span<const double> c, int nodes, const DenseMatrix<Scalar>& x) {
  const int count = x.rows() / nodes, rows = static_cast<int>(c.size()) / count;
  DenseMatrix<Scalar> y(rows * nodes, x.columns());
  for (int r = 0; r < rows; ++r) {
    for (int l = 0; l < count; ++l) {
      const double weight = c[r * count + l];
      if (weight == 0) continue;
      for (int column = 0; column < x.columns(); ++column) {
        const Scalar* from = x.column(column) + l * nodes;
        Scalar* to = y.column(column) + r * nodes;
        for (int m = 0; m < nodes; ++m) to[m] += weight * from[m];
      }
    }
  }
  return y;
}

// rates x 1 + per_distance x speeds, both by rows, `count` of them; at each of the nodes.
template <class Scalar>
DenseMatrix<Scalar> at_each(std::span<const double> rates, std::span<const double> per_distance,
                            std::span<const double> speeds, int count) {
  const int columns = static_cast<int>(rates.size()) / count,
            nodes = static_cast<int>(speeds.size());
  DenseMatrix<Scalar> a(count * nodes, columns * nodes);
  for (int l = 0; l < count; ++l) {
    for (int c = 0; c < columns; ++c) {
      const std::size_t place = static_cast<std::size_t>(l) * columns + c;
      const double carried = per_distance.empty() ? 0 : per_distance[place];
      for (int m = 0; m < nodes; ++m) {
        a(l * nodes + m, c * nodes + m) = rates[place] + carried * speeds[m];
      }
    }
  }
  return a;
}

// Copies a block beside what is there.
template <class Scalar>
void place(const DenseMatrix<Scalar>& block, int row, int column, DenseMatrix<Scalar>& to) {
  for (int c = 0; c < block.columns(); ++c) {
    std::copy_n(block.column(c), block.rows(), to.column(column + c) + row);
  }
}

template <class Scalar>
DenseMatrix<Scalar> part(const DenseMatrix<Scalar>& a, const std::vector<int>& rows,
                         const std::vector<int>& columns) {
  DenseMatrix<Scalar> result(static_cast<int>(rows.size()), static_cast<int>(columns.size()));
  for (int c = 0; c < result.columns(); ++c) {
    for (int r = 0; r < result.rows(); ++r) result(r, c) = a(rows[r], columns[c]);
  }
  return result;
}

}  // namespace

int first_rising(std::span<const double> speeds, double drag) {
  const auto first = std::partition_point(speeds.begin(), speeds.end(),
                                          [drag](double speed) { return speed + drag <= 0; });
  return static_cast<int>(first - speeds.begin());
}

/// The block-tridiagonal LU over groups, upwards, and what unit values beyond the ends make of the
/// element: forward over the groups, and back, all of them at once. Columns of responses are inputs
/// and rows outputs, in the order of noise nodes, so that those of the groups up to one come first.
template <class Scalar>
class ElementSystem<Scalar>::Elimination {
 public:
  /// `rates` of the own nodes among each other: by noise node, q x q by rows, zero diagonals. The
  /// first `rising_inner`, `rising_outer` nodes fall at the ends. `speeds`, `lambda`: by velocity
  /// node.
  Elimination(const ElementSystem& system, const Nodes& noise, std::vector<double> rates,
              std::span<const double> speeds, Scalars lambda, int rising_inner, int rising_outer)
      : s_(system),
        q_(system.nodes_),
        noise_(noise),
        rates_(std::move(rates)),
        speeds_(speeds),
        lambda_(std::move(lambda)) {
    for (int l = 0; l < s_.count_; ++l) {
      (l < rising_inner ? inner_in_ : inner_out_)
          .push_back(l < rising_inner ? inputs_++ : outputs_++);
      (l < rising_outer ? outer_out_ : outer_in_)
          .push_back(l < rising_outer ? outputs_++ : inputs_++);
      ports_.push_back({l < rising_inner, l >= rising_outer});
    }
    int begin = 0;
    length_ = static_cast<std::size_t>(s_.size());
    for (const auto& group : noise.groups()) {
      groups_.push_back({&group, begin, group.count, {}, {}, {}});
      begin += group.count;
      Group& added = groups_.back();
      added.first = length_;
      added.last = length_ + group.at_first().size() / group.count * q_;
      length_ = added.last + group.at_last().size() / group.count * q_;
    }
    eliminate();
  }

  [[nodiscard]] Response response() {
    result_ = Matrix(outputs_, inputs_);
    forward();
    back();
    return {part(result_, inner_out_, inner_in_), part(result_, inner_out_, outer_in_),
            part(result_, outer_out_, inner_in_), part(result_, outer_out_, outer_in_)};
  }

  /// The LU as steps; lists end with places for values on the levels of each group to which others
  /// jump. The factors are gone then.
  [[nodiscard]] LinearSteps<Scalar> steps() {
    LinearSteps<Scalar> steps;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      Group& group = groups_[g];
      if (g > 0) {
        const Group& below = groups_[g - 1];
        contract(below, below.noise->at_last(), below.last, steps);
        const int rank = rank_of(below.noise->at_last(), below);
        const auto& carried = group.noise->carried_below;
        if (!carried.empty()) {
          steps.add(at_each<Scalar>(group.noise->to_below, carried, speeds_, group.count),
                    below.last, at(group));
        }
        for (int r = 0; carried.empty() && r < rank; ++r) {
          std::vector<double> rates;
          for (int l = 0; l < group.count; ++l) {
            rates.push_back(group.noise->to_below[static_cast<std::size_t>(l) * rank + r]);
          }
          steps.spread(rates, q_, below.last + static_cast<std::size_t>(r) * q_, at(group));
        }
      }
      steps.solve(std::move(group.factors), at(group));
    }
    for (std::size_t g = groups_.size() - 1; g-- > 0;) {
      const Group& above = groups_[g + 1];
      contract(above, above.noise->at_first(), above.first, steps);
      steps.add(std::move(groups_[g].to_next), above.first, at(groups_[g]));
    }
    return steps;
  }

  [[nodiscard]] std::size_t length() const { return length_; }

 private:
  struct Group {
    const Nodes::Group* noise;
    int begin, count;  // noise nodes from 0
    linalg::LuFactors<Scalar> factors;
    Matrix to_next;    // D^-1 (a x 1): what values on the next group make here
    Matrix to_before;  // D^-1 (b x 1): the same for the group before
    // Places in a list for values on the levels to which the groups below and above jump.
    std::size_t first = 0, last = 0;
  };
  // Whether a noise node takes the value beyond an end; else it gives one there.
  struct Takes {
    bool inner, outer;
  };
  // One end of the element on one noise node.
  struct Port {
    int noise;
    bool inner;
  };

  [[nodiscard]] std::size_t at(const Group& group) const {
    return static_cast<std::size_t>(group.begin) * q_;
  }
  // Of how many levels a border is.
  [[nodiscard]] static int rank_of(std::span<const double> border, const Group& group) {
    return static_cast<int>(border.size()) / group.count;
  }
  void contract(const Group& group, std::span<const double> border, std::size_t to,
                LinearSteps<Scalar>& steps) const {
    const auto count = static_cast<std::size_t>(group.count);
    for (std::size_t r = 0; r * count < border.size(); ++r) {
      steps.contract(border.subspan(r * count, count), q_, at(group), to + r * q_);
    }
  }

  // The rows and columns of a group.
  [[nodiscard]] Matrix block(const Group& group) const {
    Matrix a(group.count * q_, group.count * q_);
    for (int l = 0; l < group.count; ++l) {
      const int node = group.noise->begin + l;
      double jumps = 0;
      for (const auto& [to, rate] : noise_.jumps(node)) {
        jumps += rate;
        const int column = to - group.noise->begin;
        if (column < 0 || column >= group.count) continue;
        for (int m = 0; m < q_; ++m) a(l * q_ + m, column * q_ + m) -= rate;
      }
      for (const auto& [to, rate] : noise_.carried(node)) {
        const int column = to - group.noise->begin;
        const bool here = column >= 0 && column < group.count;
        for (int m = 0; m < q_; ++m) {
          a(l * q_ + m, l * q_ + m) += rate * speeds_[m];
          if (here) a(l * q_ + m, column * q_ + m) -= rate * speeds_[m];
        }
      }
      for (int m = 0; m < q_; ++m) {
        const int row = l * q_ + m;
        const std::size_t place = at(group) + row;
        double sum = s_.taken_.inner[place] + s_.taken_.outer[place] + s_.killed_[place];
        for (int n = 0; n < q_; ++n) {
          const double rate = rates_[place * q_ + n];
          sum += rate;
          a(row, l * q_ + n) -= rate;
        }
        a(row, row) += lambda_[m] + sum + jumps;
      }
    }
    return a;
  }

  // (to_below x 1) returns (at_first x 1) from the block of a group.
  void subtract(const Group& group, const Matrix& returns, Matrix& a) const {
    const auto first = group.noise->at_first();
    const auto &to_below = group.noise->to_below, &carried = group.noise->carried_below;
    const int below = returns.rows() / q_, here = returns.columns() / q_;
    std::vector<double> shares(static_cast<std::size_t>(q_));
    for (int l = 0; l < group.count; ++l) {
      for (int s = 0; s < below; ++s) {
        const double rate = to_below[l * below + s],
                     per_distance = carried.empty() ? 0 : carried[l * below + s];
        if (rate == 0 && per_distance == 0) continue;
        for (int r = 0; r < here; ++r) {
          for (int k = 0; k < group.count; ++k) {
            const double share = first[r * group.count + k];
            if (share == 0) continue;
            for (int m = 0; m < q_; ++m) shares[m] = (rate + per_distance * speeds_[m]) * share;
            for (int n = 0; n < q_; ++n) {
              for (int m = 0; m < q_; ++m) {
                a(l * q_ + m, k * q_ + n) -= shares[m] * returns(s * q_ + m, r * q_ + n);
              }
            }
          }
        }
      }
    }
  }

  void eliminate() {
    Matrix returns;  // (d x 1)^T D^-1 (a x 1) of the group before
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      Group& group = groups_[g];
      Matrix a = block(group);
      if (g > 0) subtract(group, returns, a);
      group.factors = linalg::LuFactors<Scalar>(std::move(a));
      if (g > 0) {
        group.to_before = at_each<Scalar>(group.noise->to_below, group.noise->carried_below,
                                          speeds_, group.count);
        group.factors.solve(group.to_before);
      }
      if (g + 1 < groups_.size()) {
        group.to_next = at_each<Scalar>(group.noise->to_above, group.noise->carried_above, speeds_,
                                        group.count);
        group.factors.solve(group.to_next);
        returns = contracted(group.noise->at_last(), q_, group.to_next);
      }
    }
  }

  [[nodiscard]] std::vector<Port> ports_of(const Group& group, bool that_take) const {
    std::vector<Port> ports;
    for (int l = group.begin; l < group.begin + group.count; ++l) {
      if (ports_[l].inner == that_take) ports.push_back({l, true});
      if (ports_[l].outer == that_take) ports.push_back({l, false});
    }
    return ports;
  }

  // What the inputs of a group make of it alone.
  [[nodiscard]] Matrix own(const Group& group) const {
    const auto ports = ports_of(group, true);
    Matrix columns(group.count * q_, static_cast<int>(ports.size()));
    for (int c = 0; c < columns.columns(); ++c) {
      const auto& rates = ports[c].inner ? s_.taken_.inner : s_.taken_.outer;
      const auto from = rates.begin() + static_cast<std::ptrdiff_t>(ports[c].noise) * q_;
      std::copy_n(from, q_, &columns((ports[c].noise - group.begin) * q_, c));
    }
    group.factors.solve(columns);
    return columns;
  }

  // Rows of the outputs of a group.
  [[nodiscard]] Matrix outputs(const Group& group, const Matrix& x) const {
    const auto ports = ports_of(group, false);
    Matrix y(static_cast<int>(ports.size()), x.columns());
    for (int c = 0; c < x.columns(); ++c) {
      for (int r = 0; r < y.rows(); ++r) {
        const auto& weights = ports[r].inner ? s_.given_.inner : s_.given_.outer;
        const std::size_t trace = static_cast<std::size_t>(ports[r].noise) * q_;
        const int from = (ports[r].noise - group.begin) * q_;
        for (int m = 0; m < q_; ++m) y(r, c) += weights[trace + m] * x(from + m, c);
      }
    }
    return y;
  }

  void forward() {
    Matrix last;  // values on the levels of the group before to which this one jumps
    int column = 0, row = 0;
    for (const Group& group : groups_) {
      const Matrix alone = own(group);
      const int inputs = alone.columns();
      const auto extended = [&](const Matrix& through, const Matrix& here) {
        Matrix all(here.rows(), column + inputs);
        if (column > 0) add_product(1, through, last, column, all);
        place(here, 0, column, all);
        return all;
      };
      const bool begins = group.begin == 0;
      // With wide borders it takes less to find the values on all nodes first.
      const auto first = group.noise->at_first(), to_last = group.noise->at_last();
      const bool wide =
          group.count > 1 && rank_of(first, group) + rank_of(to_last, group) > group.count;
      const Matrix everywhere = wide ? extended(group.to_before, alone) : Matrix();
      const auto map = [&](const auto& functional) {
        if (wide) return functional(everywhere);
        const Matrix through = begins ? Matrix() : functional(group.to_before);
        return extended(through, functional(alone));
      };
      const auto on = [&](std::span<const double> c) {
        return map([&](const Matrix& x) { return contracted(c, q_, x); });
      };
      const Matrix given = map([&](const Matrix& x) { return outputs(group, x); });
      place(given, row, 0, result_);
      Matrix next = on(to_last);
      on_first_.push_back(group.count == 1 ? next : on(first));
      last = std::move(next);
      column += inputs;
      row += given.rows();
      rows_.push_back(row);
    }
  }

  void back() {
    Matrix next;  // values on the levels of the group above to which this one jumps
    for (std::size_t g = groups_.size(); g-- > 0;) {
      const Group& group = groups_[g];
      Matrix here(on_first_[g].rows(), inputs_);
      place(on_first_[g], 0, 0, here);
      if (g + 1 < groups_.size()) {
        const Matrix given = outputs(group, group.to_next) * next;
        const int row = rows_[g] - given.rows();
        for (int c = 0; c < inputs_; ++c) {
          for (int r = 0; r < given.rows(); ++r) result_(row + r, c) += given(r, c);
        }
        add_product(1, contracted(group.noise->at_first(), q_, group.to_next), next, inputs_, here);
      }
      next = std::move(here);
    }
  }

  const ElementSystem& s_;
  int q_;
  const Nodes& noise_;
  std::vector<double> rates_;
  std::span<const double> speeds_;  // of the nodes of the element
  Scalars lambda_;
  std::vector<Takes> ports_;  // by noise node
  int inputs_ = 0, outputs_ = 0;
  std::vector<int> inner_in_, outer_in_, inner_out_, outer_out_;
  std::vector<Group> groups_;
  Matrix result_;
  // By group: values on its levels to which the one below jumps, before those above count.
  std::vector<Matrix> on_first_;
  std::vector<int> rows_;  // by group: outputs up to it
  std::size_t length_ = 0;
};

template <class Scalar>
ElementSystem<Scalar>::ElementSystem(const Nodes& noise, const HpDiscretisation& velocities,
                                     int element, std::span<const double> net_force,
                                     const Shift<Scalar>& shift, Response& response)
    : count_(noise.count()),
      nodes_(velocities.element(element).reference->size),
      first_(velocities.element(element).first) {
  const auto& reference = *velocities.element(element).reference;
  const int rising_inner = first_rising(net_force, velocities.drag_at_end(element));
  const int rising_outer = first_rising(net_force, velocities.drag_at_end(element + 1));
  const auto q = static_cast<std::size_t>(nodes_), all = net_force.size() * q;
  std::vector<double> rates(all * q, 0.0);
  for (auto* port : {&taken_.inner, &taken_.outer, &given_.inner, &given_.outer}) {
    port->assign(all, 0.0);
  }
  killed_.resize(all);
  TransportRow row;
  for (std::size_t place = 0; place < all; ++place) {
    const int l = static_cast<int>(place / q), m = static_cast<int>(place % q);
    velocities.transport(net_force[l], first_ + m, row);
    double& inner = taken_.inner[place] = row.inflow;
    double& outer = taken_.outer[place] = row.outflow;
    killed_[place] = row.killed;
    for (const auto& [node, value] : row.entries) {
      if (node < first_) {
        inner += value;
      } else if (node >= first_ + nodes_) {
        outer += value;
      } else {
        rates[place * q + static_cast<std::size_t>(node - first_)] = value;
      }
    }
    if (l >= rising_inner) given_.inner[place] = reference.at_left[m];
    if (l < rising_outer) given_.outer[place] = reference.at_right[m];
  }
  Scalars by_node;
  const auto speeds = velocities.nodes().subspan(static_cast<std::size_t>(first_), q);
  for (double v : speeds) by_node.push_back(shift.at(v));
  Elimination elimination(*this, noise, std::move(rates), speeds, std::move(by_node), rising_inner,
                          rising_outer);
  response = elimination.response();
  steps_ = elimination.steps();
  length_ = static_cast<int>(elimination.length());
}

template <class Scalar>
void ElementSystem<Scalar>::solve(Lists x, bool transposed) const {
  for (int c = 0; c < x.count; ++c) std::fill(x.column(c) + size(), x.column(c) + length_, 0.0);
  steps_.run(x, transposed);
}

template <class Scalar>
void ElementSystem<Scalar>::collect(const Ports& ports, Lists x, Lists at_inner,
                                    Lists at_outer) const {
  for (int c = 0; c < x.count; ++c) {
    const Scalar* from = x.column(c);
    Scalar *inner = at_inner.column(c), *outer = at_outer.column(c);
    std::size_t place = 0;
    for (int l = 0; l < count_; ++l) {
      for (int m = 0; m < nodes_; ++m, ++place) {
        inner[l] += ports.inner[place] * from[place];
        outer[l] += ports.outer[place] * from[place];
      }
    }
  }
}

template <class Scalar>
void ElementSystem<Scalar>::distribute(const Ports& ports, Lists at_inner, Lists at_outer,
                                       Lists x) const {
  for (int c = 0; c < x.count; ++c) {
    const Scalar *inner = at_inner.column(c), *outer = at_outer.column(c);
    Scalar* to = x.column(c);
    std::size_t place = 0;
    for (int l = 0; l < count_; ++l) {
      for (int m = 0; m < nodes_; ++m, ++place) {
        to[place] += ports.inner[place] * inner[l] + ports.outer[place] * outer[l];
      }
    }
  }
}

template class ElementSystem<double>;
template class ElementSystem<std::complex<double>>;

}  // namespace stickslip::generator
