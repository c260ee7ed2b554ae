/// Whether an expression is odd, from its tree alone: f(v) and f(-v) are written in one form, in
/// which signs stand outside as far as odd and even functions let them, and what may be exchanged
/// is sorted.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "stickslip/model/expression.hpp"

namespace stickslip::model {
namespace {

using Nodes = std::vector<Expression::Node>;

struct Form {
  bool minus;
  std::string text;
  [[nodiscard]] std::string with_sign() const { return (minus ? "-" : "+") + text; }
  [[nodiscard]] Form negated() const { return {text != "0" && !minus, text}; }
};

using Forms = std::vector<Form>;

std::string joined(const std::string& name, const Forms& forms) {
  std::vector<std::string> parts;
  for (const Form& form : forms) parts.push_back(form.with_sign());
  std::sort(parts.begin(), parts.end());
  std::string text = name + "(";
  for (const auto& part : parts) text += part + ",";
  return text + ")";
}

// Of a form and its negative, which has another name or the same, the first in the alphabet. What
// is its own negative is 0.
Form first_of(const std::string& plus, const std::string& minus) {
  if (plus == minus) return {false, "0"};
  return {minus < plus, std::min(plus, minus)};
}

Form symmetric(const std::string& name, const std::string& negative, const Forms& forms) {
  Forms negated;
  for (const Form& form : forms) negated.push_back(form.negated());
  return first_of(joined(name, forms), joined(negative, negated));
}

class Writer {
 public:
  Writer(const Nodes& nodes, bool mirrored) : nodes_(nodes), mirrored_(mirrored) {}

  [[nodiscard]] Form write(std::size_t at) const {
    const auto& [operation, a, b, c, value] = nodes_[at];
    switch (operation) {
    case Operation::constant:
      return {std::signbit(value) && value != 0, fmt::format("{}", std::abs(value))};
    case Operation::variable: return {a == 0 && mirrored_, fmt::format("v{}", a)};
    case Operation::add:
    case Operation::subtract:
    case Operation::negate: return sum(at);
    case Operation::multiply:
    case Operation::divide: return product(at);
    case Operation::pow: return power(a, b);
    case Operation::minimum: return least(at);
    case Operation::less:
    case Operation::at_most: return {false, difference(a, b).with_sign() + "<0"};
    case Operation::equal: return {false, difference(a, b).text + "=0"};
    case Operation::both: return {false, joined("both", {write(a), write(b)})};
    case Operation::choose: return choice(a, b, c);
    default: return function(operation, a, b);
    }
  }

 private:
  [[nodiscard]] double constant(std::size_t at) const { return nodes_[at].value; }
  [[nodiscard]] bool is(std::size_t at, Operation operation) const {
    return nodes_[at].operation == operation;
  }

  void add_terms(std::size_t at, bool minus, Forms& terms) const {
    const auto& node = nodes_[at];
    if (is(at, Operation::negate)) return add_terms(node.a, !minus, terms);
    if (is(at, Operation::add) || is(at, Operation::subtract)) {
      add_terms(node.a, minus, terms);
      return add_terms(node.b, minus != is(at, Operation::subtract), terms);
    }
    const Form term = write(at);
    if (term.text != "0") terms.push_back(minus ? term.negated() : term);
  }

  [[nodiscard]] static Form sum(const Forms& terms) {
    return terms.size() == 1 ? terms[0] : symmetric("sum", "sum", terms);
  }
  [[nodiscard]] Form sum(std::size_t at) const {
    Forms terms;
    add_terms(at, false, terms);
    return sum(terms);
  }
  [[nodiscard]] Form difference(std::size_t a, std::size_t b) const {
    Forms terms;
    add_terms(a, false, terms);
    add_terms(b, true, terms);
    return sum(terms);
  }

  void add_factors(std::size_t at, bool below, Forms& factors, bool& minus) const {
    const auto& node = nodes_[at];
    if (is(at, Operation::multiply) || is(at, Operation::divide)) {
      add_factors(node.a, below, factors, minus);
      return add_factors(node.b, below != is(at, Operation::divide), factors, minus);
    }
    const Form factor = write(at);
    minus = minus != factor.minus;
    factors.push_back({false, (below ? "/" : "*") + factor.text});
  }

