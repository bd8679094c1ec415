// Event-driven motion agrees with motion by time steps: a single collision equals the limit of infinitely
// many steps, a gas has the same temperature, and the result has the same bits however the run is divided
// into calls.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstring>
#include <random>

#include "core/error.hpp"
#include "sim/event_driven/binary_collision.hpp"
#include "sim/event_driven/event_driven_solver.hpp"
#include "sim/laws/contact_laws.hpp"
#include "sim/run/make_solver.hpp"
#include "sim/run/simulation.hpp"
#include "sim/scene/make_plan.hpp"
#include "sim/scene/read_scene.hpp"
#include "tests/support/put_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell::sim::event_driven_test {
namespace {

Scene scene_of(const std::string& text) {
  return read_scene_text(text, "gas");
}
/// The cell of the second paper, strongly driven.
std::string gas(const std::string& system, double w, const std::string& more = "") {
  return "preset = \"bhateja-2016-" + system + "\"\n[drive]\nk_m = " + std::to_string(w) +
         "\n[time]\nintegrator = \"split\"\nsteps_per_contact = 25\n" + more;
}

// --- single collision ---

struct Impact {
  double normal, tangential, spin, mu, restitution;
  int dimension;
};
ContactLaws laws_of(const Impact& m) {
  LinearSpringDashpot normal;
  normal.k_n = 1e6;
  normal.damping = {0, 0, damping_of_restitution(m.restitution) * 1e3};
  ContactLaws laws{normal, NoTangential{}, NoRolling{}};
  if (m.mu > 0) laws.tangential = DashpotSlider{normal.damping, m.mu};
  return laws;
}
/// Two beads of mass 1 and radius 1/2: spheres in 3D, discs in 2D.
CollisionSetting setting_of(const Impact& m, const ContactLaws& laws) {
  const double turn = m.dimension == 2 ? 2 : 2.5;  // R^2/I for m = 1
  CollisionSetting s;
  s.dimension = m.dimension;
  s.laws = &laws;
  s.pair = {0.5, 0.25, 2 * (1 + turn)};
  s.reach = 1;
  s.turn = 2 * turn;
  return s;
}

TEST(BinaryCollision, HeadOnHasTheClosedFormsRestitutionAndDuration) {
  for (const double e : {0.3, 0.7, 0.9, 1.0}) {
    const Impact impact{4, 0, 0, 0, e, 2};
    const ContactLaws laws = laws_of(impact);
    const CollisionSetting s = setting_of(impact, laws);
    const CollisionEnd end =
        integrate_collision(s, {Vec3(0, 0, 1), Vec3(0, 0, -4), Vec3::Zero()}, 0, 1, 1e-12);
    const Collision exact = std::get<LinearSpringDashpot>(laws.normal).collision(s.pair);
    ASSERT_TRUE(end.parted);
    EXPECT_NEAR(end.motion.u.z() / 4, exact.restitution, 1e-10) << e;
    EXPECT_NEAR(end.time / exact.duration, 1, 1e-10) << e;
    EXPECT_NEAR(end.motion.r.z(), 1, 1e-13);
  }
}

// F_n has a kink where the pull would begin (Schwager & Poeschel 2007), and is 0 from there to the end of the
// contact.
TEST(BinaryCollision, WithoutTensionHasTheClosedFormsRestitution) {
  for (const double e : {0.3, 0.7, 0.9})
    for (const double mu : {0.0, 0.4}) {
      const Impact impact{4, 0, 0, mu, e, 2};
      ContactLaws laws = laws_of(impact);
      laws.normal = NoTensionSpringDashpot{std::get<LinearSpringDashpot>(laws.normal)};
      const CollisionSetting s = setting_of(impact, laws);
      const CollisionEnd end =
          integrate_collision(s, {Vec3(0, 0, 1), Vec3(0, 0, -4), Vec3::Zero()}, 0, 1, 1e-12);
      ASSERT_TRUE(end.parted);
      const double exact = std::get<NoTensionSpringDashpot>(laws.normal).collision(s.pair).restitution;
      EXPECT_NEAR(end.motion.u.z() / 4, exact, 1e-10) << e << ", mu " << mu;
    }
}

/// The same collision by the time-stepping solver with n steps per contact. Returns v_i - v_j and R_i w_i +
/// R_j w_j after the collision.
std::pair<Vec3, Vec3> by_steps(const Impact& m, double n) {
  std::string text =
      "[cell]\ndimension = " + std::to_string(m.dimension) +
      "\nwidth = 40.0\nheight = 40.0\ngravity = 0.0\nbottom = \"periodic\"\nsides = \"periodic\"\n";
  if (m.dimension == 3) text += "depth = 40.0\nplates = \"periodic\"\n";
  text += "[beads]\ncount = 2\n[drive]\namplitude = 0.0\nomega = 6.0\n[time]\nintegrator = \"split\"\n" +
          fmt::format(
              "steps_per_contact = {}\n[contact]\nk_n = 1e6\ntangential = \"dashpot\"\nmu = {}\n"
              "restitution = {}\nc_t_over_c_n = 1.0\n",
              n, m.mu, m.restitution);
  const Scene scene = scene_of(text);
  const Plan plan = make_plan(scene);
  System s = make_system(scene, plan);
  Bead a, b;
  a.inertia = b.inertia = m.dimension == 2 ? 0.125 : 0.1;
  // The beads touch at the end of a step and are then moved back by half a step, so that contact begins
  // inside a step, as it does in general.
  const double back = 0.5 * plan.dt;
  a.z = 0.5 + back * m.normal, a.vz = -0.5 * m.normal;
  b.z = -0.5, b.vz = 0.5 * m.normal;
  a.z -= 0.5 * back * m.normal, b.z -= 0.5 * back * m.normal;
  a.vx = 0.5 * m.tangential, b.vx = -0.5 * m.tangential;
  a.x -= back * a.vx, b.x -= back * b.vx;
  a.spin = b.spin = m.spin;
  s.beads = {a, b};
  const auto kernel = make_solver(plan, guard_limits(plan), SolverKind::all_pairs);
  const double apart = 1;
  std::int64_t steps = 0;
  do {
    kernel->advance(s, 1);
    ++steps;
  } while (steps < 10 || Vec3(s.beads[0].x - s.beads[1].x, 0, s.beads[0].z - s.beads[1].z).norm() < apart);
  kernel->advance(s, 2);  // the last contact step may leave a correction to later steps
  const Bead &p = s.beads[0], &q = s.beads[1];
  return {Vec3(p.vx - q.vx, p.vy - q.vy, p.vz - q.vz), Vec3(0, -p.radius * p.spin - q.radius * q.spin, 0)};
}

TEST(BinaryCollision, ObliqueIsTheLimitOfEverSmallerSteps) {
  for (const int dimension : {2, 3})
    for (const double mu : {0.0, 0.4})
      for (const auto& [normal, tangential, spin] :
           {std::tuple{4.0, 1.0, 0.3}, std::tuple{4.0, 6.0, 0.0}, std::tuple{1.0, 4.0, -2.0}}) {
        const Impact impact{normal, tangential, spin, mu, 0.9, dimension};
        const ContactLaws laws = laws_of(impact);
        const RelativeMotion start{Vec3(0, 0, 1), Vec3(tangential, 0, -normal), Vec3(0, -spin, 0)};
        const CollisionEnd end = integrate_collision(setting_of(impact, laws), start, 0, 1, 1e-12);
        ASSERT_TRUE(end.parted);
        // The method is of second order: two step lengths give the limit, a second pair gives its accuracy.
        const auto limit = [&](double n) {
          const auto coarse = by_steps(impact, n), fine = by_steps(impact, 2 * n);
          return std::pair<Vec3, Vec3>{(4 * fine.first - coarse.first) / 3,
                                       (4 * fine.second - coarse.second) / 3};
        };
        const auto a = limit(2000), b = limit(50000);
        const double speed = std::hypot(normal, tangential);
        const std::string name = std::to_string(dimension) + "D mu " + std::to_string(mu) + " at " +
                                 std::to_string(normal) + ", " + std::to_string(tangential);
        EXPECT_LT((end.motion.u - b.first).norm() / speed, 1e-8)
            << name << ", limits differ by " << (a.first - b.first).norm() / speed;
        EXPECT_LT((end.motion.s - b.second).norm() / speed, 1e-9) << name;
      }
}

// The orientation of two spheres in space does not change their collision from that in the plane of their
// motion: relative speed, direction and spin are preserved.
TEST(BinaryCollision, SmoothSpheresAreIndependentOfOrientation) {
  std::mt19937 random(8);
  std::normal_distribution<double> normal;
  const Impact impact{4, 3, 0, 0, 0.8, 3};
  const ContactLaws laws = laws_of(impact);
  Impact flat = impact;
  flat.dimension = 2;
  const RelativeMotion start{Vec3(0, 0, 1), Vec3(3, 0, -4), Vec3(0.1, 0.2, 0.3)};
  const CollisionEnd plane = integrate_collision(setting_of(flat, laws), start, 0, 1, 1e-12);
  for (int k = 0; k < 100; ++k) {
    const Eigen::Quaterniond turn =
        Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random)).normalized();
    const RelativeMotion turned{turn * start.r, turn * start.u, turn * start.s};
    const CollisionEnd end = integrate_collision(setting_of(impact, laws), turned, 0, 1, 1e-12);
    ASSERT_TRUE(end.parted);
    EXPECT_NEAR(end.time / plane.time, 1, 1e-11);
    EXPECT_LT((end.motion.u - turn * plane.motion.u).norm(), 1e-10);
    EXPECT_LT((end.motion.r - turn * plane.motion.r).norm(), 1e-10);
    EXPECT_EQ(end.motion.s, turned.s);
    EXPECT_NEAR((end.motion.r.cross(end.motion.u) - turned.r.cross(turned.u)).norm(), 0, 1e-11);
  }
  // In a head-on collision the tangential direction is undefined.
  const CollisionEnd end = integrate_collision(setting_of(impact, laws),
                                               {Vec3(0, 1, 0), Vec3(0, -4, 0), Vec3::Zero()}, 0, 1, 1e-12);
  EXPECT_NEAR(end.motion.u.y() / 4, 0.8, 1e-10);
  EXPECT_LT(std::hypot(end.motion.u.x(), end.motion.u.z()), 1e-15);
}

