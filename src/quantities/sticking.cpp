#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <numeric>
#include <set>
#include <span>
#include <string>

#include "stickslip/case/sticking_rows.hpp"
#include "stickslip/generator/static_chain.hpp"
#include "stickslip/linalg/dense.hpp"
#include "stickslip/linalg/petsc.hpp"
#include "stickslip/linalg/vectors.hpp"
#include "stickslip/quantities/engines/excursions.hpp"
#include "stickslip/quantities/excursion.hpp"
#include "stickslip/quantities/plan.hpp"

namespace stickslip::quantities {
namespace {

using generator::KolmogorovOperator;
using generator::Symmetry;

double sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

// Probabilities of the places of a Markov chain. Where a body never rests on some static levels,
// starts that are reached from these alone have none; those from which the fewest places are
// reached are taken for ever.
std::vector<double> shares_of(int count, const std::vector<linalg::RateElimination::Rate>& steps) {
  std::vector<model::Transition> taken;
  for (const auto& [from, to, p] : steps) {
    if (p > 0) taken.push_back({static_cast<std::size_t>(from), static_cast<std::size_t>(to), p});
  }
  const auto size = static_cast<std::size_t>(count);
  std::vector<bool> recurs;
  for (std::size_t first = 0; first < size; ++first) {
    auto reached = model::reached_from(first, size, taken);
    const bool fewer = std::ranges::count(reached, true) < std::ranges::count(recurs, true);
    if (first == 0 || fewer) recurs = std::move(reached);
  }
  std::vector<int> place(size, -1);
  int places = 0;
  for (std::size_t n = 0; n < size; ++n) place[n] = recurs[n] ? places++ : -1;
  std::vector<linalg::RateElimination::Rate> among;
  for (const auto& [from, to, p] : steps) {
    if (recurs[from] && recurs[to]) among.push_back({place[from], place[to], p});
  }
  const std::vector<double> none(static_cast<std::size_t>(places), 0.0);
  const auto known = linalg::RateElimination(none, among).stationary();
  std::vector<double> shares(size, 0.0);
  for (std::size_t n = 0; n < size; ++n) shares[n] = recurs[n] ? known[place[n]] : 0;
  return shares;
}

// What the spring adds: sums over all nodes, in motion on either branch and at rest.
void append_positions(const model::Process& process, const Excursion& excursion, Results& results) {
  double p = 0, square = 0, with_noise = 0;
  const auto add = [&](const model::NoiseChain& chain, int i, double sign, double time) {
    const double position = chain.position(i);
    p += sign * position * time;
    square += position * position * time;
    with_noise += chain.noise(i) * position * time;
  };
  const auto other = process.mirrored().noise;
  const auto count = static_cast<std::size_t>(process.noise.count());
  for (std::size_t n = 0; n < excursion.slide_time.size(); ++n) {
    const bool upper = n < count;
    const auto& chain = upper ? process.noise : other;
    add(chain, chain.lowest() + static_cast<int>(n % count), upper ? 1 : -1,
        excursion.slide_time[n]);
  }
  for (std::size_t n = 0; n < excursion.stick_time.size(); ++n) {
    add(process.noise, process.lowest_static() + static_cast<int>(n), 1, excursion.stick_time[n]);
  }
  const double total = excursion.mean_excursion();
  // A bias leaves the process its symmetry, about g/K.
  const auto& noise = process.noise;
  const bool centred = noise.position(noise.lowest()) == -noise.position(noise.highest());
  results.push_back(scalar(cases::kEP, process.drifts() || !centred ? p / total : 0, 0));
  results.push_back(scalar(cases::kEP2, square / total, 0));
  results.push_back(scalar(cases::kEXP, with_noise / total, 0));
}

// Of the noise alone, which nodes of one level and several positions share.
model::NoiseMoments moments_of_pairs(const model::NoiseChain& noise, double mu_s) {
  const auto p = model::stationary_distribution(noise);
  model::NoiseMoments moments{0, 0, 0};
  for (int i = noise.lowest(); i <= noise.highest(); ++i) {
    const double x = noise.noise(i), share = p[static_cast<std::size_t>(i - noise.lowest())];
    (std::abs(x) <= mu_s ? moments.within : moments.beyond) += share;
    moments.square += share * x * x;
  }
  return moments;
}

/// Integrals of f over an excursion.
struct Integral {
  Uncertain stick, slide;
};

// Rounding is the effect of iterative refinement, and the defect of an exact identity, relative to
// the size of what is summed.
Integral integral(const StationaryDistribution& distribution, double defect,
                  const KolmogorovOperator& a, const model::Observable& f) {
  const auto& process = distribution.process();
  const auto part = generator::part_with_mean(f, process);
  Integral sum;
  const auto &now = distribution.excursion().stick_time,
             &before = distribution.uncorrected().stick_time;
  const bool averaged = f.formula != nullptr;
  const auto values =
      process.noise.values([&](const model::Place& x) { return part(x, 0, 0); }, averaged);
  double change = 0, size = 0;
  for (std::size_t n = 0; n < now.size(); ++n) {
    const int level = process.lowest_static() + static_cast<int>(n);
    const double at_rest = values[level - process.noise.lowest()];
    sum.stick.value += now[n] * at_rest;
    change += (now[n] - before[n]) * at_rest;
    size += now[n] * std::abs(at_rest);
  }
  sum.stick.error = std::abs(change) + defect * size;
  const linalg::VecHandle sliding = a.values(part, averaged);
  sum.slide.value = linalg::dot(sliding, distribution.occupation());
  sum.slide.error =
      std::abs(sum.slide.value - linalg::dot(sliding, distribution.uncorrected_occupation())) +
      defect * linalg::norm(linalg::product(sliding, distribution.occupation()), NORM_1);
  if (!f.quadratic) {
    sum.slide.error += std::abs(linalg::dot(a.overlooked(part), distribution.occupation()));
  }
  return sum;
}

}  // namespace

double Excursion::mean_slide() const { return sum(slide_time); }
double Excursion::mean_stick() const { return sum(stick_time); }
double Excursion::mean_excursion() const { return mean_slide() + mean_stick(); }

double Excursion::mean_drift(const generator::Nodes& noise) const {
  const auto half = slide_distance.begin() + noise.count();
  if (half == slide_distance.end()) return 0;
  return std::accumulate(slide_distance.begin(), half, 0.0) -
         std::accumulate(half, slide_distance.end(), 0.0);
}

double Excursion::conservation_defect(const generator::Discretisation& discretisation) const {
  const auto& [process, noise, velocities] = discretisation;
  if (process.noise.has_positions()) {
    // E[P V] = 0, as p^2 is represented.
    const model::Process sides[] = {process, process.mirrored()};
    double sum = 0, size = 0;
    for (std::size_t n = 0; n < slide_distance.size(); ++n) {
      const int place = static_cast<int>(n), count = noise->count();
      const auto& chain = sides[place < count ? 0 : 1].noise;
      const double part = chain.position(chain.lowest() + place % count) * slide_distance[n];
      sum += part;
      size += std::abs(part);
    }
    return std::abs(sum) / size + lost_probability * lost_probability;
  }
  if (!process.sticks()) {
    const auto seen = marginal_of_noise(discretisation, *this),
               exact = model::stationary_distribution(process.noise);
    return std::transform_reduce(seen.begin(), seen.end(), exact.begin(), 0.0, std::plus<>(),
                                 [](double p, double q) { return std::abs(p - q); });
  }
  const int highest = noise->last_up_to(process.highest_static()),
            lowest = -noise->mirrored().last_up_to(-process.lowest_static());
  double beyond = 0;
  for (std::size_t n = 0; n < slide_time.size(); ++n) {
    const int place = static_cast<int>(n), count = noise->count();
    const int node = place < count ? noise->first() + place : noise->last() - (place - count);
    if (node < lowest || node > highest) beyond += slide_time[n];
  }
  const auto moments =
      model::noise_moments(process.noise, process.lowest_static(), process.highest_static());
  return std::abs(beyond / (moments.beyond * mean_excursion()) - 1) +
         lost_probability * lost_probability;
}

Starts Starts::upwards(const model::Process& process) {
  return {{process.exit_level(true)}, {1}, {1}};
}

Starts chain_of_starts(const model::Process& process, std::vector<int> levels,
                       const std::vector<Excursion>& from) {
  const auto sticking = generator::StaticChain::of(process);
  const auto count = static_cast<int>(levels.size());
  Starts starts{std::move(levels), {}, std::vector<double>(from.size() * from.size())};
  std::vector<linalg::RateElimination::Rate> steps;
  for (int u = 0; u < count; ++u) {
    const auto exit = sticking.exit_transform_to(starts.levels[u]);
    for (int t = 0; t < count; ++t) {
      const auto& entry = from[t].entry;
      const double p = std::inner_product(entry.begin(), entry.end(), exit.begin(), 0.0);
      starts.next[t * count + u] = p;
      if (t != u) steps.push_back({t, u, p});
    }
  }
  starts.shares = shares_of(count, steps);
  return starts;
}

Excursion joined(const model::Process& process, const Starts& starts,
                 const std::vector<Excursion>& from) {
  const auto mean = [&](std::vector<double> Excursion::*member, const auto& counts) {
    std::vector<double> all((from[0].*member).size(), 0.0);
    double weight = 0;
    for (std::size_t t = 0; t < from.size(); ++t) weight += counts(t) ? starts.shares[t] : 0;
    for (std::size_t t = 0; t < from.size(); ++t) {
      if (!counts(t)) continue;
      for (std::size_t n = 0; n < all.size(); ++n) {
        all[n] += starts.shares[t] / weight * (from[t].*member)[n];
      }
    }
    return all;
  };
  const auto upwards = [&](std::size_t t) { return starts.levels[t] > process.highest_static(); };
  Excursion all;
  for (auto member : {&Excursion::slide_time, &Excursion::slide_distance, &Excursion::slide_square,
                      &Excursion::entry, &Excursion::stick_time}) {
    all.*member = mean(member, [](std::size_t) { return true; });
  }
  all.entry_plus = mean(&Excursion::entry, upwards);
  all.entry_minus = mean(&Excursion::entry, [&](std::size_t t) { return !upwards(t); });
  for (std::size_t t = 0; t < from.size(); ++t) {
    all.lost_probability += starts.shares[t] * std::abs(from[t].lost_probability);
  }
  return all;
}

void append_sticking(const Excursion& excursion, Results& results) {
  const double slide = excursion.mean_slide(), stick = excursion.mean_stick();
  const double total = excursion.mean_excursion();
  results.push_back(scalar(cases::kPStick, stick / total, 0));
  results.push_back(scalar(cases::kPSlide, slide / total, 0));
  results.push_back(scalar(cases::kMeanStick, stick, 0));
  results.push_back(scalar(cases::kMeanSlide, slide, 0));
  results.push_back(scalar(cases::kMeanExcursion, total, 0));
}

void sticking_tasks(Planner& planner) {
  planner.append_from([](const auto&, const Excursion& excursion, Results& results) {
    append_sticking(excursion, results);
  });
}

void append_moments(const generator::Discretisation& discretisation, const Excursion& excursion,
                    Results& results) {
  const double total = excursion.mean_excursion();
  const auto& noise = *discretisation.noise;
  const auto& distance = excursion.slide_distance;
  double force_times_velocity = 0;
  std::size_t place = 0;
  for (const auto* along : {&noise, &noise.mirrored()}) {
    for (int n = along->first(); n <= along->last() && place < distance.size(); ++n) {
      force_times_velocity += along->x(n) * distance[place++];
    }
  }
  results.push_back(scalar(cases::kEV2, sum(excursion.slide_square) / total, 0));
  results.push_back(scalar(cases::kEAbsV, sum(excursion.slide_distance) / total, 0));
  results.push_back(scalar(cases::kEXV, force_times_velocity / total, 0));
  // A difference of the two velocity branches: exact to the size of E|V|.
  const bool drifts =
      discretisation.process.drifts() && !discretisation.process.noise.has_positions();
  const double rounding = excursion.conservation_defect(discretisation) * sum(distance);
  results.push_back(scalar(cases::kEV, drifts ? excursion.mean_drift(noise) / total : 0,
                           drifts ? rounding / total : 0));
}

void moments_tasks(Planner& planner) {
  planner.append_from([](const auto& discretisation, const Excursion& excursion, Results& results) {
    append_moments(discretisation, excursion, results);
    if (discretisation.process.noise.has_positions()) {
      append_positions(discretisation.process, excursion, results);
    }
  });
}

void append_hitting_distribution(const model::Process& process, const Excursion& excursion,
                                 Results& results) {
  std::vector<double> levels;
  for (int i = process.lowest_static(); i <= process.highest_static(); ++i) levels.push_back(i);
  const auto append = [&](const Row& row, const std::vector<double>& entry) {
    Result distribution = array(row, levels);
    distribution.value = entry;
    distribution.error.assign(entry.size(), 0.0);
    results.push_back(std::move(distribution));
  };
  append(cases::kEntryLawPlus, excursion.entry_plus);
  if (!excursion.entry_minus.empty()) append(cases::kEntryLawMinus, excursion.entry_minus);
  results.push_back(scalar(cases::kFStick0, stick_density_at_zero(process, excursion.entry), 0));
}

void entry_law_tasks(Planner& planner) {
  planner.need_distribution();
  Task task{"hitting distribution (entry_law)"};
  if (planner.symmetric()) task.uses = {{{0, generator::Symmetry::odd}, 0, 1}};
  task.carry_out = [](Computation& computation) {
    computation.found.distribution->orient(computation.systems);
    const auto append = [](const auto& discretisation, const auto& excursion, Results& results) {
      append_hitting_distribution(discretisation.process, excursion, results);
    };
    computation.distribution().append_from(append, computation.results());
  };
  planner.add(std::move(task));
}

double stick_density_at_zero(const model::Process& process, const std::vector<double>& entry) {
  const auto rates = process.exit_rates();
  return std::inner_product(rates.begin(), rates.end(), entry.begin(), 0.0);
}

void append_noise_distribution(const model::Process& process, Results& results) {
  const auto& noise = process.noise;
  const double mu_s = process.friction.mu_s;
  if (noise.continuous()) {
    const double sigma = noise.standard_deviation(),
                 within = std::erf(mu_s / sigma / std::numbers::sqrt2);
    results.push_back(
        scalar(cases::kPWithin, within, std::numeric_limits<double>::epsilon() * within));
    results.push_back(
        scalar(cases::kEX2, sigma * sigma, std::numeric_limits<double>::epsilon() * sigma * sigma));
    return;
  }
  const auto moments = noise.has_positions() ? moments_of_pairs(noise, mu_s)
                                             : model::noise_moments(noise, noise.first_from(-mu_s),
                                                                    noise.last_up_to(mu_s));
  const double rounding = model::rounding_of_sums(noise);
  results.push_back(scalar(cases::kPWithin, moments.within, rounding * moments.within));
  results.push_back(scalar(cases::kEX2, moments.square, rounding * moments.square));
}

void leave_out_missing_side(const model::Process& process, Results& results) {
  static const std::set<std::string> of_plus{"entry_law", "h_plus", "h_minus", "w_one",
                                             "w_plus",    "u",      "mu"},
      of_minus{"entry_law_minus",  "h_plus_from_minus", "h_minus_from_minus",
               "w_one_from_minus", "w_minus",           "u_minus",
               "mu_minus"};
  std::erase_if(results, [&](const Result& result) {
    const std::string word = result.key.substr(0, result.key.find('('));
    return (!process.starts_upwards() && of_plus.contains(word)) ||
           (!process.starts_downwards() && of_minus.contains(word));
  });
}

void leave_out_uncountable(const model::Process& process, Results& results) {
  if (!process.noise.has_levels()) {
    std::erase_if(results, [](const Result& result) { return result.key == cases::kFStick0.key; });
  }
  if (!process.starts_at_balance()) return;
  static const std::set<std::string> durations{"mean_stick", "mean_slide", "mean_excursion"};
  std::erase_if(results, [](const Result& result) { return durations.contains(result.key); });
}

std::vector<double> marginal_of_noise(const generator::Discretisation& discretisation,
                                      const Excursion& excursion) {
  const auto& [process, noise, velocities] = discretisation;
  const std::span all(excursion.slide_time);
  const auto nodes = static_cast<std::size_t>(noise->count());
  const bool one_branch = all.size() == nodes;
  auto time = noise->spread(all.first(nodes));
  const int lowest = process.lowest_static() - process.noise.lowest();
  for (std::size_t k = 0; k < excursion.stick_time.size(); ++k) {
    time[lowest + k] += excursion.stick_time[k];
  }
  const auto other = one_branch ? time : noise->mirrored().spread(all.last(nodes));
  const std::vector<double> below(other.rbegin(), other.rend());
  for (std::size_t i = 0; i < time.size(); ++i) {
    time[i] = (time[i] + below[i]) / ((one_branch ? 2 : 1) * excursion.mean_excursion());
  }
  return time;
}

void append_averages(const StationaryDistribution& distribution, const KolmogorovOperator& a,
                     const std::vector<model::Observable>& observables, Results& results) {
  const double defect = distribution.excursion().conservation_defect(distribution.discretisation());
  const auto mean = [&](double (Excursion::*time)() const) {
    const double value = (distribution.excursion().*time)();
    return Uncertain{value,
                     std::abs(value - (distribution.uncorrected().*time)()) + defect * value};
  };
  const Uncertain stick = mean(&Excursion::mean_stick), slide = mean(&Excursion::mean_slide),
                  excursion = mean(&Excursion::mean_excursion);
  for (const auto& f : observables) {
    const Integral sum = integral(distribution, defect, a, f);
    const auto append = [&](const Row& row, Uncertain value) {
      results.push_back(scalar(blank(row, f), value));
    };
    append(cases::kPi, (sum.stick + sum.slide) / excursion);
    if (!distribution.process().sticks()) continue;
    append(cases::kPiStick, sum.stick / stick);
    append(cases::kPiSlide, sum.slide / slide);
  }
  const Integral power =
      integral(distribution, defect, a, model::friction_power(distribution.process().friction));
  results.push_back(scalar(cases::kFrictionPower, power.slide / excursion));
  if (distribution.process().sticks()) {
    results.push_back(scalar(cases::kSlipRate, Uncertain{1, 0} / excursion));
  }
}

void averages_tasks(Planner& planner) {
  planner.need_distribution();
  const auto system = planner.system();
  planner.add({"averages", {{system, 0, 0}}, [system](Computation& computation) {
                 append_averages(computation.distribution(), computation.systems.at(system).a(),
                                 computation.question().observables, computation.results());
               }});
}

}  // namespace stickslip::quantities
