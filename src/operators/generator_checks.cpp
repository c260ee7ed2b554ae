#include "stickslip/operators/generator_checks.hpp"

#include <fmt/format.h>

#include <cmath>

#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/session.hpp"
#include "stickslip/support/errors.hpp"

namespace stickslip::operators {
namespace {

constexpr double kRounding = 1e-12;  // of a row sum, against the diagonal
constexpr double kNegligible = 1e-9;

// Off-diagonals and their sum in one pass; the diagonal was summed in the same order.
struct Row {
  double diagonal = 0, others = 0;
  double largest = -HUGE_VAL;  // off-diagonal: at most 0 if monotone
};

Row read_row(const LocalRows& rows, PetscInt r) {
  Row row;
  for (PetscInt n = rows.row_start[r]; n < rows.row_start[r + 1]; ++n) {
    const double value = PetscRealPart(rows.values[n]);
    if (rows.columns[n] == rows.first + r) {
      row.diagonal = value;
    } else {
      row.others += value;
      if (!(value <= row.largest)) row.largest = value;  // NaN is kept
    }
  }
  return row;
}

std::string complaint(const Row& row, Promise promise) {
  const double sum = row.diagonal + row.others, rounding = kRounding * std::abs(row.diagonal);
  if (promise.monotone && !(row.largest <= 0)) {
    return fmt::format("a jump rate of {:.2g}", -row.largest);
  }
  if (promise.monotone && !(sum >= -rounding)) return fmt::format("a killing rate of {:.2g}", sum);
  if (promise.conservative && !(std::abs(sum) <= rounding)) {
    return fmt::format("a row sum of {:.2g}", sum);
  }
  return "";
}

std::string broken_promise(const LocalRows& rows, Promise promise) {
  for (PetscInt r = 0; r + 1 < static_cast<PetscInt>(rows.row_start.size()); ++r) {
    const bool alone = rows.row_start[r + 1] - rows.row_start[r] < 2;
    const std::string what = alone ? "" : complaint(read_row(rows, r), promise);
    if (!what.empty()) return fmt::format("the generator has {} in row {}", what, rows.first + r);
  }
  return "";
}

}  // namespace

void require_generator(MPI_Comm comm, const LocalRows& rows, Promise promise,
                       const model::Process& process) {
  const std::string broken = broken_promise(rows, promise);
  petsc::require_everywhere(comm, broken.empty() ? "" : broken + model::please_report(process));
}

void require_occupation(Vec nu, const model::Process& process) {
  PetscReal smallest = 0, largest = 0;
  petsc::check(VecMin(nu, nullptr, &smallest));
  petsc::check(VecMax(nu, nullptr, &largest));
  if (smallest >= -kNegligible * largest) return;
  throw NotReached(fmt::format("an occupation reaches from {:.2g} to {:.2g} and must not be "
                               "negative{}",
                               smallest, largest, model::please_report(process)));
}

}  // namespace stickslip::operators
