#pragma once
/// Rows of a KolmogorovOperator.

#include <petscsys.h>

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <utility>
#include <vector>

#include "stickslip/generator/generator.hpp"

namespace stickslip::generator {

/// Collects the rates out of one state at a time and appends its row to the local CSR arrays.
class RowAssembler {
 public:
  /// Values by global index.
  using Functional = std::vector<std::pair<PetscInt, double>>;

  RowAssembler(const Discretisation& discretisation, const StateSpace& states,
               Shift<PetscScalar> shift, StaticPhase static_phase,
               std::optional<model::Derivative> derivative)
      : derivative_(std::move(derivative)),
        noise_(*discretisation.noise),
        chain_(discretisation.process.noise),
        upper_{discretisation.process, noise_, *discretisation.velocities},
        lower_{discretisation.process.mirrored(), noise_.mirrored(),
               discretisation.velocities->mirrored()},
        states_(states),
        shift_(shift),
        static_phase_(static_phase),
        exit_rates_(upper_.process.exit_rates()),
        zero_trace_(discretisation.velocities->trace_at_zero()),
        top_trace_(discretisation.velocities->trace_at_top()),
        lines_(2 * static_cast<std::size_t>(noise_.count())) {
    for (Branch branch : states.branches()) {
      const auto& nodes = side(branch).noise;
      for (int n = nodes.first(); n <= nodes.last(); ++n) {
        lines_[place_of_line(branch, n)] = states.nodes_of(branch, n);
      }
    }
  }

  void assemble() {
    reserve();
    states_.for_each_local([this](const State& state) { append(state); });
  }

  /// u(0+) on a noise node of a branch that leaves v = 0, as global indices and coefficients.
  [[nodiscard]] Functional trace_at_zero(Branch branch, int n) const {
    if (states_.has_origin(branch, n)) {
      return {{states_.index({StateKind::origin, branch, n, 0}), 1.0}};
    }
    Functional trace;
    for (const auto& e : zero_trace_) trace.emplace_back(node(branch, n, e.node), e.value);
    return trace;
  }

  /// The same on a level that does not stick and is a node, as those from which excursions start;
  /// symmetry-reduced, of a level above the static ones.
  [[nodiscard]] Functional trace_at_start(int level) const {
    const bool up = level > upper_.process.highest_static();
    const Branch branch = up ? Branch::positive : Branch::negative;
    return trace_at_zero(branch, side(branch).noise.node_at(up ? level : -level));
  }

  std::vector<PetscInt> row_start{0};
  std::vector<PetscInt> columns;
  std::vector<PetscScalar> values;
  std::vector<StaticCoupling> static_coupling;
  std::vector<TopCoupling> top_coupling;

 private:
  // A velocity branch, seen with its noise and velocities counted along it.
  struct Side {
    model::Process process;
    const Nodes& noise;
    const VelocityDiscretisation& velocities;
  };
  [[nodiscard]] const Side& side(Branch branch) const {
    return branch == Branch::positive ? upper_ : lower_;
  }

  // What rows on a node where all speeds are positive, and jumps, take: little more than there is.
  void reserve() {
    std::size_t entries = 0;
    for (int j = 0; j < upper_.velocities.size(); ++j) {
      upper_.velocities.transport(upper_.process.net_force_at(noise_.x(noise_.last())), j,
                                  transport_);
      entries += transport_.entries.size() + 1;
    }
    const std::vector<int>& local = states_.local_noise();
    entries *= local.size();
    for (int n : local) {
      entries +=
          (noise_.jumps(n).size() + noise_.carried(n).size()) * upper_.velocities.nodes().size();
    }
    entries *= states_.branches().size();
    columns.reserve(entries);
    values.reserve(entries);
    row_start.reserve(static_cast<std::size_t>(states_.local_size()) + 1);
  }

  void append(const State& state) {
    switch (state.kind) {
    case StateKind::node: rates_of_node(state); break;
    case StateKind::origin: rates_of_origin(state); break;
    case StateKind::holding: rates_of_holding(state); break;
    case StateKind::static_phase: rates_at_rest(state.noise); break;
    }
    finish_row(states_.index(state), shift_.at(velocity_of(state, upper_.velocities)));
  }

