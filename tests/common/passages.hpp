#pragma once
/// Passages of a speed, by hand.

#include "scenes.hpp"
#include "stickslip/generator/discretisation.hpp"
#include "stickslip/generator/system_key.hpp"
#include "stickslip/model/process.hpp"

namespace stickslip::test {

inline model::Scene passing(double bias = 0) { return biased(scene(1, 0.5, 1, 0.5, {1, 0}), bias); }

inline generator::SystemKey passage_key(const model::Process& process, model::Passage passage,
                                        double w) {
  generator::SystemKey key{0, generator::symmetry_of(process)};
  key.speed_limit = w;
  key.passage = passage;
  if (passage != model::Passage::both) key.symmetry = generator::Symmetry::none;
  return key;
}

}  // namespace stickslip::test
