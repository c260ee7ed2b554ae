#include <fmt/format.h>

#include "all.hpp"
#include "polynomial_drag.hpp"

namespace stickslip::effects {
namespace {

constexpr const char* kCubic = "drag_cubic";

void read_cubic_drag(Given& given, model::Scene& scene) {
  read_linear_drag(given, scene);
  scene.drag.cubic = given.real(kCubic);
}

}  // namespace

model::Parameters drag_coefficients(const model::Scene& scene) {
  return {{kDragCoefficient, scene.drag.linear}, {kCubic, scene.drag.cubic}};
}

std::string drag_heading(const model::Scene& scene) {
  std::string text = "drag " + scene.drag_name;
  if (scene.drag.linear > 0) text += fmt::format(", c = {:g}", scene.drag.linear);
  if (scene.drag.cubic > 0) text += fmt::format(", c3 = {:g}", scene.drag.cubic);
  return text;
}

const Effect kCubicDrag{
    .word = "cubic",
    .sentence = "-c v - c3 v^3",
    .parameters = {{drag_coefficient()},
                   {Option::real(kCubic, "time/length^2", "0", Range::not_negative(),
                                 "c3 of the cubic drag law", kDragMayNotGrow,
                                 {.symbol = "c_3",
                                  .label = "cubic drag coefficient",
                                  .slider = Slider{.low = 0, .high = 3, .start = 1}})}},
    .read = read_cubic_drag,
    .values = drag_coefficients,
    .heading = drag_heading,
    .derivatives = {by_drag_coefficient()}};

}  // namespace stickslip::effects
