#pragma once
/// Elements that follow waves of a spectrum, on velocity elements. See waves.cpp for the reasons.

#include <vector>

#include "stickslip/model/process.hpp"

namespace stickslip::velocity {

/// The element ends with those between that the waves need; `gap` is the distance from rest down to
/// the nearest level [force]. O(elements levels) for a table.
[[nodiscard]] std::vector<double> split_for_waves(const model::Process& process, double omega,
                                                  double gap, std::vector<double> ends);

}  // namespace stickslip::velocity
