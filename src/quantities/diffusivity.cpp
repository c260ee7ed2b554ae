#include "stickslip/quantities/diffusivity.hpp"

#include <cmath>
#include <numeric>
#include <vector>

#include "stickslip/operators/static_chain.hpp"
#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/vectors.hpp"

namespace stickslip::quantities {
namespace {

using operators::Symmetry;
using petsc::dot;

/// -L u = V - E[V], with solutions as they are or without their last correction.
class Poisson {
 public:
  Poisson(operators::Systems& systems, const StationaryDistribution& distribution)
      : system_(systems.at(0, Symmetry::none)),
        distribution_(distribution),
        chain_(operators::StaticChain::of(systems.process())),
        mean_(mean_velocity(distribution)),
        sticking_(chain_.integral(std::vector<double>(chain_.size(), -mean_))),
        upwards_(chain_.upward_exit_transform()),
        force_(system_.a().values([this](double, double, double v) { return v - mean_; })) {
    const auto& a = system_.a();
    petsc::VecHandle source = a.from_rest({sticking_.begin(), sticking_.end()});
    petsc::check(VecAXPY(source, 1, force_));
    integral_ = system_.factors().solve(source);
    rising_ = system_.factors().solve(a.from_rest({upwards_.begin(), upwards_.end()}));
  }

  [[nodiscard]] Uncertain spectrum() {
    const double corrected = value();
    petsc::check(VecAXPY(integral_.x, -1, integral_.correction));
    petsc::check(VecAXPY(rising_.x, -1, rising_.correction));
    return {corrected, std::abs(corrected - value())};
  }

 private:
  static double mean_velocity(const StationaryDistribution& distribution) {
    const auto& drift = distribution.excursion().slide_drift;
    return std::accumulate(drift.begin(), drift.end(), 0.0) /
           distribution.excursion().mean_excursion();
  }

  // 2 pi((V - m) u); u may have any constant added, and has the one that makes it small.
  [[nodiscard]] double value() const {
    const double d =
        dot(system_.a().trace_at_exit(), integral_.x) / distribution_.reversal_probability();
    petsc::VecHandle u, occupied;
    petsc::check(VecDuplicate(force_, u.out()));
    petsc::check(VecDuplicate(force_, occupied.out()));
    petsc::check(VecWAXPY(u, d, rising_.x, integral_.x));
    petsc::check(VecShift(u, -d / 2));
    petsc::check(VecPointwiseMult(occupied, force_, distribution_.occupation()));
    double sum = dot(occupied, u);
    const auto& stick = distribution_.excursion().stick_time;
    for (std::size_t n = 0; n < stick.size(); ++n) {
      sum -= stick[n] * mean_ * (sticking_[n] + d * (upwards_[n] - 0.5));
    }
    return 2 * sum / distribution_.excursion().mean_excursion();
  }

  operators::System& system_;
  const StationaryDistribution& distribution_;
  operators::StaticChain chain_;
  double mean_;
  std::vector<double> sticking_, upwards_;
  petsc::VecHandle force_;
  petsc::Solution integral_, rising_;
};

}  // namespace

Uncertain spectrum_at_zero(operators::Systems& systems,
                           const StationaryDistribution& distribution) {
  return Poisson(systems, distribution).spectrum();
}

}  // namespace stickslip::quantities
