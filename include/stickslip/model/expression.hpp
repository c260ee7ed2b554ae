#pragma once
/// Formulas in named variables, as users write them.

#include <cstddef>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include "stickslip/model/jet.hpp"

namespace stickslip::model {

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

}  // namespace stickslip::model
