#include "stickslip/quantities/resolvent.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "stickslip/catalogue/averages_keys.hpp"
#include "stickslip/catalogue/resolvent_keys.hpp"
#include "stickslip/operators/static_chain.hpp"
#include "stickslip/petsc/check.hpp"
#include "stickslip/quantities/plan.hpp"

namespace stickslip::quantities {
namespace {

using operators::Branch;
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

PetscReal largest(Vec values) {
  PetscReal size = 0;
  petsc::check(VecNorm(values, NORM_INFINITY, &size));
  return size;
}

/// The problems of one symmetry.
class Sector {
 public:
  Sector(operators::Systems& systems, double lambda, Symmetry symmetry)
      : systems_(systems), lambda_(lambda), symmetry_(symmetry) {}

  /// At s+ and, where both branches are kept, at s-.
  struct Values {
    Uncertain plus, minus;
  };

  /// h^+ or h^- by the exits of the static chain; with symmetry h^+ + h^- of even functions and
  /// h^+ - h^- of odd ones.
  [[nodiscard]] Values exit_transform(Branch side) {
    const auto& process = systems_.process();
    const auto chain = StaticChain::of(process, lambda_);
    switch (symmetry_) {
    case Symmetry::even: return solve(chain.exit_transform());
    case Symmetry::odd: {
      const int k = process.highest_static();
      return solve(spread_odd(StaticChain::odd(process.noise, k, lambda_).upward_exit_transform()));
    }
    case Symmetry::none: break;
    }
    return solve(side == Branch::positive ? chain.upward_exit_transform()
                                          : chain.downward_exit_transform());
  }

  /// w(s+-; f) for an f of this symmetry.
  [[nodiscard]] Values integral(const Function& f, bool quadratic) {
    const auto values = static_integral(f);
    const auto& a = systems_.at(lambda_, symmetry_).a();
    const petsc::VecHandle source = a.values(f);
    PetscReal size = largest(source);
    for (double v : values) size = std::max<PetscReal>(size, std::abs(v));
    if (size == 0) return {};
    Values found = solve(values, source);
    if (quadratic) return found;
    constexpr double rounding = 1e-12;
    const petsc::VecHandle overlooked = a.overlooked(f);
    if (largest(overlooked) <= rounding * size) return found;
    const Values more = solve(std::vector<double>(values.size(), 0.0), overlooked);
    found.plus.error += std::abs(more.plus.value);
    found.minus.error += std::abs(more.minus.value);
    return found;
  }

 private:
  // int exp(-lambda s) f(X_s, 0, 0) ds over a sticking phase, by its first level from the lowest
  // up.
  [[nodiscard]] std::vector<double> static_integral(const Function& f) const {
    const auto& process = systems_.process();
    const int highest = process.highest_static();
    const bool odd = symmetry_ == Symmetry::odd;
    std::vector<double> values;
    for (int i = odd ? 1 : process.lowest_static(); i <= highest; ++i) {
      values.push_back(f(process.noise.level(i), 0, 0));
    }
    if (!odd) return StaticChain::of(process, lambda_).integral(std::move(values));
    return spread_odd(
        StaticChain::odd(process.noise, highest, lambda_).integral(std::move(values)));
  }

  // u(s+-) where (lambda - L) u = source on the sliding states, with the static values given.
  [[nodiscard]] Values solve(const std::vector<double>& values, Vec source = nullptr) {
    auto& system = systems_.at(lambda_, symmetry_);
    const std::vector<PetscScalar> s(values.begin(), values.end());
    const petsc::VecHandle rhs = system.a().from_static(s);
    if (source != nullptr) petsc::check(VecAXPY(rhs, 1, source));
    const auto u = system.factors().solve(rhs);
    Values at{value_of(system.a().trace_at_exit(), u), {}};
    if (symmetry_ != Symmetry::none) return at;
    at.minus = value_of(system.a().trace_at_exit(Branch::negative), u);
    return at;
  }

  operators::Systems& systems_;
  double lambda_;
  Symmetry symmetry_;
};

Function one() {
  return [](double, double, double) { return 1.0; };
}

// From s- everything is the same for even functions, and the opposite for odd ones.
struct Mirrored {
  Uncertain same, other, w_one;
  double lambda;

