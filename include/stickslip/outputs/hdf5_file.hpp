#pragma once
/// A parallel HDF5 file with datasets of plain doubles.

#include <mpi.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "stickslip/support/atomic_file.hpp"

namespace stickslip::outputs {

/// Written with the HDF5 library itself: PETSc's viewer would store every number of the complex
/// program as a pair, and both programs write the same file. All members are collective with equal
/// arguments, but for rows.
class Hdf5File {
 public:
  /// Creates the file beside `target`; commit() moves it there.
  Hdf5File(MPI_Comm comm, const std::string& target);
  ~Hdf5File();
  Hdf5File(const Hdf5File&) = delete;
  Hdf5File& operator=(const Hdf5File&) = delete;

  void make_group(const std::string& path);
  /// A dataset that every rank holds; written by rank 0.
  void write_array(const std::string& path, std::span<const double> values);
  /// An array with several indices, the last one fastest, or with none: a scalar.
  void write_array(const std::string& path, std::span<const std::size_t> sizes,
                   std::span<const double> values);
  void write_scalar(const std::string& path, double value);
  /// A matrix of which this rank holds whole rows: values row after row, in the order of `rows`.
  void write_rows(const std::string& path, std::size_t row_count, std::size_t columns,
                  std::span<const std::size_t> rows, std::span<const double> values);
  void attribute(const std::string& path, const std::string& name, const std::string& value);
  void attribute(const std::string& path, const std::string& name, double value);

  /// Closes the file and moves it over the target.
  void commit();

 private:
  MPI_Comm comm_;
  AtomicFile file_;
  std::int64_t id_;  // of HDF5, whose headers stay out of this one
};

}  // namespace stickslip::outputs
