#include "stickslip/model/expression.hpp"

#include <fmt/format.h>
#include <muParser.h>
#include <muParserBytecode.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string_view>

namespace stickslip::model {
namespace {

using Operation::divide;

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

double minimum(double a, double b) { return b < a ? b : a; }
double less(double a, double b) { return a < b; }
double equal(double a, double b) { return a == b; }
double both(double a, double b) { return a != 0 && b != 0; }
double choose(double condition, double a, double b) { return condition != 0 ? a : b; }
double sign(double a) { return (a > 0) - (a < 0); }
double rint(double a) { return std::floor(a + 0.5); }
double at_most(double a, double b) { return a <= b; }
Jet at_most(const Jet& a, const Jet& b) { return choose(less(b, a), Jet(0), Jet(1)); }

using Node = Expression::Node;

// The operations that one operand has, for numbers and for what they can be on an interval.
template <class T>
T function(Operation operation, const T& a) {
  using std::abs, std::acos, std::acosh, std::asin, std::asinh, std::atan, std::atanh, std::cos,
      std::cosh, std::exp, std::log, std::sin, std::sinh, std::sqrt, std::tan, std::tanh;
  switch (operation) {
  case Operation::negate: return -a;
  case Operation::sin: return sin(a);
  case Operation::cos: return cos(a);
  case Operation::tan: return tan(a);
  case Operation::asin: return asin(a);
  case Operation::acos: return acos(a);
  case Operation::atan: return atan(a);
  case Operation::sinh: return sinh(a);
  case Operation::cosh: return cosh(a);
  case Operation::tanh: return tanh(a);
  case Operation::asinh: return asinh(a);
  case Operation::acosh: return acosh(a);
  case Operation::atanh: return atanh(a);
  case Operation::exp: return exp(a);
  case Operation::log: return log(a);
  case Operation::sqrt: return sqrt(a);
  case Operation::abs: return abs(a);
  case Operation::sign: return sign(a);
  default: return rint(a);
  }
}

template <class T>
T combined(Operation operation, const T& a, const T& b) {
  using std::atan2, std::pow;
  switch (operation) {
  case Operation::add: return a + b;
  case Operation::subtract: return a - b;
  case Operation::multiply: return a * b;
  case Operation::divide: return a / b;
  case Operation::pow: return pow(a, b);
  case Operation::minimum: return minimum(a, b);
  case Operation::less: return less(a, b);
  case Operation::at_most: return at_most(a, b);
  case Operation::equal: return equal(a, b);
  case Operation::both: return both(a, b);
  default: return atan2(a, b);
  }
}

int operands(Operation operation) {
  if (operation <= Operation::variable) return 0;
  if (operation == Operation::choose) return 3;
  return operation < Operation::choose || operation == Operation::atan2 ? 2 : 1;
}

template <class T>
T value_of(const Node& node, const std::vector<T>& of_nodes, const std::vector<T>& variables) {
  const auto& [operation, a, b, c, value] = node;
  if (operation == Operation::constant) return T(value);
  if (operation == Operation::variable) return variables[a];
  if (operation == Operation::choose) return choose(of_nodes[a], of_nodes[b], of_nodes[c]);
  if (operands(operation) == 1) return function(operation, of_nodes[a]);
  return combined(operation, of_nodes[a], of_nodes[b]);
}

// What depends on no variable that moves is exact.
Jet value_of(const Node& node, const std::vector<Jet>& of_nodes,
             const std::vector<Jet>& variables) {
  const std::array places{node.a, node.b, node.c};
  std::vector<double> numbers;
  for (int n = 0; n < operands(node.operation); ++n) {
    const Jet& operand = of_nodes[places[n]];
    if (!operand.is_constant()) return value_of<Jet>(node, of_nodes, variables);
    numbers.push_back(operand.at[0].low);
  }
  if (numbers.empty()) return value_of<Jet>(node, of_nodes, variables);
  return Jet(value_of<double>({node.operation, 0, 1, 2}, numbers, {}));
}

template <class T>
T evaluated(const std::vector<Node>& nodes, const std::vector<T>& variables) {
  std::vector<T> values;
  values.reserve(nodes.size());
  for (const Node& node : nodes) values.push_back(value_of(node, values, variables));
  return values.back();
}

// Functions of several numbers, which are written with those of two.
enum class Many : int { sum = 100, avg, min, max };
enum class Other : int { plus = 200, cot, coth, log2, log10 };

// muParser calls a function that the reader knows by what it returns.
template <auto which>
double named(double) {
  return static_cast<double>(which);
}
template <auto which>
double named_of_two(double, double) {
  return static_cast<double>(which);
}
template <auto which>
double named_of_many(const double*, int count) {
  if (count == 0) throw mu::ParserError("Too few parameters for a function");
  return static_cast<double>(which);
}

constexpr std::pair<const char*, double (*)(double)> kOfOne[] = {
    {"sin", named<Operation::sin>},     {"cos", named<Operation::cos>},
    {"tan", named<Operation::tan>},     {"cot", named<Other::cot>},
    {"asin", named<Operation::asin>},   {"acos", named<Operation::acos>},
    {"atan", named<Operation::atan>},   {"sinh", named<Operation::sinh>},
    {"cosh", named<Operation::cosh>},   {"tanh", named<Operation::tanh>},
    {"coth", named<Other::coth>},       {"asinh", named<Operation::asinh>},
    {"acosh", named<Operation::acosh>}, {"atanh", named<Operation::atanh>},
    {"exp", named<Operation::exp>},     {"log", named<Operation::log>},
    {"ln", named<Operation::log>},      {"log2", named<Other::log2>},
    {"log10", named<Other::log10>},     {"sqrt", named<Operation::sqrt>},
    {"sign", named<Operation::sign>},   {"rint", named<Operation::rint>},
    {"abs", named<Operation::abs>}};

void define_functions(mu::Parser& parser) {
  parser.ClearFun();  // among them random numbers
  parser.ClearInfixOprt();
  parser.DefineInfixOprt("-", named<Operation::negate>);
  parser.DefineInfixOprt("+", named<Other::plus>);
  for (const auto& [name, function] : kOfOne) parser.DefineFun(name, function);
  parser.DefineFun("atan2", named_of_two<Operation::atan2>);
  parser.DefineFun("sum", named_of_many<Many::sum>);
  parser.DefineFun("avg", named_of_many<Many::avg>);
  parser.DefineFun("min", named_of_many<Many::min>);
  parser.DefineFun("max", named_of_many<Many::max>);
}

/// The tree of muParser's bytecode, which is in reverse Polish notation.
class Reader {
 public:
  Reader(const mu::SToken* code, const std::vector<double>& variables) : variables_(variables) {
    for (; code->Cmd != mu::cmEND; ++code) read(*code);
  }

