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
  Poisson(operators::Systems& systems, const StationaryLaw& law)
      : system_(systems.at(0, Symmetry::none)),
        law_(law),
        chain_(operators::StaticChain::of(systems.process())),
        mean_(mean_velocity(law)),
        stay_(chain_.integral(std::vector<double>(chain_.size(), -mean_))),
        upwards_(chain_.upward_exit_transform()),
        force_(system_.a().values([this](double, double, double v) { return v - mean_; })) {
    const auto& a = system_.a();
    petsc::VecHandle source = a.from_rest({stay_.begin(), stay_.end()});
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
  static double mean_velocity(const StationaryLaw& law) {
    const auto& drift = law.excursion().slide_drift;
    return std::accumulate(drift.begin(), drift.end(), 0.0) / law.excursion().mean_excursion();
  }

  // 2 pi((V - m) u); u may have any constant added, and has the one that makes it small.
  [[nodiscard]] double value() const {
    const double d = dot(system_.a().trace_at_exit(), integral_.x) / law_.chance_of_falling();
    petsc::VecHandle u, occupied;
    petsc::check(VecDuplicate(force_, u.out()));
    petsc::check(VecDuplicate(force_, occupied.out()));
    petsc::check(VecWAXPY(u, d, rising_.x, integral_.x));
    petsc::check(VecShift(u, -d / 2));
    petsc::check(VecPointwiseMult(occupied, force_, law_.occupation()));
    double sum = dot(occupied, u);
    const auto& stick = law_.excursion().stick_time;
    for (std::size_t n = 0; n < stick.size(); ++n) {
      sum -= stick[n] * mean_ * (stay_[n] + d * (upwards_[n] - 0.5));
    }
    return 2 * sum / law_.excursion().mean_excursion();
  }

  operators::System& system_;
  const StationaryLaw& law_;
  operators::StaticChain chain_;
  double mean_;
  std::vector<double> stay_, upwards_;
  petsc::VecHandle force_;
  petsc::Solution integral_, rising_;
};

}  // namespace

Uncertain spectrum_at_zero(operators::Systems& systems, const StationaryLaw& law) {
  return Poisson(systems, law).spectrum();
}

}  // namespace stickslip::quantities
