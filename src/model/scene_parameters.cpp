#include "stickslip/model/scene_parameters.hpp"

namespace stickslip::model {

SceneParameters parameters_of(const Scene& s) {
  SceneParameters all{{"mu_s", s.friction.mu_s}, {"mu_d", s.friction.mu_d}, {"drag", s.drag_name}};
  const auto add = [&all](const char* name, const auto& value) { all.emplace_back(name, value); };
  const auto& noise = s.noise;
  if (noise.name == "telegraph") {
    add("telegraph_amplitude", noise.amplitude);
    add("telegraph_rate", noise.rate);
  } else if (noise.name == "file") {
    add("noise_file", noise.file);
  } else {
    add("tau", s.tau);
    add("delta", s.delta);
    if (noise.deviation) add("noise_deviation", *noise.deviation);
  }
  if (noise.name != "ou") add("noise", noise.name);
  if (!s.friction.symmetric()) {
    add("mu_s_minus", s.friction.mirrored().mu_s);
    add("mu_d_minus", s.friction.mirrored().mu_d);
  }
  if (const auto& stribeck = s.friction.stribeck) {
    add("friction", std::string("stribeck"));
    add("stribeck_velocity", stribeck->velocity);
    add("stribeck_exponent", stribeck->exponent);
  }
  if (s.drag.law) {
    add("drag_expression", s.drag_expression);
  } else {
    add("drag_coefficient", s.drag.linear);
    add("drag_cubic", s.drag.cubic);
  }
  add("bias", s.bias);
  if (s.limits_speed) add("speed_limit", *s.v_max);
  return all;
}

}  // namespace stickslip::model
