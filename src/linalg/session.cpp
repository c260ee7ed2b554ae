#include "stickslip/linalg/session.hpp"

#include <fmt/format.h>
#include <malloc.h>
#include <slepcsys.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <new>
#include <optional>
#include <sstream>
#include <system_error>
#include <utility>

#include <dlfcn.h>
#include <petscsys.h>
#include <unistd.h>
// After PETSc itself, whose types it uses.
#include <petscblaslapack.h>

#include "stickslip/base/errors.hpp"
#include "stickslip/base/text.hpp"
#include "stickslip/linalg/petsc.hpp"
#include "stickslip/linalg/solver_options.hpp"

namespace stickslip::linalg {
namespace {

// Ranks of this run on this machine. The first call is collective on MPI_COMM_WORLD; Session makes
// it.
int ranks_on_node() {
  static const int ranks = [] {
    MPI_Comm node = MPI_COMM_NULL;
    MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &node);
    int count = 1;
    MPI_Comm_size(node, &count);
    MPI_Comm_free(&node);
    return count;
  }();
  return ranks;
}

constexpr double kUnlimited = kInfinity;

// The value of a line "Name:  12345 kB" in a file of /proc, in bytes.
double proc_value(const char* file, const std::string& name) {
  std::ifstream lines(file);
  std::string line;
  while (std::getline(lines, line)) {
    if (!line.starts_with(name + ":")) continue;
    double kilobytes = 0;
    std::istringstream(line.substr(name.size() + 1)) >> kilobytes;
    return 1024 * kilobytes;
  }
  return kUnlimited;
}

double number_in(const std::string& file) {
  std::ifstream stream(file);
  double value = kUnlimited;
  return stream >> value ? value : kUnlimited;  // "max" or no such file: no limit
}

// Folder of the control group of this process (version 2).
std::string control_group() {
  std::ifstream lines("/proc/self/cgroup");
  std::string line;
  while (std::getline(lines, line)) {
    if (line.starts_with("0::")) return "/sys/fs/cgroup" + line.substr(3) + "/";
  }
  return "/sys/fs/cgroup/";
}

// Limit less use; file caches count as use there, but give way.
double left_in_control_group() {
  const std::string folder = control_group();
  const double limit = number_in(folder + "memory.max");
  if (limit == kUnlimited) return kUnlimited;
  std::ifstream words(folder + "memory.stat");
  double cached = 0, value = 0;
  for (std::string name; words >> name >> value;) {
    if (name == "file") cached = value;
  }
  return limit - number_in(folder + "memory.current") + cached;
}

double available_now(MPI_Comm comm) {
  const double shared =
      std::min(proc_value("/proc/meminfo", "MemAvailable"), left_in_control_group());
  double mine = std::max(0.0, std::min(shared / ranks_on_node(), left_in_address_space()));
  // Ranks share the work evenly: the poorest decides.
  MPI_Allreduce(MPI_IN_PLACE, &mine, 1, MPI_DOUBLE, MPI_MIN, comm);
  return mine * ranks(comm);
}

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

std::string& pending_text() {
  static std::string text;
  return text;
}

std::exception_ptr& kept_exception() {
  static std::exception_ptr exception;
  return exception;
}

// Of errors by exceptions; PETSc itself has none of that number.
constexpr PetscErrorCode kException = PETSC_ERR_MAX_VALUE + 1;

PetscErrorCode append_message(MPI_Comm, int line, const char* function, const char* file,
                              PetscErrorCode code, PetscErrorType type, const char* message,
                              void*) {
  std::string& text = pending_text();
  if (type == PETSC_ERROR_INITIAL) {
    text = fmt::format("PETSc error {}: {}", code, message != nullptr ? message : "");
  }
  text += fmt::format("\n  in {}() at {}:{}", function, file, line);
  return code;
}

constexpr const char* kOutOfMemory =
    "memory ran out; take a larger -delta, a looser -accuracy or more ranks, or raise the limit "
    "(ulimit -v)";

constexpr const char* kPleaseReport =
    "this should not happen, please report it with the command line: ";

Failure failure_of(const PetscFailure& failure) {
  const std::string text = failure.what(), message = text.substr(0, text.find('\n'));
  switch (failure.code()) {
  case PETSC_ERR_MEM: return {ExitStatus::no_memory, kOutOfMemory};
  case PETSC_ERR_NOT_CONVERGED: return {ExitStatus::not_reached, message};
  case PETSC_ERR_USER_INPUT: return {ExitStatus::bad_input, message};
  default: return {ExitStatus::other, text};
  }
}

void shorten_start_of_single_process() {
  if (under_mpiexec()) return;
  constexpr int keep_users_choice = 0;
  setenv("OMPI_MCA_ess_singleton_isolated", "1", keep_users_choice);
  setenv("OMPI_MCA_btl", "self", keep_users_choice);
  setenv("OMPI_MCA_pml", "ob1", keep_users_choice);
  // Isolated processes would all use the same session folder, and remove it under one another.
  setenv("OMPI_MCA_orte_create_session_dirs", "0", keep_users_choice);
  setenv("OMPI_MCA_sharedfp", "^sm", keep_users_choice);  // needs that folder
  // hwloc would look for ten X displays: seconds each where "localhost" has no address.
  setenv("HWLOC_COMPONENTS", "-gl", keep_users_choice);
}

// Open MPI 5 makes a folder in TMPDIR, one for all single processes of a user, and leaves it there.
// None of them needs it: each starts with a TMPDIR of its own, which goes when MPI has started.
class StartFolder {
 public:
  StartFolder() {
    if (under_mpiexec()) return;
    std::error_code failure;
    std::string name = std::filesystem::temp_directory_path(failure) / "stickslip-start-XXXXXX";
    if (failure || mkdtemp(name.data()) == nullptr) return;
    folder_ = name;
    if (const char* given = std::getenv(kVariable); given != nullptr) given_ = given;
    setenv(kVariable, name.c_str(), 1);
  }
  StartFolder(const StartFolder&) = delete;
  StartFolder& operator=(const StartFolder&) = delete;
  ~StartFolder() {
    if (folder_.empty()) return;
    if (given_) setenv(kVariable, given_->c_str(), 1);
    if (!given_) unsetenv(kVariable);
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

 private:
  static constexpr const char* kVariable = "TMPDIR";
  std::filesystem::path folder_;
  std::optional<std::string> given_;
};

// PETSc after 3.18 ends with a list of the options that it has not read. This program refuses what
// nobody reads, with the name that was meant.
void list_no_options_at_the_end() {
  if (!option_value("options_left")) check(PetscOptionsSetValue(nullptr, "-options_left", "no"));
}

PetscErrorCode start(int& count, char**& values) {
  const StartFolder folder;
  return SlepcInitialize(&count, &values, nullptr, nullptr);
}

// PETSc's own words, without the chain of its functions.
[[noreturn]] void refuse_start(PetscErrorCode code) {
  try {
    check(code);
  } catch (const PetscFailure& failure) {
    const std::string text = failure.what();
    const bool crowded = text.find("extra token") != text.npos;
    const char* const fix =
        crowded ? "; write one -name value a line, and values with blanks in quotes" : "";
    throw PetscFailure(code, "PETSc cannot start with these options: " +
                                 text.substr(0, text.find("\n  in ")) + fix);
  }
  throw PetscFailure(code, "PETSc cannot start");
}

// Makes OpenBLAS take its work space now: at its first use it would try for ever where there is
// none. Throws NoMemory if a limit of the address space leaves too little.
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

}  // namespace

double left_in_address_space() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return kUnlimited;
  return static_cast<double>(limit.rlim_cur) - proc_value("/proc/self/status", "VmSize");
}

