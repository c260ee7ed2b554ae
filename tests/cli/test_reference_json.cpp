#include <nlohmann/json.hpp>

#include "../common/catch.hpp"
#include "stickslip/case/entry.hpp"
#include "stickslip/cli/help.hpp"
#include "stickslip/cli/options.hpp"

using namespace stickslip::cli;
using stickslip::cli::reference_json;

namespace {

using Json = nlohmann::json;

const Json& described(const std::string& name) {
  static const Json all = Json::parse(reference_json()).at("options");
  for (const auto& option : all) {
    if (option.at("name") == name) return option;
  }
  throw std::out_of_range(name);
}

}  // namespace

TEST_CASE("reference as JSON: every option as in the table") {
  for (const auto& option : all_options()) {
    INFO(option.name);
    const auto& json = described(option.name);
    CHECK(json.at("form") == option.form);
    CHECK(json.at("unit") == option.unit);
    CHECK(json.at("default") == option.initial);
    CHECK(json.at("words") == option.words);
    CHECK(json.at("sentence") == option.sentence);
  }
  CHECK(described("mu_d").at("group") == "Model");
  CHECK(described("mu_d").at("range") == "[0, inf)");
  CHECK(described("omega").at("range") == "[0, inf)");
  CHECK(described("scheme").at("range") == "");
}

TEST_CASE("reference as JSON: what belongs to a drag law, a friction law or a noise") {
  CHECK(described("mu_s").at("belongs_to") == Json::object());
  CHECK(described("tau").at("belongs_to") == Json{{"noise", {"ou"}}, {"drag", {"expression"}}});
  CHECK(described("drag_coefficient").at("belongs_to") == Json{{"drag", {"linear", "cubic"}}});
  CHECK(described("drag").at("meanings").at("cubic") == "-c v - c3 v^3");
  CHECK(described("drag").at("meanings").size() == described("drag").at("words").size());
  CHECK(described("scheme").at("meanings") == Json::object());
}

TEST_CASE("reference as JSON: sliders stay where the program takes their values") {
  int sliders = 0;
  for (const auto& option : all_options()) {
    INFO(option.name);
    const auto& slider = described(option.name).at("slider");
    if (slider.is_null()) continue;
    ++sliders;
    const double low = slider.at("low"), high = slider.at("high");
    CHECK(low < high);
    if (const auto& start = slider.at("start"); start.is_null()) {
      CHECK(option.initial.empty());
      CHECK_FALSE(described(option.name).at("needed").get<bool>());
    } else {
      CHECK(low <= start.get<double>());
      CHECK(start.get<double>() <= high);
    }
    CHECK(option.range.contains(low));
    CHECK(option.range.contains(high));
    CHECK((low > 0 || !slider.at("logarithmic").get<bool>()));
    CHECK_FALSE(option.shown.symbol.empty());
  }
  CHECK(sliders >= 10);
}

TEST_CASE("reference as JSON: keys of quantities, and what their values are over") {
  const Json quantities = Json::parse(reference_json()).at("quantities");
  REQUIRE(quantities.size() == stickslip::cases::entries().size());
  for (const auto& quantity : quantities) {
    const auto* entry = stickslip::cases::find_entry(quantity.at("word").get<std::string>());
    REQUIRE(entry != nullptr);
    CHECK(quantity.at("keys").size() == entry->rows.size());
    if (entry->word == "spectrum") CHECK(quantity.at("keys").at("S_v") == "omega");
    if (entry->word == "sticking") CHECK(quantity.at("keys").at("P_stick") == "");
  }
}
