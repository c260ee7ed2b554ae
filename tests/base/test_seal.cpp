#include <stdexcept>

#include "../common/catch.hpp"
#include "stickslip/base/files.hpp"

using stickslip::sealed;
using stickslip::unsealed;

TEST_CASE("seal: what was sealed comes back") {
  for (const std::string object : {R"({"a":1})", "{}", R"({"x":[1.5,2],"y":"}"})"}) {
    CHECK(unsealed(sealed(object)) == object);
  }
  CHECK_THROWS_AS(sealed("[1]"), std::invalid_argument);
}

TEST_CASE("seal: any changed, missing or added byte is seen") {
  const std::string whole = sealed(R"({"rounds":12,"tally":[0.25,1e-3]})");
  for (std::size_t n = 0; n < whole.size(); ++n) {
    for (int bit = 0; bit < 8; ++bit) {
      std::string other = whole;
      other[n] = static_cast<char>(other[n] ^ (1 << bit));
      CHECK_FALSE(unsealed(other));
    }
    CHECK_FALSE(unsealed(whole.substr(0, n)));
  }
  CHECK_FALSE(unsealed(whole + "}"));
  CHECK_FALSE(unsealed(R"({"rounds":12})"));
}
