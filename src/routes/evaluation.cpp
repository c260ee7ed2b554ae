#include "stickslip/routes/evaluation.hpp"

#include "routes.hpp"

namespace stickslip::routes {

Evaluation evaluate(const Problem& problem) {
  switch (problem.given.method.route) {
  case catalogue::Route::excursion: return by_excursion(problem);
  case catalogue::Route::lambda: return by_lambda(problem);
  case catalogue::Route::hitting: return by_hitting(problem);
  case catalogue::Route::null_vector: return by_null_vector(problem);
  case catalogue::Route::fluid_queue: return by_fluid_queue(problem);
  case catalogue::Route::monte_carlo: break;  // has no discretisation
  }
  return {};
}

}  // namespace stickslip::routes
