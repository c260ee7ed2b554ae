#pragma once
/// Linear evolution equations of which reduced models are made.

#include <complex>
#include <memory>
#include <set>

#include "stickslip/operators/complex_solver.hpp"
#include "stickslip/operators/systems.hpp"
#include "stickslip/petsc/handle.hpp"

namespace stickslip::quantities {

/// (z + A)^-1 at one complex z. Collective.
class ShiftedPencil {
 public:
  virtual ~ShiftedPencil() = default;
  /// x = (z + A)^-1 b, or with the transpose (no conjugation), after iterative refinement. Throws
  /// NotReached.
  [[nodiscard]] virtual operators::ComplexVector solve(const operators::ComplexVector& b,
                                                       bool transposed) = 0;

 protected:
  ShiftedPencil() = default;
  ShiftedPencil(const ShiftedPencil&) = default;
  ShiftedPencil& operator=(const ShiftedPencil&) = default;
};

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
  [[nodiscard]] virtual std::unique_ptr<ShiftedPencil> shifted(std::complex<double> z) = 0;

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
  ProcessPencil(operators::Systems& systems, operators::Symmetry symmetry,
                operators::StaticPhase static_phase,
                operators::Clock clock = operators::Clock::time);
  ~ProcessPencil() override;
  ProcessPencil(const ProcessPencil&) = delete;
  ProcessPencil& operator=(const ProcessPencil&) = delete;

  /// -L.
  [[nodiscard]] const operators::KolmogorovOperator& a() const { return a_; }
  /// x <- e^power/2 x. Collective.
  void by_clock(int power, Vec x) const;

  void multiply(Vec x, Vec y, bool transposed) const override;
  void solve(double z, Vec b, Vec x, bool transposed, bool refined) override;
  [[nodiscard]] std::unique_ptr<ShiftedPencil> shifted(std::complex<double> z) override;

 private:
  class Shifted;

  operators::Systems& systems_;
  operators::SystemKey key_;
  operators::KolmogorovOperator a_;
  petsc::VecHandle root_, inverse_root_;  // e^1/2, e^-1/2, unless the clock is time
  std::set<operators::SystemKey> used_;
};

}  // namespace stickslip::quantities
