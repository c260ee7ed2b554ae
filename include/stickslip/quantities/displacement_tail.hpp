#pragma once
/// Small probabilities of displacements.

#include <memory>
#include <optional>
#include <vector>

#include "stickslip/exact/tail_inversion.hpp"
#include "stickslip/quantities/displacement_model.hpp"

namespace stickslip::quantities {

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
                   double mass, double mean, double deviation);

  /// The probability of what lies beyond d; where that is too small, 0 with a bound of it as error.
  /// Collective. Throws NotReached or NoMemory.
  [[nodiscard]] Uncertain beyond(double d) { return at(d, &exact::TailInversion::beyond); }
  /// The density there. Collective. Throws NotReached or NoMemory.
  [[nodiscard]] Uncertain density(double d) { return at(d, &exact::TailInversion::density); }
  /// A displacement beyond which there is less than a probability p, if there is one within reach.
  /// Collective. Throws NotReached or NoMemory.
  [[nodiscard]] double end(double p);
  [[nodiscard]] int evaluations() const;

 private:
  /// A weight exp(s x), with log E exp(s x), and mean and deviation of what is weighted.
  struct Weight {
    double s = 0, log_size = 0, mean = 0, deviation = 0;
    double scaled = 1, doubt = 0;  // the size in units of the model, and its relative error
    std::unique_ptr<DisplacementModel> model = {};
    std::optional<exact::TailInversion> inversion = {};
  };
  using OfInversion = Uncertain (exact::TailInversion::*)(double) const;

  bool add_weight();  // false where all has been reached
  [[nodiscard]] exact::FourierInversion::Transformed transform(const Weight& of, double k) const;
  [[nodiscard]] Uncertain at(double d, OfInversion of);
  [[nodiscard]] Uncertain by(Weight& weight, double d, OfInversion of);

  const Computation& computation_;
  double time_;
  std::vector<Atom> atoms_;
  int side_;
  std::vector<Weight> weights_;  // the first is none
  bool ended_ = false;
};

}  // namespace stickslip::quantities
