#include <fmt/format.h>

#include <algorithm>

#include "all.hpp"
#include "formula.hpp"
#include "ou_noise.hpp"
#include "stickslip/model/drag_law.hpp"
#include "stickslip/model/largest_force.hpp"
#include "stickslip/support/errors.hpp"

namespace stickslip::effects {
namespace {

constexpr const char* kExpression = "drag_expression";

// The formula may hold tau, whatever the noise.
void read_expression(Given& given, model::Scene& scene) {
  scene.drag = {0, 0};
  scene.drag_expression = given.text(kExpression);
  scene.tau = given.real(kTau);
}

bool make_law(Given& given, model::Scene& scene) {
  return set_drag(given, scene, kExpression, scene.drag_expression);
}

model::Parameters expression_values(const model::Scene& scene) {
  return {{kExpression, scene.drag_expression}, {kTau, scene.tau}};
}

model::Drag drag_of(const std::string& formula, const model::Scene& scene) {
  const auto process = scene.meant();
  return model::parse_drag(
      formula, scene.friction, scene.tau, model::largest_force(scene), process.mean_force(),
      std::max(process.noise.tail_intensity(), process.mirrored().noise.tail_intensity()));
}

}  // namespace

void renew_drag(model::Scene& scene) {
  if (scene.drag_expression.empty()) return;
  try {
    scene.drag = drag_of(scene.drag_expression, scene);
  } catch (const model::UnfitLaw& unfit) {
    throw BadInput(fmt::format("-{} = {}: with -tau {:g}, {}; {}", kExpression,
                               scene.drag_expression, scene.tau, unfit.what(), unfit.fix()));
  }
}

bool set_drag(Given& given, model::Scene& scene, const char* option, const std::string& formula) {
  try {
    scene.drag = drag_of(formula, scene);
  } catch (const model::UnfitLaw& unfit) {
    given.refuse(option, unfit.what(), unfit.fix());
    return false;
  }
  return true;
}

const Effect kDragExpression{
    .word = "expression",
    .sentence = "the formula of -drag_expression",
    .others = {"quadratic", "formula", "custom"},
    .parameters = {{Option::text_of(
                        kExpression, "formula", "",
                        "b(v) of -drag expression, such as \"-v - 0.1*v*abs(v)\". b(0) = 0, and "
                        "slopes are bounded: kinks are allowed, jumps are not. b may rise where "
                        "friction and drag together still slow a fast body. Unless b is odd, both "
                        "velocity branches are computed"),
                    true, "\"-v - 0.1*v*abs(v)\""},
                   {tau_option()}},
    .read = read_expression,
    .complete = make_law,
    .values = expression_values,
    .heading = [](const model::Scene& scene) { return "drag b(v) = " + scene.drag_expression; }};

}  // namespace stickslip::effects
