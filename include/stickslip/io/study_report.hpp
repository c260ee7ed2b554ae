#pragma once
/// What a study tells: tables, JSON, HDF5, CSV.

#include <mpi.h>

#include <string>

#include "stickslip/io/report.hpp"
#include "stickslip/studies/study.hpp"

namespace stickslip::io {

/// Tables and conclusions for standard output.
[[nodiscard]] std::string study_table(const options::Request& request, const studies::Study& study,
                                      const RunTimes& times);

/// The JSON summary: `runs` in the place of results, and the tables under `study`.
[[nodiscard]] std::string study_summary(MPI_Comm comm, const options::Request& request,
                                        const studies::Study& study, const RunTimes& times);

/// Every scalar of every run in a row.
[[nodiscard]] std::string study_csv(const studies::Study& study);

/// Writes -output: /study/<table>/<column>, and the record. Collective.
void write_study_hdf5(MPI_Comm comm, const options::Request& request, const studies::Study& study,
                      const RunTimes& times);

}  // namespace stickslip::io
