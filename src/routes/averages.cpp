#include "averages.hpp"

#include <cmath>

#include "stickslip/model/noise_chain.hpp"

namespace stickslip::routes {
namespace {

using options::Quantity;
using quantities::Kind;
using quantities::Uncertain;

Average average(const Setting& setting, const char* key, const char* unit, Kind kind,
                const char* f) {
  return {key, unit, kind, model::parse_observable(f, setting.discretisation.process.friction)};
}

}  // namespace

std::vector<Average> averages(const Setting& setting) {
  const options::Question& question = setting.given.question;
  std::vector<Average> all{average(setting, "P_X_gt_mu_s", "", Kind::probability, "1")};
  const auto within = model::parse_observable("|x|<=mu_s", setting.discretisation.process.friction);
  all[0].f.value = [within](double x, double y, double v) { return 1 - within(x, y, v); };
  const auto add = [&](const char* key, const char* unit, Kind kind, const char* f) {
    all.push_back(average(setting, key, unit, kind, f));
  };
  if (question.wants(Quantity::sticking)) {
    add("P_stick", "", Kind::share, "stick");
    add("P_slide", "", Kind::share, "slide");
  }
  if (question.wants(Quantity::moments)) {
    add("E_V2", "velocity^2", Kind::positive_mean, "v^2");
    add("E_absV", "velocity", Kind::mean, "|v|");
    add("E_XV", "force*velocity", Kind::mean, "x*v");
    if (!setting.discretisation.process.symmetric()) add("E_V", "velocity", Kind::drift, "v");
  }
  if (question.wants(Quantity::noise_law)) {
    add("P_X_le_mu_s", "", Kind::probability, "|x|<=mu_s");
    add("E_X2", "force^2", Kind::positive_mean, "x^2");
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
    if (all[n].key == "P_stick") share = std::min(share, std::abs(values[n + 1].value));
    results.push_back(quantities::scalar(all[n].key, all[n].unit, values[n].value,
                                         values[n].error + defect * share, all[n].kind));
  }
  if (setting.given.question.wants(Quantity::moments) &&
      setting.discretisation.process.symmetric()) {
    results.push_back(quantities::scalar("E_V", "velocity", 0, 0, Kind::drift));  // by symmetry
  }
}

}  // namespace stickslip::routes
