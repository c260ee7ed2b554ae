#pragma once
/// Leading eigenvalues of L: the slowest relaxation rates and their modes.

#include <complex>
#include <string>
#include <vector>

#include "stickslip/generator/system_key.hpp"
#include "stickslip/quantities/density.hpp"
#include "stickslip/quantities/results.hpp"

namespace stickslip::generator {
class Systems;

}  // namespace stickslip::generator

namespace stickslip::quantities {

/// Prefix of the PETSc options of this eigensolver.
inline const std::string kRelaxPrefix = "relax_";

/// A mode exp(-rate t) phi(x, y, v) of the backward equation, L phi = -rate phi.
struct RelaxationMode {
  std::complex<double> rate;   ///< real part: decay, imaginary part >= 0: frequency [1/time]
  double residual = 0;         ///< of the eigensolver
  double spread = 0;           ///< distance to rates that rounding cannot distinguish from this one
  PhaseField real, imaginary;  ///< phi on the grid, largest modulus 1
  std::vector<std::complex<double>>
      at_rest;  ///< phi(x_i, 0, 0), from the lowest level up, on all ranks
};

/// The modes of functions of one symmetry, slowest first.
struct RelaxationSector {
  generator::Symmetry symmetry;
  std::vector<RelaxationMode> modes;
};

/// What the rates and the frequencies of functions of one symmetry are called.
struct RelaxationRows {
  const Row &rate, &frequency;
};
[[nodiscard]] RelaxationRows relaxation_rows(generator::Symmetry symmetry);

/// The modes of functions of one symmetry with the smallest decay rates, the constant function left
/// out: half as many as the eigensolver is asked for (-relax_eps_nev, 8 unless given), since those
/// come in conjugate pairs, of which the member with frequency >= 0 is kept. One assembly, one
/// factorisation and some 55 solves. Collective. Throws NotReached or NoMemory.
///
/// Rounding splits a (nearly) defective double rate into rates about sqrt(rounding) apart, at times
/// conjugate, at times real. So a frequency below 1e-5 |rate| counts as none: both members of such
/// a pair are kept, as two real modes whose fields agree to about as many digits as the rates do.
/// `spread`, part of the error of a rate, is its distance to the rates that are as close as that.
[[nodiscard]] RelaxationSector relaxation_modes(generator::Systems& systems,
                                                generator::Symmetry symmetry);

/// Rates and frequencies, by number of the mode.
void append_relaxation(const RelaxationSector& sector, Results& results);

}  // namespace stickslip::quantities
