#pragma once
/// What is factored of a velocity branch in the elimination of elements.

#include <cstddef>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "stickslip/base/errors.hpp"
#include "stickslip/generator/element_system.hpp"
#include "stickslip/linalg/session.hpp"

namespace stickslip::generator {

template <class Scalar>
MPI_Datatype mpi_type() {
  return std::is_same_v<Scalar, double> ? MPI_DOUBLE : MPI_C_DOUBLE_COMPLEX;
}

/// The elements of a velocity branch, and the elimination of the values between them: its part of
/// the list w of ElementElimination, those at v = 0 first, then those at v_1 ... Lists by noise
/// node count along the branch. Ranks share the elements.
template <class Scalar>
class BranchFactors {
 public:
  using Matrix = linalg::Matrix<Scalar>;
  using Factors = linalg::LuFactors<Scalar>;
  using Element = ElementSystem<Scalar>;
  using Steps = LinearSteps<Scalar>;

  /// Of `before` elements of other branches ranks have their shares. Local.
  BranchFactors(const Nodes& noise, const HpDiscretisation& velocities,
                std::vector<double> net_force, Shift<Scalar> shift, MPI_Comm comm,
                std::size_t before)
      : noise_(noise),
        velocities_(velocities),
        net_force_(std::move(net_force)),
        shift_(shift),
        comm_(comm),
        before_(before),
        elements_(static_cast<std::size_t>(velocities.elements())) {
    for (int e = 0; e <= velocities.elements(); ++e) {
      rising_.push_back(first_rising(net_force_, velocities.drag_at_end(e)));
    }
  }

  [[nodiscard]] const HpDiscretisation& velocities() const { return velocities_; }
  /// By element; null for those of other ranks.
  [[nodiscard]] const std::vector<std::unique_ptr<Element>>& elements() const { return elements_; }
  /// How many nodes fall to v = 0.
  [[nodiscard]] int falling() const { return rising_[0]; }
  /// Places in w of the first value at an end of elements, and of the first that rises there.
  [[nodiscard]] std::size_t falling_at(int end) const {
    return static_cast<std::size_t>(end) * net_force_.size();
  }
  [[nodiscard]] std::size_t rising_at(int end) const { return falling_at(end) + rising_[end]; }
  /// R at v = 0.
  [[nodiscard]] const Matrix& reflection() const { return reflection_; }
  /// From v_max to 0, and back from the values that fall there.
  [[nodiscard]] const Steps& inwards() const { return inwards_; }
  [[nodiscard]] const Steps& outwards() const { return outwards_; }
  [[nodiscard]] double entries() const {
    double sum = inwards_.entries() + outwards_.entries();
    for (const auto& element : elements_) sum += element ? element->entries() : 0;
    return sum;
  }

  /// Factors the elements of this rank, where there are others, which can wait for one that fails:
  /// returns what it says. Local.
  [[nodiscard]] std::string make_shared_elements() {
    responses_.resize(elements_.size());
    try {
      for (std::size_t e = 0; e < elements_.size(); ++e) {
        if (owner(e) == linalg::rank(comm_)) responses_[e] = make_element(e);
      }
    } catch (const NotReached& singular) {
      return singular.what();
    }
    return "";
  }

