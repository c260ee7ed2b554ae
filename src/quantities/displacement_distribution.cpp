#include <boost/math/tools/roots.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "engines/displacement_model.hpp"
#include "stickslip/base/text.hpp"
#include "stickslip/case/displacement_rows.hpp"
#include "stickslip/model/process.hpp"
#include "stickslip/quantities/durations.hpp"
#include "stickslip/quantities/engines/inversion.hpp"
#include "stickslip/quantities/plan.hpp"
#include "stickslip/simulation/flow.hpp"

namespace stickslip::quantities {
namespace {

using model::Start;
using Complex = std::complex<double>;

// Logarithm of probabilities that nobody looks for.
constexpr double kNothing = -32;
constexpr double kWithin = 2;  // deviations beyond the mean of the last weight

// Small probabilities of displacements.

/// A displacement that has a probability.
struct Atom {
  double at = 0;
  Uncertain probability = {};
};

/// The distribution of x(t) on one side of its mean, without atoms, with relative errors, down to
/// probabilities of 1e-14: by inversion with paths weighted with exp(s x). Weights that rise by 1.2
/// in units of the deviation, one after the other, have their means further and further out. The
/// two whose means are next to d both give P, and their difference is part of the error. A weight
/// costs a dozen wavenumbers, and some 12 more where it is used.
class DisplacementTail {
 public:
  /// Above the mean (side 1) or below it (side -1), for mass, mean and standard deviation of what
  /// is no atom. The computation must live as long. Local.
  DisplacementTail(const Computation& computation, double time, std::vector<Atom> atoms, int side,
                   double mass, double mean, double deviation)
      : computation_(computation), time_(time), atoms_(std::move(atoms)), side_(side) {
    weights_.push_back({0, std::log(mass), mean, deviation});
  }

  /// The probability of what lies beyond d; where that is too small, 0 with a bound of it as error.
  /// Collective. Throws NotReached or NoMemory.
  [[nodiscard]] Uncertain beyond(double d) { return at(d, &TailInversion::beyond); }
  /// The density there. Collective. Throws NotReached or NoMemory.
  [[nodiscard]] Uncertain density(double d) { return at(d, &TailInversion::density); }
  /// A displacement beyond which there is less than a probability p, if there is one within reach.
  /// Collective. Throws NotReached or NoMemory.
  [[nodiscard]] double end(double p) {
    const auto beyond_last = [&] {
      const Weight& last = weights_.back();
      return last.log_size - last.s * last.mean -
             std::log1p(2.5 * std::abs(last.s) * last.deviation);
    };
    while ((weights_.size() < 3 || beyond_last() > std::log(p)) && add_weight()) {
    }
    return weights_.back().mean + side_ * kWithin * weights_.back().deviation;
  }
  [[nodiscard]] int evaluations() const {
    int all = 0;
    for (const Weight& weight : weights_) {
      if (weight.model) all += 2;
      if (weight.inversion) all += weight.inversion->evaluations();
    }
    return all;
  }

 private:
  /// A weight exp(s x), with log E exp(s x), and mean and deviation of what is weighted.
  struct Weight {
    double s = 0, log_size = 0, mean = 0, deviation = 0;
    double scaled = 1, doubt = 0;  // the size in units of the model, and its relative error
    std::unique_ptr<DisplacementModel> model = {};
    std::optional<TailInversion> inversion = {};
  };
  using OfInversion = Uncertain (TailInversion::*)(double) const;

  // The part without atoms of E exp((s + i k) x), in units of what its model gives.
  [[nodiscard]] FourierInversion::Transformed transform(const Weight& of, double k) const {
    const auto found = of.model->at(k);
    const double growth = (of.log_size - std::log(of.scaled)) / time_;
    Complex value = found.value;
    double error = found.error;
    for (const Atom& atom : atoms_) {
      const double size = std::exp(of.s * atom.at - growth * time_);
      value -= std::polar(size * atom.probability.value, k * atom.at);
      error += size * atom.probability.error;
    }
    return {value / of.scaled, error / of.scaled};
  }

