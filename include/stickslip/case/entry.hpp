#pragma once
/// The quantities that can be asked for, and every key that a summary can hold: what it means, in
/// which unit, and how its error is judged. Each quantity has a file beside this one with all that
/// is said of it; help, reference pages, validation and files follow from these.

#include <cstdint>
#include <initializer_list>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace stickslip::cases {

// The solution methods. Each is a row with all that is said of it: help, reference pages,
// validation, refinement and plans follow from these rows. The functions that compute are listed
// in run/routes.cpp.

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

/// What can be asked for by -quantities.
enum class Quantity : std::uint64_t {
  sticking,
  moments,
  averages,
  noise_law,
  entry_law,
  density,
  laplace,
  stick_duration_transform,
  resolvent,
  relaxation,
  spectrum,
  duration_density,
  slip,
  peak,
  autocorrelation,
  displacement,
  expectation,
  trajectory,
  sensitivity
};

/// One that no other file than its own and lists name; it needs no name above. By FNV-1a.
[[nodiscard]] constexpr Quantity own_quantity(std::string_view word) {
  std::uint64_t hash = 14695981039346656037U;
  for (char c : word) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211U;
  return Quantity{hash};
}

/// What a result is, whatever it is called: its range and direction (run/estimates.hpp),
/// and with which others it shares errors (run/estimates.hpp), follow from it.
enum class Kind {
  other,          ///< nothing more is known
  probability,    ///< in [0, 1]
  share,          ///< of the time: one of two probabilities whose sum is 1
  mean,           ///< of what has either sign
  drift,          ///< a mean that may vanish
  positive_mean,  ///< of a duration or a square
  transform,      ///< E[exp(-lambda T)]: in [0, 1], falls with lambda
  distribution,   ///< P(T <= t): in [0, 1], rises with t
  spectrum,       ///< a power spectral density, >= 0
  derivative      ///< of a mean or a share by a parameter
};

/// A result of a quantity. A key may stand for many: f is an observable, as in pi(f), A a scalar
/// and p a parameter, as in dA_dp; t is a time, w a speed.
struct Row {
  std::string_view key;
  std::string_view symbol;           ///< in the formulas of the model, in ASCII
  std::string_view definition;       ///< one line
  std::string_view unit = {};        ///< empty for pure numbers; [f] is the unit of the observable
  std::string_view abscissa = {};    ///< of an array; empty for a scalar
  std::string_view convention = {};  ///< normalisation, sign, start
  std::string_view paper = {};       ///< equations or sections of the paper; empty if beyond it
  Kind kind = Kind::other;
  /// Whether it is a mean of the observable: a probability where that is between 0 and 1.
  bool is_mean_of_f = false;
  /// Whether the accuracy of an array is meant relative to each value, not to the largest one.
  bool each_by_its_size = false;
  /// Whether simulations give averages over cells, not values at points.
  bool by_cells = false;
  Routes without = {};  ///< solution methods that give the quantity but not this result
  /// Whether it stands for its quantity in a file to compare with, where -quantities is not given.
  bool asks = false;

  /// Whether the key stands for the results of many observables or parameters.
  [[nodiscard]] constexpr bool is_pattern() const {
    return unit.find('[') != unit.npos || key.find('(') != key.npos;
  }
  /// The key of the observable or the time `f`, such as pi(v^2|stick).
  [[nodiscard]] std::string key_of(std::string_view f) const;
};

/// Values for which quantities are wanted: an option that is a list of numbers.
struct Argument {
  std::string_view option;         ///< name, the abscissa of the rows
  std::string_view unit = {};      ///< of the numbers
  std::string_view sentence;       ///< for the help, where "of" the quantities follows
  std::string_view besides = {};   ///< a sentence after it
  std::string_view example;        ///< numbers that make sense
  std::string_view synonyms = {};  ///< names that mean it elsewhere, a comma list
  /// Range of the numbers, without its ends.
  double low = -std::numeric_limits<double>::infinity(),
         high = std::numeric_limits<double>::infinity();
  bool low_included = false;  ///< whether the lower end is in the range
  bool optional = false;      ///< whether quantities give something without it

  /// Whether a number is in the range.
  [[nodiscard]] constexpr bool allows(double value) const {
    return (low < value || (low_included && low == value)) && value < high;
  }
};

/// A quantity that can be asked for.
struct Entry {
  Quantity quantity;
  std::string_view word;                            ///< of -quantities
  std::string_view synonyms = {};                   ///< words that mean it elsewhere, a comma list
  std::string_view title;                           ///< what it is, in half a line
  Routes routes;                                    ///< that give it, for every scene
  std::string_view options = {};                    ///< that it depends on besides, a comma list
  std::span<const Argument* const> arguments = {};  ///< that it has of its own
  std::string_view others = {};  ///< keys of other quantities that come with it, a comma list
  std::span<const Row* const> rows = {};
  /// The degree of elements at which error estimates meet an accuracy of 10^-n is expected to be
  /// n + degrees_besides.
  double degrees_besides = 1;
  /// Where -accuracy is not given; 0: that of the option. A digit of some costs an octave more.
  double usual_accuracy = 0;
  bool of_phases = false;  ///< about sticking and sliding phases: nothing where a body never sticks
  bool of_levels = false;  ///< by levels of the noise, or known for these alone
  bool of_travel = false;  ///< of a displacement that grows with time
  bool by_excursion = false;  ///< simulated excursion by excursion, whatever comes before and after
  bool without_system = false;  ///< from the model parameters, or from what others give, alone
  bool of_one_run = false;      ///< a field or a path, which has no place in a sweep
  bool without_limit = false;   ///< not a number that white noise has, which -study tau follows
  /// What is wrong with it where drag does not bound the velocity, and what to take; empty where
  /// nothing is.
  std::string_view unbounded = {}, instead = {};
  bool weighs_tail = false;    ///< and may weigh large speeds anyhow
  bool both_branches = false;  ///< its systems hold both signs of v, symmetry or not

  /// All options that it depends on (names without dashes).
  [[nodiscard]] std::vector<std::string> all_options() const;
  /// Whether it depends on an option.
  [[nodiscard]] bool takes(std::string_view option) const;
};

/// All quantities, in the order of the help text.
[[nodiscard]] std::span<const Entry* const> entries();

/// The lists of numbers that quantities take, each once: shared ones first.
[[nodiscard]] std::span<const Argument* const> arguments();

/// The words of the quantities that depend on an option: "peak and first_passage".
[[nodiscard]] std::string takers_of(std::string_view option);

/// The quantity of a word; nullptr if there is none of that name.
[[nodiscard]] const Entry* find_entry(std::string_view word);

/// The quantity that gives a result with that key as written, such as pi(v^2|stick) or
/// dP_stick_dtau; nullptr if none does.
[[nodiscard]] const Entry* entry_of(std::string_view key);

/// The row of a key as written; nullptr if no quantity gives such a result.
[[nodiscard]] const Row* find_row(std::string_view key);

}  // namespace stickslip::cases
