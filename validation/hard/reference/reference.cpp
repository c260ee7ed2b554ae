/// Dry friction with noise in extended precision. Shares nothing with the program: no mesh of
/// elements, no weak form, no symmetry reduction; and every number that the program gets from a
/// transposed solve comes from backward equations here.
///
/// On a velocity branch the backward equations (lambda + Lambda) u_i - Lambda (alpha_i u_{i+1} + (1
/// - alpha_i) u_{i-1}) - B_i(v) u_i' = f_i have bounded solutions that are analytic, also where a
/// B_i has its root v_i*: there u_i is fixed by its neighbours, order by order. So the branch is
/// split into pieces, each a Taylor series about a root v_i* or about an ordinary point, well
/// inside the distance to all other roots (complex ones too). From the top down, the levels that
/// move up at v are a function of those that move down, u_up = Psi u_down + w: Psi is the
/// distribution of the level at the first return to v. Without drag Psi does not depend on v and
/// solves a Riccati equation, here by Newton's method. Excursions are then linear algebra on the
/// levels at v = 0.
///
///   reference N LO HI MU_D TAU DELTA C_ABOVE C_BELOW CUBIC BIAS SHARE [lambda L]... [omega W]...
///
/// LO, HI: first and last static level. C_ABOVE, C_BELOW: drag coefficients for v > 0 and v < 0
/// (both 0: no drag). SHARE: reach of a series over its radius of convergence. Numbers are taken as
/// doubles, exactly. lambda and omega need a symmetric process. -DDIGITS=60 at compile time.

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/cpp_complex.hpp>

#include <algorithm>
#include <complex>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

#ifndef DIGITS
#define DIGITS 60
#endif

namespace mp = boost::multiprecision;
using Real = mp::number<mp::cpp_bin_float<DIGITS>, mp::et_off>;
using Complex = mp::number<mp::complex_adaptor<mp::cpp_bin_float<DIGITS>>, mp::et_off>;

