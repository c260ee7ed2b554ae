#include <cmath>
#include <set>
#include <vector>

#include "../common/catch.hpp"
#include "stickslip/simulation/walk.hpp"

using stickslip::simulation::RandomStream;

namespace {

using Block = std::array<std::uint64_t, 4>;
using Key = std::array<std::uint64_t, 2>;
__extension__ using Wide = unsigned __int128;

struct Product {
  std::uint64_t high, low;
};

Product multiply(std::uint64_t a, std::uint64_t b) {
  const Wide product = static_cast<Wide>(a) * b;
  return {static_cast<std::uint64_t>(product >> 64), static_cast<std::uint64_t>(product)};
}

/// Philox4x64-10 by its definition.
Block philox(Block counter, Key key) {
  for (int round = 0; round < 10; ++round) {
    const auto a = multiply(0xD2E7470EE14C6C93, counter[0]);
    const auto b = multiply(0xCA5A826395121157, counter[2]);
    counter = {b.high ^ counter[1] ^ key[0], b.low, a.high ^ counter[3] ^ key[1], a.low};
    key[0] += 0x9E3779B97F4A7C15;
    key[1] += 0xBB67AE8584CAA73B;
  }
  return counter;
}

std::vector<std::uint64_t> words(std::uint64_t seed, std::uint64_t stream, int count) {
  RandomStream random(seed, stream);
  std::vector<std::uint64_t> all;
  for (int n = 0; n < count; ++n) all.push_back(random());
  return all;
}

}  // namespace

// The last is of the digits of pi: counter and key that are not zero.
TEST_CASE("random stream: known answers of Random123") {
  const std::vector<std::uint64_t> known{0x16554d9eca36314c, 0xdb20fe9d672d0fdc, 0xd7e772cee186176b,
                                         0x7e68b68aec7ba23b};
  CHECK(words(0, 0, 4) == known);
  CHECK(philox({}, {}) == Block{known[0], known[1], known[2], known[3]});
  CHECK(philox({0x243f6a8885a308d3, 0x13198a2e03707344, 0xa4093822299f31d0, 0x082efa98ec4e6c89},
               {0x452821e638d01377, 0xbe5466cf34e90c6c}) ==
        Block{0xa528f45403e61d95, 0x38c72dbd566e9788, 0xa5a1610e72fd18b5, 0x57bd43b5e52b7fe6});
}

TEST_CASE("random stream: the counter goes on from block to block, the key is seed and stream") {
  for (const Key& key : {Key{0, 0}, Key{1, 7}, Key{~0ULL, 1ULL << 63}}) {
    const auto found = words(key[0], key[1], 1000);
    for (std::uint64_t block = 0; block < 250; ++block) {
      const Block known = philox({block, 0, 0, 0}, key);
      for (std::size_t w = 0; w < 4; ++w) REQUIRE(found[4 * block + w] == known[w]);
    }
  }
}

TEST_CASE("random stream: seeds and streams differ in every word, and repeat") {
  std::set<std::uint64_t> seen;
  for (std::uint64_t seed : {0, 1, 2}) {
    for (std::uint64_t stream : {0, 1, 2, 3}) {
      const auto found = words(seed, stream, 200);
      CHECK(found == words(seed, stream, 200));
      seen.insert(found.begin(), found.end());
    }
  }
  CHECK(seen.size() == 3 * 4 * 200);
}

TEST_CASE("random stream: two half words make a word, and words go on between") {
  const auto whole = words(5, 6, 3);
  RandomStream random(5, 6);
  const auto low = random.half_word();
  CHECK(low == static_cast<std::uint32_t>(whole[0]));
  CHECK(random() == whole[1]);
  CHECK(random.half_word() == whole[0] >> 32);
  CHECK(random.half_word() == static_cast<std::uint32_t>(whole[2]));
}

TEST_CASE("random stream: exponential numbers have the exponential distribution within 4 sigma") {
  RandomStream random(3, 1);
  constexpr int count = 400000;
  const std::vector<double> beyond{0.01, 0.1, 1, 3, 7, 10};
  std::vector<double> counted(beyond.size());
  double sum = 0;
  for (int n = 0; n < count; ++n) {
    const double wait = random.exponential();
    sum += wait;
    for (std::size_t b = 0; b < beyond.size(); ++b) counted[b] += wait > beyond[b];
  }
  CHECK(std::abs(sum / count - 1) < 4 / std::sqrt(count));
  for (std::size_t b = 0; b < beyond.size(); ++b) {
    const double p = std::exp(-beyond[b]);
    INFO("beyond " << beyond[b]);
    CHECK(std::abs(counted[b] - count * p) < 4 * std::sqrt(count * p * (1 - p)));
  }
}
