#pragma once
/// Named results with their errors.

#include <string>
#include <utility>
#include <vector>

#include "stickslip/options/result_table.hpp"

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

/// What a scalar is called and what it is. Its unit and meaning stand in the table of results.
struct Name {
  const char* key;
  Kind kind = Kind::other;
};

// Those that several solution methods compute.
inline constexpr Name kPStick{"P_stick", Kind::share};
inline constexpr Name kPSlide{"P_slide", Kind::share};
inline constexpr Name kPWithin{"P_X_le_mu_s", Kind::probability};
inline constexpr Name kMeanStick{"mean_stick", Kind::positive_mean};
inline constexpr Name kMeanSlide{"mean_slide", Kind::positive_mean};
inline constexpr Name kMeanExcursion{"mean_excursion", Kind::positive_mean};
inline constexpr Name kMeanSlip{"mean_slip", Kind::positive_mean};
inline constexpr Name kVarSlip{"var_slip"};
inline constexpr Name kMeanSlipNet{"mean_slip_net", Kind::drift};
inline constexpr Name kVarSlipNet{"var_slip_net"};
inline constexpr Name kEV2{"E_V2", Kind::positive_mean};
inline constexpr Name kEAbsV{"E_absV", Kind::mean};
inline constexpr Name kEXV{"E_XV", Kind::mean};
inline constexpr Name kEV{"E_V", Kind::drift};
inline constexpr Name kEX2{"E_X2", Kind::positive_mean};
inline constexpr Name kFStick0{"f_stick_0"};
inline constexpr Name kSlipRate{"slip_rate", Kind::positive_mean};
inline constexpr Name kFrictionPower{"friction_power", Kind::positive_mean};
inline constexpr Name kS0{"S_0", Kind::spectrum};
inline constexpr Name kDiffusivity{"diffusivity"};

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
  /// Whether it shows how good others are, and was not asked for: its error decides nothing.
  bool diagnostic = false;
  /// Whether values that are not numbers lie beyond double precision; the others do not.
  bool partial = false;
  /// 95 % confidence intervals, one for each value; none for deterministic results.
  std::vector<std::pair<double, double>> ci95 = {};

  [[nodiscard]] bool is_scalar() const { return abscissa_name.empty(); }
};

using Results = std::vector<Result>;

/// A scalar result.
[[nodiscard]] inline Result scalar(std::string key, std::string unit, double value, double error) {
  return {std::move(key), std::move(unit), "", {}, {value}, {error}};
}
/// A scalar of the table of results, with its unit.
[[nodiscard]] inline Result scalar(const Name& name, double value, double error) {
  return {name.key, options::unit_of(name.key), "", {}, {value}, {error}, name.kind};
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
/// An array of the table of results, with its unit and the name of its abscissa.
[[nodiscard]] inline Result array(const std::string& key, std::vector<double> abscissa,
                                  Kind kind = Kind::other) {
  return array(key, options::unit_of(key), options::abscissa_of(key), std::move(abscissa), kind);
}

/// Largest error relative to the size of the values; infinite where one is not a number, unless the
/// result is partial.
[[nodiscard]] double relative_error(const Result& result);

}  // namespace stickslip::quantities