  // False where all has been reached.
  bool add_weight() {
    constexpr double first = 1.5, further = 1.2, probe = 0.5;
    constexpr std::size_t most = 14;
    const Weight& last = weights_.back();
    if (ended_) return false;
    const auto& question = computation_.question();
    // Cumulants of the last one predict the next.
    const double ds = side_ * (weights_.size() == 1 ? first : further) / last.deviation,
                 square = last.deviation * last.deviation;
    Weight next;
    next.s = last.s + ds;
    next.log_size = last.log_size + ds * last.mean + ds * ds * square / 2;
    next.model = std::make_unique<DisplacementModel>(
        computation_.systems, computation_.distribution(), question.start, time_,
        0.1 * question.accuracy, Tilt{next.s, next.log_size / time_});
    ended_ = !next.model->resolved();
    if (ended_) return false;
    const auto size = transform(next, 0);
    ended_ = !(size.value.real() > 2 * size.error);
    if (ended_) return false;
    next.scaled = size.value.real();
    next.doubt = size.error / next.scaled;
    next.log_size += std::log(next.scaled);
    const double expected = last.mean + ds * square, k = probe / last.deviation;
    const Complex turned = transform(next, k).value * std::polar(1.0, -k * expected);
    next.mean = expected + std::arg(turned) / k;
    next.deviation = std::sqrt(std::max(-2 * std::log(std::abs(turned)), 1e-6)) / k;
    ended_ = side_ * (next.mean - last.mean) <= 0 || weights_.size() >= most ||
             next.log_size - next.s * next.mean < kNothing;
    weights_.push_back(std::move(next));
    return true;
  }

  [[nodiscard]] Uncertain by(Weight& weight, double d, OfInversion of) {
    if (!weight.inversion) {
      constexpr int most = 40;
      weight.inversion.emplace([&](double k) { return transform(weight, k); }, weight.s,
                               weight.mean, weight.deviation,
                               0.2 * computation_.question().accuracy, most);
    }
    const auto found = (*weight.inversion.*of)(d);
    const Uncertain size{1, weight.doubt};
    return std::exp(weight.log_size - weight.s * d) * (size * found);
  }

  [[nodiscard]] Uncertain at(double d, OfInversion of) {
    const auto bound = [&] { return weights_.back().log_size - weights_.back().s * d; };
    const auto below = [&] { return side_ * (d - weights_.back().mean); };
    while ((weights_.size() < 3 || below() > 0) && bound() > kNothing && add_weight()) {
    }
    if (weights_.size() < 3 || below() > kWithin * weights_.back().deviation) {
      return {0, std::exp(bound())};
    }
    std::size_t n = 2;
    while (n + 1 < weights_.size() && side_ * (weights_[n].mean - d) < 0) ++n;
    Uncertain one = by(weights_[n - 1], d, of), other = by(weights_[n], d, of);
    if (other.error < one.error) std::swap(one, other);
    return {one.value, one.error + std::abs(one.value - other.value)};
  }

  const Computation& computation_;
  double time_;
  std::vector<Atom> atoms_;
  int side_;
  std::vector<Weight> weights_;  // the first is none
  bool ended_ = false;
};

using Inversion = FourierInversion;

constexpr double kRootFound = 1e-9;  // of a probability at a quantile found
constexpr double kPlace = 1e-11;     // relative error of the place of an atom

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

// Of a body on one level, which moves as long as the force stays the same, and may come to rest.
Atom under_one_force(const model::Process& process, const Start& start, double time) {
  const int level = start.level, lowest = process.lowest_static();
  const bool holds = process.sticks(level);
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
  const double slid = std::min(now, time);
  const auto [first, on_levels] = model::unchanged(process.noise, level, slid);
  if (holds && now < time) {
    std::vector<double> begins(static_cast<std::size_t>(process.highest_static() - lowest) + 1);
    std::ranges::copy(on_levels, begins.begin() + (first - lowest));
    atom.probability = still_at_rest(process, begins, time - now);
  } else {
    const double kept = std::reduce(on_levels.begin(), on_levels.end());
    atom.probability = {kept, 1e-16 * (8 + process.noise.rate(level) * slid) * kept};
  }
  return atom;
}

// The one that counts most first: of bodies at rest, if there are any.
std::vector<Atom> atoms_at(const Computation& computation, double time) {
  const auto& process = computation.process();
  const auto& start = computation.question().start;
  if (time == 0) return {{0, {1, 0}}};
  if (start.kind == Start::Kind::state) return {under_one_force(process, start, time)};
  std::vector<double> rests;
  if (start.kind == Start::Kind::stationary) {
    const auto& excursion = computation.distribution().excursion();
    for (double t : excursion.stick_time) rests.push_back(t / excursion.mean_excursion());
    return {{0, still_at_rest(process, rests, time)}};
  }
  // From rest on a level that does not stick, bodies slide at once.
  constexpr double rounding = 1e-14;
  const auto levels = model::stationary_distribution(process.noise);
  std::vector<Atom> all(1);
  for (int i = process.noise.lowest(); i <= process.noise.highest(); ++i) {
    const double p = levels[static_cast<std::size_t>(i - process.noise.lowest())];
    if (process.sticks(i)) {
      rests.push_back(p);
    } else if (p * std::exp(-model::change_rates(process.noise, i).least * time) > rounding) {
      all.push_back(under_one_force(process, {i, 0}, time));
      all.back().probability = p * all.back().probability;
    }
  }
  all[0].probability = still_at_rest(process, rests, time);
  return all;
}

// Few levels, and starts in one state, leave parts far narrower than the deviation of all, which so
// many times larger wavenumbers show.
constexpr double kNarrower = 4;

/// The distribution at one time: atoms, and a density that is singular where bodies rest: at 0, as
/// many slips are short; from a state of sliding or where none rests, at the first atom. Where
/// quantiles are asked for that far out, probabilities below kTail on either side of d are found by
/// weighted paths, unless drag leaves the velocity unbounded.
class Distribution {
 public:
  /// Those that are found by weighted paths.
  enum class Tails { none, lower, upper, both };

