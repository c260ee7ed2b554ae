#include "stickslip/model/same_force.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "stickslip/algebra/dense.hpp"
#include "stickslip/support/infinity.hpp"

namespace stickslip::model {
namespace {

// The first and the last level with the force of level i.
struct Block {
  Block(const NoiseChain& chain, int i) : first(i), last(i) {
    while (first > chain.lowest() && chain.level(first - 1) == chain.level(i)) --first;
    while (last < chain.highest() && chain.level(last + 1) == chain.level(i)) ++last;
  }
  [[nodiscard]] bool holds(int i) const { return first <= i && i <= last; }

  int first, last;
};

}  // namespace

ChangeRates change_rates(const NoiseChain& chain, int i) {
  const Block block(chain, i);
  ChangeRates rates{kInfinity, 0};
  for (int from = block.first; from <= block.last; ++from) {
    double sum = 0;
    chain.for_each_jump(from, [&](int to, double rate) { sum += block.holds(to) ? 0 : rate; });
    rates = {std::min(rates.least, sum), std::max(rates.most, sum)};
  }
  return rates;
}

Unchanged unchanged(const NoiseChain& chain, int i, double time) {
  const Block block(chain, i);
  const int count = block.last - block.first + 1;
  if (count == 1) return {i, {std::exp(-chain.rate(i) * time)}};
  algebra::Matrix<double> killed(count, count);
  for (int from = block.first; from <= block.last; ++from) {
    const int row = from - block.first;
    killed(row, row) = -chain.rate(from);
    chain.for_each_jump(from, [&](int to, double rate) {
      if (block.holds(to)) killed(row, to - block.first) += rate;
    });
  }
  const auto moved = algebra::exponential(std::move(killed), time);
  Unchanged found{block.first};
  for (int n = 0; n < count; ++n) found.probability.push_back(moved(i - block.first, n));
  return found;
}

}  // namespace stickslip::model
