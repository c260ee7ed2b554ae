#pragma once
/// Small models of c (z + A)^-1 b by two-sided rational Krylov projection.

#include <slepcbv.h>

#include <complex>
#include <cstddef>
#include <functional>
#include <map>
#include <set>
#include <vector>

#include "stickslip/base/text.hpp"
#include "stickslip/generator/resolvents.hpp"
#include "stickslip/linalg/dense.hpp"
#include "stickslip/linalg/vectors.hpp"
#include "stickslip/quantities/plan.hpp"

namespace stickslip::quantities {

// Linear evolution equations of which reduced models are made.

/// (z + A)^-1 b at one complex z, or with the transpose (no conjugation), after iterative
/// refinement, by factors that it holds. Collective. Throws NotReached.
using ShiftedInverse =
    std::function<generator::ComplexVector(const generator::ComplexVector& b, bool transposed)>;

/// u' = -A u on discrete states: c (z + A)^-1 b is the Laplace transform of c exp(-A t) b. All
/// members are collective.
class Pencil {
 public:
  virtual ~Pencil() = default;
  /// y = A x, or A^T x.
  virtual void multiply(Vec x, Vec y, bool transposed) const = 0;
  /// x = (z + A)^-1 b, or with the transpose: by one solve, or with iterative refinement. A new z >
  /// 0 takes a factorisation. Throws NoMemory or NotReached.
  virtual void solve(double z, Vec b, Vec x, bool transposed, bool refined) = 0;
  /// Factors of z + A for a complex z, at three to four times the cost of real ones; they must not
  /// outlive the pencil. Throws NoMemory or NotReached.
  [[nodiscard]] virtual ShiftedInverse shifted(std::complex<double> z) = 0;

 protected:
  Pencil() = default;
  Pencil(const Pencil&) = default;
  Pencil& operator=(const Pencil&) = default;
};

/// A = -L with that part of the static states, by any clock: with its rates e, functions u and
/// functionals c on the operator are e^1/2 u and e^-1/2 c here, and A = -e^-1/2 L e^-1/2. Releases
/// the systems that it has solved with.
class ProcessPencil final : public Pencil {
 public:
  ProcessPencil(generator::Systems& systems, generator::Symmetry symmetry,
                generator::StaticPhase static_phase,
                generator::Clock clock = generator::Clock::time);
  ~ProcessPencil() override;
  ProcessPencil(const ProcessPencil&) = delete;
  ProcessPencil& operator=(const ProcessPencil&) = delete;

  /// -L.
  [[nodiscard]] const generator::KolmogorovOperator& a() const { return a_; }
  /// x <- e^power/2 x. Collective.
  void by_clock(int power, Vec x) const;

  void multiply(Vec x, Vec y, bool transposed) const override;
  void solve(double z, Vec b, Vec x, bool transposed, bool refined) override;
  [[nodiscard]] ShiftedInverse shifted(std::complex<double> z) override;

 private:
  generator::Systems& systems_;
  generator::SystemKey key_;
  generator::KolmogorovOperator a_;
  linalg::VecHandle root_, inverse_root_;  // e^1/2, e^-1/2, unless the clock is time
  std::set<generator::SystemKey> used_;
};

/// A small model: c (z + A)^-1 b ~ gamma (z - m)^-1 beta.
struct Reduced {
  linalg::Matrix<double> m;
  std::vector<double> beta, gamma;
  /// Coordinates in the bases of the model: x ~ V to_right (z - m)^-1 beta, and w ~ gamma (z -
  /// m)^-1 to_left W^T.
  linalg::Matrix<double> to_right, to_left;
};

/// Right and left vectors and the weight D of a problem.
struct Ends {
  Vec b, c, weight;
};

/// The transfer function as it is, by factors of z + A.
struct Truth {
  std::complex<double> z;
  /// c (z + A)^-1 b; or, where `far`, c A (z + A)^-1 A b, which lacks the leading terms of the
  /// expansion in 1/z and keeps its digits however large z is.
  std::complex<double> value;
  bool far = false;
  generator::ComplexVector x;  ///< the solution, scaled like V
  ShiftedInverse inverse;      ///< none for real z
};

/// Size of b - (z + A) V y in the norm of a basis V that is orthonormal: with A V = V T + Q R and b
/// = V b_V + Q b_Q, the root of |b_V - (z + T) y|^2 + |b_Q - R y|^2. Q has few columns, as A V
/// leaves V in one direction for each shift.
class Residual {
 public:
  /// The first `size` columns of both. Collective. O(rows size columns(Q)).
  Residual(BV basis, BV image, int size, Vec end);
  /// Local. O(size^2).
  [[nodiscard]] double operator()(std::complex<double> z,
                                  const std::vector<std::complex<double>>& y) const;

