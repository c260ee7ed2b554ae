#include "stickslip/checkpoint/checkpoint.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "stickslip/petsc/session.hpp"
#include "stickslip/support/atomic_file.hpp"
#include "stickslip/support/errors.hpp"
#include "stickslip/support/seal.hpp"
#include "stickslip/support/text.hpp"

namespace stickslip::checkpoint {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "stickslip checkpoint 3";

/// A file open for reading and writing, locked against other processes that do the same.
class LockedFile {
 public:
  explicit LockedFile(const std::string& name)
      : name_(name), descriptor_(open(name.c_str(), O_RDWR | O_CREAT | O_APPEND, 0666)) {
    if (descriptor_ < 0) fail("cannot open");
    struct stat kind {};
    regular_ = fstat(descriptor_, &kind) == 0 && S_ISREG(kind.st_mode);
    if (!regular_) return;
    // Locks of this kind work over NFS; where there are none, O_APPEND has to do.
    struct flock lock {};
    lock.l_type = F_WRLCK;
    lock.l_whence = SEEK_SET;
    while (fcntl(descriptor_, F_SETLKW, &lock) != 0 && errno == EINTR) {
    }
  }
  ~LockedFile() { close(descriptor_); }
  LockedFile(const LockedFile&) = delete;
  LockedFile& operator=(const LockedFile&) = delete;

  [[nodiscard]] bool regular() const { return regular_; }
  [[nodiscard]] std::string read_all() const {
    std::string text;
    std::array<char, 65536> part{};
    for (ssize_t size = 0; (size = read(descriptor_, part.data(), part.size())) != 0;) {
      if (size < 0) fail("cannot read");
      text.append(part.data(), static_cast<std::size_t>(size));
    }
    return text;
  }

  void truncate(std::size_t size) const {
    if (ftruncate(descriptor_, static_cast<off_t>(size)) != 0) fail("cannot write");
  }

  // Whole or not at all: what a full disk has taken of it is removed.
  void append(const std::string& text) const {
    const off_t before = lseek(descriptor_, 0, SEEK_END);
    errno = 0;
    const ssize_t written = write(descriptor_, text.data(), text.size());
    if (written == static_cast<ssize_t>(text.size()) && fsync(descriptor_) == 0) return;
    const int reason = errno == 0 ? ENOSPC : errno;
    const bool removed = before >= 0 && ftruncate(descriptor_, before) == 0;
    errno = reason;
    fail(removed ? "cannot write" : "cannot write, nor remove the last line of,");
  }

 private:
  [[noreturn]] void fail(const char* what) const {
    throw SystemFailure(fmt::format("{} {}: {}", what, name_, std::strerror(errno)));
  }

  std::string name_;
  int descriptor_;
  bool regular_ = false;
};

std::string name_of(Kind kind) { return kind == Kind::sweep ? "sweep" : "simulation"; }

std::string header_of(const std::string& kind, const Identity& identity) {
  Json json{{"format", kFormat}, {"of", kind}, {"run", Json::object()}};
  for (const auto& [name, value] : identity) json["run"][name] = value;
  return json.dump() + "\n";
}

// The order of options means nothing.
bool same(const std::string& header, const std::string& other) {
  return nlohmann::json::parse(header, nullptr, false) == nlohmann::json::parse(other);
}

}  // namespace

Checkpoint::Checkpoint(std::string file, Kind kind, const Identity& identity)
    : file_(std::move(file)), kind_(name_of(kind)), header_(header_of(kind_, identity)) {}

void Checkpoint::refuse(const std::string& why) const {
  throw BadInput(fmt::format("-checkpoint = {}: {}; name another file, or remove it", file_, why));
}

// Reports in what the header of the file differs.
void Checkpoint::refuse_other(const std::string& header) const {
  const Json json = Json::parse(header, nullptr, false), own = Json::parse(header_);
  const auto agrees = [&](const char* key) {
    return json.is_object() && json.contains(key) && json[key] == own[key];
  };
  if (!agrees("format") || !agrees("of") || !json.contains("run") || !json["run"].is_object()) {
    refuse(fmt::format("is no checkpoint of a {} by this version of the program", kind_));
  }
  const auto refuse_difference = [&](const Json& names) {
    for (const auto& option : names.items()) {
      const auto found = json["run"].value(option.key(), Json("none"));
      const auto wanted = own["run"].value(option.key(), Json("none"));
      if (found == wanted) continue;
      refuse(fmt::format("belongs to a {} with {} {}, not {}", kind_, option.key(), found.dump(),
                         wanted.dump()));
    }
  };
  refuse_difference(own["run"]);
  refuse_difference(json["run"]);
  refuse("belongs to another version of the program");
}

void Checkpoint::open(MPI_Comm comm, const Take& take) const {
  std::string problem;
  if (petsc::rank(comm) == 0) {
    try {
      read(take);
    } catch (const BadInput& bad) {
      problem = bad.what();
    }
  }
  problem = petsc::first_text(comm, problem);
  if (!problem.empty()) throw BadInput(problem);
}

void Checkpoint::read(const Take& take) const {
  const LockedFile file(file_);
  if (!file.regular()) refuse("is no regular file");
  const std::string text = file.read_all();
  if (header_.starts_with(text)) {  // new, or killed before the first line was whole
    file.truncate(0);
    file.append(header_);
    return;
  }
  const std::string header = text.substr(0, text.find('\n') + 1);
  if (!same(header, header_)) refuse_other(header);
  const std::size_t whole = text.rfind('\n') + 1;
  std::vector<std::string> lines = split(text.substr(header.size(), whole - header.size()), '\n');
  if (!lines.empty()) lines.pop_back();  // behind the last end of line
  // A file that is always replaced as a whole is never truncated.
  if (kind_ == name_of(Kind::simulation) && (lines.size() > 1 || whole < text.size())) {
    refuse("is damaged");
  }
  for (const auto& line : lines) {
    const auto entry = unsealed(line);
    if (!entry) refuse("is damaged");
    try {
      take(*entry);
    } catch (const std::exception&) {
      refuse("is damaged");
    }
  }
  if (whole < text.size()) file.truncate(whole);
}

void Checkpoint::append(const std::string& entry) const {
  LockedFile(file_).append(sealed(entry) + "\n");
}

void Checkpoint::replace(const std::string& entry) const {
  write_text(file_, header_ + sealed(entry) + "\n");
}

}  // namespace stickslip::checkpoint
