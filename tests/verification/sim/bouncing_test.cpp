// One bead on a vibrating plate (docs/validation.md: V4.7, V4.8). omega = g = 1, so that A = Gamma.

#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/collision.hpp"
#include "tests/support/rigid_bed.hpp"
#include "tests/support/validation.hpp"

namespace twincell::sim::bouncing_test {
namespace {

using test::validate;
constexpr double kTurn = 2 * std::numbers::pi;

std::string number(double v) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", v);
  return text;
}

/// A bead above the plate, about to fall on it.
struct Bouncer : Bench {
  Bouncer(const std::string& law, double gamma, double n)
      : Bench("[contact]\ntangential = \"none\"\n" + law + "[time]\nintegrator = \"split\"\n", n) {
    system.drive.amplitude = gamma;
    system.steps_per_period = static_cast<std::int64_t>(std::ceil(kTurn / system.dt));
    system.dt = kTurn / static_cast<double>(system.steps_per_period);
  }
  [[nodiscard]] bool touches() const { return system.beads[0].z - system.plate_height() < 0.5; }
  /// Runs until the contact state equals `touching` and returns the time.
  double until(bool touching, std::int64_t block) {
    while (touches() != touching) kernel->advance(system, block);
    return system.time();
  }
};

/// Phases of `count` landings after `discard` discarded ones. The bead starts on the period-1 orbit: it takes
/// off at the landing phase, with the speed that returns it to that phase one period later.
std::vector<double> landings(double e, double gamma, double n, int discard, int count) {
  Bouncer b("restitution = " + std::to_string(e) + "\n", gamma, n);
  const double phase = std::acos(std::numbers::pi * (1 - e) / ((1 + e) * gamma));
  b.system.step = std::llround(phase / kTurn * static_cast<double>(b.system.steps_per_period));
  b.add(10, 0.5 + b.system.plate_height() + 1e-6, 0, std::numbers::pi);  // up at g T/2
  std::vector<double> phases;
  const std::int64_t block = 10;
  for (int k = 0; k < discard + count; ++k) {
    b.until(true, block);
    // Extrapolates back to the instant of first touch at the relative landing speed.
    const Bead& p = b.system.beads[0];
    const double late = (0.5 + b.system.plate_height() - p.z) / (b.system.plate_velocity() - p.vz);
    const double at =
        std::fmod(b.system.time() - std::min(late, static_cast<double>(block) * b.system.dt), kTurn);
    if (k >= discard) phases.push_back(at);
    b.until(false, block);
  }
  return phases;
}

TEST(BouncingBead, LandsAtThePhaseOfPeriodOneAndDoublesItsPeriod) {  // V4.7
  // 2-3 % below the bifurcation, every landing is at cos(phi) = pi (1 - e)/((1 + e) Gamma). Above it two
  // phases alternate; their reference values come from an event-driven bead with the same spring.
  struct Case {
    double e, gamma, upper, lower, tolerance;
  };
  for (const Case& c : {Case{0.5, 1.49, 0, 0, 0.03},
                        {0.8, 1.04, 0, 0, 0.03},
                        {0.5, 1.56, 1.075, 0.537, 0.015},
                        {0.8, 1.10, 1.597, 0.858, 0.01}}) {
    const auto phases = landings(c.e, c.gamma, 50.37, 120, 20);
    const auto [low, high] = std::minmax_element(phases.begin(), phases.end());
    const std::string what = "bead on the plate, e = " + number(c.e) + ", Gamma = " + number(c.gamma) + ": ";
    if (c.upper == 0) {
      const double exact = std::acos(std::numbers::pi * (1 - c.e) / ((1 + c.e) * c.gamma));
      validate({"V4.7", what + "earliest landing phase", exact, c.tolerance, "closed form"}, *low);
      validate({"V4.7", what + "latest landing phase", exact, c.tolerance, "closed form"}, *high);
    } else {
      double even = 0, odd = 0;
      for (std::size_t k = 0; k < phases.size(); ++k) (k % 2 ? odd : even) += phases[k] / 10;
      validate({"V4.7", what + "larger of two alternating phases", c.upper, c.tolerance, "event-driven map"},
               std::max(even, odd));
      validate({"V4.7", what + "smaller of them", c.lower, c.tolerance, "event-driven map"},
               std::min(even, odd));
    }
  }
}

/// Iterates the landing phases of a hard bead by its closed-form flight: t' > t with z(t') = A sin t', solved
/// by bisection.
/// \return whether two successive landings on the settled orbit differ
bool map_has_doubled(double e, double gamma) {
  double t = std::acos(std::numbers::pi * (1 - e) / ((1 + e) * gamma)) + 1e-3, up = std::numbers::pi;
  double before = 0, last = 0;
  for (int k = 0; k < 5000; ++k) {
    const auto gap = [&](double s) {
      return gamma * std::sin(t) + up * s - s * s / 2 - gamma * std::sin(t + s);
    };
    double low = 0.5;
    while (gap(low + 0.01) > 0) low += 0.01;
    double high = low + 0.01;
    for (int i = 0; i < 60; ++i) (gap((low + high) / 2) > 0 ? low : high) = (low + high) / 2;
    const double plate = gamma * std::cos(t + low), v = up - low;
    t = std::fmod(t + low, kTurn), up = plate + e * (plate - v);
    before = last, last = t;
  }
  return std::abs(last - before) > 1e-4;
}

TEST(BouncingBead, PeriodDoublingOfTheHardBead) {  // V4.7, the closed form against the map itself
  for (const auto& [e, outside] :
       {std::pair{0.5, 1.52682}, {0.8, 1.07084}, {0.85447, 1.03592}, {0.9, 1.01631}}) {
    double low = outside - 0.04, high = outside + 0.06;
    for (int i = 0; i < 10; ++i) (map_has_doubled(e, (low + high) / 2) ? high : low) = (low + high) / 2;
    const double a = std::numbers::pi * (1 - e) / (1 + e), b = 2 * (1 + e * e) / ((1 + e) * (1 + e));
    EXPECT_NEAR(std::hypot(a, b), outside, 1e-5);
    validate({"V4.7", "Gamma at which the hard bead's map doubles its period, e = " + number(e), outside,
              1e-3, "closed form, event-driven map"},
             (low + high) / 2);
  }
}

TEST(InelasticBead, FliesFromTakeOffToLanding) {  // V4.8: e = 0 by critical damping, zeta = 1
  for (const auto& [gamma, outside] : {std::pair{1.2, 0.3823}, {1.5, 0.5676}, {2.0, 0.7415}, {3.0, 0.9498}}) {
    Bouncer b("gamma_n = 2000.0\n", gamma, 50.37);
    b.add(10, 0.5 - 1e-6, 0, gamma);  // resting on the plate, at its speed
    b.until(false, 5);
    b.until(true, 5);  // the second flight
    b.kernel->advance(b.system, 200);
    const double off = b.until(false, 5), land = b.until(true, 5);
    const std::string what = "inelastic bead, Gamma = " + number(gamma);
    validate({"V4.8", what + ": flight over T", outside, 0.01 * outside, "closed form"},
             (land - off) / kTurn);
    validate({"V4.8", what + ": sin of the take-off phase times Gamma", 1, 0.01, "sin(phi) = 1/Gamma"},
             gamma * std::sin(std::fmod(off, kTurn)));
  }
  // Independent check: at Gamma = sqrt(1 + pi^2) the flight lasts one whole period.
  const double top = std::sqrt(1 + std::numbers::pi * std::numbers::pi);
  Bouncer b("gamma_n = 2000.0\n", 0.999 * top, 50.37);
  b.add(10, 0.5 - 1e-6, 0, 0.999 * top);
  const double off = b.until(false, 5);
  b.kernel->advance(b.system, 1000);
  validate({"V4.8", "inelastic bead, Gamma = 0.999 sqrt(1 + pi^2): flight over T", 1, 0.01, "closed form"},
           (b.until(true, 5) - off) / kTurn);
}

}  // namespace
}  // namespace twincell::sim::bouncing_test
