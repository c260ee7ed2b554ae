#pragma once
/// Forms in which results leave the program. Each is a file that declares its option, what it is
/// written of, and how; all else that speaks of them follows from these declarations.

#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "stickslip/catalogue/entry.hpp"

namespace stickslip::outputs {

struct Report;

/// What the program does, and reports of.
enum class Subject { run, study, sweep, plan };

struct Output {
  std::string option = {};                 ///< that names the file; none for standard output
  std::string ending = {};                 ///< of such files, for messages
  std::string sentence = {};               ///< what it does, for the help of the option
  std::vector<std::string> synonyms = {};  ///< other names of the option
  std::set<Subject> subjects;              ///< what it is written of; of others it is left out
  /// The quantities that are no numbers of a table, and that it holds.
  std::set<catalogue::Quantity> fields = {};
  /// Whether all ranks of a report write it together; otherwise the first one does.
  bool collective = false;
  /// Throws SystemFailure when the file cannot be written.
  void (*write)(const Report&, const std::string& file);
};

/// All outputs, in the order in which they are listed and written.
[[nodiscard]] std::span<const Output* const> all();

/// Writes the outputs that have no option, and those whose options have files. Collective on the
/// ranks of the report. Throws what they throw.
void write_all(const Report& report, const std::map<std::string, std::string>& files);

}  // namespace stickslip::outputs
