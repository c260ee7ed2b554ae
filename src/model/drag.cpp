#include "stickslip/model/drag.hpp"

#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <cstdint>
#include <limits>

namespace stickslip::model {

double Drag::terminal_velocity(double force) const {
  if (force <= 0) return 0;
  if (!bounds_velocity()) return std::numeric_limits<double>::infinity();
  const auto net = [&](double v) { return force + (*this)(v); };
  double v = std::numeric_limits<double>::infinity();
  if (linear > 0) v = std::fmin(v, force / linear);
  if (cubic > 0) v = std::fmin(v, std::cbrt(force / cubic));
  if (linear > 0 && cubic > 0) {
    while (net(v) > 0) v = std::nextafter(v, std::numeric_limits<double>::infinity());
    std::uintmax_t iterations = 200;
    v = boost::math::tools::toms748_solve(net, 0.0, v,
                                          boost::math::tools::eps_tolerance<double>(52), iterations)
            .second;
  }
  while (net(v) > 0) v = std::nextafter(v, std::numeric_limits<double>::infinity());
  return v;
}

}  // namespace stickslip::model