// Short contacts, sliding that begins and ends within a small fraction of the contact, and a floor that
// returns: a long step must not miss what short steps resolve.
TEST(BinaryCollision, NoStepLeapsOverWhatShorterOnesSee) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (const int dimension : {2, 3})
    for (const double mu : {0.0, 0.1, 0.5})
      for (const bool floor : {false, true}) {
        const ContactLaws laws = laws_of({0, 0, 0, mu, 0.9, dimension});
        CollisionSetting s = setting_of({0, 0, 0, mu, 0.9, dimension}, laws);
        if (floor) {
          s.wall = Vec3::UnitZ();
          s.reach = 0.5;
          s.pair = {1, 0.5, 1 + s.turn / 2};
          s.turn /= 2;
          s.pull = -Vec3::UnitZ();
          s.swing = 600 * Vec3::UnitZ(), s.omega = 20;
        }
        const double piece = 0.01 * collision_time(s, 1);
        for (int k = 0; k < 150; ++k) {
          const auto draw = [&](double size) {
            Vec3 v(normal(random), normal(random), normal(random));
            if (dimension == 2) v.y() = 0;
            return Vec3(size * v);
          };
          const Vec3 n = floor ? Vec3::UnitZ().eval() : draw(1).normalized();
          RelativeMotion start{s.reach * n, draw(7), Vec3::Zero()};
          if (start.u.dot(n) > 0) start.u -= 2 * start.u.dot(n) * n;
          if (mu > 0) start.s = dimension == 2 ? Vec3(0, 5 * normal(random), 0) : draw(5);
          const double speed = std::max(start.u.norm(), start.s.norm());
          const CollisionEnd whole = integrate_collision(s, start, 0.3, 1, 1e-7);
          CollisionEnd cut{false, 0.3, start, 0};
          while (!cut.parted && cut.time < 1)
            cut = integrate_collision(s, cut.motion, cut.time, cut.time + piece, 1e-12);
          ASSERT_TRUE(whole.parted && cut.parted);
          const std::string name = fmt::format("{}D mu {} floor {} number {}", dimension, mu, floor, k);
          EXPECT_LT((whole.motion.u - cut.motion.u).norm() / speed, 3e-5) << name;
          EXPECT_LT((whole.motion.s - cut.motion.s).norm() / speed, 3e-5) << name;
          EXPECT_LT((whole.motion.r - cut.motion.r).norm(), 1e-6) << name;
        }
      }
}

