#include "stickslip/io/provenance.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <petscsys.h>
#include <slepcversion.h>
#include <unistd.h>

#include <array>
#include <ctime>

#include "stickslip/io/version.hpp"
#include "stickslip/petsc/blas.hpp"
#include "stickslip/petsc/session.hpp"

namespace stickslip::io {
namespace {

std::string host() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
}

std::string mpi_library() {
  std::array<char, MPI_MAX_LIBRARY_VERSION_STRING> text{};
  int length = 0;
  MPI_Get_library_version(text.data(), &length);
  const std::string all(text.data());
  return all.substr(0, all.find_first_of(",\n"));
}

std::string compiler() {
#ifdef __clang__
  return fmt::format("clang {}.{}.{}", __clang_major__, __clang_minor__, __clang_patchlevel__);
#else
  return fmt::format("gcc {}.{}.{}", __GNUC__, __GNUC_MINOR__, __GNUC_PATCHLEVEL__);
#endif
}

std::string petsc_version() {
  return fmt::format("{}.{}.{}", PETSC_VERSION_MAJOR, PETSC_VERSION_MINOR, PETSC_VERSION_SUBMINOR);
}

std::string slepc_version() {
  return fmt::format("{}.{}.{}", SLEPC_VERSION_MAJOR, SLEPC_VERSION_MINOR, SLEPC_VERSION_SUBMINOR);
}

const char* scalar_type() { return petsc::complex_scalars() ? "complex" : "real"; }

}  // namespace

std::vector<std::pair<std::string, std::string>> provenance(MPI_Comm comm) {
  return {{"program", "stickslip " + std::string(kVersion)},
          {"commit", kCommit},
          {"scalar", scalar_type()},
          {"petsc", petsc_version()},
          {"slepc", slepc_version()},
          {"mpi", mpi_library()},
          {"blas", petsc::loaded_blas().library},
          {"compiler", compiler()},
          {"host", host()},
          {"ranks", std::to_string(petsc::ranks(comm))},
          {"date", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)))}};
}

std::string version_number() { return kVersion; }

std::string version_text() {
  return fmt::format("stickslip {} ({}, {} scalars)\nPETSc {}, SLEPc {}, BLAS {}\n", kVersion,
                     kCommit, scalar_type(), petsc_version(), slepc_version(),
                     petsc::loaded_blas().library);
}

}  // namespace stickslip::io
