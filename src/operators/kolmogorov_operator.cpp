#include "stickslip/operators/kolmogorov_operator.hpp"

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <utility>

#include "stickslip/operators/laws.hpp"
#include "stickslip/operators/transport.hpp"
#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/session.hpp"
#include "stickslip/petsc/split_matrix.hpp"
#include "stickslip/petsc/vectors.hpp"

namespace stickslip::operators {
namespace {

using petsc::check;

Half other(Half half) { return half == Half::upper ? Half::lower : Half::upper; }

}  // namespace

/// Collects the rates out of one state at a time and appends its row to the local CSR arrays.
class KolmogorovOperator::Assembler {
 public:
  Assembler(const model::Process& process, const velocity::Axis& axis, const StateSpace& states,
            PetscScalar lambda, Rest rest, Form form, std::optional<Parameter> derivative)
      : by_elements_(form == Form::by_elements),
        derivative_(derivative),
        noise_(process.noise),
        upper_{process, axis},
        lower_{process.mirrored(), axis.mirrored()},
        states_(states),
        lambda_(lambda),
        rest_(rest),
        top_(process.noise.levels),
        zero_trace_(axis.trace_at_zero()),
        top_trace_(axis.trace_at_top()),
        lines_(2 * (2 * static_cast<std::size_t>(top_) + 1)) {
    for (int level = -top_; level <= top_; ++level) {
      for (Half half : states.halves()) {
        lines_[place_of_line(half, level)] = states.nodes_of(half, level);
      }
    }
  }

  void assemble() {
    reserve();
    states_.for_each_local([this](const State& state) { append(state); });
  }

  /// u(0+) on a level of a half that leaves v = 0, as global indices and coefficients.
  [[nodiscard]] Functional trace_at_zero(Half half, int level) const {
    if (states_.has_origin(half, level)) {
      return {{states_.index({StateKind::origin, half, level, 0}), 1.0}};
    }
    Functional trace;
    for (const auto& e : zero_trace_) trace.emplace_back(node(half, level, e.node), e.value);
    return trace;
  }

  std::vector<PetscInt> row_start{0};
  std::vector<PetscInt> columns;
  std::vector<PetscScalar> values;
  std::vector<Coupling> rest_coupling, exit_coupling;

 private:
  // A half line, seen with its levels and velocities counted along it.
  struct Side {
    Side(const model::Process& p, const velocity::Axis& a)
        : process(p), axis(a), k(p.static_index()) {}
    model::Process process;
    const velocity::Axis& axis;
    int k;  // the highest level that can stick
  };
  [[nodiscard]] const Side& side(Half half) const { return half == Half::upper ? upper_ : lower_; }

  // What rows on a level where all speeds are positive, and jumps, take: little more than there is.
  void reserve() {
    std::size_t entries = 0;
    for (int j = 0; j < upper_.axis.size(); ++j) {
      if (by_elements_ && !at_an_end(j)) continue;
      entries += 3;
      upper_.axis.transport(upper_.process.excess(top_), j, transport_);
      entries += transport_.entries.size();
    }
    entries *= states_.halves().size() * states_.local_levels().size();
    columns.reserve(entries);
    values.reserve(entries);
    row_start.reserve(static_cast<std::size_t>(states_.local_size()) + 1);
  }

  void append(const State& state) {
    switch (state.kind) {
    case StateKind::node: rates_of_node(state); break;
    case StateKind::origin: rates_of_origin(state); break;
    case StateKind::holding: rates_of_holding(state); break;
    case StateKind::rest: rates_of_rest(state.level); break;
    }
    if (by_elements_ && state.kind == StateKind::node) {
      finish_couplings();  // jumps and transport have the diagonal
      killing_ = 0;
    } else {
      finish_row(states_.index(state));
    }
  }

  void rates_of_node(const State& s) {
    if (!by_elements_ || at_an_end(s.node)) rates_of_transport(s);
    const auto jump_to = [&](int level, double rate) {
      const bool applied = by_elements_ && states_.owns(level);
      if (!applied) rate_to(node(s.half, level, s.node), rate);
    };
    if (s.level < top_) jump_to(s.level + 1, up_rate(s.level));
    if (s.level > -top_) jump_to(s.level - 1, down_rate(s.level));
  }

