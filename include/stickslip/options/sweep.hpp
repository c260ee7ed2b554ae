#pragma once
/// -sweep_<option>: a run for each combination of values of some options of the model.

#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "stickslip/options/request.hpp"
#include "stickslip/options/settings.hpp"

namespace stickslip::options {

/// An option of the model with the values it takes.
struct SweepAxis {
  std::string option;  ///< without the dash
  std::string unit;    ///< empty for pure numbers
  std::vector<double> values;
};

/// The product of the axes, in the order of the table of options; the last one changes fastest.
class Sweep {
 public:
  /// `settings` holds every other option.
  Sweep(Settings settings, std::vector<SweepAxis> axes);

  [[nodiscard]] const std::vector<SweepAxis>& axes() const { return axes_; }
  /// Number of points.
  [[nodiscard]] std::size_t size() const;
  /// Values of the axes at a point, 0 <= point < size().
  [[nodiscard]] std::vector<double> values(std::size_t point) const;
  /// "mu_d = 0.5, tau = 1".
  [[nodiscard]] std::string place(std::size_t point) const;

  /// The settings of a single run with the values of the point.
  [[nodiscard]] Settings settings(std::size_t point) const;
  /// What such a run would be asked, of a point that is not left out; it writes no files. Local.
  [[nodiscard]] Request request(std::size_t point) const;

  /// Points at which the model cannot be computed, such as mu_d above mu_s, with the reason.
  [[nodiscard]] const std::map<std::size_t, std::string>& left_out() const { return left_out_; }
  void leave_out(std::size_t point, std::string reason) { left_out_[point] = std::move(reason); }

  /// Name and value of every option that may change a number, those of the solvers included.
  [[nodiscard]] const std::vector<std::pair<std::string, std::string>>& identity() const {
    return identity_;
  }

 private:
  Settings settings_;
  std::vector<SweepAxis> axes_;
  std::vector<std::pair<std::string, std::string>> identity_;
  std::map<std::size_t, std::string> left_out_;
};

}  // namespace stickslip::options
