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

/// Under a limit of the address space, starts the program anew with one thread for OpenBLAS. That
/// makes its threads while it is loaded, before main(); without space for their work they try for
/// ever, and the end of the program would wait for them. Takes as long as loading the program, and
/// returns where there is no limit or the environment names a number of threads.
void restart_with_one_blas_thread(char** arguments);

/// Keeps an OpenBLAS to one thread unless the environment names a number: the blocks of these
/// factorisations are too small to gain from threads, and ranks share the cores.
void keep_blas_to_one_thread();

/// Makes OpenBLAS take its work space now: at its first use it would try for ever where there is
/// none. Throws NoMemory if a limit of the address space leaves too little.
void take_blas_space();

/// Operations a second of a matrix product of the size of the fronts that occur here, measured in
/// a few milliseconds on the calling process.
[[nodiscard]] double measured_speed();

}  // namespace stickslip::petsc
