#include "stickslip/quantities/resolvent.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "stickslip/catalogue/averages_keys.hpp"
#include "stickslip/catalogue/resolvent_keys.hpp"
#include "stickslip/operators/static_chain.hpp"
#include "stickslip/petsc/check.hpp"
#include "stickslip/quantities/discounted_starts.hpp"
#include "stickslip/quantities/plan.hpp"
#include "stickslip/quantities/stationary.hpp"

namespace stickslip::quantities {
namespace {

using operators::StaticChain;
using operators::Symmetry;
using Function = operators::KolmogorovOperator::Observable;

// Values on 1 ... k of an odd function, spread over -k ... k.
std::vector<double> spread_odd(const std::vector<double>& upper) {
  const std::size_t k = upper.size();
  std::vector<double> all(2 * k + 1, 0.0);
  for (std::size_t i = 1; i <= k; ++i) {
    all[k + i] = upper[i - 1];
    all[k - i] = -upper[i - 1];
  }
  return all;
}

PetscReal infinity_norm(Vec values) {
  PetscReal size = 0;
  petsc::check(VecNorm(values, NORM_INFINITY, &size));
  return size;
}

Function one() {
  return [](double, double, double) { return 1.0; };
}

/// Excursions from each of some levels by one symmetry: how long, discounted, their sliding phases
/// are in each state, and where these end.
class Sector {
 public:
  Sector(operators::Systems& systems, double lambda, Symmetry symmetry,
         const std::vector<int>& levels)
      : process_(systems.process()),
        lambda_(lambda),
        symmetry_(symmetry),
        system_(systems.at(lambda, symmetry)) {
    for (int level : levels) {
      auto& nu = occupations_.emplace_back(
          system_.factors().solve_transposed(system_.a().trace_at_start(level)));
      if (symmetry != Symmetry::odd) {
        petsc::check(VecAYPX(nu.correction, -1, nu.x));
        for (Vec each : std::array<Vec, 2>{nu.x, nu.correction})
          normalise(system_.a(), each, lambda);
        petsc::check(VecAYPX(nu.correction, -1, nu.x));
      }
      const auto p = system_.a().entry_rates(nu.x), step = system_.a().entry_rates(nu.correction);
      auto& entry = entries_.emplace_back();
      for (std::size_t k = 0; k < p.size(); ++k) {
        entry.push_back({PetscRealPart(p[k]), std::abs(PetscRealPart(step[k]))});
      }
    }
  }

  /// E[exp(-lambda T); the excursion ends in a way] from start t, given that by the first level of
  /// its sticking phase.
  [[nodiscard]] Uncertain exit_transform(std::size_t t, const std::vector<double>& exit) const {
    Uncertain sum;
    for (std::size_t k = 0; k < exit.size(); ++k) sum = sum + exit[k] * entries_[t][k];
    return sum;
  }

  /// w(f), for an f of this symmetry, by start.
  [[nodiscard]] std::vector<Uncertain> integral(const Function& f, bool quadratic) const {
    const auto rest = static_integral(f);
    const auto& a = system_.a();
    const petsc::VecHandle sliding = a.values(f);
    petsc::VecHandle overlooked = quadratic ? a.zeros() : a.overlooked(f);
    constexpr double rounding = 1e-12;
    const double size = std::max<double>(infinity_norm(sliding), largest_size(rest));
    if (infinity_norm(overlooked) <= rounding * size) overlooked = a.zeros();
    std::vector<Uncertain> w;
    for (std::size_t t = 0; t < occupations_.size(); ++t) {
      const auto& nu = occupations_[t];
      w.push_back(value_of(sliding, nu) + exit_transform(t, rest));
      w.back().error += std::abs(value_of(overlooked, nu).value);
    }
    return w;
  }

 private:
  // int exp(-lambda s) f(X_s, 0, 0) ds over a sticking phase, by its first level from the lowest
  // up.
  [[nodiscard]] std::vector<double> static_integral(const Function& f) const {
    const int highest = process_.highest_static();
    const bool odd = symmetry_ == Symmetry::odd;
    std::vector<double> values;
    for (int i = odd ? 1 : process_.lowest_static(); i <= highest; ++i) {
      values.push_back(f(process_.noise.level(i), 0, 0));
    }
    if (!odd) return StaticChain::of(process_, lambda_).integral(std::move(values));
    return spread_odd(
        StaticChain::odd(process_.noise, highest, lambda_).integral(std::move(values)));
  }

