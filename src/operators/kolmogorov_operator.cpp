#include "stickslip/operators/kolmogorov_operator.hpp"

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <utility>

#include "stickslip/operators/laws.hpp"
#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/session.hpp"
#include "stickslip/petsc/vectors.hpp"

namespace stickslip::operators {
namespace {

using petsc::check;

Half other(Half half) { return half == Half::upper ? Half::lower : Half::upper; }

}  // namespace

/// Collects the rates out of one state at a time and appends its row to the local CSR arrays.
class KolmogorovOperator::Assembler {
 public:
  Assembler(const Discretisation& discretisation, const StateSpace& states, PetscScalar lambda,
            Rest rest, std::optional<Parameter> derivative)
      : derivative_(derivative),
        noise_(*discretisation.noise),
        chain_(discretisation.process.noise),
        upper_{discretisation.process, *discretisation.axis},
        lower_{discretisation.process.mirrored(), discretisation.axis->mirrored()},
        states_(states),
        lambda_(lambda),
        rest_(rest),
        zero_trace_(discretisation.axis->trace_at_zero()),
        top_trace_(discretisation.axis->trace_at_top()),
        lines_(2 * static_cast<std::size_t>(noise_.count())) {
    for (int n = -noise_.half(); n <= noise_.half(); ++n) {
      for (Half half : states.halves()) lines_[place_of_line(half, n)] = states.nodes_of(half, n);
    }
  }

  void assemble() {
    reserve();
    states_.for_each_local([this](const State& state) { append(state); });
  }

  /// u(0+) on a noise node of a half that leaves v = 0, as global indices and coefficients.
  [[nodiscard]] Functional trace_at_zero(Half half, int n) const {
    if (states_.has_origin(half, n)) {
      return {{states_.index({StateKind::origin, half, n, 0}), 1.0}};
    }
    Functional trace;
    for (const auto& e : zero_trace_) trace.emplace_back(node(half, n, e.node), e.value);
    return trace;
  }

  /// The same at s+ or s-: the level next to those at rest is a node.
  [[nodiscard]] Functional trace_at_exit(Half half) const {
    return trace_at_zero(half, states_.last_static(half) + 1);
  }

  std::vector<PetscInt> row_start{0};
  std::vector<PetscInt> columns;
  std::vector<PetscScalar> values;
  std::vector<Coupling> rest_coupling, exit_coupling;

 private:
  // A half line, seen with its noise and velocities counted along it.
  struct Side {
    model::Process process;
    const velocity::Axis& axis;
  };
  [[nodiscard]] const Side& side(Half half) const { return half == Half::upper ? upper_ : lower_; }

  // What rows on a node where all speeds are positive, and jumps, take: little more than there is.
  void reserve() {
    std::size_t entries = 0;
    for (int j = 0; j < upper_.axis.size(); ++j) {
      upper_.axis.transport(upper_.process.excess_at(noise_.x(noise_.half())), j, transport_);
      entries += transport_.entries.size() + 1;
    }
    const std::vector<int>& local = states_.local_noise();
    entries *= local.size();
    for (int n : local) entries += noise_.jumps(n).size() * upper_.axis.nodes().size();
    entries *= states_.halves().size();
    columns.reserve(entries);
    values.reserve(entries);
    row_start.reserve(static_cast<std::size_t>(states_.local_size()) + 1);
  }

  void append(const State& state) {
    switch (state.kind) {
    case StateKind::node: rates_of_node(state); break;
    case StateKind::origin: rates_of_origin(state); break;
    case StateKind::holding: rates_of_holding(state); break;
    case StateKind::rest: rates_of_rest(state.noise); break;
    }
    finish_row(states_.index(state));
  }

  // Calls visit(node, rate) for the jumps from a noise node, which are alike on both halves.
  template <class Visit>
  void for_each_jump(int n, Visit visit) const {
    if (!derivative_) {
      for (const auto& [to, rate] : noise_.jumps(n)) visit(to, rate);
    } else if (*derivative_ == Parameter::tau) {
      if (changes_of_ != n) {
        changes_ = noise_.jumps_by_tau(n);
        changes_of_ = n;
      }
      for (const auto& [to, rate] : changes_) visit(to, rate);
    }
  }

