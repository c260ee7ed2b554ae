#include "stickslip/routes/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <numeric>

#include "stickslip/effects/effect.hpp"
#include "stickslip/quantities/sensitivity.hpp"

namespace stickslip::routes {
namespace {

using cases::Case;
using catalogue::Quantity;
using operators::Symmetry;

// Anything but resolvents, modes and closed forms.
bool needs_distribution(const Case& given) {
  for (Quantity q : {Quantity::sticking, Quantity::moments, Quantity::averages, Quantity::entry_law,
                     Quantity::density, Quantity::laplace, Quantity::stick_duration_transform,
                     Quantity::spectrum, Quantity::duration_density, Quantity::slip,
                     Quantity::autocorrelation, Quantity::displacement, Quantity::expectation}) {
    if (given.question.wants(q)) return true;
  }
  // The shares of both sides.
  if (given.question.wants(Quantity::peak) && !given.scene.symmetric()) return true;
  return given.scene.v_max.has_value();  // the mass beyond v_max follows from the distribution
}

/// Collects the tasks in their order.
class Planner {
 public:
  explicit Planner(const Case& given) : given_(given), question_(given.question) {}

  Plan plan() {
    if (needs_distribution(given_)) plan_distribution();
    if (question_.wants(Quantity::sensitivity)) plan_sensitivity();
    plan_transforms();
    if (question_.wants(Quantity::spectrum)) plan_spectrum();
    const auto observables = static_cast<int>(question_.observables.size());
    if (question_.wants(Quantity::duration_density)) add_adaptive(Work::durations, 14, 160);
    if (question_.wants(Quantity::slip)) plan_slips();
    if (question_.wants(Quantity::peak)) plan_peaks();
    if (question_.wants(Quantity::displacement)) plan_displacement();
    if (question_.wants(Quantity::autocorrelation)) add_adaptive(Work::autocorrelation, 6, 36);
    if (question_.wants(Quantity::expectation)) {
      add_adaptive(Work::expectation, 6 * observables, 36 * observables);
    }
    const int sectors = symmetric_ ? 2 : 1;
    if (question_.wants(Quantity::relaxation)) {
      add_adaptive(Work::relaxation, sectors, 28 * sectors);
    }
    return std::move(plan_);
  }

 private:
  void add(Task task) { plan_.tasks.push_back(std::move(task)); }

  // With operators of its own, which carry the static states or are projected; the numbers are
  // those seen in most of thirty cases, in solves with iterative refinement.
  void add_adaptive(Work work, int factorizations, int solves) {
    Task task{work};
    task.adaptive = true;
    task.usual_factorizations = factorizations;
    task.usual_solves = solves;
    add(std::move(task));
  }

  void plan_distribution() {
    add({Work::stationary_distribution,
         0,
         {{ground(), 0, symmetric_ || !given_.scene.meant().sticks() ? 1 : 2}}});
    if (question_.wants(Quantity::averages)) add({Work::averages, 0, {{ground(), 0, 0}}});
    if (!question_.wants(Quantity::entry_law)) return;
    Task orientation{Work::orientation};
    if (symmetric_) orientation.uses = {{{0, Symmetry::odd}, 0, 1}};
    add(std::move(orientation));
  }

  // Adjoints of mean_slide and mean_stick, which every derivative needs, and of three moments.
  // With a single static level mean_stick needs none.
  void plan_sensitivity() {
    const bool moments = question_.wants(Quantity::moments);
    if (!moments && !question_.wants(Quantity::sticking)) return;
    const int durations = given_.scene.meant().highest_static() > 0 ? 2 : 1;
    // Without symmetry the side of the next excursion, and E_V.
    const int sides = symmetric_ ? 0 : 1;
    const int adjoints = durations + sides + (moments ? 3 + sides : 0);
    Task task{Work::sensitivity, 0, {{ground(), adjoints, 0}}};
    task.derivatives = static_cast<int>(effects::derivatives_of(given_.scene).size());
    add(std::move(task));
  }

  void plan_transforms() {
    const bool laplace = question_.wants(Quantity::laplace);
    if (question_.wants(Quantity::stick_duration_transform) && !laplace)
      add({Work::stick_duration_transforms});
    if (laplace) add({Work::duration_moments, 0, {{ground(), 4, 0}}});
    if (!laplace && !question_.wants(Quantity::resolvent)) return;
    for (std::size_t n = 0; n < question_.lambda.size(); ++n) {
      const double lambda = question_.lambda[n];
      if (laplace) add({Work::duration_transforms, n, {{{lambda, ground().symmetry}, 2, 0}}});
      if (question_.wants(Quantity::resolvent)) add(resolvent(n));
    }
  }

  // Both sectors for the exits, the even one for their discounted time.
  [[nodiscard]] Task resolvent(std::size_t n) const {
    const double lambda = question_.lambda[n];
    const auto& f = question_.observables;
    if (!symmetric_) {
      return {Work::resolvent, n, {{{lambda, Symmetry::none}, 3 + static_cast<int>(f.size()), 0}}};
    }
    const int even = 2 + observables_with(&model::Observable::even);
    const int odd = 1 + observables_with(&model::Observable::odd);
    return {Work::resolvent,
            n,
            {{{lambda, Symmetry::even}, even, 0}, {{lambda, Symmetry::odd}, odd, 0}}};
  }

