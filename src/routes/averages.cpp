#include "averages.hpp"

#include <cmath>

#include "stickslip/model/noise_chain.hpp"

namespace stickslip::routes {
namespace {

using options::Quantity;
using quantities::Kind;
using quantities::Uncertain;

Average average(const Setting& setting, const quantities::Name& name, const char* f) {
  return {name, model::parse_observable(f, setting.discretisation.process.friction)};
}

}  // namespace

std::vector<Average> averages(const Setting& setting) {
  const options::Question& question = setting.given.question;
  std::vector<Average> all{average(setting, {"P_X_gt_mu_s", ""}, "1")};
  const auto within = model::parse_observable("|x|<=mu_s", setting.discretisation.process.friction);
  all[0].f.value = [within](double x, double y, double v) { return 1 - within(x, y, v); };
  const auto add = [&](const quantities::Name& name, const char* f) {
    all.push_back(average(setting, name, f));
  };
  if (question.wants(Quantity::sticking)) {
    add(quantities::kPStick, "stick");
    add(quantities::kPSlide, "slide");
  }
  if (question.wants(Quantity::moments)) {
    add(quantities::kEV2, "v^2");
    add(quantities::kEAbsV, "|v|");
    add(quantities::kEXV, "x*v");
    if (!setting.discretisation.process.symmetric()) add(quantities::kEV, "v");
  }
  if (question.wants(Quantity::noise_law)) {
    add(quantities::kPWithin, "|x|<=mu_s");
    add(quantities::kEX2, "x^2");
  }
  return all;
}

void append_averages(const Setting& setting, const std::vector<Uncertain>& values,
                     quantities::Results& results) {
  const auto all = averages(setting);
  const int k = setting.discretisation.process.threshold_index();
  const double beyond = model::noise_moments(setting.discretisation.process.noise, k).beyond;
  const double defect = std::abs(values[0].value / beyond - 1);
  for (std::size_t n = 1; n < all.size(); ++n) {
    double share = std::abs(values[n].value);
    const bool first_share = all[n].name.kind == Kind::share && n + 1 < all.size() &&
                             all[n + 1].name.kind == Kind::share;
    if (first_share) share = std::min(share, std::abs(values[n + 1].value));
    results.push_back(
        quantities::scalar(all[n].name, values[n].value, values[n].error + defect * share));
  }
  if (setting.given.question.wants(Quantity::moments) &&
      setting.discretisation.process.symmetric()) {
    results.push_back(quantities::scalar(quantities::kEV, 0, 0));  // by symmetry
  }
}

}  // namespace stickslip::routes