  void rates_of_node(const State& s) {
    rates_of_transport(s);
    for_each_jump(s.noise, [&](int to, double rate) { rate_to(node(s.half, to, s.node), rate); });
  }

  void rates_of_transport(const State& s) {
    const Side& here = side(s.half);
    const double excess = here.process.excess_at(noise_.x(s.noise));
    if (derivative_) {
      here.axis.transport_change(excess, speed_change(), s.node, transport_);
    } else {
      here.axis.transport(excess, s.node, transport_);
    }
    for (const auto& e : transport_.entries) rate_to(node(s.half, s.noise, e.node), e.value);
    if (transport_.inflow != 0) rate_to_zero(s, transport_.inflow);
    if (transport_.outflow != 0) rate_to(holding(s.half, s.noise), transport_.outflow);
  }

  void rates_of_origin(const State& s) {
    const Side& here = side(s.half);
    const double excess = here.process.excess_at(noise_.x(s.noise));
    rate_to(node(s.half, s.noise, 0),
            here.axis.origin_rate(derivative_ ? speed_change().excess : excess));
    for_each_jump(s.noise, [&](int to, double rate) {
      if (states_.has_origin(s.half, to)) {
        rate_to(states_.index({StateKind::origin, s.half, to, 0}), rate);
      } else {
        rate_to_rest(s.half, to, rate);
      }
    });
  }

  void rates_of_holding(const State& s) {
    for_each_jump(s.noise, [&](int to, double rate) {
      if (states_.has_holding(s.half, to)) return rate_to(holding(s.half, to), rate);
      for (const auto& e : top_trace_) rate_to(node(s.half, to, e.node), rate * e.value);
    });
  }

  void rates_of_rest(int i) {
    const int highest = upper_.process.static_index(), lowest = upper_.process.lowest_static();
    if (rest_ == Rest::killing_edges && (i == highest || i == lowest)) {
      killing_ = chain_.rate();  // value 0 there: killed at once
      return;
    }
    if (i < highest) rate_to_rest(i + 1, up_rate(i));
    if (i == highest) rate_to_exit(Half::upper, up_rate(i));
    if (i > lowest) rate_to_rest(i - 1, down_rate(i));
    if (i == lowest) rate_to_exit(Half::lower, down_rate(i));
  }

  // Where a sliding body meets v = 0.
  void rate_to_zero(const State& s, double rate) {
    if (s.noise > states_.last_static(s.half)) {
      // A grid scheme near a turning point: back to the state at v = 0.
      rate_to(states_.index({StateKind::origin, s.half, s.noise, 0}), rate);
    } else if (s.noise >= -states_.last_static(other(s.half))) {
      rate_to_rest(s.half, s.noise, rate);
    } else if (states_.folded()) {
      rate_to_trace(trace_at_zero(s.half, -s.noise), rate, reflection());
    } else {
      rate_to_trace(trace_at_zero(other(s.half), -s.noise), rate, 1);
    }
  }

  // To rest on the levels for which a node stands, in the shares of T.
  void rate_to_rest(Half half, int n, double rate) {
    const noise::Nodes::Group& group = noise_.group_of(n);
    for (int i = group.first; i <= group.last; ++i) {
      const double share = group.row(group.weight, i)[n - group.begin];
      rate_to_rest(half == Half::upper ? i : -i, rate * share);
    }
  }

  void rate_to_rest(int i, double rate) {
    if (rest_ == Rest::killing) {
      killing_ += rate;
      rest_coupling.push_back({local_row(), i, rate});
      return;
    }
    const int kept = states_.folded() ? std::abs(i) : i;
    if (!states_.has_rest(kept)) {
      killing_ += rate;  // an odd function vanishes at x = 0
      return;
    }
    rate_to(states_.index({StateKind::rest, Half::upper, kept, 0}), rate,
            kept == i ? 1 : reflection());
  }

