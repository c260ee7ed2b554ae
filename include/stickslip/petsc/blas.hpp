#pragma once
/// Which BLAS this process uses. It decides the speed of a factorisation.

#include <string>

namespace stickslip::petsc {

struct Blas {
  std::string library;  ///< path of the shared library that provides dgemm
  bool reference;       ///< the unoptimised reference implementation, several times slower here
};

/// Looks the loaded library up; local, microseconds.
[[nodiscard]] Blas loaded_blas();

/// Keeps an OpenBLAS to one thread unless the environment names a number: the blocks of these
/// factorisations are too small to gain from threads, and ranks share the cores. One that has
/// threads of its own has one from when it is loaded; this is for one that takes those of OpenMP.
void keep_blas_to_one_thread();

/// Makes OpenBLAS take its work space now: at its first use it would try for ever where there is
/// none. Throws NoMemory if a limit of the address space leaves too little.
void take_blas_space();

/// Operations a second of a matrix product of the size of the fronts that occur here, measured in
/// a few milliseconds on the calling process.
[[nodiscard]] double measured_speed();

}  // namespace stickslip::petsc
