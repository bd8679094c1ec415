// A straight chain of compressed beads against the closed forms of a spring network (docs/validation.md:
// V4.5, V4.6).

#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/collision.hpp"
#include "tests/support/validation.hpp"

namespace twincell::sim::chain_test {
namespace {

using test::validate;

/// `count` beads along x, closed to a ring by a period slightly shorter than their total length, so that no
/// contact opens.
Bench ring(int count, const std::string& law, double n) {
  constexpr double kPressed = 1e-3;
  Bench b(
      kNoGravity + "width = " + std::to_string(count + 10) + ".0\n[contact]\ntangential = \"none\"\n" + law,
      n);
  b.system.walls.clear();
  b.system.period[0] = count * (1 - kPressed);
  for (int i = 0; i < count; ++i) b.add(i * (1 - kPressed), 0, 0, 0);
  return b;
}

/// Amplitude of v along cos(q i).
double projection(const Bench& b, int mode) {
  const auto& beads = b.system.beads;
  double sum = 0;
  for (std::size_t i = 0; i < beads.size(); ++i)
    sum += beads[i].vx *
           std::cos(2 * std::numbers::pi * mode * static_cast<double>(i) / static_cast<double>(beads.size()));
  return 2 * sum / static_cast<double>(beads.size());
}

TEST(Chain, NormalModes) {  // V4.5: w = 2 sqrt(k/m) |sin(q/2)|
  constexpr int kBeads = 200;
  for (const int mode : {1, 10, 50, 90}) {
    Bench b = ring(kBeads, "gamma_n = 0.0\n", 100.37);
    for (int i = 0; i < kBeads; ++i)
      b.system.beads[static_cast<std::size_t>(i)].vx =
          0.01 * std::cos(2 * std::numbers::pi * mode * i / kBeads);
    const double exact = 2 * 1000 * std::sin(std::numbers::pi * mode / kBeads);
    // Times of the zero crossings of the mode's velocity, over about twenty of its periods.
    const std::int64_t block = std::max<std::int64_t>(1, std::llround(0.05 / exact / b.system.dt));
    std::vector<double> zeros;
    double before = projection(b, mode), at = 0;
    while (zeros.size() < 41) {
      b.kernel->advance(b.system, block);
      const double now = projection(b, mode), t = b.system.time();
      if (before * now <= 0) zeros.push_back(at + (t - at) * before / (before - now));
      before = now, at = t;
    }
    const double measured = 40 * std::numbers::pi / (zeros.back() - zeros.front());
    validate({"V4.5",
              "ring of 200 beads, mode " + std::to_string(mode) + ": frequency over 2 sqrt(k_n/m) sin(q/2)",
              1, 1e-4, "closed form"},
             measured / exact);
    if (mode == 1)
      validate({"V4.5", "speed of sound over d sqrt(k_n/m)", 1, 0.01, "closed form"},
               measured / (2 * std::numbers::pi / kBeads) / 1000);
  }
}

TEST(Chain, PulseAfterAHit) {  // V4.5: one bead is hit; bead n then moves at v J_2n(2 w t)
  constexpr int kBeads = 400;
  Bench b = ring(kBeads, "gamma_n = 0.0\n", 200.37);
  b.system.beads[0].vx = 0.01;
  std::vector<double> crest_time(kBeads), crest(kBeads);
  double worst = 0;
  for (int k = 0; k < 800; ++k) {
    b.kernel->advance(b.system, 20);
    for (const std::size_t n : {std::size_t{50}, std::size_t{150}}) {
      const double v = b.system.beads[n].vx / 0.01;
      worst = std::max(
          worst, std::abs(v - std::cyl_bessel_j(2.0 * static_cast<double>(n), 2 * 1000 * b.system.time())));
      if (v > crest[n]) crest[n] = v, crest_time[n] = b.system.time();
    }
  }
  ASSERT_GT(crest[150], 0.08);
  validate({"V4.5", "chain hit at one bead: largest error of v_n/v, n = 50 and 150", 0, 1e-3, "J_2n(2 w t)"},
           worst);
  validate({"V4.5", "speed of the crest from bead 50 to 150 over d sqrt(k_n/m)", 1, 0.01, "closed form"},
           100 / (crest_time[150] - crest_time[50]) / 1000);
}

TEST(Chain, ModesRelax) {  // V4.6: amplitude falls at (eta/m)(1 - cos q), eta = gamma m/2
  constexpr int kBeads = 200;
  for (const int mode : {10, 30, 80}) {
    Bench b = ring(kBeads, "", 100.37);
    for (int i = 0; i < kBeads; ++i)
      b.system.beads[static_cast<std::size_t>(i)].vx =
          0.01 * std::cos(2 * std::numbers::pi * mode * i / kBeads);
    const double q = 2 * std::numbers::pi * mode / kBeads, rate = 50 * (1 - std::cos(q));
    // Maxima of |v|, each from a parabola through three samples.
    const double period = std::numbers::pi / (1000 * std::sin(q / 2));
    const std::int64_t block = std::max<std::int64_t>(1, std::llround(period / 60 / b.system.dt));
    std::vector<std::pair<double, double>> crests;  // time, log amplitude
    double a = 0, c = std::abs(projection(b, mode));
    while (b.system.time() < 2 / rate) {
      b.kernel->advance(b.system, block);
      const double next = std::abs(projection(b, mode));
      if (c > a && c >= next && a > 0) {
        const double shift = 0.5 * (a - next) / (a - 2 * c + next);
        crests.emplace_back(b.system.time() + (shift - 1) * static_cast<double>(block) * b.system.dt,
                            std::log(c - 0.25 * (a - next) * shift));
      }
      a = c, c = next;
    }
    ASSERT_GT(crests.size(), 4U);
    const double measured =
        -(crests.back().second - crests.front().second) / (crests.back().first - crests.front().first);
    validate(
        {"V4.6", "ring of 200 beads, mode " + std::to_string(mode) + ": decay rate over (eta/m)(1 - cos q)",
         1, 0.01, "closed form"},
        measured / rate);
  }
}

}  // namespace
}  // namespace twincell::sim::chain_test
