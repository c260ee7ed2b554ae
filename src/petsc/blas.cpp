#include "stickslip/petsc/blas.hpp"

#include <dlfcn.h>
#include <petscsys.h>
// After PETSc itself, whose types it uses.
#include <petscblaslapack.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <vector>

#include "stickslip/petsc/memory.hpp"
#include "stickslip/support/errors.hpp"
#include "stickslip/support/infinity.hpp"

namespace {

constexpr const char* kOfOpenBlas = "OPENBLAS_NUM_THREADS";

bool names_threads() {
  return secure_getenv(kOfOpenBlas) != nullptr || secure_getenv("OMP_NUM_THREADS") != nullptr;
}

}  // namespace

// The program's getenv() stands before that of the C library, also for shared libraries. OpenBLAS
// makes its threads when it is loaded, before main() could set a variable; where a limit of the
// address space leaves them no work space, they try for ever, and the end of the program waits for
// them. To start the program anew with the variable set would double the time of loading.
extern "C" char* getenv(const char* name) noexcept {
  static char one[] = "1";
  char* const value = secure_getenv(name);
  const bool open = value == nullptr && std::strcmp(name, kOfOpenBlas) == 0 && !names_threads();
  return open ? one : value;
}

namespace stickslip::petsc {
namespace {

bool names_optimised(const std::string& path) {
  for (const char* name : {"openblas", "mkl", "blis", "atlas", "armpl", "nvpl"}) {
    if (path.find(name) != std::string::npos) return true;
  }
  return false;
}

// OpenBLAS takes 128 MB at a time.
constexpr double kBlasSpace = 140e6;

}  // namespace

void take_blas_space() {
  const double left = left_in_address_space();
  if (left < kBlasSpace) {
    throw NoMemory(
        "the limit of the address space (ulimit -v) leaves no memory for linear algebra; "
        "raise it");
  }
  PetscScalar one = 1;
  PetscBLASInt size = 1, pivot = 0, info = 0;
  LAPACKgetrf_(&size, &size, &one, &size, &pivot, &info);
}

Blas loaded_blas() {
  void* dgemm = dlsym(RTLD_DEFAULT, "dgemm_");
  Dl_info info{};
  if (dgemm == nullptr || dladdr(dgemm, &info) == 0 || info.dli_fname == nullptr) {
    return {"unknown", false};
  }
  // Debian's alternatives hide the implementation behind libblas.so.3: follow the link.
  std::error_code error;
  const auto resolved = std::filesystem::canonical(info.dli_fname, error);
  const std::string path = error ? std::string(info.dli_fname) : resolved.string();
  return {path, !names_optimised(path)};
}

void keep_blas_to_one_thread() {
  if (names_threads()) return;
  using SetThreads = void (*)(int);
  if (auto set = reinterpret_cast<SetThreads>(dlsym(RTLD_DEFAULT, "openblas_set_num_threads"))) {
    set(1);
  }
}

double measured_speed() {
  constexpr PetscBLASInt n = 192;
  constexpr int repetitions = 6;
  constexpr std::size_t entries = std::size_t{n} * n;
  const std::vector<PetscScalar> a(entries, 0.5), b(entries, 0.25);
  std::vector<PetscScalar> c(entries, 0.0);
  const PetscScalar one = 1, zero = 0;
  double best = kInfinity;
  for (int r = 0; r < repetitions; ++r) {
    const auto start = std::chrono::steady_clock::now();
    BLASgemm_("N", "N", &n, &n, &n, &one, a.data(), &n, b.data(), &n, &zero, c.data(), &n);
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
    best = std::min(best, spent.count());
  }
  return 2.0 * n * n * n / best;
}

}  // namespace stickslip::petsc
