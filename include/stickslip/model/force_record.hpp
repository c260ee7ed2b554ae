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

  /// Largest |force|.
  [[nodiscard]] double largest() const {
    double most = 0;
    for (double f : force) most = std::max(most, std::abs(f));
    return most;
  }
};

}  // namespace stickslip::model