  // Calls visit(node, rate) for the jumps from a noise node. By tau they are alike on both
  // branches.
  template <class Visit>
  void for_each_jump(Branch branch, int n, Visit visit) const {
    if (!derivative_) {
      for (const auto& [to, rate] : side(branch).noise.jumps(n)) visit(to, rate);
    } else if (derivative_->nodes) {
      const int sign = branch == Branch::positive ? 1 : -1;
      for (const auto& [to, rate] : derivative_->nodes->rates[place_of_level(sign * n)]) {
        visit(sign * (chain_.lowest() + to), rate);
      }
    } else if (derivative_->is_of_jumps()) {
      if (changes_of_ != n) {
        changes_ = noise_.jumps_by_tau(n);
        changes_of_ = n;
      }
      for (const auto& [to, rate] : changes_) visit(to, rate);
    }
  }

  void rates_of_node(const State& s) {
    rates_of_transport(s);
    for_each_jump(s.branch, s.noise,
                  [&](int to, double rate) { rate_to(node(s.branch, to, s.node), rate); });
    if (derivative_) return;
    const double speed = upper_.velocities.nodes()[s.node];
    for (const auto& [to, rate] : side(s.branch).noise.carried(s.noise)) {
      rate_to(node(s.branch, to, s.node), speed * rate);
    }
  }

  void rates_of_transport(const State& s) {
    const Side& here = side(s.branch);
    const double net_force = here.process.net_force_at(here.noise.x(s.noise));
    if (derivative_) {
      here.velocities.transport_change(net_force, speed_change(s.branch, s.noise), s.node,
                                       transport_);
    } else {
      here.velocities.transport(net_force, s.node, transport_);
    }
    for (const auto& e : transport_.entries) rate_to(node(s.branch, s.noise, e.node), e.value);
    if (transport_.inflow != 0) rate_to_zero(s, transport_.inflow);
    if (transport_.outflow != 0) rate_to(holding(s.branch, s.noise), transport_.outflow);
    if (transport_.killed == 0) return;
    killing_ += transport_.killed;
    top_coupling.push_back({local_row(), transport_.killed});
  }

  void rates_of_origin(const State& s) {
    const Side& here = side(s.branch);
    const double net_force = here.process.net_force_at(here.noise.x(s.noise));
    rate_to(
        node(s.branch, s.noise, 0),
        here.velocities.origin_rate(derivative_ ? speed_change(s.branch, s.noise)(0) : net_force));
    for_each_jump(s.branch, s.noise, [&](int to, double rate) {
      rate_to_zero({StateKind::node, s.branch, to, 0}, rate);
    });
  }

  void rates_of_holding(const State& s) {
    const auto leave = [&](int to, double rate) {
      if (states_.has_holding(s.branch, to)) return rate_to(holding(s.branch, to), rate);
      for (const auto& e : top_trace_) rate_to(node(s.branch, to, e.node), rate * e.value);
    };
    for_each_jump(s.branch, s.noise, leave);
    if (derivative_) return;
    for (const auto& [to, rate] : side(s.branch).noise.carried(s.noise)) {
      leave(to, upper_.velocities.v_max() * rate);
    }
  }

  void rates_at_rest(int i) {
    const int highest = upper_.process.highest_static(), lowest = upper_.process.lowest_static();
    if (static_phase_ == StaticPhase::killing_edges && exit_rates_[i - lowest] > 0) {
      killing_ = chain_.rate();  // value 0 there: killed at once
      return;
    }
    chain_.for_each_jump(i, [&](int to, double rate) {
      if (lowest <= to && to <= highest) return rate_to_rest(to, rate);
      rate_to_exit(to, rate);
    });
  }

  // Where a sliding body meets v = 0.
  void rate_to_zero(const State& s, double rate) {
    if (s.noise > states_.last_static(s.branch)) {
      // A grid scheme near a turning point: back to the state at v = 0.
      rate_to(states_.index({StateKind::origin, s.branch, s.noise, 0}), rate);
    } else if (s.noise >= -states_.last_static(opposite(s.branch))) {
      rate_to_rest(s.branch, s.noise, rate);
    } else if (states_.symmetry_reduced()) {
      rate_to_trace(trace_at_zero(s.branch, -s.noise), rate, reflection());
    } else {
      rate_to_trace(trace_at_zero(opposite(s.branch), -s.noise), rate, 1);
    }
  }