  void rate_to_exit(Half half, double rate) {
    if (rest_ == Rest::killed_on_exit) {
      killing_ += rate;
      exit_coupling.push_back({local_row(), half == Half::upper ? 1 : -1, rate});
    } else if (states_.folded()) {
      rate_to_trace(trace_at_exit(Half::upper), rate, half == Half::upper ? 1 : reflection());
    } else {
      rate_to_trace(trace_at_exit(half), rate, 1);
    }
  }

  void rate_to_trace(const Functional& trace, double rate, double sign) {
    for (const auto& [column, weight] : trace) rate_to(column, rate * weight, sign);
  }

  // A value seen with sign -1 through a reflection leaves twice its rate in the row sum.
  void rate_to(PetscInt column, double rate, double sign = 1) {
    if (sign < 0) killing_ += 2 * rate;
    row_.emplace_back(column, -sign * rate);
  }

  // The couplings of the row to the arrays, in the order of columns, each once.
  void finish_row(PetscInt diagonal) {
    row_.emplace_back(diagonal, 0.0);  // keeps its place in the order
    std::sort(row_.begin(), row_.end(),
              [](const auto& a, const auto& b) { return a.first < b.first; });
    const std::size_t begin = columns.size();
    for (auto next = row_.begin(); next != row_.end();) {
      const PetscInt column = next->first;
      PetscScalar rate = 0;
      for (; next != row_.end() && next->first == column; ++next) rate += next->second;
      columns.push_back(column);
      values.push_back(rate);
    }
    row_start.push_back(static_cast<PetscInt>(columns.size()));
    row_.clear();
    // Summed as a reader of the row would sum it: with it the row adds up to exactly zero.
    PetscScalar sum = 0;
    std::size_t place = begin;
    for (std::size_t n = begin; n < columns.size(); ++n) {
      if (columns[n] == diagonal) {
        place = n;  // and nothing goes back to itself
      } else {
        sum += values[n];
      }
    }
    values[place] = lambda_ - sum + std::exchange(killing_, 0.0);
  }

  [[nodiscard]] PetscInt local_row() const { return static_cast<PetscInt>(row_start.size()) - 1; }
  [[nodiscard]] PetscInt node(Half half, int n, int j) const {
    const auto& [first, stride] = lines_[place_of_line(half, n)];
    return first + j * stride;
  }
  [[nodiscard]] std::size_t place_of_line(Half half, int n) const {
    return 2 * static_cast<std::size_t>(noise_.half() + n) + (half == Half::upper ? 0 : 1);
  }
  [[nodiscard]] PetscInt holding(Half half, int n) const {
    return states_.index({StateKind::holding, half, n, 0});
  }
  [[nodiscard]] double reflection() const { return states_.symmetry() == Symmetry::odd ? -1 : 1; }
  [[nodiscard]] double up_rate(int level) const { return chain_.rate() * chain_.up(level); }
  [[nodiscard]] double down_rate(int level) const { return chain_.rate() * chain_.down(level); }
  [[nodiscard]] velocity::SpeedChange speed_change() const {
    switch (*derivative_) {
    case Parameter::mu_d: return {-1, 0};
    case Parameter::tau: return {0, 0};
    case Parameter::drag_coefficient: return {0, -1};
    }
    return {};
  }

