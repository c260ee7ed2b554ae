#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "stickslip/studies/limit.hpp"
#include "stickslip/support/number_text.hpp"
#include "studies.hpp"

namespace stickslip::studies {
namespace {

/// One family of steps, with mu_s at the same place between the levels.
class Family {
 public:
  Family(const Context& context, double offset, std::string name)
      : context_(context), name_(std::move(name)) {
    const auto& friction = context.given.scene.friction;
    grazing_ = friction.mu_d == friction.mu_s;
    const double mu_s = friction.mu_s;
    const double first = std::max(1.0, std::round(mu_s / context.given.scene.delta - offset));
    // A lattice in the plane has states in proportion to the square of a step, and times to their
    // square again.
    const bool plane = !context.given.scene.meant().noise.neighbours_only();
    accuracy_ = std::min(context.given.question.accuracy, plane ? 1e-6 : 1e-9);
    const int steps = context.study.steps.value_or(plane ? 4 : 8);
    for (int n = 0; n < steps; ++n) {
      deltas_.push_back(mu_s / ((plane ? first + n : first * (1 << n)) + offset));
    }
  }

  [[nodiscard]] const std::vector<double>& deltas() const { return deltas_; }
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const std::vector<Run>& runs() const { return runs_; }

  void run(int& number, int count) {
    for (double delta : deltas_) {
      context_.report(++number, count, fmt::format("{}, delta = {:.6g}", name_, delta));
      runs_.push_back(converged_run(context_, with_delta(context_.given, delta), accuracy_));
    }
  }

  [[nodiscard]] Table table(const std::string& key) const {
    Table table{key + " " + name_,
                fmt::format("{}, mu_s {}", key, name_),
                {{"delta", Digits::parameter},
                 {"value", Digits::supported},
                 {"error", Digits::error},
                 {"order", Digits::order},
                 {"limit", Digits::supported},
                 {"limit_error", Digits::error}},
                {}};
    const auto s = samples(key);
    for (std::size_t n = 0; n < s.size(); ++n) {
      const auto known = std::span(s).first(n + 1);
      const double order = observed_order(known);
      const Limit limit = limit_of(known, order, grazing_);
      table.rows.push_back({s[n].delta, s[n].value, s[n].error, order, limit.value, limit.error});
    }
    return table;
  }

 private:
  [[nodiscard]] std::vector<Sample> samples(const std::string& key) const {
    std::vector<Sample> all;
    for (const auto& run : runs_) {
      for (const auto& result : run.results) {
        if (result.key != key) continue;
        all.push_back({run.parameters[0].second, result.value[0], result.error[0]});
      }
    }
    return all;
  }

  const Context& context_;
  std::string name_;
  bool grazing_ = false;  // mu_d = mu_s
  double accuracy_;
  std::vector<double> deltas_;
  std::vector<Run> runs_;
};

std::string conclusion(const Table& table) {
  const auto& last = table.rows.back();
  if (std::isnan(last[4]))
    return table.name + ": no order of convergence; the changes are too small or irregular";
  return fmt::format("{}: order {:.2f}, limit {} +- {:.1e}", table.name, last[3],
                     number_text(last[4], last[5]), last[5]);
}

}  // namespace

Study study_steps(const Context& context) {
  Study study;
  study.kind = "delta";
  Family on_level(context, 0, "on a level"), between(context, 0.5, "between levels");
  const int count = static_cast<int>(on_level.deltas().size() + between.deltas().size());
  int number = 0;
  for (Family* family : {&on_level, &between}) {
    family->run(number, count);
    for (const auto& result : family->runs().back().results) {
      study.tables.push_back(family->table(result.key));
      study.conclusions.push_back(conclusion(study.tables.back()));
    }
    study.runs.insert(study.runs.end(), family->runs().begin(), family->runs().end());
  }
  return study;
}

}  // namespace stickslip::studies