  /// From v_max down to v = 0: w takes up what each element gives, as it comes back from above.
  /// Collective. Throws NotReached if a block is singular.
  void reflect() {
    Matrix reflection = hold();
    std::vector<std::pair<Matrix, Matrix>> outwards;
    for (int e = velocities_.elements(); e-- > 0;) {
      auto s = response(static_cast<std::size_t>(e));
      const int falling = rising_[e + 1];
      Matrix turns = Matrix::identity(falling);
      linalg::add_product(-1, s.outer_outer, reflection, falling, turns);
      Factors factors(std::move(turns));
      Matrix through = std::move(s.outer_inner);
      factors.solve(through);
      Matrix returned = reflection * through;
      linalg::add_product(1, s.inner_outer, returned, returned.columns(), s.inner_inner);
      const std::size_t fall = falling_at(e + 1), rise = rising_at(e + 1);
      inwards_.add(std::move(s.outer_outer), rise, fall);
      inwards_.solve(std::move(factors), fall);
      inwards_.add(std::exchange(reflection, std::move(s.inner_inner)), fall, rise);
      inwards_.add(std::move(s.inner_outer), rise, rising_at(e));
      outwards.emplace_back(std::move(through), std::move(returned));
    }
    reflection_ = reflection;
    outwards_.add(std::move(reflection), falling_at(0), rising_at(0));
    for (int e = 0; e < velocities_.elements(); ++e) {
      auto& [through, returned] = outwards[outwards.size() - 1 - static_cast<std::size_t>(e)];
      outwards_.add(std::move(through), falling_at(e), falling_at(e + 1));
      outwards_.add(std::move(returned), falling_at(e), rising_at(e + 1));
    }
  }

 private:
  using Response = typename Element::Response;

  [[nodiscard]] int count() const { return static_cast<int>(net_force_.size()); }
  // The rank that has an element.
  [[nodiscard]] int owner(std::size_t e) const {
    return static_cast<int>((before_ + e) % static_cast<std::size_t>(linalg::ranks(comm_)));
  }

  Response make_element(std::size_t e) {
    Response response;
    elements_[e] = std::make_unique<Element>(noise_, velocities_, static_cast<int>(e), net_force_,
                                             shift_, response);
    return response;
  }

  // Sends a matrix from the owner of an element to all ranks.
  void send(std::size_t e, int rows, int columns, Matrix& a) const {
    if (linalg::rank(comm_) != owner(e)) a = Matrix(rows, columns);
    MPI_Bcast(a.data(), rows * columns, mpi_type<Scalar>(), owner(e), comm_);
  }

  // What an element makes of the values beyond its ends, on all ranks.
  [[nodiscard]] Response response(std::size_t e) {
    if (linalg::ranks(comm_) == 1) return make_element(e);
    Response s = std::move(responses_[e]);
    const int all = count(), inner = rising_[e], outer = rising_[e + 1];
    send(e, all - inner, inner, s.inner_inner);
    send(e, all - inner, all - outer, s.inner_outer);
    send(e, outer, inner, s.outer_inner);
    send(e, outer, all - outer, s.outer_outer);
    return s;
  }

  // What holding states make of the values that fall at v_max; where bodies are killed, nothing.
  [[nodiscard]] Matrix hold() {
    const int below = rising_[velocities_.elements()], held = count() - below;
    if (velocities_.kills_at_top()) return {held, below};
    Matrix own(held, held), jumps(held, below);
    for (int l = 0; l < held; ++l) {
      own(l, l) = shift_.at(velocities_.v_max());
      const auto leave = [&](int to, double rate) {
        const int place = to - noise_.first();
        own(l, l) += rate;
        if (place < below) {
          jumps(l, place) += rate;
        } else {
          own(l, place - below) -= rate;
        }
      };
      const int node = noise_.first() + below + l;
      for (const auto& [to, rate] : noise_.jumps(node)) leave(to, rate);
      for (const auto& [to, rate] : noise_.carried(node)) leave(to, rate * velocities_.v_max());
    }
    Factors factors(std::move(own));
    factors.solve(jumps);
    inwards_.solve(std::move(factors), rising_at(velocities_.elements()));
    return jumps;
  }

  const Nodes& noise_;
  const HpDiscretisation& velocities_;
  std::vector<double> net_force_;
  Shift<Scalar> shift_;
  MPI_Comm comm_;
  std::size_t before_;
  std::vector<int> rising_;  // by end of elements: the first node that rises there
  std::vector<std::unique_ptr<Element>> elements_;
  std::vector<Response> responses_;  // of shared elements, until they are used
  Matrix reflection_;
  Steps inwards_, outwards_;
};

}  // namespace stickslip::generator
