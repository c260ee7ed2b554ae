#pragma once
/// The file of -checkpoint of a sweep: JSON lines, the first one says which sweep, each further one
/// is a finished point.

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace stickslip::sweeps {

/// What a record belongs to: name and value of everything that may change a number.
using Identity = std::vector<std::pair<std::string, std::string>>;

/// Gets every line before the file is touched, and throws BadInput if it cannot be one.
using Inspect = std::function<void(const std::string& line)>;

/// The lines of finished points in `file`, which is made if there is none. A last line that was cut
/// off when its writer was killed is removed. To be called by one process. Throws BadInput that
/// says what differs unless the file is the record of a sweep like `identity`, and leaves it alone;
/// std::runtime_error when the disk refuses.
[[nodiscard]] std::vector<std::string>
open_record(const std::string& file, const Identity& identity, const Inspect& inspect = {});

/// Adds a line and flushes it to disk. Processes take turns, on network file systems too. Throws
/// std::runtime_error when the disk refuses.
void append_to_record(const std::string& file, const std::string& line);

/// Throws BadInput: "-checkpoint = FILE: why; fix".
[[noreturn]] void refuse_record(const std::string& file, const std::string& why);

}  // namespace stickslip::sweeps