namespace {

Real size(const Real& x) { return abs(x); }
Real size(const Complex& z) { return abs(z.real()) + abs(z.imag()); }

template <class S>
struct Matrix {
  int rows = 0, cols = 0;
  std::vector<S> a;
  Matrix() = default;
  Matrix(int r, int c) : rows(r), cols(c), a(static_cast<std::size_t>(r) * c, S(0)) {}
  S& operator()(int i, int j) { return a[static_cast<std::size_t>(i) * cols + j]; }
  const S& operator()(int i, int j) const { return a[static_cast<std::size_t>(i) * cols + j]; }
};

template <class S>
Matrix<S> operator*(const Matrix<S>& x, const Matrix<S>& y) {
  Matrix<S> z(x.rows, y.cols);
  for (int i = 0; i < x.rows; ++i)
    for (int k = 0; k < x.cols; ++k)
      if (x(i, k) != 0)
        for (int j = 0; j < y.cols; ++j) z(i, j) += x(i, k) * y(k, j);
  return z;
}

/// a x = b by elimination with row pivots; b becomes x.
template <class S>
void solve(Matrix<S> a, Matrix<S>& b) {
  const int n = a.rows;
  for (int k = 0; k < n; ++k) {
    int pivot = k;
    for (int i = k + 1; i < n; ++i)
      if (size(a(i, k)) > size(a(pivot, k))) pivot = i;
    for (int j = k; j < n; ++j) std::swap(a(k, j), a(pivot, j));
    for (int j = 0; j < b.cols; ++j) std::swap(b(k, j), b(pivot, j));
    for (int i = k + 1; i < n; ++i) {
      if (a(i, k) == 0) continue;
      const S factor = a(i, k) / a(k, k);
      for (int j = k + 1; j < n; ++j) a(i, j) -= factor * a(k, j);
      for (int j = 0; j < b.cols; ++j) b(i, j) -= factor * b(k, j);
    }
  }
  for (int k = n - 1; k >= 0; --k)
    for (int j = 0; j < b.cols; ++j) {
      for (int i = k + 1; i < n; ++i) b(k, j) -= a(k, i) * b(i, j);
      b(k, j) /= a(k, k);
    }
}

struct Scene {
  int levels, lo, hi;  // levels -N .. N; static ones lo .. hi
  Real mu_d, tau, delta, c_above, c_below, cubic, bias, share;
  int count() const { return 2 * levels + 1; }
  Real rate() const { return 2 / (tau * tau * delta * delta); }
  Real up(int i) const {
    if (std::abs(i) == levels) return i < 0 ? 1 : 0;
    return (1 - tau * delta * delta * i / 2) / 2;
  }
  bool frictionless() const { return c_above == 0 && c_below == 0 && cubic == 0; }
  bool symmetric() const { return c_above == c_below && bias == 0; }
};

/// A velocity branch v > 0; the negative one is that of the mirrored process (-X, -Y, -V).
struct Side {
  const Scene& scene;
  bool below;
  int n;
  std::vector<Real> x, force, alpha;  // by i + N in the coordinates of this side
  Real c, rate;
  Side(const Scene& s, bool lower) : scene(s), below(lower), n(s.count()), rate(s.rate()) {
    c = lower ? s.c_below : s.c_above;
    for (int i = -s.levels; i <= s.levels; ++i) {
      x.push_back(s.delta * i);
      force.push_back(x.back() + (lower ? Real(-s.bias) : s.bias) - s.mu_d);
      alpha.push_back(s.up(i));
    }
  }
  Real speed(int e, const Real& v) const { return force[e] - v * (c + scene.cubic * v * v); }
};

/// Real root of B_e, and all others in double precision (they only limit how far a series reaches).
Real root(const Side& side, int e) {
  const Real& k = side.scene.cubic;
  if (k == 0) return side.force[e] / side.c;
  Real v = mp::cbrt(side.force[e] / k);
  if (side.c > 0 && abs(v) > abs(side.force[e] / side.c)) v = side.force[e] / side.c;
  for (int n = 0; n < 200; ++n) {  // convex between the root and either start
    const Real step = side.speed(e, v) / (side.c + 3 * k * v * v + Real(v == 0));
    v += step;
    if (abs(step) <= abs(v) * mp::pow(Real(10), 5 - DIGITS)) break;
  }
  return v;
}

std::vector<std::complex<double>> other_roots(const Side& side, const Real& v) {
  if (side.scene.cubic == 0) return {};
  const double r = v.convert_to<double>(), q = (side.c / side.scene.cubic).convert_to<double>();
  const double depth = std::sqrt(std::max(0.0, 0.75 * r * r + q));
  return {{-r / 2, depth}, {-r / 2, -depth}};
}

/// Series about `centre` used on [bottom, top]; `own` is the level whose root the centre is, or -1.
struct Piece {
  Real centre, bottom, top;
  int own;
};

class Cuts {
 public:
  explicit Cuts(const Side& side) : side_(side) {
    for (int e = 0; e < side.n; ++e) {
      roots_.push_back(root(side, e));
      for (const auto& z : other_roots(side, roots_.back())) complex_.push_back(z);
    }
    Real at = 0;
    for (int e = 0; e < side.n; ++e) {
      if (roots_[e] < 0) continue;
      while (roots_[e] - at > side.scene.share * radius(roots_[e], e)) at = ordinary(at);
      const Real end = roots_[e] + side.scene.share * radius(roots_[e], e);
      pieces.push_back({roots_[e], at, e == side.n - 1 ? roots_[e] : end, e});
      at = end;
    }
  }
  std::vector<Piece> pieces;