// --- many beads ---

struct Gas {
  Scene scene;
  Plan plan;
  System system;
  std::unique_ptr<Solver> kernel;

  Gas(const std::string& text, bool flights)
      : scene(scene_of(text)), plan(make_plan(scene)), system(make_system(scene, plan)) {
    plan.event_driven = flights;
    kernel = make_solver(plan, guard_limits(plan));
    system.beads = placed(scene).beads;
    system.drive.amplitude = 0;
    kernel->advance(system, static_cast<std::int64_t>(8 / system.dt));
    begin_drive(scene, plan, system);
  }
  void periods(std::int64_t n) { kernel->advance(system, n * plan.steps_per_period); }
};

TEST(EventDriven, TemperatureAgreesWithTimeStepping) {
  for (const char* system : {"rough-2d", "smooth-3d"}) {
    std::array<double, 2> mean{}, error{};
    for (const bool flights : {false, true}) {
      Gas g(gas(system, 50), flights);
      g.periods(60);
      constexpr int kBlocks = 10, kPeriods = 30, kLooks = 4;
      std::vector<double> blocks;
      for (int b = 0; b < kBlocks; ++b) {
        double sum = 0;
        for (int k = 0; k < kPeriods * kLooks; ++k) {
          g.kernel->advance(g.system, g.plan.steps_per_period / kLooks);
          double v = 0, vv = 0;
          for (const Bead& bead : g.system.beads) v += bead.vz, vv += bead.vz * bead.vz;
          const auto n = static_cast<double>(g.system.beads.size());
          sum += vv / n - v * v / (n * n);
        }
        blocks.push_back(sum / (kPeriods * kLooks) / g.scene.drive.k_m());
      }
      double m = 0, var = 0;
      for (const double b : blocks) m += b / kBlocks;
      for (const double b : blocks) var += (b - m) * (b - m) / (kBlocks - 1) / kBlocks;
      mean[flights ? 1 : 0] = m, error[flights ? 1 : 0] = std::sqrt(var);
    }
    const double spread = std::hypot(error[0], error[1]);
    EXPECT_LT(spread, 0.1 * mean[0]) << system;
    EXPECT_NEAR(mean[1], mean[0], 4 * spread)
        << system << ": " << mean[0] << " +- " << error[0] << " by steps, " << mean[1] << " +- " << error[1]
        << " by flights";
  }
}