 private:
  linalg::Matrix<double> t_, r_;
  std::vector<double> b_v_, b_q_;
};

/// Two-sided projection -(W^T V)^-1 W^T A V. V spans chains (s + A)^-1 ... b, W the
/// transposed chains from c, for real shifts s: real factorisations only. Each pair of vectors
/// matches two more derivatives of the transfer function at its shift. b, A b, c, c A, if they are
/// smooth enough to be of use, match four moments at infinity. A true solution at a complex z adds
/// its real and imaginary part. One-sided projections, W = V, fail by orders of magnitude in the
/// tail, and so does the orthogonal projection on V and W together in L2(D), although it cannot
/// have growing modes.
///
/// Vectors are orthogonalised in the scalar product with a weight D, V with D and W with D^-1: with
/// D near the stationary distribution both then are functions in L2(D). Without it V sees fast
/// bodies that never occur, W what does, and W^T V is near singular.
///
/// The error is r_c(z)^T (z + A)^-1 r_b(z), r the residuals of both sides.
class ReducedModel {
 public:
  /// Smooth b and c: V and W start with b, A b, c, c A. Rough ones, such as the value at a point,
  /// give no information at infinity; then W^T V is near singular all the same (1e-11 was seen).
  /// Those of a start in one state are rough, and what becomes of it has kinks in time.
  enum class Nature { smooth, rough, kinked };
  /// `pencil` must live as long; `ends.weight` > 0. Collective.
  ReducedModel(Pencil& pencil, const Ends& ends, Nature nature, int most_pairs);

  /// Adds up to `count` pairs of vectors of the chains of `shift` > 0 [1/time]; a new shift takes
  /// one factorisation, each pair one forward and one transposed solve. Returns how many were
  /// added: fewer when the space is full or invariant. Collective.
  int extend(double shift, int count);
  /// Adds the real and the imaginary part of (z + A)^-1 b and of c (z + A)^-1, so that the model is
  /// exact at z. Returns how many pairs were added. Collective.
  int interpolate(const Truth& truth);

  /// By complex factors, which it keeps. `far` for smooth ends alone. Collective.
  [[nodiscard]] Truth truth(std::complex<double> z, bool far) const;

  [[nodiscard]] int pairs() const { return pairs_; }
  [[nodiscard]] bool full() const { return pairs_ >= most_pairs_; }
  /// The projection on all vectors so far, without directions of V and W that see nothing of the
  /// other space: of size 0 when b is never felt at c. Collective. O(n pairs) for new pairs.
  [[nodiscard]] Reduced reduce();
  /// Those of V and b, and of W and c. Collective.
  [[nodiscard]] Residual right_residual() const { return {right_, image_, pairs_, b_}; }
  [[nodiscard]] Residual left_residual() const { return {left_, left_image_, pairs_, c_}; }

 private:
  bool append(Vec v, Vec w);
  void multiply(Vec x, Vec y, bool transposed) const;
  void resolve(double shift, Vec x, bool transposed, bool refined) const;
  [[nodiscard]] generator::ComplexVector shifted(const ShiftedInverse& inverse, Vec real,
                                                 bool transposed) const;

