#pragma once
/// Named results with their errors.

#include <string>
#include <utility>
#include <vector>

namespace stickslip::quantities {

/// What a result is, whatever it is called: its range and direction (accuracy/result_bounds.hpp),
/// and with which others it shares errors (accuracy/estimates.hpp), follow from it.
enum class Kind {
  other,          ///< nothing more is known
  probability,    ///< in [0, 1]
  share,          ///< of the time: one of two probabilities whose sum is 1
  mean,           ///< of what has either sign
  drift,          ///< a mean that may vanish
  positive_mean,  ///< of a duration or a square
  transform,      ///< E[exp(-lambda T)]: in [0, 1], falls with lambda
  distribution,   ///< P(T <= t): in [0, 1], rises with t
  spectrum        ///< a power spectral density, >= 0
};

/// What a scalar is called, in which unit, and what it is.
struct Name {
  const char* key;
  const char* unit;
  Kind kind = Kind::other;
};

// Those that several solution methods compute.
inline constexpr Name kPStick{"P_stick", "", Kind::share};
inline constexpr Name kPSlide{"P_slide", "", Kind::share};
inline constexpr Name kPWithin{"P_X_le_mu_s", "", Kind::probability};
inline constexpr Name kMeanStick{"mean_stick", "time", Kind::positive_mean};
inline constexpr Name kMeanSlide{"mean_slide", "time", Kind::positive_mean};
inline constexpr Name kMeanExcursion{"mean_excursion", "time", Kind::positive_mean};
inline constexpr Name kMeanSlip{"mean_slip", "velocity*time", Kind::positive_mean};
inline constexpr Name kVarSlip{"var_slip", "velocity^2*time^2"};
inline constexpr Name kMeanSlipNet{"mean_slip_net", "velocity*time", Kind::drift};
inline constexpr Name kVarSlipNet{"var_slip_net", "velocity^2*time^2"};
inline constexpr Name kEV2{"E_V2", "velocity^2", Kind::positive_mean};
inline constexpr Name kEAbsV{"E_absV", "velocity", Kind::mean};
inline constexpr Name kEXV{"E_XV", "force*velocity", Kind::mean};
inline constexpr Name kEV{"E_V", "velocity", Kind::drift};
inline constexpr Name kEX2{"E_X2", "force^2", Kind::positive_mean};
inline constexpr Name kFStick0{"f_stick_0", "1/time"};
inline constexpr Name kSlipRate{"slip_rate", "1/time", Kind::positive_mean};
inline constexpr Name kFrictionPower{"friction_power", "force*velocity", Kind::positive_mean};
inline constexpr Name kS0{"S_0", "velocity^2*time", Kind::spectrum};
inline constexpr Name kDiffusivity{"diffusivity", "velocity^2*time"};

/// A scalar (no abscissa, one value) or an array over an abscissa.
struct Result {
  std::string key;            ///< name in table, JSON and HDF5
  std::string unit;           ///< empty for pure numbers
  std::string abscissa_name;  ///< empty for a scalar
  std::vector<double> abscissa;
  std::vector<double> value;
  std::vector<double> error;  ///< absolute error estimates, one for each value
  Kind kind = Kind::other;
  /// Whether accuracy is meant relative to each value of an array, not to the largest one.
  bool each_by_its_size = false;
  /// 95 % confidence intervals, one for each value; none for deterministic results.
  std::vector<std::pair<double, double>> ci95 = {};

  [[nodiscard]] bool is_scalar() const { return abscissa_name.empty(); }
};

using Results = std::vector<Result>;

/// A scalar result.
[[nodiscard]] inline Result scalar(std::string key, std::string unit, double value, double error) {
  return {std::move(key), std::move(unit), "", {}, {value}, {error}};
}
[[nodiscard]] inline Result scalar(const Name& name, double value, double error) {
  return {name.key, name.unit, "", {}, {value}, {error}, name.kind};
}

/// An array result without values yet. Transforms and spectra, which span decades, are meant
/// relative to each value.
[[nodiscard]] inline Result array(std::string key, std::string unit, std::string abscissa_name,
                                  std::vector<double> abscissa, Kind kind = Kind::other) {
  const bool each = kind == Kind::transform || kind == Kind::spectrum;
  return {std::move(key),
          std::move(unit),
          std::move(abscissa_name),
          std::move(abscissa),
          {},
          {},
          kind,
          each};
}

/// Largest error relative to the size of the values; infinite where one is not a number.
[[nodiscard]] double relative_error(const Result& result);

}  // namespace stickslip::quantities
