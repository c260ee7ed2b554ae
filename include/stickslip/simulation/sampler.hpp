#pragma once
/// Batches of samples.

#include <cstdint>
#include <memory>
#include <vector>

#include "stickslip/simulation/excursions.hpp"
#include "stickslip/simulation/path.hpp"
#include "stickslip/simulation/tally.hpp"

namespace stickslip::simulation {

/// A sample is an excursion from s+ and, without symmetry, another one from s-, together with the
/// paths that are wanted. Local.
class Sampler {
 public:
  Sampler(const cases::Question& question, const model::Process& process);

  /// `count` < 2^16 samples by the random streams of their batch, at most 2^44 of them; until the
  /// next batch.
  [[nodiscard]] const Tally& batch(std::uint64_t seed, std::uint64_t batch, int count);

 private:
  void draw_from_rest(RandomStream& random, Excursion& all);
  void add_cycle(RandomStream& random, RandomStream& places, Excursion& first);
  void add_stationary(const RandomStream& random, std::size_t side, double place, bool mirrored);
  [[nodiscard]] std::pair<State, std::span<const State>> follow();
  [[nodiscard]] std::span<const double> pass(bool mirrored);

  Tally tally_;
  model::Process process_;
  Sampled sampled_;
  std::vector<int> starts_;  // by side, or of cycles
  Wanted wanted_;
  std::unique_ptr<ExcursionSource> source_, from_rest_;
  std::unique_ptr<NoiseLevels> at_rest_;  // where passages from rest are wanted
  std::unique_ptr<Walk> walk_;
  std::vector<std::size_t> order_;  // of times
  std::vector<State> states_;
  std::vector<double> passages_;
};

}  // namespace stickslip::simulation
