#pragma once
/// Noises that jump further than to neighbours.

#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "stickslip/model/process.hpp"

namespace stickslip::test {

/// Five states with jumps of any length, the same in the mirror; slides start from the outer ones.
inline model::LevelTable five_states() {
  return {{-2, -0.6, 0, 0.6, 2},
          {{0, 1, 2},
           {1, 0, 0.3},
           {1, 2, 1},
           {2, 1, 0.7},
           {2, 3, 0.7},
           {3, 2, 1},
           {3, 4, 0.3},
           {4, 3, 2},
           {2, 0, 0.2},
           {2, 4, 0.2},
           {0, 2, 1},
           {4, 2, 1},
           {4, 0, 0.15},
           {0, 4, 0.15},
           {1, 3, 0.4},
           {3, 1, 0.4}}};
}

/// The sum of a sine of the given amplitude and period, in phases that follow one another at a
/// rate, and of an Ornstein-Uhlenbeck process of step delta, cut off at its last levels: states by
/// level of that, then by phase.
inline model::LevelTable sine_and_levels(double amplitude, double period, int phases, double delta,
                                         double tau, double deviation, int levels) {
  const double square = deviation * deviation, rate = 2 * square / (tau * delta * delta);
  const double turn = 2 * 3.14159265358979323846 / phases;
  const auto count = static_cast<std::size_t>(phases);
  std::vector<double> x;
  std::vector<model::Transition> transitions;
  for (int i = -levels; i <= levels; ++i) {
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t here = x.size();
      const double level = i * delta, tilt = delta * level / (2 * square);
      x.push_back(level + amplitude * std::sin(turn * static_cast<double>(k)));
      transitions.push_back({here, here - k + (k + 1) % count, phases / period});
      if (i < levels) transitions.push_back({here, here + count, rate * (1 - tilt) / 2});
      if (i > -levels) transitions.push_back({here, here - count, rate * (1 + tilt) / 2});
    }
  }
  return {x, transitions};
}

/// A chain of levels with each of them twice: jumps arrive at the first copy with probability
/// `share`, and the copies of a level jump to one another. The force has the distribution that it
/// had.
inline model::LevelTable twice(const model::NoiseChain& chain, double share) {
  std::vector<double> x;
  std::vector<model::Transition> transitions;
  const int lowest = chain.lowest();
  for (int i = lowest; i <= chain.highest(); ++i) {
    const std::size_t first = x.size();
    x.insert(x.end(), {chain.level(i), chain.level(i)});
    transitions.push_back({first, first + 1, 0.3});
    transitions.push_back({first + 1, first, 1.1});
    chain.for_each_jump(i, [&](int level, double rate) {
      const auto to = static_cast<std::size_t>(2 * (level - lowest));
      for (std::size_t from : {first, first + 1}) {
        transitions.push_back({from, to, rate * share});
        transitions.push_back({from, to + 1, rate * (1 - share)});
      }
    });
  }
  return {x, transitions};
}

inline model::Scene with_table(model::Scene s, model::LevelTable table) {
  s.noise.name = "chain";
  s.noise.table = std::make_shared<const model::LevelTable>(std::move(table));
  return s;
}

}  // namespace stickslip::test
