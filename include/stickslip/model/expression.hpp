#pragma once
/// Formulas in named variables, as users write them.

#include <initializer_list>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace stickslip::model {

/// A formula such as "x*v" or "y == 0 ? x^2 : 0", read by muParser. Evaluation writes the variables
/// into the object, so that threads need one each; a copy shares nothing.
class Expression {
 public:
  using Constants = std::vector<std::pair<std::string, double>>;

  /// Throws std::invalid_argument with the parser's message and the place of the error, and for an
  /// assignment or more than one expression.
  Expression(std::string text, std::vector<std::string> variables, Constants constants);
  Expression(const Expression& other);
  Expression& operator=(const Expression&) = delete;
  ~Expression();

  [[nodiscard]] const std::string& text() const { return text_; }
  /// Its value, which need not be finite, at values in the order of the variables.
  [[nodiscard]] double operator()(std::initializer_list<double> values) const;

 private:
  struct Reader;
  std::string text_;
  std::vector<std::string> variables_;
  Constants constants_;
  std::unique_ptr<Reader> reader_;
};

}  // namespace stickslip::model