 private:
  Real radius(const Real& v, int own) const {
    Real least = 1e30;
    for (int e = 0; e < side_.n; ++e)
      if (e != own) least = std::min<Real>(least, abs(v - roots_[e]));
    const double at = v.convert_to<double>();
    for (const auto& z : complex_)
      if (std::abs(at - z) > 0) least = std::min<Real>(least, Real(std::abs(at - z)));
    return least;
  }
  Real ordinary(const Real& bottom) {
    Real low = bottom, high = roots_.back();
    for (int n = 0; n < 60; ++n) {
      const Real middle = (low + high) / 2;
      (middle - bottom < side_.scene.share * radius(middle, -1) ? low : high) = middle;
    }
    pieces.push_back({low, bottom, low + (low - bottom), -1});
    return pieces.back().top;
  }
  const Side& side_;
  std::vector<Real> roots_;
  std::vector<std::complex<double>> complex_;
};

/// f_e about a centre: coefficient of h^m on level e.
template <class S>
using Source = std::function<S(int piece, const Real& centre, int e, int m)>;

/// v^power times a weight of the level.
template <class S>
Source<S> power(int p, std::function<Real(int)> weight) {
  return [p, weight](int, const Real& centre, int e, int m) -> S {
    if (m > p) return S(0);
    Real binomial = 1;
    for (int j = 0; j < m; ++j) binomial = binomial * (p - j) / (j + 1);
    return S(weight(e) * binomial * (p == m ? Real(1) : Real(mp::pow(centre, p - m))));
  };
}

/// What a branch does to levels at v = 0: u_up = psi u_down + w, a column of w for each source.
template <class S>
struct Return {
  std::vector<int> up, down;
  Matrix<S> psi, w;
};

template <class S>
class HalfLine {
 public:
  HalfLine(const Side& side, const S& lambda) : side_(side), lambda_(lambda), cuts_(side) {}

  const std::vector<Piece>& pieces() const { return cuts_.pieces; }

  Return<S> first_return(const std::vector<Source<S>>& sources) {
    Return<S> now;
    for (int e = 0; e < side_.n; ++e) now.down.push_back(e);
    now.psi = Matrix<S>(0, side_.n);
    now.w = Matrix<S>(0, static_cast<int>(sources.size()));
    parameters_.assign(cuts_.pieces.size(), {});
    down_.assign(cuts_.pieces.size(), {});
    for (int j = static_cast<int>(cuts_.pieces.size()) - 1; j >= 0; --j)
      now = below(j, now, sources);
    return now;
  }

  /// The solution as series, given its downward levels at v = 0, after first_return with one
  /// source.
  std::vector<std::vector<std::vector<S>>> series(const std::vector<S>& down_at_0,
                                                  const std::vector<Source<S>>& sources) {
    std::vector<std::vector<std::vector<S>>> found;
    std::vector<S> down = down_at_0;
    for (std::size_t j = 0; j < cuts_.pieces.size(); ++j) {
      const Matrix<S>& p = parameters_[j];
      const int given = static_cast<int>(down.size());
      std::vector<S> start(side_.n, S(0));
      for (std::size_t r = 0, e = 0; e < start.size(); ++e) {
        if (static_cast<int>(e) == cuts_.pieces[j].own) continue;
        for (int q = 0; q < given; ++q) start[e] += p(static_cast<int>(r), q) * down[q];
        start[e] += p(static_cast<int>(r), given);
        ++r;
      }
      found.push_back(coefficients(static_cast<int>(j), start, &sources[0]));
      if (j + 1 == cuts_.pieces.size()) break;
      down.clear();
      for (int e : down_[j + 1])
        down.push_back(value(found.back(), e, cuts_.pieces[j].top - cuts_.pieces[j].centre));
    }
    return found;
  }

 private:
  static S value(const std::vector<std::vector<S>>& terms, int e, const Real& h) {
    S sum(0);
    for (auto term = terms.rbegin(); term != terms.rend(); ++term) sum = sum * S(h) + (*term)[e];
    return sum;
  }