void expect_same_bits_however_cut(const std::string& text) {
  Gas whole(text, true), cut(text, true), taken(text, true);
  const std::int64_t steps = 6 * whole.plan.steps_per_period;
  whole.kernel->advance(whole.system, steps);
  for (std::int64_t done = 0, piece = 1; done < steps; done += piece, piece = piece * 7 % 1013 + 1)
    cut.kernel->advance(cut.system, std::min(piece, steps - done));
  for (std::int64_t done = 0, piece = steps / 11; done < steps; done += piece) {
    taken.kernel->advance(taken.system, std::min(piece, steps - done));
    const auto contacts = taken.kernel->contacts();
    const auto memory = taken.kernel->memory();
    taken.kernel = make_solver(taken.plan, guard_limits(taken.plan));
    taken.kernel->restore(contacts);
    taken.kernel->recall(taken.system, memory);
  }
  const auto bytes = whole.system.beads.size() * sizeof(Bead);
  EXPECT_EQ(std::memcmp(whole.system.beads.data(), cut.system.beads.data(), bytes), 0);
  EXPECT_EQ(std::memcmp(whole.system.beads.data(), taken.system.beads.data(), bytes), 0);
  EXPECT_NE(whole.system.beads[0].spin, 0);
  EXPECT_NE(whole.kernel->description().find("free flight"), std::string::npos);
  EXPECT_NE(whole.kernel->memory().front(), 0) << "beads fly";
}
TEST(EventDriven, BitwiseEqualForAnySplitOrResume) {
  expect_same_bits_however_cut(gas("rough-3d", 30));
}
TEST(EventDriven, WithSpringsBitwiseEqualForAnySplitOrResume) {
  expect_same_bits_however_cut(gas("rough-2d", 50, "[contact]\ntangential = \"spring\"\nk_t = 2e5\n"));
}

