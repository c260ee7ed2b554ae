#include "stickslip/catalogue/solution_method.hpp"

#include <cstddef>

namespace stickslip::catalogue {
namespace {

// In the order of Route.
constexpr SolutionMethod kMethods[] = {
    {.route = Route::excursion,
     .word = "excursion",
     .sentence = "one transposed solve gives the stationary distribution. The others check it",
     .needs_sticking = false,
     .bounds_speed = true,
     .closed_noise_law = true},
    {.route = Route::lambda,
     .word = "lambda",
     .sentence = "lambda u_lambda for small lambda",
     .limit = "lambda u_lambda tends to stationary averages as lambda -> 0, and gives nothing else",
     .full_grid = true,
     .small_lambda = true},
    {.route = Route::hitting,
     .word = "hitting",
     .sentence = "mean hitting times",
     .limit = "mean hitting times give mean durations, and nothing else",
     .full_grid = true},
    {.route = Route::null_vector,
     .word = "null_vector",
     .sentence = "left null vector of the generator",
     .limit = "the left null vector of the generator is the stationary distribution, and gives its "
              "averages alone",
     .full_grid = true,
     .needs_sticking = false},
    {.route = Route::fluid_queue,
     .word = "fluid_queue",
     .sentence = "b = 0",
     .limit = "the fluid queue gives the hitting distribution, durations and the moments of V up "
              "to the second",
     .without_drag = "only then is it a fluid queue",
     .discretises_velocity = false},
    {.route = Route::monte_carlo,
     .word = "monte_carlo",
     .synonyms = "mc, simulation, simulate",
     .sentence = "simulation",
     .limit = "a sample has no eigenvalues, no derivatives, and no density at a point (take "
              "averages of indicator functions such as abs(v)>0.5)",
     .discretises_velocity = false,
     .simulates = true}};

}  // namespace

std::span<const SolutionMethod> solution_methods() { return kMethods; }

const SolutionMethod& method_of(Route route) { return kMethods[static_cast<std::size_t>(route)]; }

const SolutionMethod& method_of(std::string_view word) {
  for (const auto& method : kMethods) {
    if (method.word == word) return method;
  }
  return kMethods[0];
}

}  // namespace stickslip::catalogue