  /// terms[m][e] until they no longer count at either end.
  std::vector<std::vector<S>> coefficients(int j, const std::vector<S>& start, const Source<S>* f) {
    const Piece& piece = cuts_.pieces[j];
    const int n = side_.n;
    const Real reach = std::max<Real>(piece.top - piece.centre, piece.centre - piece.bottom);
    const Real k = side_.scene.cubic, slope = -side_.c - 3 * k * piece.centre * piece.centre,
               bend = -3 * k * piece.centre;
    std::vector<Real> speed(n);
    for (int e = 0; e < n; ++e) speed[e] = e == piece.own ? Real(0) : side_.speed(e, piece.centre);
    std::vector<std::vector<S>> a(1, start);
    const auto neighbours = [&](const std::vector<S>& u, int e) {
      S sum(0);
      if (e + 1 < n) sum += side_.alpha[e] * u[e + 1];
      if (e > 0) sum += (1 - side_.alpha[e]) * u[e - 1];
      return S(side_.rate * sum);
    };
    const auto curved = [&](int m, int e) {
      S sum(0);
      if (k != 0 && m >= 2) sum += a[m - 1][e] * (bend * (m - 1));
      if (k != 0 && m >= 3) sum -= a[m - 2][e] * (k * (m - 2));
      return sum;
    };
    Real scale = 0, height = 1;
    int quiet = 0;
    for (int m = 0;; ++m) {
      if (piece.own >= 0) {
        const int e = piece.own;
        S right = neighbours(a[m], e) + curved(m, e);
        if (f) right += (*f)(j, piece.centre, e, m);
        a[m][e] = right / (lambda_ + side_.rate - slope * m);
      }
      Real largest = 0;
      for (const S& term : a[m]) largest = std::max<Real>(largest, size(term));
      largest *= height;
      scale = std::max(scale, largest);
      quiet = largest <= scale * mp::pow(Real(10), -DIGITS) ? quiet + 1 : 0;
      if (quiet > 8 || reach == 0) return a;
      if (m > 4000) throw std::runtime_error("a series does not end");
      height *= reach;
      std::vector<S> next(n, S(0));
      for (int e = 0; e < n; ++e) {
        if (e == piece.own) continue;
        S right = (lambda_ + side_.rate - slope * m) * a[m][e] - neighbours(a[m], e) - curved(m, e);
        if (f) right -= (*f)(j, piece.centre, e, m);
        next[e] = right / S(speed[e] * (m + 1));
      }
      a.push_back(std::move(next));
    }
  }

  /// From the top of a piece to its bottom.
  Return<S> below(int j, const Return<S>& above, const std::vector<Source<S>>& sources) {
    const Piece& piece = cuts_.pieces[j];
    const int n = side_.n, free = piece.own < 0 ? n : n - 1,
              given = static_cast<int>(sources.size());
    const bool last = piece.own == n - 1;
    Matrix<S> bottom(n, free + given), top(n, free + given);
    const auto fill = [&](int column, const std::vector<S>& start, const Source<S>* f) {
      const auto terms = coefficients(j, start, f);
      for (int e = 0; e < n; ++e) {
        bottom(e, column) = value(terms, e, piece.bottom - piece.centre);
        top(e, column) = value(terms, e, piece.top - piece.centre);
      }
    };
    for (int e = 0, column = 0; e < n; ++e) {
      if (e == piece.own) continue;
      std::vector<S> start(n, S(0));
      start[e] = S(1);
      fill(column++, start, nullptr);
    }
    for (int q = 0; q < given; ++q) fill(free + q, std::vector<S>(n, S(0)), &sources[q]);
    Return<S> result;
    for (int e = 0; e < n; ++e) {
      const bool rises = e == piece.own || std::count(above.up.begin(), above.up.end(), e);
      (rises ? result.up : result.down).push_back(e);
    }
    const int down = static_cast<int>(result.down.size());
    Matrix<S> system(free, free), right(free, down + given);
    for (int r = 0; r < down; ++r) {
      for (int z = 0; z < free; ++z) system(r, z) = bottom(result.down[r], z);
      right(r, r) = S(1);
      for (int q = 0; q < given; ++q) right(r, down + q) = -bottom(result.down[r], free + q);
    }
    for (int r = 0; !last && r < static_cast<int>(above.up.size()); ++r) {
      const auto defect = [&](int column) {
        S sum = top(above.up[r], column);
        for (std::size_t d = 0; d < above.down.size(); ++d)
          sum -= above.psi(r, static_cast<int>(d)) * top(above.down[d], column);
        return sum;
      };
      for (int z = 0; z < free; ++z) system(down + r, z) = defect(z);
      for (int q = 0; q < given; ++q) right(down + r, down + q) = above.w(r, q) - defect(free + q);
    }
    solve(system, right);
    parameters_[j] = right;
    down_[j] = result.down;
    const int up = static_cast<int>(result.up.size());
    result.psi = Matrix<S>(up, down);
    result.w = Matrix<S>(up, given);
    for (int r = 0; r < up; ++r)
      for (int column = 0; column < down + given; ++column) {
        S sum = column < down ? S(0) : bottom(result.up[r], free + column - down);
        for (int z = 0; z < free; ++z) sum += bottom(result.up[r], z) * right(z, column);
        (column < down ? result.psi(r, column) : result.w(r, column - down)) = sum;
      }
    return result;
  }

