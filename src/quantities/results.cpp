#include "stickslip/quantities/results.hpp"

#include <fmt/format.h>

namespace stickslip::quantities {

double largest_size(const std::vector<double>& values) {
  double size = 0;
  for (double v : values) size = std::fmax(size, std::abs(v));
  return size;
}

double least_positive(const std::vector<double>& values) {
  double least = kInfinity;
  for (double value : values) least = value > 0 ? std::min(least, value) : least;
  return least;
}

Result blank(const Row& row) {
  const bool known = row.unit.find('[') == row.unit.npos;  // that of an observable is not
  return {.key = std::string(row.key),
          .unit = known ? std::string(row.unit) : "",
          .abscissa_name = std::string(row.abscissa),
          .abscissa = {},
          .value = {},
          .error = {},
          .kind = row.kind,
          .each_by_its_size = row.each_by_its_size};
}

Result blank(const Row& row, const model::Observable& f) {
  Result result = blank(row);
  result.key = row.key_of(f.name);
  if (row.is_mean_of_f && f.within_unit()) result.kind = Kind::probability;
  return result;
}

Result scalar(Result blank, double value, double error) {
  blank.value = {value};
  blank.error = {error};
  return blank;
}

Result array(Result blank, std::vector<double> abscissa) {
  blank.abscissa = std::move(abscissa);
  return blank;
}

Result array_at(const Row& row, double at, std::vector<double> abscissa) {
  Result result = array(row, std::move(abscissa));
  result.key = row.key_of(fmt::format("{}", at));
  return result;
}

std::string place(const Result& result, std::size_t n) {
  if (result.is_scalar()) return "";
  return fmt::format(" at {} = {:g}", result.abscissa_name, result.abscissa[n]);
}

bool is_unreached(const Result& result, std::size_t n) {
  return !result.unreached.empty() && std::isnan(result.value[n]);
}

double relative_error(const Result& result) {
  constexpr double vanishing = 1e-6;  // of the scale of a derivative
  const double size = largest_size(result.value);
  double relative = 0;
  for (std::size_t n = 0; n < result.value.size(); ++n) {
    if (is_unreached(result, n)) continue;
    const bool number = !std::isnan(result.value[n]) && !std::isnan(result.error[n]);
    if (!number) return kInfinity;
    if (result.error[n] == 0) continue;
    double own = result.each_by_its_size ? std::abs(result.value[n]) : size;
    const double rare = size_of(result, n);
    const bool vanishes =
        std::abs(result.value[n]) <= result.error[n] && result.error[n] <= vanishing * result.scale;
    if (vanishes) own = result.scale;
    if (result.tails_by_their_size && rare < kTail && rare > kLeastTail) own = rare;
    relative = std::max(relative, result.error[n] / own);
  }
  return relative;
}

bool all_numbers(const Result& result) {
  return std::ranges::none_of(result.value, [](double v) { return std::isnan(v); });
}

std::string where_unknown(const Result& result) {
  for (std::size_t n = 0; n < result.value.size() && !result.is_scalar(); ++n) {
    if (std::isfinite(result.value[n]) && std::isfinite(result.error[n])) continue;
    return place(result, n);
  }
  return "";
}

}  // namespace stickslip::quantities
