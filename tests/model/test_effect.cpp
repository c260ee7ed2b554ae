#include <fmt/format.h>

#include <set>

#include "../common/given.hpp"
#include "stickslip/case/entry.hpp"

using namespace stickslip;

namespace {

using test::said_of;
using test::scene_of;

std::vector<std::string> heading_of(const effects::Choice& choice, const model::Scene& scene) {
  return effects::heading(choice.in(scene), scene);
}

using Parts = std::vector<std::string>;

}  // namespace

TEST_CASE("effects: words are told apart, and what they declare are options of the model") {
  for (const auto* choice : effects::choices()) {
    CHECK(effects::model_option(choice->option).initial == choice->effects.front()->word);
    std::set<std::string_view> words;
    for (const auto* effect : choice->effects) {
      INFO(effect->word);
      CHECK(words.insert(effect->word).second);
      CHECK(&choice->of(effect->word) == effect);
      CHECK(!effect->sentence.empty());
      for (const auto& [option, refused, example] : effect->parameters) {
        CHECK(effects::model_option(option.name).sentence == option.sentence);
        CHECK(effect->knows(option.name));
      }
      for (const auto& parameter : effect->derivatives) {
        CHECK(effects::model_option(parameter.option).kind == effects::Kind::real);
        CHECK(cases::find_row(fmt::format("dP_stick_d{}", parameter.option)) != nullptr);
      }
    }
  }
  CHECK_THROWS_AS(effects::model_option("mass"), std::logic_error);
}

TEST_CASE("effects: values reach the scene, its headings and its parameters") {
  const auto plain = scene_of({{"mu_d", "0.5"}});
  CHECK(heading_of(effects::frictions(), plain).empty());
  CHECK(heading_of(effects::noises(), plain) == Parts{"tau = 1", "delta = 0.125"});
  CHECK(heading_of(effects::drags(), plain) == Parts{"drag linear, c = 1"});
  const auto other = scene_of({{"mu_d", "0.5"},
                               {"friction", "stribeck"},
                               {"stribeck_velocity", "0.2"},
                               {"noise", "telegraph"},
                               {"telegraph_amplitude", "2"},
                               {"telegraph_rate", "3"},
                               {"drag", "cubic"},
                               {"drag_coefficient", "0"},
                               {"drag_cubic", "4"}});
  CHECK(other.friction.stribeck->velocity == 0.2);
  CHECK(other.noise.table->at(other.noise.table->highest()).x == 2);
  CHECK(other.noise.table->at(other.noise.table->highest()).down == 3);
  CHECK(other.drag(2) == -32);
  CHECK(heading_of(effects::frictions(), other) ==
        Parts{"stribeck_velocity = 0.2", "stribeck_exponent = 1"});
  CHECK(heading_of(effects::noises(), other) == Parts{"telegraph noise a = 2, rate = 3"});
  CHECK(heading_of(effects::drags(), other) == Parts{"drag cubic, c3 = 4"});
  const auto formula = scene_of(
      {{"mu_d", "0.5"}, {"drag", "expression"}, {"drag_expression", "-tau*v"}, {"tau", "2"}});
  CHECK(formula.drag(1) == -2);
  CHECK(heading_of(effects::drags(), formula) == Parts{"drag b(v) = -tau*v"});
}

TEST_CASE("effects: what they lack or cannot be is refused") {
  using Catch::Contains;
  CHECK_THAT(said_of({{"noise", "telegraph"}}), Contains("-noise needs -telegraph_amplitude"));
  CHECK_THAT(said_of({{"noise", "telegraph"}, {"telegraph_amplitude", "2"}}),
             Contains("-noise needs -telegraph_rate"));
  CHECK_THAT(said_of({{"noise", "file"}}), Contains("-noise needs -noise_file"));
  CHECK_THAT(said_of({{"noise", "file"}, {"noise_file", "none.csv"}}),
             Contains("-noise_file cannot be read"));
  CHECK_THAT(said_of({{"friction", "stribeck"}}), Contains("-friction needs -stribeck_velocity"));
  CHECK_THAT(said_of({{"drag", "expression"}}), Contains("-drag needs -drag_expression"));
  CHECK_THAT(said_of({{"delta_per_mu_s", "8"}, {"delta", "0.1"}}),
             Contains("so does -delta = 0.1"));
  CHECK_THAT(said_of({{"delta", "2"}}), Contains("-delta leaves no noise level besides 0"));
  CHECK_THAT(said_of({{"noise_levels", "1000"}}), Contains("-noise_levels gives tau delta L_X"));
  CHECK_THAT(said_of({{"mu_s", "100"}}), Contains("the body never slides"));
  CHECK_THAT(said_of({{"mu_d", "2"}}), Contains("-mu_d must be in [0, mu_s]"));
}