  const Side& side_;
  S lambda_;
  Cuts cuts_;
  std::vector<Matrix<S>>
      parameters_;  // of each piece, by its downward levels at the bottom and sources
  std::vector<std::vector<int>> down_;
};

Matrix<Real> noise(const Side& side, const Real& lambda) {
  Matrix<Real> t(side.n, side.n);
  for (int e = 0; e < side.n; ++e) {
    t(e, e) = -side.rate - lambda;
    if (e + 1 < side.n) t(e, e + 1) = side.rate * side.alpha[e];
    if (e > 0) t(e, e - 1) = side.rate * (1 - side.alpha[e]);
  }
  return t;
}

/// Psi without drag: Psi A Psi + Psi B + C Psi + E = 0 by Newton's method from 0.
Return<Real> riccati(const Side& side, const Real& lambda) {
  Return<Real> r;
  for (int e = 0; e < side.n; ++e) (side.force[e] > 0 ? r.up : r.down).push_back(e);
  const Matrix<Real> t = noise(side, lambda);
  const int p = static_cast<int>(r.up.size()), q = static_cast<int>(r.down.size());
  const auto block = [&](const std::vector<int>& rows, const std::vector<int>& cols) {
    Matrix<Real> m(static_cast<int>(rows.size()), static_cast<int>(cols.size()));
    for (int i = 0; i < m.rows; ++i)
      for (int j = 0; j < m.cols; ++j) m(i, j) = t(rows[i], cols[j]) / abs(side.force[rows[i]]);
    return m;
  };
  const Matrix<Real> a = block(r.down, r.up), b = block(r.down, r.down), c = block(r.up, r.up),
                     e = block(r.up, r.down);
  r.psi = Matrix<Real>(p, q);
  for (int step = 0; step < 60; ++step) {
    const Matrix<Real> pa = r.psi * a, ap = a * r.psi;
    const Matrix<Real> g = [&] {
      Matrix<Real> sum = pa * r.psi, pb = r.psi * b, cp = c * r.psi;
      for (std::size_t i = 0; i < sum.a.size(); ++i) sum.a[i] += pb.a[i] + cp.a[i] + e.a[i];
      return sum;
    }();
    Matrix<Real> system(p * q, p * q), change(p * q, 1);
    for (int i = 0; i < p; ++i)
      for (int j = 0; j < q; ++j) {
        for (int k = 0; k < p; ++k) system(i * q + j, k * q + j) += pa(i, k) + c(i, k);
        for (int k = 0; k < q; ++k) system(i * q + j, i * q + k) += ap(k, j) + b(k, j);
        change(i * q + j, 0) = -g(i, j);
      }
    solve(system, change);
    Real largest = 0;
    for (int i = 0; i < p * q; ++i) {
      r.psi.a[i] += change(i, 0);
      largest = std::max<Real>(largest, abs(change(i, 0)));
    }
    if (largest < mp::pow(Real(10), 8 - DIGITS)) break;
  }
  return r;
}

/// w of sources weight(e) v^p without drag and lambda: polynomial part minus its own return.
std::vector<Real> polynomial_part(const Side& side, int p, const std::function<Real(int)>& weight) {
  const int n = side.n;
  const Matrix<Real> t = noise(side, 0);
  std::vector<Real> law(n, Real(1));
  for (int e = 0; e + 1 < n; ++e) law[e + 1] = law[e] * side.alpha[e] / (1 - side.alpha[e + 1]);
  Real drift = 0;
  for (int e = 0; e < n; ++e) drift += law[e] * side.force[e];
  std::vector<Real> a(n, Real(0));
  for (int k = p; k >= 0; --k) {
    Real sum = 0;
    for (int e = 0; e < n; ++e)
      sum += law[e] * ((k == p ? weight(e) : Real(0)) + (k + 1) * side.force[e] * a[e]);
    for (Real& value : a) value -= sum / ((k + 1) * drift);
    Matrix<Real> system = t, right(n, 1);
    for (int e = 0; e < n; ++e)
      right(e, 0) = -(k == p ? weight(e) : Real(0)) - (k + 1) * side.force[e] * a[e];
    for (int e = 0; e < n; ++e)
      system(0, e) = e == 0 ? 1 : 0;  // one equation follows from the others
    right(0, 0) = 0;
    solve(system, right);
    for (int e = 0; e < n; ++e) a[e] = right(e, 0);
  }
  return a;
}

/// Levels at v = 0 that leave it: above for i > hi, below for i < lo, numbered through.
template <class S>
class Crossing {
 public:
  Crossing(const Scene& scene, const Return<S>& above, const Return<S>& below)
      : scene_(scene), sides_{&above, &below} {}
  int count() const { return scene_.levels - scene_.hi + scene_.lo + scene_.levels; }
  int above(int i) const { return i - scene_.hi - 1; }
  int below(int i) const { return scene_.levels - scene_.hi + scene_.lo - 1 - i; }

