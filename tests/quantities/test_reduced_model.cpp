#include <limits>

#include "../common/catch.hpp"
#include "../common/solved.hpp"
#include "stickslip/petsc/vectors.hpp"
#include "stickslip/quantities/reduced_model.hpp"

using namespace stickslip;
using operators::StaticPhase;
using operators::Symmetry;
using quantities::Answers;
using quantities::Questions;
using quantities::ReducedModel;

namespace {

using Script = std::vector<std::vector<double>>;

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// A model of some process whose answers are given beforehand, one list of values after the other;
/// the last one is repeated.
class Scripted {
 public:
  explicit Scripted(Script script, int most_pairs = 60)
      : script_(std::move(script)),
        solved_(test::on_hp(test::scene(1, 0.25, 1, 0.5, {1, 0}), 4, 1e-6)),
        model_(made(most_pairs)) {
    questions.values = [this](const quantities::Reduced&) {
      return script_[std::min(asked++, script_.size() - 1)];
    };
    questions.shift.assign(script_.front().size(), 1.0);
    questions.first_shifts = {1};
  }

  [[nodiscard]] Answers ask() { return quantities::ask(*model_, questions); }

  Questions questions;
  std::size_t asked = 0;

 private:
  std::unique_ptr<ReducedModel> made(int most_pairs) {
    pencil_ = std::make_unique<quantities::ProcessPencil>(solved_.systems, Symmetry::odd,
                                                          StaticPhase::kept);
    const auto [b, c] = solved_.distribution.velocity(pencil_->a());
    const petsc::VecHandle weight = solved_.distribution.weight_on(pencil_->a());
    return std::make_unique<ReducedModel>(*pencil_, quantities::Ends{b, c, weight},
                                          ReducedModel::Nature::smooth, most_pairs);
  }

  Script script_;
  test::Solved solved_;
  std::unique_ptr<quantities::ProcessPencil> pencil_;
  std::unique_ptr<ReducedModel> model_;
};

}  // namespace

TEST_CASE("reduced model: stops at the tolerance, with what the last vectors changed") {
  Scripted s(Script{{1}, {1.25}, {1.3125}, {1.328125}, {2}});
  s.questions.tolerance = 0.02;
  const Answers found = s.ask();
  CHECK(s.asked == 4);
  CHECK(found.value == std::vector<double>{1.328125});
  CHECK(found.error == std::vector<double>{0.015625});
  CHECK(found.relative_error == 0.015625);
  CHECK(found.shifts == std::vector<double>{1});
  // b, L b and a block more than there were questions.
  CHECK(found.pairs == 2 + 4 * 5);
}

TEST_CASE("reduced model: errors relative to each value, or absolute; the largest counts") {
  const Script script{{64, -0.5}, {64.5, -0.5625}, {64.5, -0.5625}};
  for (bool each : {false, true}) {
    Scripted s(script);
    s.questions.tolerance = each ? 0.2 : 0.6;
    s.questions.each_by_its_size = each;
    const Answers found = s.ask();
    CHECK(s.asked == 2);
    CHECK(found.error == std::vector<double>{0.5, 0.0625});
    CHECK(found.relative_error == Approx(each ? 0.0625 / 0.5625 : 0.5).epsilon(1e-14));
  }
}

TEST_CASE("reduced model: a first model has no error but its size") {
  Scripted s(Script{{-8, 2}, {-8, 2}}, 10);  // full after one question
  s.questions.each_by_its_size = true;
  const Answers found = s.ask();
  CHECK(s.asked == 1);
  CHECK(found.error == std::vector<double>{8, 2});
  CHECK(found.relative_error == 1);
  CHECK(found.pairs == 10);
}

TEST_CASE("reduced model: what does not change is still rounded") {
  Scripted s(Script{{8}, {8}});
  s.questions.each_by_its_size = true;
  const Answers found = s.ask();
  CHECK(s.asked == 2);
  CHECK(found.error == std::vector<double>{8 * kEpsilon});
  CHECK(found.relative_error == kEpsilon);
}

TEST_CASE("reduced model: the best one met is kept, when patience ends") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Scripted s(Script{{1}, {1.125}, {1.15625}, {2}, {nan}, {4}, {4}});
  s.questions.tolerance = 1e-9;
  s.questions.patience = 3;
  const Answers found = s.ask();
  CHECK(s.asked == 6);
  CHECK(found.value == std::vector<double>{1.15625});
  CHECK(found.error == std::vector<double>{0.03125});
}

// An error that falls by less than 0.3 is no help.
TEST_CASE("reduced model: patience begins anew with whatever helps") {
  Scripted slow(Script{{0}, {0.5}, {0.75}, {0.875}, {0.9375}});
  slow.questions.patience = 2;
  (void)slow.ask();
  CHECK(slow.asked == 3);
  Scripted fast(Script{{0}, {0.5}, {0.625}, {0.6875}, {0.6875}});
  fast.questions.patience = 2;
  (void)fast.ask();
  CHECK(fast.asked == 5);  // 1, 0.5, 0.125 helps, 0.0625, rounding
}

TEST_CASE("reduced model: shifts go where the error is largest, unless one is near") {
  const auto shifts = [](double at_worst, double lowest, double highest) {
    Scripted s(Script{{0, 0}, {0.5, 1}, {0.5, 2}, {0.5, 3}});
    s.questions.shift = {50, at_worst};
    s.questions.lowest = lowest;
    s.questions.highest = highest;
    s.questions.patience = 2;
    return s.ask().shifts;
  };
  using Shifts = std::vector<double>;
  CHECK(shifts(7, 0, 100) == Shifts{1, 7});
  CHECK(shifts(7, 0, 5) == Shifts{1, 5});
  CHECK(shifts(7, 20, 100) == Shifts{1, 20});
  CHECK(shifts(1.6, 0, 100) == Shifts{1, 1.6});
  CHECK(shifts(1.4, 0, 100) == Shifts{1});
  CHECK(shifts(0.7, 0, 100) == Shifts{1});
  CHECK(shifts(0.6, 0, 100) == Shifts{1, 0.6});
}
