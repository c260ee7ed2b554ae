#include "stickslip/run/routes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <stdexcept>

#include "stickslip/base/errors.hpp"
#include "stickslip/case/sticking_rows.hpp"
#include "stickslip/generator/static_chain.hpp"
#include "stickslip/quantities/durations.hpp"

namespace stickslip::run {
namespace {

using cases::Quantity;
using linalg::LuFactors;
using quantities::Excursion;
using quantities::Uncertain;

using Matrix = linalg::Matrix<double>;

/// Noise levels by the sign of their fluid rate x_i + g - mu_d.
struct Phases {
  explicit Phases(const model::Process& process) {
    for (int i = process.noise.lowest(); i <= process.noise.highest(); ++i) {
      const double rate = process.net_force(i);
      (rate > 0 ? rising : rate < 0 ? falling : still).push_back(i);
    }
  }
  std::vector<int> rising, falling, still;  // `still`: at the force mu_d - g
};

/// T - lambda between groups of phases, the still ones censored: what passes through them counts as
/// a direct jump, discounted for the time in them.
class Jumps {
 public:
  Jumps(const model::Process& process, const Phases& phases, double lambda)
      : process_(process), phases_(phases), lambda_(lambda), still_(still_phases()) {}

  /// Mean discounted times in the still phases by the jumps from another one in a unit of time.
  [[nodiscard]] std::vector<double> in_still(int from) const {
    return still_.occupation(rates(from, phases_.still));
  }

  /// diag(|x_i + g - mu_d|)^-1 T between two groups.
  [[nodiscard]] Matrix per_length(const std::vector<int>& from, const std::vector<int>& to) const {
    Matrix m(static_cast<int>(from.size()), static_cast<int>(to.size()));
    std::vector<std::vector<double>> from_still;
    for (int s : phases_.still) from_still.push_back(rates(s, to));
    for (int r = 0; r < m.rows(); ++r) {
      auto row = rates(from[r], to);
      const auto time = in_still(from[r]);
      for (std::size_t c = 0; c < row.size(); ++c) {
        for (std::size_t s = 0; s < time.size(); ++s) row[c] += time[s] * from_still[s][c];
        m(r, static_cast<int>(c)) = row[c] / std::abs(process_.net_force(from[r]));
      }
    }
    return m;
  }

 private:
  // To phases of a group, in their rising order; to itself less all rates of leaving.
  [[nodiscard]] std::vector<double> rates(int from, const std::vector<int>& group) const {
    std::vector<double> all(group.size(), 0.0);
    const auto add = [&](int to, double rate) {
      const auto place = std::ranges::lower_bound(group, to);
      if (place != group.end() && *place == to) all[place - group.begin()] += rate;
    };
    process_.noise.for_each_jump(from, add);
    add(from, -(process_.noise.rate(from) + lambda_));
    return all;
  }
  [[nodiscard]] linalg::RateElimination still_phases() const {
    std::vector<double> killing;
    std::vector<linalg::RateElimination::Rate> among;
    for (int from : phases_.still) {
      const int row = static_cast<int>(killing.size());
      killing.push_back(lambda_);
      process_.noise.for_each_jump(from, [&](int to, double rate) {
        const auto place = std::ranges::lower_bound(phases_.still, to);
        const bool still = place != phases_.still.end() && *place == to;
        if (still) among.push_back({row, static_cast<int>(place - phases_.still.begin()), rate});
        if (!still) killing.back() += rate;
      });
    }
    return {std::move(killing), among};
  }

  const model::Process& process_;
  const Phases& phases_;
  double lambda_;
  linalg::RateElimination still_;
};

double largest_diagonal(const Matrix& m) {
  double size = 0;
  for (int i = 0; i < m.rows(); ++i) size = std::max(size, std::abs(m(i, i)));
  return size;
}

/// Only products of one factor e and one f enter: where one grows and the other falls doubly
/// exponentially, sharing their sizes keeps both in range.
void balance(Matrix& e, Matrix& f) {
  const double factor = std::sqrt(f.largest() / e.largest());
  if (!std::isnormal(factor)) return;
  e *= factor;
  f *= 1 / factor;
}

/// Largest change of an entry relative to the entry.
double largest_ratio(const Matrix& change, const Matrix& h) {
  double ratio = 0;
  for (int c = 0; c < h.columns(); ++c) {
    for (int r = 0; r < h.rows(); ++r) {
      if (h(r, c) > 0) ratio = std::max(ratio, std::abs(change(r, c)) / h(r, c));
    }
  }
  return ratio;
}

/// Minimal non-negative X with X C X - X D - A X + B = 0, [D -C; -B A] an M-matrix.
struct Riccati {
  Matrix a, b, c, d;