  /// J - (crossings) J = [sources..., static levels lo .. hi]; `sign` of each source below.
  void assemble(Matrix<S>& system, Matrix<S>& right, const std::vector<int>& sign) const {
    const int levels = scene_.hi - scene_.lo + 1, given = static_cast<int>(sign.size());
    system = Matrix<S>(count(), count());
    right = Matrix<S>(count(), given + levels);
    for (int s = 0; s < 2; ++s) {
      const Return<S>& r = *sides_[s];
      for (std::size_t u = 0; u < r.up.size(); ++u) {
        const int level = (s ? -1 : 1) * (r.up[u] - scene_.levels);
        if (level >= scene_.lo && level <= scene_.hi) continue;
        const int row = s ? below(level) : above(level);
        system(row, row) += S(1);
        for (int q = 0; q < given; ++q)
          right(row, q) = r.w(static_cast<int>(u), q) * S(s ? sign[q] : 1);
        for (std::size_t d = 0; d < r.down.size(); ++d) {
          const int i = (s ? -1 : 1) * (r.down[d] - scene_.levels);
          const S& weight = r.psi(static_cast<int>(u), static_cast<int>(d));
          if (i >= scene_.lo && i <= scene_.hi)
            right(row, given + i - scene_.lo) = weight;
          else
            system(row, i > scene_.hi ? above(i) : below(i)) -= weight;
        }
      }
    }
  }

 private:
  const Scene& scene_;
  const Return<S>* sides_[2];
};

/// Transforms of a sticking phase by its first level: leaving upwards, leaving downwards, and the
/// mean duration.
template <class S>
Matrix<S> sticking_transforms(const Scene& scene, const S& lambda) {
  const int n = scene.hi - scene.lo + 1;
  Matrix<S> system(n, n), right(n, 3);
  for (int r = 0; r < n; ++r) {
    const Real up = scene.rate() * scene.up(scene.lo + r), down = scene.rate() - up;
    system(r, r) = lambda + scene.rate();
    (r + 1 < n ? system(r, r + 1) : right(r, 0)) -= r + 1 < n ? up : Real(-up);
    (r > 0 ? system(r, r - 1) : right(r, 1)) -= r > 0 ? down : Real(-down);
    right(r, 2) = S(1);
  }
  solve(system, right);
  return right;
}

template <class S>
Return<S> returned(const Side& side, const S& lambda, const std::vector<Source<S>>& sources) {
  return HalfLine<S>(side, lambda).first_return(sources);
}

void print(const std::string& name, const Real& value) {
  std::cout << name << " " << std::setprecision(40) << value << "\n";
}

class Answer {
 public:
  explicit Answer(const Scene& scene) : scene_(scene), above_(scene, false), below_(scene, true) {}

