#pragma once
/// A process made discrete.

#include <cstdint>
#include <memory>
#include <utility>

#include "stickslip/model/process.hpp"
#include "stickslip/noise/nodes.hpp"
#include "stickslip/velocity/axis.hpp"

namespace stickslip::operators {

/// A process with the nodes of its noise and of its velocity.
struct Discretisation {
  /// On all levels of the noise unless nodes are given.
  Discretisation(model::Process of, std::shared_ptr<const velocity::Axis> velocity_axis,
                 std::shared_ptr<const noise::Nodes> noise_nodes = nullptr)
      : process(std::move(of)),
        noise(noise_nodes ? std::move(noise_nodes) : std::make_shared<noise::Nodes>(process)),
        axis(std::move(velocity_axis)) {}

  model::Process process;
  std::shared_ptr<const noise::Nodes> noise;
  std::shared_ptr<const velocity::Axis> axis;  ///< none for the fluid queue
};

/// Whether dense blocks of noise nodes along the velocity beat sparse factors: groups couple all of
/// their nodes, and MUMPS takes ten times as long; where every level is a node, which has two
/// neighbours alone, both are even at some 900 of them.
[[nodiscard]] inline bool suits_elements(std::int64_t noise_nodes, bool all_levels) {
  constexpr std::int64_t most_levels = 700;
  return !all_levels || noise_nodes <= most_levels;
}

}  // namespace stickslip::operators
