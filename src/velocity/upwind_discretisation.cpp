#include "stickslip/velocity/upwind_discretisation.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace stickslip::velocity {

UpwindDiscretisation::UpwindDiscretisation(double spacing, int count, const model::Drag& drag)
    : spacing_(spacing), drag_(drag) {
  if (!(spacing > 0) || count < 1)
    throw std::invalid_argument("upwind velocity discretisation without nodes");
  cells_.push_back(0);
  for (int j = 1; j <= count; ++j) {
    nodes_.push_back(j * spacing);
    weights_.push_back(spacing);
    cells_.push_back((j + 0.5) * spacing);
    drag_at_nodes_.push_back(drag(nodes_.back()));
  }
}

std::unique_ptr<VelocityDiscretisation> UpwindDiscretisation::up_to(double speed) const {
  const int steps = std::max(2, static_cast<int>(std::lround(speed / spacing_)));
  return std::make_unique<UpwindDiscretisation>(speed / steps, steps - 1, drag_);
}

std::unique_ptr<VelocityDiscretisation> UpwindDiscretisation::split_at(double speed) const {
  const int steps = std::max(2, static_cast<int>(std::lround(speed / spacing_)));
  const double spacing = speed / steps;
  const int all = static_cast<int>(std::lround(v_max() / spacing));
  auto split = std::make_unique<UpwindDiscretisation>(spacing, std::max(steps - 1, all), drag_);
  split->end_at_speed(steps - 2);
  return split;
}

void UpwindDiscretisation::transport(double net_force, int j, TransportRow& row) const {
  const double speed = net_force + drag_at_nodes_[j];
  fill(j, speed, speed / spacing_, row);
}

void UpwindDiscretisation::transport_change(double net_force, const SpeedChange& change, int j,
                                            TransportRow& row) const {
  fill(j, net_force + drag_at_nodes_[j], change(nodes_[j]) / spacing_, row);
}

void UpwindDiscretisation::fill(int j, double direction, double rate, TransportRow& row) const {
  row.entries.clear();
  row.inflow = row.outflow = row.killed = 0;
  if (direction < 0 && j > 0) row.entries.push_back({j - 1, -rate});
  if (direction < 0 && j == 0) row.inflow = -rate;
  if (direction > 0 && j < size() - 1 && !kills_above(j)) row.entries.push_back({j + 1, rate});
  if (direction > 0 && kills_above(j)) row.killed = rate;
}

// Between two nodes; below the first one, where a cell of its own begins, its value.
std::vector<Entry> UpwindDiscretisation::value_at(double v) const {
  const double place = std::clamp(v / spacing_ - 1, 0.0, size() - 1.0);
  const int below = std::min(static_cast<int>(place), size() - 2);
  if (below < 0) return {{0, 1.0}};
  return {{below, 1 - (place - below)}, {below + 1, place - below}};
}

// A node stands for the cell around it; the mass is spread evenly over the cell.
double UpwindDiscretisation::mass_below(std::span<const double> mass, double v) const {
  double below = 0;
  for (int j = 0; j < size(); ++j) {
    const double share = (v - nodes_[j]) / spacing_ + 0.5;
    below += mass[j] * std::clamp(share, 0.0, 1.0);
  }
  return below;
}

}  // namespace stickslip::velocity