  [[nodiscard]] Resolvent empty() const { return {{same, other, w_one}, {other, same, w_one}, {}}; }
  // 1 - h_o = (1 - h_e) + 2 h^- and 1 - h_e = lambda w(s+; 1): a positive sum.
  [[nodiscard]] ObservableTransforms of(Uncertain w_even, Uncertain w_odd) const {
    const Uncertain mu = w_odd / (lambda * w_one + 2.0 * other);
    return {w_even + w_odd, w_even - w_odd, w_even / w_one, mu, -1.0 * mu, {}, {}};
  }
};

Resolvent by_parity(operators::Systems& systems, double lambda,
                    const std::vector<model::Observable>& observables) {
  Sector even(systems, lambda, Symmetry::even), odd(systems, lambda, Symmetry::odd);
  const Uncertain h_even = even.exit_transform(Branch::positive).plus;
  const Uncertain w_one = even.integral(one(), true).plus;
  std::vector<Uncertain> w_even;
  for (const auto& f : observables) {
    w_even.push_back(even.integral(operators::part_of(f, Symmetry::even), f.quadratic).plus);
  }
  systems.release({lambda, Symmetry::even});
  const Uncertain h_odd = odd.exit_transform(Branch::positive).plus;
  const Mirrored sides{0.5 * (h_even + h_odd), 0.5 * (h_even - h_odd), w_one, lambda};
  Resolvent r = sides.empty();
  for (std::size_t n = 0; n < observables.size(); ++n) {
    const auto& f = observables[n];
    r.of.push_back(
        sides.of(w_even[n], odd.integral(operators::part_of(f, Symmetry::odd), f.quadratic).plus));
  }
  systems.release({lambda, Symmetry::odd});
  return r;
}

// The same where no level lies at 0, and both branches are kept.
Resolvent by_mirror(operators::Systems& systems, double lambda,
                    const std::vector<model::Observable>& observables) {
  Sector all(systems, lambda, Symmetry::none);
  const Mirrored sides{all.exit_transform(Branch::positive).plus,
                       all.exit_transform(Branch::negative).plus, all.integral(one(), true).plus,
                       lambda};
  Resolvent r = sides.empty();
  for (const auto& f : observables) {
    const auto w = [&](Symmetry parity) {
      return all.integral(operators::part_of(f, parity), f.quadratic).plus;
    };
    r.of.push_back(sides.of(w(Symmetry::even), w(Symmetry::odd)));
  }
  systems.release({lambda, Symmetry::none});
  return r;
}

// The sides from which excursions start by the chain with discounted steps h.
Resolvent by_side(operators::Systems& systems, double lambda,
                  const std::vector<model::Observable>& observables) {
  Sector all(systems, lambda, Symmetry::none);
  const auto up = all.exit_transform(Branch::positive), down = all.exit_transform(Branch::negative);
  const auto w_one = all.integral(one(), true);
  Resolvent r{{up.plus, down.plus, w_one.plus}, {up.minus, down.minus, w_one.minus}, {}};
  const Uncertain a = down.plus, b = up.minus;
  // The determinant of 1 - h is lambda times this sum; both are positive.
  const Uncertain cycle = b * w_one.plus + a * w_one.minus;
  const Uncertain discounted = cycle + lambda * (w_one.plus * w_one.minus);
  for (const auto& f : observables) {
    const auto w = all.integral(f.value, f.quadratic);
    const Uncertain difference = w_one.minus * w.plus - w_one.plus * w.minus;
    r.of.push_back({w.plus,
                    w.minus,
                    (b * w.plus + a * w.minus) / cycle,
                    (a * w_one.minus / cycle) * (difference / discounted),
                    -1.0 * ((b * w_one.plus / cycle) * (difference / discounted)),
                    {},
                    {}});
  }
  systems.release({lambda, Symmetry::none});
  return r;
}

// How many observables have a part of that symmetry, as far as a sample of states shows; the others
// are not solved for.
int count_with(double (model::Observable::*part)(double, double, double) const,
               const std::vector<model::Observable>& observables, const model::Scene& scene) {
  const auto process = scene.meant();
  const int last = std::min(3 * process.highest_static() + 3, process.noise.highest());
  return static_cast<int>(std::ranges::count_if(observables, [&](const model::Observable& f) {
    for (int i = 0; i <= last; ++i) {
      const double x = process.noise.level(i);
      if (i <= process.highest_static() && (f.*part)(x, 0, 0) != 0) return true;
      for (double v : {0.01, 0.3, 2.0}) {
        if ((f.*part)(x, 1, v) != 0 || (f.*part)(-x, 1, v) != 0) return true;
      }
    }
    return false;
  }));
}

}  // namespace

Resolvent resolvent(operators::Systems& systems, double lambda,
                    const std::vector<model::Observable>& observables) {
  const auto& process = systems.process();
  const auto by = process.symmetric() ? by_parity : process.drifts() ? by_side : by_mirror;
  Resolvent r = by(systems, lambda, observables);
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

// Both sectors for the exits, the even one for their discounted time.
void resolvent_tasks(Planner& planner) {
  const auto found = planner.collect<Resolvent>(
      [](const Computation& computation, const auto& all) {
        const auto& question = computation.question();
        append_resolvent(question.lambda, question.observables, all,
                         !computation.process().drifts(), computation.results());
      },
      true);
  const auto& scene = planner.given().scene;
  const auto& f = planner.question().observables;
  const int even = planner.symmetric() ? count_with(&model::Observable::even, f, scene) : 0,
            odd = planner.symmetric() ? count_with(&model::Observable::odd, f, scene) : 0;
  planner.add_at_each_lambda([&](double lambda) {
    Task task{fmt::format("resolvent at lambda = {:g}", lambda)};
    task.uses = {{{lambda, Symmetry::even}, 2 + even, 0}, {{lambda, Symmetry::odd}, 1 + odd, 0}};
    if (!planner.symmetric()) {
      task.uses = {{{lambda, Symmetry::none}, 3 + static_cast<int>(f.size()), 0}};
    }
    task.carry_out = [=](Computation& computation) {
      found->push_back(resolvent(computation.systems, lambda, computation.question().observables));
    };
    return task;
  });
}

}  // namespace stickslip::quantities
