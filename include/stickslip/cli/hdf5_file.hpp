#pragma once
/// A parallel HDF5 file with datasets of plain doubles.

#include <hdf5.h>
#include <mpi.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "stickslip/base/files.hpp"

namespace stickslip {

// HDF5 objects that close themselves.

/// An HDF5 identifier and how to close it; HDF5 may have refused to give one.
class Hdf5Id {
 public:
  Hdf5Id(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Hdf5Id() {
    if (valid()) close_(id_);
  }
  Hdf5Id(const Hdf5Id&) = delete;
  Hdf5Id& operator=(const Hdf5Id&) = delete;
  // NOLINTNEXTLINE(google-explicit-constructor): stands for its identifier in HDF5 calls.
  operator hid_t() const { return id_; }
  [[nodiscard]] bool valid() const { return id_ >= 0; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

}  // namespace stickslip

namespace stickslip::cli {

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
  /// The dimension scale of each index of a dataset, by which xarray, netCDF and MATLAB name and
  /// label it; empty where an index has none. A dataset that is its own axis becomes a scale.
  void set_axes(const std::string& path, const std::vector<std::string>& axes);
  void attribute(const std::string& path, const std::string& name, const std::string& value);
  void attribute(const std::string& path, const std::string& name, double value);

  /// Closes the file and moves it over the target.
  void commit();

 private:
  MPI_Comm comm_;
  AtomicFile file_;
  std::int64_t id_;  // of HDF5, whose headers stay out of this one
};

}  // namespace stickslip::cli
