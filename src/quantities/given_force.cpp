#include "stickslip/quantities/given_force.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "stickslip/case/force_rows.hpp"
#include "stickslip/simulation/response.hpp"

namespace stickslip::quantities {
namespace {

using simulation::Response;
using simulation::Slip;

constexpr double kUnit = std::numeric_limits<double>::epsilon();

// Forces, drag and spring by some units of rounding larger or smaller.
Response varied(model::Process process, model::ForceRecord record, double velocity, double sign) {
  const double of_drag = 1 + sign * (process.drag.is_linear() ? 4 * kUnit : 2e-14);
  process.drag.linear *= of_drag;
  process.drag.cubic *= of_drag;
  if (const auto law = process.drag.law) {
    process.drag.law = [law, of_drag](double v) { return of_drag * law(v); };
  }
  process.stiffness *= 1 + sign * 4 * kUnit;
  for (double& force : record.force) force *= 1 + sign * 4 * kUnit;
  return simulation::respond(process, record, velocity, 0.5);
}

// The same force with a sample more in each interval.
model::ForceRecord refined(const model::ForceRecord& given) {
  const auto finer = [](const std::vector<double>& samples, bool constant) {
    std::vector<double> fine;
    fine.reserve(2 * samples.size());
    for (std::size_t n = 0; n < samples.size(); ++n) {
      if (n > 0) {
        const double before = samples[n - 1];
        fine.push_back(constant ? before : std::midpoint(before, samples[n]));
      }
      fine.push_back(samples[n]);
    }
    return fine;
  };
  return {.time = finer(given.time, false),
          .force = finer(given.force, given.constant),
          .constant = given.constant,
          .load = finer(given.load, given.constant)};
}

Response on_refined(const model::Process& process, const model::ForceRecord& given,
                    double velocity) {
  Response found = varied(process, refined(given), velocity, 1);
  for (auto* path : {&found.v, &found.x}) {
    for (std::size_t n = 0; n < given.time.size(); ++n) (*path)[n] = (*path)[2 * n];
    path->resize(given.time.size());
  }
  return found;
}

/// A response, and two that differ from it by rounding.
class Compared {
 public:
  Compared(const model::Scene& scene, double velocity)
      : found_(simulation::respond(scene.followed(), *scene.force, velocity)),
        others_{on_refined(scene.followed(), *scene.force, velocity),
                varied(scene.followed(), *scene.force, velocity, -1)},
        alike_(std::ranges::all_of(others_, [&](const Response& other) {
          return other.slips.size() == found_.slips.size();
        })) {}

  [[nodiscard]] bool alike() const { return alike_; }
  [[nodiscard]] const Response& found() const { return found_; }

  /// A number that a function takes from each.
  template <class Part>
  void append(Result& result, const Part& part) const {
    const double value = part(found_);
    double error = 0;
    for (const auto& other : others_) error = std::max(error, std::abs(part(other) - value));
    result.value.push_back(value);
    result.error.push_back(2 * error + kUnit * std::abs(value));
  }
  /// A member of each slip.
  [[nodiscard]] Result of_slips(const Row& row, double Slip::*member) const {
    std::vector<double> numbers(found_.slips.size());
    std::iota(numbers.begin(), numbers.end(), 1.0);
    Result result = array(row, numbers);
    for (std::size_t n = 0; n < numbers.size(); ++n) {
      append(result, [&](const Response& r) {
        return alike_ ? r.slips[n].*member : &r == &found_ ? found_.slips[n].*member : kInfinity;
      });
    }
    return result;
  }
  /// Values at the samples.
  [[nodiscard]] Result of_path(const Row& row, const std::vector<double>& time,
                               std::vector<double> Response::*path) const {
    Result result = array(row, time);
    for (std::size_t n = 0; n < time.size(); ++n) {
      append(result, [&](const Response& r) { return (r.*path)[n]; });
    }
    return result;
  }

 private:
  Response found_;
  std::array<Response, 2> others_;
  bool alike_;
};

// What velocity, path and time are measured in where forces are in m/s^2.
std::string unit_in(const std::string& of_force, const std::string& unit) {
  if (unit == cases::kPathForce.unit) return of_force;
  if (unit == cases::kPathVelocity.unit) return "m/s";
  if (unit == cases::kPathDisplacement.unit) return "m";
  return unit.empty() ? unit : "s";
}

// The displacement of the last sample may cancel; that of the path shows how well it is known.
std::string shortfall(const Results& results, bool alike, double accuracy) {
  if (!alike) {
    return "the force comes so close to friction that rounding decides how often the body slips; "
           "change -force_scale or -mu_s by little to see what either does";
  }
  for (const auto& result : results) {
    if (result.key == cases::kFinalDisplacement.key) continue;
    if (relative_error(result) <= accuracy) continue;
    return fmt::format("rounding limits the relative error of {} to {:.1e}; take -accuracy {:.0e}",
                       result.key, relative_error(result), 2 * relative_error(result));
  }
  return "";
}

}  // namespace

std::string append_given_force(const model::Scene& scene, double accuracy, Results& results,
                               double velocity) {
  const Compared compared(scene, velocity);
  const auto& time = scene.force->time;
  const double duration = time.back() - time.front();
  Results own;
  const auto add = [&](const Row& row, const auto& part) {
    Result result = blank(row);
    compared.append(result, part);
    own.push_back(std::move(result));
  };
  add(cases::kFinalDisplacement, [](const Response& r) { return r.x.back(); });
  add(cases::kLargestDisplacement, [](const Response& r) { return r.farthest; });
  add(cases::kLargestSpeed, [](const Response& r) { return r.fastest; });
  add(cases::kSlidingShare, [&](const Response& r) { return r.sliding / duration; });
  add(cases::kSlipCount, [](const Response& r) { return static_cast<double>(r.slips.size()); });
  if (compared.alike()) own.back().error = {0};
  if (!compared.found().slips.empty()) {
    own.push_back(compared.of_slips(cases::kSlipBegin, &Slip::begin));
    own.push_back(compared.of_slips(cases::kSlipEnd, &Slip::end));
    own.push_back(compared.of_slips(cases::kSlipDisplacement, &Slip::displacement));
    own.push_back(compared.of_slips(cases::kSlipPeak, &Slip::peak));
  }
  own.push_back(array(cases::kPathForce, time));
  own.back().value = scene.force->force;
  own.back().error.assign(time.size(), 0.0);
  own.push_back(compared.of_path(cases::kPathVelocity, time, &Response::v));
  own.push_back(compared.of_path(cases::kPathDisplacement, time, &Response::x));
  if (!scene.force->unit.empty()) {
    for (auto& result : own) result.unit = unit_in(scene.force->unit, result.unit);
  }
  std::string missed = shortfall(own, compared.alike(), accuracy);
  std::ranges::move(own, std::back_inserter(results));
  return missed;
}

}  // namespace stickslip::quantities