const std::string kDashpot = "tangential = \"dashpot\"\nc_t_over_c_n = 1.0\n",
                  kSpring = "tangential = \"spring\"\nk_t = 2e5\ngamma_t = 100.0\n",
                  kSpringOnly = "tangential = \"spring-limited\"\nk_t = 2e5\ngamma_t = 100.0\n",
                  kForceClipped = "tangential = \"force-clipped\"\nk_t = 2e5\ngamma_t = 100.0\n";

/// Two spheres slide on each other while a separate row of `row` beads is compressed. Returns all beads after
/// both events.
std::vector<Bead> pair_and_row(const std::string& stepping, int n, int row, const std::string& friction) {
  const Scene scene = scene_of(fmt::format(
      "[cell]\ndimension = 3\nwidth = 40.0\ndepth = 40.0\nheight = 40.0\ngravity = 0.0\nbottom = "
      "\"periodic\"\nsides = \"periodic\"\nplates = \"periodic\"\n[beads]\ncount = {}\n[drive]\namplitude "
      "= 0.0\nomega = 6.0\n[time]\nintegrator = \"split\"\nsteps_per_contact = {}\nstepping = "
      "\"{}\"\n[contact]\nk_n = 1e6\nmu = 0.4\nrestitution = 0.9\n{}",
      2 + row, n, stepping, friction));
  const Plan plan = make_plan(scene);
  System s = make_system(scene, plan);
  const auto put = [&](const Vec3& r, const Vec3& v) {
    Bead b;
    b.inertia = 0.1;
    b.x = r.x(), b.y = r.y(), b.z = r.z(), b.vx = v.x(), b.vy = v.y(), b.vz = v.z();
    s.beads.push_back(b);
  };
  const double t_c = 2.2227e-3, gap = 1e-4, v = 4;  // the pair touches after a time gap/v
  put({10, 10, 10.5 + gap / 2}, {1.5, 1, -v / 2});
  put({10, 10, 9.5 - gap / 2}, {-1.5, -1, v / 2});
  // The beads of the row all touch 0.45 t_c after the pair.
  const double space = v * (gap / v + 0.45 * t_c);
  for (int k = 0; k < row; ++k) {
    const double place = k - 0.5 * (row - 1);
    put({25 + (1 + space) * place, 10, 10}, {-v * place, 0, 0.6 * place});
  }
  const auto kernel = make_solver(plan, guard_limits(plan));
  while (s.time() < 3 * t_c) kernel->advance(s, 1);
  return s.beads;
}
/// Largest difference of velocity and of surface speed R w between `a` and `b`, in sigma/t0, over beads
/// `first` to `last` - 1.
double difference(const std::vector<Bead>& a, const std::vector<Bead>& b, std::size_t first,
                  std::size_t last) {
  double most = 0;
  for (std::size_t i = first; i < last; ++i)
    most =
        std::max({most, std::abs(a[i].vx - b[i].vx), std::abs(a[i].vy - b[i].vy), std::abs(a[i].vz - b[i].vz),
                  0.5 * std::abs(a[i].spin - b[i].spin), 0.5 * std::abs(a[i].spin_x - b[i].spin_x)});
  return most;
}

