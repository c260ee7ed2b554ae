#pragma once
/// Where a function of the speed is not smooth.

#include <functional>
#include <string>
#include <vector>

namespace stickslip::model {

using FunctionOfSpeed = std::function<double(double)>;

/// A jump, a kink or another speed v > 0 at which a function is not smooth.
struct Break {
  double v;
  double width;    ///< of the interval that it was found in, at least the spacing of doubles
  bool unbounded;  ///< whether the function is
  /// About 0 for a jump, the power for a root, 1 for a kink.
  double order = 1;
  [[nodiscard]] bool same_as(const Break& other) const;
};

/// Largest |f - p| at 8 places of [a, b], its ends among them, p interpolating f at the 8 Chebyshev
/// nodes between. Not a number where f is none. 16 values of f.
[[nodiscard]] double interpolation_error(const FunctionOfSpeed& f, double a, double b);

/// Breaks of f on (0, reach], rising: those that 400 intervals show, and intervals around each
/// number and around the products, quotients, sums and differences of two. A break that equals one
/// of these is set to it. Others have the precision at which f stops to show them: that of v for a
/// jump. Functions that doubles resolve have none, however steep. Kinks below about 1e-5 of the
/// size of f are not seen, nor narrow windows whose ends are no such numbers.
[[nodiscard]] std::vector<Break> breaks(const FunctionOfSpeed& f,
                                        const std::vector<double>& numbers, double reach);

/// `found` with those of `more` that are new, rising; of two at one place the sharper one stays.
void merge(std::vector<Break>& found, const std::vector<Break>& more);

/// The numbers in a formula, digits of names such as log10 left out.
[[nodiscard]] std::vector<double> numbers_in(const std::string& formula);

}  // namespace stickslip::model
