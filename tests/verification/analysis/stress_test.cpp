// Stress and force distribution of lattices whose contact forces are known.
#include "analysis/force/stress.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "analysis/force/contact_force.hpp"
#include "tests/support/column.hpp"
#include "tests/support/known_beds.hpp"
#include "tests/support/validation.hpp"

namespace twincell::test::stress_test {
namespace {

constexpr int kColumns = 8, kRows = 10;

/// A triangular lattice of spacing a < 1 in a periodic box; every contact has the force f(overlap) of the
/// given function.
MemoryTrajectory compressed(double a, const std::function<double()>& force, int frames = 1,
                            int rows = kRows) {
  MemoryTrajectory t = empty(2, period_of_lattice(kColumns, rows, a), true);
  t.info().columns.contact_forces = true;
  add(t, triangular_lattice(kColumns, rows, a));
  Frame frame = t.frames().front();
  const analysis::Neighbours near = analysis::find_neighbours(frame, t.info().box, 1.01 * a);
  MemoryTrajectory out(t.info());
  for (int f = 0; f < frames; ++f) {
    frame.contact_forces.clear();
    frame.step = frame.cycle = f;
    for (std::size_t i = 0; i < frame.position.size(); ++i)
      near.for_each(i, [&](std::size_t j, const Vec3& bond) {
        if (i < j)
          frame.contact_forces.push_back({static_cast<std::int32_t>(i), static_cast<std::int32_t>(j), 1 - a,
                                          -bond.normalized(), force(), Vec3::Zero()});
      });
    out.append(frame);
  }
  return out;
}

}  // namespace

TEST(Stress, OfACompressedTriangularLatticeIsIsotropic) {
  // Three contacts per bead, each f a n n: sigma = 3/2 N f a/V with V = N sqrt(3)/2 a^2.
  for (const double a : {0.99, 0.9}) {
    const double f = 1000 * (1 - a), expected = std::sqrt(3.0) * f / a;
    const MemoryTrajectory t = compressed(a, [f] { return f; });
    const auto stress = values_of(t, "stress");
    validate({"V5.24", "sigma_xx of a compressed lattice", expected, 1e-9 * expected, "sqrt(3) f/a"},
             stress[0]);
    validate({"V5.24", "sigma_zz of a compressed lattice", expected, 1e-9 * expected, "sqrt(3) f/a"},
             stress[3]);
    validate({"V5.24", "sigma_xz of a compressed lattice", 0, 1e-9 * expected, "symmetry"}, stress[1]);
    validate({"V5.24", "pressure of a compressed lattice", expected, 1e-9 * expected, "sqrt(3) f/a"},
             values_of(t, "pressure")[0]);
    EXPECT_NEAR(values_of(t, "contact_force")[0], f, 1e-9 * f);
    EXPECT_NEAR(values_of(t, "mechanical_contact_number")[0], 6, 1e-12);
  }
}

// In a cell that is periodic along z, positions may lie in any period: the profile and the field are those of
// one period, and the means of both are the stress.
TEST(Stress, OfACellThatIsPeriodicAlongZDoesNotDependOnThePeriodsOfItsBeads) {
  const double a = 0.95, f = 50, expected = std::sqrt(3.0) * f / a;
  const MemoryTrajectory lattice = compressed(
      a, [f] { return f; }, 1, 26);
  MemoryTrajectory t(lattice.info()), spread(lattice.info());
  Frame frame = lattice.frames().front();
  const double period = t.info().box.size().z();
  for (Vec3& r : frame.position) r.z() += 0.1;  // no row lies on the border of a slab
  t.append(frame);
  for (std::size_t i = 0; i < frame.position.size(); ++i)
    frame.position[i].z() += period * (static_cast<double>(i % 7) - 3);
  spread.append(frame);
  for (const char* name : {"stress_xx_z", "stress_zz_z", "stress_z", "stress_field", "stress_field_z"}) {
    const auto inside = values_of(t, name), across = values_of(spread, name);
    ASSERT_EQ(inside.size(), across.size()) << name;
    for (std::size_t k = 0; k < inside.size(); ++k)
      EXPECT_NEAR(across[k], inside[k], 1e-9 * expected) << name << " " << k;
  }
  const auto profile = values_of(t, "stress_zz_z");
  EXPECT_EQ(profile.size(), static_cast<std::size_t>(std::lround(period)));
  double mean = 0;
  for (const double p : profile) mean += p / static_cast<double>(profile.size());
  validate({"V5.24", "mean over a period along z of the profile of sigma_zz, over sqrt(3) f/a", 1, 1e-9,
            "sqrt(3) f/a"},
           mean / expected);
}

// The Gaussian is wider than the lattice, whose shortest reciprocal vector is 4 pi/(sqrt(3) a): the field is
// uniform up to exp(-26), and up to the images of a contact beyond the nearest one.
TEST(StressField, OfACompressedTriangularLatticeIsUniform) {
  const double a = 0.95, f = 50, expected = std::sqrt(3.0) * f / a;
  const MemoryTrajectory t = compressed(
      a, [f] { return f; }, 2, 26);
  const auto field = values_of(t, "stress_field"), z = values_of(t, "stress_field_z");
  const std::size_t columns = values_of(t, "stress_field_x").size();
  ASSERT_EQ(field.size(), 4 * columns * z.size());
  double diagonal = 0, off = 0;
  int points = 0;
  for (std::size_t r = 0; r < z.size(); ++r) {
    for (std::size_t c = 0; c < columns; ++c, ++points) {
      const double* s = &field[4 * (r * columns + c)];
      diagonal = std::max({diagonal, std::abs(s[0] - expected), std::abs(s[3] - expected)});
      off = std::max({off, std::abs(s[1]), std::abs(s[2])});
    }
  }
  EXPECT_GE(points, 40);
  validate({"V5.24",
            "stress field of a compressed lattice: largest error of sigma_xx and sigma_zz, over sqrt(3) f/a",
            0, 2e-3, "sqrt(3) f/a"},
           diagonal / expected);
  validate({"V5.24", "stress field of a compressed lattice: largest sigma_xz and sigma_zx, over sqrt(3) f/a",
            0, 2e-3, "symmetry"},
           off / expected);
}

// One contact of two discs with the force (2, 0, 3): in its middle the field is
// f_a l_b/(sqrt(2 pi) w) erf(1/(2 sqrt(2) w)), and its integral f_a l_b.
TEST(StressField, OfOneContactIsTheClosedForm) {
  MemoryTrajectory t = empty(2, Vec3(21, 1, 21), false);
  t.info().columns.contact_forces = true;
  add(t, {Vec3(11, 0, 10.5), Vec3(10, 0, 10.5)});
  Frame frame = t.frames().front();
  frame.contact_forces = {{0, 1, 0, Vec3::UnitX(), 2, Vec3(0, 0, 3)}};
  MemoryTrajectory one(t.info());
  one.append(frame);
  analysis::AnalysisOptions options;
  options.only = {"stress_field"};
  options.field_cell = 1;
  const analysis::Result field = analysis::find_result(analysis::analyze(one, options), "stress_field");
  ASSERT_EQ(field.shape[1], 21);
  const std::size_t middle = 4 * (10 * 21 + 10);  // the point (10.5, 10.5)
  const double closed = std::erf(1 / (2 * std::sqrt(2.0))) / std::sqrt(2 * std::numbers::pi);
  const double expected[] = {2, 0, 3, 0};
  double sums[4] = {0, 0, 0, 0};
  for (std::size_t k = 0; k < field.values.size(); ++k) sums[k % 4] += field.values[k];
  for (std::size_t k = 0; k < 4; ++k) {
    validate({"V5.24", fmt::format("stress field in the middle of one contact, component {}", k),
              expected[k] * closed, 1e-9, "f_a l_b erf(l/(2 sqrt(2) w))/(sqrt(2 pi) w l)"},
             field.values[middle + k]);
    validate({"V5.24", fmt::format("sum of that field over its points one sigma apart, component {}", k),
              expected[k], 1e-3 * expected[k], "f_a l_b"},
             sums[k]);
  }
}

TEST(Stress, OfAColumnIsTheWeightAbove) {
  for (const int dimension : {2, 3}) {
    const MemoryTrajectory t = sim::column_at_rest(dimension);
    analysis::AnalysisOptions options;
    options.only = {"stress", "wall_force", "stress_zz_z", "mechanical_contact_number", "contact_force"};
    const auto results = analysis::analyze(t, options);
    const auto& walls = analysis::find_result(results, "wall_force").values;
    validate({"V5.24", "force on the floor over the weight", 1, 1e-6, "closed form"},
             walls[0] / sim::kColumnBeads);
    // Virial: contact k carries k beads over a branch of one diameter, the floor all over a radius: N^2/2.
    // The window of a column is one diameter wide.
    validate({"V5.24", "sigma_zz of a column", sim::kColumnBeads / 2.0, 2e-3, "closed form"},
             analysis::find_result(results, "stress").values.back());
    const auto& profile = analysis::find_result(results, "stress_zz_z").values;
    double worst = 0;  // the middle of slab k is the centre of a bead: half of it is above
    for (int k = 0; k < sim::kColumnBeads; ++k)
      worst =
          std::max(worst, std::abs(profile.at(static_cast<std::size_t>(k)) - (sim::kColumnBeads - k - 0.5)));
    validate({"V5.24", "sigma_zz of the slabs of a column, largest error", 0, 5e-3, "closed form"}, worst);
    validate({"V5.24", "mean force of the contacts", sim::kColumnBeads / 2.0, 1e-5, "closed form"},
             analysis::find_result(results, "contact_force").value());
    // N - 1 beads with two contacts; the top one has one
    validate({"V5.24", "mechanical contact number of a column", 2, 1e-12, "closed form"},
             analysis::find_result(results, "mechanical_contact_number").value());
  }
}

TEST(Stress, OfABedThatIsDrivenSidewaysHasTheHeightsOfABedAtRest) {
  // A drive along x displaces the plate sideways: heights above it are z, whatever plate_height holds.
  const MemoryTrajectory rests = sim::column_at_rest(2);
  MemoryTrajectory driven(rests.info());
  driven.info().drive = Drive{Axis::x, 0.8, 1};
  driven.info().columns.plate_height = true;
  for (Frame frame : rests.frames()) {
    frame.plate_height = 0.8;
    driven.append(frame);
  }
  for (const char* name : {"stress_zz_z", "stress_z", "stress_field", "stress_field_z"}) {
    const auto expected = values_of(rests, name), found = values_of(driven, name);
    ASSERT_EQ(found.size(), expected.size()) << name;
    for (std::size_t k = 0; k < found.size(); ++k)
      EXPECT_NEAR(found[k], expected[k], 1e-12 * std::abs(expected[k])) << name << " " << k;
  }
}

TEST(Stress, KineticPartIsTheTemperature) {
  // Beads of mass 1 with speed c in both senses of each axis: m <v_a^2> = c^2/2 along each axis.
  MemoryTrajectory t = empty(2, Vec3(8, 1, 4), true);
  t.info().columns.contact_forces = true;
  std::vector<Vec3> r, v;
  for (int i = 0; i < 32; ++i) {
    r.emplace_back(i % 8 + 0.5, 0, i / 8 + 0.5);
    const double c = i % 4 < 2 ? 3 : -3;
    v.push_back(Vec3(1, 0, 2) + (i % 2 == 0 ? Vec3(c, 0, 0) : Vec3(0, 0, c)));
  }
  add(t, r, v);
  validate({"V5.24", "kinetic pressure of a gas", 4.5, 1e-12, "N T/V"}, values_of(t, "pressure_kinetic")[0]);
  EXPECT_NEAR(values_of(t, "pressure")[0], 0, 1e-12);
}

TEST(ContactForce, DistributionIsThatOfTheForces) {
  // Exponential forces: density exp(-x) of x = f/<f>, by the mean of each of its bins.
  std::mt19937_64 random(2);
  std::exponential_distribution<double> force(0.2);
  const MemoryTrajectory t = compressed(
      0.99, [&] { return force(random); }, 400);
  const auto density = values_of(t, "contact_force_density"), low = values_of(t, "contact_force_density_low"),
             high = values_of(t, "contact_force_density_high");
  int held = 0;
  for (std::size_t b = 0; b < 40; ++b) {
    const double x = static_cast<double>(b) * analysis::kForceWidth;
    const double expected = (std::exp(-x) - std::exp(-x - analysis::kForceWidth)) / analysis::kForceWidth;
    // 96000 forces; 240 in each frame, whose mean has an error of 6 %
    EXPECT_NEAR(density[b], expected, 0.03) << x;
    held += low[b] <= expected && expected <= high[b] ? 1 : 0;
  }
  EXPECT_GE(held, 32);
  validate({"V5.25", "mean of exponential forces", 5, 0.06, "closed form"}, values_of(t, "contact_force")[0]);
}

// The kinetic stress needs velocities only.
TEST(Stress, KineticPartNeedsNoContacts) {
  MemoryTrajectory t = empty(2, Vec3(8, 1, 4), true);
  add(t, {Vec3(1, 0, 1), Vec3(2, 0, 1)}, {Vec3(4, 0, 2), Vec3(-4, 0, -2)});
  validate({"V5.24", "kinetic pressure of two beads without contact forces", (16.0 + 4) / 32, 1e-12, "N T/V"},
           values_of(t, "pressure_kinetic")[0]);
  EXPECT_NEAR(values_of(t, "stress_kinetic")[1], 16.0 / 32, 1e-12);
}

// Frames whose forces are twice those of the time means.
TEST(Stress, UsesStoredTimeMeans) {
  MemoryTrajectory t = empty(2, Vec3(4, 1, 4), false);
  t.info().columns.contact_forces = t.info().columns.force_mean = true;
  t.info().samples_per_cycle = 400;
  t.info().walls = {"bottom"};
  t.info().drive = Drive{.amplitude = 2, .omega = 1};
  add(t, {Vec3(1, 0, 0.5), Vec3(2, 0, 0.5)});
  Frame frame = t.frames().front();
  MemoryTrajectory with(t.info()), without(t.info());
  for (int f = 0; f < 61; ++f) {
    frame.step = frame.cycle = f;
    frame.time = f;
    // Cycles 1 to 60 scatter about 1 in pairs that cancel.
    const int pair = (f - 1) / 2;
    const double off = 0.1 + 0.4 * std::fmod(0.618 * pair, 1.0);
    const double swing = (f % 2 == 0) == (pair * 7 % 5 < 2) ? 1 + off : 1 - off;
    frame.contact_forces = {{0, -1, 0, Vec3::UnitZ(), 4, Vec3::Zero()},
                            {0, 1, 0, -Vec3::UnitX(), 6, Vec3(0, 0, 3)}};
    frame.force_mean = {};
    without.append(frame);
    if (f > 0) {
      BedForces& m = frame.force_mean = BedForces::zero(1);
      m.wall_normal_force = {2 * swing};
      m.wall_force = {Vec3(0, 0, -2 * swing)};
      m.stress.diagonal() = Vec3(3, 0, 5) * swing;
      m.kinetic.diagonal() = Vec3(1, 0, 2) * swing;
      m.in_contact = 0.5, m.normal_force = 1.5 * swing, m.tangential_force = 0.6;
    }
    with.append(frame);
  }
  const auto of = [](const MemoryTrajectory& which, const std::string& name) {
    return analysis::find_result(analysis::analyze(which, {.only = {name}}), name);
  };
  for (const auto& [name, value] : {std::pair<std::string, double>{"pressure", 4},
                                    {"pressure_kinetic", 1.5},
                                    {"wall_support", 1},
                                    {"contact_force", 3},
                                    {"tangential_to_normal", 0.4}}) {
    const analysis::Result r = of(with, name);
    EXPECT_NEAR(r.value(), value, 1e-12) << name;
    EXPECT_EQ(r.n, 60U) << name;
    ASSERT_TRUE(r.interval) << name << ": " << r.no_interval;
    EXPECT_LE(r.interval->low, value + 1e-9) << name;
    EXPECT_GE(r.interval->high, value - 1e-9) << name;
    EXPECT_NE(r.convention.find("time"), std::string::npos) << r.convention;
  }
  EXPECT_NEAR(of(with, "wall_force").values.at(0), 2, 1e-12);
  EXPECT_LT(of(with, "wall_force_low").values.at(0), 2);
  EXPECT_GT(of(with, "wall_force_high").values.at(0), 2);
  EXPECT_NEAR(of(with, "stress").values.at(3), 5, 1e-12);
  // Of the frames alone: other values, no interval, and the reason.
  EXPECT_NEAR(of(without, "wall_force").values.at(0), 4, 1e-12);
  EXPECT_NEAR(of(without, "wall_support").value(), 2, 1e-12);
  EXPECT_NEAR(of(without, "contact_force").value(), 6, 1e-12);
  for (const char* name : {"pressure", "pressure_kinetic", "wall_support", "contact_force",
                           "tangential_to_normal", "wall_force"}) {
    const analysis::Result r = of(without, name);
    EXPECT_FALSE(r.interval) << name;
    EXPECT_NE(r.no_interval.find("--contacts"), std::string::npos) << name;
    EXPECT_NE(r.convention.find("miss the landings"), std::string::npos) << name;
  }
  EXPECT_NE(of(without, "wall_force_low").absent.find("--contacts"), std::string::npos);
}

TEST(ContactForce, IsAbsentWithoutStoredContacts) {
  MemoryTrajectory t = empty(2, Vec3(8, 1, 4), true);
  add(t, {Vec3(1, 0, 1), Vec3(2, 0, 1)});
  for (const char* name : {"stress", "pressure", "wall_force", "wall_support", "stress_zz_z", "contact_force",
                           "contact_force_density", "mechanical_contact_number"}) {
    analysis::AnalysisOptions options;
    options.only = {name};
    EXPECT_NE(analysis::find_result(analysis::analyze(t, options), name).absent.find("--contacts"),
              std::string::npos)
        << name;
  }
}

}  // namespace twincell::test::stress_test
