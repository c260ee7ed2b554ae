#pragma once
/// A force given over time.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace stickslip::model {

/// Samples of a force, at least two, at rising times. Between two of them it is linear, or keeps
/// the value of the first.
struct ForceRecord {
  std::vector<double> time = {}, force = {};  ///< [time], [force]
  bool constant = false;
  std::string file = {};  ///< from which it was read
  double scale = 1;       ///< by which the values of the file have been multiplied
  double step = 0;        ///< [time], of a file of rows of samples
  double rest = 0;        ///< [time] without force behind the last sample of the file
  /// Normal force over the weight, by which all friction is multiplied: 1 + a/g under a vertical
  /// acceleration a of the ground. Empty where it is 1.
  std::vector<double> load = {};
  double gravity = 0;     ///< g; 0 where load is empty
  std::string unit = {};  ///< of the force, m/s^2; empty where it is the user's

  [[nodiscard]] double load_at(std::size_t n) const { return load.empty() ? 1 : load[n]; }
  /// The first sample of the largest |force|.
  [[nodiscard]] std::size_t peak() const {
    const auto smaller = [](double a, double b) { return std::abs(a) < std::abs(b); };
    return static_cast<std::size_t>(std::ranges::max_element(force, smaller) - force.begin());
  }
};

}  // namespace stickslip::model
