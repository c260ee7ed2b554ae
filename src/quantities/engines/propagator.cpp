#include "stickslip/quantities/engines/propagator.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

#include "stickslip/quantities/engines/inversion.hpp"

namespace stickslip::quantities {
namespace {

using Complex = std::complex<double>;

constexpr int kBlock = 4;  // pairs at a time
// Rounding of a model, relative: mostly below the first one, at times up to the second.
constexpr double kFloor = 3e-13, kMostRounding = 3e-12;
// Shifts nearer than that to each other find nearly dependent vectors.
constexpr double kNear = 1.5;
// Errors between true solutions may be that much larger than residuals make them.
constexpr double kCaution = 3;
// Where a deviation is that much larger beside the residuals than elsewhere, it is rounding.
constexpr double kRounded = 1e3;

double distance(Complex a, Complex b) {
  constexpr double least = 1e-300;
  return std::abs(std::log(std::max(std::abs(a), least) / std::max(std::abs(b), least)));
}

/// A reduced model with what it takes to see its errors.
class Judged {
 public:
  explicit Judged(ReducedModel& model)
      : reduced(model.reduce()),
        transfer(reduced.m, reduced.gamma, reduced.beta),
        beyond_(transfer.between(reduced.gamma * reduced.m, reduced.m * reduced.beta)),
        right_(model.right_residual()),
        left_(model.left_residual()) {}

  // |r_b| |r_c|.
  [[nodiscard]] double residuals(Complex z) const {
    return right_(z, expanded(reduced.to_right, transfer.from_right(z), false)) *
           left_(z, expanded(reduced.to_left, transfer.from_left(z), true));
  }

  // |H - H_r|.
  [[nodiscard]] double deviation(const Truth& truth) const {
    const Complex z = truth.z;
    if (!truth.far) return std::abs(truth.value - transfer(z));
    return std::abs(truth.value - beyond_(z)) / std::norm(z);
  }

  Reduced reduced;
  TransferFunction transfer;

 private:
  static std::vector<Complex> expanded(const linalg::Matrix<double>& a,
                                       const std::vector<Complex>& x, bool transposed) {
    std::vector<Complex> y(static_cast<std::size_t>(transposed ? a.columns() : a.rows()), 0.0);
    for (int c = 0; c < a.columns(); ++c) {
      for (int r = 0; r < a.rows(); ++r) {
        transposed ? y[c] += a(r, c) * x[r] : y[r] += a(r, c) * x[c];
      }
    }
    return y;
  }

  TransferFunction beyond_;
  Residual right_, left_;
};

class Search {
 public:
  Search(ReducedModel& model, const Questions& questions, Recipe& recipe)
      : model_(model), questions_(questions), recipe_(recipe), replayed_(!recipe.steps.empty()) {}

  Answers run() {
    const auto steps = replayed_ ? std::exchange(recipe_.steps, {}) : questions_.first;
    for (const auto& step : steps) carry_out(step);
    judge();
    if (!replayed_) {
      verify(0);
      if (questions_.points.size() > 1) verify(questions_.points.size() - 1);
    }
    while (true) {
      const std::size_t point = worst_point();
      if (now_.relative_error <= questions_.tolerance) {
        if (known(point)) break;
        const double expected = errors_[point];
        verify(point);
        if (errors_[point] <= expected && now_.relative_error <= questions_.tolerance) break;
      } else if (!improve(point)) {
        if (!known(point)) verify(point);
        break;
      }
    }
    if (!truths_.empty()) recipe_.scales = scales();
    evaluate_best();
    best_.truths = static_cast<int>(truths_.size());
    best_.pairs = model_.pairs();
    best_.shifts.assign(shifts_.begin(), shifts_.end());
    return std::move(best_);
  }

 private:
  void carry_out(const Recipe::Step& step) {
    if (step.z.imag() == 0 && step.pairs > 0) {
      if (model_.extend(step.z.real(), step.pairs) == 0) return;
      shifts_.insert(step.z.real());
    } else {
      const Truth truth = model_.truth(step.z, false);
      if (model_.interpolate(truth) == 0) return;
    }
    recipe_.steps.push_back(step);
  }

  void judge() {
    judged_ = std::make_unique<Judged>(model_);
    now_ = {};
    now_.model = judged_->reduced;
    if (questions_.each_by_its_size) evaluate(now_);
    residuals_.clear();
    for (const Complex z : questions_.points) residuals_.push_back(judged_->residuals(z));
    estimate();
  }