  void plan_slips() {
    Task moments{Work::slips, 0, {{ground(), symmetric_ ? 3 : 4, 0}}};
    if (symmetric_) moments.uses.push_back({{0, Symmetry::odd}, 1, 0});
    add(std::move(moments));
    for (std::size_t n = 0; n < question_.inverse_distance.size(); ++n) {
      auto system = ground();
      system.lambda = question_.inverse_distance[n];
      system.clock = operators::Clock::path_length;
      add({Work::slip_transform, n, {{system, 1, 0}}});
    }
    if (!question_.distance.empty()) add_adaptive(Work::slip_distribution, 6, 80);
  }

  // From each side, and from rest.
  void plan_peaks() {
    for (std::size_t n = 0; n < question_.velocity.size(); ++n) {
      auto system = ground();
      system.speed_limit = question_.velocity[n];
      add({Work::first_passage, n, {{system, 0, symmetric_ ? 2 : 3}}});
    }
  }

  void plan_displacement() {
    const bool stationary = question_.start.kind == model::Start::Kind::stationary;
    add_adaptive(Work::displacement, stationary ? 6 : 12, stationary ? 36 : 200);
  }

  void plan_spectrum() {
    if (given_.method.spectrum_solver == cases::SpectrumSolver::direct) {
      const int frequencies = static_cast<int>(question_.omega.size()) + 1;  // and 0
      add_adaptive(Work::spectrum, frequencies + 1,
                   frequencies + 1);  // and the stationary distribution alone
    } else {
      add_adaptive(Work::spectrum, 2, 18);
    }
  }

  // How many observables have a part of that symmetry, as far as a sample of states shows; the
  // others are not solved for.
  [[nodiscard]] int observables_with(double (model::Observable::*part)(double, double, double)
                                         const) const {
    const auto& f = question_.observables;
    return static_cast<int>(std::count_if(f.begin(), f.end(), [&](const model::Observable& g) {
      const auto process = given_.scene.meant();
      const int last = std::min(3 * process.highest_static() + 3, process.noise.highest());
      for (int i = 0; i <= last; ++i) {
        const double x = process.noise.level(i);
        if (i <= process.highest_static() && (g.*part)(x, 0, 0) != 0) return true;
        for (double v : {0.01, 0.3, 2.0}) {
          if ((g.*part)(x, 1, v) != 0 || (g.*part)(-x, 1, v) != 0) return true;
        }
      }
      return false;
    }));
  }

  // The system of the stationary distribution.
  [[nodiscard]] operators::SystemKey ground() const {
    return {0, operators::symmetry_of(given_.scene.process(1))};
  }

  const Case& given_;
  const cases::Question& question_;
  const bool symmetric_ = given_.scene.symmetric();
  Plan plan_;
};

}  // namespace

std::set<operators::SystemKey> Plan::systems() const { return used_from(0); }

std::set<operators::SystemKey> Plan::used_from(std::size_t first) const {
  std::set<operators::SystemKey> used;
  for (std::size_t n = first; n < tasks.size(); ++n) {
    for (const Use& use : tasks[n].uses) used.insert(use.system);
  }
  return used;
}

int Plan::factorizations() const { return static_cast<int>(systems().size()); }

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

bool Plan::adaptive() const {
  return std::any_of(tasks.begin(), tasks.end(), [](const Task& task) { return task.adaptive; });
}

Plan plan_of(const Case& given) {
  if (given.method.route != catalogue::Route::excursion) return {};
  return Planner(given).plan();
}

std::string task_name(const cases::Question& question, const Task& task) {
  const auto at_lambda = [&](const char* what) {
    return fmt::format("{} at lambda = {:g}", what, question.lambda[task.at]);
  };
  switch (task.work) {
  case Work::stationary_distribution: return "stationary distribution";
  case Work::averages: return "averages";
  case Work::orientation: return "hitting distribution (entry_law)";
  case Work::sensitivity: return "sensitivity";
  case Work::duration_moments: return "moments of durations";
  case Work::duration_transforms: return at_lambda("Laplace transforms");
  case Work::stick_duration_transforms: return "Laplace transforms of sticking phases";
  case Work::resolvent: return at_lambda("resolvent");
  case Work::spectrum: return "spectrum";
  case Work::durations: return "distributions of durations";
  case Work::slips: return "moments of slips";
  case Work::slip_transform:
    return fmt::format("transform of slips at s = {:g}", question.inverse_distance[task.at]);
  case Work::slip_distribution: return "distribution of slips";
  case Work::first_passage:
    return fmt::format("first passage to |v| = {:g}", question.velocity[task.at]);
  case Work::displacement: return "displacement";
  case Work::autocorrelation: return "autocorrelation";
  case Work::expectation: return "expectations";
  case Work::relaxation: return "relaxation modes";
  }
  return "";
}

}  // namespace stickslip::routes