  [[nodiscard]] Matrix solve() const {
    const double alpha = largest_diagonal(a), beta = largest_diagonal(d), sum = alpha + beta;
    const int m = a.rows(), n = d.rows();
    const LuFactors a_shifted(a + Matrix::identity(m, beta));
    const LuFactors d_shifted(d + Matrix::identity(n, alpha));
    const Matrix into_a = a_shifted.solved(b), into_d = d_shifted.solved(c);
    const LuFactors w(a + Matrix::identity(m, beta) - b * into_d);
    const LuFactors v(d + Matrix::identity(n, alpha) - c * into_a);
    // I - sum V^-1 = V^-1 (D - beta - C A_beta^-1 B): all terms of one sign.
    Matrix e = v.solved(d - Matrix::identity(n, beta) - c * into_a);
    Matrix f = w.solved(a - Matrix::identity(m, alpha) - b * into_d);
    Matrix g = sum * d_shifted.solved(c * w.solved(Matrix::identity(m)));
    Matrix h = sum * w.solved(b * d_shifted.solved(Matrix::identity(n)));
    constexpr int most = 60;
    for (int step = 0; step < most; ++step) {
      balance(e, f);
      const LuFactors gh(Matrix::identity(n) - g * h), hg(Matrix::identity(m) - h * g);
      const Matrix change = f * hg.solved(h * e);
      g += e * gh.solved(g * f);
      h += change;
      // Convergence is quadratic: what is left is the square of the last change.
      if (largest_ratio(change, h) <= 1e-9) return h;
      e = e * gh.solved(e);
      f = f * hg.solved(f);
    }
    throw std::runtime_error("the doubling algorithm of the fluid queue does not converge");
  }

  [[nodiscard]] double residual(const Matrix& x) const {
    const Matrix terms = x * c * x + b;
    return (terms - x * d - a * x).largest() / terms.largest();
  }
};

/// The queue of one velocity branch, seen along its motion; empty where no body starts.
class Queue {
 public:
  Queue(const model::Process& process, double lambda)
      : process_(process),
        phases_(process_),
        jumps_(process_, phases_, lambda),
        riccati_{-1.0 * jumps_.per_length(phases_.rising, phases_.rising),
                 jumps_.per_length(phases_.rising, phases_.falling),
                 jumps_.per_length(phases_.falling, phases_.rising),
                 -1.0 * jumps_.per_length(phases_.falling, phases_.falling)},
        psi_(starts() == 0 ? Matrix(0, 0) : riccati_.solve()),
        minus_k_(starts() == 0 ? Matrix::identity(1) : riccati_.a - psi_ * riccati_.c) {}
  Queue(const Queue&) = delete;
  Queue& operator=(const Queue&) = delete;

  [[nodiscard]] double residual() const { return starts() == 0 ? 0 : riccati_.residual(psi_); }
  /// Bodies start in the phases highest_static + 1 ... highest.
  [[nodiscard]] int starts() const { return process_.noise.highest() - process_.highest_static(); }
  [[nodiscard]] int lowest_static() const { return process_.lowest_static(); }
  [[nodiscard]] int count_static() const { return process_.highest_static() - lowest_static() + 1; }

  /// Probability that a body that starts in phase highest_static + 1 + start is back at 0 in phase
  /// i; calls visit(i, p).
  template <class Visit>
  void for_each_return(int start, Visit visit) const {
    for (std::size_t c = 0; c < phases_.falling.size(); ++c) {
      visit(phases_.falling[c], psi_(row(start), static_cast<int>(c)));
    }
  }

  /// Adds what a body does that starts `number` times in each phase. The density of upcrossings of
  /// v by phase is starts exp(K v), K = C_u^-1 T_uu + Psi C_d^-1 T_du; its moments are powers of
  /// (-K)^-1.
  void follow(const double* number, std::size_t first, SlidingMeans& slide) const {
    if (starts() == 0) return;
    std::vector<double> moment(phases_.rising.size(), 0.0);
    for (int s = 0; s < starts(); ++s) moment[row(s)] = number[s];
    double factorial = 1;
    for (auto* sums : {&slide.slide_time, &slide.slide_distance, &slide.slide_square}) {
      minus_k_.solve(moment, true);
      spend(phases_.rising, moment, factorial, &(*sums)[first]);
      spend(phases_.falling, moment * psi_, factorial, &(*sums)[first]);
      factorial *= sums == &slide.slide_time ? 1 : 2;
    }
  }

 private:
  [[nodiscard]] int row(int start) const {
    return static_cast<int>(phases_.rising.size()) - starts() + start;
  }

