#include "stickslip/quantities/plan.hpp"

#include <algorithm>
#include <numeric>

#include "stickslip/catalogue/displacement_distribution_keys.hpp"
#include "stickslip/catalogue/displacement_transform_keys.hpp"
#include "stickslip/catalogue/first_passage_keys.hpp"
#include "stickslip/catalogue/large_deviation_keys.hpp"
#include "stickslip/catalogue/passage_distribution_keys.hpp"
#include "stickslip/catalogue/phase_durations_keys.hpp"
#include "stickslip/quantities/stationary.hpp"
#include "stickslip/quantities/time_functions.hpp"

namespace stickslip::quantities {

using catalogue::Quantity;
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
    {catalogue::kPhaseDurations.quantity, phase_durations_tasks},
    {Quantity::slip, slip_tasks},
    {Quantity::peak, peak_tasks},
    {catalogue::kFirstPassageTime.quantity, first_passage_tasks},
    {catalogue::kPassageTimeTransform.quantity, passage_transform_tasks},
    {catalogue::kPassageTimeDistribution.quantity, passage_distribution_tasks},
    {Quantity::displacement, displacement_tasks},
    {Quantity::autocorrelation, autocorrelation_tasks},
    {Quantity::expectation, expectation_tasks},
    {Quantity::relaxation, relaxation_tasks},
    {catalogue::own_quantity("noise_spectrum"), noise_spectrum_tasks},
    {catalogue::kLargeDeviation.quantity, large_deviation_tasks},
    {catalogue::kDisplacementTransform.quantity, displacement_transform_tasks},
    {catalogue::kDisplacementDistribution.quantity, displacement_distribution_tasks}};

}  // namespace

std::set<operators::SystemKey> Plan::used_from(std::size_t first) const {
  std::set<operators::SystemKey> used;
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

operators::SystemKey Planner::system(double lambda) const {
  return {lambda, operators::symmetry_of(given_.scene.process(1))};
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
  if (given.method.route != catalogue::Route::excursion) return {.needs = std::move(plan.needs)};
  return plan;
}

}  // namespace stickslip::quantities
