#include "stickslip/outputs/hdf5_file.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <exception>
#include <utility>

#include "stickslip/petsc/session.hpp"
#include "stickslip/support/errors.hpp"
#include "stickslip/support/hdf5_id.hpp"

namespace stickslip::outputs {
namespace {

static_assert(sizeof(hid_t) == sizeof(std::int64_t));

long shared_tag(MPI_Comm comm) {
  long tag = getpid();
  MPI_Bcast(&tag, 1, MPI_LONG, 0, comm);
  return tag;
}

// Throws when HDF5 refused to give an identifier.
Hdf5Id given(hid_t id, herr_t (*close)(hid_t), const std::string& what) {
  if (id < 0) throw SystemFailure("HDF5 refused " + what);
  return {id, close};
}

void require(herr_t status, const std::string& what) {
  if (status < 0) throw SystemFailure("HDF5 could not write " + what);
}

Hdf5Id space_of(std::span<const hsize_t> sizes, const std::string& what) {
  return given(H5Screate_simple(static_cast<int>(sizes.size()), sizes.data(), nullptr), H5Sclose,
               what);
}

Hdf5Id dataset(hid_t file, const std::string& path, hid_t space) {
  return given(H5Dcreate2(file, path.c_str(), H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT,
                          H5P_DEFAULT),
               H5Dclose, path);
}

// Adds rows [first, first + count) of a matrix with `columns` columns to the selection of a space.
void select_rows(hid_t space, H5S_seloper_t how, hsize_t first, hsize_t count, hsize_t columns) {
  const std::array<hsize_t, 2> start{first, 0}, size{count, columns};
  require(H5Sselect_hyperslab(space, how, start.data(), nullptr, size.data(), nullptr), "rows");
}

void write_attribute(hid_t file, const std::string& path, const std::string& name, hid_t type,
                     const void* value) {
  const Hdf5Id object = given(H5Oopen(file, path.c_str(), H5P_DEFAULT), H5Oclose, path);
  const Hdf5Id space = given(H5Screate(H5S_SCALAR), H5Sclose, name);
  const Hdf5Id attribute = given(
      H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, name);
  require(H5Awrite(attribute, type, value), name);
}

}  // namespace

Hdf5File::Hdf5File(MPI_Comm comm, const std::string& target)
    : comm_(comm), file_(target, shared_tag(comm)) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // failures are reported by exceptions
  const Hdf5Id access = given(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "a list of properties");
  require(H5Pset_fapl_mpio(access, comm, MPI_INFO_NULL), file_.part());
  id_ = H5Fcreate(file_.part().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access);
  if (id_ < 0) throw SystemFailure("cannot create " + file_.part());
}

Hdf5File::~Hdf5File() {
  // Collective: where one rank unwinds alone, the others would be waited for.
  const bool alone = std::uncaught_exceptions() > 0 && petsc::ranks(comm_) > 1;
  if (id_ >= 0 && !alone) (void)H5Fclose(id_);
}

void Hdf5File::make_group(const std::string& path) {
  const Hdf5Id group =
      given(H5Gcreate2(id_, path.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose, path);
}

void Hdf5File::write_array(const std::string& path, std::span<const double> values) {
  write_array(path, std::array{values.size()}, values);
}

void Hdf5File::write_array(const std::string& path, std::span<const std::size_t> sizes,
                           std::span<const double> values) {
  const std::vector<hsize_t> counts(sizes.begin(), sizes.end());
  const Hdf5Id space = space_of(counts, path);
  const Hdf5Id data = dataset(id_, path, space);
  if (petsc::rank(comm_) != 0) return;
  require(H5Dwrite(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), path);
}

void Hdf5File::write_scalar(const std::string& path, double value) {
  write_array(path, std::span<const std::size_t>{}, {&value, 1});
}

void Hdf5File::write_rows(const std::string& path, std::size_t row_count, std::size_t columns,
                          std::span<const std::size_t> rows, std::span<const double> values) {
  const std::array<hsize_t, 2> size{row_count, columns};
  const Hdf5Id file_space = space_of(size, path);
  const Hdf5Id data = dataset(id_, path, file_space);
  // One row at a time: HDF5 writes a selection in the order of the file, not of `rows`.
  for (std::size_t n = 0; n < rows.size(); ++n) {
    const std::array<hsize_t, 2> one{1, columns};
    const Hdf5Id memory_space = space_of(one, path);
    select_rows(file_space, H5S_SELECT_SET, rows[n], 1, columns);
    require(H5Dwrite(data, H5T_NATIVE_DOUBLE, memory_space, file_space, H5P_DEFAULT,
                     values.data() + n * columns),
            path);
  }
}

void Hdf5File::attribute(const std::string& path, const std::string& name,
                         const std::string& value) {
  const Hdf5Id type = given(H5Tcopy(H5T_C_S1), H5Tclose, name);
  require(H5Tset_size(type, H5T_VARIABLE), name);
  require(H5Tset_cset(type, H5T_CSET_UTF8), name);
  const char* text = value.c_str();
  write_attribute(id_, path, name, type, &text);
}

void Hdf5File::attribute(const std::string& path, const std::string& name, double value) {
  write_attribute(id_, path, name, H5T_NATIVE_DOUBLE, &value);
}

void Hdf5File::commit() {
  require(H5Fflush(id_, H5F_SCOPE_GLOBAL), file_.part());
  require(H5Fclose(std::exchange(id_, -1)), file_.part());
  if (petsc::rank(comm_) == 0) file_.commit();
  MPI_Barrier(comm_);
}

}  // namespace stickslip::outputs