  [[nodiscard]] bool made_from(Complex z) const {
    return std::any_of(recipe_.steps.begin(), recipe_.steps.end(),
                       [z](const Recipe::Step& step) { return step.pairs == 0 && step.z == z; });
  }

  // What true solutions show beside the residuals, |z| (z + A)^-1 being of order one.
  [[nodiscard]] std::vector<Recipe::Scale> scales() const {
    std::vector<Recipe::Scale> found;
    for (const auto& truth : truths_) {
      if (made_from(truth.z)) continue;
      const double error = judged_->deviation(truth);
      found.push_back({truth.z, error / judged_->residuals(truth.z) * size_of(truth.z),
                       error / std::abs(judged_->transfer(truth.z))});
    }
    return found;
  }
  [[nodiscard]] double size_of(Complex z) const { return std::max(std::abs(z), questions_.lowest); }

  // What true solutions show of rounding, relative: residuals do not see it, and points in between
  // have as much of it as the best of them.
  [[nodiscard]] static double rounding_among(const std::vector<Recipe::Scale>& known) {
    if (known.empty()) return 0;
    double least = kMostRounding;
    for (const auto& scale : known) least = std::min(least, scale.relative);
    return least;
  }

  // Of all values, from what true solutions show.
  void estimate() {
    std::vector<Recipe::Scale> known = scales(), rounded;
    if (replayed_) known.insert(known.end(), recipe_.scales.begin(), recipe_.scales.end());
    const double rounding = rounding_among(known);
    const auto least = std::ranges::min_element(known, {}, &Recipe::Scale::beside_residuals);
    if (least != known.end()) {
      const double most = kRounded * least->beside_residuals;
      const auto first = std::partition(known.begin(), known.end(), [most](const auto& scale) {
        return scale.beside_residuals <= most;
      });
      rounded.assign(first, known.end());
      known.erase(first, known.end());
    }
    const auto nearest = [](const std::vector<Recipe::Scale>& all, Complex z) {
      return std::ranges::min_element(all, {},
                                      [z](const auto& scale) { return distance(scale.z, z); });
    };
    errors_.clear();
    for (std::size_t p = 0; p < questions_.points.size(); ++p) {
      const Complex z = questions_.points[p];
      if (const auto truth = truth_at(p); truth != truths_.end()) {
        errors_.push_back(judged_->deviation(*truth));
        continue;
      }
      double error = kCaution * residuals_[p] / size_of(z);
      if (!known.empty()) error *= nearest(known, z)->beside_residuals;
      if (!rounded.empty()) error += nearest(rounded, z)->relative * std::abs(judged_->transfer(z));
      errors_.push_back(std::max(error, rounding * std::abs(judged_->transfer(z))));
    }
    now_.error.clear();
    relative_.clear();
    for (std::size_t n = 0; n < questions_.terms.size(); ++n) {
      double error = kFloor * size(n);
      for (const auto& [point, weight] : questions_.terms[n]) error += weight * errors_[point];
      // A projection may have a pole on the wrong side; the next ones have it elsewhere.
      if (!std::isfinite(error)) error = kInfinity;
      now_.error.push_back(error);
      relative_.push_back(error / size(n));
    }
    now_.relative_error = *std::max_element(relative_.begin(), relative_.end());
    if (best_.error.empty() || truths_.size() != best_truths_ ||
        now_.relative_error < best_.relative_error) {
      best_ = now_;
      best_truths_ = truths_.size();
    }
  }

  [[nodiscard]] double size(std::size_t n) const {
    return questions_.each_by_its_size ? std::abs(now_.value[n]) : 1;
  }

  // What adds most to the error of the worst value.
  [[nodiscard]] std::size_t worst_point() const {
    const auto worst = std::max_element(relative_.begin(), relative_.end()) - relative_.begin();
    const auto& terms = questions_.terms[static_cast<std::size_t>(worst)];
    const auto share = [this](const auto& term) { return term.weight * errors_[term.point]; };
    return std::ranges::max_element(terms, {}, share)->point;
  }

  [[nodiscard]] std::vector<Truth>::iterator truth_at(std::size_t point) {
    return std::ranges::find(truths_, questions_.points[point], &Truth::z);
  }
  [[nodiscard]] bool known(std::size_t point) { return truth_at(point) != truths_.end(); }

  void verify(std::size_t point) {
    const Complex z = questions_.points[point];
    truths_.push_back(model_.truth(z, std::abs(z) >= questions_.far));
    if (truths_.size() > 1) truths_[truths_.size() - 2].inverse = nullptr;
    estimate();
  }

