#pragma once
/// What is assembled, factored and solved on each discretisation, derived from the question.

#include <set>
#include <string>
#include <vector>

#include "stickslip/cases/case.hpp"
#include "stickslip/operators/system_key.hpp"

namespace stickslip::routes {

/// What a task computes.
enum class Work {
  stationary_distribution,    ///< occupations, and with them sticking, moments and density
  averages,                   ///< of observables
  orientation,                ///< the hitting distribution, which is no even functional
  sensitivity,                ///< adjoints of the scalars
  duration_moments,           ///< variances of durations
  duration_transforms,        ///< of one lambda
  stick_duration_transforms,  ///< F_stick by itself
  resolvent,                  ///< of one lambda
  spectrum,
  durations,          ///< densities and distribution functions
  slips,              ///< variances of path lengths and net displacements
  slip_transform,     ///< of one inverse distance
  slip_distribution,  ///< density and distribution function
  first_passage,      ///< to one speed
  displacement,
  autocorrelation,
  expectation,
  relaxation
};

/// A system that a task solves with, and the right-hand sides.
struct Use {
  operators::SystemKey system;
  int forward = 0, transposed = 0;
};

struct Task {
  Work work;
  std::size_t at = 0;  ///< index of its lambda, inverse distance or speed
  std::vector<Use> uses = {};
  int derivatives = 0;  ///< of the operator, assembled and not factored
  /// Whether it makes operators and factorisations of its own besides, as many as its accuracy
  /// asks for: rational Krylov models, eigensolvers, time steps.
  bool adaptive = false;
  int usual_factorizations = 0, usual_solves = 0;  ///< of an adaptive task, for predictions
};

/// Tasks in the order of execution. Each system is assembled and factored when the first task asks
/// for it, and freed after the last one has used it.
struct Plan {
  std::vector<Task> tasks;

  /// Each system once.
  [[nodiscard]] std::set<operators::SystemKey> systems() const;
  /// Systems that tasks from number `first` on use.
  [[nodiscard]] std::set<operators::SystemKey> used_from(std::size_t first) const;
  /// Operators assembled, systems factored and right-hand sides solved for by all tasks; of the
  /// adaptive ones only what is known before.
  [[nodiscard]] int assemblies() const;
  [[nodiscard]] int factorizations() const;
  [[nodiscard]] int solves() const;
  [[nodiscard]] bool adaptive() const;
};

/// The least set of work for the quantities asked for. Solution methods other than excursion do one
/// thing each, and their plan is empty. Local.
[[nodiscard]] Plan plan_of(const cases::Case& given);

/// "stationary distribution", "resolvent at lambda = 0.5".
[[nodiscard]] std::string task_name(const cases::Question& question, const Task& task);

}  // namespace stickslip::routes
