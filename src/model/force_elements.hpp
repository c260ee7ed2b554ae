#pragma once
/// Continuous piecewise polynomials along the force, for noise of continuous paths.

#include <cstddef>
#include <utility>
#include <vector>

#include "stickslip/linalg/dense.hpp"
#include "stickslip/model/noise_chain.hpp"

namespace stickslip::model {

// Polynomials by their values at nodes.

/// Nodes and weights of the Gauss-Legendre rule on [-1, 1].
struct LegendreRule {
  std::vector<double> node, weight;

  explicit LegendreRule(int size);
};

/// At a place the polynomial that is 1 at the k-th node and 0 at the others.
[[nodiscard]] double cardinal(const std::vector<double>& nodes, std::size_t k, double at);
/// D_kl: the derivatives of these polynomials l at the nodes k.
[[nodiscard]] linalg::Matrix<double> derivatives(const std::vector<double>& nodes);

// Elements along the force.

/// Weight of functions of the force: the normal density, or 1.
using Weight = double (*)(double);
[[nodiscard]] double normal_weight(double z);
[[nodiscard]] double even_weight(double z);

/// Nodes z and weights w of the Gauss-Lobatto rule on an element, exact for polynomials of degree 2
/// p - 1, and the derivatives D_kl of its cardinal functions l at its nodes k.
struct ForceElement {
  std::vector<double> z, w;
  linalg::Matrix<double> d;

  ForceElement(double low, double high, int p, Weight weight);
  /// The cardinal function of a node.
  [[nodiscard]] double cardinal(std::size_t k, double at) const {
    return model::cardinal(z, k, at);
  }
};

/// Ends of elements and their degrees.
struct ForceMesh {
  std::vector<double> ends;
  std::vector<int> degrees;
};

/// A force at which functions are not smooth.
struct SpecialForce {
  double z;
  double size;   ///< of the elements beside it
  bool balance;  ///< whether elements beside it need few digits, as they are short
  bool upper;    ///< the side to which bodies move there
};

/// Where bodies start and where friction balances the force, in units of `scale`: the elements
/// beside balance points have the size `finest`, beside other starts at least `at_starts`.
[[nodiscard]] std::vector<SpecialForce> special_forces(const Thresholds& thresholds, double scale,
                                                       double finest, double at_starts);

/// Elements on [-reach, reach] that end at the special points and grow from there, none longer than
/// `longest`; of the degree `at_rest` inside of starts.
[[nodiscard]] ForceMesh force_mesh(const std::vector<SpecialForce>& special, double reach,
                                   double longest, int degree, int at_rest);

/// Functions of the force on the nodes of a mesh: weights W, <Du, Dv> and <v, Du>. Nodes at cuts
/// are doubled and tied together by a penalty, so that a function may jump there.
struct AlongForce {
  std::vector<double> z, w;
  linalg::Matrix<double> stiffness, slope;
  std::vector<int> cuts;                               ///< the upper of both nodes
  std::vector<std::pair<int, ForceElement>> elements;  ///< with the first of their nodes

  AlongForce(const ForceMesh& mesh, const std::vector<double>& at, Weight weight);
  [[nodiscard]] static int nodes_of(const ForceMesh& mesh, const std::vector<double>& cuts);
  /// By node the mean of f under what the node stands for: its function times the weight. Sums over
  /// nodes of such means are integrals of f whether or not f is smooth. Adaptive: some 200
  /// values of f on each element, 600 more beside a jump.
  [[nodiscard]] std::vector<double> means(const FunctionOfNoise& f) const;
  /// The element that holds a force within the mesh.
  [[nodiscard]] const std::pair<int, ForceElement>& element_at(double z) const;
  /// Forces of nodes, with those on both sides of a cut told apart: the one that sticks at `start`
  /// itself, the outer one beyond.
  [[nodiscard]] std::vector<double> forces(double scale, double upper_start,
                                           double lower_start) const;

 private:
  Weight weight_;

  void append(const ForceElement& element, bool own);
  void tie(int node, double length);
};

/// Of the nodes on both sides of a start [scale of forces].
inline constexpr double kApart = 1e-9;

}  // namespace stickslip::model
