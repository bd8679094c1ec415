// Contact forces of a run against closed forms: columns and layers at rest, whose contacts carry the weight
// above.
#include "sim/run/contact_forces.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "sim/run/simulation.hpp"
#include "tests/support/column.hpp"
#include "tests/support/shaken_bed.hpp"
#include "tests/support/validation.hpp"

namespace twincell::sim::contact_forces_test {
TEST(ContactForces, ColumnCarriesTheWeightAbove) {
  for (const int dimension : {2, 3}) {
    const MemoryTrajectory t = column_at_rest(dimension);
    ASSERT_TRUE(t.info().columns.contact_forces);
    const Frame& last = t.frames().back();
    int pairs = 0, floor = 0;
    double worst_force = 0, worst_overlap = 0;
    for (const ContactForce& c : last.contact_forces) {
      if (c.j < 0 && t.info().walls[static_cast<std::size_t>(-1 - c.j)] != "bottom") continue;
      const double z = last.position[static_cast<std::size_t>(c.i)].z();
      int above = 0;  // beads at or above the upper of the two
      const double upper = c.j < 0 ? z : std::max(z, last.position[static_cast<std::size_t>(c.j)].z());
      for (const Vec3& r : last.position) above += r.z() >= upper ? 1 : 0;
      worst_force = std::max(worst_force, std::abs(c.normal_force / above - 1));
      worst_overlap = std::max(worst_overlap, std::abs(1e5 * c.overlap / above - 1));
      (c.j < 0 ? floor : pairs) += 1;
    }
    EXPECT_EQ(pairs, kColumnBeads - 1);
    EXPECT_EQ(floor, 1);
    test::validate(
        {"V2.30", fmt::format("forces in a column over the weight above, largest error, {}D", dimension), 0,
         1e-6, "closed form"},
        worst_force);
    test::validate(
        {"V2.30", fmt::format("overlaps times k_n over the weight above, largest error, {}D", dimension), 0,
         1e-6, "closed form"},
        worst_overlap);
  }
}

TEST(ContactForces, AddUpToThoseOfTheSolver) {
  // In a shaken bed with friction, the sum over a bead's contacts is the solver's force up to corrections of
  // the order of the step.
  for (const char* integrator : {"verlet", "split"}) {
    double error[2] = {0, 0};
    for (const int fine : {0, 1}) {
      ShakenBed bed({fmt::format("time.integrator={}", integrator),
                     fmt::format("time.steps_per_contact={}", fine == 0 ? 50 : 400)});
      double sum = 0, all = 0;
      for (int k = 0; k < 60; ++k) {
        bed.advance(bed.plan.steps_per_period / 50);
        std::vector<Vec3> force(bed.system.beads.size(), Vec3::Zero());
        for (const ContactForce& c : contact_forces(bed.plan, bed.system, bed.kernel->contacts())) {
          force[static_cast<std::size_t>(c.i)] += c.force();
          if (c.j >= 0) force[static_cast<std::size_t>(c.j)] -= c.force();
          EXPECT_NEAR(c.tangential_force.dot(c.normal), 0, 1e-9);
        }
        for (std::size_t i = 0; i < force.size(); ++i) {
          const Force& f = bed.system.forces[i];
          sum += (force[i] - Vec3(f.x, f.y, f.z)).squaredNorm();
          all += force[i].squaredNorm();
        }
      }
      ASSERT_GT(all, 0);
      error[fine] = std::sqrt(sum / all);
    }
    EXPECT_LT(error[0], 0.2) << integrator;
    EXPECT_LT(error[1], 0.35 * error[0]) << integrator << ": " << error[0] << " and " << error[1];
  }
}

}  // namespace twincell::sim::contact_forces_test
