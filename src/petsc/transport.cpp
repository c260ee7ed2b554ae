#include "stickslip/petsc/transport.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "stickslip/petsc/dense.hpp"

namespace stickslip::petsc {
namespace {

using Scalars = std::vector<PetscScalar>;

}  // namespace

Transport::Transport(int levels, std::vector<TransportStrip> strips)
    : levels_(levels), strips_(std::move(strips)) {
  int widest = 0;
  for (const TransportStrip& s : strips_) widest = std::max(widest, s.element->height());
  ends_.resize(2 * strips_.size() * levels_);
  work_.resize(static_cast<std::size_t>(widest) * levels_);
  speed_.resize(static_cast<std::size_t>(levels_));
}

Transport Transport::sizes() const {
  Transport bound = *this;
  bound.sizes_ = true;
  std::map<const TransportElement*, std::shared_ptr<const TransportElement>> known;
  for (TransportStrip& s : bound.strips_) {
    auto& element = known[s.element.get()];
    if (!element) {
      TransportElement positive = *s.element;
      take_sizes(positive.rows);
      take_sizes(positive.lifting);
      element = std::make_shared<const TransportElement>(std::move(positive));
    }
    s.element = element;
  }
  return bound;
}

void Transport::subtract(const PetscScalar* x, PetscScalar* y, bool transposed) const {
  if (levels_ == 0) return;
  if (transposed) return subtract_transposed(x, y);
  subtract_plain(x, y);
}

const double* Transport::speed_at(const TransportStrip& s, int node) const {
  const double drag = s.drag[node], scale = 1 / s.length;
  for (int a = 0; a < levels_; ++a) speed_[a] = ((*s.excess)[a] + drag) * scale;
  if (sizes_) {
    for (double& speed : speed_) speed = std::abs(speed);
  }
  return speed_.data();
}

// The values at all ends first, then derivatives and jumps.
void Transport::subtract_plain(const PetscScalar* x, PetscScalar* y) const {
  const int levels = levels_;
  const double sign = sizes_ ? 1 : -1;
  for (std::size_t n = 0; n < strips_.size(); ++n) {
    const TransportElement& e = *strips_[n].element;
    product("NT", levels, 2, e.nodes, 1, x + strips_[n].first, levels, e.rows.data() + e.nodes,
            e.height(), 0, ends(static_cast<int>(n)), levels);
  }
  Scalars jump_out(levels), jump_in(levels);
  for (std::size_t n = 0; n < strips_.size(); ++n) {
    const TransportStrip& s = strips_[n];
    const TransportElement& e = *s.element;
    const int q = e.nodes;
    const PetscScalar* own_out = ends(static_cast<int>(n));
    const PetscScalar* own_in = own_out + levels;
    const PetscScalar* beyond_out = s.outer < 0 ? nullptr : ends(s.outer) + levels;
    const PetscScalar* beyond_in = s.inner < 0 ? nullptr : ends(s.inner);
    for (int a = 0; a < levels; ++a) {
      const Speeds leaving = speeds(n, a);
      const PetscScalar out = beyond_out == nullptr ? 0.0 : beyond_out[a];
      const PetscScalar in = beyond_in == nullptr ? 0.0 : beyond_in[a];
      jump_out[a] = leaving.up / s.length * (out + sign * own_out[a]);
      jump_in[a] = leaving.down / s.length * (in + sign * own_in[a]);
    }
    product("NT", levels, q, q, 1, x + s.first, levels, e.rows.data(), e.height(), 0, work_.data(),
            levels);
    for (int m = 0; m < q; ++m) {
      const PetscScalar* slope = work_.data() + static_cast<std::ptrdiff_t>(levels) * m;
      PetscScalar* to = y + s.first + static_cast<std::ptrdiff_t>(levels) * m;
      const PetscScalar lift_out = e.lifting[m], lift_in = e.lifting[q + m];
      const double* speed = speed_at(s, m);
      for (int a = 0; a < levels; ++a) {
        to[a] += sign * (speed[a] * slope[a] + lift_out * jump_out[a] + lift_in * jump_in[a]);
      }
    }
  }
}

// What leaves through all ends first.
void Transport::subtract_transposed(const PetscScalar* x, PetscScalar* y) const {
  const int levels = levels_;
  const double sign = sizes_ ? 1 : -1;
  for (std::size_t n = 0; n < strips_.size(); ++n) {
    const TransportStrip& s = strips_[n];
    const int q = s.element->nodes;
    PetscScalar* out = ends(static_cast<int>(n));
    PetscScalar* in = out + levels;
    product("NN", levels, 2, q, 1, x + s.first, levels, s.element->lifting.data(), q, 0, out,
            levels);
    for (int a = 0; a < levels; ++a) {
      const Speeds leaving = speeds(n, a);
      out[a] *= leaving.up / s.length;
      in[a] *= leaving.down / s.length;
    }
  }
  for (std::size_t n = 0; n < strips_.size(); ++n) {
    const TransportStrip& s = strips_[n];
    const TransportElement& e = *s.element;
    const int q = e.nodes;
    for (int m = 0; m < q; ++m) {
      const PetscScalar* from = x + s.first + static_cast<std::ptrdiff_t>(levels) * m;
      PetscScalar* scaled = work_.data() + static_cast<std::ptrdiff_t>(levels) * m;
      const double* speed = speed_at(s, m);
      for (int a = 0; a < levels; ++a) scaled[a] = speed[a] * from[a];
    }
    const PetscScalar* own_out = ends(static_cast<int>(n));
    const PetscScalar* own_in = own_out + levels;
    // Beyond b lies the element that leaves inwards to here, beyond a the one that leaves outwards.
    const PetscScalar* beyond_out = s.outer < 0 ? nullptr : ends(s.outer) + levels;
    const PetscScalar* beyond_in = s.inner < 0 ? nullptr : ends(s.inner);
    PetscScalar* at_out = work_.data() + static_cast<std::ptrdiff_t>(levels) * q;
    PetscScalar* at_in = at_out + levels;
    for (int a = 0; a < levels; ++a) {
      at_out[a] = sign * own_out[a] + (beyond_out == nullptr ? 0.0 : beyond_out[a]);
      at_in[a] = sign * own_in[a] + (beyond_in == nullptr ? 0.0 : beyond_in[a]);
    }
    product("NN", levels, q, e.height(), sign, work_.data(), levels, e.rows.data(), e.height(), 1,
            y + s.first, levels);
  }
}

Transport::Terms Transport::terms(std::size_t n) const {
  const TransportStrip& s = strips_[n];
  const TransportElement& e = *s.element;
  const int q = e.nodes;
  Terms t;
  for (Scalars* matrix : {&t.by_excess, &t.constant, &t.by_up, &t.by_down}) {
    matrix->resize(static_cast<std::size_t>(q) * q);
  }
  for (int k = 0; k < q; ++k) {
    const PetscScalar* column = e.rows.data() + static_cast<std::ptrdiff_t>(e.height()) * k;
    for (int m = 0; m < q; ++m) {
      const int at = m + q * k;
      t.by_excess[at] = column[m] / s.length;
      t.constant[at] = s.drag[m] * column[m] / s.length;
      t.by_up[at] = -e.lifting[m] * column[q] / s.length;
      t.by_down[at] = -e.lifting[q + m] * column[q + 1] / s.length;
    }
  }
  return t;
}

PetscInt64 Transport::entries() const {
  PetscInt64 sum = 0;
  for (std::size_t n = 0; n < strips_.size(); ++n) {
    const TransportStrip& s = strips_[n];
    const PetscInt64 q = s.element->nodes;
    for (int a = 0; a < levels_; ++a) {
      const Speeds leaving = speeds(n, a);
      sum += q * q;
      if (leaving.up > 0 && s.outer >= 0) sum += q * strips_[s.outer].element->nodes;
      if (leaving.down > 0 && s.inner >= 0) sum += q * strips_[s.inner].element->nodes;
    }
  }
  return sum;
}

}  // namespace stickslip::petsc
