#pragma once
/// What is assembled, factored and solved on each discretisation, derived from the question.

#include <mpi.h>

#include <complex>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "stickslip/case/case.hpp"
#include "stickslip/generator/discretisation.hpp"
#include "stickslip/generator/system_key.hpp"
#include "stickslip/generator/velocity_mesh.hpp"
#include "stickslip/linalg/solver_statistics.hpp"
#include "stickslip/quantities/excursion.hpp"
#include "stickslip/quantities/relaxation.hpp"
#include "stickslip/quantities/results.hpp"

namespace stickslip::quantities {

// What reduced models on one refinement level tell those on the next one.

/// How a model was made: shifts with their numbers of pairs, in order, and points of interpolation.
/// On the next refinement level the same model is made at once.
struct Recipe {
  struct Step {
    std::complex<double> z;
    int pairs = 0;
  };
  std::vector<Step> steps;
  /// What true solutions have shown: |H - H_r| in units of |r_b| |r_c|/|z|, and of |H|.
  struct Scale {
    std::complex<double> z;
    double beside_residuals, relative;
  };
  std::vector<Scale> scales;
  bool verified = false;  ///< by until_still(), at both ends
};

/// By name of what the model is of.
using Recipes = std::map<std::string, Recipe>;

/// The tolerance of reduced models, and how those of coarser discretisations were made.
struct ModelTolerance {
  // NOLINTNEXTLINE(google-explicit-constructor): a number is a tolerance
  ModelTolerance(double tolerance, std::shared_ptr<Recipes> known = std::make_shared<Recipes>())
      : value(tolerance), recipes(std::move(known)) {}
  [[nodiscard]] Recipe& recipe(const std::string& name) const { return (*recipes)[name]; }

  double value;
  std::shared_ptr<Recipes> recipes;
};

// A case on one discretisation, what is found of it, and what tasks have at hand.

class StationaryDistribution;

/// A case on one discretisation.
struct Problem {
  MPI_Comm comm;
  const cases::Case& given;
  generator::Discretisation discretisation;
  linalg::SolverStatistics& statistics;
  /// Of reduced models, from one refinement level to the next.
  std::shared_ptr<Recipes> recipes = std::make_shared<Recipes>();
  /// By frequencies whose waves need elements of their own.
  std::map<double, generator::Discretisation> waves = {};
};

struct Evaluation {
  /// Errors are those of the solution method on this discretisation: rounding, and the bias of
  /// small lambda.
  Results results;
  std::vector<Check> checks;  ///< what the solution method reports of itself
  std::shared_ptr<StationaryDistribution> distribution;  ///< of method excursion, if it was needed
  std::vector<RelaxationSector> modes;                   ///< if asked for
  /// Why quantities have no results.
  std::map<cases::Quantity, std::string> failed = {};
  std::string missed = {};  ///< why some points of others have none
};

/// What the exception in flight says. Throws it again where others must not go on: without memory,
/// for bad input, and on several ranks, of which one may fail alone. Called in a catch block.
[[nodiscard]] std::string reason_to_go_on(MPI_Comm comm);

/// Does the work for a quantity, unless that has failed. What fails there leaves all others alone,
/// as far as reason_to_go_on() allows. Results of a quantity that has failed are of no use.
void attempt(const Problem& problem, Evaluation& evaluation, cases::Quantity quantity,
             const std::function<void()>& work);

/// The results of a quantity that has failed, without values, as far as their arguments are known.
[[nodiscard]] Results without_values(const cases::Case& given, cases::Quantity quantity,
                                     const std::string& reason);

/// What a task works with, and adds to. Tasks that need the stationary distribution find it there.
struct Computation {
  const Problem& problem;
  generator::Systems& systems;
  Evaluation& found;

  [[nodiscard]] const cases::Question& question() const { return problem.given.question; }
  [[nodiscard]] const model::Process& process() const { return problem.discretisation.process; }
  [[nodiscard]] const StationaryDistribution& distribution() const { return *found.distribution; }
  [[nodiscard]] Results& results() const { return found.results; }
  /// What `find` returns, or `none`, which has no values, where it fails.
  template <class Value, class Find>
  [[nodiscard]] Value value_or(Value none, const Find& find) const {
    try {
      return find();
    } catch (...) {
      found.missed = "has no value: " + reason_to_go_on(problem.comm);
      return none;
    }
  }
  void report(const char* name, double value, std::string_view meaning) const {
    found.checks.push_back({name, value, meaning});
  }
  /// A tenth of the accuracy, so that reduced models do not rule the error.
  [[nodiscard]] ModelTolerance tolerance() const {
    return {0.1 * question().accuracy, problem.recipes};
  }
};

/// A system that a task solves with, and the right-hand sides.
struct Use {
  generator::SystemKey system;
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
  std::optional<cases::Quantity> quantity = {};
};

/// What tasks need resolved by the discretisation.
struct Needs {
  generator::Rates rates = {};     ///< of the equations to be solved
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
  [[nodiscard]] std::set<generator::SystemKey> systems() const { return used_from(0); }
  /// Systems that tasks from number `first` on use.
  [[nodiscard]] std::set<generator::SystemKey> used_from(std::size_t first) const;
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

/// Collects the tasks of quantities. Each quantity is a function that adds what it takes; plan.cpp
/// lists them.
class Planner {
 public:
  explicit Planner(const cases::Case& given) : given_(given) {}

  [[nodiscard]] const cases::Case& given() const { return given_; }
  [[nodiscard]] const cases::Question& question() const { return given_.question; }
  [[nodiscard]] bool symmetric() const { return given_.scene.symmetric(); }
  /// From how many levels excursions start; with symmetry, on one side. At least 1.
  [[nodiscard]] int starts() const;
  /// The system of the stationary distribution, and the same at another lambda.
  [[nodiscard]] generator::SystemKey system(double lambda = 0) const;

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
  void begin(cases::Quantity quantity) { quantity_ = quantity; }
  /// All that has been added.
  [[nodiscard]] Plan plan() &&;

 private:
  [[nodiscard]] Task of_quantity(Task task) const {
    task.quantity = quantity_;
    return task;
  }

  const cases::Case& given_;
  Plan plan_;
  std::optional<cases::Quantity> quantity_;
  std::vector<Task> last_;
  bool needs_distribution_ = false;
  std::vector<FunctionOfExcursion> of_excursions_;
  // The place of the tasks at the first lambda, and how many there are at each.
  std::size_t at_lambda_ = 0, at_each_lambda_ = 0;
};

}  // namespace stickslip::quantities
