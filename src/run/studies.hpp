#pragma once
/// The studies one by one, and what they share.

#include <limits>

#include "stickslip/run/study.hpp"

namespace stickslip::run {

/// What every study is given.
struct Context {
  MPI_Comm comm;
  const cases::Case& given;
  const StudyOptions& study;
  const StudyProgress& progress;

  /// The progress line of run `number` of `count`.
  void report(int number, int count, const std::string& what) const {
    if (progress) progress(number, count, what);
  }
};

[[nodiscard]] Study study_heuristic(const Context& context);
[[nodiscard]] Study study_cost(const Context& context);

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// The numbers that are not 0, in their order; those of arrays are named after their arguments,
/// such as "S_v omega=1".
[[nodiscard]] quantities::Results scalars(const quantities::Results& results);
/// Value of the scalar `key`; NaN if there is none.
[[nodiscard]] double value_of(const quantities::Results& results, const std::string& key);
/// Sets the errors of the results to their distances from the values of the same name in `known`.
void set_errors(const quantities::Results& known, quantities::Results& results);
/// The case with another noise step, and without choices of the discretisation made by hand.
[[nodiscard]] cases::Case with_delta(const cases::Case& given, double delta);
/// Noise and velocity of upwind runs are truncated where they weigh less: far less than the error
/// of the scheme, which is about 1/p.
constexpr double kUpwindTail = 1e-9;
/// Upwind with p points per noise step.
[[nodiscard]] Run upwind_run(const Context& context, const cases::Case& given, int points,
                             double tail = kUpwindTail);
/// Throws NoMemory if that run would not fit: no study computes for long only to end there.
void require_upwind_memory(const Context& context, const cases::Case& given, int points,
                           double tail = kUpwindTail);
/// The case with a scheme, and without choices of the discretisation made by hand.
[[nodiscard]] cases::Case by_scheme(const cases::Case& given, cases::Scheme scheme);
/// Has a run found its results on one discretisation; where that fails it has none, and says why.
[[nodiscard]] Run solved_on(MPI_Comm comm, Run run, const cases::Case& given,
                            const Resolution& resolution);
/// Refined hp.
[[nodiscard]] Run converged_run(const Context& context, const cases::Case& given, double accuracy);

}  // namespace stickslip::run
