#include "all.hpp"

namespace stickslip::effects {
namespace {

constexpr const char *kVelocity = "stribeck_velocity", *kExponent = "stribeck_exponent";

void read_stribeck(Given& given, model::Scene& scene) {
  if (!given.needs("friction", kVelocity, "0.1")) return;
  scene.friction.stribeck = {given.real(kVelocity), given.real(kExponent)};
}

model::Parameters stribeck_values(const model::Scene& scene) {
  const auto& stribeck = scene.friction.stribeck;
  if (!stribeck) return {};
  return {{kVelocity, stribeck->velocity}, {kExponent, stribeck->exponent}};
}

}  // namespace

const Effect kCoulomb{.word = "coulomb", .sentence = "F = mu_d at every speed"};

const Effect kStribeck{
    .word = "stribeck",
    .sentence = "F(v) = mu_d + (mu_s - mu_d) exp(-(|v|/v_s)^gamma), with the coefficients of each "
                "direction",
    .parameters = {{Option::real(
                        kVelocity, "velocity", "", Range::positive(),
                        "Stribeck velocity v_s: friction falls from mu_s to mu_d over speeds of "
                        "this size",
                        "for a fall at once take -friction coulomb"),
                    true},
                   {Option::real(kExponent, "", "1", Range::positive(),
                                 "exponent gamma of -friction stribeck",
                                 "take 1, or 2 for friction that is flat at rest"),
                    true}},
    .read = read_stribeck,
    .values = stribeck_values};

}  // namespace stickslip::effects
