#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <numbers>

#include "../common/given.hpp"
#include "../common/temporary.hpp"

using namespace stickslip;
using test::said_of;
using test::scene_of;

namespace {

using Given = std::map<std::string, std::string>;

Given with(Given all, const Given& more) {
  for (const auto& [name, value] : more) all[name] = value;
  return all;
}

const model::LevelTable& table_of(const model::Scene& scene) { return *scene.noise.table; }

bool near(double a, double b, double tolerance) { return std::abs(a - b) <= tolerance; }

// The largest difference between two chains of the same forces, in forces and rates.
double difference(const model::LevelTable& a, const model::LevelTable& b) {
  REQUIRE(a.lowest() == b.lowest());
  REQUIRE(a.highest() == b.highest());
  double largest = 0;
  for (int i = a.lowest(); i <= a.highest(); ++i) {
    std::map<int, double> rates;
    a.for_each_jump(i, [&](int to, double rate) { rates[to] += rate; });
    b.for_each_jump(i, [&](int to, double rate) { rates[to] -= rate; });
    largest = std::max(largest, std::abs(a.at(i).x - b.at(i).x));
    for (const auto& [to, rate] : rates) largest = std::max(largest, std::abs(rate));
  }
  return largest;
}

const Given kBand{
    {"noise", "narrow_band"}, {"band_frequency", "2"}, {"band_width", "0.5"}, {"mu_d", "0.5"}};
const Given kGround{
    {"noise", "filtered"}, {"ground_frequency", "3"}, {"ground_damping", "0.5"}, {"mu_d", "0.5"}};
const Given kSine{
    {"noise", "periodic"}, {"periodic_amplitude", "1.2"}, {"period", "4"}, {"mu_d", "0.5"}};
const Given kPulses{
    {"noise", "pulses"}, {"pulse_height", "2"}, {"pulse_rate", "0.8"}, {"mu_d", "0.5"}};

}  // namespace

TEST_CASE("narrow band and filtered noise are Gaussian noise of continuous paths") {
  for (const auto& [given, terms] :
       {std::pair(kBand, model::CovarianceTerm{1, 0.5, 2}),
        std::pair(kGround, model::CovarianceTerm{1, 1.5, 3 * std::sqrt(0.75), 0}),
        std::pair(Given{{"noise", "ou"}, {"tau", "0.5"}, {"delta", "0"}, {"mu_d", "0.5"}},
                  model::CovarianceTerm{2, 2})}) {
    const auto scene = scene_of(given);
    REQUIRE(scene.noise.gaussian);
    const auto& found = scene.noise.gaussian->terms().at(0);
    INFO(given.at("noise"));
    CHECK(near(found.amplitude, terms.amplitude, 1e-12));
    CHECK(near(found.decay, terms.decay, 1e-12));
    CHECK(near(found.frequency, terms.frequency, 1e-12));
    CHECK(near(found.sine, terms.sine, 1e-12));
    for (double omega : {0.0, 1.0, 5.0}) {
      CHECK(near(scene.noise.target(omega), scene.noise.gaussian->power_spectral_density(omega),
                 1e-12));
    }
  }
  CHECK_THAT(said_of(with(kBand, {{"delta", "0.5"}})),
             Catch::Contains("a step between levels, and -noise narrow_band has none"));
}

TEST_CASE("filtered noise: the intensity of what is filtered gives the deviation") {
  const auto given = with(kGround, {{"ground_intensity", "0.3"}});
  const auto scene = scene_of(given);
  CHECK(near(*scene.noise.deviation, std::sqrt(0.3 * 3 * 2), 1e-12));
  CHECK_THAT(said_of(with(given, {{"noise_deviation", "1"}})),
             Catch::Contains("fixes the deviation, and so does -noise_deviation"));
}

