#include "sample_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "stickslip/effects/read_scene.hpp"
#include "stickslip/support/number_text.hpp"
#include "stickslip/support/readable.hpp"

namespace stickslip::effects {
namespace {

constexpr const char *kLayout = "sample_layout", *kStep = "sample_step", *kRest = "force_rest";

model::ForceRecord read_rows(const std::string& file, double step) {
  require_readable(file);
  model::ForceRecord record;
  std::ifstream lines(file);
  std::size_t number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (line.starts_with('#')) continue;
    std::ranges::replace_if(
        line, [](char c) { return c == ',' || c == ';'; }, ' ');
    std::istringstream words(line);
    for (std::string word; words >> word;) {
      const auto value = parse_number(word);
      if (!value) {
        throw std::invalid_argument(fmt::format("line {}: {} is no finite number", number, word));
      }
      record.time.push_back(step * static_cast<double>(record.time.size()));
      record.force.push_back(*value);
    }
  }
  if (record.time.size() < 2) {
    throw std::invalid_argument(
        fmt::format("has {} samples, and a force over time takes 2", record.time.size()));
  }
  return record;
}

}  // namespace

std::vector<Option> sample_options() {
  return {{kLayout,
           Kind::choice,
           "word",
           "",
           "",
           {},
           {"columns", "rows"},
           "how -force_file holds its samples. columns: below the names time,force, unless this "
           "option is given. rows: one after the other in rows, without times and names",
           ""},
          Option::real(kStep, "time", "", Range::positive(),
                       "time between two samples of -sample_layout rows",
                       "take for example 0.005, that of 200 samples in a second"),
          Option::real(kRest, "time", "", Range::not_negative(),
                       "time without force that is appended to -force_file; 0 unless given",
                       "take as long as the body needs to stop")};
}

bool layout_is_sound(Given& given) {
  const bool rows = given.text(kLayout) == "rows";
  if (rows == given.has(kStep)) return true;
  given.refuse(rows ? kLayout : kStep, rows ? "rows have no times" : "has no effect on columns",
               rows ? "add -sample_step, the time between two samples, such as -sample_step 0.005"
                    : "leave it out, or add -sample_layout rows");
  return false;
}

model::ForceRecord read_samples(const Given& given, const std::string& file,
                                model::ForceRecord (*columns)(const std::string&)) {
  auto record = given.has(kStep) ? read_rows(file, given.real(kStep)) : columns(file);
  if (given.has(kStep)) record.step = given.real(kStep);
  if (!given.has(kRest) || given.real(kRest) == 0) return record;
  record.rest = given.real(kRest);
  const double last = record.time.back(), end = last + record.rest;
  const double next = last + (last - record.time[record.time.size() - 2]);
  for (const double time : {std::min(next, end), end}) {
    if (!(time > record.time.back())) continue;
    record.time.push_back(time);
    record.force.push_back(0);
    if (!record.load.empty()) record.load.push_back(0);
  }
  return record;
}

}  // namespace stickslip::effects
