// The drag of the plates on a single bead, against the exponential decay and the terminal velocity.
#include "sim/contact/plate_drag.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/collision.hpp"
#include "tests/support/validation.hpp"

namespace twincell::sim::plate_drag_test {
namespace {

constexpr double kRate = 20;

TEST(PlateDrag, FreeMotionDecaysExponentially) {
  for (const double n : {50.37, 200.37}) {
    Bench b(kNoGravity + "plate_drag = 20.0\n", n);
    b.add(5, 100, 2, 1);
    const auto steps = static_cast<std::int64_t>(std::lround(0.2 / b.system.dt));
    b.kernel->advance(b.system, steps);
    const double decay =
        -std::log(b.system.beads[0].vx / 2) / (kRate * static_cast<double>(steps) * b.system.dt);
    test::validate({"V2.19", fmt::format("drag of the plates: rate of decay over c (1 + c dt/2), n = {}", n),
                    1, 1e-6, "closed form"},
                   decay / (1 + kRate * b.system.dt / 2));
    test::validate({"V2.19", fmt::format("drag of the plates: v_z/v_x of a free bead, n = {}", n), 0.5, 1e-9,
                    "closed form"},
                   b.system.beads[0].vz / b.system.beads[0].vx);
  }
}

TEST(PlateDrag, AFallEndsAtTheTerminalVelocity) {
  Bench b("[cell]\nheight = 1000.0\nlid = \"wall\"\nplate_drag = 20.0\n");
  b.add(10, 500, 0, 0);
  b.advance_time(1.5);
  test::validate({"V2.19", "drag of the plates: terminal velocity", -1 / kRate, 1e-9, "-g/c"},
                 b.system.beads[0].vz);
}

}  // namespace
}  // namespace twincell::sim::plate_drag_test
