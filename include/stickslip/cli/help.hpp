#pragma once
/// Help, pages and the completion of the command line, made from the tables of options,
/// quantities and results.

#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace stickslip::cli {

/// The forms of values, such as "number": what stands after the name of an option, and its meaning.
[[nodiscard]] std::span<const std::pair<const char*, const char*>> forms();

/// The text of -help.
[[nodiscard]] std::string help_text();

/// The reference page of options in Markdown (docs/options.md).
[[nodiscard]] std::string reference_page();

/// The table of options as JSON: {"options": [...]}, in the order of the help text. Each has name,
/// group, form, unit, default, range and sentence as the page has them, empty where there is none;
/// words; for a choice of effects what each word means; symbol in TeX and label of pictures; slider
/// {low, high, start, logarithmic} or null; and belongs_to, by choice the words of the effects that
/// know the option, {} where all do. Then the quantities, each with its word and its keys, and of a
/// key the option that its values are over.
[[nodiscard]] std::string reference_json();

/// The tables of quantities and of the keys of a summary in Markdown, which stand between two marks
/// in docs/quantities.md.
[[nodiscard]] std::string quantity_tables();

/// `text` as one line of running text in roff: no character acts as a command, and dashes can be
/// copied from the page.
[[nodiscard]] std::string roff(std::string_view text);

/// The manual page of section 1 in roff, for the program's version. It bears no date, so that the
/// same sources give the same page.
[[nodiscard]] std::string man_page(std::string_view version);

/// A script that lets bash complete names of options, their words, and files.
[[nodiscard]] std::string completion();

}  // namespace stickslip::cli
