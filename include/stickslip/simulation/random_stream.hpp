#pragma once
/// Random numbers that depend on the seed and on the place where they are used, and on nothing
/// else.

#include <Random123/philox.h>

#include <array>
#include <boost/random/exponential_distribution.hpp>
#include <cstdint>
#include <limits>

namespace stickslip::simulation {

/// Stream number `stream` of `seed`: 2^66 random bits of the counter-based generator Philox4x64-10
/// (Salmon, Moraes, Dror and Shaw, SC 2011), from Random123. Streams of different number or seed
/// share no counter, so that work can be distributed in any way. A UniformRandomBitGenerator.
class RandomStream {
 public:
  using result_type = std::uint64_t;

  RandomStream(std::uint64_t seed, std::uint64_t stream) : key_{{seed, stream}} {}

  static constexpr result_type min() { return 0; }
  static constexpr result_type max() { return std::numeric_limits<result_type>::max(); }
  result_type operator()() {
    if (next_ == words_.size()) refill();
    return words_[next_++];
  }

  /// 32 random bits; two calls share a word.
  std::uint32_t half_word() {
    if (kept_) {
      kept_ = false;
      return half_;
    }
    const result_type word = (*this)();
    half_ = static_cast<std::uint32_t>(word >> 32);
    kept_ = true;
    return static_cast<std::uint32_t>(word);
  }
  /// Uniform in [0, 1).
  double uniform() { return static_cast<double>((*this)() >> 11) * 0x1p-53; }
  /// Exponentially distributed with mean 1, by Boost.Random's ziggurat.
  double exponential() { return exponential_(*this); }

 private:
  // Many blocks at a time: they do not depend on one another, and processors overlap them.
  void refill() {
    constexpr std::size_t block = 4;
    for (std::size_t n = 0; n < words_.size(); n += block) {
      const auto random = r123::Philox4x64()(counter_, key_);
      ++counter_.v[0];
      for (std::size_t w = 0; w < block; ++w) words_[n + w] = random.v[w];
    }
    next_ = 0;
  }

  r123::Philox4x64::key_type key_;
  r123::Philox4x64::ctr_type counter_{};
  std::array<result_type, 128> words_{};
  std::size_t next_ = 128;
  std::uint32_t half_ = 0;
  bool kept_ = false;
  boost::random::exponential_distribution<double> exponential_;
};

}  // namespace stickslip::simulation
