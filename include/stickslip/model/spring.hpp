#pragma once
/// A body on a spring.

#include <memory>
#include <vector>

#include "stickslip/model/drag.hpp"
#include "stickslip/model/noise_chain.hpp"

namespace stickslip::model {

struct AlongForce;

/// dp/dt = v, dv/dt = f + b(v) - F(|v|) sign v with the force f = X - K (p - g/K) of the noise and
/// the spring; a body sticks while |f| <= mu_s. A bias g shifts all positions by g/K and does
/// nothing else. Nodes stand for pairs of a force and a position:
///
///   L = (f - F + b(v)) d/dv + C + v D,
///
/// C the noise at a fixed position, D the transport of the position by the motion. Of a noise on
/// levels f = x_n - K p_j, C its jumps and D = d/dp by discontinuous elements, which end where a
/// level starts or stops to hold a body. Of an Ornstein-Uhlenbeck process, of deviation sigma and
/// correlation time tau,
///
///   C = (sigma^2/tau) d^2/df^2 - ((f + K p)/tau) d/df,   D = d/dp - K d/df,
///
/// by continuous polynomials along f as in GaussianNoise, with even weights. Positions end where
/// the energy of a body driven by the noise has fallen off. Source: docs/spring.md. Local.
class Spring final : public Projector {
 public:
  /// An Ornstein-Uhlenbeck process.
  struct Coloured {
    double deviation, tau;
  };
  struct Body {
    double stiffness;  ///< K > 0 [1/time^2]
    double bias;       ///< g [force]
    Friction friction;
    Drag drag;
  };
  Spring(Body body, const Coloured& noise);
  /// Throws UnfitTable if all levels hold the body at some positions, where it stays for ever.
  Spring(Body body, const NoiseChain& chain);

  /// The noise on levels; null where it is an Ornstein-Uhlenbeck process.
  [[nodiscard]] const NoiseChain* chain() const { return chain_.get(); }
  [[nodiscard]] bool fits(const Thresholds& thresholds, int order) const override;
  static constexpr std::size_t kMostPairs = 3000;  ///< that fit to be solved for

 private:
  // Deviations in the stationary state of the body whose friction is replaced by the linear drag
  // that takes as much power; and by how many of them positions and forces reach out.
  struct Scales {
    double position, velocity, force;
    double drag;  // all of it, per velocity
  };
  [[nodiscard]] Projection projection(const Thresholds& thresholds, int order) const override;
  [[nodiscard]] std::size_t pairs(const Thresholds& thresholds, int order) const;
  [[nodiscard]] Scales find_scales() const;
  [[nodiscard]] double reach(int order) const;
  [[nodiscard]] Projection of_coloured(const Thresholds& thresholds, int order) const;
  [[nodiscard]] Shown shown_by(const AlongForce& x, const std::vector<double>& positions) const;
  [[nodiscard]] Projection of_chain(const Thresholds& thresholds, int order) const;
  [[nodiscard]] std::vector<double> ends_of_positions(const Thresholds& thresholds,
                                                      int order) const;

  Body body_;
  Coloured noise_;
  std::shared_ptr<const NoiseChain> chain_;
  Scales scales_;
};

}  // namespace stickslip::model
