#include "stickslip/quantities/until_passage.hpp"

#include <cstdlib>
#include <numeric>
#include <utility>

#include "stickslip/algebra/rate_elimination.hpp"
#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/vectors.hpp"

namespace stickslip::quantities {
namespace {

double sum_of_products(const ByLevel& a, const ByLevel& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

}  // namespace

StickingPhases::StickingPhases(const model::Process& of, std::vector<int> from, bool reduced,
                               double lambda)
    : process(of), symmetric(reduced) {
  if (!process.sticks()) return;
  starts = std::move(from);
  chain.emplace(operators::StaticChain::of(process, lambda));
  for (int level : starts) {
    exits.push_back(symmetric ? chain->exit_transform() : chain->exit_transform_to(level));
  }
}

ByLevel StickingPhases::each(double value) const {
  return ByLevel(chain ? static_cast<std::size_t>(chain->size()) : 0, value);
}

ByLevel StickingPhases::stationary() const {
  ByLevel p = each(0);
  if (!chain) return p;
  const auto all = model::stationary_distribution(process.noise);
  std::copy_n(all.begin() + (process.lowest_static() - process.noise.lowest()), p.size(),
              p.begin());
  return p;
}

ByLevel StickingPhases::square_field(const ByLevel& at_rest, const ByLevel& at_starts) const {
  ByLevel f = each(0);
  const int lowest = process.lowest_static();
  for (std::size_t n = 0; n < f.size(); ++n) {
    process.noise.for_each_jump(lowest + static_cast<int>(n), [&](int to, double rate) {
      const auto start = std::ranges::find(starts, symmetric ? std::abs(to) : to);
      const double change =
          (process.sticks(to) ? at_rest[to - lowest] : at_starts[start - starts.begin()]) -
          at_rest[n];
      f[n] += rate * change * change;
    });
  }
  return f;
}

std::vector<petsc::Solution> occupations_from(operators::System& system,
                                              const std::vector<int>& starts,
                                              petsc::VecHandle first) {
  std::vector<petsc::VecHandle> from;
  for (int level : starts) from.push_back(system.a().trace_at_start(level));
  from.push_back(std::move(first));
  auto solutions = system.factors().solve_transposed(from);
  for (const petsc::Solution& nu : solutions) petsc::check(VecAYPX(nu.correction, -1, nu.x));
  return solutions;
}

UntilPassage::UntilPassage(const operators::KolmogorovOperator& a, const StickingPhases& sticking,
                           const ByLevel& at_rest, const std::vector<petsc::Solution>& solutions,
                           petsc::VecHandle petsc::Solution::*which)
    : sticking_(sticking), at_rest_(at_rest) {
  for (const auto& solution : solutions) {
    Vec nu = solution.*which;
    nu_.push_back(nu);
    entry_.emplace_back();
    for (const auto& rate : a.entry_rates(nu)) entry_.back().push_back(PetscRealPart(rate));
    reached_.push_back(a.rate_at_top(nu));
  }
}

UntilPassage::Integral UntilPassage::integral(Vec f, const ByLevel& f_at_rest) const {
  Integral sum{petsc::dot(nu_.back(), f), {}, {}};
  if (!sticking_.chain) return sum;
  sum.at_rest = sticking_.chain->integral(f_at_rest);
  for (std::size_t t = 0; t < sticking_.starts.size(); ++t) {
    sum.at_starts.push_back(petsc::dot(nu_[t], f));
  }
  return renewed(std::move(sum), {reached_.begin(), reached_.end() - 1});
}

// Discounted, a phase ends nowhere with the probability of lambda times its discounted time.
double UntilPassage::transform(double lambda, Vec one) const {
  if (!sticking_.chain) return reached_.back();
  std::vector<double> killing(reached_.begin(), reached_.end() - 1);
  Integral sum{reached_.back(), sticking_.each(0), killing};
  const ByLevel stuck = sticking_.chain->integral(sticking_.each(1));
  for (std::size_t t = 0; t < killing.size(); ++t) {
    killing[t] += lambda * (petsc::dot(nu_[t], one) + sum_of_products(entry_[t], stuck));
  }
  return renewed(std::move(sum), std::move(killing)).overall;
}

// From what is gathered in the first sliding or sticking phase alone.
UntilPassage::Integral UntilPassage::renewed(Integral sum, std::vector<double> killing) const {
  const std::size_t count = sticking_.starts.size();
  std::vector<algebra::RateElimination::Rate> steps;
  for (std::size_t t = 0; t < count; ++t) {
    sum.at_starts[t] += sum_of_products(entry_[t], sum.at_rest);
    for (std::size_t u = 0; u < count; ++u) {
      if (u == t) continue;
      steps.push_back({static_cast<int>(t), static_cast<int>(u),
                       sum_of_products(entry_[t], sticking_.exits[u])});
    }
  }
  sum.at_starts =
      algebra::RateElimination(std::move(killing), steps).integral(std::move(sum.at_starts));
  for (std::size_t u = 0; u < count; ++u) {
    for (std::size_t i = 0; i < sum.at_rest.size(); ++i) {
      sum.at_rest[i] += sticking_.exits[u][i] * sum.at_starts[u];
    }
  }
  sum.overall +=
      sum_of_products(entry_.back(), sum.at_rest) + sum_of_products(at_rest_, sum.at_rest);
  return sum;
}

}  // namespace stickslip::quantities