  // Whether a node lies in the first or last element.
  [[nodiscard]] bool at_an_end(int node) const {
    return node <= zero_trace_.back().node || node >= top_trace_.front().node;
  }

  void rates_of_transport(const State& s) {
    const Side& here = side(s.half);
    const double excess = here.process.excess(s.level);
    if (derivative_) {
      here.axis.transport_change(excess, speed_change(), s.node, transport_);
    } else {
      here.axis.transport(excess, s.node, transport_);
    }
    if (!by_elements_) {
      for (const auto& e : transport_.entries) rate_to(node(s.half, s.level, e.node), e.value);
    }
    if (transport_.inflow != 0) rate_to_zero(s, transport_.inflow);
    if (transport_.outflow != 0) rate_to(holding(s.half, s.level), transport_.outflow);
  }

  void rates_of_origin(const State& s) {
    const auto origin = [&](int level) {
      return states_.index({StateKind::origin, s.half, level, 0});
    };
    const Side& here = side(s.half);
    rate_to(
        node(s.half, s.level, 0),
        here.axis.origin_rate(derivative_ ? speed_change().excess : here.process.excess(s.level)));
    if (s.level < top_) rate_to(origin(s.level + 1), up_rate(s.level));
    if (s.level - 1 > here.k) {
      rate_to(origin(s.level - 1), down_rate(s.level));
    } else {
      rate_to_rest(noise_level(s.half, here.k), down_rate(s.level));
    }
  }

  void rates_of_holding(const State& s) {
    if (s.level < top_) rate_to(holding(s.half, s.level + 1), up_rate(s.level));
    if (states_.has_holding(s.half, s.level - 1)) {
      rate_to(holding(s.half, s.level - 1), down_rate(s.level));
    } else if (s.level > -top_) {
      for (const auto& e : top_trace_) {
        rate_to(node(s.half, s.level - 1, e.node), down_rate(s.level) * e.value);
      }
    }
  }

  void rates_of_rest(int i) {
    const int highest = upper_.k, lowest = -lower_.k;
    if (rest_ == Rest::killing_edges && (i == highest || i == lowest)) {
      killing_ = noise_.rate();  // value 0 there: killed at once
      return;
    }
    if (i < highest) rate_to_rest(i + 1, up_rate(i));
    if (i == highest) rate_to_exit(Half::upper, up_rate(i));
    if (i > lowest) rate_to_rest(i - 1, down_rate(i));
    if (i == lowest) rate_to_exit(Half::lower, down_rate(i));
  }

