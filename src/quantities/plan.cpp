#include "stickslip/quantities/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "stickslip/case/displacement_rows.hpp"
#include "stickslip/case/duration_rows.hpp"
#include "stickslip/case/passage_rows.hpp"
#include "stickslip/linalg/petsc.hpp"
#include "stickslip/linalg/session.hpp"
#include "stickslip/quantities/engines/excursions.hpp"
#include "stickslip/quantities/engines/propagator.hpp"

namespace stickslip::quantities {
namespace {

using cases::Quantity;

// What the results of a row are called: one for each observable, time or speed.
std::vector<std::string> keys_of(const Row& row, const cases::Question& question) {
  if (!row.is_pattern()) return {std::string(row.key)};
  std::vector<std::string> keys;
  const bool of_time = row.key.ends_with("(t)"), of_speed = row.key.ends_with("(w)");
  for (double value : of_time ? question.time : question.velocity) {
    if (of_time || of_speed) keys.push_back(row.key_of(fmt::format("{}", value)));
  }
  for (const auto& f : question.observables) {
    if (!of_time && !of_speed) keys.push_back(row.key_of(f.name));
  }
  return keys;
}

}  // namespace

std::string reason_to_go_on(MPI_Comm comm) {
  const Failure failure = linalg::failure_in_flight();
  const bool ends_all =
      failure.status() == ExitStatus::no_memory || failure.status() == ExitStatus::bad_input;
  if (linalg::ranks(comm) > 1 || ends_all) throw;
  return failure.what();
}

void attempt(const Problem& problem, Evaluation& evaluation, cases::Quantity quantity,
             const std::function<void()>& work) {
  if (evaluation.failed.contains(quantity)) return;
  try {
    work();
  } catch (...) {
    evaluation.failed[quantity] = reason_to_go_on(problem.comm);
  }
}

Results without_values(const cases::Case& given, cases::Quantity quantity,
                       const std::string& reason) {
  Results results;
  const auto& entry = **std::ranges::find(cases::entries(), quantity, &cases::Entry::quantity);
  for (const Row* row : entry.rows) {
    if (row->without.contains(given.method.route)) continue;
    for (const auto& key : keys_of(*row, given.question)) {
      Result result = array(*row, given.question.values(row->abscissa));
      result.key = key;
      result.unreached = reason;
      const std::size_t count = result.is_scalar() ? 1 : result.abscissa.size();
      for (std::size_t n = 0; n < count; ++n) append_value(result, kNoValue);
      if (count > 0) results.push_back(std::move(result));
    }
  }
  return results;
}

using Tasks = void(Planner&);

Tasks sticking_tasks, mean_slip_tasks, moments_tasks, density_tasks, averages_tasks,
    entry_law_tasks, sensitivity_tasks, stick_transform_tasks, laplace_tasks, resolvent_tasks,
    spectrum_tasks, duration_density_tasks, phase_durations_tasks, slip_tasks, peak_tasks,
    first_passage_tasks, displacement_tasks, autocorrelation_tasks, expectation_tasks,
    relaxation_tasks, noise_spectrum_tasks, large_deviation_tasks, displacement_transform_tasks,
    displacement_distribution_tasks, passage_transform_tasks, passage_distribution_tasks;

namespace {

// All that the excursion method gives, in the order of tasks and of results.
constexpr std::pair<Quantity, Tasks*> kAll[] = {
    {Quantity::sticking, sticking_tasks},
    {Quantity::slip, mean_slip_tasks},
    {Quantity::moments, moments_tasks},
    {Quantity::density, density_tasks},
    {Quantity::averages, averages_tasks},
    {Quantity::entry_law, entry_law_tasks},
    {Quantity::sensitivity, sensitivity_tasks},
    {Quantity::stick_duration_transform, stick_transform_tasks},
    {Quantity::laplace, laplace_tasks},
    {Quantity::resolvent, resolvent_tasks},
    {Quantity::spectrum, spectrum_tasks},
    {Quantity::duration_density, duration_density_tasks},
    {cases::kPhaseDurations.quantity, phase_durations_tasks},
    {Quantity::slip, slip_tasks},
    {Quantity::peak, peak_tasks},
    {cases::kFirstPassageTime.quantity, first_passage_tasks},
    {cases::kPassageTimeTransform.quantity, passage_transform_tasks},
    {cases::kPassageTimeDistribution.quantity, passage_distribution_tasks},
    {Quantity::displacement, displacement_tasks},
    {Quantity::autocorrelation, autocorrelation_tasks},
    {Quantity::expectation, expectation_tasks},
    {Quantity::relaxation, relaxation_tasks},
    {cases::own_quantity("noise_spectrum"), noise_spectrum_tasks},
    {cases::kLargeDeviation.quantity, large_deviation_tasks},
    {cases::kDisplacementTransform.quantity, displacement_transform_tasks},
    {cases::kDisplacementDistribution.quantity, displacement_distribution_tasks}};

}  // namespace

std::set<generator::SystemKey> Plan::used_from(std::size_t first) const {
  std::set<generator::SystemKey> used;
  for (std::size_t n = first; n < tasks.size(); ++n) {
    for (const Use& use : tasks[n].uses) used.insert(use.system);
  }
  return used;
}

int Plan::assemblies() const {
  return std::accumulate(tasks.begin(), tasks.end(), factorizations(),
                         [](int sum, const Task& task) { return sum + task.derivatives; });
}

int Plan::solves() const {
  int count = 0;
  for (const Task& task : tasks) {
    for (const Use& use : task.uses) count += use.forward + use.transposed;
  }
  return count;
}

bool Plan::adaptive() const { return std::ranges::any_of(tasks, &Task::adaptive); }

generator::SystemKey Planner::system(double lambda) const {
  return {lambda, generator::symmetry_of(given_.scene.process(1))};
}

void Planner::append_from(const FunctionOfExcursion& append) {
  need_distribution();
  of_excursions_.push_back(append);
}

void Planner::add_adaptive(std::string name, int factorizations, int solves, Action carry_out) {
  add({std::move(name), {}, std::move(carry_out), 0, true, factorizations, solves});
}

void Planner::add_at_each_lambda(const std::function<Task(double)>& task) {
  resolve_lambda();
  auto& tasks = plan_.tasks;
  if (at_each_lambda_++ == 0) at_lambda_ = tasks.size();
  std::size_t end = at_lambda_;
  for (double lambda : question().lambda) {
    end += at_each_lambda_;
    tasks.insert(tasks.begin() + static_cast<std::ptrdiff_t>(end - 1), of_quantity(task(lambda)));
  }
}

void Planner::resolve_lambda() {
  double& fastest = needs().rates.lambda;
  fastest = std::max(fastest, largest_size(question().lambda));
}

void Planner::resolve_speeds() { needs().rates.speed = largest_size(question().velocity); }

void Planner::resolve_times() { resolve_rate(kFastestOnContour / least_positive(question().time)); }

void Planner::resolve_rate(double rate) {
  double& fastest = needs().rates.lambda;
  if (given_.scene.meant().noise.table) fastest = std::max(fastest, rate);
}

int Planner::starts() const {
  if (symmetric()) return 1;
  return std::max(1, static_cast<int>(given_.scene.meant().starts().size()));
}

Plan Planner::plan() && {
  plan_.afterwards.insert(plan_.afterwards.end(), last_.begin(), last_.end());
  if (!needs_distribution_) return std::move(plan_);
  const auto find = [of_excursions = of_excursions_](Computation& computation) {
    const auto found = std::make_shared<StationaryDistribution>(computation.systems);
    for (const auto& append : of_excursions) found->append_from(append, computation.results());
    computation.found.distribution = found;
  };
  plan_.tasks.insert(plan_.tasks.begin(),
                     Task{"stationary distribution", {{system(), 0, starts()}}, find});
  return std::move(plan_);
}

Plan plan_of(const cases::Case& given) {
  Planner planner(given);
  if (given.scene.v_max) planner.need_distribution();  // it has the mass beyond v_max
  if (given.method.row().small_lambda) planner.resolve_lambda();
  for (const auto& [quantity, add_tasks] : kAll) {
    if (!given.question.wants(quantity)) continue;
    planner.begin(quantity);
    add_tasks(planner);
  }
  Plan plan = std::move(planner).plan();
  if (given.method.route != cases::Route::excursion) return {.needs = std::move(plan.needs)};
  return plan;
}

}  // namespace stickslip::quantities
