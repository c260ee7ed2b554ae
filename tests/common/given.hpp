#pragma once
/// Scenes from the values of options.

#include <map>
#include <optional>
#include <string>
#include <utility>

#include "catch.hpp"
#include "stickslip/base/text.hpp"
#include "stickslip/model/effect.hpp"

namespace stickslip::test {

/// Values as a user would give them, and what is said about them.
class Values : public effects::Given {
 public:
  explicit Values(std::map<std::string, std::string> given) : given_(std::move(given)) {}

  [[nodiscard]] bool has(const std::string& option) const override {
    return given_.contains(option);
  }
  [[nodiscard]] std::string text(const std::string& option) const override {
    return has(option) ? given_.at(option) : effects::model_option(option).initial;
  }
  [[nodiscard]] double real(const std::string& option) const override {
    return parse_number(text(option)).value();
  }
  [[nodiscard]] std::optional<int> integer(const std::string& option) const override {
    const auto number = parse_number(text(option));
    return number ? std::optional(static_cast<int>(*number)) : std::nullopt;
  }
  void refuse(const std::string& option, const std::string& why, const std::string&) override {
    said_ += "-" + option + " " + why + "\n";
  }
  [[nodiscard]] bool sound() const override { return said_.empty(); }
  [[nodiscard]] const std::string& said() const { return said_; }

 private:
  std::map<std::string, std::string> given_;
  std::string said_;
};

inline std::string said_of(std::map<std::string, std::string> given) {
  Values values(std::move(given));
  (void)effects::read_scene(values);
  return values.said();
}

inline model::Scene scene_of(std::map<std::string, std::string> given) {
  Values values(std::move(given));
  auto scene = effects::read_scene(values);
  INFO(values.said());
  REQUIRE(values.sound());
  return scene;
}

}  // namespace stickslip::test
