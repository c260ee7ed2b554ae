#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "all.hpp"
#include "csv_rows.hpp"
#include "levels.hpp"
#include "stickslip/base/text.hpp"
#include "stickslip/model/effect.hpp"

namespace stickslip::effects {
namespace {

constexpr const char *kTerms = "covariance", *kTermsFile = "covariance_file";
constexpr const char* kForm =
    "amplitude,decay or amplitude,decay,frequency or amplitude,decay,frequency,sine";

// "a,g; a,g,w; a,g,w,k".
std::vector<model::CovarianceTerm> terms_of(const std::string& text) {
  std::vector<model::CovarianceTerm> terms;
  for (const auto& part : split(text, ';')) {
    std::vector<double> numbers;
    for (const auto& word : split(part, ',')) {
      const auto number = parse_number(word);
      if (!number) {
        throw std::invalid_argument(
            fmt::format("has \"{}\" in the place of a number in the term \"{}\"", word, part));
      }
      numbers.push_back(*number);
    }
    if (numbers.size() < 2 || numbers.size() > 4) {
      throw std::invalid_argument(fmt::format("has {} numbers in the term \"{}\", which is {}",
                                              numbers.size(), part, kForm));
    }
    numbers.resize(4, 0.0);
    terms.push_back({numbers[0], numbers[1], numbers[2], numbers[3]});
  }
  return terms;
}

std::string text_of(const std::vector<model::CovarianceTerm>& terms) {
  std::vector<std::string> parts;
  for (const auto& [amplitude, decay, frequency, sine] : terms) {
    parts.push_back(fmt::format("{},{},{},{}", amplitude, decay, frequency, sine));
  }
  return fmt::format("{}", fmt::join(parts, "; "));
}

void read_gaussian(Given& given, model::Scene& scene) {
  const bool by_file = given.has(kTermsFile);
  if (by_file && given.has(kTerms)) {
    return given.refuse(kTermsFile, fmt::format("gives the covariance, and so does -{}", kTerms),
                        "leave one of them out");
  }
  const char* option = by_file ? kTermsFile : kTerms;
  const std::string fix = fmt::format("write {}; for example 1,0.5,2", kForm);
  std::vector<model::CovarianceTerm> terms;
  try {
    if (by_file) {
      for (const auto& [amplitude, decay, frequency, sine] :
           read_csv<4>(given.text(kTermsFile), {"amplitude", "decay", "frequency", "sine"},
                       ::io::ignore_no_column)
               .values) {
        terms.push_back({amplitude, decay, frequency, sine});
      }
    } else {
      terms = terms_of(given.text(kTerms));
    }
  } catch (const std::exception& problem) {
    return given.refuse(option, problem.what(), fix);
  }
  make_continuous(given, scene, terms, option, fix);
  if (scene.noise.gaussian) scene.own.emplace_back(kTerms, text_of(terms));
}

}  // namespace

void make_continuous(Given& given, model::Scene& scene,
                     const std::vector<model::CovarianceTerm>& terms, const char* option,
                     const std::string& fix) {
  try {
    scene.noise.gaussian = std::make_shared<const model::GaussianNoise>(terms);
  } catch (const model::UnfitTable& unfit) {
    const bool one = unfit.row() < terms.size();
    const std::string where = one ? fmt::format("term {}: ", unfit.row() + 1) : "";
    return given.refuse(option, where + unfit.what(), fix);
  }
  scene.noise.target = [noise = scene.noise.gaussian](double omega) {
    return noise->power_spectral_density(omega);
  };
}

bool complete_continuous(Given& given, model::Scene& scene) {
  if (!given.sound() || !scene.noise.gaussian) return false;
  try {
    scene.noise.table = scene.meant().noise.table;
  } catch (const model::UnfitTable& unfit) {
    given.refuse("noise", unfit.what(), "take fewer terms");
  }
  return scene.noise.table != nullptr;
}

const Effect kGaussianNoise{
    .word = "gaussian",
    .sentence = "any Gaussian noise with a rational spectrum, of continuous paths and without "
                "levels",
    .parameters =
        {{Option::text_of(kTerms, "terms", "1,1",
                          "covariance C(t) of -noise gaussian as a sum of terms amplitude "
                          "exp(-decay t) (cos(frequency t) + sine sin(frequency t)), each written "
                          "amplitude,decay[,frequency[,sine]], with ; between them")
              .called({"autocovariance", "acf"}),
          true},
         {Option::file(kTermsFile, Kind::input,
                       "CSV with the columns amplitude,decay,frequency,sine: the terms of "
                       "-covariance, one a line",
                       {.label = "covariance of"}),
          true}},
    .read = read_gaussian,
    .complete = complete_continuous,
    .stronger = [](const model::Scene&) {
      return std::string("larger amplitudes in -covariance");
    }};

}  // namespace stickslip::effects
