#include "all.hpp"

namespace stickslip::effects {
namespace {

constexpr const char *kVelocity = "stribeck_velocity", *kExponent = "stribeck_exponent";

void read_stribeck(Given& given, model::Scene& scene) {
  scene.friction.stribeck = {given.real(kVelocity), given.real(kExponent)};
}

model::Parameters stribeck_values(const model::Scene& scene) {
  const auto& stribeck = scene.friction.stribeck;
  if (!stribeck) return {};
  return {{kVelocity, stribeck->velocity}, {kExponent, stribeck->exponent}};
}

// At fixed static levels.
double by_mu_s(const model::BranchFriction& here, double v) {
  return here.own_mu_s ? 0.0 : here.friction.share(v) - 1;
}

double by_velocity(const model::BranchFriction& here, double v) {
  const auto& friction = here.friction;
  return (friction.mu_s - friction.mu_d) * friction.stribeck->share_by_velocity(v);
}

}  // namespace

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
    .read = read_stribeck,
    .values = stribeck_values,
    .derivatives = {{"mu_s", by_mu_s}, {kVelocity, by_velocity}}};

}  // namespace stickslip::effects