  std::vector<Node> nodes;

 private:
  std::size_t push(Node node) {
    nodes.push_back(node);
    fold();
    return nodes.size() - 1;
  }
  std::size_t pop() {
    const std::size_t top = stack_.back();
    stack_.pop_back();
    return top;
  }
  std::size_t number(double value) { return push({Operation::constant, 0, 0, 0, value}); }
  std::size_t apply(Operation operation, std::size_t a, std::size_t b = 0, std::size_t c = 0) {
    return push({operation, a, b, c});
  }

  // Operations on constants alone are one.
  void fold() {
    const Node& last = nodes.back();
    const std::array operand{last.a, last.b, last.c};
    const int count = operands(last.operation);
    for (int n = 0; n < count; ++n) {
      if (nodes[operand[n]].operation != Operation::constant) return;
    }
    if (count > 0)
      nodes.back() = {Operation::constant, 0, 0, 0, evaluated<double>(nodes, variables_)};
  }

  void read(const mu::SToken& token) {
    if (token.Cmd == mu::cmIF || token.Cmd == mu::cmELSE) return;
    if (token.Cmd == mu::cmVAL) return stack_.push_back(number(token.Val.data2));
    if (token.Cmd == mu::cmVAR) {
      const auto place = static_cast<std::size_t>(token.Val.ptr - variables_.data());
      return stack_.push_back(apply(Operation::variable, place));
    }
    if (token.Cmd == mu::cmFUNC) return stack_.push_back(called(token));
    const std::size_t b = pop(), a = pop();
    stack_.push_back(token.Cmd == mu::cmENDIF ? apply(Operation::choose, pop(), a, b)
                                              : infix(token.Cmd, a, b));
  }

  std::size_t negation(std::size_t a) { return apply(Operation::equal, a, number(0)); }

