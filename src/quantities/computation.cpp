#include "stickslip/quantities/computation.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/session.hpp"
#include "stickslip/quantities/uncertain.hpp"

namespace stickslip::quantities {

std::string reason_to_go_on(MPI_Comm comm) {
  const Failure failure = petsc::failure_in_flight();
  const bool ends_all =
      failure.status() == ExitStatus::no_memory || failure.status() == ExitStatus::bad_input;
  if (petsc::ranks(comm) > 1 || ends_all) throw;
  return failure.what();
}

void attempt(const Problem& problem, Evaluation& evaluation, catalogue::Quantity quantity,
             const std::function<void()>& work) {
  if (evaluation.failed.contains(quantity)) return;
  try {
    work();
  } catch (...) {
    evaluation.failed[quantity] = reason_to_go_on(problem.comm);
  }
}

namespace {

// What the results of a row are called: one for each observable, time or speed.
std::vector<std::string> keys_of(const Row& row, const cases::Question& question) {
  if (!row.is_pattern()) return {std::string(row.key)};
  std::vector<std::string> keys;
  const bool of_time = row.key.ends_with("(t)"), of_speed = row.key.ends_with("(w)");
  for (double value : of_time ? question.time : question.velocity) {
    if (of_time || of_speed) keys.push_back(row.key_of(fmt::format("{}", value)));
  }
  for (const auto& f : question.observables) {
    if (!of_time && !of_speed) keys.push_back(row.key_of(f.name));
  }
  return keys;
}

}  // namespace

Results without_values(const cases::Case& given, catalogue::Quantity quantity,
                       const std::string& reason) {
  Results results;
  const auto& entry =
      **std::ranges::find(catalogue::entries(), quantity, &catalogue::Entry::quantity);
  for (const Row* row : entry.rows) {
    if (row->without.contains(given.method.route)) continue;
    for (const auto& key : keys_of(*row, given.question)) {
      Result result = array(*row, given.question.values(row->abscissa));
      result.key = key;
      result.unreached = reason;
      const std::size_t count = result.is_scalar() ? 1 : result.abscissa.size();
      for (std::size_t n = 0; n < count; ++n) append_value(result, kNoValue);
      if (count > 0) results.push_back(std::move(result));
    }
  }
  return results;
}

}  // namespace stickslip::quantities
