#include "stickslip/options/reference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#define CSV_IO_NO_THREAD  // small files
// Fast C++ CSV Parser: header only, reports the file and line of an error.
#include <libfccp/csv.h>

#include "reading.hpp"
#include "stickslip/catalogue/entry.hpp"
#include "stickslip/options/settings.hpp"
#include "stickslip/support/hdf5_id.hpp"
#include "stickslip/support/infinity.hpp"
#include "stickslip/support/isolated.hpp"
#include "stickslip/support/number_text.hpp"
#include "stickslip/support/readable.hpp"
#include "stickslip/support/statistics.hpp"

namespace stickslip::options {
namespace {

using Json = nlohmann::json;

/// An array of a file, or a scalar as an array of one.
struct Values {
  std::vector<double> argument, value, error, low, high;  // low, high: simulated ones only
  bool scalar = false;
};

void require_equal_sizes(const std::string& key, const Values& v) {
  const std::size_t n = v.value.size();
  const bool intervals = v.low.empty() ? v.error.size() == n : v.low.size() == n;
  if (n == 0 || !intervals || v.high.size() != v.low.size() ||
      (!v.scalar && v.argument.size() != n)) {
    throw std::invalid_argument(fmt::format("{} lacks values, errors or arguments", key));
  }
}

void require_numbers(const std::string& key, const Values& v) {
  bool sound = true;
  for (const auto* values : {&v.argument, &v.value}) {
    for (double value : *values) sound = sound && std::isfinite(value);
  }
  // A simulation may have bounded a value from below alone.
  const bool finite = v.low.empty();
  for (double error : v.error) sound = sound && error >= 0 && (!finite || std::isfinite(error));
  for (std::size_t n = 0; n < v.low.size(); ++n) sound = sound && v.low[n] <= v.high[n];
  if (!sound) throw std::invalid_argument(key + " has values or errors that are no numbers");
}

void append(const std::string& key, const Values& v, std::vector<Reference>& all) {
  require_equal_sizes(key, v);
  require_numbers(key, v);
  const bool simulated = !v.low.empty();
  const auto* row = catalogue::find_row(key);
  if (simulated && !v.scalar && row != nullptr && row->by_cells) return;
  for (std::size_t n = 0; n < v.value.size(); ++n) {
    // A computed error is a bound; as a standard deviation it errs on the safe side.
    const double half = simulated ? 0 : kNormalQuantile * v.error[n];
    all.push_back({key, v.scalar ? std::nullopt : std::optional(v.argument[n]), v.value[n],
                   simulated ? v.low[n] : v.value[n] - half,
                   simulated ? v.high[n] : v.value[n] + half});
  }
}

// JSON has no infinity: null stands for it.
double number_or_infinity(const Json& json) {
  return json.is_null() ? kInfinity : json.get<double>();
}

std::vector<double> numbers(const Json& json) {
  if (!json.is_array()) return {number_or_infinity(json)};
  std::vector<double> all;
  for (const auto& number : json) all.push_back(number_or_infinity(number));
  return all;
}

void read_intervals(const Json& ci95, Values& v) {
  const auto add = [&](const Json& pair) {
    v.low.push_back(pair.at(0).get<double>());
    v.high.push_back(number_or_infinity(pair.at(1)));
  };
  if (!ci95.at(0).is_array()) return add(ci95);
  for (const auto& pair : ci95) add(pair);
}

std::vector<Reference> read_json(const std::string& file) {
  std::ifstream stream(file);
  std::vector<Reference> all;
  try {
    const Json json = Json::parse(stream);
    for (const auto& [key, result] : json.at("results").items()) {
      Values v;
      v.value = numbers(result.at("value"));
      v.error = numbers(result.at("error"));
      v.scalar = !result.at("value").is_array();
      if (result.contains("ci95")) read_intervals(result["ci95"], v);
      for (const auto& [name, values] : result.items()) {
        const bool abscissa = name != "value" && name != "error" && name != "ci95";
        if (abscissa && values.is_array()) v.argument = numbers(values);
      }
      append(key, v, all);
    }
  } catch (const Json::exception& problem) {
    throw std::invalid_argument(
        fmt::format("is not a JSON summary of this program ({})", problem.what()));
  }
  return all;
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

std::vector<double> dataset(hid_t group, const std::string& name, bool* scalar = nullptr) {
  const Hdf5Id data(H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose);
  if (!data.valid()) throw std::invalid_argument(name + " is no dataset");
  const Hdf5Id space(H5Dget_space(data), H5Sclose);
  const hssize_t size = H5Sget_simple_extent_npoints(space);
  constexpr hssize_t most = 100000000;
  if (size < 0 || size > most) throw std::invalid_argument(name + " has an absurd size");
  if (scalar != nullptr) *scalar = H5Sget_simple_extent_type(space) == H5S_SCALAR;
  std::vector<double> values(static_cast<std::size_t>(size));
  if (size > 0 &&
      H5Dread(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) {
    throw std::invalid_argument(name + " cannot be read as numbers");
  }
  return values;
}

Values values_of(hid_t group) {
  Values v;
  const std::map<std::string, std::vector<double>*> known{
      {"value", &v.value}, {"error", &v.error}, {"low", &v.low}, {"high", &v.high}};
  for (const auto& name : names_in(group)) {
    const auto found = known.find(name);
    auto& values = found == known.end() ? v.argument : *found->second;
    values = dataset(group, name, name == "value" ? &v.scalar : nullptr);
  }
  return v;
}

std::vector<Reference> read_hdf5(const std::string& file) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // failures are reported by exceptions
  const Hdf5Id id(H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (!id.valid()) {
    throw std::invalid_argument("is not a readable HDF5 file, or another program is writing it");
  }
  const Hdf5Id results(H5Gopen2(id, "/results", H5P_DEFAULT), H5Gclose);
  if (!results.valid()) throw std::invalid_argument("has no group /results");
  std::vector<Reference> all;
  for (const auto& key : names_in(results)) {
    const Hdf5Id group(H5Gopen2(results, key.c_str(), H5P_DEFAULT), H5Gclose);
    if (!group.valid()) throw std::invalid_argument("/results/" + key + " is no group");
    append(key, values_of(group), all);
  }
  return all;
}

std::string text_of(const std::vector<Reference>& references) {
  Json json = Json::array();
  for (const auto& r : references) {
    const Json argument = r.argument ? Json(*r.argument) : Json();
    json.push_back({r.quantity, argument, r.value, r.low, r.high});
  }
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::vector<Reference> references_of(const std::string& text) {
  std::vector<Reference> all;
  for (const auto& r : Json::parse(text)) {
    const auto argument = r[1].is_null() ? std::nullopt : std::optional(r[1].get<double>());
    all.push_back({r[0].get<std::string>(), argument, r[2].get<double>(), r[3].get<double>(),
                   number_or_infinity(r[4])});
  }
  return all;
}

// The HDF5 library can crash, or never end, on damaged files; so another process reads them. A
// message has a ! before it.
std::vector<Reference> read_hdf5_apart(const std::string& file) {
  constexpr unsigned seconds = 60;
  const auto text = isolated(
      [&]() -> std::string {
        try {
          return text_of(read_hdf5(file));
        } catch (const std::exception& problem) {
          return std::string("!") + problem.what();
        }
      },
      seconds);
  if (!text) throw std::invalid_argument("is so damaged that the HDF5 library cannot read it");
  if (text->starts_with('!')) throw std::invalid_argument(text->substr(1));
  return references_of(*text);
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

}  // namespace stickslip::options