  Pencil& pencil_;
  linalg::VecHandle root_, inverse_root_;  // D^1/2, D^-1/2
  int most_pairs_, pairs_ = 0;
  linalg::BvHandle right_, left_;               // D^1/2 V, D^-1/2 W
  linalg::BvHandle image_, left_image_;         // D^1/2 A V, D^-1/2 A^T W
  linalg::VecHandle b_, c_;                     // scaled like V and W
  linalg::VecHandle ab_, ca_;                   // of smooth ends
  linalg::Matrix<double> overlap_, projected_;  // W^T V, W^T A V
  int projected_pairs_ = 0;
  struct Chain {
    linalg::VecHandle v, w;
  };
  std::map<double, Chain> chains_;
};

// The search for a reduced model that is good enough, and how that is known.

/// Numbers to be had from a reduced model of a transfer function H.
struct Questions {
  /// From a model, with what their evaluation leaves.
  std::function<std::vector<Uncertain>(const Reduced&)> values;
  /// Where they need it; the first and the last one are the low and the high end.
  std::vector<std::complex<double>> points;
  /// A value is off by at most the sum of weight |H - H_r|(points[point]).
  struct Term {
    std::size_t point;
    double weight;
  };
  std::vector<std::vector<Term>> terms;  ///< by value
  std::vector<double> shift;             ///< by value: one that serves it, for until_still()
  bool each_by_its_size = false;  ///< whether `tolerance` is relative to each value, or absolute
  double tolerance = 1e-8;
  std::vector<Recipe::Step> first;     ///< what a model begins with
  double lowest = 0, highest = 1e300;  ///< range of further shifts
  double far = kInfinity;              ///< |z| from where Truth::far is found
  int most_truths =
      12;  ///< true solutions at most; where they are dear, the answers are what they are
};

struct Answers {
  Reduced model;
  std::vector<double> value;
  std::vector<double> error;          ///< absolute
  double relative_error = kInfinity;  ///< the largest, in the sense of the questions
  int pairs = 0;                      ///< of vectors in the space
  int truths = 0;                     ///< true solutions that were compared
  std::vector<double> shifts;
};

/// Extends `model` until the answers are known to the tolerance. With r_b, r_c the residuals of the
/// model from both sides,
///
///   H(z) - H_r(z) = r_c(z)^T (z + A)^-1 r_b(z):
///
/// the product of their sizes says where the error is large, and true solutions at points that the
/// model was not made from say how large it is in those units. There are true solutions at both
/// ends and where the estimate is largest. While that exceeds the tolerance, the model gets a shift
/// of about |z| there, and where this does not help it interpolates the true solution. Returns the
/// best model met. `recipe`: of a coarser discretisation, or empty; it is brought up to date.
/// Collective.
[[nodiscard]] Answers ask(ReducedModel& model, const Questions& questions, Recipe& recipe);

/// The same for rough ends, where residuals are far from errors and W^T V is near singular: extends
/// `model` at all shifts alike until the values stand still, with shifts where they moved most.
/// True solutions at both ends and where the last vectors changed most say whether they stand in
/// the right place: what the model misses there counts as an error. Collective.
[[nodiscard]] Answers until_still(ReducedModel& model, const Questions& questions, Recipe& recipe);

// c exp(-A t) b and its integrals on reduced models.

/// Inverse Laplace transforms at the time t take rates up to this over t.
constexpr double kFastestOnContour = 12;

/// n-fold integrals from 0 to t of gamma exp(m t) beta, for each n of `folds` one for each time >
/// 0, by quadrature of the inverse Laplace transform on Talbot's contour with the parameters of
/// Weideman (SIAM J. Numer. Anal. 44, 2006); the error is three times what a narrower contour makes
/// of it. Growing modes that a two-sided projection may have lie outside the contour and do no
/// harm, as they would to exp(m t). Local. O(size^2) a time.
[[nodiscard]] std::vector<std::vector<Uncertain>>
evaluate(const Reduced& reduced, const std::vector<double>& time, const std::vector<int>& folds);

/// An n-fold integral that is wanted to a tolerance times `unit`.
struct Fold {
  int n;
  double unit;
};

/// How fast things happen: the correlation time of the noise, its rate, and the time in which a
/// body of a typical speed stops, by the clock of a pencil.
struct TimeScales {
  double correlation, rate, stopping;
};

/// Integrals of c exp(-A t) b with their errors, by fold and time.
struct TimeCurve {
  std::vector<std::vector<Uncertain>> value;
  int pairs = 0;  ///< of vectors of the reduced model
};
/// By reduced models grown until they stand still; what they miss of the tolerance is in the
/// errors. Collective.
[[nodiscard]] TimeCurve time_curve(Pencil& pencil, const Ends& ends, ReducedModel::Nature nature,
                                   const std::vector<Fold>& folds, const std::vector<double>& time,
                                   const TimeScales& scales, double tolerance, Recipe& recipe);
/// Those of a process, by the clock of time.
[[nodiscard]] TimeScales time_scales(const model::Process& process);

}  // namespace stickslip::quantities
