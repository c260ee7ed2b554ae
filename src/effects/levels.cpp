#include "levels.hpp"

#include <memory>
#include <stdexcept>

namespace stickslip::effects {

void set_levels(Given& given, model::Scene& scene, const char* option, const char* fix,
                const std::function<model::LevelTable()>& levels) {
  if (!given.sound()) return;
  try {
    scene.noise.table = std::make_shared<const model::LevelTable>(levels());
  } catch (const std::invalid_argument& unfit) {
    given.refuse(option, unfit.what(), fix);
  }
}

bool has_levels(Given&, model::Scene& scene) { return scene.noise.table != nullptr; }

}  // namespace stickslip::effects
