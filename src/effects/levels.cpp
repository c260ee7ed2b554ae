#include "levels.hpp"

#include <fmt/format.h>

#include <exception>
#include <memory>
#include <new>
#include <stdexcept>

namespace stickslip::effects {

bool make_levels(Given& given, model::Scene& scene, const char* option, const char* fix) {
  if (!given.sound()) return false;
  try {
    make_noise_levels(scene);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& unfit) {  // files have errors of their own
    given.refuse(option, unfit.what(), fix);
  }
  return scene.noise.table != nullptr;
}

States sum(const States& a, const States& b) {
  const std::size_t count = b.x.size();
  require_number_of_states(static_cast<double>(a.x.size()) * static_cast<double>(count));
  States all;
  for (double x : a.x) {
    for (double y : b.x) all.x.push_back(x + y);
  }
  for (const auto& [from, to, rate] : a.transitions) {
    for (std::size_t m = 0; m < count; ++m) {
      all.transitions.push_back({from * count + m, to * count + m, rate});
    }
  }
  for (std::size_t n = 0; n < a.x.size(); ++n) {
    for (const auto& [from, to, rate] : b.transitions) {
      all.transitions.push_back({n * count + from, n * count + to, rate});
    }
  }
  return all;
}

void require_number_of_states(double count) {
  constexpr double most = 4000;  // of which factors take more than ten gigabytes
  if (count <= most) return;
  throw std::invalid_argument(
      fmt::format("gives a chain of {:.0f} states, and at most {:g} are taken", count, most));
}

}  // namespace stickslip::effects
