// A bead on a plate that moves with harmonics (docs/validation.md: V4.15). omega = g = 1, so that A = Gamma.

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "tests/support/collision.hpp"
#include "tests/support/validation.hpp"

namespace twincell::sim::harmonics_test {
namespace {

using test::validate;
constexpr double kTurn = 2 * std::numbers::pi;

/// An inelastic bead (critical damping) that rests on the plate at a phase and moves with it.
struct Resting : Bench {
  Resting(double gamma, std::vector<Harmonic> harmonics, double phase, SolverKind kind = SolverKind::best)
      : Bench("[contact]\ntangential = \"none\"\ngamma_n = 2000.0\n[time]\nintegrator = \"split\"\n", 50.37,
              kind) {
    system.drive.amplitude = gamma;
    system.drive.harmonics = std::move(harmonics);
    system.steps_per_period = static_cast<std::int64_t>(std::ceil(kTurn / system.dt));
    system.dt = kTurn / static_cast<double>(system.steps_per_period);
    system.step = std::llround(phase / kTurn * static_cast<double>(system.steps_per_period));
    add(10, 0.5 + system.plate_height() - 1e-6, 0, system.plate_velocity());
  }
  [[nodiscard]] double overlap() const { return 0.5 + system.plate_height() - system.beads[0].z; }
  /// Runs until the contact state equals `touching` and returns the phase in radians.
  double until(bool touching) {
    while ((overlap() > 0) != touching) kernel->advance(system, 5);
    return kTurn * system.phase();
  }
};

// z = Gamma (sin t + cos(2t)/4): the plate falls faster than g where Gamma (s + 1 - 2s^2) > 1, s = sin t. At
// Gamma = 0.95, at which a sine carries the bead for ever, this is where s is between the two roots, once
// while the first harmonic rises and once while it falls.
TEST(Harmonics, TheBeadTakesOffWhereThePlateFallsFasterThanGravity) {
  const double gamma = 0.95, root = std::sqrt(1 + 8 * (1 - 1 / gamma));
  const double first = std::asin((1 - root) / 4), second = std::numbers::pi - std::asin((1 + root) / 4);
  for (const auto& [kind, name] : {std::pair{SolverKind::best, "vector kernels"},
                                   {SolverKind::scalar, "scalar kernels"},
                                   {SolverKind::all_pairs, "all pairs"}}) {
    const std::string what =
        fmt::format("inelastic bead, Gamma = 0.95, second harmonic 1/4 cos(2 omega t), {}: ", name);
    Resting b(gamma, {{0.25, 0.25}}, 1.5 * std::numbers::pi, kind);
    validate({"V4.15", what + "first take-off phase", first, 0.01, "root of g + z'' = 0"}, b.until(false));
    b.until(true);
    validate({"V4.15", what + "second take-off phase", second, 0.01, "root of g + z'' = 0"}, b.until(false));
  }
  Resting sine(gamma, {}, 0);
  for (std::int64_t step = 0; step < 2 * sine.system.steps_per_period; step += 5) {
    sine.kernel->advance(sine.system, 5);
    ASSERT_GT(sine.overlap(), 0) << "a sine at Gamma = 0.95 does not release the bead";
  }
}

// Below lift-off the contact carries the bead along: the overlap is that of its weight and inertia,
// m (g + z'')/k_n, at every phase.
TEST(Harmonics, BelowLiftOffTheBeadFollowsThePlate) {
  Resting b(0.3, {{0.2, 0.1}, {0.05, 0.6}}, 0);
  const auto per_period = b.system.steps_per_period;
  b.kernel->advance(b.system, per_period / 4);
  double worst = 0, least = HUGE_VAL, most = 0;
  for (int k = 0; k < 100; ++k) {
    b.kernel->advance(b.system, per_period / 100);
    const double load = 1 + b.system.drive.acceleration(b.system.phase());
    worst = std::max(worst, std::abs(1e6 * b.overlap() - load));
    least = std::min(least, load), most = std::max(most, load);
  }
  EXPECT_LT(least, 0.7);
  EXPECT_GT(most, 1.3);
  validate({"V4.15", "largest error of the load on a bead that rests on a plate with harmonics, m g", 0,
            0.005, "m (g + z'')"},
           worst);
}

}  // namespace
}  // namespace twincell::sim::harmonics_test
