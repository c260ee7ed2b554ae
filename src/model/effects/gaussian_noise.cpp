#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "../moved_nodes.hpp"
#include "all.hpp"
#include "csv_rows.hpp"
#include "levels.hpp"
#include "stickslip/base/errors.hpp"
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
  if (given.has(kDelta) && given.real(kDelta) > 0) {
    return given.refuse(kDelta,
                        fmt::format("is a step between levels, and -noise {} has none: its paths "
                                    "are continuous",
                                    scene.noise.name),
                        "leave it out, or take 0 where a sum has ou; in Python lattice(delta) of "
                        "such a noise makes a chain of levels");
  }
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

namespace {

// Gaussian noises by name, of one term.

// Reads the options of a term, the last of which damps it, and the deviation if it is given.
void make_named(Given& given, model::Scene& scene, std::initializer_list<const char*> own,
                double deviation, model::CovarianceTerm (*term)(const model::Scene&)) {
  scene.noise.deviation = given.has(kDeviation) ? given.real(kDeviation) : deviation;
  for (const char* name : own) scene.own.emplace_back(name, given.real(name));
  if (!given.sound()) return;
  const char* damping = own.end()[-1];
  make_continuous(given, scene, {term(scene)}, damping, fmt::format("take a larger -{}", damping));
}

double variance_of(const model::Scene& scene) { return std::pow(*scene.noise.deviation, 2); }

model::Parameters deviation_of(const model::Scene& scene) {
  return {{kDeviation, *scene.noise.deviation}};
}

std::string larger_deviation(const model::Scene&) {
  return fmt::format("a larger -{}", kDeviation);
}

constexpr const char *kGroundFrequency = "ground_frequency", *kGroundDamping = "ground_damping",
                     *kGroundIntensity = "ground_intensity", *kBandFrequency = "band_frequency",
                     *kBandWidth = "band_width";

// White noise of spectrum S at the foot of an oscillator, q'' + 2 zeta w q' + w^2 q = -noise, gives
// its mass the acceleration X = 2 zeta w q' + w^2 q, of which the spectrum is
//
//   S (1 + (2 zeta r)^2)/((1 - r^2)^2 + (2 zeta r)^2),  r = omega/w,
//
// and the covariance deviation^2 exp(-zeta w t) (cos(nu t) + k sin(nu t)), nu = w (1 - zeta^2)^1/2.
model::CovarianceTerm ground_of(const model::Scene& scene) {
  const double w = own_number(scene, kGroundFrequency), zeta = own_number(scene, kGroundDamping),
               turn = std::sqrt((1 - zeta) * (1 + zeta)), square = 4 * zeta * zeta;
  return {variance_of(scene), zeta * w, turn * w, zeta * (1 - square) / (turn * (1 + square))};
}

void read_ground(Given& given, model::Scene& scene) {
  if (given.has(kGroundIntensity) && given.has(kDeviation)) {
    return given.refuse(kGroundIntensity,
                        fmt::format("fixes the deviation, and so does -{}", kDeviation),
                        "leave one of them out");
  }
  const double w = given.real(kGroundFrequency), zeta = given.real(kGroundDamping);
  double deviation = 1;
  if (given.has(kGroundIntensity)) {
    const double intensity = given.real(kGroundIntensity);
    scene.own.emplace_back(kGroundIntensity, intensity);
    deviation = std::sqrt(intensity * w * (1 + 4 * zeta * zeta) / (2 * zeta));
  }
  make_named(given, scene, {kGroundFrequency, kGroundDamping}, deviation, ground_of);
}

// The options of a scene as files state them, with another value of one.
class Stated final : public Given {
 public:
  Stated(const model::Scene& scene, std::string_view option, double value)
      : all_(parameters_of(scene)) {
    std::erase_if(all_, [&scene](const auto& each) {
      return each.first != kDelta && is_given_by_another(scene, each.first);
    });
    for (auto& [name, stated] : all_) {
      if (name == option) stated = value;
    }
  }
  [[nodiscard]] bool has(const std::string& option) const override { return found(option); }
  [[nodiscard]] double real(const std::string& option) const override {
    return std::get<double>(*found(option));
  }
  [[nodiscard]] std::string text(const std::string& option) const override {
    return std::get<std::string>(*found(option));
  }
  [[nodiscard]] std::optional<int> integer(const std::string&) const override { return {}; }
  void refuse(const std::string& option, const std::string& why, const std::string&) override {
    throw NotReached(fmt::format("no derivative by -{}: it {}", option, why));
  }
  [[nodiscard]] bool sound() const override { return true; }

 private:
  [[nodiscard]] const std::variant<double, std::string>* found(std::string_view option) const {
    const auto at = std::ranges::find(all_, option, &model::Parameters::value_type::first);
    return at == all_.end() ? nullptr : &at->second;
  }

