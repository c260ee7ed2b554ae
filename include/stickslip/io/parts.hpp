#pragma once
/// Parts that reports of runs, studies and sweeps share.

#include <mpi.h>

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "stickslip/io/report.hpp"

namespace stickslip::io {

class Hdf5File;

// JSON for Modern C++: the common header-only writer; numbers are written so that they read back
// to the same bits. It takes seconds to compile: sources that make JSON include it, headers do not.
using Json = nlohmann::ordered_json;

/// The scene in a line.
[[nodiscard]] std::string scene_line(const model::Scene& scene);
/// The discretisation in v as cells of a table of steps, and their title.
[[nodiscard]] std::string axis_cells(const accuracy::Resolution& resolution);
[[nodiscard]] const char* axis_title(options::Scheme scheme);

[[nodiscard]] Json resolution_json(const accuracy::Resolution& resolution);
[[nodiscard]] Json scene_json(const model::Scene& scene);
[[nodiscard]] Json results_json(const quantities::Results& results);
/// What one run found and what it cost: scene, results, accuracy, comparison if any, cost, plan.
/// `compared` is the name of the file of the references.
[[nodiscard]] Json run_json(const options::Case& given, const accuracy::Outcome& outcome,
                            const RunTimes& times, const std::string& compared = {});
[[nodiscard]] Json provenance_json(MPI_Comm comm, const options::Request& request);
[[nodiscard]] Json seconds_json(const petsc::Ledger& ledger);
/// A key of a result as the name of a group or dataset, where a slash would make a group of its
/// own.
[[nodiscard]] std::string hdf5_name(std::string key);
/// get(row) for each row.
template <class Row, class Get>
[[nodiscard]] std::vector<double> column(const std::vector<Row>& rows, Get get) {
  std::vector<double> values;
  for (const Row& row : rows) values.push_back(get(row));
  return values;
}
/// The group /record: provenance, options, seconds.
void write_record(Hdf5File& file, MPI_Comm comm, const options::Request& request,
                  const RunTimes& times);

}  // namespace stickslip::io
