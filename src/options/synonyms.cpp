#include "stickslip/options/synonyms.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "literal_table.hpp"
#include "quantities.hpp"
#include "stickslip/catalogue/entry.hpp"
#include "stickslip/effects/effect.hpp"
#include "stickslip/effects/model_options.hpp"
#include "stickslip/support/text.hpp"

namespace stickslip::options {
namespace {

// Option, its word, other names for it; without the model, which declares its own.
constexpr const char* kRows = R"(
quantities | - | q, compute, observables
omega | - | freq, frequency, frequencies
time | - | t, times
velocity | - | speed, speeds
observable | - | function, functions
accuracy | - | tol, tolerance, rtol, precision, eps, error, digits
start | - | x0, v0, initial, initial_state
route | - | method, solver, algorithm
excursions | - | samples, n_samples, trials, paths
horizon | - | duration, t_max, t_end, t_final
summary | - | json
output | - | o, out, h5, hdf5, save
compare | - | reference, check
options_file | - | config, input, file
help | - | h
quantities | sticking | stick, mean_durations
quantities | moments | variance, mean_square, energy
quantities | entry_law | hitting, entry, onset
quantities | density | pdf, stationary, distribution, invariant_measure, histogram
quantities | laplace | transform, transforms, laplace_transform
quantities | relaxation | eigenvalues, spectral_gap, gap, modes, relaxation_time
quantities | spectrum | psd, power, power_spectrum, power_spectral_density, spectral_density
quantities | duration_density | durations, survival, duration_distribution
quantities | autocorrelation | acf, vacf, correlation, autocovariance
quantities | slip | avalanche, slide_length
quantities | peak | first_passage, fpt, mfpt, passage, exit_time, largest_speed
quantities | displacement | msd, mean_square_displacement, diffusion
quantities | trajectory | path, sample_path, simulation
quantities | sensitivity | derivatives, gradient, gradients
route | monte_carlo | mc, simulation, simulate
scheme | hp | dg, fem, galerkin
scheme | upwind | finite_difference, fd
)";

// How options of PETSc's objects begin, and the prefixes of the solvers that have such an object.
constexpr const char* kFamilies = R"(
ksp_ | slide_
pc_ | slide_
sub_ | slide_
mat_mumps_ | slide_
eps_ | relax_, null_
st_ | relax_, null_
ts_ | backward_
snes_ | backward_
)";

const Synonyms* synonyms_of(const std::string& other, const std::string& option) {
  for (const auto& row : all_synonyms()) {
    const bool fits = option.empty() ? row.word.empty() : !row.word.empty() && row.option == option;
    if (fits && std::count(row.others.begin(), row.others.end(), other) > 0) return &row;
  }
  return nullptr;
}

// A name of PETSc with the prefixes that it lacks; empty if it is no such name.
std::string with_prefixes(const std::string& name) {
  for (const auto& row : rows_of(kFamilies, 2)) {
    if (!name.starts_with(row[0])) continue;
    auto prefixes = split(row[1], ',');
    for (auto& prefix : prefixes) prefix = fmt::format("-{}{}", prefix, name);
    return enumerate(prefixes, "or");
  }
  return "";
}

// The option that a name means, with its dash; empty if there is none.
std::string meant_option(const std::string& name) {
  std::string solver = with_prefixes(name);
  if (!solver.empty()) return solver;
  const Synonyms* row = synonyms_of(name, "");
  return row != nullptr ? "-" + row->option : nearest_word("-" + name, all_names());
}

// The same for a name and a value that are joined by an equals sign at `sign`.
std::string apart(const std::string& name, std::size_t sign) {
  const std::string before = name.substr(0, sign), after = name.substr(sign + 1);
  const std::string meant = find(before) != nullptr ? "-" + before : meant_option(before);
  return fmt::format("write {} {}", meant.empty() ? "-name" : meant,
                     after.empty() ? "value" : after);
}

}  // namespace

std::span<const Synonyms> all_synonyms() {
  static const auto all = [] {
    std::vector<Synonyms> rows;
    const auto add = [&rows](const Synonyms& row) {
      if (!row.others.empty()) rows.push_back(row);
    };
    for (const auto& option : effects::model_options()) {
      add({option.name, "", option.shown.others, option.shown.page});
    }
    for (const auto* choice : effects::choices()) {
      for (const auto* effect : choice->effects) {
        add({std::string(choice->option), std::string(effect->word), effect->others, ""});
      }
    }
    for (const auto& cells : rows_of(kRows, 3)) add({cells[0], cells[1], split(cells[2], ','), ""});
    return rows;
  }();
  return all;
}

std::string suggestion_for_option(const std::string& name) {
  if (const auto sign = name.find('='); sign != name.npos) return apart(name, sign);
  const std::string meant = meant_option(name);
  if (meant.empty()) return "-help lists all";
  const Synonyms* row = synonyms_of(name, "");
  const bool has_page = row != nullptr && !row->page.empty();
  return fmt::format("did you mean {}?{}", meant, has_page ? " See " + row->page : "");
}

std::string meant_word(const Option& option, const std::string& word) {
  if (const Synonyms* row = synonyms_of(word, option.name)) return row->word;
  const auto* quantity = option.name == "quantities" ? catalogue::entry_of(word) : nullptr;
  if (quantity != nullptr) return std::string(quantity->word);
  return nearest_word(word, option.words);
}

}  // namespace stickslip::options
