#include <fmt/format.h>

#include <algorithm>
#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <limits>
#include <optional>

#include "stickslip/catalogue/displacement_distribution_keys.hpp"
#include "stickslip/exact/fourier_inversion.hpp"
#include "stickslip/quantities/displacement_model.hpp"
#include "stickslip/quantities/durations.hpp"
#include "stickslip/quantities/plan.hpp"
#include "stickslip/simulation/flow.hpp"

namespace stickslip::quantities {
namespace {

using Inversion = exact::FourierInversion;
using model::Start;

/// A displacement that has a probability.
struct Atom {
  double at = 0;
  Uncertain probability = {};
};

// Of bodies at rest, by level that sticks: that the noise does not push them up to a time.
Uncertain still_at_rest(const model::Process& process, const std::vector<double>& rests,
                        double time) {
  double all = 0;
  std::vector<Uncertain> start;
  for (double p : rests) {
    start.push_back({p, 0});
    all += p;
  }
  if (all == 0) return {};
  const Uncertain left = stick_distribution(process, start, {time}).distribution[0];
  return {std::max(all - left.value, 0.0), left.error + 1e-15};
}

// Of a body on one level, which moves as long as the noise does not jump, and may come to rest.
Atom without_jumps(const model::Process& process, const Start& start, double time) {
  const int level = start.level, lowest = process.lowest_static();
  const bool holds = lowest <= level && level <= process.highest_static();
  const auto mirrored = process.mirrored();
  Atom atom;
  double speed = std::abs(start.v), now = 0;
  bool upwards = start.v != 0 ? start.v > 0 : process.net_force(level) > 0;
  for (bool slides = speed > 0 || !holds; slides && now < time;) {
    const model::Process& there = upwards ? process : mirrored;
    const double force = there.net_force(upwards ? level : -level);
    const auto piece = simulation::GeneralFlow(there.drag).move(speed, force, time - now, true);
    if (piece.time <= 0) break;
    atom.at += (upwards ? 1 : -1) * piece.path;
    now += piece.time;
    speed = piece.end;
    slides = !piece.stopped || !holds;
    if (piece.stopped) upwards = !upwards;
  }
  const double unmoved = std::exp(-process.noise.rate(level) * std::min(now, time));
  Uncertain rests{1, 0};
  if (holds && now < time) {
    std::vector<double> begins(static_cast<std::size_t>(process.highest_static() - lowest) + 1);
    begins[static_cast<std::size_t>(level - lowest)] = 1;
    rests = still_at_rest(process, begins, time - now);
  }
  atom.probability = unmoved * rests;
  return atom;
}

Atom atom_at(const Computation& computation, double time) {
  const auto& process = computation.process();
  const auto& start = computation.question().start;
  if (time == 0) return {0, {1, 0}};
  if (start.kind == Start::Kind::state) return without_jumps(process, start, time);
  if (!process.sticks()) return {};
  std::vector<double> rests;
  if (start.kind == Start::Kind::stationary) {
    const auto& excursion = computation.distribution().excursion();
    for (double t : excursion.stick_time) rests.push_back(t / excursion.mean_excursion());
  } else {
    const auto levels = model::stationary_distribution(process.noise);
    const auto first = levels.begin() + (process.lowest_static() - process.noise.lowest());
    rests.assign(first, first + (process.highest_static() - process.lowest_static() + 1));
  }
  return {0, still_at_rest(process, rests, time)};
}

/// The distribution at one time: an atom, and a density about it.
class Distribution {
 public:
  Distribution(const Computation& computation, double time, const Atom& atom) : atom_(atom) {
    const auto& question = computation.question();
    even_ = computation.process().symmetric() && question.start.kind != Start::Kind::state;
    if (time > 0) invert(computation, time);
  }

  [[nodiscard]] Uncertain density(double d) const {
    if (!inversion_) return {};
    const auto found = inversion_->density(d - atom_.at);
    return {found.value, found.error};
  }
  [[nodiscard]] Uncertain cdf(double d) const {
    if (even_ && d > 0) return Uncertain{1, 0} - cdf(-d);
    Uncertain below = continuous_below(d);
    if (d >= atom_.at) below = below + atom_.probability;
    return below;
  }
  // As far off as the quantiles of the probabilities that may be meant.
  [[nodiscard]] Uncertain quantile(double p) const {
    const auto [value, found] = inverse(p);
    const bool exact = even_ && p == 0.5;
    if (!found || exact) return {value, 0};
    const double doubt = cdf(value).error;
    return {value, std::max(std::abs(inverse(p + doubt).first - value),
                            std::abs(inverse(p - doubt).first - value))};
  }
  [[nodiscard]] int evaluations() const { return inversion_ ? inversion_->evaluations() : 0; }