// A Hertz contact begins without a normal force, so the Coulomb limit begins at 0, and with it the sum of
// spring and dashpot. Friction on a flat plate acts along -v_t, which never turns.
TEST(EventDriven, HertzContactStartsSlidingAlongItsVelocity) {
  const TemporaryFolder folder;
  put_file(
      folder / "one.csv",
      "x,y,z,vx,vy,vz,spin_x,spin,spin_z\n2.0,2.0,0.7,0.16863,-0.45907,-1.62627,3.84862,-10.84514,0.16681\n");
  const auto last = [&](const std::string& stepping, int n) {
    Simulation run(scene_of(fmt::format(
        "[cell]\ndimension = 3\nwidth = 100.0\ndepth = 100.0\nheight = 50.0\n[beads]\ncount = "
        "1\n[contact]\nnormal = "
        "\"hertz\"\ntangential = \"spring\"\nmu = 0.26138\nc_t = 16.86155\nk_t = 12068.51052\nyoungs_modulus "
        "= "
        "1e6\nviscous_time = 0.00011\n[drive]\namplitude = 0.0\nomega = 6.283185307179586\n[start]\nkind = "
        "\"table\"\nfrom = \"{}\"\nin_motion = true\n[time]\ndiscard = 0\ncycles = 1\nphases = 20\nstepping "
        "= "
        "\"{}\"\nsteps_per_contact = {}\n",
        (folder / "one.csv").string(), stepping, n)));
    MemoryTrajectory t(run.trajectory_info());
    run.run(t);
    const Frame& f = t.frames().back();
    return std::pair{f.velocity[0], f.spin[0]};
  };
  const auto [v, w] = last("event-driven", 100);
  const auto [v_steps, w_steps] = last("steps", 4000);
  // v_t = v + R w x n with n = z, before and after. The spin of a table is counter-clockwise, -w_y.
  const Vec3 v_0(0.16863, -0.45907, 0), w_0(3.84862, 10.84514, 0.16681), arm(0, 0, -0.5);
  Vec3 slip = v_0 + w_0.cross(arm), change = v - v_0;
  slip.z() = change.z() = 0;
  EXPECT_GT(change.norm(), 0.5);
  EXPECT_NEAR(change.normalized().dot(slip.normalized()), -1, 1e-9);
  EXPECT_NEAR(change.normalized().cross(slip.normalized()).norm(), 0, 1e-7);
  EXPECT_NEAR((v - v_steps).norm(), 0, 1e-6);
  EXPECT_NEAR((w - w_steps).norm(), 0, 1e-5);
}

// Three beads in contact move by time steps until they separate; the pair stays event-driven.
TEST(EventDriven, ThreeBodyClusterAgreesWithTimeStepping) {
  for (const std::string& law : {kDashpot, kSpring, kSpringOnly, kForceClipped}) {
    const auto exact = pair_and_row("steps", 8000, 3, law), by_steps = pair_and_row("steps", 200, 3, law),
               flown = pair_and_row("event-driven", 200, 3, law);
    EXPECT_GT(std::abs(exact[2].spin), 0.1) << law;
    EXPECT_LT(difference(flown, exact, 2, 5), 2e-3) << law;
    EXPECT_LT(difference(flown, exact, 0, 2), 1e-5) << law;
    EXPECT_GT(difference(by_steps, exact, 0, 2), 2 * difference(flown, exact, 0, 2)) << law;
  }
}

// Ten beads in contact are too many to be stepped separately, so that the whole system changes to time steps
// in the middle of the contact of the pair. The contact must end as if uninterrupted, which requires that its
// tangential spring is passed on.
TEST(EventDriven, OpenContactIsPassedToTimeStepping) {
  for (const std::string& law : {kDashpot, kSpring, kSpringOnly, kForceClipped}) {
    const auto exact = pair_and_row("steps", 8000, 10, law),
               handed = pair_and_row("event-driven", 200, 10, law);
    EXPECT_GT(std::abs(exact[0].spin), 1) << law;
    EXPECT_GT(std::abs(exact[0].spin_x), 0.5) << law;
    EXPECT_LT(difference(handed, exact, 0, 2), 1e-3) << law;
    EXPECT_GT(difference(handed, exact, 0, 2), 1e-7) << law;
  }
}

