#include "averages.hpp"

#include <algorithm>
#include <cmath>

#include "stickslip/model/noise_chain.hpp"

namespace stickslip::routes {
namespace {

using options::Quantity;
using quantities::Kind;
using quantities::Uncertain;

// Numbers of those that are not always results; those of the phases are there for others, too.
constexpr int kBeyond = 0, kStick = 1, kSlide = 2;

}  // namespace

std::vector<Average> averages(const Setting& setting) {
  const options::Question& question = setting.given.question;
  const auto& process = setting.discretisation.process;
  const auto named = [&](const char* f) {
    return model::parse_observable(f, process.friction).value;
  };
  std::vector<Average> all;
  const auto add = [&all](const quantities::Name& name, const model::Observable::Function& f) {
    all.push_back({name.key, name.kind, f});
  };
  const auto within = named("|x|<=mu_s"), stick = named("stick"), slide = named("slide");
  const double low = process.noise.level(process.lowest_static()),
               high = process.noise.level(process.static_index());
  add({"P_moving_levels"}, [=](double x, double, double) { return x < low || x > high ? 1 : 0; });
  if (question.wants(Quantity::sticking) || question.wants(Quantity::averages)) {
    add(quantities::kPStick, stick);
    add(quantities::kPSlide, slide);
  }
  if (question.wants(Quantity::moments)) {
    add(quantities::kEV2, named("v^2"));
    add(quantities::kEAbsV, named("|v|"));
    add(quantities::kEXV, named("x*v"));
    if (process.drifts()) add(quantities::kEV, named("v"));
  }
  if (question.wants(Quantity::noise_law)) {
    add(quantities::kPWithin, within);
    add(quantities::kEX2, named("x^2"));
  }
  if (!question.wants(Quantity::averages)) return all;
  for (const auto& observable : question.observables) {
    const auto f = observable.value;
    const Kind kind = observable.within_unit() ? Kind::probability : Kind::drift;
    const auto given = [&](const char* phase, const model::Observable::Function& in, int number) {
      const auto part = [=](double x, double y, double v) { return f(x, y, v) * in(x, y, v); };
      all.push_back({"pi(" + observable.name + phase + ")", kind, part, number});
    };
    all.push_back({"pi(" + observable.name + ")", kind, f});
    given("|stick", stick, kStick);
    given("|slide", slide, kSlide);
  }
  add(quantities::kFrictionPower, model::friction_power(process.friction).value);
  return all;
}

void append_averages(const Setting& setting, const std::vector<Uncertain>& values,
                     quantities::Results& results) {
  const auto all = averages(setting);
  const options::Question& question = setting.given.question;
  const auto& process = setting.discretisation.process;
  const double beyond =
      model::noise_moments(process.noise, process.lowest_static(), process.static_index()).beyond;
  const double defect = std::abs(values[kBeyond].value / beyond - 1);
  for (int n = kBeyond + 1; n < static_cast<int>(all.size()); ++n) {
    Uncertain value = values[n];
    const bool phase = all[n].kind == Kind::share;
    if (phase && !question.wants(Quantity::sticking)) continue;
    if (all[n].given >= 0) value = value / values[all[n].given];
    double share = std::abs(value.value);
    if (phase && n == kStick) share = std::min(share, std::abs(values[kSlide].value));
    value.error += defect * share;
    results.push_back(scalar({all[n].key.c_str(), all[n].kind}, value));
  }
  if (question.wants(Quantity::moments) && !process.drifts()) {
    results.push_back(quantities::scalar(quantities::kEV, 0, 0));  // by symmetry
  }
}

}  // namespace stickslip::routes
