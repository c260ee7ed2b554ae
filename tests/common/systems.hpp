#pragma once
/// Systems of every kind that is killed at rest.

#include <vector>

#include "scenes.hpp"
#include "stickslip/generator/generator.hpp"

namespace stickslip::test {

struct System {
  model::Scene scene;
  generator::Symmetry symmetry;
  generator::StaticPhase static_phase;
};

inline std::vector<System> killed_systems() {
  using generator::StaticPhase;
  using generator::Symmetry;
  const auto plain = scene(1, 0.25, 1, 0.25, {1, 0});
  auto biased = plain, driven = plain;
  auto three_levels = scene(0.3, 0.2, 1, 0.5, {1, 0}), five_levels = three_levels;
  biased.bias = 0.4;
  driven.bias = 1.4;
  three_levels.noise_levels = 1;
  five_levels.noise_levels = 2;
  return {{plain, Symmetry::even, StaticPhase::killing},
          {plain, Symmetry::odd, StaticPhase::killing},
          {plain, Symmetry::even, StaticPhase::killed_on_exit},
          {plain, Symmetry::none, StaticPhase::killing},
          {biased, Symmetry::none, StaticPhase::killing},
          {driven, Symmetry::none, StaticPhase::killing_edges},
          {three_levels, Symmetry::even, StaticPhase::killing},
          {five_levels, Symmetry::none, StaticPhase::killing},
          {scene(0.1, 0.1, 1, 0.125, {1, 3}), Symmetry::even, StaticPhase::killing},
          {scene(1, 1, 0.1, 0.5, {0, 0}), Symmetry::even, StaticPhase::killing}};
}

}  // namespace stickslip::test