double available_bytes(MPI_Comm comm, double wanted) {
  const double found = available_now(comm);
  // Only in need: pages given back cost time when they are touched again.
  if (found >= wanted) return found;
  (void)malloc_trim(0);
  return available_now(comm);
}

double peak_resident_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
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

void check(PetscErrorCode code) {
  if (code == 0) return;
  std::string text = std::exchange(pending_text(), {});
  const auto exception = std::exchange(kept_exception(), nullptr);
  if (code == kException && exception) std::rethrow_exception(exception);
  if (text.empty()) text = fmt::format("PETSc error {}", code);
  throw PetscFailure(code, text);
}

PetscErrorCode keep_exception() noexcept {
  kept_exception() = std::current_exception();
  return kException;
}

Failure failure_in_flight() {
  try {
    throw;
  } catch (const Failure& failure) {
    return failure;
  } catch (const std::bad_alloc&) {
    return {ExitStatus::no_memory, kOutOfMemory};
  } catch (const PetscFailure& failure) {
    return failure_of(failure);
  } catch (const std::exception& unforeseen) {
    return {ExitStatus::other, kPleaseReport + std::string(unforeseen.what())};
  } catch (...) {  // muParser's are none of these
    return {ExitStatus::other, kPleaseReport + std::string("an error without words")};
  }
}

Session::Session(int& argc, char**& argv) : arguments_(argv, argv + argc) {
  shorten_start_of_single_process();
  static char skip_petscrc[] = "-skip_petscrc";
  arguments_.push_back(skip_petscrc);
  arguments_.push_back(nullptr);
  int count = argc + 1;
  char** values = arguments_.data();
  check(PetscPushErrorHandler(append_message, nullptr));  // into the text of the next failure
  const PetscErrorCode code = start(count, values);
  if (code != 0) refuse_start(code);
  list_no_options_at_the_end();
  check(PetscLogDefaultBegin());  // the statistics read event times
  (void)ranks_on_node();          // all ranks are here
  take_blas_space();
  std::signal(SIGPIPE, SIG_DFL);  // a closed pipe (| head) is no crash
  // Nor are a closed terminal and Ctrl-\, which PETSc would explain; what nohup ignores stays so.
  for (const int wanted : {SIGHUP, SIGQUIT}) {
    if (std::signal(wanted, SIG_DFL) == SIG_IGN) std::signal(wanted, SIG_IGN);
  }
  std::signal(SIGXFSZ, SIG_IGN);  // the write that fails reports a limit of file sizes
}

Session::~Session() { (void)SlepcFinalize(); }

bool complex_scalars() { return PetscDefined(USE_COMPLEX); }

bool under_mpiexec() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK", "PMI_SIZE"}) {
    if (std::getenv(name) != nullptr) return true;
  }
  return false;
}

int rank(MPI_Comm comm) {
  int value = 0;
  MPI_Comm_rank(comm, &value);
  return value;
}

int ranks(MPI_Comm comm) {
  int value = 1;
  MPI_Comm_size(comm, &value);
  return value;
}

std::string first_text(MPI_Comm comm, std::string text) {
  const int all = ranks(comm);
  int first = text.empty() ? all : rank(comm);
  MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT, MPI_MIN, comm);
  if (first == all) return "";
  auto size = static_cast<int>(text.size());
  MPI_Bcast(&size, 1, MPI_INT, first, comm);
  text.resize(static_cast<std::size_t>(size));
  MPI_Bcast(text.data(), size, MPI_CHAR, first, comm);
  return text;
}

void require_everywhere(MPI_Comm comm, const std::string& failure) {
  const std::string first = first_text(comm, failure);
  if (!first.empty()) throw NotReached(first);
}

}  // namespace stickslip::linalg
