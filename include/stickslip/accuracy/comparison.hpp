#pragma once
/// Results compared with values of other origin.

#include <optional>
#include <string>
#include <vector>

#include "stickslip/cases/case.hpp"
#include "stickslip/quantities/results.hpp"

namespace stickslip::accuracy {

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

}  // namespace stickslip::accuracy