// Elastic beads in a box without gravity: the energy after some ten thousand collisions equals the initial
// energy, except for the energy stored in current contacts.
// Two collisions that overlap make a cluster, whose steps are followed until its beads have parted. Half of
// the impulse of the step in which they part belongs to the step after it: elastic gases were heated without
// it.
TEST(EventDriven, ClusterEnergyAgreesWithTimeStepping) {
  for (const double n : {18.0, 20.0, 22.0, 25.0, 30.0, 40.0, 50.0}) {
    double energy[2];
    for (const bool flights : {false, true}) {
      const Scene scene =
          scene_of(fmt::format("[cell]\nwidth = 10.0\nheight = 10.0\nlid = \"wall\"\ngravity = "
                               "0.0\n[beads]\ncount = 3\n[contact]\nk_n = "
                               "1e5\nrestitution = 1.0\ntangential = \"none\"\n[drive]\namplitude = "
                               "0.0\nomega = 1.0\n[time]\nintegrator = "
                               "\"split\"\nsteps_per_contact = {}\nstepping = \"{}\"\n",
                               n, flights ? "event-driven" : "steps"));
      const Plan plan = make_plan(scene);
      System s = make_system(scene, plan);
      s.beads.resize(3);
      for (std::size_t k = 0; k < 3; ++k) s.beads[k].z = 5;
      s.beads[0].x = 2, s.beads[1].x = 4, s.beads[2].x = 5.001;
      s.beads[0].vx = 1;
      for (Bead& b : s.beads) b.radius = 0.5, b.mass = 1, b.inertia = 0.125;
      const auto kernel = make_solver(plan, guard_limits(plan));
      kernel->advance(s, static_cast<std::int64_t>(3 / s.dt));
      energy[flights ? 1 : 0] = 3 * kinetic_energy_per_bead(s);
    }
    EXPECT_NEAR(energy[1], energy[0], 1e-5) << "n = " << n;
    EXPECT_NEAR(energy[1], 0.5, 1e-4) << "n = " << n;
  }
}

TEST(EventDriven, ElasticBeadsConserveEnergy) {
  Gas g(
      "[cell]\ndimension = 3\nwidth = 8.0\ndepth = 8.0\nheight = 8.0\ngravity = 0.0\nsides = "
      "\"periodic\"\nplates = \"periodic\"\nbottom = \"periodic\"\n[beads]\ncount = 50\n[start]\nkind = "
      "\"random\"\n[contact]\nk_n = 1e6\nrestitution = 1.0\ntangential = \"none\"\n[drive]\namplitude = "
      "0.0\nomega = 6.0\n[time]\nintegrator = \"split\"\nsteps_per_contact = 400\nstepping = "
      "\"event-driven\"\n",
      true);
  const auto least = [&] {  // maximum over several steps, at one of which no beads are in contact
    double e = 0;
    for (int k = 0; k < 200; ++k) {
      g.kernel->advance(g.system, 37);
      e = std::max(e, kinetic_energy_per_bead(g.system));
    }
    return e;
  };
  const double before = least();
  g.periods(200);
  const double after = least();
  EXPECT_GT(before, 0.1);
  EXPECT_NEAR(after / before, 1, 3e-6);
}

// A box at rest without gravity, defined by a scene file and run with `auto`.
TEST(EventDriven, IsTheAutomaticChoiceWithoutGravity) {
  const Scene scene = scene_of(
      "[cell]\nwidth = 8.0\nheight = 8.0\ngravity = 0.0\nsides = \"periodic\"\nbottom = \"periodic\"\n"
      "[beads]\ncount = 20\n[start]\nkind = \"random\"\n[contact]\nk_n = 1e5\nrestitution = 1.0\n"
      "tangential = \"none\"\n[drive]\namplitude = 0.0\nomega = 6.0\n"
      "[time]\nintegrator = \"verlet\"\n");  // `split` drifts in energy where three beads are in contact
  const Plan plan = make_plan(scene);
  EXPECT_TRUE(plan.event_driven);
  System s = make_system(scene, plan);
  s.beads = placed(scene).beads;
  const auto kernel = make_solver(plan, guard_limits(plan));
  const auto most = [&] {  // maximum over several instants, at one of which no beads are in contact
    double e = 0;
    for (int k = 0; k < 100; ++k) {
      kernel->advance(s, 37);
      e = std::max(e, kinetic_energy_per_bead(s));
    }
    return e;
  };
  const double before = most();
  kernel->advance(s, 300 * plan.steps_per_period);
  EXPECT_GT(before, 0.1);
  EXPECT_NEAR(most() / before, 1, 2e-4);
  // Beads that fall on a plate at rest do not form a gas.
  Scene heavy = scene;
  heavy.gravity = -Vec3::UnitZ();
  EXPECT_FALSE(make_plan(heavy).event_driven);
}

