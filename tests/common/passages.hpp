#pragma once
/// Passages of a speed, by hand.

#include "scenes.hpp"
#include "stickslip/model/passage.hpp"
#include "stickslip/operators/discretisation.hpp"
#include "stickslip/operators/system_key.hpp"

namespace stickslip::test {

inline model::Scene passing(double bias = 0) { return biased(scene(1, 0.5, 1, 0.5, {1, 0}), bias); }

inline operators::SystemKey passage_key(const model::Process& process, model::Passage passage,
                                        double w) {
  operators::SystemKey key{0, operators::symmetry_of(process)};
  key.speed_limit = w;
  key.passage = passage;
  if (passage != model::Passage::both) key.symmetry = operators::Symmetry::none;
  return key;
}

}  // namespace stickslip::test
