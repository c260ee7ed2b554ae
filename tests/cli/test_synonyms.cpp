#include "../common/catch.hpp"
#include <set>

#include "stickslip/base/text.hpp"
#include "stickslip/cli/options.hpp"

using namespace stickslip::cli;

namespace {

bool is_word(const Option& option, const std::string& word) {
  return std::count(option.words.begin(), option.words.end(), word) > 0;
}

}  // namespace

TEST_CASE("synonyms: each means an option or a word that there is, and is none itself") {
  const auto names = all_names();
  std::set<std::string> seen;
  for (const auto& row : all_synonyms()) {
    INFO(row.option << " " << row.word);
    REQUIRE(std::count(names.begin(), names.end(), "-" + row.option) == 1);
    REQUIRE_FALSE(row.others.empty());
    if (!row.word.empty()) {
      REQUIRE(find(row.option) != nullptr);
      CHECK(is_word(*find(row.option), row.word));
    }
    for (const auto& other : row.others) {
      INFO(other);
      CHECK(seen.insert((row.word.empty() ? "" : row.option) + " " + other).second);
      const bool known =
          row.word.empty() ? find(other) != nullptr : is_word(*find(row.option), other);
      CHECK_FALSE(known);
    }
  }
}

TEST_CASE("synonyms: the option that is meant") {
  CHECK(suggestion_for_option("sigma") == "did you mean -noise_deviation?");
  CHECK(suggestion_for_option("record") == "did you mean -noise_file? See docs/recorded_forces.md");
  CHECK(suggestion_for_option("ksp_view") == "did you mean -slide_ksp_view?");
  CHECK(suggestion_for_option("mat_view") == "did you mean -slide_mat_view?");
  CHECK(suggestion_for_option("eps_nev") == "did you mean -relax_eps_nev or -null_eps_nev?");
  CHECK(suggestion_for_option("detla") == "did you mean -delta?");
  CHECK(suggestion_for_option("D") == "did you mean -noise_deviation?");
  CHECK(suggestion_for_option("zzzzzzzz") == "-help lists all");
}

TEST_CASE("synonyms: a value behind an equals sign") {
  CHECK(suggestion_for_option("mu_d=0.5") == "write -mu_d 0.5");
  CHECK(suggestion_for_option("sigma=0.5") == "write -noise_deviation 0.5");
  CHECK(suggestion_for_option("zzzzzzzz=0.5") == "write -name 0.5");
  CHECK(suggestion_for_option("mu_d=") == "write -mu_d value");
}

TEST_CASE("synonyms: the word that is meant") {
  const Option& quantities = *find("quantities");
  CHECK(meant_word(quantities, "psd") == "spectrum");
  CHECK(meant_word(quantities, "mfpt") == "first_passage");
  CHECK(meant_word(quantities, "first_passage_distribution") == "passage_distribution");
  CHECK(meant_word(quantities, "P_stick") == "sticking");  // a key, not a misspelt F_stick
  CHECK(meant_word(quantities, "momens") == "moments");
  CHECK(meant_word(quantities, "simulation") == "trajectory");
  CHECK(meant_word(*find("route"), "simulation") == "monte_carlo");
  CHECK(meant_word(quantities, "zzzzzzzz").empty());
}