 private:
  void invert(const Computation& computation, double time);

  [[nodiscard]] Uncertain continuous_below(double d) const {
    if (!inversion_) return {};
    const auto found = inversion_->below(d - atom_.at);
    return {found.value, found.error};
  }
  // And whether it had to be found.
  [[nodiscard]] std::pair<double, bool> inverse(double p) const {
    if (!inversion_ || (even_ && p == 0.5)) return {atom_.at, false};
    const double before = continuous_below(atom_.at).value;
    if (before < p && p <= before + atom_.probability.value) return {atom_.at, false};
    const bool above = p > before;
    const auto off = [&](double d) {
      return continuous_below(d).value + (above ? atom_.probability.value : 0) - p;
    };
    double low = above ? atom_.at : lowest_, high = above ? highest_ : atom_.at;
    if (off(low) >= 0) return {low, true};
    if (off(high) <= 0) return {high, true};
    constexpr double relative = 1e-12;
    const auto near = [&](double a, double b) { return std::abs(b - a) < relative * spread_; };
    std::uintmax_t steps = 200;
    const auto [a, b] = boost::math::tools::toms748_solve(off, low, high, near, steps);
    return {(a + b) / 2, true};
  }

  Atom atom_;
  bool even_ = false;
  std::optional<Inversion> inversion_;
  double spread_ = 0, lowest_ = 0, highest_ = 0;  // beyond which nothing is looked for
};

// phi without the atom, about it.
void Distribution::invert(const Computation& computation, double time) {
  const auto& question = computation.question();
  const double mass = 1 - atom_.probability.value;
  if (mass < 1e-14) return;
  DisplacementModel model(computation.systems, computation.distribution(), question.start, time,
                          0.1 * question.accuracy);
  const auto phi = [&](double k) -> Inversion::Transformed {
    const auto found = model.at(k);
    const auto rest = found.value * std::polar(1.0, -k * atom_.at) - atom_.probability.value;
    return {even_ ? rest.real() : rest, found.error + atom_.probability.error};
  };
  // Mean and deviation from small k.
  const double h = 0.1 / (model.speed() * time);
  const auto small = phi(h).value / mass;
  const double mean = even_ ? 0 : std::arg(small) / h;
  spread_ = std::sqrt(std::max(-2 * std::log(std::abs(small)), 1e-12)) / h;
  constexpr double furthest = 60;
  // An octave more for each digit.
  const double units = std::exp2(std::ceil(-std::log10(question.accuracy)));
  lowest_ = atom_.at + mean - furthest * spread_;
  highest_ = atom_.at + mean + furthest * spread_;
  inversion_.emplace(phi, mass, mean, spread_, even_,
                     Inversion::Limits{question.accuracy, units * 2 / spread_, 400});
}

void find_displacements(Computation& computation) {
  const auto& question = computation.question();
  const auto probabilities = question.values(catalogue::kProbability.option);
  auto& results = computation.results();
  Result probability = array(catalogue::kDisplacementAtom, question.time),
         position = array(catalogue::kDisplacementAtomAt, question.time);
  for (double t : question.time) {
    const Atom atom = atom_at(computation, t);
    const Distribution distribution(computation, t, atom);
    append_value(probability, atom.probability);
    append_value(position, {atom.at, 1e-11 * std::abs(atom.at)});
    const auto append = [&](const Row& row, const std::vector<double>& abscissa, auto of) {
      if (abscissa.empty()) return;
      Result result = array(row, abscissa);
      result.key = row.key_of(fmt::format("{}", t));
      for (double x : abscissa) append_value(result, (distribution.*of)(x));
      results.push_back(std::move(result));
    };
    append(catalogue::kDisplacementDensity, question.distance, &Distribution::density);
    append(catalogue::kDisplacementCdf, question.distance, &Distribution::cdf);
    append(catalogue::kDisplacementQuantile, probabilities, &Distribution::quantile);
    computation.report("displacement_wavenumbers", distribution.evaluations(),
                       "wavenumbers at which the characteristic function was found");
  }
  for (auto* result : {&probability, &position}) results.push_back(std::move(*result));
}

}  // namespace

void displacement_distribution_tasks(Planner& planner) {
  planner.need_distribution();
  const auto times = static_cast<int>(planner.question().time.size());
  planner.add_adaptive("distribution of displacements", 15 * times, 350 * times,
                       find_displacements);
}

}  // namespace stickslip::quantities
