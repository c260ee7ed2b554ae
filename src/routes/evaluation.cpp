#include "stickslip/routes/evaluation.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "routes.hpp"

namespace stickslip::routes {
namespace {

using catalogue::Route;

struct Computation {
  Route route;
  Evaluation (*evaluate)(const Problem&);
};

// All methods that have a discretisation, each in a file of its own.
constexpr Computation kComputations[] = {{Route::excursion, by_excursion},
                                         {Route::lambda, by_lambda},
                                         {Route::hitting, by_hitting},
                                         {Route::null_vector, by_null_vector},
                                         {Route::fluid_queue, by_fluid_queue}};

}  // namespace

Evaluation evaluate(const Problem& problem) {
  for (const auto& [route, evaluate_by] : kComputations) {
    if (route == problem.given.method.route) return evaluate_by(problem);
  }
  throw std::logic_error(
      fmt::format("-route {} works on no discretisation", problem.given.method.row().word));
}

}  // namespace stickslip::routes
