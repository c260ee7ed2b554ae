#pragma once
/// All that is asked for, on one discretisation, by the route asked for.

#include <mpi.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "stickslip/model/process.hpp"
#include "stickslip/operators/system_key.hpp"
#include "stickslip/options/request.hpp"
#include "stickslip/petsc/ledger.hpp"
#include "stickslip/petsc/solver_choice.hpp"
#include "stickslip/quantities/relaxation.hpp"
#include "stickslip/quantities/results.hpp"
#include "stickslip/velocity/axis.hpp"

namespace stickslip::quantities {
class StationaryLaw;
}

namespace stickslip::routes {

/// One discretisation of the scene of a request.
struct Setting {
  MPI_Comm comm;
  const options::Request& request;
  model::Process process;
  std::shared_ptr<const velocity::Axis> axis;  ///< none for the fluid queue
  petsc::Ledger& ledger;
};

struct Evaluation {
  /// Errors are those of the route on this discretisation: rounding, and the bias of small lambda.
  quantities::Results results;
  /// What the route tells about itself, by name, such as the lambda it used.
  std::vector<std::pair<std::string, double>> checks;
  std::shared_ptr<quantities::StationaryLaw> law;     ///< excursion route, if it was needed
  std::vector<quantities::RelaxationMode> even, odd;  ///< modes, if asked for
};

/// Assembles, factors and solves what the request needs and nothing else. Collective. Throws
/// NotReached or NoMemory.
[[nodiscard]] Evaluation evaluate(const Setting& setting);

/// Assembles the system of a key, for iteration if `iterates`, and has its solver analyse it;
/// nothing is factored. Sizes and times go to the ledger. Collective. Throws NoMemory.
[[nodiscard]] petsc::Analysis analyse(const Setting& setting, const operators::SystemKey& key,
                                      bool iterates);

/// Assembles the system of the stationary law without its transport and jumps, as nested
/// evaluations do, and enters it in the ledger. Collective.
void assemble_by_elements(const Setting& setting);

/// The same on a discretisation and then on finer ones with the same elements and levels and higher
/// degrees, each from the law found before: through the factors of the first one, if it has any, in
/// less than half of its time; by iteration with the same coarse factors otherwise.
class NestedEvaluation {
 public:
  /// Factors and solves on the coarse discretisation. The request and the ledger must outlive this
  /// object. Collective. Throws as evaluate().
  explicit NestedEvaluation(const Setting& coarse);
  ~NestedEvaluation();
  NestedEvaluation(const NestedEvaluation&) = delete;
  NestedEvaluation& operator=(const NestedEvaluation&) = delete;

  [[nodiscard]] Evaluation coarse() const;
  /// Errors of the route include what the cycles of a NestedSystem leave. Collective. Throws
  /// NotReached, for one if they do not converge, or NoMemory.
  [[nodiscard]] Evaluation finer(const Setting& setting);

 private:
  class Systems;
  std::unique_ptr<Systems> systems_;
};

}  // namespace stickslip::routes
