#pragma once
/// What a case gives, by key.

#include <map>
#include <string>

#include "stickslip/run/carry_out.hpp"

namespace stickslip::test {

using Values = std::map<std::string, quantities::Result>;

/// Standard deviation of a simulated value.
inline double sigma(const quantities::Result& simulated, std::size_t n) {
  return (simulated.ci95[n].second - simulated.ci95[n].first) / 2 / 1.96;
}

/// Collective.
inline Values values(const cases::Case& c) {
  Values by_key;
  for (const auto& r : run::carry_out(PETSC_COMM_WORLD, c, {}).results) by_key[r.key] = r;
  return by_key;
}

/// Of a case with one time, by keys without it. Collective.
inline Values values_at_the_time(const cases::Case& c) {
  Values by_key;
  for (const auto& [key, result] : values(c)) by_key[key.substr(0, key.find('('))] = result;
  return by_key;
}

}  // namespace stickslip::test