  const model::Process& process_;
  double lambda_;
  Symmetry symmetry_;
  operators::System& system_;
  std::vector<petsc::Solution> occupations_;
  std::vector<std::vector<Uncertain>> entries_;
};

// With symmetry all that s- gives is the same for even functions, and the opposite for odd ones.
Resolvent by_parity(operators::Systems& systems, double lambda,
                    const std::vector<model::Observable>& observables) {
  const auto& process = systems.process();
  const std::vector<int> start{process.exit_level(true)};
  const auto solve = [&](Symmetry parity, const std::vector<double>& exit, Uncertain& h,
                         Uncertain& w_one) {
    const Sector sector(systems, lambda, parity, start);
    h = sector.exit_transform(0, exit);
    if (parity == Symmetry::even) w_one = sector.integral(one(), true)[0];
    std::vector<Uncertain> w;
    for (const auto& f : observables) {
      w.push_back(sector.integral(operators::part_of(f, parity), f.quadratic)[0]);
    }
    systems.release({lambda, parity});
    return w;
  };
  const auto both = StaticChain::of(process, lambda).exit_transform(),
             apart = spread_odd(StaticChain::odd(process.noise, process.highest_static(), lambda)
                                    .upward_exit_transform());
  Uncertain h_even, h_odd, w_one;
  const auto w_even = solve(Symmetry::even, both, h_even, w_one);
  const auto w_odd = solve(Symmetry::odd, apart, h_odd, w_one);
  const Uncertain same = 0.5 * (h_even + h_odd), other = 0.5 * (h_even - h_odd);
  Resolvent r{{same, other, w_one}, {other, same, w_one}, {}};
  for (std::size_t n = 0; n < observables.size(); ++n) {
    // 1 - h_o = (1 - h_e) + 2 h^- and 1 - h_e = lambda w(s+; 1): a positive sum.
    const Uncertain mu = w_odd[n] / (lambda * w_one + 2.0 * other);
    r.of.push_back(
        {w_even[n] + w_odd[n], w_even[n] - w_odd[n], w_even[n] / w_one, mu, -1.0 * mu, {}, {}});
  }
  return r;
}

// From all starts, one after the other.
Resolvent by_start(operators::Systems& systems, double lambda,
                   const std::vector<model::Observable>& observables) {
  const auto& process = systems.process();
  const auto levels = process.starts();
  const auto place_of = [&](int level) {
    return static_cast<std::size_t>(std::ranges::find(levels, level) - levels.begin());
  };
  const Sector all(systems, lambda, Symmetry::none, levels);
  const auto chain = StaticChain::of(process, lambda);
  const std::size_t count = levels.size(), plus = place_of(process.exit_level(true)),
                    minus = place_of(process.exit_level(false));
  std::vector<std::vector<Uncertain>> h(count);
  for (int level : levels) {
    const auto exit = chain.exit_transform_to(level);
    for (std::size_t t = 0; t < count; ++t) h[t].push_back(all.exit_transform(t, exit));
  }
  const auto w_one = all.integral(one(), true);
  const auto up = chain.upward_exit_transform(), down = chain.downward_exit_transform();
  const auto from = [&](std::size_t t) {
    return ExitTransforms{all.exit_transform(t, up), all.exit_transform(t, down), w_one[t]};
  };
  Resolvent r{from(plus), from(minus), {}};
  const DiscountedStarts starts(lambda, w_one, h);
  for (const auto& f : observables) {
    const auto part = [&](Symmetry parity) {
      return all.integral(operators::part_of(f, parity), f.quadratic);
    };
    const auto w = part(Symmetry::none);
    Uncertain pi = starts.mean(w);
    auto mu = starts.apart(w);
    if (!process.drifts()) {
      // What mirror images make zero is exactly zero.
      pi = starts.mean(part(Symmetry::even));
      if (count == 2) mu = starts.apart(part(Symmetry::odd));
    }
    r.of.push_back({w[plus], w[minus], pi, mu[plus], mu[minus], {}, {}});
  }
  systems.release({lambda, Symmetry::none});
  return r;
}

}  // namespace

Resolvent resolvent(operators::Systems& systems, double lambda,
                    const std::vector<model::Observable>& observables) {
  Resolvent r =
      (systems.process().symmetric() ? by_parity : by_start)(systems, lambda, observables);
  for (auto& t : r.of) {
    if (lambda == 0) continue;
    t.u = (1 / lambda) * t.pi_lambda + t.mu_lambda;
    t.u_from_minus = (1 / lambda) * t.pi_lambda + t.mu_from_minus;
  }
  return r;
}

void append_resolvent(const std::vector<double>& lambda,
                      const std::vector<model::Observable>& observables,
                      const std::vector<Resolvent>& resolvents, bool symmetric, Results& results) {
  const auto add = [&](Result result, const auto& value) {
    for (const auto& r : resolvents) append_value(result, value(r));
    results.push_back(std::move(result));
  };
  const auto append = [&](const Row& row, const auto& value) { add(array(row, lambda), value); };
  append(catalogue::kHPlus, [](const Resolvent& r) { return r.from_plus.h_plus; });
  append(catalogue::kHMinus, [](const Resolvent& r) { return r.from_plus.h_minus; });
  // A difference of the two parities has no accuracy of its own size where they nearly cancel.
  if (symmetric) results.back().each_by_its_size = false;
  append(catalogue::kWOne, [](const Resolvent& r) { return r.from_plus.w_one; });
  if (!symmetric) {
    append(catalogue::kHPlusFromMinus, [](const Resolvent& r) { return r.from_minus.h_plus; });
    append(catalogue::kHMinusFromMinus, [](const Resolvent& r) { return r.from_minus.h_minus; });
    append(catalogue::kWOneFromMinus, [](const Resolvent& r) { return r.from_minus.w_one; });
  }
  const bool finite = std::all_of(lambda.begin(), lambda.end(), [](double l) { return l > 0; });
  for (std::size_t n = 0; n < observables.size(); ++n) {
    const auto& f = observables[n];
    const auto of = [&](const Row& row, Uncertain ObservableTransforms::*value) {
      add(array(blank(row, f), lambda), [n, value](const Resolvent& r) { return r.of[n].*value; });
    };
    if (finite) of(catalogue::kU, &ObservableTransforms::u);
    of(catalogue::kWPlus, &ObservableTransforms::w_plus);
    of(catalogue::kWMinus, &ObservableTransforms::w_minus);
    // Beside averages it may not take their name.
    const std::string average = catalogue::kPi.key_of(f.name);
    const bool taken = std::any_of(results.begin(), results.end(),
                                   [&](const Result& r) { return r.key == average; });
    of(catalogue::kPiLambda, &ObservableTransforms::pi_lambda);
    if (!taken) results.back().key = average;
    of(catalogue::kMu, &ObservableTransforms::mu_lambda);
    if (symmetric) continue;
    if (finite) of(catalogue::kUMinus, &ObservableTransforms::u_from_minus);
    of(catalogue::kMuMinus, &ObservableTransforms::mu_from_minus);
  }
}

void resolvent_tasks(Planner& planner) {
  const auto found = planner.collect<Resolvent>(
      [](const Computation& computation, const auto& all) {
        const auto& question = computation.question();
        append_resolvent(question.lambda, question.observables, all,
                         !computation.process().drifts(), computation.results());
      },
      true);
  planner.add_at_each_lambda([&](double lambda) {
    Task task{fmt::format("resolvent at lambda = {:g}", lambda)};
    task.uses = {{{lambda, Symmetry::even}, 0, 1}, {{lambda, Symmetry::odd}, 0, 1}};
    if (!planner.symmetric()) task.uses = {{{lambda, Symmetry::none}, 0, planner.starts()}};
    task.carry_out = [=](Computation& computation) {
      found->push_back(resolvent(computation.systems, lambda, computation.question().observables));
    };
    return task;
  });
}

}  // namespace stickslip::quantities