TEST_CASE("periodic noise: phases follow one another, with the force of each") {
  const auto scene = scene_of(with(kSine, {{"period_phases", "8"}}));
  const auto& table = table_of(scene);
  CHECK(table.highest() - table.lowest() == 7);
  CHECK(table.even());
  CHECK(near(table.at(table.highest()).x, 1.2, 1e-12));
  CHECK(near(table.variance(), 0.72, 1e-12));
  CHECK(near(table.rate(), 2, 1e-12));
  const test::TemporaryFolder folder;
  const std::string file = folder / "shape.csv";
  std::ofstream(file) << "x\n-1\n0\n2\n0\n";
  const auto shaped = scene_of(with(kSine, {{"period_shape", file}}));
  CHECK(near(table_of(shaped).mean(), 0.3, 1e-12));
  CHECK(near(table_of(shaped).rate(), 1, 1e-12));
  const auto both = scene_of(with(kSine, {{"period_shape", file}, {"period_phases", "4"}}));
  CHECK(difference(table_of(both), table_of(shaped)) == 0);
  CHECK_THAT(said_of(with(kSine, {{"period_shape", file}, {"period_phases", "5"}})),
             Catch::Contains("holds 4 phases, but -period_phases is 5"));
  std::ofstream(file) << "x\n-1\n1\n";
  CHECK_THAT(said_of(with(kSine, {{"period_shape", file}})), Catch::Contains("three phases"));
}

TEST_CASE("pulses: mean and variance are those of shot noise") {
  const double height = 2, rate = 0.8, time = 0.5;
  struct {
    Given more;
    double mean, variance;
  } cases[] = {
      {{{"pulse_duration", "0.5"}, {"pulse_sign", "up"}}, 1, 1},
      {{{"pulse_duration", "0.5"}, {"pulse_sign", "down"}}, -1, 1},
      {{{"pulse_duration", "0.5"}}, 0, 1},
      {{{"pulse_decay", "0.5"}, {"pulse_sign", "up"}, {"pulse_steps", "1"}}, 1, 1},
      {{{"pulse_decay", "0.5"}, {"pulse_sign", "up"}, {"pulse_steps", "4"}}, 1, 0.5 * 1.25},
      {{{"pulse_decay", "0.5"}, {"pulse_sign", "down"}, {"pulse_steps", "4"}}, -1, 0.5 * 1.25}};
  for (const auto& [more, mean, variance] : cases) {
    const auto scene = scene_of(with(kPulses, more));
    CHECK(near(table_of(scene).mean(), mean * height * rate * time, 1e-12));
    CHECK(near(table_of(scene).variance(), variance * height * height * rate * time, 1e-12));
  }
  // Levels at 0, with as many pulses up as down, are their own images.
  const auto two = scene_of(with(kPulses, {{"pulse_duration", "0.5"}}));
  CHECK(table_of(two).even());
  CHECK(!table_of(two).even_in_order());
  CHECK(near(table_of(two).variance(), height * height * rate * time, 4e-15));
  // The mean is 2 of each sign, and 23 of one have weight, but not with many of the other.
  const auto many = scene_of(with(kPulses, {{"pulse_duration", "5"}}));
  CHECK(table_of(many).even());
  CHECK(table_of(many).highest() - table_of(many).lowest() < 0.9 * 23 * 23);
  CHECK(table_of(many).at(table_of(many).highest()).x >= 22 * height);
  CHECK(near(table_of(many).variance(), height * height * rate * 5, 2e-14));
  // Where forces of both signs decay on one lattice, steps add no noise of their own for long.
  const auto both = scene_of(with(kPulses, {{"pulse_decay", "0.5"}, {"pulse_steps", "16"}}));
  CHECK(table_of(both).even());
  CHECK(near(table_of(both).variance(), height * height * rate * time / 2, 0.05));
  CHECK_THAT(said_of(kPulses), Catch::Contains("needs either -pulse_duration or -pulse_decay"));
  CHECK_THAT(said_of(with(kPulses, {{"pulse_duration", "1"}, {"pulse_steps", "4"}})),
             Catch::Contains("belongs to -pulse_decay"));
  CHECK_THAT(said_of(with(kPulses, {{"pulse_duration", "1e6"}})), Catch::Contains("at most 4000"));
}

// Levels of many pulses at once are left out, the first ones in the order of forces.
TEST_CASE("sums of noises: pulses downwards are the mirror image of those upwards") {
  const auto sum_with = [](const char* sign) {
    return scene_of(with(kPulses, {{"noise", "pulses+telegraph"},
                                   {"pulse_rate", "0.853"},
                                   {"pulse_duration", "0.279"},
                                   {"pulse_sign", sign},
                                   {"telegraph_amplitude", "0.5"},
                                   {"telegraph_rate", "1"}}));
  };
  const auto up = sum_with("up"), down = sum_with("down");
  CHECK(table_of(up).highest() - table_of(up).lowest() ==
        table_of(down).highest() - table_of(down).lowest());
  CHECK(near(table_of(down).mean(), -table_of(up).mean(), 1e-12));
  CHECK(near(table_of(down).variance(), table_of(up).variance(), 1e-12));
}

