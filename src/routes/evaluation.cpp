#include "stickslip/routes/evaluation.hpp"

#include "routes.hpp"

namespace stickslip::routes {

Evaluation evaluate(const Setting& setting) {
  switch (setting.given.method.route) {
  case options::Route::excursion: return by_excursion(setting);
  case options::Route::lambda: return by_lambda(setting);
  case options::Route::hitting: return by_hitting(setting);
  case options::Route::null_vector: return by_null_vector(setting);
  case options::Route::fluid_queue: return by_fluid_queue(setting);
  case options::Route::monte_carlo: break;  // has no discretisation
  }
  return {};
}

}  // namespace stickslip::routes