  std::optional<Parameter> derivative_;
  const noise::Nodes& noise_;
  const model::NoiseChain& chain_;
  Side upper_, lower_;
  const StateSpace& states_;
  PetscScalar lambda_;
  Rest rest_;
  std::vector<velocity::Entry> zero_trace_, top_trace_;
  std::vector<StateSpace::NodeLine> lines_;  // by noise node and half
  // Derivatives of the jumps from the noise node that was asked for last.
  mutable std::vector<noise::Nodes::Rate> changes_;
  mutable std::optional<int> changes_of_;
  velocity::TransportRow transport_;
  std::vector<std::pair<PetscInt, PetscScalar>> row_;
  double killing_ = 0;  // row sum of A - lambda
};

KolmogorovOperator::KolmogorovOperator(MPI_Comm comm, const Discretisation& discretisation,
                                       PetscScalar lambda, Symmetry symmetry, Rest rest)
    : KolmogorovOperator(comm, discretisation, lambda, symmetry, rest, std::nullopt) {}

KolmogorovOperator KolmogorovOperator::derivative(MPI_Comm comm,
                                                  const Discretisation& discretisation,
                                                  Symmetry symmetry, Parameter theta) {
  return {comm, discretisation, 0, symmetry, Rest::killing, theta};
}

KolmogorovOperator::KolmogorovOperator(MPI_Comm comm, const Discretisation& discretisation,
                                       PetscScalar lambda, Symmetry symmetry, Rest rest,
                                       std::optional<Parameter> derivative)
    : data_(std::make_shared<MatrixData>(
          MatrixData{discretisation,
                     StateSpace(comm, discretisation, symmetry, rest != Rest::killing), lambda})) {
  Assembler rows(discretisation, states(), lambda, rest, derivative);
  rows.assemble();
  trace_upper_ = rows.trace_at_exit(Half::upper);
  if (!states().folded()) trace_lower_ = rows.trace_at_exit(Half::lower);
  rest_coupling_ = std::move(rows.rest_coupling);
  exit_coupling_ = std::move(rows.exit_coupling);
  if (!derivative && symmetry != Symmetry::odd && PetscRealPart(lambda) >= 0) {
    const bool nothing_killed = rest == Rest::kept && PetscAbsScalar(lambda) == 0;
    require_generator(comm, {states().local_begin(), rows.row_start, rows.columns, rows.values},
                      {discretisation.axis->keeps_origin(), nothing_killed},
                      discretisation.process);
  }
  nonzeros_ = rows.row_start.back();
  row_start_ = std::move(rows.row_start);
  columns_ = std::move(rows.columns);
  values_ = std::move(rows.values);
  matrix_ = stored();
  if (!derivative) attach(matrix_, data_);
  MPI_Allreduce(MPI_IN_PLACE, &nonzeros_, 1, MPIU_INT64, MPI_SUM, comm);
}

void KolmogorovOperator::shift(PetscScalar by) {
  check(MatShift(matrix_, by));
  data_->lambda += by;
}

petsc::MatHandle KolmogorovOperator::stored() {
  const PetscInt local = states().local_size(), global = states().global_size();
  MPI_Comm comm = states().comm();
  petsc::MatHandle matrix;
  if (petsc::ranks(comm) == 1) {
    check(MatCreateSeqAIJWithArrays(comm, local, local, row_start_.data(), columns_.data(),
                                    values_.data(), matrix.out()));
  } else {
    separate_others();
    check(MatCreateMPIAIJWithSplitArrays(
        comm, local, local, global, global, row_start_.data(), columns_.data(), values_.data(),
        other_start_.data(), other_columns_.data(), other_values_.data(), matrix.out()));
  }
  return matrix;
}

// Entries in columns of other ranks into arrays of their own, which PETSc wants apart; few, as only
// jumps lead there.
void KolmogorovOperator::separate_others() {
  const PetscInt begin = states().local_begin(), local = states().local_size();
  other_start_.assign(1, 0);
  PetscInt kept = 0, next = 0;
  for (PetscInt r = 0; r < local; ++r) {
    const PetscInt end = row_start_[r + 1];
    for (; next < end; ++next) {
      const PetscInt column = columns_[next] - begin;
      if (column >= 0 && column < local) {
        columns_[kept] = column;
        values_[kept++] = values_[next];
      } else {
        other_columns_.push_back(columns_[next]);
        other_values_.push_back(values_[next]);
      }
    }
    row_start_[r + 1] = kept;
    other_start_.push_back(static_cast<PetscInt>(other_columns_.size()));
  }
}

petsc::VecHandle KolmogorovOperator::zeros() const {
  petsc::VecHandle x;
  check(MatCreateVecs(matrix_, nullptr, x.out()));
  return x;
}

petsc::VecHandle KolmogorovOperator::trace_at_exit(Half half) const {
  petsc::VecHandle g = zeros();
  const PetscInt begin = states().local_begin(), end = begin + states().local_size();
  for (const auto& [index, weight] : half == Half::upper ? trace_upper_ : trace_lower_) {
    if (index < begin || index >= end) continue;
    check(VecSetValue(g, index, weight, INSERT_VALUES));
  }
  check(VecAssemblyBegin(g));
  check(VecAssemblyEnd(g));
  return g;
}

petsc::VecHandle KolmogorovOperator::value_at(int i, double v) const {
  const auto& [process, noise, axis] = discretisation();
  const int lowest = process.lowest_static();
  const bool rest = v == 0 && i >= lowest && i <= process.static_index();
  const bool below = v < 0 || (v == 0 && (rest ? i < 0 : i < lowest));
  const bool mirrored = below && states().folded();
  const double sign = mirrored && states().symmetry() == Symmetry::odd ? -1 : 1;
  const Half half = below && !mirrored ? Half::lower : Half::upper;
  petsc::VecHandle g = zeros();
  const PetscInt begin = states().local_begin(), end = begin + states().local_size();
  const auto add = [&](const State& state, double weight) {
    const PetscInt index = states().index(state);
    if (index >= begin && index < end) check(VecSetValue(g, index, weight, ADD_VALUES));
  };
  // A level as a combination of noise nodes, of those as combinations of velocity nodes.
  const auto& group = noise->group_at(below ? -i : i);
  const auto shares = group.row(group.value, below ? -i : i);
  for (int l = 0; !rest && l < group.count; ++l) {
    const int n = group.begin + l;
    if (v == 0 && states().has_origin(half, n)) {
      add({StateKind::origin, half, n, 0}, sign);
      continue;
    }
    for (const auto& e : v == 0 ? axis->trace_at_zero() : axis->value_at(std::abs(v))) {
      add({StateKind::node, half, n, e.node}, sign * shares[l] * e.value);
    }
  }
  if (rest) {
    const int kept = states().folded() ? std::abs(i) : i;
    if (states().has_rest(kept)) add({StateKind::rest, Half::upper, kept, 0}, sign);
  }
  check(VecAssemblyBegin(g));
  check(VecAssemblyEnd(g));
  return g;
}

std::vector<PetscScalar> KolmogorovOperator::entry_rates(Vec nu) const {
  const int lowest = discretisation().process.lowest_static(),
            count = discretisation().process.static_index() - lowest + 1;
  std::vector<PetscScalar> rates(static_cast<std::size_t>(count), 0.0);
  const petsc::ReadView local(nu);
  for (const auto& c : rest_coupling_) rates[c.level - lowest] += c.rate * local[c.row];
  MPI_Allreduce(MPI_IN_PLACE, rates.data(), static_cast<int>(rates.size()), MPIU_SCALAR, MPIU_SUM,
                states().comm());
  return rates;
}

petsc::VecHandle KolmogorovOperator::from_rest(const std::vector<PetscScalar>& s) const {
  const int lowest = discretisation().process.lowest_static();
  petsc::VecHandle f = zeros();
  petsc::WriteView local(f);
  for (const auto& c : rest_coupling_) local[c.row] += c.rate * s[c.level - lowest];
  return f;
}

petsc::VecHandle KolmogorovOperator::exit_rates(Half half) const {
  const int side = half == Half::upper ? 1 : -1;
  petsc::VecHandle f = zeros();
  petsc::WriteView local(f);
  for (const auto& c : exit_coupling_) {
    if (c.level == side) local[c.row] += c.rate;
  }
  return f;
}

petsc::VecHandle KolmogorovOperator::values(const Observable& f) const {
  petsc::VecHandle result = zeros();
  petsc::WriteView local(result);
  const model::NoiseChain& chain = discretisation().process.noise;
  const velocity::Axis& axis = *discretisation().axis;
  PetscInt at = 0;
  states().for_each_local([&](const State& s) {
    const double sign = s.half == Half::upper ? 1 : -1;
    if (s.kind == StateKind::rest) {
      local[at++] = f(chain.level(s.noise), 0, 0);
      return;
    }
    double v = 0;
    if (s.kind == StateKind::node) v = sign * axis.nodes()[s.node];
    if (s.kind == StateKind::holding) v = sign * axis.v_max();
    local[at++] = discretisation().noise->projected(
        s.noise, [&](int i) { return f(sign * chain.level(i), sign, v); });
  });
  return result;
}

}  // namespace stickslip::operators
