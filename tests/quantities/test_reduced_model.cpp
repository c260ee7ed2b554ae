#include <cmath>
#include <complex>
#include <limits>
#include <memory>

#include "../common/catch.hpp"
#include "../common/solved.hpp"
#include "stickslip/linalg/vectors.hpp"
#include "stickslip/quantities/engines/inversion.hpp"
#include "stickslip/quantities/engines/propagator.hpp"

using namespace stickslip;
using generator::StaticPhase;
using generator::Symmetry;
using quantities::Answers;
using quantities::Questions;
using quantities::Recipe;
using quantities::Reduced;
using quantities::ReducedModel;
using quantities::Uncertain;
using Complex = std::complex<double>;

namespace {

/// The model of the autocorrelation of the velocity of some process.
class Velocity {
 public:
  explicit Velocity(double delta = 0.25, double mu_d = 0.25, int most_pairs = 80)
      : solved_(test::on_hp(test::scene(1, mu_d, 1, delta, {1, 0}), 6, 1e-6)),
        pencil_(solved_.systems, Symmetry::odd, StaticPhase::kept) {
    auto ends = solved_.distribution.velocity(pencil_.a());
    b_ = std::move(ends.b);
    c_ = std::move(ends.c);
    weight_ = solved_.distribution.weight_on(pencil_.a());
    most_pairs_ = most_pairs;
  }

  [[nodiscard]] std::unique_ptr<ReducedModel> model() {
    return std::make_unique<ReducedModel>(pencil_, quantities::Ends{b_, c_, weight_},
                                          ReducedModel::Nature::smooth, most_pairs_);
  }
  /// c (z + A)^-1 b at these points, each by its size.
  [[nodiscard]] static Questions at(const std::vector<Complex>& points, double tolerance) {
    Questions questions;
    questions.points = points;
    for (std::size_t n = 0; n < points.size(); ++n) questions.terms.push_back({{n, 1}});
    questions.values = [points](const Reduced& r) {
      const quantities::TransferFunction transfer(r.m, r.gamma, r.beta);
      std::vector<Uncertain> values;
      for (const Complex z : points) values.push_back({std::abs(transfer(z)), 0});
      return values;
    };
    questions.each_by_its_size = true;
    questions.tolerance = tolerance;
    questions.first = {{5, 2}};
    questions.lowest = 0.01;
    return questions;
  }

 private:
  test::Solved solved_;
  quantities::ProcessPencil pencil_;
  linalg::VecHandle b_, c_, weight_;
  int most_pairs_;
};

const std::vector<Complex> kFrequencies{{0, 0.01}, {0, 0.1}, {0, 0.5}, {0, 2}, {0, 7}, {0, 20}};

}  // namespace

TEST_CASE("reduced model: the error is the product of both residuals with the resolvent") {
  Velocity velocity;
  auto model = velocity.model();
  model->extend(5, 2);
  const Reduced reduced = model->reduce();
  const quantities::TransferFunction transfer(reduced.m, reduced.gamma, reduced.beta);
  const auto residual = [&](Complex z) {
    const auto expand = [](const linalg::Matrix<double>& a, const std::vector<Complex>& x,
                           bool transposed) {
      std::vector<Complex> y(static_cast<std::size_t>(transposed ? a.columns() : a.rows()), 0.0);
      for (int r = 0; r < a.rows(); ++r) {
        for (int c = 0; c < a.columns(); ++c) {
          transposed ? y[c] += a(r, c) * x[r] : y[r] += a(r, c) * x[c];
        }
      }
      return y;
    };
    return model->right_residual()(z, expand(reduced.to_right, transfer.from_right(z), false)) *
           model->left_residual()(z, expand(reduced.to_left, transfer.from_left(z), true));
  };
  for (const Complex z : kFrequencies) {
    INFO("z = " << z);
    const double error = std::abs(model->truth(z, false).value - transfer(z));
    CHECK(error > 1e-12);  // or there is nothing to see
    // |(z + A)^-1| is at most the slowest time of the odd functions, below 3 here.
    CHECK(error < 3 * residual(z));
    CHECK(error > 1e-6 * residual(z));
  }
}

TEST_CASE("reduced model: no error where it was made from a true solution") {
  Velocity velocity;
  auto model = velocity.model();
  model->extend(5, 2);
  for (const Complex z : {Complex(0, 0.3), Complex(0.4, 0)}) {
    const auto truth = model->truth(z, false);
    const auto before = model->reduce();
    const double error = std::abs(
        truth.value - quantities::TransferFunction(before.m, before.gamma, before.beta)(z));
    CHECK(model->interpolate(truth) == (z.imag() == 0 ? 1 : 2));
    const auto after = model->reduce();
    const quantities::TransferFunction transfer(after.m, after.gamma, after.beta);
    CHECK(error > 1e-9 * std::abs(truth.value));
    CHECK(std::abs(truth.value - transfer(z)) < 1e-12 * std::abs(truth.value));
  }
}

TEST_CASE("reduced model: far out, the form without leading terms keeps its digits") {
  Velocity velocity;
  const auto model = velocity.model();
  const Complex z(0, 3);
  const auto near = model->truth(z, false), far = model->truth(z, true);
  // c (z + A)^-1 b = c b/z - c A b/z^2 + c A (z + A)^-1 A b/z^2, and c A b = 0 as E[V dV/dt] = 0.
  const auto huge = model->truth({0, 1e6}, true);
  CHECK(std::abs((near.value - far.value / (z * z)).real()) < 1e-12 * std::abs(near.value));
  CHECK(std::isfinite(std::abs(huge.value)));
  CHECK(std::abs(huge.value) > 0);
}

