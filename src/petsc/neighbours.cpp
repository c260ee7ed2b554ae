#include "stickslip/petsc/neighbours.hpp"

#include "stickslip/petsc/session.hpp"

namespace stickslip::petsc {

Neighbours neighbours(MPI_Comm comm, int links) {
  const int ranks = petsc::ranks(comm), here = petsc::rank(comm);
  std::vector<int> all(static_cast<std::size_t>(ranks));
  MPI_Allgather(&links, 1, MPI_INT, all.data(), 1, MPI_INT, comm);
  Neighbours found;
  if (links == 0) return found;
  for (int r = 0; r < here; ++r) {
    if (all[r] > 0) found.inner = r;
  }
  for (int r = ranks - 1; r > here; --r) {
    if (all[r] > 0) found.outer = r;
  }
  return found;
}

}  // namespace stickslip::petsc
