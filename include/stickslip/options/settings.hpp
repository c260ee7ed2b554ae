#pragma once
/// Values of the table's options as the user gave them.

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "stickslip/effects/effect.hpp"
#include "stickslip/options/table.hpp"

namespace stickslip::options {

/// Messages about everything that is wrong with the input, reported together.
class Problems {
 public:
  void add(std::string message) { messages_.push_back(std::move(message)); }
  /// "-delta = -1: must be ...; fix".
  void add(const Option& option, const std::string& value, const std::string& why,
           const std::string& fix);
  [[nodiscard]] bool empty() const { return messages_.empty(); }
  [[nodiscard]] const std::vector<std::string>& messages() const { return messages_; }
  /// Throws BadInput with all messages, if there are any.
  void raise() const;

 private:
  std::vector<std::string> messages_;
};

/// Typed access to the options of the table, with what is wrong with them. A number is not asked
/// for before its text is known to be one.
class Settings : public effects::Given {
 public:
  /// Reads all options of the table from the PETSc options database, and marks them used. Local.
  static Settings read();

  [[nodiscard]] bool has(const std::string& name) const override { return text_.contains(name); }
  /// The value as given or its default; empty if neither exists.
  [[nodiscard]] std::string text(const std::string& name) const override;
  [[nodiscard]] double real(const std::string& name) const override;
  /// The whole number given or the default; nothing if neither exists or a word was given.
  [[nodiscard]] std::optional<int> integer(const std::string& name) const override;
  [[nodiscard]] std::vector<std::string> list(const std::string& name) const;
  /// The numbers of a list option, empty if it was not given.
  [[nodiscard]] std::vector<double> numbers(const std::string& name) const;
  [[nodiscard]] bool flag(const std::string& name) const { return text(name) != "no"; }
  /// Gives the number option `name` another value, checked as if the user had given it.
  void set(const std::string& name, double value);
  void refuse(const std::string& name, const std::string& why, const std::string& fix) override;
  [[nodiscard]] bool sound() const override { return problems_.empty(); }
  [[nodiscard]] Problems& problems() { return problems_; }

 private:
  std::map<std::string, std::string> text_;
  Problems problems_;
};

}  // namespace stickslip::options
