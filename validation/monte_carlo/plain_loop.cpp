/// The process as one would write it in an afternoon: one loop, xoshiro256**, linear drag. It
/// shares nothing with the program, serves as reference of -compare and as the measure of its
/// speed.
///
///   plain_loop MU_S MU_D TAU DELTA EXCURSIONS SEED [FACTOR]
///
/// writes CSV (quantity,argument,value,low,high with 95 % confidence intervals) and, on standard
/// error, the nanoseconds for each jump of the noise. FACTOR speeds the jumps up, for a
/// deliberately wrong process.

#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

namespace {

class Xoshiro {  // Blackman and Vigna, ACM Trans. Math. Softw. 47 (2021)
 public:
  explicit Xoshiro(std::uint64_t seed) {
    for (auto& word : s_) {  // splitmix64
      std::uint64_t z = (seed += 0x9e3779b97f4a7c15);
      z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
      z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
      word = z ^ (z >> 31);
    }
  }
  double uniform() { return static_cast<double>(next() >> 11) * 0x1p-53; }

 private:
  static std::uint64_t rotl(std::uint64_t x, int k) { return (x << k) | (x >> (64 - k)); }
  std::uint64_t next() {
    const std::uint64_t result = rotl(s_[1] * 5, 7) * 9, t = s_[1] << 17;
    s_[2] ^= s_[0];
    s_[3] ^= s_[1];
    s_[1] ^= s_[2];
    s_[0] ^= s_[3];
    s_[2] ^= t;
    s_[3] = rotl(s_[3], 45);
    return result;
  }
  std::uint64_t s_[4];
};

struct Sums {
  double slide = 0, stick = 0, square = 0, path = 0, product = 0, within = 0, noise_square = 0;
};

/// Sums of samples and of their products with themselves and the duration.
struct Statistic {
  double sum = 0, squares = 0, with_time = 0;
  void add(double g, double t) {
    sum += g;
    squares += g * g;
    with_time += g * t;
  }
};

}  // namespace

int main(int argc, char** argv) {
  if (argc < 7) {
    std::fprintf(stderr, "usage: plain_loop MU_S MU_D TAU DELTA EXCURSIONS SEED [FACTOR]\n");
    return 2;
  }
  const double mu_s = std::atof(argv[1]), mu_d = std::atof(argv[2]), tau = std::atof(argv[3]),
               delta = std::atof(argv[4]);
  const long count = std::atol(argv[5]);
  Xoshiro random(std::strtoull(argv[6], nullptr, 10));
  const double factor = argc > 7 ? std::atof(argv[7]) : 1;
  const double rate = factor * 2 / (tau * tau * delta * delta);
  const int k = static_cast<int>(std::floor(mu_s / delta + 1e-9));
  const auto wait_for_jump = [&] { return -std::log1p(-random.uniform()) / rate; };
  const auto jump = [&](int i) {
    return i + (random.uniform() < (1 - tau * delta * delta * i / 2) / 2 ? 1 : -1);
  };

  double jumps = 0;
  Statistic time, slide, square, path, product, within, noise_square;
  const auto start = std::chrono::steady_clock::now();
  for (long n = 0; n < count; ++n) {
    Sums s;
    int i = k + 1, y = 1;
    double v = 0, wait = wait_for_jump();
    for (;;) {  // sliding
      const double x = i * delta, force = x - y * mu_d;
      double e = std::exp(-wait), end = force + (v - force) * e, t = wait;
      const bool stops = y * end <= 0;
      if (stops) {
        t = std::log1p(-v / force);
        e = std::exp(-t);
        end = 0;
      }
      const double moved = force * t - (end - v);
      s.slide += t;
      s.path += y * moved;
      s.product += x * moved;
      s.square += force * moved - (end * end - v * v) / 2;
      s.noise_square += x * x * t;
      if (std::abs(i) <= k) s.within += t;
      v = end;
      if (!stops) {
        i = jump(i);
        wait = wait_for_jump();
        ++jumps;
        continue;
      }
      wait -= t;
      if (std::abs(i) <= k) break;
      y = -y;
    }
    for (;;) {  // sticking
      s.stick += wait;
      s.noise_square += i * delta * i * delta * wait;
      i = jump(i);
      ++jumps;
      if (std::abs(i) > k) break;
      wait = wait_for_jump();
    }
    s.within += s.stick;
    const double t = s.slide + s.stick;
    time.add(t, t);
    slide.add(s.slide, t);
    square.add(s.square, t);
    path.add(s.path, t);
    product.add(s.product, t);
    within.add(s.within, t);
    noise_square.add(s.noise_square, t);
  }
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

  std::printf("quantity,argument,value,low,high\n");
  const auto print = [&](const char* name, const Statistic& g) {
    const double ratio = g.sum / time.sum;
    const double spread = g.squares - 2 * ratio * g.with_time + ratio * ratio * time.squares;
    const double half = 1.96 * std::sqrt(spread) / time.sum;
    std::printf("%s,,%.17g,%.17g,%.17g\n", name, ratio, ratio - half, ratio + half);
  };
  print("P_slide", slide);
  print("E_V2", square);
  print("E_absV", path);
  print("E_XV", product);
  print("P_X_le_mu_s", within);
  print("E_X2", noise_square);
  std::fprintf(stderr, "%.3f ns a jump\n", 1e9 * seconds / jumps);
  return 0;
}