  Distribution(const Computation& computation, double time, std::vector<Atom> atoms)
      : computation_(computation), time_(time), atoms_(std::move(atoms)) {
    const auto& question = computation.question();
    const auto& process = computation.process();
    even_ = model::mirrors_itself(process, question.start);
    const bool bounded = process.drag.bounds_velocity() || computation.problem.given.scene.v_max;
    const auto probabilities = question.values(cases::kProbability.option);
    weighs_ = bounded && std::any_of(probabilities.begin(), probabilities.end(),
                                     [](double p) { return std::min(p, 1 - p) < kTail; });
    if (!process.sticks() || question.start.kind == Start::Kind::state) centre_ = atoms_[0].at;
    if (time > 0) invert(time);
  }

  [[nodiscard]] Uncertain density(double d) {
    if (!inversion_) return {};
    if (resolves_tails()) {
      const double at_most = cdf(d).value;
      if (at_most < kTail) return tail(-1).density(d);
      if (1 - at_most < kTail) return even_ ? tail(-1).density(-d) : tail(1).density(d);
    }
    return inversion_->density(d - centre_);
  }
  // P(x <= d), or P(x < d).
  [[nodiscard]] Uncertain below(double d, bool or_at, Tails which) {
    if (even_ && d > 0) return Uncertain{1, 0} - below(-d, !or_at, mirrored(which));
    Uncertain sum;
    if (inversion_) {
      // However inaccurate, it is no less than 0 and no more than all that is no atom.
      const auto found = inversion_->below(d - centre_);
      const double value = std::clamp(found.value, 0.0, mass_);
      sum = {value, std::min(found.error, std::max(value, mass_ - value))};
    }
    Uncertain atoms, above;
    for (const Atom& atom : atoms_) {
      Uncertain& all = d > atom.at || (or_at && d == atom.at) ? atoms : above;
      all = all + atom.probability;
    }
    sum = sum + atoms;
    sum.value = std::clamp(sum.value, 0.0, 1.0);  // nearer to the truth than what lies outside
    const bool low = which != Tails::upper && sum.value < kTail,
               high = which != Tails::lower && 1 - sum.value < kTail;
    if (which == Tails::none || !resolves_tails() || !(low || high)) return sum;
    if (low) return atoms + tail(-1).beyond(d);
    return Uncertain{1, 0} - (above + tail(1).beyond(d));
  }
  [[nodiscard]] Uncertain cdf(double d) { return below(d, true, Tails::both); }
  // As far off as the quantiles of the probabilities that may be meant; anywhere, where weighted
  // paths do not reach as far out.
  [[nodiscard]] Uncertain quantile(double p) {
    if (even_ && p == 0.5) return {0, 0};
    const auto tails = tails_for(p);
    const double value = inverse(p);
    const auto [at_most, doubt] = below(value, true, tails);
    const bool atom = std::ranges::find(atoms_, value, &Atom::at) != atoms_.end();
    const bool reached = atom || std::abs(at_most - p) <= doubt + kRootFound * p;
    if (!reached || (tails != Tails::none && doubt >= std::min(p, 1 - p))) {
      return {value, kInfinity};
    }
    const double off = std::max(reach(p, value, -1, tails), reach(p, value, 1, tails));
    return {value, std::max(off, atom ? kPlace * std::abs(value) : 0)};
  }
  [[nodiscard]] int evaluations() const {
    int all = inversion_ ? inversion_->evaluations() : 0;
    for (const auto& [side, of] : tails_) all += of.evaluations();
    return all;
  }
  [[nodiscard]] bool resolves_tails() const { return weighs_ && inversion_; }
  [[nodiscard]] bool is_resolved() const { return !inversion_ || inversion_->is_resolved(); }

