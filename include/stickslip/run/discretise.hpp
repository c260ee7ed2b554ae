#pragma once
/// One discretisation of a case: noise range and nodes, truncation velocity and velocity
/// discretisation.

#include <cstdint>
#include <memory>
#include <vector>

#include "stickslip/case/case.hpp"
#include "stickslip/generator/discretisation.hpp"
#include "stickslip/generator/noise_nodes.hpp"
#include "stickslip/generator/velocity_mesh.hpp"
#include "stickslip/model/process.hpp"

namespace stickslip::run {

struct Resolution {
  cases::Scheme scheme = cases::Scheme::hp;
  int degree = 0;                    ///< hp: largest polynomial degree of an element
  int least_degree = 2;              ///< hp: of an element, unless `degree` is smaller
  int layers = 0;                    ///< hp: elements graded towards v = 0
  generator::Rates rates;            ///< hp: fastest rates that the elements resolve
  std::vector<double> waves;         ///< hp: frequencies with elements of their own
  generator::Integrands integrands;  ///< hp: that the elements resolve
  int points = 0;                    ///< upwind: nodes per noise step
  int levels = 0;                    ///< N, noise levels on each side of 0, if not a table
  generator::Grouping grouping;      ///< of the noise levels
  std::shared_ptr<const generator::Nodes> noise;  ///< of that grouping; none: every level is a node
  int table_levels = 0;                           ///< of a noise from a table
  double v_max = 0;                               ///< end of the velocity discretisation [velocity]
  double truncation = 0;    ///< hp: relative error that both ends may leave, 0 where nothing is cut
  bool whole_tail = false;  ///< hp: degrees do not fall with the density
  int branches = 1;         ///< 1: reduced by symmetry, v > 0 only; 2: both signs of v
  cases::Factors factors = cases::Factors::own;

  [[nodiscard]] std::int64_t noise_nodes() const {
    if (noise) return noise->count();
    return table_levels > 0 ? table_levels : 2LL * levels + 1;
  }
};

/// Noise levels on each side of 0 whose tail beyond weighs less than `tolerance` against the level
/// from which sliding phases start, second moments included; never more than the full range, and
/// always more than k. Where drag does not hold it back, a body is fast because the noise stayed
/// high: there the distribution of X is shifted upwards, and the range with it.
[[nodiscard]] int levels_for(const model::Scene& scene, double tolerance,
                             const generator::Rates& rates = {});

/// End of the velocity discretisation: the terminal velocity of the highest level, or
/// where the density has fallen below `tolerance` if that comes first. What the user fixed goes
/// before.
[[nodiscard]] double velocity_end(const model::Scene& scene, int levels, double tolerance,
                                  double tilt = 0);

/// hp of polynomial degree `degree` in v, the noise levels grouped so, all that is open chosen for
/// truncation errors of `tolerance`, a hundredth of it in v, of which moments are asked for;
/// `layers` 0 are chosen for equations with rates up to `rates`.
/// O(noise levels).
[[nodiscard]] Resolution hp_resolution(const model::Scene& scene, int degree, int layers,
                                       double tolerance, const generator::Rates& rates = {},
                                       const generator::Grouping& grouping = {});

/// Upwind with `points` nodes per noise step, all that is open chosen as above.
[[nodiscard]] Resolution upwind_resolution(const model::Scene& scene, int points, double tolerance,
                                           const generator::Rates& rates = {});

/// No discretisation in v: only the noise range is chosen.
[[nodiscard]] Resolution exact_resolution(const model::Scene& scene, double tolerance);

/// The resolution with elements that follow waves of the frequency omega.
[[nodiscard]] Resolution following(const Resolution& resolution, double omega);

/// Without a velocity discretisation if the scheme has none.
[[nodiscard]] generator::Discretisation discretise(const model::Scene& scene,
                                                   const Resolution& resolution);

/// Number of sliding unknowns, up to the few origin and holding states; for the fluid queue that of
/// its phases.
[[nodiscard]] std::int64_t unknowns(const model::Scene& scene, const Resolution& resolution);

/// Memory that assembly and factorisation take, all ranks together [bytes], within a factor 2 (see
/// generator/solver_policy.hpp). Incomplete factors are taken for ILU(12). O(elements groups).
[[nodiscard]] double predicted_bytes(const model::Scene& scene, const Resolution& resolution,
                                     int ranks = 1);

/// Arithmetic of the factorisation up to a common factor, to scale measured times with.
[[nodiscard]] double relative_work(const model::Scene& scene, const Resolution& resolution);

/// Refuses a -start beyond the levels and the velocities of the first discretisation, where there
/// is nothing but extrapolation, if a quantity starts there. Throws BadInput with the largest.
void require_start_within(const cases::Case& given, const Resolution& first);

}  // namespace stickslip::run
