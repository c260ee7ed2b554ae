#pragma once
/// Estimates of tallies by their keys.

#include <stdexcept>
#include <string>
#include <vector>

#include "stickslip/simulation/tally.hpp"

namespace stickslip::test {

inline std::vector<simulation::Estimate> estimates(const simulation::Tally& tally,
                                                   const std::string& key) {
  for (const auto& e : tally.estimates()) {
    if (key == (e.observable ? e.row->key_of(e.observable->name) : e.row->key)) return e.values;
  }
  throw std::invalid_argument(key);
}

inline simulation::Estimate estimate(const simulation::Tally& tally, const std::string& key,
                                     std::size_t n = 0) {
  return estimates(tally, key).at(n);
}

}  // namespace stickslip::test
