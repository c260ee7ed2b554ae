#include "../common/catch.hpp"
#include "stickslip/case/entry.hpp"

#include <algorithm>
#include <set>
#include <string_view>

using namespace stickslip::cases;

TEST_CASE("solution methods: each is found by its word and its route, and says what it does") {
  std::set<std::string_view> words;
  for (const auto& method : solution_methods()) {
    INFO(method.word);
    CHECK(words.insert(method.word).second);
    CHECK_FALSE(method.sentence.empty());
    CHECK(&method_of(method.word) == &method);
    CHECK(&method_of(method.route) == &method);
  }
  CHECK(method_of("nonsense").word == solution_methods().front().word);
}

TEST_CASE("solution methods: the default gives every quantity, and others say why they do not") {
  const auto all = entries();
  for (const auto& method : solution_methods()) {
    INFO(method.word);
    const bool gives_all = std::all_of(all.begin(), all.end(), [&method](const Entry* entry) {
      return entry->routes.contains(method.route);
    });
    CHECK(method.limit.empty() == gives_all);
  }
  CHECK(solution_methods().front().limit.empty());
}

TEST_CASE("solution methods: what is simulated has no discretisation and no small lambda") {
  for (const auto& method : solution_methods()) {
    INFO(method.word);
    CHECK_FALSE((method.simulates && (method.discretises_velocity || method.small_lambda)));
    CHECK((method.discretises_velocity || !method.full_grid));
  }
}

TEST_CASE("solution methods: routes are a set") {
  constexpr Routes some{Route::excursion, Route::monte_carlo};
  CHECK(some.contains(Route::excursion));
  CHECK(some.contains(Route::monte_carlo));
  CHECK_FALSE(some.contains(Route::lambda));
  CHECK_FALSE(Routes{}.contains(Route::excursion));
}
