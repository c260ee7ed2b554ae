#pragma once
/// Error estimates of results: what refinement shows, and what it cannot show.

#include <string>
#include <vector>

#include "stickslip/base/text.hpp"
#include "stickslip/case/case.hpp"
#include "stickslip/quantities/results.hpp"

namespace stickslip::run {

/// error >= least |value| for every value. Sums of positive terms over levels are rounded even
/// where nothing else is wrong, as for a mean duration of sticking that has the same hitting
/// distribution on every discretisation; what all discretisations cut off changes with none.
void require_least_error(double least, quantities::Results& results);

/// The error of an entry whose relative error is above `digit` is at least its size: a mode in a
/// continuous spectrum moves slowly from one discretisation to the next, and changes understate how
/// far.
void doubt_without_digit(double digit, quantities::Result& result);

/// |change| from one discretisation to the next, by result and entry.
using Changes = std::vector<std::vector<double>>;

/// By how much an error exceeds a change.
struct ErrorPerChange {
  double last = 1;                ///< the change to this discretisation
  double earlier = 0;             ///< the change to the one before
  double alone = 1;               ///< both, of what shares no errors with means of its family
  double of_other_family = 0;     ///< what the means of one family tell of the other
  double of_waves = 1;            ///< both, of values of a spectrum that may have waves
  double waves_from = kInfinity;  ///< the lowest frequency of these
  double most_fall = kInfinity;   ///< of the error of a mean, from one discretisation to the next
};

/// Adds the error of the discretisation,
///
///   d = |(last |change from coarse|, earlier |change before|)|,   Euclidean norm,
///   error += |(d, 0.65 size rms(d/size))|,
///
/// where the mean square is over the means of the same stationary distribution and family, whose
/// errors are alike within a decade or two: a change that vanishes by accident hides an error,
/// which the changes before it and of the other means show. Durations are one family, functions of
/// the velocity the other; `of_other_family` times its rms takes the place of the own one where it
/// is larger, as all changes of a family may vanish at once. The size of a mean is its value; that
/// of P_stick and P_slide, of which P_slide/P_stick is a ratio of two durations, is P_stick
/// P_slide. What changes by less than 1e-13 does not depend on the discretisation and takes no
/// share; the drift, which may vanish, gives none.
///
/// With two coarser discretisations the error of a mean or of a probability of a phase is at least
/// that on `coarse` over `most_fall`: where it falls by more, several changes were small by
/// accident.
///
/// An entry u_i of an array over anything but modes gets at least
///
///   error_i = 0.7 max over |j - i| <= 2 of d_j min(1, |u_i/u_j|).
///
/// What is no mean and no probability of a phase has `alone` d in the place of d; values of a
/// spectrum from `waves_from` on have `of_waves` times that, with `earlier` at least 0.2 `last`.
///
/// The derivative of a mean by a parameter has 1.5 `alone` d, and takes 1.5 `alone` times the
/// larger share of both families: derivatives decide no status, but searches trust their errors.
///
/// A value that `coarse` lacks is all change; `before` is empty where there are no two coarser
/// discretisations. Returns the changes from `coarse`.
[[nodiscard]] Changes add_discretisation(const ErrorPerChange& factor,
                                         const quantities::Results& coarse, const Changes& before,
                                         quantities::Results& results);

// What holds of results whatever the model parameters.

/// What no result may show, beyond its errors: a probability, a transform F or a distribution
/// function outside [0, 1], an F that rises with lambda, a distribution function that falls with
/// time, a negative second moment, mean duration or spectrum. The first violation in words; empty
/// if there is none. Simulated results scatter, and are not looked at. O(values).
[[nodiscard]] std::string broken_bound(const quantities::Results& results);

// Results compared with values of other origin.

enum class Verdict { agrees, by_chance, disagrees };

/// "agrees", "by chance", "DISAGREES".
[[nodiscard]] const char* verdict_text(Verdict verdict);

/// One value beside its reference.
struct Compared {
  cases::Reference reference;
  double value = 0, error = 0;  ///< ours
  double z = 0;                 ///< difference in standard deviations
  Verdict verdict = Verdict::agrees;
};

struct Comparison {
  std::vector<Compared> rows;
  std::vector<std::string> left_out;  ///< quantities of the file that were not computed
  bool disagrees = false;
};

/// z = (ours - reference)/sigma, where sigma joins the half of the reference's confidence interval
/// on the side of our value with our error (a bound, or half of a confidence interval if ours is
/// simulated). |z| < 1.96 agrees; what is beyond is chance unless Holm's step-down test rejects it
/// at the family-wise level 1e-3. References without counterpart are left out. Local.
[[nodiscard]] Comparison compare(const std::vector<cases::Reference>& references,
                                 const quantities::Results& results);

}  // namespace stickslip::run
