#include "stickslip/quantities/engines/excursions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <utility>

namespace stickslip::quantities {
namespace {

using generator::Branch;
using generator::KolmogorovOperator;
using generator::State;
using generator::StateKind;
using generator::Symmetry;
using generator::Systems;

std::vector<double> real_parts(const std::vector<PetscScalar>& values) {
  std::vector<double> parts;
  for (const auto& value : values) parts.push_back(PetscRealPart(value));
  return parts;
}

// Means over excursions of which nu is the occupation, normalised.
Excursion excursion_of(const KolmogorovOperator& a, Vec nu, double lost) {
  const auto& [process, noise, velocities] = a.discretisation();
  const auto nodes = static_cast<std::size_t>(noise->count());
  const bool symmetry_reduced = a.states().symmetry_reduced();
  Excursion e;
  for (auto* sums : {&e.slide_time, &e.slide_distance, &e.slide_square}) {
    sums->resize((symmetry_reduced ? 1 : 2) * nodes);
  }
  const linalg::ReadView local(nu);
  PetscInt at = 0;
  a.states().for_each_local([&, &velocities_of_v = *velocities,
                             &nodes_of_x = *noise](const State& state) {
    const double mass = PetscRealPart(local[at++]), v = generator::speed_of(state, velocities_of_v);
    const int node = state.branch == Branch::positive
                         ? state.noise - nodes_of_x.first()
                         : nodes_of_x.count() + state.noise + nodes_of_x.last();
    e.slide_time[node] += mass;
    e.slide_distance[node] += mass * v;
    e.slide_square[node] += mass * v * v;
  });
  // A node lives on one rank, so that the sums do not depend on the distribution.
  for (auto* sums : {&e.slide_time, &e.slide_distance, &e.slide_square}) {
    linalg::sum_over_ranks(a.states().comm(), *sums);
  }
  e.entry = real_parts(a.entry_rates(nu));
  e.lost_probability = lost;
  e.stick_time = generator::StaticChain::of(process).occupation(e.entry);
  return e;
}

double sum_of_products(const ByLevel& a, const ByLevel& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

// Far below what follows one another at all; where discounts leave nothing but rounding, shares
// have its error.
std::vector<std::vector<Uncertain>> at_least_none(std::vector<std::vector<Uncertain>> h) {
  constexpr double least = 1e-30;
  for (auto& row : h) {
    for (auto& step : row) {
      const double value = std::max(step.value, least);
      step = {value, std::max(step.error, value - step.value)};
    }
  }
  return h;
}

std::size_t most_reached(const std::vector<std::vector<Uncertain>>& h) {
  std::vector<double> arrivals(h.size());
  for (const auto& row : h) {
    for (std::size_t u = 0; u < h.size(); ++u) arrivals[u] += row[u].value;
  }
  return static_cast<std::size_t>(std::ranges::max_element(arrivals) - arrivals.begin());
}

std::vector<std::size_t> all_but(std::size_t one, std::size_t count) {
  std::vector<std::size_t> others;
  for (std::size_t t = 0; t < count; ++t) {
    if (t != one) others.push_back(t);
  }
  return others;
}

}  // namespace

Uncertain value_of(Vec functional, const linalg::Solution& solution) {
  return {linalg::dot(functional, solution.x),
          std::abs(linalg::dot(functional, solution.correction))};
}

linalg::VecHandle on_states_of(const KolmogorovOperator& a, Vec sliding, const ByLevel& at_rest) {
  const linalg::ReadView values(sliding);
  const int lowest = a.discretisation().process.lowest_static();
  PetscInt next = 0;
  return a.by_state([&](const State& state) -> PetscScalar {
    if (state.kind != StateKind::static_phase) return values[next++];
    const bool pair = a.states().symmetry_reduced() && state.noise != 0;
    return at_rest[state.noise - lowest] + (pair ? at_rest[-state.noise - lowest] : 0);
  });
}

double normalise(const KolmogorovOperator& a, Vec nu, double lambda) {
  const auto entry = real_parts(a.entry_rates(nu));
  PetscScalar time = 0;
  linalg::check(VecSum(nu, &time));
  const double total =
      std::accumulate(entry.begin(), entry.end(), 0.0) + lambda * PetscRealPart(time);
  if (!(std::abs(total - 1) < 0.1)) {
    throw NotReached(
        fmt::format("rounding leaves {:.2g} for the probability that a sliding phase ends; sliding "
                    "phases last too long against the noise for double precision",
                    total));
  }
  linalg::check(VecScale(nu, 1 / total));
  return total - 1;
}

StationaryDistribution::StationaryDistribution(Systems& systems)
    : discretisation_(systems.discretisation()),
      states_(systems.at(0, generator::symmetry_of(systems.process())).a().states()) {
  auto& system = systems.at(0, generator::symmetry_of(process()));
  const KolmogorovOperator& a = system.a();
  const bool rests = process().sticks(), symmetric = process().symmetric();
  const Starts upwards = rests && symmetric ? Starts::upwards(process()) : Starts{};
  const std::vector<int> levels = rests && !symmetric ? process().starts() : upwards.levels;
  std::vector<linalg::VecHandle> from;
  for (int level : levels) from.push_back(a.trace_at_start(level));
  if (!rests) from.push_back(a.value_in_that_state());
  const auto occupations = system.factors().solve_transposed(from);
  for (const auto& nu : occupations) {
    const bool monotone = rests && discretisation_.velocities->keeps_origin();
    if (monotone) generator::require_occupation(nu.x, process());
    linalg::check(VecAYPX(nu.correction, -1, nu.x));
  }
  const auto follow = [&](linalg::VecHandle linalg::Solution::*which, Excursion& excursion,
                          linalg::VecHandle& occupation) {
    std::vector<Excursion> each;
    for (const auto& nu : occupations) {
      // A null vector of L, over a time that is as good as any other.
      if (!rests) linalg::scale_to_sum_one(nu.*which);
      const double lost = rests ? normalise(a, nu.*which) : 0;
      each.push_back(excursion_of(a, nu.*which, lost));
    }
    const bool several = rests && !symmetric;
    Starts starts = several ? chain_of_starts(process(), levels, each) : upwards;
    excursion = several ? joined(process(), starts, each) : each[0];
    occupation = a.zeros();
    for (std::size_t t = 0; t < occupations.size(); ++t) {
      linalg::check(VecAXPY(occupation, rests ? starts.shares[t] : 1, occupations[t].*which));
    }
    return starts;
  };
  starts_ = follow(&linalg::Solution::x, excursion_, occupation_);
  (void)follow(&linalg::Solution::correction, uncorrected_, uncorrected_occupation_);
}

// Sliding phases that end with V > 0 on level i, and with V < 0 on level -i in symmetry-reduced
// coordinates: halves of the sum and of the difference of both.
void StationaryDistribution::orient(Systems& systems) {
  if (!excursion_.entry_plus.empty()) return;
  auto& system = systems.at(0, Symmetry::odd);
  const linalg::Solution nu = system.factors().solve_transposed(system.a().trace_at_exit());
  linalg::check(VecAYPX(nu.correction, -1, nu.x));
  const auto set = [&](Vec odd, Excursion& e) {
    const auto oriented = real_parts(system.a().entry_rates(odd));
    const std::size_t last = e.entry.size() - 1;
    e.entry_plus.resize(e.entry.size());
    for (std::size_t i = 0; i <= last; ++i) {
      e.entry_plus[i] =
          (e.entry[i] + oriented[i]) / 2 + (e.entry[last - i] - oriented[last - i]) / 2;
    }
  };
  set(nu.x, excursion_);
  set(nu.correction, uncorrected_);
}

void StationaryDistribution::append_from(const FunctionOfExcursion& append,
                                         Results& results) const {
  Results corrected, uncorrected;
  append(discretisation_, excursion_, corrected);
  append(discretisation_, uncorrected_, uncorrected);
  const double defect = excursion_.conservation_defect(discretisation_);
  for (std::size_t r = 0; r < corrected.size(); ++r) {
    auto& result = corrected[r];
    for (std::size_t n = 0; n < result.value.size(); ++n) {
      const double value = result.value[n];
      result.error[n] += std::abs(value - uncorrected[r].value[n]) + defect * std::abs(value);
    }
    results.push_back(std::move(result));
  }
}

std::vector<Uncertain> StationaryDistribution::entry() const {
  const auto &p = excursion_.entry, &before = uncorrected_.entry;
  std::vector<Uncertain> entry;
  for (std::size_t n = 0; n < p.size(); ++n) entry.push_back(changed_from(before[n], p[n]));
  return entry;
}

linalg::VecHandle StationaryDistribution::starts_on(const KolmogorovOperator& a) const {
  linalg::VecHandle g = a.zeros();
  for (std::size_t t = 0; t < starts_.size(); ++t) {
    linalg::check(VecAXPY(g, starts_.shares[t], a.trace_at_start(starts_.levels[t])));
  }
  return g;
}

StationaryDistribution::Velocity
StationaryDistribution::velocity(const KolmogorovOperator& a) const {
  const double total = excursion_.mean_excursion();
  const double mean = excursion_.mean_drift(*discretisation_.noise) / total;
  linalg::VecHandle b = a.values([mean](double, double, double v) { return v - mean; }),
                    c = linalg::product(b, occupation_on(a));
  linalg::check(VecScale(c, 1 / total));
  return {std::move(b), std::move(c)};
}

// High order leaves far tails with signs of their own.
linalg::VecHandle StationaryDistribution::weight_on(const KolmogorovOperator& a) const {
  return positive_weight(occupation_on(a));
}

linalg::VecHandle positive_weight(linalg::VecHandle weight) {
  linalg::check(VecAbs(weight));
  linalg::check(VecShift(weight, 1e-12 * linalg::norm(weight, NORM_INFINITY)));
  return weight;
}

StickingPhases::StickingPhases(const model::Process& of, std::vector<int> from, bool reduced,
                               double lambda)
    : process(of), symmetric(reduced) {
  if (!process.sticks()) return;
  starts = std::move(from);
  chain.emplace(generator::StaticChain::of(process, lambda));
  for (int level : starts) {
    exits.push_back(symmetric ? chain->exit_transform() : chain->exit_transform_to(level));
  }
}

ByLevel StickingPhases::each(double value) const {
  return ByLevel(chain ? static_cast<std::size_t>(chain->size()) : 0, value);
}

ByLevel StickingPhases::static_part(const std::vector<double>& all) const {
  ByLevel p = each(0);
  if (!chain) return p;
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

std::vector<linalg::Solution> occupations_from(generator::System& system,
                                               const std::vector<int>& starts,
                                               linalg::VecHandle first) {
  std::vector<linalg::VecHandle> from;
  for (int level : starts) from.push_back(system.a().trace_at_start(level));
  from.push_back(std::move(first));
  auto solutions = system.factors().solve_transposed(from);
  for (const linalg::Solution& nu : solutions) linalg::check(VecAYPX(nu.correction, -1, nu.x));
  return solutions;
}

UntilPassage::UntilPassage(const generator::KolmogorovOperator& a, const StickingPhases& sticking,
                           const ByLevel& at_rest, const std::vector<linalg::Solution>& solutions,
                           linalg::VecHandle linalg::Solution::*which)
    : sticking_(sticking), at_rest_(at_rest) {
  for (const auto& solution : solutions) {
    Vec nu = solution.*which;
    nu_.push_back(nu);
    entry_.push_back(real_parts(a.entry_rates(nu)));
    reached_.push_back(a.rate_at_top(nu));
  }
}

UntilPassage::Integral UntilPassage::integral(Vec f, const ByLevel& f_at_rest) const {
  Integral sum{linalg::dot(nu_.back(), f), {}, {}};
  if (!sticking_.chain) return sum;
  sum.at_rest = sticking_.chain->integral(f_at_rest);
  for (std::size_t t = 0; t < sticking_.starts.size(); ++t) {
    sum.at_starts.push_back(linalg::dot(nu_[t], f));
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
    killing[t] += lambda * (linalg::dot(nu_[t], one) + sum_of_products(entry_[t], stuck));
  }
  return renewed(std::move(sum), std::move(killing)).overall;
}

// From what is gathered in the first sliding or sticking phase alone.
UntilPassage::Integral UntilPassage::renewed(Integral sum, std::vector<double> killing) const {
  const std::size_t count = sticking_.starts.size();
  std::vector<linalg::RateElimination::Rate> steps;
  for (std::size_t t = 0; t < count; ++t) {
    sum.at_starts[t] += sum_of_products(entry_[t], sum.at_rest);
    for (std::size_t u = 0; u < count; ++u) {
      if (u == t) continue;
      steps.push_back({static_cast<int>(t), static_cast<int>(u),
                       sum_of_products(entry_[t], sticking_.exits[u])});
    }
  }
  sum.at_starts =
      linalg::RateElimination(std::move(killing), steps).integral(std::move(sum.at_starts));
  for (std::size_t u = 0; u < count; ++u) {
    for (std::size_t i = 0; i < sum.at_rest.size(); ++i) {
      sum.at_rest[i] += sticking_.exits[u][i] * sum.at_starts[u];
    }
  }
  sum.overall +=
      sum_of_products(entry_.back(), sum.at_rest) + sum_of_products(at_rest_, sum.at_rest);
  return sum;
}

DiscountedStarts::DiscountedStarts(double lambda, std::vector<Uncertain> w,
                                   std::vector<std::vector<Uncertain>> h, bool positive)
    : lambda_(lambda),
      w_(std::move(w)),
      h_(positive ? at_least_none(std::move(h)) : std::move(h)),
      base_(most_reached(h_)),
      others_(all_but(base_, w_.size())),
      until_base_(steps(lambda)) {
  std::vector<Uncertain> to_base;
  for (std::size_t t : others_) to_base.push_back({h_[t][base_].value, 0});
  reaching_ = solved(to_base, 1);
  shares_ = shares();
}

template <class Term>
Uncertain DiscountedStarts::sum(const Term& term, std::size_t without) const {
  Uncertain sum;
  for (std::size_t s = 0; s < size(); ++s) {
    if (s != without) sum = sum + term(s);
  }
  return sum;
}

Uncertain DiscountedStarts::weight() const {
  return sum([&](std::size_t t) { return shares_[t] * w_[t]; });
}

Uncertain DiscountedStarts::mean(const std::vector<Uncertain>& f) const {
  return sum([&](std::size_t t) { return shares_[t] * f[t]; }) / weight();
}

std::vector<Uncertain> DiscountedStarts::apart(const std::vector<Uncertain>& f) const {
  std::vector<Uncertain> source, mu;
  for (std::size_t t : others_) {
    const auto term = [&](std::size_t s) { return shares_[s] * (f[t] * w_[s] - w_[t] * f[s]); };
    source.push_back(sum(term, t) / weight());
  }
  const auto x = solved(source, 0);
  const Uncertain all = sum([&](std::size_t s) { return shares_[s] * w_[s] * reaching_[s]; });
  for (std::size_t t = 0; t < size(); ++t) {
    const auto term = [&](std::size_t s) {
      return shares_[s] * w_[s] * (reaching_[s] * x[t] - reaching_[t] * x[s]);
    };
    mu.push_back(sum(term, t) / all);
  }
  return mu;
}

// Until the base is reached.
linalg::RateElimination DiscountedStarts::steps(double lambda) const {
  std::vector<double> killing;
  std::vector<linalg::RateElimination::Rate> steps;
  const int count = static_cast<int>(others_.size());
  for (int t = 0; t < count; ++t) {
    const auto& row = h_[others_[t]];
    killing.push_back(lambda * w_[others_[t]].value + row[base_].value);
    for (int u = 0; u < count; ++u) {
      if (u != t) steps.push_back({t, u, row[others_[u]].value});
    }
  }
  return {std::move(killing), steps};
}

// By start, from values of the others.
std::vector<Uncertain> DiscountedStarts::with_base(const std::vector<double>& values,
                                                   double at_base,
                                                   const std::vector<double>& errors) const {
  std::vector<Uncertain> all(size(), {at_base, 0});
  for (std::size_t n = 0; n < values.size(); ++n) {
    all[others_[n]] = {values[n], errors.empty() ? 0 : errors[n]};
  }
  return all;
}

// x with lambda w_t x_t + sum_u h_tu (x_t - x_u) = f_t and x = at_base at the base, where source_t
// = f_t + h_t,base at_base.
std::vector<Uncertain> DiscountedStarts::solved(const std::vector<Uncertain>& source,
                                                double at_base) const {
  std::vector<double> values, left;
  for (const auto& s : source) values.push_back(s.value);
  values = until_base_.integral(std::move(values));
  const auto x = with_base(values, at_base);
  for (std::size_t n = 0; n < others_.size(); ++n) {
    const std::size_t t = others_[n];
    double error = source[n].error + lambda_ * w_[t].error * std::abs(x[t].value);
    for (std::size_t u = 0; u < size(); ++u) {
      error += h_[t][u].error * std::abs(x[u].value - x[t].value);
    }
    left.push_back(error);
  }
  return with_base(values, at_base, until_base_.integral(std::move(left)));
}

// p_u sum_t h_ut = sum_t p_t h_tu but at the base.
std::vector<Uncertain> DiscountedStarts::shares() const {
  const auto chain = steps(0);
  std::vector<double> first, left;
  for (std::size_t u : others_) first.push_back(h_[base_][u].value);
  const auto values = chain.occupation(first);
  const auto p = with_base(values, 1);
  for (std::size_t u : others_) {
    double error = 0;
    for (std::size_t t = 0; t < size(); ++t) {
      if (t != u) error += p[t].value * h_[t][u].error + p[u].value * h_[u][t].error;
    }
    left.push_back(error);
  }
  return with_base(values, 1, chain.occupation(left));
}

}  // namespace stickslip::quantities