  // By pairs at a shift near the point, and by interpolation where they have been tried.
  bool improve(std::size_t point) {
    if (model_.full()) return false;
    const Complex z = questions_.points[point];
    const bool tried = before_ < kInfinity && now_.relative_error > 0.3 * before_ &&
                       distance(z, last_) < std::log(2.0);
    before_ = now_.relative_error;
    last_ = z;
    if (tried) return interpolate(point);
    double shift = std::max(std::abs(z), questions_.lowest);
    for (double s : shifts_) {
      if (distance(s, shift) < std::log(kNear)) shift = s;
    }
    const int pairs = model_.pairs();
    carry_out({shift, kBlock});
    if (model_.pairs() == pairs) return interpolate(point);
    judge();
    return true;
  }

  bool interpolate(std::size_t point) {
    if (static_cast<int>(truths_.size()) >= questions_.most_truths) return false;
    if (!known(point)) {
      verify(point);
      if (now_.relative_error <= questions_.tolerance) return true;
      if (worst_point() != point) return true;
    }
    const Complex z = questions_.points[point];
    const auto truth = truth_at(point);
    if (truth->inverse == nullptr) *truth = model_.truth(z, truth->far);
    if (model_.interpolate(*truth) == 0) return false;
    recipe_.steps.push_back({z, 0});
    judge();
    return true;
  }

  void evaluate(Answers& answers) {
    answers.value.clear();
    evaluation_.clear();
    for (const auto& [value, error] : questions_.values(answers.model)) {
      answers.value.push_back(value);
      evaluation_.push_back(error);
    }
  }

  // The values, with what their evaluation adds to their errors.
  void evaluate_best() {
    evaluate(best_);
    for (std::size_t n = 0; n < best_.value.size(); ++n) {
      best_.error[n] += evaluation_[n];
      const double size = questions_.each_by_its_size ? std::abs(best_.value[n]) : 1;
      best_.relative_error = std::max(best_.relative_error, best_.error[n] / size);
    }
  }

