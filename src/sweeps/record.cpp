#include "stickslip/sweeps/record.hpp"

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

#include "stickslip/support/errors.hpp"
#include "stickslip/support/text.hpp"

namespace stickslip::sweeps {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "stickslip sweep 1";

/// A file open for reading and writing, locked against other processes that do the same.
class LockedFile {
 public:
  explicit LockedFile(const std::string& name)
      : name_(name), descriptor_(open(name.c_str(), O_RDWR | O_CREAT | O_APPEND, 0666)) {
    if (descriptor_ < 0) fail("cannot open");
    struct stat kind {};
    if (fstat(descriptor_, &kind) != 0 || !S_ISREG(kind.st_mode)) {
      refuse_record(name, "is no regular file");
    }
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

  [[nodiscard]] std::string read_all() const {
    std::string text;
    std::array<char, 65536> part{};
    for (ssize_t size = 0; (size = read(descriptor_, part.data(), part.size())) != 0;) {
      if (size < 0) fail("cannot read");
      text.append(part.data(), static_cast<std::size_t>(size));
    }
    return text;
  }

  void cut(std::size_t size) const {
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
    throw std::runtime_error(fmt::format("{} {}: {}", what, name_, std::strerror(errno)));
  }

  std::string name_;
  int descriptor_;
};

std::string header_of(const Identity& identity) {
  Json json{{"format", kFormat}, {"run", Json::object()}};
  for (const auto& [name, value] : identity) json["run"][name] = value;
  return json.dump() + "\n";
}

std::string text_at(const Json& json, const std::string& name) {
  return json.contains(name) && json[name].is_string() ? json[name].get<std::string>() : "none";
}

// Says in what the sweep of a header differs.
[[noreturn]] void refuse_other(const std::string& file, const std::string& header,
                               const Identity& identity) {
  const Json json = Json::parse(header, nullptr, false);
  const bool is_header = json.is_object() && json.contains("format") && json["format"] == kFormat &&
                         json.contains("run") && json["run"].is_object();
  if (!is_header) refuse_record(file, "is no record of a sweep");
  for (const auto& [name, value] : identity) {
    const std::string found = text_at(json["run"], name);
    if (found == value) continue;
    refuse_record(file,
                  fmt::format("belongs to a sweep with {} \"{}\", not \"{}\"", name, found, value));
  }
  for (const auto& option : json["run"].items()) {
    const bool known = std::any_of(identity.begin(), identity.end(),
                                   [&](const auto& entry) { return entry.first == option.key(); });
    if (known) continue;
    refuse_record(
        file, fmt::format("belongs to a sweep with {} {}", option.key(), option.value().dump()));
  }
  refuse_record(file, "belongs to another version of the program");
}

}  // namespace

void refuse_record(const std::string& file, const std::string& why) {
  throw BadInput(fmt::format("-checkpoint = {}: {}; name another file, or remove it", file, why));
}

std::vector<std::string> open_record(const std::string& file, const Identity& identity,
                                     const Inspect& inspect) {
  const LockedFile record(file);
  const std::string text = record.read_all(), header = header_of(identity);
  if (header.starts_with(text)) {  // new, or killed before the first line was whole
    record.cut(0);
    record.append(header);
    return {};
  }
  if (!text.starts_with(header)) refuse_other(file, text.substr(0, text.find('\n')), identity);
  const std::size_t whole = text.rfind('\n') + 1;
  std::vector<std::string> lines = split(text.substr(header.size(), whole - header.size()), '\n');
  if (!lines.empty()) lines.pop_back();  // behind the last end of line
  if (inspect) std::for_each(lines.begin(), lines.end(), inspect);
  if (whole < text.size()) record.cut(whole);
  return lines;
}

void append_to_record(const std::string& file, const std::string& line) {
  LockedFile(file).append(line + "\n");
}

}  // namespace stickslip::sweeps
