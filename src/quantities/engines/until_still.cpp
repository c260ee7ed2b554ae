#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "stickslip/base/text.hpp"
#include "stickslip/quantities/engines/inversion.hpp"
#include "stickslip/quantities/engines/propagator.hpp"

namespace stickslip::quantities {
namespace {

using Complex = std::complex<double>;

class Growth {
 public:
  Growth(ReducedModel& model, const Questions& questions, Recipe& recipe)
      : model_(model), questions_(questions), recipe_(recipe), known_before_(recipe.verified) {
    for (const auto& step : questions.first) shifts_.push_back(step.z.real());
  }

  Answers run() {
    extend();  // a first model is not worth its questions
    grow();
    grow_until_still();
    compare_with_truths();
    doubt_best();
    add_evaluation();
    best_.pairs = model_.pairs();
    best_.truths = static_cast<int>(truths_.size());
    best_.shifts = shifts_;
    recipe_.verified = true;
    return std::move(best_);
  }

 private:
  static constexpr int kPatience = 4;  // blocks in a row that may fail to help
  static constexpr int kBlock = 4;

  void grow_until_still() {
    int barren = 0;
    while (!model_.full() && barren < kPatience && best_.relative_error > questions_.tolerance) {
      const double before = best_.relative_error;
      const bool grew = grow();
      barren = grew && best_.relative_error < 0.3 * before ? 0 : barren + 1;
      if (barren > 0) add_shift(worst_shift());
    }
  }

  // About a block of pairs, shared out over the shifts: many pairs at few shifts are nearly
  // dependent.
  bool extend() {
    const int each = std::max(1, kBlock / static_cast<int>(shifts_.size()));
    int added = 0;
    for (double shift : shifts_) added += model_.extend(shift, each);
    return added > 0;
  }

  bool grow() {
    const bool grew = extend();
    Answers now;
    now.model = model_.reduce();
    std::vector<double> evaluation;
    for (const auto& [value, error] : questions_.values(now.model)) {
      now.value.push_back(value);
      evaluation.push_back(error);
    }
    judge(now);
    met_.push_back(now.value);
    const TransferFunction transfer(now.model.m, now.model.gamma, now.model.beta);
    std::swap(last_, before_);
    last_.clear();
    for (const Complex z : questions_.points) last_.push_back(transfer(z));
    if (best_.value.empty() || now.relative_error < best_.relative_error) {
      best_ = std::move(now);
      best_at_ = met_.size() - 1;
      evaluation_ = std::move(evaluation);
    }
    return grew;
  }

  // The changes of a value fall from block to block. Once they have grown they are noise that adds
  // up: a value is then no better known than it is far from all met since.
  void judge(Answers& now) {
    const std::size_t last = met_.empty() ? 0 : met_.size() - 1;
    double largest = 0;
    for (std::size_t n = 0; n < now.value.size(); ++n) {
      largest = std::max(largest, distance(now.value, last, n));
    }
    if (largest > change_) noisy_from_ = std::min(noisy_from_, last);
    change_ = largest;
    relative_.clear();
    for (std::size_t n = 0; n < now.value.size(); ++n) {
      double error = std::numeric_limits<double>::epsilon();
      for (std::size_t m = std::min(noisy_from_, last); m <= last; ++m) {
        error = std::max(error, distance(now.value, m, n));
      }
      now.error.push_back(error);
      relative_.push_back(error);
    }
    now.relative_error = *std::max_element(relative_.begin(), relative_.end());
  }

  // From value n of the model met m-th; the first has only its size to be judged by.
  [[nodiscard]] double distance(const std::vector<double>& value, std::size_t m,
                                std::size_t n) const {
    const double change = met_.empty() ? 1 : std::abs(value[n] - met_[m][n]);
    // A projection may have a pole on the wrong side; the next ones have it elsewhere.
    return std::isfinite(change) ? change : kInfinity;
  }

  // What true solutions miss in the best model is an error.
  void compare_with_truths() {
    const TransferFunction transfer(best_.model.m, best_.model.gamma, best_.model.beta);
    for (const std::size_t point : points_to_verify()) {
      truths_.emplace_back(point, model_.truth(questions_.points[point], false).value);
    }
    const std::vector<double> missed = between_truths(transfer);
    for (std::size_t n = 0; n < best_.value.size(); ++n) {
      double error = 0;
      for (const auto& [point, weight] : questions_.terms[n]) error += weight * missed[point];
      best_.error[n] = std::max(best_.error[n], error);
      best_.relative_error = std::max(best_.relative_error, best_.error[n]);
    }
  }