  // Where a sliding body meets v = 0.
  void rate_to_zero(const State& s, double rate) {
    if (s.level > side(s.half).k) {
      // A grid scheme near a turning point: back to the state at v = 0.
      rate_to(states_.index({StateKind::origin, s.half, s.level, 0}), rate);
    } else if (s.level >= -side(other(s.half)).k) {
      rate_to_rest(noise_level(s.half, s.level), rate);
    } else if (states_.folded()) {
      rate_to_trace(trace_at_zero(s.half, -s.level), rate, reflection());
    } else {
      rate_to_trace(trace_at_zero(other(s.half), -s.level), rate, 1);
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
      rate_to_trace(trace_at_zero(Half::upper, upper_.k + 1), rate,
                    half == Half::upper ? 1 : reflection());
    } else {
      rate_to_trace(trace_at_zero(half, side(half).k + 1), rate, 1);
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
  void finish_couplings() {
    std::sort(row_.begin(), row_.end(),
              [](const auto& a, const auto& b) { return a.first < b.first; });
    for (auto next = row_.begin(); next != row_.end();) {
      const PetscInt column = next->first;
      PetscScalar rate = 0;
      for (; next != row_.end() && next->first == column; ++next) rate += next->second;
      columns.push_back(column);
      values.push_back(rate);
    }
    row_start.push_back(static_cast<PetscInt>(columns.size()));
    row_.clear();
  }

  void finish_row(PetscInt diagonal) {
    row_.emplace_back(diagonal, 0.0);  // keeps its place in the order
    const std::size_t begin = columns.size();
    finish_couplings();
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
  [[nodiscard]] PetscInt node(Half half, int level, int j) const {
    const auto& [first, stride] = lines_[place_of_line(half, level)];
    return first + j * stride;
  }
  [[nodiscard]] std::size_t place_of_line(Half half, int level) const {
    return 2 * static_cast<std::size_t>(top_ + level) + (half == Half::upper ? 0 : 1);
  }
  [[nodiscard]] PetscInt holding(Half half, int level) const {
    return states_.index({StateKind::holding, half, level, 0});
  }
  static int noise_level(Half half, int level) { return half == Half::upper ? level : -level; }
  [[nodiscard]] double reflection() const { return states_.symmetry() == Symmetry::odd ? -1 : 1; }
  [[nodiscard]] double up_rate(int level) const {
    if (!derivative_) return noise_.rate() * noise_.up(level);
    return jump_change(noise_.up(level), noise_.up_change(level));
  }
  [[nodiscard]] double down_rate(int level) const {
    if (!derivative_) return noise_.rate() * noise_.down(level);
    return jump_change(noise_.down(level), noise_.down_change(level));
  }
  // Of Lambda times a jump probability.
  [[nodiscard]] double jump_change(double probability, double change) const {
    if (*derivative_ != Parameter::tau) return 0;
    return noise_.rate_change() * probability + noise_.rate() * change;
  }
  [[nodiscard]] velocity::SpeedChange speed_change() const {
    switch (*derivative_) {
    case Parameter::mu_d: return {-1, 0};
    case Parameter::tau: return {0, 0};
    case Parameter::drag_coefficient: return {0, -1};
    }
    return {};
  }

  bool by_elements_;
  std::optional<Parameter> derivative_;
  const model::NoiseChain& noise_;
  Side upper_, lower_;
  const StateSpace& states_;
  PetscScalar lambda_;
  Rest rest_;
  int top_;
  std::vector<velocity::Entry> zero_trace_, top_trace_;
  std::vector<StateSpace::NodeLine> lines_;  // by level and half
  velocity::TransportRow transport_;
  std::vector<std::pair<PetscInt, PetscScalar>> row_;
  double killing_ = 0;  // row sum of A - lambda
};

KolmogorovOperator::KolmogorovOperator(MPI_Comm comm, const model::Process& process,
                                       const velocity::Axis& axis, PetscScalar lambda,
                                       Symmetry symmetry, Rest rest, Form form)
    : KolmogorovOperator(comm, process, axis, lambda, symmetry, rest, form, std::nullopt) {}

KolmogorovOperator KolmogorovOperator::derivative(MPI_Comm comm, const model::Process& process,
                                                  const velocity::Axis& axis, Symmetry symmetry,
                                                  Parameter theta) {
  return {comm, process, axis, 0, symmetry, Rest::killing, Form::assembled, theta};
}

KolmogorovOperator::KolmogorovOperator(MPI_Comm comm, const model::Process& process,
                                       const velocity::Axis& axis, PetscScalar lambda,
                                       Symmetry symmetry, Rest rest, Form form,
                                       std::optional<Parameter> derivative)
    : states_(comm, process, axis, symmetry, rest != Rest::killing),
      process_(process),
      nodes_(axis.nodes().begin(), axis.nodes().end()),
      v_max_(axis.v_max()) {
  Assembler rows(process, axis, states_, lambda, rest, form, derivative);
  rows.assemble();
  trace_upper_ = rows.trace_at_zero(Half::upper, process.static_index() + 1);
  if (!states_.folded()) {
    trace_lower_ = rows.trace_at_zero(Half::lower, 1 - process.lowest_static());
  }
  rest_coupling_ = std::move(rows.rest_coupling);
  exit_coupling_ = std::move(rows.exit_coupling);
  const bool whole = form == Form::assembled && !derivative;
  if (whole && symmetry != Symmetry::odd && PetscRealPart(lambda) >= 0) {
    const bool nothing_killed = rest == Rest::kept && PetscAbsScalar(lambda) == 0;
    require_generator(comm, {states_.local_begin(), rows.row_start, rows.columns, rows.values},
                      {axis.keeps_origin(), nothing_killed}, process);
  }

  nonzeros_ = rows.row_start.back();
  row_start_ = std::move(rows.row_start);
  columns_ = std::move(rows.columns);
  values_ = std::move(rows.values);
  matrix_ = stored();
  if (form == Form::by_elements) {
    auto between = jumps(states_, process, axis, lambda);
    auto within = transport(states_, process, dynamic_cast<const velocity::HpAxis&>(axis));
    nonzeros_ += between.entries() + within.entries();
    matrix_ = petsc::SplitMatrix::make(std::move(matrix_), std::move(between), std::move(within));
  }
  MPI_Allreduce(MPI_IN_PLACE, &nonzeros_, 1, MPIU_INT64, MPI_SUM, comm);
}

petsc::MatHandle KolmogorovOperator::stored() {
  const PetscInt local = states_.local_size(), global = states_.global_size();
  MPI_Comm comm = states_.comm();
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
  const PetscInt begin = states_.local_begin(), local = states_.local_size();
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
  const PetscInt begin = states_.local_begin(), end = begin + states_.local_size();
  for (const auto& [index, weight] : half == Half::upper ? trace_upper_ : trace_lower_) {
    if (index < begin || index >= end) continue;
    check(VecSetValue(g, index, weight, INSERT_VALUES));
  }
  check(VecAssemblyBegin(g));
  check(VecAssemblyEnd(g));
  return g;
}

petsc::VecHandle KolmogorovOperator::value_at(const velocity::Axis& axis, int i, double v) const {
  const int lowest = process_.lowest_static();
  const bool rest = v == 0 && i >= lowest && i <= process_.static_index();
  const bool below = v < 0 || (v == 0 && (rest ? i < 0 : i < lowest));
  const bool mirrored = below && states_.folded();
  const double sign = mirrored && states_.symmetry() == Symmetry::odd ? -1 : 1;
  const Half half = below && !mirrored ? Half::lower : Half::upper;
  const int level = below ? -i : i;
  petsc::VecHandle g = zeros();
  const PetscInt begin = states_.local_begin(), end = begin + states_.local_size();
  const auto add = [&](const State& state, double weight) {
    const PetscInt index = states_.index(state);
    if (index >= begin && index < end) check(VecSetValue(g, index, weight, ADD_VALUES));
  };
  if (rest) {
    const int kept = states_.folded() ? std::abs(i) : i;
    if (states_.has_rest(kept)) add({StateKind::rest, Half::upper, kept, 0}, sign);
  } else if (v == 0 && states_.has_origin(half, level)) {
    add({StateKind::origin, half, level, 0}, sign);
  } else {
    for (const auto& e : v == 0 ? axis.trace_at_zero() : axis.value_at(std::abs(v))) {
      add({StateKind::node, half, level, e.node}, sign * e.value);
    }
  }
  check(VecAssemblyBegin(g));
  check(VecAssemblyEnd(g));
  return g;
}

std::vector<PetscScalar> KolmogorovOperator::entry_rates(Vec nu) const {
  const int lowest = process_.lowest_static(), count = process_.static_index() - lowest + 1;
  std::vector<PetscScalar> rates(static_cast<std::size_t>(count), 0.0);
  const petsc::ReadView local(nu);
  for (const auto& c : rest_coupling_) rates[c.level - lowest] += c.rate * local[c.row];
  MPI_Allreduce(MPI_IN_PLACE, rates.data(), static_cast<int>(rates.size()), MPIU_SCALAR, MPIU_SUM,
                states_.comm());
  return rates;
}

petsc::VecHandle KolmogorovOperator::from_rest(const std::vector<PetscScalar>& s) const {
  const int lowest = process_.lowest_static();
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
  PetscInt at = 0;
  states_.for_each_local([&](const State& s) {
    const double sign = s.half == Half::upper ? 1 : -1;
    const double x = sign * process_.noise.level(s.level);
    double v = 0;
    if (s.kind == StateKind::node) v = sign * nodes_[s.node];
    if (s.kind == StateKind::holding) v = sign * v_max_;
    local[at++] = f(x, s.kind == StateKind::rest ? 0 : sign, v);
  });
  return result;
}

}  // namespace stickslip::operators