  void stationary() {
    const std::vector<int> sign{1, 1, 1, 1, -1};  // time, |V|, V^2, X V, V
    const Return<Real> up = at_rest(above_), down = scene_.symmetric() ? up : at_rest(below_);
    const Crossing<Real> crossing(scene_, up, down);
    Matrix<Real> system, j;
    crossing.assemble(system, j, sign);
    solve(system, j);
    const int n = scene_.hi - scene_.lo + 1, plus = crossing.above(scene_.hi + 1),
              minus = crossing.below(scene_.lo - 1);
    const Matrix<Real> sticking = sticking_transforms<Real>(scene_, 0);
    Real to_plus = 0, to_minus = 0;  // sides of the next start
    for (int s = 0; s < n; ++s) {
      to_plus += j(minus, 5 + s) * sticking(s, 0);
      to_minus += j(plus, 5 + s) * sticking(s, 1);
    }
    const Real share = to_plus / (to_plus + to_minus);
    const auto mean = [&](int q) { return share * j(plus, q) + (1 - share) * j(minus, q); };
    Real rest = 0;
    for (int s = 0; s < n; ++s) {
      entry_.push_back(j(plus, 5 + s));
      rest += mean(5 + s) * sticking(s, 2);
    }
    mean_excursion_ = mean(0) + rest;
    print("mean_slide", mean(0));
    print("mean_stick", rest);
    print("P_stick", rest / mean_excursion_);
    print("P_slide", mean(0) / mean_excursion_);
    print("E_absV", mean(1) / mean_excursion_);
    print("E_V2", mean(2) / mean_excursion_);
    print("E_XV", mean(3) / mean_excursion_);
    print("E_V", mean(4) / mean_excursion_);
    print("f_stick_0", scene_.rate() * (scene_.up(scene_.hi) * mean(5 + n - 1) +
                                        (1 - scene_.up(scene_.lo)) * mean(5)));
    for (int s = 0; s < n; ++s) print("entry_law:" + std::to_string(scene_.lo + s), entry_[s]);
  }

  void laplace(const std::string& text) {
    const Real lambda = std::strtod(text.c_str(), nullptr);
    const Return<Real> r =
        scene_.frictionless() ? riccati(above_, lambda) : returned<Real>(above_, lambda, {});
    Return<Real> side = r;
    side.w = Matrix<Real>(static_cast<int>(r.up.size()), 0);
    const Crossing<Real> crossing(scene_, side, side);
    Matrix<Real> system, j;
    crossing.assemble(system, j, {});
    solve(system, j);
    const Matrix<Real> sticking = sticking_transforms<Real>(scene_, lambda);
    const int plus = crossing.above(scene_.hi + 1);
    Real slide = 0, stick = 0, excursion = 0;
    for (int s = 0; s < j.cols; ++s) {
      slide += j(plus, s);
      stick += entry_[s] * (sticking(s, 0) + sticking(s, 1));
      excursion += j(plus, s) * (sticking(s, 0) + sticking(s, 1));
    }
    print("F_slide:" + text, slide);
    print("F_stick:" + text, stick);
    print("F_excursion:" + text, excursion);
  }