  ReducedModel& model_;
  const Questions& questions_;
  Recipe& recipe_;
  bool replayed_;
  std::unique_ptr<Judged> judged_;
  std::vector<Truth> truths_;
  std::vector<double> residuals_, errors_;     // by point
  std::vector<double> relative_, evaluation_;  // by value
  Answers now_, best_;
  std::size_t best_truths_ = 0;
  std::set<double> shifts_;
  double before_ = kInfinity;
  Complex last_ = 0;
};

// Waves that few levels hardly damp lie to the right of a contour beyond some 0.8 points / t. With
// a Laplace transform that falls as 1/z^2 there, the wide contour loses about what the two differ
// by; three times that stands for it, as waves come with any phase. Wider ones multiply rounding by
// exp(0.17 points).
constexpr int kWide = 34, kNarrow = 24;
constexpr double kDoubt = 3;

// An error dH of the transfer function is one of its inverse at the time t,
//
//   |df| <= (e/pi) int |dH((1 + i y)/t)| dy/t,  y >= 0,
//
// which three points of this line stand for, up to where the contour reaches. Models of rough ends
// miss most there of what is over long before t; without kinks that has the first two.
void add_points(const std::vector<Fold>& folds, const std::vector<double>& time,
                ReducedModel::Nature nature, Questions& questions) {
  std::vector<std::pair<double, double>> line{{0, 1}, {2, 2}};
  if (nature != ReducedModel::Nature::rough) line.emplace_back(14, 24);
  struct Place {
    std::complex<double> z;
    std::size_t time;
    double width;
  };
  std::vector<Place> places;
  for (std::size_t n = 0; n < time.size(); ++n) {
    for (const auto& [y, width] : line) {
      places.push_back({std::complex<double>(1, y) / time[n], n, width / time[n]});
    }
  }
  std::ranges::sort(places, {}, [](const Place& place) { return std::abs(place.z); });
  questions.terms.resize(folds.size() * time.size());
  for (const Place& place : places) {
    for (std::size_t f = 0; f < folds.size(); ++f) {
      const double weight = std::numbers::e / std::numbers::pi * place.width /
                            (std::pow(std::abs(place.z), folds[f].n) * folds[f].unit);
      questions.terms[f * time.size() + place.time].push_back({questions.points.size(), weight});
    }
    questions.points.push_back(place.z);
  }
}

}  // namespace

Answers ask(ReducedModel& model, const Questions& questions, Recipe& recipe) {
  return Search(model, questions, recipe).run();
}

std::vector<std::vector<Uncertain>>
evaluate(const Reduced& reduced, const std::vector<double>& time, const std::vector<int>& folds) {
  static const std::array<TalbotContour, 2> contours{TalbotContour(kWide), TalbotContour(kNarrow)};
  const TransferFunction transfer(reduced.m, reduced.gamma, reduced.beta);
  std::vector<std::vector<Uncertain>> values(folds.size());
  for (double t : time) {
    std::vector<std::array<double, 2>> found(folds.size(), {0, 0});
    for (std::size_t k = 0; k < contours.size(); ++k) {
      const auto& [points, weights] = contours[k];
      for (std::size_t n = 0; n < points.size(); ++n) {
        const auto z = points[n] / t;
        const auto term = weights[n] * transfer(z) / t;
        for (std::size_t f = 0; f < folds.size(); ++f) {
          found[f][k] += (folds[f] == 0 ? term : term / std::pow(z, folds[f])).real();
        }
      }
    }
    for (std::size_t f = 0; f < folds.size(); ++f) {
      values[f].push_back({found[f][0], kDoubt * std::abs(found[f][1] - found[f][0])});
    }
  }
  return values;
}

TimeScales time_scales(const model::Process& process) {
  // At a typical speed friction and drag take the power that white noise gives.
  const auto force = [&](double v) {
    return process.friction.at_rest() - std::abs(process.bias) - process.drag(v);
  };
  const double scale = process.noise.intensity() / process.noise.standard_deviation();
  double low = 1e-9 * scale, high = 1e9 * scale;
  for (int n = 0; n < 60; ++n) {
    const double v = std::sqrt(low * high);
    (v * force(v) < process.noise.intensity() ? low : high) = v;
  }
  return {process.noise.correlation_time(), process.noise.rate(), low / force(low)};
}

TimeCurve time_curve(Pencil& pencil, const Ends& ends, ReducedModel::Nature nature,
                     const std::vector<Fold>& folds, const std::vector<double>& time,
                     const TimeScales& scales, double tolerance, Recipe& recipe) {
  constexpr int most_pairs = 120;
  std::vector<double> later;
  std::copy_if(time.begin(), time.end(), std::back_inserter(later), [](double t) { return t > 0; });
  ReducedModel model(pencil, ends, nature, most_pairs);
  std::vector<int> orders;
  for (const Fold& fold : folds) orders.push_back(fold.n);
  Questions questions;
  questions.values = [&](const Reduced& reduced) {
    const auto found = evaluate(reduced, later, orders);
    std::vector<Uncertain> values;
    for (std::size_t f = 0; f < folds.size(); ++f) {
      for (Uncertain value : found[f]) values.push_back(1 / folds[f].unit * value);
    }
    return values;
  };
  add_points(folds, later, nature, questions);
  for (std::size_t n = 0; n < folds.size() * later.size(); ++n) {
    questions.shift.push_back(2 / std::max(later[n % later.size()], 1e-6 * scales.correlation));
  }
  questions.tolerance = tolerance;
  questions.highest = 1e6 / scales.correlation;
  // From the slowest rates to beyond the rate of the noise. Under fast noise velocities are slower
  // than it by any factor, and long times depend on them.
  const auto [tau, rate, stopping] = scales;
  const double longest = *std::max_element(time.begin(), time.end());
  double low = 0.3 / tau;
  const double high = std::max(30 / tau, 12 * rate);
  int shifts = 6;
  questions.lowest = 0.05 / tau;
  const double slowest = std::max(2 / longest, 0.05 / stopping);
  if (slowest < questions.lowest) {
    shifts += static_cast<int>(std::ceil(std::log10(low / slowest)));
    low = slowest;
    questions.lowest = 0.5 * slowest;
  }
  for (int n = 0; n < shifts; ++n) {
    questions.first.push_back({low * std::pow(high / low, n / (shifts - 1.0)), 3});
  }
  TimeCurve curve;
  Answers answers;
  if (!later.empty()) {
    const bool smooth = nature == ReducedModel::Nature::smooth;
    answers = smooth ? ask(model, questions, recipe) : until_still(model, questions, recipe);
  }
  curve.pairs = answers.pairs;
  auto value = answers.value.begin(), error = answers.error.begin();
  for (const Fold& fold : folds) {
    auto& values = curve.value.emplace_back();
    for (double t : time) {
      if (t > 0) {
        values.push_back({fold.unit * *value++, fold.unit * *error++});
      } else {
        values.push_back({fold.n > 0 ? 0 : linalg::dot(ends.c, ends.b), 0});
      }
    }
  }
  return curve;
}

}  // namespace stickslip::quantities