TEST_CASE("reduced model: errors hold at points that the search never saw") {
  for (double tolerance : {1e-3, 1e-6, 1e-9}) {
    Velocity velocity;
    auto model = velocity.model();
    Recipe recipe;
    const Answers found = quantities::ask(*model, Velocity::at(kFrequencies, tolerance), recipe);
    INFO("tolerance " << tolerance << ", pairs " << found.pairs);
    CHECK(found.relative_error <= tolerance);
    CHECK(found.truths >= 2);  // at both ends
    const quantities::TransferFunction transfer(found.model.m, found.model.gamma, found.model.beta);
    for (const Complex z :
         {Complex(0, 0.03), Complex(0, 0.25), Complex(0, 1), Complex(0, 4), Complex(0, 12)}) {
      const Complex truth = model->truth(z, false).value;
      CHECK(std::abs(truth - transfer(z)) <= 2 * tolerance * std::abs(truth));
    }
  }
}

// What is slow beside the first shift is seen all the same.
TEST_CASE("reduced model: a first shift far above the spectrum is no trap") {
  Velocity velocity;
  auto model = velocity.model();
  auto questions = Velocity::at(kFrequencies, 1e-7);
  questions.first = {{1e4, 4}};
  Recipe recipe;
  const Answers found = quantities::ask(*model, questions, recipe);
  CHECK(found.relative_error <= 1e-7);
  for (std::size_t n = 0; n < kFrequencies.size(); ++n) {
    const double truth = std::abs(model->truth(kFrequencies[n], false).value);
    INFO(n << " " << found.error[n] / truth << " " << found.value[n] / truth - 1);
    CHECK(std::abs(found.value[n] - truth) <= found.error[n] + 1e-13 * truth);
  }
}

TEST_CASE("reduced model: full, it says how far it is") {
  Velocity velocity(0.25, 0.25, 6);
  auto model = velocity.model();
  Recipe recipe;
  const Answers found = quantities::ask(*model, Velocity::at(kFrequencies, 1e-10), recipe);
  CHECK(found.pairs == 6);
  CHECK(found.relative_error > 1e-10);
  for (std::size_t n = 0; n < kFrequencies.size(); ++n) {
    const double truth = std::abs(model->truth(kFrequencies[n], false).value);
    CHECK(std::abs(found.value[n] - truth) <= found.error[n] + 1e-13 * truth);
  }
}

TEST_CASE("reduced model: a recipe makes the same model at once") {
  Velocity velocity;
  Recipe recipe;
  auto first = velocity.model(), second = velocity.model();
  const auto questions = Velocity::at(kFrequencies, 1e-7);
  const Answers found = quantities::ask(*first, questions, recipe);
  const auto steps = recipe.steps.size();
  const Answers again = quantities::ask(*second, questions, recipe);
  CHECK(again.pairs == found.pairs);
  CHECK(recipe.steps.size() == steps);
  CHECK(again.truths <= found.truths);
  for (std::size_t n = 0; n < kFrequencies.size(); ++n) {
    CHECK(again.value[n] == Approx(found.value[n]).epsilon(1e-10));
  }
}

namespace {

/// Answers that are given beforehand, whatever the model is; true solutions are of the model.
struct Scripted {
  Questions questions;
  std::size_t asked = 0;

  Scripted(std::vector<std::vector<double>> script, double tolerance, double evaluation = 0) {
    questions.points = {{1, 0}};
    questions.values = [this, script, evaluation](const Reduced&) {
      std::vector<Uncertain> values;
      for (double v : script[std::min(asked, script.size() - 1)]) values.push_back({v, evaluation});
      ++asked;
      return values;
    };
    questions.terms.resize(script.front().size());  // true solutions say nothing of these values
    questions.shift.assign(script.front().size(), 1.0);
    questions.first = {{1, 1}};
    questions.highest = 100;
    questions.tolerance = tolerance;
  }
};

Answers grown(Scripted& scripted, int most_pairs = 60) {
  Velocity velocity(0.5, 0.25, most_pairs);
  auto model = velocity.model();
  Recipe recipe;
  return quantities::until_still(*model, scripted.questions, recipe);
}

}  // namespace

TEST_CASE("reduced model: stands still within what the last vectors changed") {
  Scripted s({{1}, {1.25}, {1.3125}, {1.328125}, {2}}, 0.02);
  const Answers found = grown(s);
  CHECK(s.asked == 4);
  CHECK(found.value == std::vector<double>{1.328125});
  CHECK(found.error == std::vector<double>{0.015625});
}

TEST_CASE("reduced model: what the evaluation of values leaves is an error") {
  Scripted s({{1}, {1.25}, {1.3125}, {1.328125}, {2}}, 0.02, 0.5);
  const Answers found = grown(s);
  CHECK(s.asked == 4);  // more vectors do not help
  CHECK(found.error == std::vector<double>{0.515625});
  CHECK(found.relative_error == 0.515625);
}

TEST_CASE("reduced model: the best one met is kept, when patience ends") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Scripted s({{1}, {1.125}, {1.15625}, {2}, {nan}, {4}, {4}, {4}}, 1e-9);
  const Answers found = grown(s);
  CHECK(found.value == std::vector<double>{1.15625});
  // The next model was to be better: the error lies between the changes before and after it.
  CHECK(found.error[0] == Approx(std::sqrt(0.03125 * 0.84375)));
}

TEST_CASE("reduced model: what true solutions miss is an error") {
  Scripted s({{1}, {1}}, 1e-12);
  s.questions.terms = {{{0, 1e6}}};  // of the transfer function at 1, a million times
  const Answers found = grown(s, 8);
  CHECK(found.truths == 1);
  CHECK(found.error[0] > 1e-12);
}
