#include "stickslip/petsc/session.hpp"

#include <slepcsys.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>

#include "stickslip/petsc/blas.hpp"
#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/memory.hpp"
#include "stickslip/petsc/solver_options.hpp"
#include "stickslip/support/errors.hpp"

namespace stickslip::petsc {
namespace {

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

}  // namespace

Session::Session(int& argc, char**& argv) : arguments_(argv, argv + argc) {
  shorten_start_of_single_process();
  static char skip_petscrc[] = "-skip_petscrc";
  arguments_.push_back(skip_petscrc);
  arguments_.push_back(nullptr);
  int count = argc + 1;
  char** values = arguments_.data();
  collect_error_messages();
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

void sum_over_ranks(MPI_Comm comm, std::vector<double>& values) {
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_SUM,
                comm);
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

}  // namespace stickslip::petsc