TEST(EventDriven, HardCases) {
  // Weak drive: the bed stays on the plate, and all motion is by time steps.
  {
    Gas g(gas("smooth-2d", 0.5, "stepping = \"event-driven\"\n"), true);
    g.periods(30);
    double v = 0, vv = 0;
    for (const Bead& b : g.system.beads) v += b.vz / 40, vv += b.vz * b.vz / 40;
    EXPECT_LT(vv - v * v, 1e-4 * 0.5);
  }
  // A single bead, then one very high above the plate: it follows its parabola.
  {
    Gas g(gas("smooth-2d", 50, "[beads]\ncount = 1\n"), true);
    g.periods(100);
    EXPECT_TRUE(std::isfinite(g.system.beads[0].z));
    EXPECT_GT(g.system.beads[0].z, -1);
    Bead& b = g.system.beads[0];
    b.z = 1e4, b.vz = 0, b.vx = 3;
    const double t_0 = g.system.time(), x_0 = b.x;
    g.periods(100);
    const double t = g.system.time() - t_0;
    ASSERT_LT(0.5 * t * t, 9000);
    EXPECT_NEAR(g.system.beads[0].z, 1e4 - 0.5 * t * t, 1e-9);
    EXPECT_NEAR(g.system.beads[0].x, x_0 + 3 * t, 1e-9);
  }
  // Overdamped contacts do not end without an external force.
  {
    Gas g(gas("smooth-2d", 30, "[contact]\nrestitution = 1e-6\n"), true);
    g.periods(20);
    for (const Bead& b : g.system.beads) EXPECT_TRUE(std::isfinite(b.z) && b.z > -1);
  }
}

TEST(EventDriven, IsRefusedWhereNotExact) {
  const auto flights = [](const std::string& more) { return "[time]\nstepping = \"event-driven\"\n" + more; };
  const std::string paper = "preset = \"fortini-huang-2015\"\n[beads]\ncount = 40\n[drive]\ngamma = 7.0\n";
  EXPECT_TRUE(make_plan(scene_of(paper + flights(""))).event_driven);
  EXPECT_FALSE(make_plan(scene_of(paper)).event_driven) << "springs fly where that is asked for";
  EXPECT_THROW(
      make_plan(scene_of(paper + flights("[contact]\nrolling = \"spring\"\nk_r = 1.0\nmu_r = 0.1\n"))),
      ConfigError);
  EXPECT_THROW(
      make_plan(scene_of(paper + flights("[contact]\nnormal = \"cohesive\"\nsurface_energy = 0.1\n"))),
      ConfigError);
  EXPECT_TRUE(make_plan(scene_of("preset = \"bhateja-2016-smooth-2d\"\n" + flights("[drive]\nk_m = 50.0\n") +
                                 "[contact]\nnormal = \"linear-no-tension\"\n"))
                  .event_driven);
  EXPECT_TRUE(make_plan(scene_of(gas("rough-2d", 50))).event_driven);
  EXPECT_FALSE(make_plan(scene_of(gas("rough-2d", 5))).event_driven);
  EXPECT_FALSE(make_plan(scene_of(gas("rough-2d", 50, "[beads]\ncount = 400\n"))).event_driven);
  EXPECT_FALSE(make_plan(scene_of(gas("rough-2d", 50, "stepping = \"steps\"\n"))).event_driven);
}

}  // namespace
}  // namespace twincell::sim::event_driven_test
