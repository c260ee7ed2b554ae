#pragma once
/// The solution methods. Each is a row with all that is said of it: help, reference pages,
/// validation, refinement and plans follow from these rows. The functions that compute are listed
/// in routes/evaluation.cpp.

#include <initializer_list>
#include <span>
#include <string_view>

namespace stickslip::catalogue {

/// By which system of equations.
enum class Route { excursion, lambda, hitting, null_vector, fluid_queue, monte_carlo };

/// A set of routes.
class Routes {
 public:
  constexpr Routes() = default;
  constexpr Routes(std::initializer_list<Route> routes) {
    for (Route route : routes) bits_ |= 1U << static_cast<unsigned>(route);
  }
  [[nodiscard]] constexpr bool contains(Route route) const {
    return (bits_ >> static_cast<unsigned>(route) & 1U) != 0;
  }

 private:
  unsigned bits_ = 0;
};

/// What is known of a route. Which quantities it gives stands in their own rows.
struct SolutionMethod {
  Route route;
  std::string_view word;           ///< of -route
  std::string_view synonyms = {};  ///< words that mean it elsewhere, a comma list
  std::string_view sentence;       ///< what it does, for the help of -route
  std::string_view limit = {};     ///< why it gives no other quantities; empty where it gives all
  /// Why it needs a model without drag and with Coulomb friction; empty where it does not.
  std::string_view without_drag = {};
  /// Whether it works on elements or differences in v, which -scheme and its options choose.
  bool discretises_velocity = true;
  /// Whether results are means over random samples with confidence intervals: nothing is refined,
  /// and no system is planned.
  bool simulates = false;
  /// Whether its systems hold both signs of v, symmetry or not, and each noise level is a node.
  bool full_grid = false;
  /// Whether it follows excursions to the sticking phases at their ends, which need not exist.
  bool needs_sticking = true;
  /// Whether -v_max and -speed_limit apply.
  bool bounds_speed = false;
  /// Whether results are limits for lambda -> 0: -lambda is one positive value, which biases them.
  bool small_lambda = false;
  /// Whether it takes the closed form of the distribution of the noise; methods that check the
  /// model compute it.
  bool closed_noise_law = false;
};

/// All of them, the default first, in the order of the help text.
[[nodiscard]] std::span<const SolutionMethod> solution_methods();

[[nodiscard]] const SolutionMethod& method_of(Route route);

/// The solution method of a word; the default where there is none of that name.
[[nodiscard]] const SolutionMethod& method_of(std::string_view word);

}  // namespace stickslip::catalogue
