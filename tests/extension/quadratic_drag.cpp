#include <fmt/format.h>

#include "all.hpp"

namespace stickslip::effects {
namespace {

constexpr const char* kQuadratic = "drag_quadratic";

void read_quadratic_drag(Given& given, model::Scene& scene) {
  scene.drag = {0, 0};
  scene.own.emplace_back(kQuadratic, given.real(kQuadratic));
}

bool make_quadratic_drag(Given& given, model::Scene& scene) {
  const double c = std::get<double>(own_value(scene, kQuadratic));
  return set_drag(given, scene, kQuadratic, fmt::format("-{}*v*abs(v)", c));
}

}  // namespace

const Effect kQuadraticDrag{
    .word = "quadratic",
    .sentence = "-c2 v |v|",
    .others = {"newton"},
    .parameters = {{Option::real(kQuadratic, "1/length", "1", Range::positive(),
                                 "c2 of the quadratic drag law", "drag must slow a body down",
                                 {.symbol = "c_2",
                                  .label = "quadratic drag coefficient",
                                  .slider = Slider{.low = 0.1, .high = 3, .start = 2},
                                  .others = {"newton_drag"}})}},
    .read = read_quadratic_drag,
    .complete = make_quadratic_drag};

}  // namespace stickslip::effects
