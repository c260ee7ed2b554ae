#include <fmt/format.h>

#include <map>

#include "stickslip/studies/extrapolation.hpp"
#include "studies.hpp"

namespace stickslip::studies {
namespace {

// The change after next is to the next one as that is to the last: a + R (a - b), where R is the
// ratio of changes one step before.
double continued(double a, double b, double c) { return a + (a - b) / (b - c) * (a - b); }

}  // namespace

bool is_computed(const Place& place) {
  const auto [k, l] = place;
  return l <= 4 || (l == 5 && k <= 6) || (l == 6 && k <= 4);
}

void extrapolate(std::map<Place, double>& s) {
  for (int l = 1; l <= kMostSteps; ++l) {
    for (int k = 1; k <= kMostPoints; ++k) {
      if (is_computed({k, l})) continue;
      const double vertical = continued(s[{k, l - 1}], s[{k, l - 2}], s[{k, l - 3}]);
      const double horizontal = continued(s[{k - 1, l}], s[{k - 2, l}], s[{k - 3, l}]);
      s[{k, l}] = (vertical + horizontal) / 2;
    }
  }
}

namespace {

/// All runs of the index set, and the converged values of the two finest steps.
class Grid {
 public:
  explicit Grid(const Context& context) : context_(context) {}

  void run() {
    int number = 0, count = 2;
    each([&](int k, int l) {
      require_upwind_memory(context_, case_at(l), 1 << k, kTail);
      ++count;
    });
    each([&](int k, int l) {
      context_.report(++number, count, fmt::format("p = {}, delta = 1/{}", 1 << k, 1 << l));
      runs_[{k, l}] = upwind_run(context_, case_at(l), 1 << k, kTail);
    });
    for (int l : {5, 6}) {
      context_.report(++number, count, fmt::format("hp, delta = 1/{}", 1 << l));
      converged_[l] = converged_run(context_, case_at(l), 1e-9);
    }
  }

  [[nodiscard]] Table table(const std::string& key) const {
    std::map<Place, double> values;
    for (const auto& [place, run] : runs_) values[place] = value_of(run.results, key);
    extrapolate(values);
    Table table{key,
                key +
                    " by the extrapolation of the paper, p = 2^k and delta = 2^-l; converged by hp",
                {{"k", Digits::parameter},
                 {"l", Digits::parameter},
                 {"extrapolated", Digits::compared},
                 {"converged", Digits::compared},
                 {"relative_error", Digits::error}},
                {}};
    for (const auto& [place, value] : values) {
      const auto [k, l] = place;
      if (is_computed(place)) continue;
      const double truth = value_of(converged_.at(l).results, key);
      table.rows.push_back({static_cast<double>(k), static_cast<double>(l), value, truth,
                            std::abs(value / truth - 1)});
    }
    return table;
  }

  [[nodiscard]] std::vector<Run> runs() const {
    std::vector<Run> all;
    for (const auto& [place, run] : runs_) all.push_back(run);
    for (const auto& [l, run] : converged_) all.push_back(run);
    return all;
  }
  [[nodiscard]] const quantities::Results& finest() const { return converged_.at(6).results; }

 private:
  // Extrapolation itself is right to a few digits.
  static constexpr double kTail = 1e-6;

  [[nodiscard]] cases::Case case_at(int l) const {
    return with_delta(context_.given, std::ldexp(1, -l));
  }

  template <class Action>
  static void each(Action action) {
    for (int l = 1; l <= kMostSteps; ++l) {
      for (int k = 1; k <= kMostPoints; ++k) {
        if (is_computed({k, l})) action(k, l);
      }
    }
  }

  const Context& context_;
  std::map<Place, Run> runs_;
  std::map<int, Run> converged_;
};

}  // namespace

Study study_heuristic(const Context& context) {
  Grid grid(context);
  grid.run();
  Study study;
  study.kind = "heuristic";
  study.runs = grid.runs();
  for (const auto& result : grid.finest()) {
    study.tables.push_back(grid.table(result.key));
    double worst = 0;
    for (const auto& row : study.tables.back().rows) worst = std::max(worst, row[4]);
    study.conclusions.push_back(
        fmt::format("{}: largest relative error of extrapolated values {:.1e}", result.key, worst));
  }
  return study;
}

}  // namespace stickslip::studies
