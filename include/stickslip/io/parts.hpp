#pragma once
/// Parts that reports of runs, studies, plans and sweeps share.

#include <mpi.h>

#include <string>
#include <vector>

#include "stickslip/io/reports.hpp"
#include "stickslip/io/text_table.hpp"

namespace stickslip::io {

using outputs::Json;

/// The model parameters, on as many lines as they take.
[[nodiscard]] std::string scene_text(const model::Scene& scene);
/// The columns that tell the size of a discretisation, and their cells.
[[nodiscard]] std::vector<TextTable::Column> size_columns(cases::Scheme scheme);
[[nodiscard]] std::vector<std::string> size_cells(const accuracy::Resolution& resolution,
                                                  std::int64_t unknowns, std::int64_t nonzeros);
/// Entries of a matrix or factorisation; "-" for none, where they are not known.
[[nodiscard]] std::string count_text(double count);
/// A row for each refinement level: its size, memory, times and largest relative error estimate;
/// then iterations, and what the solution method reports of itself. Of a simulation its size.
[[nodiscard]] std::string cost_table(cases::Scheme scheme, const accuracy::Outcome& outcome);
/// A number in a cell of CSV; nothing for NaN.
[[nodiscard]] std::string cell(double value, int digits);

[[nodiscard]] Json resolution_json(const accuracy::Resolution& resolution);
[[nodiscard]] Json scene_json(const model::Scene& scene);
/// What one run found and what it cost: scene, results, accuracy, comparison if any, cost, plan.
/// `compared` is the name of the file of the references.
[[nodiscard]] Json run_json(const cases::Case& given, const accuracy::Outcome& outcome,
                            const RunTimes& times, const std::string& compared = {});
[[nodiscard]] Json seconds_json(const petsc::SolverStatistics& statistics);
/// The beginning of a report: where it comes from, and what it took.
[[nodiscard]] outputs::Report report_from(MPI_Comm comm, const options::Request& request,
                                          outputs::Subject subject, const RunTimes& times);
/// The text of the report of a run.
[[nodiscard]] std::string run_table(const options::Request& request,
                                    const accuracy::Outcome& outcome, const RunTimes& times);

}  // namespace stickslip::io
