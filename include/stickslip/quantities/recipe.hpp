#pragma once
/// What reduced models on one refinement level tell those on the next one.

#include <complex>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace stickslip::quantities {

/// How a model was made: shifts with their numbers of pairs, in order, and points of interpolation.
/// On the next refinement level the same model is made at once.
struct Recipe {
  struct Step {
    std::complex<double> z;
    int pairs = 0;
  };
  std::vector<Step> steps;
  /// What true solutions have shown: |H - H_r| in units of |r_b| |r_c|/|z|, and of |H|.
  struct Scale {
    std::complex<double> z;
    double beside_residuals, relative;
  };
  std::vector<Scale> scales;
  bool verified = false;  ///< by until_still(), at both ends
};

/// By name of what the model is of.
using Recipes = std::map<std::string, Recipe>;

/// The tolerance of reduced models, and how those of coarser discretisations were made.
struct ModelTolerance {
  // NOLINTNEXTLINE(google-explicit-constructor): a number is a tolerance
  ModelTolerance(double tolerance, std::shared_ptr<Recipes> known = std::make_shared<Recipes>())
      : value(tolerance), recipes(std::move(known)) {}
  [[nodiscard]] Recipe& recipe(const std::string& name) const { return (*recipes)[name]; }

  double value;
  std::shared_ptr<Recipes> recipes;
};

}  // namespace stickslip::quantities
