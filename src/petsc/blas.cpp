#include "stickslip/petsc/blas.hpp"

#include <dlfcn.h>
#include <petscsys.h>
#include <unistd.h>
// After PETSc itself, whose types it uses.
#include <petscblaslapack.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <vector>

#include "stickslip/petsc/memory.hpp"
#include "stickslip/support/errors.hpp"
#include "stickslip/support/infinity.hpp"

namespace stickslip::petsc {
namespace {

bool names_threads() {
  return std::getenv("OPENBLAS_NUM_THREADS") != nullptr ||
         std::getenv("OMP_NUM_THREADS") != nullptr;
}

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

void restart_with_one_blas_thread(char** arguments) {
  if (names_threads() || std::isinf(left_in_address_space())) return;
  setenv("OPENBLAS_NUM_THREADS", "1", 1);
  execv("/proc/self/exe", arguments);  // where it fails, this process goes on
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