  [[nodiscard]] Form product(std::size_t at) const {
    Forms factors;
    bool minus = false;
    add_factors(at, false, factors, minus);
    const bool zero = std::any_of(factors.begin(), factors.end(),
                                  [](const Form& factor) { return factor.text == "*0"; });
    return zero ? Form{false, "0"} : Form{minus, joined("product", factors)};
  }

  [[nodiscard]] Form power(std::size_t a, std::size_t b) const {
    const Form base = write(a), exponent = write(b);
    const double p = constant(b);
    const bool whole = is(b, Operation::constant) && p == std::round(p);
    const std::string of = whole ? base.text : base.with_sign();
    const bool minus = whole && std::fmod(p, 2) != 0 && base.minus;
    return {minus, "(" + of + ")^" + exponent.with_sign()};
  }

  // The larger one of two is written as -min(-a, -b), and min(b, max(a, u)) for numbers a <= b as
  // the middle one of the three.
  [[nodiscard]] Form least(std::size_t at) const {
    const auto& node = nodes_[at];
    for (const auto& [end, clipped] : {std::pair{node.a, node.b}, std::pair{node.b, node.a}}) {
      if (const auto middle = of_three(end, clipped)) return *middle;
    }
    return symmetric("min", "max", {write(node.a), write(node.b)});
  }

  [[nodiscard]] std::optional<Form> of_three(std::size_t end, std::size_t clipped) const {
    if (!is(end, Operation::constant) || !is(clipped, Operation::negate)) return std::nullopt;
    const std::size_t inner = nodes_[clipped].a;
    if (!is(inner, Operation::minimum)) return std::nullopt;
    const auto& [operation, a, b, c, value] = nodes_[inner];
    const std::size_t number = is(a, Operation::constant) ? a : b, rest = number == a ? b : a;
    if (!is(number, Operation::constant) || !(-constant(number) <= constant(end)))
      return std::nullopt;
    return symmetric("middle", "middle",
                     {write(end), write(number).negated(), write(rest).negated()});
  }

  // At the boundary both branches of what is continuous are one.
  [[nodiscard]] Form choice(std::size_t condition, std::size_t a, std::size_t b) const {
    Form yes = write(a), no = write(b);
    std::string text = write(condition).text;
    if (is(condition, Operation::less) || is(condition, Operation::at_most)) {
      const auto& node = nodes_[condition];
      const Form gap = difference(node.a, node.b);
      text = gap.text;
      if (gap.minus) std::swap(yes, no);
    }
    const auto with = [&text](const Form& first, const Form& second) {
      return "if(" + text + "," + first.with_sign() + "," + second.with_sign() + ")";
    };
    return first_of(with(yes, no), with(yes.negated(), no.negated()));
  }

  [[nodiscard]] Form function(Operation operation, std::size_t a, std::size_t b) const {
    const Form inner = write(a);
    const auto name = fmt::format("f{}", static_cast<int>(operation));
    switch (operation) {
    case Operation::sin:
    case Operation::tan:
    case Operation::asin:
    case Operation::atan:
    case Operation::sinh:
    case Operation::tanh:
    case Operation::asinh:
    case Operation::atanh:
    case Operation::sign:
    case Operation::rint:
      return inner.text == "0" ? inner : Form{inner.minus, name + "(" + inner.text + ")"};
    case Operation::cos:
    case Operation::cosh:
    case Operation::abs: return {false, name + "(" + inner.text + ")"};
    case Operation::atan2:
      return {inner.minus, name + "(" + inner.text + "," + write(b).with_sign() + ")"};
    default: return {false, name + "(" + inner.with_sign() + ")"};
    }
  }

  const Nodes& nodes_;
  bool mirrored_;
};

}  // namespace

bool Expression::odd() const {
  const std::size_t root = nodes_.size() - 1;
  const Form plain = Writer(nodes_, false).write(root), mirrored = Writer(nodes_, true).write(root);
  return plain.text == mirrored.text && (plain.text == "0" || plain.minus != mirrored.minus);
}

}  // namespace stickslip::model
