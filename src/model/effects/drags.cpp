#include <fmt/format.h>

#include <algorithm>

#include "all.hpp"
#include "levels.hpp"
#include "stickslip/base/errors.hpp"
#include "stickslip/model/drag.hpp"
#include "stickslip/model/effect.hpp"
#include "stickslip/model/process.hpp"

namespace stickslip::effects {

namespace {

// What drag laws with coefficients share.

constexpr const char *kDragCoefficient = "drag_coefficient", *kCubic = "drag_cubic",
                     *kVelocity = "stribeck_velocity", *kExponent = "stribeck_exponent",
                     *kExpression = "drag_expression";
constexpr const char* kDragMayNotGrow =
    "the drag must not grow with the velocity, it would drive the body";

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

void read_cubic_drag(Given& given, model::Scene& scene) {
  read_linear_drag(given, scene);
  scene.drag.cubic = given.real(kCubic);
}

model::Derivative by_drag_coefficient() {
  return {kDragCoefficient, [](const model::BranchFriction&, double v) { return -v; }};
}

// Files state the coefficients of all of them.
model::Parameters drag_coefficients(const model::Scene& scene) {
  return {{kDragCoefficient, scene.drag.linear}, {kCubic, scene.drag.cubic}};
}

std::string drag_heading(const model::Scene& scene) {
  std::string text = "drag " + scene.drag_name;
  if (scene.drag.linear > 0) text += fmt::format(", c = {:g}", scene.drag.linear);
  if (scene.drag.cubic > 0) text += fmt::format(", c3 = {:g}", scene.drag.cubic);
  return text;
}

model::Drag drag_of(const std::string& formula, const model::Scene& scene) {
  const auto process = scene.meant();
  return model::parse_drag(
      formula, scene.friction, scene.tau, model::largest_force(scene), process.mean_force(),
      std::max(process.noise.tail_intensity(), process.mirrored().noise.tail_intensity()));
}

}  // namespace

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

const Effect kCoulomb{
    .word = "coulomb", .sentence = "F = mu_d at every speed", .others = {"dry", "constant"}};

const Effect kStribeck{
    .word = "stribeck",
    .sentence = "F(v) = mu_d + (mu_s - mu_d) exp(-(|v|/v_s)^gamma), with the coefficients of each "
                "direction",
    .parameters = {{Option::real(
                        kVelocity, "velocity", "", Range::positive(),
                        "Stribeck velocity v_s: friction falls from mu_s to mu_d over speeds of "
                        "this size",
                        "for a fall at once take -friction coulomb",
                        {.symbol = "v_s",
                         .label = "Stribeck velocity",
                         .slider =
                             Slider{.low = 0.01, .high = 10, .start = 0.3, .logarithmic = true}}),
                    true, "0.1"},
                   {Option::real(kExponent, "", "1", Range::positive(),
                                 "exponent gamma of -friction stribeck",
                                 "take 1, or 2 for friction that is flat at rest",
                                 {.symbol = "\\gamma", .label = "Stribeck exponent"}),
                    true}},
    .read =
        [](Given& given, model::Scene& scene) {
          scene.friction.stribeck = {given.real(kVelocity), given.real(kExponent)};
        },
    .values = [](const model::Scene& scene) -> model::Parameters {
      const auto& stribeck = scene.friction.stribeck;
      if (!stribeck) return {};
      return {{kVelocity, stribeck->velocity}, {kExponent, stribeck->exponent}};
    },
    .derivatives = {{"mu_s",  // at fixed static levels
                     [](const model::BranchFriction& here, double v) {
                       return here.own_mu_s ? 0.0 : here.friction.share(v) - 1;
                     }},
                    {kVelocity, [](const model::BranchFriction& here, double v) {
                       const auto& friction = here.friction;
                       return (friction.mu_s - friction.mu_d) *
                              friction.stribeck->share_by_velocity(v);
                     }}}};

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
    .read =
        [](Given& given, model::Scene& scene) {
          scene.drag = {0, 0};
          scene.drag_expression = given.text(kExpression);
          scene.tau = given.real(kTau);  // which the formula may hold, whatever the noise
        },
    .complete =
        [](Given& given, model::Scene& scene) {
          return set_drag(given, scene, kExpression, scene.drag_expression);
        },
    .values = [](const model::Scene& scene) -> model::Parameters {
      return {{kExpression, scene.drag_expression}, {kTau, scene.tau}};
    },
    .heading = [](const model::Scene& scene) { return "drag b(v) = " + scene.drag_expression; }};

}  // namespace stickslip::effects