  /// S_v = 2 Re pi(v u), (i omega - L) u = v: u as series, which are the source of a second solve.
  void spectrum(const std::string& text) {
    const Complex lambda(Real(0), Real(std::strtod(text.c_str(), nullptr)));
    const auto one = [](int) { return Real(1); };
    const std::vector<Source<Complex>> v{power<Complex>(1, one)};
    HalfLine<Complex> line(above_, lambda);
    const Return<Complex> r = line.first_return(v);
    const Crossing<Complex> crossing(scene_, r, r);
    Matrix<Complex> system, right;
    crossing.assemble(system, right, {-1});
    const Matrix<Complex> sticking = sticking_transforms<Complex>(scene_, lambda);
    const int n = scene_.hi - scene_.lo + 1, plus = crossing.above(scene_.hi + 1),
              minus = crossing.below(scene_.lo - 1);
    Matrix<Complex> u(crossing.count(), 1);
    for (int row = 0; row < crossing.count(); ++row) {
      u(row, 0) = right(row, 0);
      for (int s = 0; s < n; ++s) {  // a sticking phase leads to s+ or s-
        system(row, plus) -= right(row, 1 + s) * sticking(s, 0);
        system(row, minus) -= right(row, 1 + s) * sticking(s, 1);
      }
      // u is odd and sums to 0: this changes nothing but the null vector 1 at omega = 0.
      for (int i = 0; i < crossing.count(); ++i) system(row, i) += Complex(1);
    }
    solve(system, u);
    std::vector<Complex> down;
    for (int e : r.down) {
      const int i = e - scene_.levels;
      down.push_back(i < scene_.lo ? u(crossing.below(i), 0)
                                   : sticking(i - scene_.lo, 0) * u(plus, 0) +
                                         sticking(i - scene_.lo, 1) * u(minus, 0));
    }
    const auto series = line.series(down, v);
    const auto product = [&](bool imaginary) {
      return Source<Real>([&series, imaginary](int j, const Real& centre, int e, int m) -> Real {
        const auto part = [&](int k) -> Real {
          if (k < 0 || k >= static_cast<int>(series[j].size())) return 0;
          return imaginary ? series[j][k][e].imag() : series[j][k][e].real();
        };
        return centre * part(m) + part(m - 1);
      });
    };
    const Return<Real> back = returned<Real>(above_, 0, {product(false)});
    const Crossing<Real> again(scene_, back, back);
    Matrix<Real> system_0, j;
    again.assemble(system_0, j, {1});
    solve(system_0, j);
    print("S_v:" + text, 2 * j(plus, 0) / mean_excursion_);
  }

 private:
  Return<Real> at_rest(const Side& side) {
    const auto one = [](int) { return Real(1); };
    const auto level = [&side](int e) { return side.x[e]; };
    if (!scene_.frictionless())
      return returned<Real>(side, 0,
                            {power<Real>(0, one), power<Real>(1, one), power<Real>(2, one),
                             power<Real>(1, level), power<Real>(1, one)});
    Return<Real> r = riccati(side, 0);
    r.w = Matrix<Real>(static_cast<int>(r.up.size()), 5);
    const std::vector<Real> parts[] = {
        polynomial_part(side, 0, one), polynomial_part(side, 1, one), polynomial_part(side, 2, one),
        polynomial_part(side, 1, level), polynomial_part(side, 1, one)};
    for (int q = 0; q < 5; ++q)
      for (int u = 0; u < r.w.rows; ++u) {
        r.w(u, q) = parts[q][r.up[u]];
        for (std::size_t d = 0; d < r.down.size(); ++d)
          r.w(u, q) -= r.psi(u, static_cast<int>(d)) * parts[q][r.down[d]];
      }
    return r;
  }

  const Scene& scene_;
  Side above_, below_;
  std::vector<Real> entry_;
  Real mean_excursion_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc < 12) {
    std::fprintf(stderr, "usage: reference N LO HI MU_D TAU DELTA C_ABOVE C_BELOW CUBIC BIAS SHARE "
                         "[lambda L]... [omega W]...\n");
    return 2;
  }
  const auto number = [&](int n) { return Real(std::strtod(argv[n], nullptr)); };
  const Scene scene{std::atoi(argv[1]), std::atoi(argv[2]), std::atoi(argv[3]), number(4),
                    number(5),          number(6),          number(7),          number(8),
                    number(9),          number(10),         number(11)};
  Answer answer(scene);
  answer.stationary();
  for (int n = 12; n + 1 < argc; n += 2)
    std::strcmp(argv[n], "lambda") == 0 ? answer.laplace(argv[n + 1])
                                        : answer.spectrum(argv[n + 1]);
  return 0;
}
