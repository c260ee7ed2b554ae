#pragma once
/// What is known of an option of the command line: the form and the range of its value, its
/// default, what it does, and how pictures show it.

#include <optional>
#include <string>
#include <vector>

#include "stickslip/support/infinity.hpp"

namespace stickslip::effects {

/// What a value must look like.
enum class Kind {
  real,     ///< a finite decimal number
  integer,  ///< a whole number
  choice,   ///< one of a few words
  list,     ///< a comma list of words, each at most once
  numbers,  ///< a,b,c or first:last:count or first:last:count:log
  text,     ///< free text
  flag,     ///< yes or no; yes if it stands alone
  path,     ///< a file to write
  input,    ///< a file to read
};

/// An interval of numbers; unbounded and open by default.
struct Range {
  double low = -kInfinity;
  double high = kInfinity;
  bool low_included = false;
  bool high_included = false;

  [[nodiscard]] bool contains(double value) const;
  /// "(0, inf)".
  [[nodiscard]] std::string text() const;

  static Range positive() { return {0, kInfinity, false, false}; }
  static Range not_negative() { return {0, kInfinity, true, false}; }
  static Range whole(double low, double high) { return {low, high, true, true}; }
};

/// Ends of a slider over a number, and where it stands at first. Without a start the option is left
/// out until the slider is moved.
struct Slider {
  double low;
  double high;
  std::optional<double> start = {};
  bool logarithmic = false;
};

/// How an option is shown, and what else it is called.
struct Shown {
  std::string symbol = {};               ///< TeX, such as "c_3"
  std::string label = {};                ///< before the symbol on an axis
  std::optional<Slider> slider = {};     ///< over what is worth to be explored
  std::vector<std::string> others = {};  ///< names of the literature and of other programs
  std::string page = {};                 ///< of the manual where to read more
};

/// What to do about a number that the program chooses unless it is given.
inline constexpr const char* kChosen = "leave it out to have it chosen from -accuracy";

struct Option {
  std::string name;                ///< without the dash
  Kind kind;                       ///< form of the value
  std::string form;                ///< of the value, by the name that pages::forms() explains
  std::string unit;                ///< of a number; empty if it has none
  std::string initial;             ///< default as text; empty: see `sentence`
  Range range;                     ///< of a number
  std::vector<std::string> words;  ///< allowed words; beside numbers for kind integer
  std::string sentence;            ///< what it does
  std::string fix;                 ///< what to do about a value out of range; may be empty
  Shown shown = {};
  bool adds = false;  ///< whether words may be joined by +

  /// The same with other names.
  [[nodiscard]] Option called(const std::vector<std::string>& others) const {
    Option option = *this;
    option.shown.others = others;
    return option;
  }
  static Option real(const char* name, const char* unit, const char* initial, Range range,
                     const std::string& sentence, const std::string& fix = kChosen,
                     const Shown& shown = {}) {
    return {name, Kind::real, "number", unit, initial, range, {}, sentence, fix, shown};
  }
  static Option integer(const char* name, const char* initial, Range range, const char* sentence,
                        const char* fix = kChosen, const std::vector<std::string>& words = {},
                        const Shown& shown = {}) {
    return {name, Kind::integer, "integer", "", initial, range, words, sentence, fix, shown};
  }
  static Option text_of(const char* name, const char* form, const char* initial,
                        const std::string& sentence) {
    return {name, Kind::text, form, "", initial, {}, {}, sentence, ""};
  }
  static Option file(const std::string& name, Kind kind, const std::string& sentence,
                     const Shown& shown = {}) {
    return {name, kind, "file", "", "", {}, {}, sentence, "", shown};
  }
};

}  // namespace stickslip::effects
