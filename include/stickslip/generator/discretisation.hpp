#pragma once
/// A process made discrete.

#include <memory>
#include <optional>
#include <utility>

#include "stickslip/generator/noise_nodes.hpp"
#include "stickslip/generator/velocity_methods.hpp"
#include "stickslip/model/process.hpp"

namespace stickslip::generator {

/// A process with the nodes of its noise and of its velocity.
struct Discretisation {
  /// On all levels of the noise unless nodes are given.
  Discretisation(model::Process of, std::shared_ptr<const VelocityDiscretisation> velocity_axis,
                 std::shared_ptr<const Nodes> noise_nodes = nullptr)
      : process(std::move(of)),
        noise(noise_nodes ? std::move(noise_nodes) : std::make_shared<Nodes>(process)),
        velocities(std::move(velocity_axis)) {}

  /// The same with elements and groups that end where |v| = speed, and `beyond` or not: bodies that
  /// rise to it are killed, those of a passage, or none.
  [[nodiscard]] Discretisation cut_at(double speed, bool beyond,
                                      std::optional<model::Passage> killed) const;

  model::Process process;
  std::shared_ptr<const Nodes> noise;
  std::shared_ptr<const VelocityDiscretisation> velocities;  ///< none for the fluid queue
};

}  // namespace stickslip::generator
