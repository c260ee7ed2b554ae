#pragma once
/// Formulas in named variables, as users write them.

#include <array>
#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace stickslip::model {

// What a formula and its derivatives can be on an interval.

/// All numbers from low to high, which are widened by the rounding of each operation.
struct Interval {
  double low = 0, high = 0;

  [[nodiscard]] bool is_point() const { return low == high; }
  [[nodiscard]] bool is_zero() const { return low == 0 && high == 0; }
  [[nodiscard]] bool holds_zero() const { return low <= 0 && high >= 0; }
  /// Largest |x|.
  [[nodiscard]] double size() const { return low + high > 0 ? high : -low; }
};

constexpr std::size_t kJetOrder = 8;

/// Bounds on f^(k)/k!, k = 0 ... 8, inside an interval of the variable (Taylor coefficients; Moore,
/// Methods and Applications of Interval Analysis, 1979). Where f may have a jump, a kink or a pole
/// inside, `rough` is set.
struct Jet {
  std::array<Interval, kJetOrder + 1> at{};
  bool rough = false;

  Jet() = default;
  explicit Jet(double value) { at[0] = {value, value}; }
  /// The variable itself, times `slope`.
  Jet(Interval value, double slope) : at{value, Interval{slope, slope}} {}

  [[nodiscard]] bool is_zero() const;      ///< f = 0
  [[nodiscard]] bool is_constant() const;  ///< f is one number
};

[[nodiscard]] Jet operator+(const Jet& f, const Jet& g);
[[nodiscard]] Jet operator-(const Jet& f, const Jet& g);
[[nodiscard]] Jet operator-(const Jet& f);
[[nodiscard]] Jet operator*(const Jet& f, const Jet& g);
[[nodiscard]] Jet operator/(const Jet& f, const Jet& g);
[[nodiscard]] Jet pow(const Jet& f, const Jet& g);
[[nodiscard]] Jet exp(const Jet& f);
[[nodiscard]] Jet log(const Jet& f);
[[nodiscard]] Jet sqrt(const Jet& f);
[[nodiscard]] Jet sin(const Jet& f);
[[nodiscard]] Jet cos(const Jet& f);
[[nodiscard]] Jet tan(const Jet& f);
[[nodiscard]] Jet asin(const Jet& f);
[[nodiscard]] Jet acos(const Jet& f);
[[nodiscard]] Jet atan(const Jet& f);
[[nodiscard]] Jet atan2(const Jet& f, const Jet& g);
[[nodiscard]] Jet sinh(const Jet& f);
[[nodiscard]] Jet cosh(const Jet& f);
[[nodiscard]] Jet tanh(const Jet& f);
[[nodiscard]] Jet asinh(const Jet& f);
[[nodiscard]] Jet acosh(const Jet& f);
[[nodiscard]] Jet atanh(const Jet& f);
[[nodiscard]] Jet abs(const Jet& f);
[[nodiscard]] Jet sign(const Jet& f);
[[nodiscard]] Jet rint(const Jet& f);
[[nodiscard]] Jet minimum(const Jet& f, const Jet& g);
/// 1 where f < g, 0 elsewhere; values at ends of the interval do not count.
[[nodiscard]] Jet less(const Jet& f, const Jet& g);
[[nodiscard]] Jet equal(const Jet& f, const Jet& g);
/// Whether both are not 0.
[[nodiscard]] Jet both(const Jet& f, const Jet& g);
/// f where `condition` is not 0, g elsewhere.
[[nodiscard]] Jet choose(const Jet& condition, const Jet& f, const Jet& g);

enum class Operation : int {
  constant,
  variable,
  add,
  subtract,
  multiply,
  divide,
  pow,
  minimum,
  less,
  at_most,
  equal,
  both,
  choose,
  negate,
  sin,
  cos,
  tan,
  asin,
  acos,
  atan,
  atan2,
  sinh,
  cosh,
  tanh,
  asinh,
  acosh,
  atanh,
  exp,
  log,
  sqrt,
  abs,
  sign,
  rint
};

/// A formula such as "x*v" or "y == 0 ? x^2 : 0", read by muParser into the tree of its operations.
class Expression {
 public:
  using Constants = std::vector<std::pair<std::string, double>>;

  /// An operation on nodes that stand before it.
  struct Node {
    Operation operation;
    std::size_t a = 0, b = 0, c = 0;  ///< its operands; of a variable, its place
    double value = 0;                 ///< of a constant
  };

  /// Throws std::invalid_argument with the parser's message and the place of the error, and for an
  /// assignment or more than one expression.
  Expression(std::string text, const std::vector<std::string>& variables,
             const Constants& constants);

  [[nodiscard]] const std::string& text() const { return text_; }
  /// Its value, which need not be finite, at values in the order of the variables.
  [[nodiscard]] double operator()(const std::vector<double>& values) const;
  /// Bounds on its values and derivatives where its variables lie in intervals.
  [[nodiscard]] Jet jet(const std::vector<Jet>& values) const;
  /// Whether the tree shows that f(-v) = -f(v), v the first variable, but for single v.
  [[nodiscard]] bool odd() const;
  /// Sizes of its constants.
  [[nodiscard]] std::vector<double> numbers() const;

 private:
  std::string text_;
  std::vector<Node> nodes_;
};

// Where a formula is not smooth in the speed, and how finely it changes.

using FunctionOfSpeed = std::function<double(double)>;

/// A jump, a kink or another speed v > 0 at which a formula is not smooth.
struct Break {
  enum class Kind { kink, jump, steep, pole };
  double v;   ///< to rounding
  Kind kind;  ///< steep: its slope has no bound, as that of a root; pole: its values have none
  [[nodiscard]] bool same_as(const Break& other) const;
};

/// Largest |f - p| at 8 places of [a, b], its ends among them, and at those of `places` within, p
/// interpolating f at the 8 Chebyshev nodes between. Not a number where f is none.
[[nodiscard]] double interpolation_error(const FunctionOfSpeed& f, double a, double b,
                                         const std::vector<double>& places = {});

/// What a formula is like as a function of one of its variables.
struct Shape {
  std::vector<Break> breaks;  ///< rising
  /// Speeds, rising, between any two of which f is a polynomial of degree 7 to 1e-10 of its size:
  /// no feature, however narrow, lies between them.
  std::vector<double> places;
  bool resolved = true;  ///< otherwise f has more features than places were allowed
};

/// The shape of |v| -> f at 0 < |v| <= reach, `v` being the place of the velocity among the
/// variables, with that sign, and the others having the values given. By bisection, guided by
/// bounds on f and its derivatives on whole intervals.
[[nodiscard]] Shape shape_of(const Expression& f, const std::vector<double>& values, std::size_t v,
                             double sign, double reach);

/// `found` with those of `more` that are new, rising.
void merge(std::vector<Break>& found, const std::vector<Break>& more);
void merge(std::vector<double>& places, const std::vector<double>& more);

}  // namespace stickslip::model
