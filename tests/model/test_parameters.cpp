#include "../common/catch.hpp"
#include "stickslip/model/effect.hpp"

using namespace stickslip;

namespace {

std::string names_of(const model::Scene& scene) {
  std::string names;
  for (const auto& [name, value] : effects::parameters_of(scene)) names += name + " ";
  return names;
}

}  // namespace

TEST_CASE("scene parameters: what a scene leaves at its default, or does not have, is left out") {
  model::Scene scene;
  scene.friction = {1, 0.5};
  CHECK(names_of(scene) == "mu_s mu_d drag tau delta drag_coefficient drag_cubic bias ");
  scene.noise.deviation = 0.5;
  scene.friction_name = "stribeck";
  scene.friction.stribeck = {{0.1, 2}};
  CHECK(names_of(scene) ==
        "mu_s mu_d drag tau delta noise_deviation friction stribeck_velocity stribeck_exponent "
        "drag_coefficient drag_cubic bias ");
  scene.noise.name = "telegraph";
  scene.own = {{"telegraph_amplitude", 1.0}, {"telegraph_rate", 1.0}};
  scene.drag_name = "expression";
  scene.drag.law = [](double v) { return -2 * v; };
  CHECK(names_of(scene) ==
        "mu_s mu_d drag telegraph_amplitude telegraph_rate noise friction stribeck_velocity "
        "stribeck_exponent drag_expression tau bias ");
}
