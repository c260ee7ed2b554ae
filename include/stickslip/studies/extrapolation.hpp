#pragma once
/// The extrapolation in p and delta of the paper.

#include <map>
#include <utility>

namespace stickslip::studies {

/// p = 2^k, delta = 2^-l.
using Place = std::pair<int, int>;
constexpr int kMostPoints = 9, kMostSteps = 6;  // k and l go from 1 up to these

/// Whether (k, l) lies in the set that the paper's memory allows to compute.
[[nodiscard]] bool is_computed(const Place& place);

/// Fills the places that are not computed: S = (S_V + S_H)/2, where S_V continues the three values
/// at l - 1, l - 2, l - 3 by the ratio of their changes, and S_H those at k - 1, k - 2, k - 3.
void extrapolate(std::map<Place, double>& values);

}  // namespace stickslip::studies