 private:
  [[nodiscard]] static Tails mirrored(Tails which) {
    if (which == Tails::lower) return Tails::upper;
    return which == Tails::upper ? Tails::lower : which;
  }
  // phi without the atoms, about the singularity.
  void invert(double time) {
    const auto& question = computation_.question();
    for (const Atom& atom : atoms_) mass_ -= atom.probability.value;
    if (mass_ < 1e-14) return;
    DisplacementModel model(computation_.systems, computation_.distribution(), question.start, time,
                            0.03 * question.accuracy);
    const auto phi = [&](double k) -> Inversion::Transformed {
      const auto found = model.at(k);
      auto rest = found.value * std::polar(1.0, -k * centre_);
      double error = found.error;
      for (const Atom& atom : atoms_) {
        rest -= std::polar(atom.probability.value, k * (atom.at - centre_));
        error += atom.probability.error;
      }
      return {even_ ? rest.real() : rest, error};
    };
    // Mean and deviation from small k. The mean is that of what is inverted, from the singularity
    // on.
    const double h = 0.1 / (model.speed() * time);
    const auto small = phi(h).value / mass_;
    mean_ = even_ ? 0 : std::arg(small) / h;
    spread_ = std::sqrt(std::max(-2 * std::log(std::abs(small)), 1e-12)) / h;
    constexpr double furthest = 60;
    // An octave more for each digit.
    const double units = std::exp2(std::ceil(-std::log10(question.accuracy)));
    lowest_ = centre_ + mean_ - furthest * spread_;
    highest_ = centre_ + mean_ + furthest * spread_;
    const double highest = units * 2 / spread_, last = kNarrower * highest;
    inversion_.emplace(phi, mass_, mean_, spread_, even_,
                       Inversion::Limits{0.3 * question.accuracy, highest, 400, last});
  }

  [[nodiscard]] DisplacementTail& tail(int side) {
    return tails_
        .try_emplace(side, computation_, time_, atoms_, side, mass_, centre_ + mean_, spread_)
        .first->second;
  }

  // Those that a quantile lies in.
  [[nodiscard]] Tails tails_for(double p) const {
    if (!resolves_tails() || std::min(p, 1 - p) >= kTail) return Tails::none;
    return p < kTail ? Tails::lower : Tails::upper;
  }

  // How far to a side of d the distribution function may still be p, by its errors. Where it
  // oscillates within them it may be that again further out; so the search goes on for three
  // octaves.
  [[nodiscard]] double reach(double p, double d, int side, Tails which) {
    constexpr double nearest = 1e-7, furthest = 100;
    const auto may_be = [&](double away) {
      const auto [at_most, doubt] = below(d + side * away, true, which);
      return side * (at_most - p) <= doubt;
    };
    double last = 0;
    int rejected = 0;
    for (double away = nearest * spread_; rejected < 3 && away < furthest * spread_; away *= 2) {
      rejected = may_be(away) ? 0 : rejected + 1;
      if (rejected == 0) last = away;
    }
    double beyond = 2 * last;
    for (int step = 0; step < 3; ++step) {
      const double middle = (last + beyond) / 2;
      (may_be(middle) ? last : beyond) = middle;
    }
    return beyond;
  }

