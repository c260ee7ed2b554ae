#include "stickslip/quantities/displacement_tail.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace stickslip::quantities {
namespace {

using Complex = std::complex<double>;

// Logarithm of probabilities that nobody looks for.
constexpr double kNothing = -32;
constexpr double kWithin = 2;  // deviations beyond the mean of the last weight

}  // namespace

DisplacementTail::DisplacementTail(const Computation& computation, double time,
                                   std::vector<Atom> atoms, int side, double mass, double mean,
                                   double deviation)
    : computation_(computation), time_(time), atoms_(std::move(atoms)), side_(side) {
  weights_.push_back({0, std::log(mass), mean, deviation});
}

// The part without atoms of E exp((s + i k) x), in units of what its model gives.
exact::FourierInversion::Transformed DisplacementTail::transform(const Weight& of, double k) const {
  const auto found = of.model->at(k);
  const double growth = (of.log_size - std::log(of.scaled)) / time_;
  Complex value = found.value;
  double error = found.error;
  for (const Atom& atom : atoms_) {
    const double size = std::exp(of.s * atom.at - growth * time_);
    value -= std::polar(size * atom.probability.value, k * atom.at);
    error += size * atom.probability.error;
  }
  return {value / of.scaled, error / of.scaled};
}

bool DisplacementTail::add_weight() {
  constexpr double first = 1.5, further = 1.2, probe = 0.5;
  constexpr std::size_t most = 14;
  const Weight& last = weights_.back();
  if (ended_) return false;
  const auto& question = computation_.question();
  // Cumulants of the last one predict the next.
  const double ds = side_ * (weights_.size() == 1 ? first : further) / last.deviation,
               square = last.deviation * last.deviation;
  Weight next;
  next.s = last.s + ds;
  next.log_size = last.log_size + ds * last.mean + ds * ds * square / 2;
  next.model = std::make_unique<DisplacementModel>(
      computation_.systems, computation_.distribution(), question.start, time_,
      0.1 * question.accuracy, Tilt{next.s, next.log_size / time_});
  ended_ = !next.model->resolved();
  if (ended_) return false;
  const auto size = transform(next, 0);
  ended_ = !(size.value.real() > 2 * size.error);
  if (ended_) return false;
  next.scaled = size.value.real();
  next.doubt = size.error / next.scaled;
  next.log_size += std::log(next.scaled);
  const double expected = last.mean + ds * square, k = probe / last.deviation;
  const Complex turned = transform(next, k).value * std::polar(1.0, -k * expected);
  next.mean = expected + std::arg(turned) / k;
  next.deviation = std::sqrt(std::max(-2 * std::log(std::abs(turned)), 1e-6)) / k;
  ended_ = side_ * (next.mean - last.mean) <= 0 || weights_.size() >= most ||
           next.log_size - next.s * next.mean < kNothing;
  weights_.push_back(std::move(next));
  return true;
}

Uncertain DisplacementTail::by(Weight& weight, double d, OfInversion of) {
  if (!weight.inversion) {
    constexpr int most = 40;
    weight.inversion.emplace([&](double k) { return transform(weight, k); }, weight.s, weight.mean,
                             weight.deviation, 0.2 * computation_.question().accuracy, most);
  }
  const auto found = (*weight.inversion.*of)(d);
  const Uncertain size{1, weight.doubt};
  return std::exp(weight.log_size - weight.s * d) * (size * found);
}

Uncertain DisplacementTail::at(double d, OfInversion of) {
  const auto bound = [&] { return weights_.back().log_size - weights_.back().s * d; };
  const auto below = [&] { return side_ * (d - weights_.back().mean); };
  while ((weights_.size() < 3 || below() > 0) && bound() > kNothing && add_weight()) {
  }
  if (weights_.size() < 3 || below() > kWithin * weights_.back().deviation) {
    return {0, std::exp(bound())};
  }
  std::size_t n = 2;
  while (n + 1 < weights_.size() && side_ * (weights_[n].mean - d) < 0) ++n;
  Uncertain one = by(weights_[n - 1], d, of), other = by(weights_[n], d, of);
  if (other.error < one.error) std::swap(one, other);
  return {one.value, one.error + std::abs(one.value - other.value)};
}

double DisplacementTail::end(double p) {
  const auto beyond_last = [&] {
    const Weight& last = weights_.back();
    return last.log_size - last.s * last.mean - std::log1p(2.5 * std::abs(last.s) * last.deviation);
  };
  while ((weights_.size() < 3 || beyond_last() > std::log(p)) && add_weight()) {
  }
  return weights_.back().mean + side_ * kWithin * weights_.back().deviation;
}

int DisplacementTail::evaluations() const {
  int all = 0;
  for (const Weight& weight : weights_) {
    if (weight.model) all += 2;
    if (weight.inversion) all += weight.inversion->evaluations();
  }
  return all;
}

}  // namespace stickslip::quantities
