#pragma once
/// All that is asked for, on one discretisation, by the route asked for.

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "stickslip/model/process.hpp"
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
  std::unique_ptr<quantities::StationaryLaw> law;     ///< excursion route, if it was needed
  std::vector<quantities::RelaxationMode> even, odd;  ///< modes, if asked for
};

/// Assembles, factors and solves what the request needs and nothing else. Collective. Throws
/// NotReached or NoMemory.
[[nodiscard]] Evaluation evaluate(const Setting& setting);

}  // namespace stickslip::routes
