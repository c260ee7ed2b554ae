#include "all.hpp"
#include "ou_noise.hpp"
#include "plane_lattice.hpp"

namespace stickslip::effects {
namespace {

constexpr const char *kBandFrequency = "band_frequency", *kBandWidth = "band_width";

PlaneNoise band_of(const model::Scene& scene) {
  return {*scene.noise.deviation, own_number(scene, kBandWidth), own_number(scene, kBandFrequency)};
}

void read_band(Given& given, model::Scene& scene) {
  read_lattice(given, scene, {kBandFrequency, kBandWidth}, 1);
  scene.noise.target = spectrum_of(band_of(scene));
}

model::LevelTable band_levels(const model::Scene& scene) {
  return lattice_of(band_of(scene), scene);
}

}  // namespace

const Effect kNarrowBand{
    .word = "narrow_band",
    .sentence = "Gaussian noise of covariance deviation^2 exp(-gamma t) cos(omega t), on a lattice",
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
         {deviation_option()},
         {delta_option()},
         {radius_option(), true}},
    .read = read_band,
    .complete = complete_lattice,
    .levels = band_levels,
    .values = lattice_values,
    .stronger = stronger_lattice,
    .note = [](const model::Scene& scene) { return lattice_note(scene, band_of(scene)); }};

}  // namespace stickslip::effects
