#pragma once
/// Discretisations in the order in which refinement tries them.

#include <map>
#include <vector>

#include "stickslip/accuracy/estimates.hpp"
#include "stickslip/accuracy/resolution.hpp"
#include "stickslip/cases/case.hpp"
#include "stickslip/quantities/plan.hpp"

namespace stickslip::accuracy {

/// Refinement levels below 1 only serve for comparison; each further refinement level is finer in
/// degrees or points and noise nodes, so that the change from one refinement level to the next
/// shows the error of the coarser one. All have the same elements, as they reach as far: how the
/// errors of two levels on other elements compare is at random. What is cut off is an error of its
/// own (Resolution::truncation). Where the tail may weigh anything, as what observables, first
/// passages and relaxation modes make of it, each level reaches further than the one before
/// instead.
class RefinementSequence {
 public:
  explicit RefinementSequence(const cases::Case& given);

  /// Number of the first refinement level: -1, or 0 where the order of convergence is known or
  /// there is nothing coarser.
  [[nodiscard]] int first() const;
  /// Number of the last refinement level that may be tried.
  [[nodiscard]] int last() const { return last_; }
  [[nodiscard]] const Resolution& refinement_level(int n) const;

  /// How the error of refinement level n >= 1 follows from changes.
  [[nodiscard]] ErrorPerChange error_per_change(int n) const;
  /// Whether the error falls only as a power of the unknowns.
  [[nodiscard]] bool first_order() const { return method_.scheme == cases::Scheme::upwind; }
  /// Truncation error allowed on refinement level n, relative.
  [[nodiscard]] double tail_tolerance(int n) const;

 private:
  [[nodiscard]] int free_refinement_levels() const;
  [[nodiscard]] Resolution made(int n) const;
  [[nodiscard]] noise::Grouping grouping(int n) const;
  [[nodiscard]] std::vector<double> waves(int n) const;
  [[nodiscard]] int degree(int n) const;
  [[nodiscard]] int points(int n) const;

  model::Scene scene_;
  cases::Method method_;
  double accuracy_;
  quantities::Needs needs_;
  std::vector<double> waves_;  // frequencies of needs_ that leave waves
  int first_degree_ = 0;       // of refinement level 1
  velocity::Integrands integrands_;
  int branches_ = 1;
  bool all_levels_ = false;   // every noise level is a node
  bool tail_counts_ = false;  // what is asked for may weigh the tail anyhow
  bool table_ = false;        // the noise has levels of its own
  int last_;
  mutable std::map<int, Resolution> refinement_levels_;  // those asked for so far
};

}  // namespace stickslip::accuracy
