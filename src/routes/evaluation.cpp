#include "stickslip/routes/evaluation.hpp"

#include "routes.hpp"

namespace stickslip::routes {

Evaluation evaluate(const Setting& setting) {
  switch (setting.given.method.route) {
  case catalogue::Route::excursion: return by_excursion(setting);
  case catalogue::Route::lambda: return by_lambda(setting);
  case catalogue::Route::hitting: return by_hitting(setting);
  case catalogue::Route::null_vector: return by_null_vector(setting);
  case catalogue::Route::fluid_queue: return by_fluid_queue(setting);
  case catalogue::Route::monte_carlo: break;  // has no discretisation
  }
  return {};
}

}  // namespace stickslip::routes
