#include "stickslip/petsc/memory.hpp"

#include <malloc.h>
#include <sys/resource.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>

#include "stickslip/petsc/session.hpp"
#include "stickslip/support/infinity.hpp"

namespace stickslip::petsc {
namespace {

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

}  // namespace

double left_in_address_space() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return kUnlimited;
  return static_cast<double>(limit.rlim_cur) - proc_value("/proc/self/status", "VmSize");
}

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

}  // namespace stickslip::petsc
