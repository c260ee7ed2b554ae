#pragma once
/// HDF5 objects that close themselves.

#include <hdf5.h>

namespace stickslip {

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