  void spend(const std::vector<int>& group, const std::vector<double>& crossings, double factorial,
             double* sums) const {
    const auto add = [&](int phase, double spent) {
      sums[phase - process_.noise.lowest()] += spent;
    };
    for (std::size_t p = 0; p < group.size(); ++p) {
      const double spent = factorial * crossings[p] / std::abs(process_.net_force(group[p]));
      add(group[p], spent);
      const auto still = jumps_.in_still(group[p]);
      for (std::size_t s = 0; s < still.size(); ++s) add(phases_.still[s], spent * still[s]);
    }
  }

  model::Process process_;
  Phases phases_;
  Jumps jumps_;
  Riccati riccati_;
  Matrix psi_;
  LuFactors<double> minus_k_;
};

/// Both velocity branches, and what a return to v = 0 leads to.
class Boundary {
 public:
  Boundary(const Queue& upper, const Queue& lower)
      : upper_(upper),
        lower_(lower),
        restart_(upper.starts() + lower.starts(), upper.starts() + lower.starts()),
        to_static_(restart_.rows(), upper.count_static()) {
    fill(upper, 0, upper.starts(), 1);
    fill(lower, upper.starts(), 0, -1);
    factors_ = LuFactors(Matrix::identity(restart_.rows()) - restart_);
  }

  /// The sliding phase that begins on a level that does not stick. The negative branch is counted
  /// in `sums` from `below` on.
  [[nodiscard]] SlidingMeans slide(int level, std::size_t sums_of_both, std::size_t below) const {
    std::vector<double> number(static_cast<std::size_t>(restart_.rows()), 0.0);
    // Those of the positive branch come first.
    const int lowest = upper_.lowest_static(), first = lowest + upper_.count_static();
    number[level >= first ? level - first : upper_.starts() + lowest - 1 - level] = 1;
    factors_.solve(number, true);
    SlidingMeans slide;
    for (auto* sums : {&slide.slide_time, &slide.slide_distance, &slide.slide_square}) {
      sums->assign(sums_of_both, 0.0);
    }
    slide.entry = number * to_static_;
    slide.turns = std::accumulate(number.begin(), number.end(), -1.0);
    upper_.follow(number.data(), 0, slide);
    lower_.follow(number.data() + upper_.starts(), below, slide);
    return slide;
  }

 private:
  // Returns of a branch whose starts have the numbers from `from` on; `sign` turns its phases into
  // levels.
  void fill(const Queue& queue, int from, int others_from, int sign) {
    for (int s = 0; s < queue.starts(); ++s) {
      queue.for_each_return(s, [&](int i, double p) {
        if (i < queue.lowest_static()) {
          restart_(from + s, others_from + queue.lowest_static() - 1 - i) += p;
        } else {
          to_static_(from + s, sign * i - upper_.lowest_static()) += p;
        }
      });
    }
  }

