#include <memory>

#include "levels.hpp"
#include "stickslip/model/effect.hpp"
#include "stickslip/model/spring.hpp"

namespace stickslip::effects {

void read_spring(Given& given, model::Scene& scene) {
  if (!given.sound()) return;
  scene.stiffness = given.real(kStiffness);
  if (scene.noise.name.empty()) return;  // a given force alone
  const model::Spring::Body body{scene.stiffness, scene.bias, scene.friction,
                                 model::with_weakening(scene.drag, scene.friction)};
  try {
    if (!scene.noise.gaussian) {
      scene.spring = std::make_shared<const model::Spring>(body, scene.meant().noise);
    } else if (const auto& terms = scene.noise.gaussian->terms();
               terms.size() == 1 && terms.front().frequency == 0) {
      scene.spring = std::make_shared<const model::Spring>(
          body,
          model::Spring::Coloured{scene.noise.gaussian->deviation(), 1 / terms.front().decay});
    } else {
      return given.refuse(kStiffness,
                          "goes with noise of levels, or with one Ornstein-Uhlenbeck process",
                          "take -noise ou, or -noise telegraph");
    }
    scene.noise.table = scene.meant().noise.table;
  } catch (const model::UnfitTable& unfit) {
    given.refuse(scene.noise.gaussian ? kStiffness : "mu_s", unfit.what(),
                 scene.noise.gaussian ? "leave it out" : "take fewer levels, or less friction");
  }
}

}  // namespace stickslip::effects