  [[nodiscard]] double inverse(double p) {
    if (even_ && p > 0.5) return 0 - inverse(1 - p);
    const Tails which = tails_for(p);
    for (const Atom& atom : atoms_) {
      if (below(atom.at, false, which).value < p && p <= below(atom.at, true, which).value) {
        return atom.at;
      }
    }
    if (!inversion_) return atoms_[0].at;
    const auto off = [&](double d) { return below(d, true, which).value - p; };
    const double lowest = which == Tails::lower ? tail(-1).end(p) : lowest_,
                 highest = which == Tails::upper ? tail(1).end(1 - p) : highest_;
    if (off(lowest) >= 0) return lowest;
    if (off(highest) <= 0) return highest;
    constexpr double relative = 1e-12;
    const auto near = [&](double a, double b) { return std::abs(b - a) < relative * spread_; };
    std::uintmax_t steps = 200;
    const auto [a, b] = boost::math::tools::toms748_solve(off, lowest, highest, near, steps);
    return (a + b) / 2;
  }

  const Computation& computation_;
  double time_;
  std::vector<Atom> atoms_;
  bool even_ = false, weighs_ = false;
  double centre_ = 0;  // the place of the singularity
  std::optional<Inversion> inversion_;
  double mass_ = 1, mean_ = 0, spread_ = 0;  // without atoms, the mean from the centre on
  double lowest_ = 0, highest_ = 0;          // beyond which nothing is looked for
  std::map<int, DisplacementTail> tails_;    // by side
};

void find_displacements(Computation& computation) {
  const auto& question = computation.question();
  const auto probabilities = question.values(cases::kProbability.option);
  auto& results = computation.results();
  Result probability = array(cases::kDisplacementAtom, question.time),
         position = array(cases::kDisplacementAtomAt, question.time);
  for (double t : question.time) {
    const auto atoms = atoms_at(computation, t);
    Distribution distribution(computation, t, atoms);
    append_value(probability, atoms[0].probability);
    append_value(position, {atoms[0].at, kPlace * std::abs(atoms[0].at)});
    const auto append = [&](const Row& row, const std::vector<double>& abscissa, auto of) {
      if (abscissa.empty()) return;
      Result result = array_at(row, t, abscissa);
      // Near 0, where it is singular, no discretisation gives the digits of the distribution
      // function.
      result.diagnostic = &row == &cases::kDisplacementDensity;
      result.tails_by_their_size =
          &row == &cases::kDisplacementCdf && distribution.resolves_tails();
      for (double x : abscissa) append_value(result, (distribution.*of)(x));
      if (!distribution.is_resolved()) {
        result.limited_by =
            "parts of the density too narrow for the wavenumbers that were tried limit";
      }
      results.push_back(std::move(result));
    };
    append(cases::kDisplacementDensity, question.distance, &Distribution::density);
    append(cases::kDisplacementCdf, question.distance, &Distribution::cdf);
    append(cases::kDisplacementQuantile, probabilities, &Distribution::quantile);
    computation.report("displacement_wavenumbers", distribution.evaluations(),
                       "wavenumbers at which the characteristic function was found");
  }
  probability.diagnostic = largest_size(probability.value) < question.accuracy;
  for (auto* result : {&probability, &position}) results.push_back(std::move(*result));
}

// Displacements down to a part of those that bodies reach, a t min(t, tau)/2. Wavenumbers up to an
// octave more for each digit, in units of 1/deviation of x(t).
void resolve_distribution(Planner& planner) {
  constexpr double parts = 32;
  const auto& question = planner.question();
  const auto process = planner.given().scene.meant();
  const double tau = process.noise.correlation_time(), first = least_positive(question.time),
               last = largest_size(question.time);
  planner.resolve_rate(std::sqrt(2 * kFastestOnContour * parts / (first * std::min(first, tau))));
  const double force = process.noise.standard_deviation(),
               speed = std::min(process.terminal_speed(), force * std::min(last, tau)) / 2,
               spread = speed * std::sqrt(last * std::min(last, 2 * tau));
  resolve_displacements(planner, (process.noise.table ? kNarrower : 1) * 2 *
                                     std::exp2(-std::log10(question.accuracy)) / spread);
}

}  // namespace

void displacement_distribution_tasks(Planner& planner) {
  planner.need_distribution();
  resolve_distribution(planner);
  const auto times = static_cast<int>(planner.question().time.size());
  // At two digits; a complex factorisation or solve is about four real ones.
  planner.add_adaptive("distribution of displacements", 80 * times, 900 * times,
                       find_displacements);
}

}  // namespace stickslip::quantities