TEST_CASE("sums of noises: states are pairs, moments add up, options go to their noise") {
  const auto both = with(kSine, {{"noise", "periodic+ou"},
                                 {"period_phases", "16"},
                                 {"delta", "0.5"},
                                 {"noise_deviation", "0.7"},
                                 {"noise_levels", "3"}});
  const auto scene = scene_of(both);
  CHECK(table_of(scene).highest() - table_of(scene).lowest() + 1 == 7 * 16);
  CHECK(near(table_of(scene).rate(), 16 / 4.0 + 2 * 0.49 / 0.25, 1e-12));
  // State (phase k, level i) has the number 7 k + i + 3.
  for (int level : {table_of(scene).lowest(), 0, table_of(scene).highest()}) {
    const auto number = table_of(scene).listed(level);
    const double phase = 2 * std::numbers::pi * static_cast<double>(number / 7) / 16,
                 force = 0.5 * (static_cast<double>(number % 7) - 3);
    CHECK(near(table_of(scene).at(level).x, 1.2 * std::sin(phase) + force, 1e-12));
  }
  auto other = both;
  other["noise"] = "ou+periodic";
  CHECK(near(table_of(scene_of(other)).intensity(), table_of(scene).intensity(), 1e-12));
  const auto alone = scene_of(with(kSine, {{"period_phases", "16"}}));
  CHECK(effects::noises().knows(scene, "delta"));
  CHECK(effects::noises().knows(scene, "period"));
  CHECK(!effects::noises().knows(scene, "pulse_rate"));
  const auto band = scene_of(with(kBand, {{"noise", "narrow_band+gaussian"}}));
  std::map<std::string, int> stated;
  for (const auto& each : effects::parameters_of(band)) ++stated[each.first];
  for (const char* name : {"band_frequency", "band_width", "noise_deviation", "covariance"}) {
    INFO(name);
    CHECK(stated[name] == 1);
  }
  const auto parameters = effects::parameters_of(scene);
  const auto value = [&parameters](const std::string& name) {
    const auto found = std::find_if(parameters.begin(), parameters.end(),
                                    [&name](const auto& each) { return each.first == name; });
    return found == parameters.end() ? -1 : std::get<double>(found->second);
  };
  CHECK(value("noise_levels") == 3);
  CHECK(value("noise_deviation") == 0.7);
  CHECK(value("period_phases") == 16);
  CHECK(effects::heading(effects::noises().in(scene), scene)[0] ==
        "periodic_amplitude = 1.2, period = 4, period_phases = 16, tau = 1, delta = 0.5, "
        "noise_deviation = 0.7, noise_levels = 3");
  const auto three = scene_of(with(kPulses, {{"noise", "telegraph+pulses+periodic"},
                                             {"telegraph_amplitude", "0.3"},
                                             {"telegraph_rate", "2"},
                                             {"pulse_duration", "0.5"},
                                             {"pulse_sign", "up"},
                                             {"periodic_amplitude", "1.2"},
                                             {"period", "4"}}));
  CHECK(near(table_of(three).mean(), 0.8, 1e-12));
  CHECK(near(table_of(three).variance(), 0.09 + 1.6 + 0.72, 1e-12));
  CHECK(
      near(table_of(three).intensity(), 0.09 / 4 + 1.6 * 0.5 + table_of(alone).intensity(), 1e-10));
  CHECK_THAT(said_of(with(kBand, {{"noise", "narrow_band+ou"}})),
             Catch::Contains("joins two noises that take -noise_deviation"));
  CHECK_THAT(said_of({{"noise", "telegraph+periodic"}, {"telegraph_amplitude", "1"}}),
             Catch::Contains("needs -telegraph_rate") && Catch::Contains("needs -period"));
  CHECK_THAT(said_of(with(both, {{"delta", "0.001"}, {"noise_levels", "2000"}})),
             Catch::Contains("at most 4000"));
}
