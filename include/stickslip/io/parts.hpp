#pragma once
/// Parts that reports of runs, studies, plans and sweeps share.

#include <mpi.h>

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "stickslip/io/report.hpp"
#include "stickslip/io/text_table.hpp"

namespace stickslip::io {

class Hdf5File;

// JSON for Modern C++: the common header-only writer; numbers are written so that they read back
// to the same bits. It takes seconds to compile: sources that make JSON include it, headers do not.
using Json = nlohmann::ordered_json;

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
/// A line of CSV (RFC 4180: what holds a comma stands in quotes).
[[nodiscard]] std::string csv_line(const std::vector<std::string>& cells);

[[nodiscard]] Json resolution_json(const accuracy::Resolution& resolution);
[[nodiscard]] Json scene_json(const model::Scene& scene);
[[nodiscard]] Json results_json(const quantities::Results& results);
/// What one run found and what it cost: scene, results, accuracy, comparison if any, cost, plan.
/// `compared` is the name of the file of the references.
[[nodiscard]] Json run_json(const cases::Case& given, const accuracy::Outcome& outcome,
                            const RunTimes& times, const std::string& compared = {});
[[nodiscard]] Json comparison_json(const accuracy::Comparison& comparison,
                                   const std::string& compared);
[[nodiscard]] Json provenance_json(MPI_Comm comm, const options::Request& request);
[[nodiscard]] Json seconds_json(const petsc::SolverStatistics& statistics);
/// The text of a summary: the tree, and where it comes from.
[[nodiscard]] std::string summary_text(MPI_Comm comm, const options::Request& request, Json tree);

/// A key of a result as the name of a group or dataset, where a slash would make a group of its
/// own.
[[nodiscard]] std::string hdf5_name(std::string key);
/// Writes a tree to a group of its own: objects as groups, texts and truths (yes, no) as attributes
/// of their group, numbers and arrays of numbers as datasets, ci95 as two of them, low and high.
/// Collective with equal trees.
void write_tree(Hdf5File& file, const std::string& group, const Json& tree);
/// The group /record: provenance, options, seconds.
void write_record(Hdf5File& file, MPI_Comm comm, const options::Request& request,
                  const RunTimes& times);

}  // namespace stickslip::io
