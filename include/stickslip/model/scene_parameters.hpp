#pragma once
/// The parameters of a scene by name, for all that reports a scene or tells two of them apart.

#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "stickslip/model/scene.hpp"

namespace stickslip::model {

using SceneParameters = std::vector<std::pair<std::string, std::variant<double, std::string>>>;

/// All that fixes the process of a scene, each by the name of its option, in the order in which
/// files hold them: friction, the word of the drag law, noise, what is beside the defaults, and the
/// coefficients of the drag. Left out are the range of the noise, the levels of a table, and a
/// truncation velocity that is no part of the model.
[[nodiscard]] SceneParameters parameters_of(const Scene& scene);

}  // namespace stickslip::model
