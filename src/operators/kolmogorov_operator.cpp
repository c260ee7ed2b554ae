#include "stickslip/operators/kolmogorov_operator.hpp"

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <utility>

#include "row_assembler.hpp"
#include "stickslip/operators/generator_checks.hpp"
#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/session.hpp"
#include "stickslip/petsc/vectors.hpp"

namespace stickslip::operators {

using petsc::check;

KolmogorovOperator::KolmogorovOperator(MPI_Comm comm, const Discretisation& discretisation,
                                       Shift<PetscScalar> shift, Symmetry symmetry,
                                       StaticPhase static_phase)
    : KolmogorovOperator(comm, discretisation, shift, symmetry, static_phase, std::nullopt) {}

KolmogorovOperator KolmogorovOperator::derivative(MPI_Comm comm,
                                                  const Discretisation& discretisation,
                                                  Symmetry symmetry,
                                                  const model::Derivative& theta) {
  return {comm, discretisation, {}, symmetry, StaticPhase::killing, theta};
}

KolmogorovOperator::KolmogorovOperator(MPI_Comm comm, const Discretisation& discretisation,
                                       Shift<PetscScalar> shift, Symmetry symmetry,
                                       StaticPhase static_phase,
                                       std::optional<model::Derivative> derivative)
    : data_(std::make_shared<MatrixData>(MatrixData{
          discretisation,
          StateSpace(comm, discretisation, symmetry, static_phase != StaticPhase::killing),
          shift})) {
  RowAssembler rows(discretisation, states(), shift, static_phase, derivative);
  rows.assemble();
  for (int level : discretisation.process.starts()) {
    if (states().symmetry_reduced() && level < 0) continue;
    traces_[level] = rows.trace_at_start(level);
  }
  static_coupling_ = std::move(rows.static_coupling);
  top_coupling_ = std::move(rows.top_coupling);
  const PetscScalar lambda = shift.lambda;
  const bool generates = symmetry != Symmetry::odd && shift.tilt == 0.0;
  if (!derivative && generates && PetscRealPart(lambda) >= 0) {
    const bool nothing_killed = static_phase == StaticPhase::kept && PetscAbsScalar(lambda) == 0 &&
                                !discretisation.velocities->kills();
    require_generator(comm, {states().local_begin(), rows.row_start, rows.columns, rows.values},
                      {discretisation.velocities->keeps_origin(), nothing_killed},
                      discretisation.process);
  }
  nonzeros_ = rows.row_start.back();
  const PetscInt local = states().local_size(), all = states().global_size();
  if (petsc::ranks(comm) == 1) {
    row_start_ = std::move(rows.row_start);
    columns_ = std::move(rows.columns);
    values_ = std::move(rows.values);
    check(MatCreateSeqAIJWithArrays(comm, local, local, row_start_.data(), columns_.data(),
                                    values_.data(), matrix_.out()));
  } else {
    check(MatCreateMPIAIJWithArrays(comm, local, local, all, all, rows.row_start.data(),
                                    rows.columns.data(), rows.values.data(), matrix_.out()));
  }
  if (!derivative) attach(matrix_, data_);
  MPI_Allreduce(MPI_IN_PLACE, &nonzeros_, 1, MPIU_INT64, MPI_SUM, comm);
}

petsc::MatHandle KolmogorovOperator::shifted(PetscScalar by) const {
  petsc::MatHandle copy;
  check(MatDuplicate(matrix_, MAT_COPY_VALUES, copy.out()));
  check(MatShift(copy, by));
  auto data = std::make_shared<MatrixData>(*data_);
  data->shift.lambda += by;
  attach(copy, std::move(data));
  return copy;
}

void KolmogorovOperator::kill_in_one_state() {
  const auto& [process, noise, velocities] = discretisation();
  const auto& chain = process.noise;
  const bool forwards = process.mean_force() >= 0;
  const auto along = forwards ? process : process.mirrored();
  const Branch branch = forwards ? Branch::positive : Branch::negative;
  const int level = std::clamp(along.noise.last_up_to(along.noise.mean()), along.noise.lowest(),
                               along.noise.highest());
  const auto& nodes = nodes_along(branch);
  const int n = std::clamp(nodes.last_up_to(level), nodes.first(), nodes.last());
  const double speed =
      std::max(chain.standard_deviation() * chain.correlation_time(),
               along.drag.terminal_velocity(along.mean_force() - along.friction.at_rest()));
  const auto& speeds = velocities->nodes();
  const auto node =
      std::lower_bound(speeds.begin(), speeds.end() - 1, std::min(speed, velocities->v_max() / 2));
  const PetscInt state =
      states().index({StateKind::node, branch, n, static_cast<int>(node - speeds.begin())});
  const PetscInt begin = states().local_begin(), end = begin + states().local_size();
  if (state >= begin && state < end) {
    check(MatSetValue(matrix_, state, state, chain.rate(), ADD_VALUES));
  }
  check(MatAssemblyBegin(matrix_, MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(matrix_, MAT_FINAL_ASSEMBLY));
  killing_state_ = state;
}

petsc::VecHandle KolmogorovOperator::value_in_that_state() const {
  petsc::VecHandle g = zeros();
  const PetscInt state = killing_state_.value(), begin = states().local_begin();
  if (state >= begin && state < begin + states().local_size()) {
    check(VecSetValue(g, state, 1, INSERT_VALUES));
  }
  check(VecAssemblyBegin(g));
  check(VecAssemblyEnd(g));
  return g;
}

petsc::VecHandle KolmogorovOperator::zeros() const {
  petsc::VecHandle x;
  check(MatCreateVecs(matrix_, nullptr, x.out()));
  return x;
}

petsc::VecHandle KolmogorovOperator::trace_at_exit(Branch branch) const {
  return trace_at_start(discretisation().process.exit_level(branch == Branch::positive));
}

petsc::VecHandle KolmogorovOperator::trace_at_start(int level) const {
  petsc::VecHandle g = zeros();
  const PetscInt begin = states().local_begin(), end = begin + states().local_size();
  for (const auto& [index, weight] : traces_.at(level)) {
    if (index < begin || index >= end) continue;
    check(VecSetValue(g, index, weight, INSERT_VALUES));
  }
  check(VecAssemblyBegin(g));
  check(VecAssemblyEnd(g));
  return g;
}

void KolmogorovOperator::add_value_at(int i, double v, double weight, Vec functional) const {
  const auto& [process, noise, velocities] = discretisation();
  const int lowest = process.lowest_static();
  const bool at_rest = v == 0 && process.sticks(i);
  const bool below = v < 0 || (v == 0 && (at_rest ? i < 0 : i < lowest));
  const bool mirrored = below && states().symmetry_reduced();
  const double sign = mirrored && states().symmetry() == Symmetry::odd ? -weight : weight;
  const Branch branch = below && !mirrored ? Branch::negative : Branch::positive;
  const PetscInt begin = states().local_begin(), end = begin + states().local_size();
  const auto add = [&](const State& state, double share) {
    const PetscInt index = states().index(state);
    if (index >= begin && index < end) check(VecSetValue(functional, index, share, ADD_VALUES));
  };
  // A level as a combination of noise nodes, of those as combinations of velocity nodes.
  const auto& group =
      nodes_along(below ? Branch::negative : Branch::positive).group_at(below ? -i : i);
  const auto shares = group.row(group.value, below ? -i : i);
  for (int l = 0; !at_rest && l < group.count; ++l) {
    const int n = group.begin + l;
    if (v == 0 && states().has_origin(branch, n)) {
      add({StateKind::origin, branch, n, 0}, sign);
      continue;
    }
    for (const auto& e : v == 0 ? velocities->trace_at_zero() : velocities->value_at(std::abs(v))) {
      add({StateKind::node, branch, n, e.node}, sign * shares[l] * e.value);
    }
  }
  if (at_rest) {
    const int kept = states().symmetry_reduced() ? std::abs(i) : i;
    if (states().has_static_state(kept))
      add({StateKind::static_phase, Branch::positive, kept, 0}, sign);
  }
}

petsc::VecHandle KolmogorovOperator::value_at(int i, double v) const {
  petsc::VecHandle g = zeros();
  add_value_at(i, v, 1, g);
  check(VecAssemblyBegin(g));
  check(VecAssemblyEnd(g));
  return g;
}

petsc::VecHandle KolmogorovOperator::mean_at_zero(const std::vector<double>& p) const {
  petsc::VecHandle g = zeros();
  const auto& chain = discretisation().process.noise;
  for (int i = chain.lowest(); i <= chain.highest(); ++i) {
    add_value_at(i, 0, p[i - chain.lowest()], g);
  }
  check(VecAssemblyBegin(g));
  check(VecAssemblyEnd(g));
  return g;
}

std::vector<PetscScalar> KolmogorovOperator::entry_rates(Vec nu) const {
  const int lowest = discretisation().process.lowest_static(),
            count = discretisation().process.highest_static() - lowest + 1;
  std::vector<PetscScalar> rates(static_cast<std::size_t>(count), 0.0);
  const petsc::ReadView local(nu);
  for (const auto& c : static_coupling_) rates[c.level - lowest] += c.rate * local[c.row];
  MPI_Allreduce(MPI_IN_PLACE, rates.data(), static_cast<int>(rates.size()), MPIU_SCALAR, MPIU_SUM,
                states().comm());
  return rates;
}

petsc::VecHandle KolmogorovOperator::rates_to_top() const {
  petsc::VecHandle rates = zeros();
  petsc::WriteView local(rates);
  for (const auto& c : top_coupling_) local[c.row] += c.rate;
  return rates;
}

double KolmogorovOperator::rate_at_top(Vec nu) const { return petsc::dot(nu, rates_to_top()); }

petsc::VecHandle KolmogorovOperator::from_static(const std::vector<PetscScalar>& s) const {
  const int lowest = discretisation().process.lowest_static();
  petsc::VecHandle f = zeros();
  petsc::WriteView local(f);
  for (const auto& c : static_coupling_) local[c.row] += c.rate * s[c.level - lowest];
  return f;
}

petsc::VecHandle KolmogorovOperator::square_field(Vec u, const std::vector<double>& s) const {
  const int lowest = discretisation().process.lowest_static();
  const auto all = petsc::WholeVectors(matrix_).gathered(u);
  petsc::VecHandle f = zeros();
  petsc::WriteView local(f);
  const PetscInt begin = states().local_begin();
  const auto add = [&](PetscInt row, PetscScalar rate, PetscScalar to) {
    const PetscScalar change = to - all[begin + row];
    local[row] += rate * change * change;
  };
  for (PetscInt row = 0; row < local.size(); ++row) {
    petsc::RowView(matrix_, begin + row).for_each([&](PetscInt column, PetscScalar value) {
      add(row, -value, all[column]);
    });
  }
  for (const auto& c : static_coupling_) add(c.row, c.rate, s[c.level - lowest]);
  for (const auto& c : top_coupling_) add(c.row, c.rate, 0.0);
  return f;
}

petsc::VecHandle KolmogorovOperator::values(const Observable& f) const {
  petsc::VecHandle result = zeros();
  petsc::WriteView local(result);
  const model::NoiseChain& chain = discretisation().process.noise;
  const velocity::VelocityDiscretisation& velocities = *discretisation().velocities;
  PetscInt at = 0;
  states().for_each_local([&](const State& s) {
    const int sign = s.branch == Branch::positive ? 1 : -1;
    if (s.kind == StateKind::static_phase) {
      local[at++] = f(chain.level(s.noise), 0, 0);
      return;
    }
    double v = 0;
    if (s.kind == StateKind::node) v = sign * velocities.nodes()[s.node];
    if (s.kind == StateKind::holding) v = sign * velocities.v_max();
    local[at++] = nodes_along(s.branch).projected(
        s.noise, [&](int i) { return f(chain.level(sign * i), sign, v); });
  });
  return result;
}

petsc::VecHandle KolmogorovOperator::overlooked(const Observable& f) const {
  petsc::VecHandle result = zeros();
  petsc::WriteView local(result);
  for (const Branch branch : states().branches()) {
    const int sign = branch == Branch::positive ? 1 : -1;
    for (const int node : states().local_noise()) {
      const int n = sign * node;
      const auto [first, stride] = states().nodes_of(branch, n);
      PetscInt at = first - states().local_begin();
      const auto of_speed = [&](double speed) {
        return nodes_along(branch).projected(n, [&](int i) {
          return f(discretisation().process.noise.level(sign * i), sign, sign * speed);
        });
      };
      for (const double value : discretisation().velocities->overlooked(of_speed)) {
        local[at] = value;
        at += stride;
      }
    }
  }
  return result;
}

}  // namespace stickslip::operators
