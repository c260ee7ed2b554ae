#pragma once
/// Elements in v, graded towards v = 0.

#include <vector>

#include "stickslip/model/expression.hpp"
#include "stickslip/model/process.hpp"

namespace stickslip::generator {

/// How far the equations (z - L) u = f to be solved go.
struct Rates {
  double lambda = 0;     ///< largest real z [1/time]
  double omega = 0;      ///< largest |Im z| [1/time]
  double speed = 0;      ///< largest |v| of which first passages are asked for
  double tilt = 0;       ///< largest |s| of equations for exp(s x(t)) [1/(velocity time)]
  bool lengths = false;  ///< whether functions of path lengths are asked for
};

/// Functions of |v| that are seen on the nodes of the elements, as the drag is.
struct Integrands {
  std::vector<double> breaks;                     ///< where elements end [velocity]
  std::vector<model::FunctionOfSpeed> functions;  ///< that elements resolve between the breaks
  std::vector<double> places = {};  ///< speeds that show all of them, see model::Shape
};

/// What fixes the elements. See velocity_mesh.cpp for the reasons behind the numbers.
struct MeshRule {
  double v_max = 1;          ///< end of the velocity discretisation
  double decay = 8;          ///< largest drop of log-density over one element
  int layers = 0;            ///< elements of the graded part; 0: from smallest_scale
  int least_degree = 2;      ///< of an element where those elsewhere have at least this one
  double tolerance = 1e-12;  ///< relative error that the smallest elements may leave
  bool whole_tail = false;   ///< degrees do not fall with the density
  Rates rates;
  Integrands integrands;

  /// Quotient of neighbouring element ends near v = 0.
  [[nodiscard]] double ratio() const { return rates.lengths ? 0.5 : 0.3; }
  /// Graded elements of one degree, the next ones towards v = 0 having one less.
  [[nodiscard]] int elements_per_degree() const { return rates.lengths ? 3 : 2; }
};

/// Whether the noise leaves waves of the frequency omega [1/time] that graded elements do not
/// follow. Levels of -delta jump equally fast; those of a table may be left so rarely that waves
/// live long on them. O(levels).
[[nodiscard]] bool has_waves(const model::Process& process, double omega);
/// Whether waves of the frequency omega [1/time] are too fast for elements to follow them, and
/// count all the same, as few levels do not damp them. O(1).
[[nodiscard]] bool has_unfollowed_waves(const model::Process& process, double omega);

/// Thickness of the finest layer at v = 0 that a solution of (lambda - L) u = f shows, or one for
/// any smaller lambda [velocity].
[[nodiscard]] double smallest_scale(const model::Process& process, double lambda = 0);

/// Number of graded elements that resolve smallest_scale under `rule`.
[[nodiscard]] int natural_layers(const model::Process& process, const MeshRule& rule);

/// Element ends 0 = e_0 < e_1 < ... < e_E = v_max, the breaks of the drag and of the integrands
/// among them, and where a level leaves its speed to both sides, unless jumps of the noise are much
/// faster. Elements on which a drag law or an integrand is steep are halved, up to 100 times.
[[nodiscard]] std::vector<double> element_ends(const model::Process& process, const MeshRule& rule);

/// Polynomial degree of each of these elements, at most `degree`: what happens at v concerns levels
/// within about v^(1/3) of mu_d alone, so that elements nearer to v = 0 need fewer digits; but not
/// more than two where bodies that have just left v = 0 might turn back. In the tail, unless it is
/// whole, digits count by the density. Where waves are followed all degrees are equal.
[[nodiscard]] std::vector<int> element_degrees(const model::Process& process, const MeshRule& rule,
                                               int degree);
/// The same of element ends that are known: observables and drag laws cost more than all else.
[[nodiscard]] std::vector<int> element_degrees(const model::Process& process, const MeshRule& rule,
                                               const std::vector<double>& ends, int degree);

// How far the velocity discretisation must reach.

/// Velocity beyond which the stationary density is below `tolerance`, from its white-noise bound
/// exp(-(mu_d - |bias|) v + int_0^v b): coloured noise and discrete levels only shorten the tail.
/// Without drag the bias must be smaller than mu_d. With a tilt s >= 0 of either sign of v, the
/// same of the density weighted with exp(s x(t)), which falls at the rate
///
///   ((F/D)^2 - 4 s v/D)^1/2,   F = mu_d - |bias| - b(v), D the intensity,
///
/// where that is real; infinity where it never is.
[[nodiscard]] double tail_velocity(const model::Process& process, double tolerance,
                                   double tilt = 0);

/// |v| beyond which nothing counts in double precision, by the density, the largest force that
/// occurs and a truncation velocity given by hand.
[[nodiscard]] double largest_speed(const model::Scene& scene);

}  // namespace stickslip::generator
