#include "stickslip/model/expression.hpp"

#include <muParser.h>

#include <algorithm>
#include <stdexcept>
#include <string_view>

namespace stickslip::model {
namespace {

// A sign = that is no part of a comparison. muParser assigns, and would overwrite the variables.
bool assigns(std::string_view text) {
  for (std::size_t n = 0; n < text.size(); ++n) {
    if (text[n] != '=') continue;
    if (n > 0 && std::string_view("<>!").find(text[n - 1]) != std::string_view::npos) continue;
    if (n + 1 == text.size() || text[n + 1] != '=') return true;
    ++n;
  }
  return false;
}

}  // namespace

// The variables live beside the parser, which keeps their addresses. muParser: small, maintained,
// packaged, compiles to bytecode.
struct Expression::Reader {
  Reader(const std::string& text, const std::vector<std::string>& variables,
         const Constants& constants)
      : values(variables.size(), 0.0) {
    for (std::size_t n = 0; n < variables.size(); ++n) parser.DefineVar(variables[n], &values[n]);
    for (const auto& [name, value] : constants) parser.DefineConst(name, value);
    parser.SetExpr(text);
  }

  /// Number of values, of which muParser gives the last: two for "v, x". Reads the text.
  [[nodiscard]] int count() {
    int found = 0;
    (void)parser.Eval(found);
    return found;
  }

  std::vector<double> values;
  mu::Parser parser;
};

Expression::Expression(std::string text, std::vector<std::string> variables, Constants constants)
    : text_(std::move(text)), variables_(std::move(variables)), constants_(std::move(constants)) {
  if (assigns(text_)) {
    throw std::invalid_argument(text_ + " assigns a value; == is the comparison");
  }
  try {
    reader_ = std::make_unique<Reader>(text_, variables_, constants_);
    if (reader_->count() == 1) return;
  } catch (const mu::ParserError& error) {
    std::string message = error.GetMsg();
    if (message.ends_with('.')) message.pop_back();
    throw std::invalid_argument(message);
  }
  throw std::invalid_argument(text_ + " is more than one expression");
}

Expression::Expression(const Expression& other)
    : Expression(other.text_, other.variables_, other.constants_) {}

Expression::~Expression() = default;

double Expression::operator()(std::initializer_list<double> values) const {
  std::copy(values.begin(), values.end(), reader_->values.begin());
  return reader_->parser.Eval();
}

}  // namespace stickslip::model
