#include <nlohmann/json.hpp>

#include "stickslip/catalogue/entry.hpp"
#include "stickslip/effects/effect.hpp"
#include "stickslip/options/table.hpp"
#include "stickslip/pages/pages.hpp"

namespace stickslip::pages {
namespace {

using options::Group;
using options::Kind;
using options::Option;
using OrderedJson = nlohmann::ordered_json;

// What each word of a choice of effects means; {} for any other option.
OrderedJson meanings_of(const Option& option) {
  OrderedJson meanings = OrderedJson::object();
  for (const auto* choice : effects::choices()) {
    if (choice->option != option.name) continue;
    for (const auto* effect : choice->effects) {
      meanings[std::string(effect->word)] = effect->sentence;
    }
  }
  return meanings;
}

OrderedJson owners_of(const Option& option) {
  OrderedJson owners = OrderedJson::object();
  for (const auto* choice : effects::choices()) {
    for (const auto* effect : choice->effects) {
      if (effect->knows(option.name)) owners[std::string(choice->option)].push_back(effect->word);
    }
  }
  return owners;
}

// Whether words cannot do without the option.
bool is_needed(const Option& option) {
  for (const auto* choice : effects::choices()) {
    for (const auto* effect : choice->effects) {
      for (const auto& parameter : effect->parameters) {
        if (parameter.option.name == option.name && !parameter.example.empty()) return true;
      }
    }
  }
  return false;
}

OrderedJson json_of(const std::optional<effects::Slider>& slider) {
  if (!slider) return nullptr;
  return {{"low", slider->low},
          {"high", slider->high},
          {"start", slider->start ? OrderedJson(*slider->start) : OrderedJson()},
          {"logarithmic", slider->logarithmic}};
}

OrderedJson json_of(const Option& option, const Group& group) {
  const bool ranged =
      option.kind == Kind::real || option.kind == Kind::integer || option.kind == Kind::numbers;
  return {{"name", option.name},
          {"group", group.title},
          {"form", option.form},
          {"unit", option.unit},
          {"default", option.initial},
          {"range", ranged ? option.range.text() : ""},
          {"words", option.words},
          {"meanings", meanings_of(option)},
          {"sentence", option.sentence},
          {"symbol", option.shown.symbol},
          {"label", option.shown.label},
          {"slider", json_of(option.shown.slider)},
          {"belongs_to", owners_of(option)},
          {"needed", is_needed(option)}};
}

// The keys of its results, each with the option that it is an array over; "" for a scalar.
OrderedJson json_of(const catalogue::Entry& quantity) {
  OrderedJson keys = OrderedJson::object();
  for (const auto* row : quantity.rows) keys[std::string(row->key)] = row->abscissa;
  return {{"word", quantity.word}, {"keys", keys}};
}

}  // namespace

std::string reference_json() {
  OrderedJson options = OrderedJson::array();
  for (const auto& group : options::table()) {
    for (const auto& option : group.options) options.push_back(json_of(option, group));
  }
  OrderedJson quantities = OrderedJson::array();
  for (const auto* quantity : catalogue::entries()) quantities.push_back(json_of(*quantity));
  return OrderedJson{{"options", options}, {"quantities", quantities}}.dump(1) + "\n";
}

}  // namespace stickslip::pages