  std::size_t infix(mu::ECmdCode code, std::size_t a, std::size_t b) {
    switch (code) {
    case mu::cmADD: return apply(Operation::add, a, b);
    case mu::cmSUB: return apply(Operation::subtract, a, b);
    case mu::cmMUL: return apply(Operation::multiply, a, b);
    case mu::cmDIV: return apply(Operation::divide, a, b);
    case mu::cmPOW: return apply(Operation::pow, a, b);
    case mu::cmLT: return apply(Operation::less, a, b);
    case mu::cmGT: return apply(Operation::less, b, a);
    case mu::cmLE: return apply(Operation::at_most, a, b);
    case mu::cmGE: return apply(Operation::at_most, b, a);
    case mu::cmEQ: return apply(Operation::equal, a, b);
    case mu::cmNEQ: return negation(apply(Operation::equal, a, b));
    case mu::cmLAND: return apply(Operation::both, a, b);
    case mu::cmLOR: return negation(apply(Operation::both, negation(a), negation(b)));
    default: throw std::invalid_argument("an operator that is none of formulas");
    }
  }

  std::size_t called(const mu::SToken& token) {
    const int count = token.Fun.argc;
    if (count < 0) return of_many(-count, token.Fun.cb.call_multfun(nullptr, 1));
    if (count == 2) {
      const std::size_t b = pop(), a = pop();
      return apply(Operation::atan2, a, b);
    }
    const auto which = static_cast<int>(token.Fun.cb.call_fun<1>(0.0));
    const std::size_t a = pop();
    switch (static_cast<Other>(which)) {
    case Other::plus: return a;
    case Other::cot: return apply(divide, number(1), apply(Operation::tan, a));
    case Other::coth: return apply(divide, number(1), apply(Operation::tanh, a));
    case Other::log2: return apply(divide, apply(Operation::log, a), number(std::log(2)));
    case Other::log10: return apply(divide, apply(Operation::log, a), number(std::log(10)));
    }
    return apply(static_cast<Operation>(which), a);
  }

  std::size_t of_many(int count, double which) {
    const auto many = static_cast<Many>(static_cast<int>(which));
    std::size_t all = pop();
    if (many == Many::max) all = apply(Operation::negate, all);
    for (int n = 1; n < count; ++n) {
      const std::size_t next = pop();
      if (many == Many::max) {
        all = apply(Operation::minimum, apply(Operation::negate, next), all);
      } else {
        all = apply(many == Many::min ? Operation::minimum : Operation::add, next, all);
      }
    }
    if (many == Many::max) return apply(Operation::negate, all);
    return many == Many::avg ? apply(divide, all, number(count)) : all;
  }

  const std::vector<double>& variables_;
  std::vector<std::size_t> stack_;
};

std::vector<Node> read(const std::string& text, const std::vector<std::string>& variables,
                       const Expression::Constants& constants) {
  std::vector<double> values(variables.size(), 0.0);
  mu::Parser parser;
  parser.EnableOptimizer(false);
  define_functions(parser);
  for (std::size_t n = 0; n < variables.size(); ++n) parser.DefineVar(variables[n], &values[n]);
  for (const auto& [name, value] : constants) parser.DefineConst(name, value);
  parser.SetExpr(text);
  int count = 0;  // of values, of which muParser gives the last: two for "v, x"
  (void)parser.Eval(count);
  if (count != 1) throw std::invalid_argument(text + " is more than one expression");
  return Reader(parser.GetByteCode().GetBase(), values).nodes;
}

}  // namespace

// muParser: small, maintained, packaged; its grammar and its messages.
Expression::Expression(std::string text, const std::vector<std::string>& variables,
                       const Constants& constants)
    : text_(std::move(text)) {
  if (assigns(text_)) {
    throw std::invalid_argument(text_ + " assigns a value; == is the comparison");
  }
  try {
    nodes_ = read(text_, variables, constants);
  } catch (const mu::ParserError& error) {
    std::string message = error.GetMsg();
    if (message.ends_with('.')) message.pop_back();
    throw std::invalid_argument(message);
  }
}

double Expression::operator()(const std::vector<double>& values) const {
  return evaluated(nodes_, values);
}

Jet Expression::jet(const std::vector<Jet>& values) const { return evaluated(nodes_, values); }

std::vector<double> Expression::numbers() const {
  std::vector<double> found;
  for (const Node& node : nodes_) {
    if (node.operation == Operation::constant) found.push_back(std::abs(node.value));
  }
  return found;
}

// Whether an expression is odd, from its tree alone: f(v) and f(-v) are written in one form, in
// which signs stand outside as far as odd and even functions let them, and what may be exchanged
// is sorted.

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
