#include "stickslip/quantities/phase_field.hpp"

#include <algorithm>
#include <iterator>

#include "stickslip/operators/state_space.hpp"

namespace stickslip::quantities {

PhaseField::PhaseField(const operators::Discretisation& discretisation,
                       const operators::StateSpace& states, Kind kind)
    : noise_(discretisation.noise),
      lowest_(discretisation.process.noise.lowest()),
      kind_(kind),
      local_noise_(states.local_noise()) {
  const auto& chain = discretisation.process.noise;
  for (int i = chain.lowest(); i <= chain.highest(); ++i) x_.push_back(chain.level(i));
  const auto nodes = discretisation.velocities->nodes();
  std::transform(nodes.rbegin(), nodes.rend(), std::back_inserter(v_),
                 [](double node) { return -node; });
  v_.insert(v_.end(), nodes.begin(), nodes.end());
  by_node_.assign(local_noise_.size() * v_.size(), 0.0);
}

std::size_t PhaseField::row_start(int noise) const {
  const auto place = std::lower_bound(local_noise_.begin(), local_noise_.end(), noise);
  return static_cast<std::size_t>(place - local_noise_.begin()) * v_.size();
}

void PhaseField::add(operators::Branch branch, int noise, int node, double value) {
  const std::size_t nodes = v_.size() / 2;
  const bool upper = branch == operators::Branch::positive;
  by_node_[upper ? row_start(noise) + nodes + node : row_start(-noise) + nodes - 1 - node] += value;
}

template <class Visit>
void PhaseField::for_each_group(Visit visit) const {
  for (auto n = local_noise_.begin(); n != local_noise_.end();) {
    const auto& group = noise_->group_of(*n);
    visit(group);
    n += group.count;
  }
}

std::vector<std::size_t> PhaseField::local_levels() const {
  std::vector<std::size_t> levels;
  for_each_group([&](const noise::Nodes::Group& group) {
    for (int i = group.first - lowest_; i <= group.last - lowest_; ++i) {
      levels.push_back(static_cast<std::size_t>(i));
    }
  });
  return levels;
}

std::vector<double> PhaseField::local_rows() const {
  std::vector<double> rows;
  for_each_group([&](const noise::Nodes::Group& group) {
    const double* nodes = by_node_.data() + row_start(group.begin);
    for (int i = group.first; i <= group.last; ++i) {
      const auto shares = group.row(kind_ == Kind::function ? group.value : group.weight, i);
      for (std::size_t v = 0; v < v_.size(); ++v) {
        double sum = 0;
        for (std::size_t l = 0; l < shares.size(); ++l) sum += shares[l] * nodes[l * v_.size() + v];
        rows.push_back(sum);
      }
    }
  });
  return rows;
}

}  // namespace stickslip::quantities
