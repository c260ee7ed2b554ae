#pragma once
/// Where a result comes from: versions, machine, time.

#include <mpi.h>

#include <string>
#include <utility>
#include <vector>

namespace stickslip::io {

/// Name and text pairs: program, commit, scalar type, PETSc, SLEPc, MUMPS, MPI, BLAS, compiler,
/// host, ranks, date (UTC). Local.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> provenance(MPI_Comm comm);

/// Such as "1.0.0".
[[nodiscard]] std::string version_number();

/// The lines of -version.
[[nodiscard]] std::string version_text();

}  // namespace stickslip::io