  // |H - H_r| at all points: between two true solutions, rising in |z|, it changes as a power of
  // it.
  [[nodiscard]] std::vector<double> between_truths(const TransferFunction& transfer) const {
    const auto logarithm = [&](const auto& known) {
      return std::log(std::max(std::abs(known.second - transfer(questions_.points[known.first])),
                               std::numeric_limits<double>::min()));
    };
    std::vector<double> missed;
    for (std::size_t p = 0; p < questions_.points.size(); ++p) {
      const auto after = std::find_if(truths_.begin(), truths_.end(),
                                      [p](const auto& known) { return known.first >= p; });
      if (after == truths_.begin() || after == truths_.end()) {
        missed.push_back(std::exp(logarithm(after == truths_.end() ? truths_.back() : *after)));
        continue;
      }
      const auto before = after - 1;
      const auto place = [&](std::size_t n) { return std::log(std::abs(questions_.points[n])); };
      const double span = place(after->first) - place(before->first);
      const double share = span > 0 ? (place(p) - place(before->first)) / span : 0;
      missed.push_back(std::exp((1 - share) * logarithm(*before) + share * logarithm(*after)));
    }
    return missed;
  }

  // Both ends and where the last vectors changed most; once they are known of a coarser
  // discretisation, the low end, which takes real factors, and that.
  [[nodiscard]] std::set<std::size_t> points_to_verify() const {
    std::set<std::size_t> points{0};
    if (!known_before_) points.insert(questions_.points.size() - 1);
    if (before_.size() == last_.size()) {
      std::size_t worst = 0;
      double largest = 0;
      for (std::size_t p = 0; p < last_.size(); ++p) {
        const double change = std::abs(last_[p] - before_[p]) / std::abs(last_[p]);
        if (change > largest) worst = p;
        largest = std::max(largest, change);
      }
      points.insert(worst);
    }
    return points;
  }

  // The best of several that miss the tolerance owes something to chance. The next one, which was
  // to be better, shows how much: the error lies between the changes before and after it.
  void doubt_best() {
    if (best_at_ + 1 == met_.size() || best_.relative_error <= questions_.tolerance) return;
    for (std::size_t n = 0; n < best_.value.size(); ++n) {
      const double after = distance(best_.value, best_at_ + 1, n);
      best_.error[n] = std::max(best_.error[n], std::sqrt(best_.error[n] * after));
      best_.relative_error = std::max(best_.relative_error, best_.error[n]);
    }
  }

  // What evaluation leaves may be the same in all models, as waves that a contour loses.
  void add_evaluation() {
    for (std::size_t n = 0; n < best_.value.size(); ++n) {
      best_.error[n] += evaluation_[n];
      best_.relative_error = std::max(best_.relative_error, best_.error[n]);
    }
  }

  // Where the error is largest.
  [[nodiscard]] double worst_shift() const {
    return questions_.shift[static_cast<std::size_t>(
        std::max_element(relative_.begin(), relative_.end()) - relative_.begin())];
  }

  // Unless one is near.
  void add_shift(double wanted) {
    const double shift = std::clamp(wanted, questions_.lowest, questions_.highest);
    for (double s : shifts_) {
      if (std::abs(std::log(shift / s)) < std::log(1.5)) return;
    }
    shifts_.push_back(shift);
  }

  ReducedModel& model_;
  const Questions& questions_;
  Recipe& recipe_;
  bool known_before_;
  Answers best_;
  std::size_t best_at_ = 0;
  std::vector<double> evaluation_;        // of the best, what it leaves
  std::vector<std::vector<double>> met_;  // values of all models
  std::vector<Complex> last_, before_;    // transfer functions of the last two, by point
  std::vector<std::pair<std::size_t, Complex>> truths_;
  std::size_t noisy_from_ = std::numeric_limits<std::size_t>::max();
  double change_ = kInfinity;
  std::vector<double> shifts_, relative_;
};

}  // namespace

Answers until_still(ReducedModel& model, const Questions& questions, Recipe& recipe) {
  return Growth(model, questions, recipe).run();
}

}  // namespace stickslip::quantities
