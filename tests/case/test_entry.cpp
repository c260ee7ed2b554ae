#include "../common/catch.hpp"
#include "stickslip/case/entry.hpp"

#include <set>
#include <string>
#include <string_view>

#include "stickslip/case/spectrum_rows.hpp"
#include "stickslip/case/sticking_rows.hpp"

using namespace stickslip::cases;

TEST_CASE("catalogue: keys are unique, every result has a symbol and a definition") {
  std::set<std::string_view> keys;
  for (const auto* entry : entries()) {
    CHECK(find_entry(entry->word) == entry);
    for (const auto* row : entry->rows) {
      INFO(row->key);
      CHECK(keys.insert(row->key).second);
      CHECK_FALSE(row->symbol.empty());
      CHECK_FALSE(row->definition.empty());
      CHECK(find_row(row->key) == row);
      CHECK(entry_of(row->key) == entry);
    }
  }
}

TEST_CASE("catalogue: results of observables and derivatives are found by their patterns") {
  const auto pattern = [](const char* key) {
    const Row* row = find_row(key);
    return row == nullptr ? std::string() : std::string(row->key);
  };
  CHECK(pattern("pi(v^2)") == "pi(f)");
  CHECK(pattern("pi(|v|)") == "pi(f)");
  CHECK(pattern("pi(|v||stick)") == "pi(f|stick)");
  CHECK(pattern("pi(abs(v)>0.5|slide)") == "pi(f|slide)");
  CHECK(pattern("w_plus(x*(1+v))") == "w_plus(f)");
  CHECK(pattern("stationary(1)") == "stationary(f)");
  CHECK(pattern("dP_stick_dmu_d") == "dA_dp");
  CHECK(pattern("dE_V2_dmu_d_minus") == "dA_dp");
  CHECK(pattern("dE_X2_ddrag_coefficient") == "dA_dp");
  for (const char* unknown : {"", "foo", "foo(v)", "u(v|stick)", "pi", "pi(v", "dP_stick_dmu",
                              "dfoo_dtau", "d_dtau", "dS_0_dtau", "P_stick_dtau", "P_stick(v)"}) {
    INFO(unknown);
    CHECK(pattern(unknown).empty());
  }
}

TEST_CASE("catalogue: the key of an observable is found again by its row") {
  CHECK(kPiStick.key_of("v^2") == "pi(v^2|stick)");
  CHECK(kU.key_of("abs(v)>0.5") == "u(abs(v)>0.5)");
  CHECK(find_row(kPiStick.key_of("f(x)")) == &kPiStick);
  CHECK(kU.is_pattern());
  CHECK_FALSE(kWOne.is_pattern());
}
