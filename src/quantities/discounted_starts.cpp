#include "stickslip/quantities/discounted_starts.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace stickslip::quantities {
namespace {

// Far below what follows one another at all; where discounts leave nothing but rounding, shares
// have its error.
std::vector<std::vector<Uncertain>> positive(std::vector<std::vector<Uncertain>> h) {
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

DiscountedStarts::DiscountedStarts(double lambda, std::vector<Uncertain> w,
                                   std::vector<std::vector<Uncertain>> h)
    : lambda_(lambda),
      w_(std::move(w)),
      h_(positive(std::move(h))),
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
algebra::RateElimination DiscountedStarts::steps(double lambda) const {
  std::vector<double> killing;
  std::vector<algebra::RateElimination::Rate> steps;
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
std::vector<double> DiscountedStarts::with_base(const std::vector<double>& values,
                                                double at_base) const {
  std::vector<double> all(size(), at_base);
  for (std::size_t n = 0; n < values.size(); ++n) all[others_[n]] = values[n];
  return all;
}

std::vector<Uncertain> DiscountedStarts::with_base(const std::vector<double>& values,
                                                   double at_base,
                                                   const std::vector<double>& errors) const {
  std::vector<Uncertain> all(size(), {at_base, 0});
  for (std::size_t n = 0; n < values.size(); ++n) all[others_[n]] = {values[n], errors[n]};
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
    double error = source[n].error + lambda_ * w_[t].error * std::abs(x[t]);
    for (std::size_t u = 0; u < size(); ++u) error += h_[t][u].error * std::abs(x[u] - x[t]);
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
      if (t != u) error += p[t] * h_[t][u].error + p[u] * h_[u][t].error;
    }
    left.push_back(error);
  }
  return with_base(values, 1, chain.occupation(left));
}

}  // namespace stickslip::quantities