  // To rest on the levels for which a node stands, in the shares of T.
  void rate_to_rest(Branch branch, int n, double rate) {
    const Nodes::Group& group = side(branch).noise.group_of(n);
    for (int i = group.first; i <= group.last; ++i) {
      const double share = group.row(group.weight, i)[n - group.begin];
      if (share != 0) rate_to_rest(branch == Branch::positive ? i : -i, rate * share);
    }
  }

  void rate_to_rest(int i, double rate) {
    if (static_phase_ == StaticPhase::killing) {
      killing_ += rate;
      static_coupling.push_back({local_row(), i, rate});
      return;
    }
    const int kept = states_.symmetry_reduced() ? std::abs(i) : i;
    if (!states_.has_static_state(kept)) {
      killing_ += rate;  // an odd function vanishes at x = 0
      return;
    }
    rate_to(states_.index({StateKind::static_phase, Branch::positive, kept, 0}), rate,
            kept == i ? 1 : reflection());
  }

  void rate_to_exit(int level, double rate) {
    if (static_phase_ == StaticPhase::killed_on_exit) {
      killing_ += rate;
    } else if (states_.symmetry_reduced()) {
      rate_to_trace(trace_at_start(std::abs(level)), rate, level > 0 ? 1 : reflection());
    } else {
      rate_to_trace(trace_at_start(level), rate, 1);
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
  void finish_row(PetscInt diagonal, PetscScalar shift) {
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
    values[place] = shift - sum + std::exchange(killing_, 0.0);
  }

  [[nodiscard]] PetscInt local_row() const { return static_cast<PetscInt>(row_start.size()) - 1; }
  [[nodiscard]] PetscInt node(Branch branch, int n, int j) const {
    const auto& [first, stride] = lines_[place_of_line(branch, n)];
    return first + j * stride;
  }
  [[nodiscard]] std::size_t place_of_line(Branch branch, int n) const {
    const int place = n - side(branch).noise.first();
    return 2 * static_cast<std::size_t>(place) + (branch == Branch::positive ? 0 : 1);
  }
  [[nodiscard]] PetscInt holding(Branch branch, int n) const {
    return states_.index({StateKind::holding, branch, n, 0});
  }
  [[nodiscard]] double reflection() const { return states_.symmetry() == Symmetry::odd ? -1 : 1; }
  [[nodiscard]] std::size_t place_of_level(int level) const {
    const int place = level - chain_.lowest();
    return static_cast<std::size_t>(place);
  }
  [[nodiscard]] SpeedChange speed_change(Branch branch, int n) const {
    if (derivative_->is_of_jumps()) return [](double) { return 0.0; };
    const auto& given = upper_.process.friction;
    const bool lower = branch == Branch::negative;
    const int sign = lower ? -1 : 1;
    const double moved =
        derivative_->nodes ? sign * derivative_->nodes->x[place_of_level(sign * n)] : 0;
    return [moved, change = derivative_->acceleration,
            here = model::BranchFriction{side(branch).process.friction, lower && given.mu_s_minus,
                                         lower && given.mu_d_minus}](double v) {
      return change(here, v) + moved;
    };
  }

  std::optional<model::Derivative> derivative_;
  const Nodes& noise_;
  const model::NoiseChain& chain_;
  Side upper_, lower_;
  const StateSpace& states_;
  Shift<PetscScalar> shift_;
  StaticPhase static_phase_;
  std::vector<double> exit_rates_;
  std::vector<Entry> zero_trace_, top_trace_;
  std::vector<StateSpace::NodeLine> lines_;  // by noise node and branch
  // Derivatives of the jumps from the noise node that was asked for last.
  mutable std::vector<Nodes::Rate> changes_;
  mutable std::optional<int> changes_of_;
  TransportRow transport_;
  std::vector<std::pair<PetscInt, PetscScalar>> row_;
  double killing_ = 0;  // row sum of A less what is added to -L
};

}  // namespace stickslip::generator
