#pragma once
/// Nodes of one noise of continuous paths, moved to where those of a noise next to it are.

#include <memory>

#include "stickslip/model/gaussian.hpp"

namespace stickslip::model {

/// A noise, and the thresholds of its scene.
struct Thresholded {
  const GaussianNoise& noise;
  Thresholds thresholds;
};

/// The generator of a noise on the elements that another one has at an order: their ends move with
/// the thresholds, in proportion between these, so that nodes are the same ones and results are
/// smooth functions of all parameters.
[[nodiscard]] std::shared_ptr<const LevelTable> moved_nodes(const Thresholded& from,
                                                            const Thresholded& to, int order);

}  // namespace stickslip::model
