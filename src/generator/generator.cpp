#include "stickslip/generator/generator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "row_assembler.hpp"
#include "stickslip/linalg/session.hpp"

namespace stickslip::generator {
namespace {

using linalg::check;

using Shared = std::shared_ptr<const MatrixData>;

constexpr const char* kName = "stickslip_data";

constexpr double kRounding = 1e-12;  // of a row sum, against the diagonal
constexpr double kNegligible = 1e-9;

// Off-diagonals and their sum in one pass; the diagonal was summed in the same order.
std::string complaint(const LocalRows& rows, PetscInt r, Promise promise) {
  double diagonal = 0, others = 0, largest = -HUGE_VAL;  // off-diagonal: at most 0 if monotone
  for (PetscInt n = rows.row_start[r]; n < rows.row_start[r + 1]; ++n) {
    const double value = PetscRealPart(rows.values[n]);
    if (rows.columns[n] == rows.first + r) {
      diagonal = value;
    } else {
      others += value;
      if (!(value <= largest)) largest = value;  // NaN is kept
    }
  }
  const double sum = diagonal + others, rounding = kRounding * std::abs(diagonal);
  if (promise.monotone && !(largest <= 0)) return fmt::format("a jump rate of {:.2g}", -largest);
  if (promise.monotone && !(sum >= -rounding)) return fmt::format("a killing rate of {:.2g}", sum);
  if (promise.conservative && !(std::abs(sum) <= rounding)) {
    return fmt::format("a row sum of {:.2g}", sum);
  }
  return "";
}

std::string broken_promise(const LocalRows& rows, Promise promise) {
  for (PetscInt r = 0; r + 1 < static_cast<PetscInt>(rows.row_start.size()); ++r) {
    const bool alone = rows.row_start[r + 1] - rows.row_start[r] < 2;
    const std::string what = alone ? "" : complaint(rows, r, promise);
    if (!what.empty()) return fmt::format("the generator has {} in row {}", what, rows.first + r);
  }
  return "";
}

// Composes the data on a matrix. Not collective.
void attach(Mat matrix, Shared data) {
  const auto object = reinterpret_cast<PetscObject>(matrix);
  PetscContainer container = nullptr;
  check(PetscContainerCreate(PetscObjectComm(object), &container));
  check(PetscContainerSetPointer(container, new Shared(std::move(data))));
  check(linalg::own_contents<Shared>(container));
  check(PetscObjectCompose(object, kName, reinterpret_cast<PetscObject>(container)));
  check(PetscContainerDestroy(&container));
}

}  // namespace

Shared data_of(Mat matrix) {
  PetscObject found = nullptr;
  check(PetscObjectQuery(reinterpret_cast<PetscObject>(matrix), kName, &found));
  if (found == nullptr) return nullptr;
  void* data = nullptr;
  check(PetscContainerGetPointer(reinterpret_cast<PetscContainer>(found), &data));
  return *static_cast<Shared*>(data);
}

void require_generator(MPI_Comm comm, const LocalRows& rows, Promise promise,
                       const model::Process& process) {
  const std::string broken = broken_promise(rows, promise);
  linalg::require_everywhere(comm, broken.empty() ? "" : broken + model::please_report(process));
}

void require_occupation(Vec nu, const model::Process& process) {
  PetscReal smallest = 0, largest = 0;
  linalg::check(VecMin(nu, nullptr, &smallest));
  linalg::check(VecMax(nu, nullptr, &largest));
  if (smallest >= -kNegligible * largest) return;
  throw NotReached(fmt::format("an occupation reaches from {:.2g} to {:.2g} and must not be "
                               "negative{}",
                               smallest, largest, model::please_report(process)));
}

KolmogorovOperator::KolmogorovOperator(MPI_Comm comm, const Discretisation& discretisation,
                                       Shift<PetscScalar> shift, Symmetry symmetry,
                                       StaticPhase static_phase,
                                       const std::optional<model::Derivative>& derivative)
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
  if (linalg::ranks(comm) == 1) {
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

linalg::MatHandle KolmogorovOperator::shifted(PetscScalar by) const {
  linalg::MatHandle copy;
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
  if (states().owns(state)) check(MatSetValue(matrix_, state, state, chain.rate(), ADD_VALUES));
  check(MatAssemblyBegin(matrix_, MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(matrix_, MAT_FINAL_ASSEMBLY));
  killing_state_ = state;
}

template <class Fill>
linalg::VecHandle KolmogorovOperator::functional(Fill fill) const {
  linalg::VecHandle g = zeros();
  fill([this, &g](PetscInt state, double weight) {
    if (states().owns(state)) check(VecSetValue(g, state, weight, ADD_VALUES));
  });
  check(VecAssemblyBegin(g));
  check(VecAssemblyEnd(g));
  return g;
}

linalg::VecHandle KolmogorovOperator::value_in_that_state() const {
  return functional([this](const auto& add) { add(killing_state_.value(), 1); });
}

linalg::VecHandle KolmogorovOperator::zeros() const {
  linalg::VecHandle x;
  check(MatCreateVecs(matrix_, nullptr, x.out()));
  return x;
}

linalg::VecHandle KolmogorovOperator::trace_at_exit(Branch branch) const {
  return trace_at_start(discretisation().process.exit_level(branch == Branch::positive));
}

linalg::VecHandle KolmogorovOperator::trace_at_start(int level) const {
  return functional([&](const auto& add) {
    for (const auto& [index, weight] : traces_.at(level)) add(index, weight);
  });
}

template <class Add>
void KolmogorovOperator::add_value_at(int i, double v, double weight, const Add& add) const {
  const auto& [process, noise, velocities] = discretisation();
  const int lowest = process.lowest_static();
  const bool at_rest = v == 0 && process.sticks(i);
  const bool below = v < 0 || (v == 0 && (at_rest ? i < 0 : i < lowest));
  const bool mirrored = below && states().symmetry_reduced();
  const double sign = mirrored && states().symmetry() == Symmetry::odd ? -weight : weight;
  const Branch branch = below && !mirrored ? Branch::negative : Branch::positive;
  const auto add_state = [&](const State& state, double share) {
    add(states().index(state), share);
  };
  // A level as a combination of noise nodes, of those as combinations of velocity nodes.
  const auto& group =
      nodes_along(below ? Branch::negative : Branch::positive).group_at(below ? -i : i);
  const auto shares = group.row(group.value, below ? -i : i);
  for (int l = 0; !at_rest && l < group.count; ++l) {
    const int n = group.begin + l;
    if (v == 0 && states().has_origin(branch, n)) {
      add_state({StateKind::origin, branch, n, 0}, sign);
      continue;
    }
    for (const auto& e : v == 0 ? velocities->trace_at_zero() : velocities->value_at(std::abs(v))) {
      add_state({StateKind::node, branch, n, e.node}, sign * shares[l] * e.value);
    }
  }
  if (at_rest) {
    const int kept = states().symmetry_reduced() ? std::abs(i) : i;
    if (states().has_static_state(kept)) {
      add_state({StateKind::static_phase, Branch::positive, kept, 0}, sign);
    }
  }
}

linalg::VecHandle KolmogorovOperator::mean_at(const std::vector<double>& p, double v) const {
  const auto& chain = discretisation().process.noise;
  return functional([&](const auto& add) {
    for (int i = chain.lowest(); i <= chain.highest(); ++i) {
      const double share = p[i - chain.lowest()];
      if (share != 0) add_value_at(i, v, share, add);
    }
  });
}

std::vector<PetscScalar> KolmogorovOperator::entry_rates(Vec nu) const {
  const int lowest = discretisation().process.lowest_static(),
            count = discretisation().process.highest_static() - lowest + 1;
  std::vector<PetscScalar> rates(static_cast<std::size_t>(count), 0.0);
  const linalg::ReadView local(nu);
  for (const auto& c : static_coupling_) rates[c.level - lowest] += c.rate * local[c.row];
  linalg::sum_over_ranks(states().comm(), rates);
  return rates;
}

linalg::VecHandle KolmogorovOperator::rates_to_top() const {
  linalg::VecHandle rates = zeros();
  linalg::WriteView local(rates);
  for (const auto& c : top_coupling_) local[c.row] += c.rate;
  return rates;
}

double KolmogorovOperator::rate_at_top(Vec nu) const { return linalg::dot(nu, rates_to_top()); }

linalg::VecHandle KolmogorovOperator::from_static(const std::vector<PetscScalar>& s) const {
  const int lowest = discretisation().process.lowest_static();
  linalg::VecHandle f = zeros();
  linalg::WriteView local(f);
  for (const auto& c : static_coupling_) local[c.row] += c.rate * s[c.level - lowest];
  return f;
}

linalg::VecHandle KolmogorovOperator::square_field(Vec u, const std::vector<double>& s) const {
  const int lowest = discretisation().process.lowest_static();
  const auto all = linalg::WholeVectors(matrix_).gathered(u);
  linalg::VecHandle f = zeros();
  linalg::WriteView local(f);
  const PetscInt begin = states().local_begin();
  const auto add = [&](PetscInt row, PetscScalar rate, PetscScalar to) {
    const PetscScalar change = to - all[begin + row];
    local[row] += rate * change * change;
  };
  for (PetscInt row = 0; row < local.size(); ++row) {
    linalg::RowView(matrix_, begin + row).for_each([&](PetscInt column, PetscScalar value) {
      add(row, -value, all[column]);
    });
  }
  for (const auto& c : static_coupling_) add(c.row, c.rate, s[c.level - lowest]);
  for (const auto& c : top_coupling_) add(c.row, c.rate, 0.0);
  return f;
}

linalg::VecHandle KolmogorovOperator::values(const Observable& f, bool averaged) const {
  const model::NoiseChain& chain = discretisation().process.noise;
  std::map<std::pair<double, double>, std::vector<double>> means;  // by y and v
  const bool by_means = averaged && chain.has_means();
  const auto value = [&](int i, double y, double v) {
    if (!by_means) return f(chain.place_of(i), y, v);
    auto& known = means[{y, v}];
    if (known.empty())
      known = chain.values([&](const model::Place& x) { return f(x, y, v); }, averaged);
    return known[i - chain.lowest()];
  };
  return by_state([&](const State& s) {
    if (s.kind == StateKind::static_phase) return value(s.noise, 0, 0);
    const int sign = s.branch == Branch::positive ? 1 : -1;
    const double speed = speed_of(s, *discretisation().velocities),
                 v = speed > 0 ? sign * speed : 0;
    return nodes_along(s.branch).projected(s.noise,
                                           [&](int i) { return value(sign * i, sign, v); });
  });
}

linalg::VecHandle KolmogorovOperator::overlooked(const Observable& f) const {
  linalg::VecHandle result = zeros();
  linalg::WriteView local(result);
  for (const Branch branch : states().branches()) {
    const int sign = branch == Branch::positive ? 1 : -1;
    for (const int node : states().local_noise()) {
      const int n = sign * node;
      const auto [first, stride] = states().nodes_of(branch, n);
      PetscInt at = first - states().local_begin();
      const auto of_speed = [&](double speed) {
        return nodes_along(branch).projected(n, [&](int i) {
          return f(discretisation().process.noise.place_of(sign * i), sign, sign * speed);
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

}  // namespace stickslip::generator
