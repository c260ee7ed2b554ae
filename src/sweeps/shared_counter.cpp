#include "shared_counter.hpp"

#include <exception>

#include "stickslip/petsc/session.hpp"

namespace stickslip::sweeps {

SharedCounter::SharedCounter(MPI_Comm comm) {
  if (petsc::ranks(comm) == 1) return;
  const MPI_Aint size = petsc::rank(comm) == 0 ? sizeof(long) : 0;
  MPI_Win_allocate(size, sizeof(long), MPI_INFO_NULL, comm, static_cast<void*>(&value_), &window_);
  MPI_Win_lock_all(0, window_);
  if (size > 0) *value_ = 0;
  MPI_Win_sync(window_);
  MPI_Barrier(comm);
}

SharedCounter::~SharedCounter() {
  if (window_ == MPI_WIN_NULL || std::uncaught_exceptions() > 0) return;
  MPI_Win_unlock_all(window_);
  MPI_Win_free(&window_);
}

long SharedCounter::next() {
  if (window_ == MPI_WIN_NULL) return alone_++;
  const long one = 1;
  long before = 0;
  MPI_Fetch_and_op(&one, &before, MPI_LONG, 0, 0, MPI_SUM, window_);
  MPI_Win_flush(0, window_);
  return before;
}

}  // namespace stickslip::sweeps
