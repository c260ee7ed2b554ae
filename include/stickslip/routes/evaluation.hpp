#pragma once
/// All that is asked for, on one discretisation, by the route asked for.

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "stickslip/model/process.hpp"
#include "stickslip/operators/systems.hpp"
#include "stickslip/options/request.hpp"
#include "stickslip/petsc/ledger.hpp"
#include "stickslip/quantities/relaxation.hpp"
#include "stickslip/quantities/results.hpp"
#include "stickslip/quantities/stationary.hpp"
#include "stickslip/velocity/axis.hpp"

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

/// The same on a discretisation and then on finer ones with the same elements and levels and higher
/// degrees, each from the law found before: through the factors of the first one, if it has any, in
/// less than half of its time; by iteration with the same coarse factors otherwise.
class NestedEvaluation {
 public:
  /// Factors and solves on the coarse discretisation. The request and the ledger must outlive this
  /// object. Collective. Throws as evaluate().
  explicit NestedEvaluation(const Setting& coarse);

  [[nodiscard]] Evaluation coarse() const;
  /// Errors of the route include what the cycles of a NestedSystem leave. Collective. Throws
  /// NotReached, for one if they do not converge, or NoMemory.
  [[nodiscard]] Evaluation finer(const Setting& setting);

 private:
  const options::Request& request_;
  operators::Systems systems_;
  std::shared_ptr<quantities::StationaryLaw> law_;
  bool iterates_;
  std::shared_ptr<operators::CoarseSystem> coarse_;  // of the last step, if it iterated
};

}  // namespace stickslip::routes
