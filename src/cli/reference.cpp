#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

#define CSV_IO_NO_THREAD  // small files
// Fast C++ CSV Parser: header only, reports the file and line of an error.
#include <libfccp/csv.h>

#include "stickslip/base/files.hpp"
#include "stickslip/base/text.hpp"
#include "stickslip/base/uncertain.hpp"
#include "stickslip/case/entry.hpp"
#include "stickslip/cli/hdf5_file.hpp"
#include "stickslip/cli/output.hpp"

namespace stickslip::cli {
namespace {

void require_numbers(const quantities::Result& r) {
  if (r.value.empty()) throw std::invalid_argument(r.key + " lacks values");
  bool sound = true;
  for (const auto* values : {&r.abscissa, &r.value}) {
    for (double value : *values) sound = sound && std::isfinite(value);
  }
  // A simulation may have bounded a value from one side alone.
  const bool finite = r.ci95.empty();
  for (double error : r.error) sound = sound && error >= 0 && (!finite || std::isfinite(error));
  for (const auto& [low, high] : r.ci95) sound = sound && low <= high;
  if (!sound) throw std::invalid_argument(r.key + " has values or errors that are no numbers");
}

void append(quantities::Result r, std::vector<Reference>& all) {
  const bool simulated = !r.ci95.empty();
  // JSON has no infinity: null stands for it where an interval has one end.
  const auto open = [](double& end, double side) { end = std::isnan(end) ? side : end; };
  if (simulated) {
    for (double& error : r.error) open(error, kInfinity);
  }
  for (auto& [low, high] : r.ci95) {
    open(low, -kInfinity);
    open(high, kInfinity);
  }
  require_numbers(r);
  const auto* row = cases::find_row(r.key);
  if (simulated && !r.is_scalar() && row != nullptr && row->by_cells) return;
  for (std::size_t n = 0; n < r.value.size(); ++n) {
    // A computed error is a bound; as a standard deviation it errs on the safe side.
    const double half = simulated ? 0 : kNormalQuantile * r.error[n];
    all.push_back({r.key, r.is_scalar() ? std::nullopt : std::optional(r.abscissa[n]), r.value[n],
                   simulated ? r.ci95[n].first : r.value[n] - half,
                   simulated ? r.ci95[n].second : r.value[n] + half});
  }
}

// The results of a summary by their keys, whatever their order. `form` is for messages.
std::vector<Reference> references_of(const std::string& text, const char* form) {
  std::vector<Reference> all;
  try {
    auto results = results_of(Json::parse(text).at("results"));
    std::ranges::sort(results, {}, &quantities::Result::key);
    for (auto& result : results) append(std::move(result), all);
  } catch (const Json::exception& problem) {
    throw std::invalid_argument(
        fmt::format("is not {} of this program ({})", form, problem.what()));
  }
  return all;
}

std::vector<Reference> read_json(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return references_of(text.str(), "a JSON summary");
}

std::vector<std::string> names_in(hid_t group) {
  std::vector<std::string> names;
  const auto visit = [](hid_t, const char* name, const H5L_info_t*, void* data) -> herr_t {
    static_cast<std::vector<std::string>*>(data)->emplace_back(name);
    return 0;
  };
  H5Literate(group, H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, visit, &names);
  return names;
}

// A number or an array of them.
Json dataset(hid_t group, const std::string& name) {
  const Hdf5Id data(H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose);
  if (!data.valid()) throw std::invalid_argument(name + " is no dataset");
  const Hdf5Id space(H5Dget_space(data), H5Sclose);
  const hssize_t size = H5Sget_simple_extent_npoints(space);
  constexpr hssize_t most = 100000000;
  if (size < 0 || size > most) throw std::invalid_argument(name + " has an absurd size");
  std::vector<double> values(static_cast<std::size_t>(size));
  if (size > 0 &&
      H5Dread(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) {
    throw std::invalid_argument(name + " cannot be read as numbers");
  }
  const bool scalar = H5Sget_simple_extent_type(space) == H5S_SCALAR;
  return scalar ? Json(values.at(0)) : Json(values);
}

// As in a summary, where null could be either what is no number or the open end of an interval.
Json result_in(hid_t group, const std::string& key) {
  Json result;
  for (const auto& name : names_in(group)) {
    const Json values = dataset(group, name);
    const auto is_no_number = [](const Json& value) { return std::isnan(value.get<double>()); };
    const bool sound = values.is_array() ? std::none_of(values.begin(), values.end(), is_no_number)
                                         : !is_no_number(values);
    if (!sound) throw std::invalid_argument(key + " has values or errors that are no numbers");
    result[name] = values;
  }
  if (!result.contains("low") || !result.contains("high")) return result;
  const Json low = result["low"], high = result["high"];
  result.erase("low");
  result.erase("high");
  if (!low.is_array()) result["ci95"] = {low, high};
  for (std::size_t n = 0; low.is_array() && n < low.size(); ++n) {
    result["ci95"].push_back({low[n], high.at(n)});
  }
  return result;
}

std::string read_hdf5(const std::string& file) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // failures are reported by exceptions
  const Hdf5Id id(H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (!id.valid()) {
    throw std::invalid_argument("is not a readable HDF5 file, or another program is writing it");
  }
  const Hdf5Id results(H5Gopen2(id, "/results", H5P_DEFAULT), H5Gclose);
  if (!results.valid()) throw std::invalid_argument("has no group /results");
  Json tree{{"results", Json::object()}};
  for (const auto& key : names_in(results)) {
    const Hdf5Id group(H5Gopen2(results, key.c_str(), H5P_DEFAULT), H5Gclose);
    if (!group.valid()) throw std::invalid_argument("/results/" + key + " is no group");
    tree["results"][key] = result_in(group, key);
  }
  return tree.dump(-1, ' ', false, Json::error_handler_t::replace);
}

// The HDF5 library can crash, or never end, on damaged files; so another process reads them. A
// message has a ! before it.
std::vector<Reference> read_hdf5_apart(const std::string& file) {
  constexpr unsigned seconds = 60;
  const auto text = isolated(
      [&]() -> std::string {
        try {
          return read_hdf5(file);
        } catch (const std::exception& problem) {
          return std::string("!") + problem.what();
        }
      },
      seconds);
  if (!text) throw std::invalid_argument("is so damaged that the HDF5 library cannot read it");
  if (text->starts_with('!')) throw std::invalid_argument(text->substr(1));
  return references_of(*text, "an HDF5 file");
}

// A number, or nothing for an empty cell.
std::optional<double> cell(const std::string& text, const std::string& column, unsigned line) {
  if (text.empty()) return std::nullopt;
  const auto value = parse_number(text);
  if (!value) {
    throw std::invalid_argument(
        fmt::format("line {}: {} = {} is no finite number", line, column, text));
  }
  return value;
}

std::vector<Reference> read_csv(const std::string& file) {
  std::vector<Reference> all;
  try {
    ::io::CSVReader<5, ::io::trim_chars<' ', '\t', '\r'>, ::io::double_quote_escape<',', '"'>>
        reader(file);
    reader.read_header(::io::ignore_extra_column, "quantity", "argument", "value", "low", "high");
    std::string quantity, argument, value, low, high;
    while (reader.read_row(quantity, argument, value, low, high)) {
      const unsigned line = reader.get_file_line();
      Reference r{quantity, cell(argument, "argument", line)};
      const auto found = cell(value, "value", line);
      if (!found || quantity.empty()) {
        throw std::invalid_argument(
            fmt::format("line {}: a quantity and a value are needed", line));
      }
      r.value = *found;
      r.low = cell(low, "low", line).value_or(r.value);
      r.high = cell(high, "high", line).value_or(r.value);
      if (r.low > r.value || r.high < r.value) {
        throw std::invalid_argument(fmt::format("line {}: low <= value <= high must hold", line));
      }
      all.push_back(std::move(r));
    }
  } catch (const ::io::error::base& problem) {
    throw std::invalid_argument(
        fmt::format("is not a CSV file of reference values: {}", problem.what()));
  }
  return all;
}

}  // namespace

std::vector<Reference> read_references(const std::string& file) {
  require_readable(file);
  using Reader = std::vector<Reference> (*)(const std::string&);
  static const std::map<std::string, Reader> readers{{".h5", read_hdf5_apart},
                                                     {".hdf5", read_hdf5_apart},
                                                     {".json", read_json},
                                                     {".csv", read_csv}};
  const auto reader = readers.find(std::filesystem::path(file).extension());
  if (reader == readers.end()) {
    throw std::invalid_argument("must end in .h5, .json or .csv");
  }
  auto all = reader->second(file);
  if (all.empty()) throw std::invalid_argument("holds no values");
  return all;
}

}  // namespace stickslip::cli