  model::Parameters all_;
};

// The scene where a parameter of friction or of the noise has another value.
model::Scene scene_at(model::Scene scene, std::string_view option, double value) {
  const std::pair<std::string_view, double*> coefficients[] = {
      {"mu_s", &scene.friction.mu_s},
      {"mu_d", &scene.friction.mu_d},
      {"mu_s_minus", scene.friction.mu_s_minus ? &*scene.friction.mu_s_minus : nullptr},
      {"mu_d_minus", scene.friction.mu_d_minus ? &*scene.friction.mu_d_minus : nullptr}};
  for (const auto& [name, coefficient] : coefficients) {
    if (name != option) continue;
    *coefficient = value;
    return scene;
  }
  Stated given(scene, option, value);
  std::erase_if(scene.own,
                [all = scene](const auto& each) { return noises().knows(all, each.first); });
  scene.noise = {.name = scene.noise.name};
  read_effect(given, noises(), std::string(scene.noise.name), scene);
  return scene;
}

// Of places of the same nodes below and above.
model::NodeChange difference(const model::LevelTable& below, const model::LevelTable& above,
                             double step) {
  model::NodeChange change;
  for (int i = below.lowest(); i <= below.highest(); ++i) {
    const int other = i - below.lowest() + above.lowest();
    change.x.push_back((above.at(other).x - below.at(i).x) / step);
    std::map<int, double> rates;
    below.for_each_jump(i, [&](int to, double rate) { rates[to - below.lowest()] -= rate / step; });
    above.for_each_jump(other,
                        [&](int to, double rate) { rates[to - above.lowest()] += rate / step; });
    auto& row = change.rates.emplace_back();
    for (const auto& [to, rate] : rates) row.push_back({to, rate});
  }
  return change;
}

}  // namespace

bool is_given_by_another(const model::Scene& scene, std::string_view option) {
  const auto is_intensity = [](const auto& each) { return each.first == kGroundIntensity; };
  return option == kDelta || (option == kDeviation && std::ranges::any_of(scene.own, is_intensity));
}

std::shared_ptr<const model::NodeChange> change_of_nodes(const model::Scene& scene,
                                                         const model::Derivative& by, int order) {
  const bool of_friction = by.option.starts_with("mu_");
  if (!scene.noise.gaussian || !(of_friction || noises().knows(scene, by.option))) return nullptr;
  const auto stated = parameters_of(scene);
  const auto at = std::ranges::find(stated, by.option, &model::Parameters::value_type::first);
  const double value = std::get<double>(at->second),
               scale = of_friction ? scene.noise.gaussian->deviation() : value;
  // Rounding of rates leaves 1e-11 of their change, and what the differences leave out 1e-10.
  const double step = 1e-5 * scale;
  const auto nodes = [&](double there) {
    const auto changed = scene_at(scene, by.option, there);
    return model::moved_nodes({*scene.noise.gaussian, scene.thresholds()},
                              {*changed.noise.gaussian, changed.thresholds()}, order);
  };
  return std::make_shared<model::NodeChange>(
      difference(*nodes(value - step), *nodes(value + step), 2 * step));
}

const Effect kFilteredNoise{
    .word = "filtered",
    .sentence = "white noise through a damped oscillator (Kanai and Tajimi)",
    .others = {"kanai_tajimi", "kanai-tajimi", "tajimi", "ground", "ground_motion", "earthquake",
               "seismic"},
    .parameters =
        {{Option::real(kGroundFrequency, "1/time", "", Range::positive(),
                       "angular frequency w of the oscillator of -noise filtered",
                       "take for example 15.6",
                       {.symbol = "\\omega_g",
                        .label = "frequency of the ground",
                        .slider = Slider{.low = 0.2, .high = 20, .start = 2, .logarithmic = true}}),
          true, "15.6"},
         {Option::real(kGroundDamping, "", "", {0, 1, false, false},
                       "damping ratio zeta of the oscillator of -noise filtered",
                       "take for example 0.6",
                       {.symbol = "\\zeta_g",
                        .label = "damping of the ground",
                        .slider = Slider{.low = 0.2, .high = 0.9, .start = 0.6}}),
          true, "0.6"},
         {Option::real(kGroundIntensity, "force^2 time", "", Range::positive(),
                       "intensity D of the white noise that -noise filtered passes on: half the "
                       "integral of its covariance, pi times its two-sided spectrum per angular "
                       "frequency. X has the variance D w (1 + 4 zeta^2)/(2 zeta)",
                       fmt::format("or give -{} in its place", kDeviation),
                       {.symbol = "D", .label = "intensity of the ground"}),
          true},
         {deviation_option()}},
    .read = read_ground,
    .complete = complete_continuous,
    .values = deviation_of,
    .stronger = larger_deviation};

const Effect kNarrowBand{
    .word = "narrow_band",
    .sentence = "Gaussian noise of covariance deviation^2 exp(-gamma t) cos(omega t)",
    .others = {"narrowband", "band", "harmonic", "waves"},
    .parameters =
        {{Option::real(kBandFrequency, "1/time", "", Range::positive(),
                       "angular frequency omega of -noise narrow_band, at the middle of its band",
                       "take for example 2",
                       {.symbol = "\\omega_0",
                        .label = "frequency of the band",
                        .slider = Slider{.low = 0.2, .high = 10, .start = 2, .logarithmic = true}}),
          true, "2"},
         {Option::real(
              kBandWidth, "1/time", "", Range::positive(),
              "half width gamma of the band: where the spectrum of -noise narrow_band has fallen "
              "to a half. Its covariance decays at this rate",
              "take for example 0.5",
              {.symbol = "\\gamma",
               .label = "half width of the band",
               .slider = Slider{.low = 0.1, .high = 5, .start = 0.5, .logarithmic = true}}),
          true, "0.5"},
         {deviation_option()}},
    .read =
        [](Given& given, model::Scene& scene) {
          make_named(given, scene, {kBandFrequency, kBandWidth}, 1,
                     [](const model::Scene& of) -> model::CovarianceTerm {
                       return {variance_of(of), own_number(of, kBandWidth),
                               own_number(of, kBandFrequency)};
                     });
        },
    .complete = complete_continuous,
    .values = deviation_of,
    .stronger = larger_deviation};

}  // namespace stickslip::effects
