#include "all.hpp"
#include "polynomial_drag.hpp"

namespace stickslip::effects {

Option drag_coefficient() {
  return Option::real(kDragCoefficient, "1/time", "1", Range::not_negative(), "c of the drag law",
                      kDragMayNotGrow,
                      {.symbol = "c",
                       .label = "drag coefficient",
                       .slider = Slider{.low = 0, .high = 3, .start = 1},
                       .others = {"c", "gamma", "damping", "viscosity"}});
}

void read_linear_drag(Given& given, model::Scene& scene) {
  scene.drag = {given.real(kDragCoefficient), 0};
}

model::Derivative by_drag_coefficient() {
  return {kDragCoefficient, [](const model::BranchFriction&, double v) { return -v; }};
}

const Effect kLinearDrag{.word = "linear",
                         .sentence = "-c v",
                         .others = {"viscous", "stokes"},
                         .parameters = {{drag_coefficient()}},
                         .read = read_linear_drag,
                         .values = drag_coefficients,
                         .heading = drag_heading,
                         .derivatives = {by_drag_coefficient()}};

const Effect kNoDrag{.word = "none",
                     .sentence = "0",
                     .others = {"no", "off", "zero"},
                     .read =
                         [](Given&, model::Scene& scene) {
                           scene.drag = {0, 0};
                         },
                     .values = drag_coefficients,
                     .heading = drag_heading};

}  // namespace stickslip::effects
