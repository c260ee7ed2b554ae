#pragma once
/// What is assembled, factored and solved on each discretisation, derived from the question.

#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "stickslip/cases/case.hpp"
#include "stickslip/operators/system_key.hpp"
#include "stickslip/quantities/computation.hpp"
#include "stickslip/quantities/excursion.hpp"
#include "stickslip/velocity/mesh.hpp"

namespace stickslip::quantities {

/// A system that a task solves with, and the right-hand sides.
struct Use {
  operators::SystemKey system;
  int forward = 0, transposed = 0;
};

using Action = std::function<void(Computation&)>;

struct Task {
  std::string name;  ///< "stationary distribution", "resolvent at lambda = 0.5"
  std::vector<Use> uses = {};
  Action carry_out = {};  ///< collective
  int derivatives = 0;    ///< of the operator, assembled and not factored
  /// Whether it makes operators and factorisations of its own besides, as many as its accuracy
  /// asks for: rational Krylov models, eigensolvers, time steps.
  bool adaptive = false;
  int usual_factorizations = 0, usual_solves = 0;  ///< of an adaptive task, for predictions
  /// Whose results it gives; all rest on a task of none.
  std::optional<catalogue::Quantity> quantity = {};
};

/// What tasks need resolved by the discretisation.
struct Needs {
  velocity::Rates rates = {};      ///< of the equations to be solved
  double phase = 0;                ///< largest p of solutions exp(i p v) [1/velocity]
  std::vector<double> omega = {};  ///< of solutions that may oscillate in v [1/time]
  bool modes = false;              ///< eigenvectors, which reach further than the density
};

/// Tasks in the order of execution. Each system is assembled and factored when the first task asks
/// for it, and freed after the last one has used it.
struct Plan {
  std::vector<Task> tasks = {};
  std::vector<Task> afterwards = {};  ///< what appends results that several tasks have found
  Needs needs = {};

  /// Each system once.
  [[nodiscard]] std::set<operators::SystemKey> systems() const { return used_from(0); }
  /// Systems that tasks from number `first` on use.
  [[nodiscard]] std::set<operators::SystemKey> used_from(std::size_t first) const;
  /// Operators assembled, systems factored and right-hand sides solved for by all tasks; of the
  /// adaptive ones only what is known before.
  [[nodiscard]] int assemblies() const;
  [[nodiscard]] int factorizations() const { return static_cast<int>(systems().size()); }
  [[nodiscard]] int solves() const;
  [[nodiscard]] bool adaptive() const;
};

/// The least set of work for the quantities asked for. Solution methods other than excursion do one
/// thing each, and their plan has no tasks. Local.
[[nodiscard]] Plan plan_of(const cases::Case& given);

/// Collects the tasks of quantities. Each quantity is a function in a file of its own that adds
/// what it takes; plan.cpp lists them.
class Planner {
 public:
  explicit Planner(const cases::Case& given) : given_(given) {}

  [[nodiscard]] const cases::Case& given() const { return given_; }
  [[nodiscard]] const cases::Question& question() const { return given_.question; }
  [[nodiscard]] bool symmetric() const { return given_.scene.symmetric(); }
  /// From how many levels excursions start; with symmetry, on one side. At least 1.
  [[nodiscard]] int starts() const;
  /// The system of the stationary distribution, and the same at another lambda.
  [[nodiscard]] operators::SystemKey system(double lambda = 0) const;

  /// Has the stationary distribution found before all else.
  void need_distribution() { needs_distribution_ = true; }
  /// What follows from means over excursions is appended with the stationary distribution.
  void append_from(const FunctionOfExcursion& append);
  void add(Task task) { plan_.tasks.push_back(of_quantity(std::move(task))); }
  /// What the discretisation has to resolve; each quantity raises it to what it needs.
  [[nodiscard]] Needs& needs() { return plan_.needs; }
  /// Has all -lambda resolved, or passages of all -velocity.
  void resolve_lambda();
  void resolve_speeds();
  /// Has a function of time resolved from the first of -time on, by its inverse Laplace transform.
  void resolve_times();
  /// Has rates of such transforms resolved where the noise is a table: levels of -delta smooth what
  /// finer elements would resolve, those of a table are few.
  void resolve_rate(double rate);
  /// One with operators of its own, which carry the static states or are projected. The numbers are
  /// those seen in most of thirty cases, in solves with iterative refinement.
  void add_adaptive(std::string name, int factorizations, int solves, Action carry_out);
  /// One for each lambda of the question. What all quantities do at one lambda is done in turn, as
  /// they share its systems, which the discretisation resolves.
  void add_at_each_lambda(const std::function<Task(double lambda)>& task);
  /// Values that tasks find one at a time. They are appended together after all tasks, if there are
  /// any; `last`: behind those of other quantities.
  template <class Value>
  [[nodiscard]] std::shared_ptr<std::vector<Value>>
  collect(const std::function<void(const Computation&, const std::vector<Value>&)>& append,
          bool last = false) {
    auto values = std::make_shared<std::vector<Value>>();
    auto& actions = last ? last_ : plan_.afterwards;
    const auto carry_out = [=](const Computation& computation) {
      if (!values->empty()) append(computation, std::exchange(*values, {}));
    };
    actions.push_back(of_quantity({.name = {}, .carry_out = carry_out}));
    return values;
  }

  /// Whose tasks follow.
  void begin(catalogue::Quantity quantity) { quantity_ = quantity; }
  /// All that has been added.
  [[nodiscard]] Plan plan() &&;

 private:
  [[nodiscard]] Task of_quantity(Task task) const {
    task.quantity = quantity_;
    return task;
  }

  const cases::Case& given_;
  Plan plan_;
  std::optional<catalogue::Quantity> quantity_;
  std::vector<Task> last_;
  bool needs_distribution_ = false;
  std::vector<FunctionOfExcursion> of_excursions_;
  // The place of the tasks at the first lambda, and how many there are at each.
  std::size_t at_lambda_ = 0, at_each_lambda_ = 0;
};

}  // namespace stickslip::quantities
