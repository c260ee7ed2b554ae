#include "averages.hpp"

#include <algorithm>
#include <cmath>

#include "stickslip/catalogue/averages_keys.hpp"
#include "stickslip/catalogue/moments_keys.hpp"
#include "stickslip/catalogue/noise_law_keys.hpp"
#include "stickslip/catalogue/sticking_keys.hpp"
#include "stickslip/model/noise_chain.hpp"

namespace stickslip::routes {
namespace {

using catalogue::Quantity;
using quantities::Kind;
using quantities::Uncertain;

// Numbers of those that are not always results; those of the phases are there for others, too.
constexpr int kBeyond = 0, kStick = 1, kSlide = 2;

}  // namespace

std::vector<Average> averages(const Problem& problem) {
  const cases::Question& question = problem.given.question;
  const auto& process = problem.discretisation.process;
  const auto named = [&](const char* f) {
    return model::parse_observable(f, process.friction).value;
  };
  std::vector<Average> all;
  const auto add = [&all](const quantities::Row& row, const model::Observable::Function& f) {
    all.push_back({quantities::blank(row), f});
  };
  const auto within = named("|x|<=mu_s"), stick = named("stick"), slide = named("slide");
  const double low = process.noise.level(process.lowest_static()),
               high = process.noise.level(process.highest_static());
  all.push_back({{}, [=](double x, double, double) { return x < low || x > high ? 1 : 0; }});
  if (question.wants(Quantity::sticking) || question.wants(Quantity::averages)) {
    add(catalogue::kPStick, stick);
    add(catalogue::kPSlide, slide);
  }
  if (question.wants(Quantity::moments)) {
    add(catalogue::kEV2, named("v^2"));
    add(catalogue::kEAbsV, named("|v|"));
    add(catalogue::kEXV, named("x*v"));
    if (process.drifts()) add(catalogue::kEV, named("v"));
  }
  if (question.wants(Quantity::noise_law)) {
    add(catalogue::kPWithin, within);
    add(catalogue::kEX2, named("x^2"));
  }
  if (!question.wants(Quantity::averages)) return all;
  for (const auto& observable : question.observables) {
    const auto f = observable.value;
    const auto append = [&](const quantities::Row& row, const model::Observable::Function& part,
                            int given) {
      all.push_back({quantities::blank(row, observable), part, given});
    };
    const auto within_phase = [f](const model::Observable::Function& in) {
      return [=](double x, double y, double v) { return f(x, y, v) * in(x, y, v); };
    };
    append(catalogue::kPi, f, -1);
    append(catalogue::kPiStick, within_phase(stick), kStick);
    append(catalogue::kPiSlide, within_phase(slide), kSlide);
  }
  add(catalogue::kFrictionPower, model::friction_power(process.friction).value);
  return all;
}

void append_averages(const Problem& problem, const std::vector<Uncertain>& values,
                     quantities::Results& results) {
  const auto all = averages(problem);
  const cases::Question& question = problem.given.question;
  const auto& process = problem.discretisation.process;
  const double beyond =
      model::noise_moments(process.noise, process.lowest_static(), process.highest_static()).beyond;
  const double defect = std::abs(values[kBeyond].value / beyond - 1);
  for (int n = kBeyond + 1; n < static_cast<int>(all.size()); ++n) {
    Uncertain value = values[n];
    const bool phase = all[n].result.kind == Kind::share;
    if (phase && !question.wants(Quantity::sticking)) continue;
    if (all[n].given >= 0) value = value / values[all[n].given];
    double share = std::abs(value.value);
    if (phase && n == kStick) share = std::min(share, std::abs(values[kSlide].value));
    value.error += defect * share;
    results.push_back(scalar(all[n].result, value));
  }
  if (question.wants(Quantity::moments) && !process.drifts()) {
    results.push_back(quantities::scalar(catalogue::kEV, 0, 0));  // by symmetry
  }
}

}  // namespace stickslip::routes
