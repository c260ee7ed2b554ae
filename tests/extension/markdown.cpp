#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "stickslip/base/files.hpp"
#include "stickslip/cli/output.hpp"

namespace stickslip::cli {
namespace {

void write_markdown(const Report& report, const std::string& file) {
  const Json tree = report.tree();
  std::string text = "| quantity | value | error |\n| --- | --- | --- |\n";
  for (const auto& [key, result] : tree["results"].items()) {
    if (!result["value"].is_number()) continue;
    text += fmt::format("| {} | {} | {} |\n", key, result["value"].get<double>(),
                        result["error"].get<double>());
  }
  write_text(file, text);
}

}  // namespace

extern const Output kMarkdown{.option = "markdown",
                              .ending = "md",
                              .sentence =
                                  "write every scalar as a row of a Markdown table to this file",
                              .subjects = {Subject::run},
                              .write = write_markdown};

}  // namespace stickslip::cli
