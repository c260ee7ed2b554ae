#pragma once
/// A number that all ranks count up, each value given once.

#include <mpi.h>

namespace stickslip::sweeps {

/// Lives in the memory of rank 0, which takes no part when others count (one-sided MPI). Not to be
/// copied; construction and destruction are collective. When it dies while an exception unwinds,
/// the window is left to MPI_Abort, since the other ranks would never join.
class SharedCounter {
 public:
  explicit SharedCounter(MPI_Comm comm);
  ~SharedCounter();
  SharedCounter(const SharedCounter&) = delete;
  SharedCounter& operator=(const SharedCounter&) = delete;

  /// 0, 1, 2, ...: the value before it is counted up. Not collective.
  [[nodiscard]] long next();

 private:
  MPI_Win window_ = MPI_WIN_NULL;  // none on one rank
  long* value_ = nullptr;          // of rank 0
  long alone_ = 0;
};

}  // namespace stickslip::sweeps
