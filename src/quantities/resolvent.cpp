#include "stickslip/quantities/resolvent.hpp"

#include <algorithm>
#include <functional>

#include "stickslip/operators/static_chain.hpp"
#include "stickslip/petsc/check.hpp"

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

PetscReal largest(Vec values) {
  PetscReal size = 0;
  petsc::check(VecNorm(values, NORM_INFINITY, &size));
  return size;
}

/// The problems of one parity.
class Sector {
 public:
  Sector(operators::Systems& systems, double lambda, Symmetry symmetry)
      : systems_(systems), lambda_(lambda), symmetry_(symmetry) {}

  /// h^+ + h^- of even symmetry, h^+ - h^- of odd symmetry, at s+.
  [[nodiscard]] Uncertain exit_transform() {
    const auto& process = systems_.process();
    const int k = process.static_index();
    const auto values =
        even() ? StaticChain(process.noise, k, lambda_).exit_transform()
               : spread_odd(StaticChain::odd(process.noise, k, lambda_).upward_exit_transform());
    return solve(values, nullptr);
  }

  /// w(s+; f) for an f of this parity.
  [[nodiscard]] Uncertain integral(const Function& f) {
    const auto values = static_integral(f);
    const auto& a = systems_.at(lambda_, symmetry_).a();
    const petsc::VecHandle source = a.values(f), overlooked = a.overlooked(f);
    PetscReal size = largest(source);
    for (double v : values) size = std::max<PetscReal>(size, std::abs(v));
    if (size == 0) return {};
    constexpr double rounding = 1e-12;
    Uncertain found = solve(values, source);
    if (largest(overlooked) <= rounding * size) return found;
    const std::vector<double> nothing(values.size(), 0.0);
    found.error += std::abs(solve(nothing, overlooked).value);
    return found;
  }

 private:
  [[nodiscard]] bool even() const { return symmetry_ == Symmetry::even; }

  // int exp(-lambda s) f(X_s, 0, 0) ds over a stay, by its first level, index i + k.
  [[nodiscard]] std::vector<double> static_integral(const Function& f) const {
    const auto& process = systems_.process();
    const int k = process.static_index();
    std::vector<double> values;
    for (int i = even() ? -k : 1; i <= k; ++i) values.push_back(f(process.noise.level(i), 0, 0));
    if (even()) return StaticChain(process.noise, k, lambda_).integral(std::move(values));
    return spread_odd(StaticChain::odd(process.noise, k, lambda_).integral(std::move(values)));
  }

  // u(s+) where (lambda - L) u = source on the sliding states, with the static values given.
  [[nodiscard]] Uncertain solve(const std::vector<double>& values, Vec source) {
    auto& system = systems_.at(lambda_, symmetry_);
    const std::vector<PetscScalar> s(values.begin(), values.end());
    const petsc::VecHandle rhs = system.a().from_rest(s);
    if (source != nullptr) petsc::check(VecAXPY(rhs, 1, source));
    return value_of(system.a().trace_at_exit(), system.factors().solve(rhs));
  }

  operators::Systems& systems_;
  double lambda_;
  Symmetry symmetry_;
};

}  // namespace

Resolvent resolvent(operators::Systems& systems, double lambda,
                    const std::vector<model::Observable>& observables) {
  Sector even(systems, lambda, Symmetry::even), odd(systems, lambda, Symmetry::odd);
  Resolvent r;
  r.of.resize(observables.size());
  const Uncertain h_even = even.exit_transform();
  r.exits.w_one = even.integral([](double, double, double) { return 1.0; });
  std::vector<Uncertain> w_even, w_odd;
  for (const auto& f : observables) {
    w_even.push_back(even.integral([&f](double x, double y, double v) { return f.even(x, y, v); }));
  }
  systems.release(lambda, Symmetry::even);
  const Uncertain h_odd = odd.exit_transform();
  for (const auto& f : observables) {
    w_odd.push_back(odd.integral([&f](double x, double y, double v) { return f.odd(x, y, v); }));
  }
  systems.release(lambda, Symmetry::odd);

  r.exits.h_plus = 0.5 * (h_even + h_odd);
  r.exits.h_minus = 0.5 * (h_even - h_odd);
  // 1 - h_o = (1 - h_e) + 2 h^- and 1 - h_e = lambda w(s+; 1): a positive sum.
  const Uncertain one_minus_h_odd = lambda * r.exits.w_one + 2.0 * r.exits.h_minus;
  for (std::size_t n = 0; n < observables.size(); ++n) {
    auto& t = r.of[n];
    t.w_plus = w_even[n] + w_odd[n];
    t.w_minus = w_even[n] - w_odd[n];
    t.pi_lambda = w_even[n] / r.exits.w_one;
    t.mu_lambda = w_odd[n] / one_minus_h_odd;
    if (lambda > 0) t.u = (1 / lambda) * t.pi_lambda + t.mu_lambda;
  }
  return r;
}

void append_resolvent(const std::vector<double>& lambda,
                      const std::vector<model::Observable>& observables,
                      const std::vector<Resolvent>& resolvents, Results& results) {
  // Differences of the two parities have no accuracy of their own size where they nearly cancel.
  const auto append = [&](const std::string& key, bool each_by_its_size, const auto& value,
                          Kind kind = Kind::other) {
    Result result = array(key, "", "lambda", lambda, kind);
    for (const auto& r : resolvents) append_value(result, value(r));
    result.each_by_its_size = each_by_its_size;
    results.push_back(std::move(result));
  };
  append("h_plus", true, [](const Resolvent& r) { return r.exits.h_plus; });
  append("h_minus", false, [](const Resolvent& r) { return r.exits.h_minus; });
  append("w_one", true, [](const Resolvent& r) { return r.exits.w_one; });
  const bool finite = std::all_of(lambda.begin(), lambda.end(), [](double l) { return l > 0; });
  for (std::size_t n = 0; n < observables.size(); ++n) {
    const auto key = [&](const char* what) { return what + ("(" + observables[n].name + ")"); };
    const auto member = [n](Uncertain ObservableTransforms::*value) {
      return [n, value](const Resolvent& r) { return r.of[n].*value; };
    };
    if (finite) append(key("u"), true, member(&ObservableTransforms::u));
    append(key("w_plus"), false, member(&ObservableTransforms::w_plus));
    append(key("w_minus"), false, member(&ObservableTransforms::w_minus));
    append(key("pi"), true, member(&ObservableTransforms::pi_lambda),
           observables[n].within_unit() ? Kind::probability : Kind::other);
    append(key("mu"), false, member(&ObservableTransforms::mu_lambda));
  }
}

}  // namespace stickslip::quantities
