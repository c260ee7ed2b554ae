#pragma once
// Results that are made for a test, of any key and unit.

#include <string>
#include <utility>
#include <vector>

#include "stickslip/quantities/results.hpp"

namespace stickslip::test {

inline quantities::Result scalar(std::string key, std::string unit, double value, double error) {
  return {std::move(key), std::move(unit), "", {}, {value}, {error}};
}

inline quantities::Result array(std::string key, std::string unit, std::string abscissa_name,
                                std::vector<double> abscissa) {
  return {std::move(key), std::move(unit), std::move(abscissa_name), std::move(abscissa), {}, {}};
}

}  // namespace stickslip::test
