// Invariance under a change of frame, of units and of the direction of time (docs/validation.md: V1.10,
// V1.11, V4.11-V4.14).

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cstring>
#include <random>

#include "sim/run/make_solver.hpp"
#include "sim/run/simulation.hpp"
#include "sim/scene/make_plan.hpp"
#include "sim/scene/read_scene.hpp"
#include "sim/system/cell_grid.hpp"
#include "tests/support/collision.hpp"
#include "tests/support/validation.hpp"

namespace twincell::sim::symmetry_test {
namespace {

using test::validate;

std::string exact(double v) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17e", v);
  return text;
}
std::string closed_box(int dimension, double size) {
  std::string text = "[cell]\ngravity = 0.0\nlid = \"wall\"\nwidth = " + exact(size) +
                     "\nheight = " + exact(size) + "\ndimension = " + std::to_string(dimension) + "\n";
  return dimension == 2 ? text : text + "depth = " + exact(size) + "\n";
}

Vec3 velocity(const Bead& b) {
  return {b.vx, b.vy, b.vz};
}
Vec3 spin(const Bead& b) {
  return {b.spin_x, -b.spin, b.spin_z};
}
void set(Bead& b, const Vec3& r, const Vec3& v, const Vec3& w) {
  b.x = r.x(), b.y = r.y(), b.z = r.z();
  b.vx = v.x(), b.vy = v.y(), b.vz = v.z();
  b.spin_x = w.x(), b.spin = -w.y(), b.spin_z = w.z();
}

TEST(Symmetry, CollisionsTurnWithTheScene) {  // V1.10
  for (const int dimension : {2, 3}) {
    // In the plane about y, in space about an oblique axis.
    const Vec3 axis = dimension == 2 ? Vec3(0, 1, 0) : Vec3(1, 2, 3).normalized();
    const bool flat = dimension == 2;
    const auto collide = [&](double angle) {
      const Eigen::Matrix3d turn = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
      Bench b(closed_box(dimension, 20));
      b.system.walls.clear();
      b.add(0, 0, 0, 0), b.add(0, 0, 0, 0);
      // The collision takes place at the origin, where coordinates have the finest resolution, and a few
      // steps after the start: the spring multiplies the rounding errors of free flight by k_n dt.
      set(b.system.beads[0], turn * Vec3(-0.4951, 0, 0.1), turn * Vec3(0.5, flat ? 0 : 0.2, 0.4),
          flat ? Vec3(0, 1, 0) : Vec3(turn * Vec3(1, -2, 0.5)));
      set(b.system.beads[1], turn * Vec3(0.5, 0, 0), turn * Vec3(-0.5, 0, 0),
          flat ? Vec3(0, -3, 0) : Vec3(turn * Vec3(0, 1, 1)));
      b.advance_time(4e-3);
      std::array<Vec3, 6> out;
      for (std::size_t k = 0; k < 2; ++k) {
        const Bead& p = b.system.beads[k];
        out[3 * k] = turn.transpose() * centre_of(p);
        out[3 * k + 1] = turn.transpose() * velocity(p);
        out[3 * k + 2] = turn.transpose() * spin(p);
      }
      return out;
    };
    const auto rest = collide(0);
    ASSERT_LT(rest[1].x(), 0.4);  // they did collide
    double worst = 0;
    for (const double angle : {0.1, 0.7, 1.5707963267948966, 2.5, 4.0}) {
      const auto turned = collide(angle);
      for (std::size_t k = 0; k < 6; ++k) worst = std::max(worst, (turned[k] - rest[k]).norm());
    }
    validate(
        {"V1.10", "rough collision in five turned scenes, turned back, " + std::to_string(dimension) + "D", 0,
         1e-12, "isotropy"},
        worst);
  }
}

TEST(Symmetry, ElasticMotionRunsBackwards) {  // V1.11
  for (const int dimension : {2, 3}) {
    Bench b(closed_box(dimension, 4) +
            "[contact]\ntangential = \"none\"\ngamma_n = 0.0\nk_n = 1e5\n[contact.wall]\nk_n = 1e5\n");
    std::mt19937_64 engine(5);
    std::normal_distribution<double> maxwell(0, 1);
    for (const double x : {0.8, 2.0, 3.2})
      for (const double z : {0.9, 2.1}) {
        Bead& bead = b.add(x, z, maxwell(engine), maxwell(engine));
        if (dimension == 3) bead.y = 2, bead.vy = maxwell(engine);
      }
    const std::vector<Bead> start = b.system.beads;
    b.kernel->advance(b.system, 10'000);
    double gone = 0;
    for (std::size_t i = 0; i < start.size(); ++i) {
      Bead& p = b.system.beads[i];
      gone = std::max(gone, (velocity(p) - velocity(start[i])).norm());
      p.vx = -p.vx, p.vy = -p.vy, p.vz = -p.vz;
    }
    ASSERT_GT(gone, 0.5);
    b.kernel->advance(b.system, 10'000);
    double worst = 0;
    for (std::size_t i = 0; i < start.size(); ++i)
      worst = std::max(worst, (centre_of(b.system.beads[i]) - centre_of(start[i])).norm());
    validate(
        {"V1.11",
         "six smooth elastic beads in a box, 1e4 steps there and back, " + std::to_string(dimension) + "D", 0,
         1e-9, "time reversal"},
        worst);
  }
}

/// The frames of a scene.
MemoryTrajectory film(const std::string& text) {
  Simulation run(read_scene_text(text, "scaled"));
  MemoryTrajectory out(run.trajectory_info());
  run.run(out);
  return out;
}
/// Counts the numbers of b whose bits differ from those of a, the velocities of a multiplied by `factor`.
int unlike(const MemoryTrajectory& a, const MemoryTrajectory& b, double factor) {
  int count = 0;
  EXPECT_EQ(a.n_frames(), b.n_frames());
  for (std::size_t f = 0; f < a.n_frames(); ++f)
    for (std::size_t i = 0; i < a.frames()[f].position.size(); ++i) {
      const Frame &p = a.frames()[f], &q = b.frames()[f];
      count += p.position[i] != q.position[i];
      count += Vec3(factor * p.velocity[i]) != q.velocity[i];
      if (!p.spin.empty()) count += Vec3(factor * p.spin[i]) != q.spin[i];
    }
  return count;
}
/// <w^2> over beads and frames.
double vertical_temperature(const MemoryTrajectory& t) {
  double sum = 0;
  for (const Frame& f : t.frames())
    for (const Vec3& v : f.velocity) sum += v.z() * v.z();
  return sum;
}

TEST(Symmetry, WithoutGravitySpeedIsTheOnlyClock) {  // V4.11
  const auto cell = [](double f) {
    return film("preset = \"bhateja-2016-zero-g\"\n[drive]\nomega = " + exact(f) +
                "\n[contact]\nk_n = " + exact(2.5e5 * f * f) + "\n[start]\nvelocity_scale = " + exact(f) +
                "\n[time]\ndiscard = 0\ncycles = 2\nsteps_per_contact = 20\n");
  };
  const MemoryTrajectory one = cell(1);
  for (const double f : {2.0, 4.0}) {
    const MemoryTrajectory fast = cell(f);
    const std::string what =
        "zero-gravity cell, V_p and k_n scaled, " + std::to_string(static_cast<int>(f)) + " V_p: ";
    validate({"V4.11", what + "numbers with other bits", 0, 0, "similarity"}, unlike(one, fast, f));
    validate({"V4.11", what + "exponent of T_z", 2, 1e-12, "similarity"},
             std::log(vertical_temperature(fast) / vertical_temperature(one)) / std::log(f));
  }
}

TEST(Symmetry, FasterDriveIsWeakerGravity) {  // V4.12
  for (const char* law : {"dashpot", "spring"}) {
    const auto bed = [&](double f) {
      const std::string friction = std::string(law) == "spring"
                                       ? "k_t = " + exact(1e4 * f * f) + "\ngamma_t = " + exact(100 * f) +
                                             "\ngamma_n = " + exact(100 * f) + "\n"
                                       : "restitution = 0.9\nc_t_over_c_n = 1.0\n";
      return film("[cell]\nwidth = 10.0\nsides = \"periodic\"\ngravity = " + exact(f * f) +
                  "\n[beads]\ncount = 40\n[contact]\nmu = 0.4\ntangential = \"" + law + "\"\nk_n = " +
                  exact(1e5 * f * f) + "\n" + friction + "[drive]\namplitude = 1.0\nomega = " + exact(2 * f) +
                  "\n[start]\nkind = \"random\"\nvelocity_scale = " + exact(f) +
                  "\nrest_energy = " + exact(1e-8 * f * f) + "\nsettle_limit = " + exact(20 / f) +
                  "\n[time]\ndiscard = 0\ncycles = 2\nsteps_per_contact = 20\n");
    };
    validate({"V4.12",
              std::string("driven bed, (omega, g) -> (2 omega, 4 g), ") + law + ": numbers with other bits",
              0, 0, "similarity"},
             unlike(bed(1), bed(2), 2));
  }
}

TEST(Symmetry, UnitsDoNotMatter) {  // V4.13
  // 2 mm glass: sigma, m and g in SI.
  const double sigma = 2e-3, mass = 2500 * std::numbers::pi / 6 * std::pow(sigma, 3), g = 9.81;
  const auto bed = [](double l, double m, double acceleration) {
    const double t = std::sqrt(l / acceleration), k = m * acceleration / l;
    const Scene scene =
        read_scene_text("[cell]\nwidth = " + exact(20 * l) + "\ngravity = " + exact(acceleration) +
                            "\n[beads]\ncount = 1\nradius = " + exact(l / 2) + "\nmass = " + exact(m) +
                            "\n[contact]\nk_n = " + exact(1e6 * k) + "\nk_t = " + exact(1e4 * k) +
                            "\ngamma_n = " + exact(100 / t) + "\ngamma_t = " + exact(100 / t) +
                            "\n[drive]\namplitude = " + exact(2 * l) + "\nomega = " + exact(1 / t) + "\n",
                        "units");
    const Plan plan = make_plan(scene);
    System system = make_system(scene, plan);
    for (int i = 0; i < 4; ++i) {
      Bead b;
      b.radius = l / 2, b.mass = m, b.inertia = scene.inertia_factor * m * l * l / 4;
      b.x = (0.7 + 1.0 * i + 0.001 * i) * l, b.z = (0.502 + 0.001 * i) * l;
      b.vx = (i % 2 ? 0.5 : -0.5) * l / t, b.vz = -0.3 * l / t;
      system.beads.push_back(b);
    }
    const auto kernel = make_solver(plan, {});
    kernel->advance(system, 2'000);
    for (Bead& b : system.beads) {
      b.x /= l, b.z /= l, b.vx *= t / l, b.vz *= t / l, b.spin *= t;
    }
    return system.beads;
  };
  const auto reduced = bed(1, 1, 1), si = bed(sigma, mass, g);
  double worst = 0, turning = 0;
  for (std::size_t i = 0; i < si.size(); ++i) {
    worst = std::max(worst, (centre_of(si[i]) - centre_of(reduced[i])).norm());
    turning = std::max(turning, std::abs(reduced[i].spin));
  }
  ASSERT_GT(turning, 0.1);
  validate({"V4.13", "4 beads on a driven plate, 2e3 steps, in SI and in reduced units: places", 0, 1e-12,
            "similarity"},
           worst);
}

/// The first paper's crystal in a cell centred on x = 0, where a mirror image has the same digits.
System centred_crystal(const Scene& scene, const Plan& plan) {
  System s = make_system(scene, plan);
  s.beads = make_start(scene).beads;
  for (Wall& w : s.walls)
    if (w.n.x() != 0) w.offset += -w.n.x() * scene.width / 2;
  for (Bead& b : s.beads) b.x -= scene.width / 2, b.vz = s.drive.peak_velocity();
  return s;
}
Bead mirrored(Bead b) {
  b.x = -b.x, b.vx = -b.vx, b.spin = -b.spin;
  return b;
}
bool same_motion(const Bead& a, const Bead& b) {
  return a.x == b.x && a.z == b.z && a.vx == b.vx && a.vz == b.vz && a.spin == b.spin;
}

TEST(Symmetry, MirrorImagesStayMirrorImages) {  // V4.14
  const Scene scene = read_scene_text(
      "preset = \"fortini-huang-2015\"\n[beads]\ncount = 78\n[drive]\ngamma = 2.0\n[time]\nsteps_per_contact "
      "= 20\n",
      "mirror");
  const Plan plan = make_plan(scene);
  const auto run = [&](System s) {
    make_solver(plan, {})->advance(s, 2 * plan.steps_per_period);
    return s.beads;
  };
  // A randomly disturbed crystal and its mirror image.
  System disturbed = centred_crystal(scene, plan);
  std::mt19937_64 engine(3);
  for (Bead& b : disturbed.beads)
    b.z += static_cast<double>(engine() % 1000) * 0x1p-20,
        b.vx = 0.1 * static_cast<double>(engine() % 100) / 100;
  System image = disturbed;
  for (Bead& b : image.beads) b = mirrored(b);
  const auto beads = run(disturbed), images = run(image);
  int unlike = 0;
  double moved = 0;
  for (std::size_t i = 0; i < beads.size(); ++i) {
    unlike += !same_motion(mirrored(beads[i]), images[i]);
    moved = std::max(moved, std::abs(beads[i].spin));
  }
  ASSERT_GT(moved, 0.01);
  validate({"V4.14", "disturbed crystal and its mirror image after two periods: beads with other bits", 0, 0,
            "mirror symmetry"},
           unlike);

  // The perfect crystal is its own mirror image, and stays so until a rounding error breaks the symmetry.
  const System perfect = centred_crystal(scene, plan);
  const auto after = run(perfect);
  int alone = 0;
  for (std::size_t i = 0; i < after.size(); ++i)
    for (std::size_t j = 0; j < after.size(); ++j)
      if (perfect.beads[j].x == -perfect.beads[i].x && perfect.beads[j].z == perfect.beads[i].z)
        alone += !same_motion(mirrored(after[i]), after[j]);
  validate({"V4.14", "perfect crystal after two periods: beads that are not their partner's image", 0, 0,
            "mirror symmetry"},
           alone);
}

}  // namespace
}  // namespace twincell::sim::symmetry_test
