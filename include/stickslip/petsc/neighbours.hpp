#pragma once
/// Messages along a chain whose links are dealt out to the ranks in order.

#include <petscsys.h>

#include <vector>

namespace stickslip::petsc {

/// The ranks next to this one that hold a part of the chain; MPI_PROC_NULL at its ends, and where
/// this rank holds none.
struct Neighbours {
  int inner = MPI_PROC_NULL, outer = MPI_PROC_NULL;
  [[nodiscard]] bool has_inner() const { return inner != MPI_PROC_NULL; }
  [[nodiscard]] bool has_outer() const { return outer != MPI_PROC_NULL; }
};

/// `links`: of this rank. Collective.
[[nodiscard]] Neighbours neighbours(MPI_Comm comm, int links);

template <class T>
MPI_Datatype mpi_type();
template <>
inline MPI_Datatype mpi_type<PetscScalar>() {
  return MPIU_SCALAR;
}
template <>
inline MPI_Datatype mpi_type<int>() {
  return MPI_INT;
}

template <class T>
void send(const std::vector<T>& data, int to, MPI_Comm comm) {
  MPI_Send(data.data(), static_cast<int>(data.size()), mpi_type<T>(), to, 0, comm);
}

template <class T>
[[nodiscard]] std::vector<T> receive(std::size_t count, int from, MPI_Comm comm) {
  std::vector<T> data(count);
  MPI_Recv(data.data(), static_cast<int>(count), mpi_type<T>(), from, 0, comm, MPI_STATUS_IGNORE);
  return data;
}

}  // namespace stickslip::petsc