  const Queue &upper_, &lower_;
  Matrix restart_, to_static_;
  LuFactors<double> factors_;
};

FluidQueue solve(const model::Process& process, double lambda) {
  try {
    return FluidQueue(process, lambda);
  } catch (const std::runtime_error& error) {
    throw NotReached(std::string(error.what()) +
                     "; sliding phases last too long against the noise, take a larger -mu_d");
  }
}

double sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

// With the sticking phase that follows.
Excursion excursion_of(const model::Process& process, Excursion e) {
  e.entry_plus = e.entry;
  e.lost_probability = sum(e.entry) - 1;
  e.stick_time = generator::StaticChain::of(process).occupation(e.entry);
  return e;
}

// What is left of sum P = 1 and of the Riccati equation is rounding, and grows with the length of
// sliding phases, whose moments it changes by about that factor.
double relative_rounding(const Excursion& e, const FluidQueue& queue) {
  const double speed = sum(e.slide_distance) / e.mean_slide();
  const double defect = std::abs(e.lost_probability) + std::abs(queue.residual()) +
                        std::numeric_limits<double>::epsilon();
  return 4 * defect * (1 + speed);
}

// From the distribution of X as the queue has it, not from its closed form.
void append_noise_distribution(const model::Process& process,
                               const std::vector<double>& distribution,
                               quantities::Results& results) {
  const auto& noise = process.noise;
  const double mu_s = process.friction.mu_s;
  const int low = noise.first_from(-mu_s), high = noise.last_up_to(mu_s);
  double within = 0, square = 0;
  for (int i = noise.lowest(); i <= noise.highest(); ++i) {
    const double p = distribution[i - noise.lowest()];
    if (low <= i && i <= high) within += p;
    square += p * noise.level(i) * noise.level(i);
  }
  results.push_back(quantities::scalar(cases::kPWithin, within, 0));
  results.push_back(quantities::scalar(cases::kEX2, square, 0));
}

/// What the queue gives of excursions as they follow one another.
struct Excursions {
  Excursion mean;
  quantities::Starts starts;
};

Excursions excursions_of(const model::Process& process, const FluidQueue& queue) {
  if (process.symmetric()) {
    return {excursion_of(process, queue.plus()), quantities::Starts::upwards(process)};
  }
  const std::vector<int> levels = process.starts();
  std::vector<Excursion> from;
  for (int level : levels) from.push_back(excursion_of(process, queue.from(level)));
  const auto starts = quantities::chain_of_starts(process, levels, from);
  return {quantities::joined(process, starts, from), starts};
}

std::vector<Uncertain> uncertain(const std::vector<double>& p, double rounding) {
  std::vector<Uncertain> all;
  for (double value : p) all.push_back({value, rounding * value});
  return all;
}

void append_laplace(const Problem& problem, const Excursions& excursions, double rounding,
                    quantities::Results& results) {
  const auto& process = problem.discretisation.process;
  const auto transform = [&](double lambda, const std::vector<double>& entry) {
    return quantities::stick_transform(process, lambda, uncertain(entry, rounding));
  };
  std::vector<quantities::DurationTransforms> transforms;
  for (double lambda : problem.given.question.lambda) {
    const FluidQueue killed = solve(process, lambda);
    double slide = 0;
    Uncertain excursion;
    const auto& [levels, shares, next] = excursions.starts;
    for (std::size_t t = 0; t < levels.size(); ++t) {
      const auto& entry = killed.from(levels[t]).entry;
      slide += shares[t] * sum(entry);
      excursion = excursion + shares[t] * transform(lambda, entry);
    }
    transforms.push_back(
        {{slide, rounding * slide}, transform(lambda, excursions.mean.entry), excursion});
  }
  quantities::append_laplace(problem.given.question.lambda, transforms, results);
}

}  // namespace

FluidQueue::FluidQueue(const model::Process& process, double lambda) {
  if (!process.drag.is_none()) throw std::invalid_argument("a fluid queue has no drag");
  const Queue upper(process, lambda);
  std::optional<Queue> lower;
  if (!process.symmetric()) lower.emplace(process.mirrored(), lambda);
  const Queue& other = lower ? *lower : upper;
  residual_ = std::max(upper.residual(), other.residual());
  const Boundary boundary(upper, other);
  const auto levels = static_cast<std::size_t>(process.noise.count());
  const std::size_t below = lower ? levels : 0;
  plus_ = process.exit_level(true);
  for (int level : lower ? process.starts() : std::vector{plus_}) {
    from_.emplace(level, boundary.slide(level, levels + below, below));
  }
}

Evaluation by_fluid_queue(const Problem& problem) {
  const auto& question = problem.given.question;
  const auto& process = problem.discretisation.process;
  const linalg::PhaseTimer timer("fluid queue", problem.statistics.factorization_seconds);
  const FluidQueue queue = solve(process, 0);
  const Excursions excursions = excursions_of(process, queue);
  const Excursion& excursion = excursions.mean;
  const double rounding = relative_rounding(excursion, queue);
  Evaluation evaluation;
  auto& results = evaluation.results;
  if (question.wants(Quantity::sticking)) quantities::append_sticking(excursion, results);
  if (question.wants(Quantity::moments))
    quantities::append_moments(problem.discretisation, excursion, results);
  if (question.wants(Quantity::entry_law)) {
    quantities::append_hitting_distribution(process, excursion, results);
  }
  if (question.wants(Quantity::noise_law)) {
    append_noise_distribution(
        process, quantities::marginal_of_noise(problem.discretisation, excursion), results);
  }
  for (auto& r : results) {
    // E_V is a difference of the two velocity branches.
    const double least = r.kind == quantities::Kind::drift && process.drifts()
                             ? sum(excursion.slide_distance) / excursion.mean_excursion()
                             : 0;
    for (std::size_t n = 0; n < r.value.size(); ++n) {
      r.error[n] = rounding * std::max(std::abs(r.value[n]), least);
    }
  }
  if (question.wants(Quantity::laplace)) {
    quantities::attempt(problem, evaluation, Quantity::laplace,
                        [&] { append_laplace(problem, excursions, rounding, results); });
  }
  if (question.wants(Quantity::stick_duration_transform) && !question.wants(Quantity::laplace)) {
    quantities::append_stick_transform(process, question.lambda,
                                       uncertain(excursion.entry, rounding), results);
  }
  evaluation.checks = {
      {"riccati_residual", queue.residual(), "relative residual of the Riccati equations"},
      {"lost_probability", excursion.lost_probability, "sum of the hitting distribution less 1"}};
  return evaluation;
}

}  // namespace stickslip::run
