// A run that continues another run from a stored frame, including the springs of its contacts; and drives
// that start at any phase of their cycle.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "core/provenance.hpp"
#include "sim/run/simulation.hpp"
#include "sim/scene/make_plan.hpp"
#include "sim/scene/read_scene.hpp"
#include "tests/support/complaint.hpp"
#include "tests/support/put_file.hpp"
#include "tests/support/temporary_folder.hpp"
#include "trajectory/formats/h5md_file.hpp"

namespace twincell::sim::motion_test {
namespace {

constexpr int kFrom = 41;  // cycle 2, phase 1: the bed rests on the plate and takes off later

std::string cell(const std::string& integrator, double n) {
  return "preset = \"fortini-huang-2015\"\n[beads]\nlayers = 5\n[cell]\nwidth = 8.0\n[start]\nkind = "
         "\"random\"\n"
         "[drive]\ngamma = 1.3\n[time]\n"
         "discard = 0\ncycles = 3\nsprings = true\nintegrator = \"" +
         integrator + "\"\nsteps_per_contact = " + std::to_string(n) + "\n";
}

MemoryTrajectory film(const Scene& scene) {
  Simulation run(scene);
  MemoryTrajectory out(run.trajectory_info());
  run.run(out);
  return out;
}

void save(const MemoryTrajectory& t, const std::filesystem::path& path, bool springs) {
  TrajectoryInfo info = t.info();
  info.columns.contacts = springs;
  H5mdWriter writer(path, info);
  for (Frame frame : t.frames()) {
    if (!springs) frame.contacts.clear(), frame.force.clear(), frame.moment.clear(), frame.rim_speed.clear();
    writer.append(frame);
  }
  writer.finish();
}

/// Largest difference of positions and spins between frames of the same time, over frames 0 to `frames` after
/// the start.
double apart(const MemoryTrajectory& whole, const MemoryTrajectory& rest, std::size_t frames) {
  double largest = 0;
  for (std::size_t f = 0; f <= frames; ++f) {
    const Frame &a = whole.frames().at(kFrom + f), &b = rest.frames().at(f);
    EXPECT_EQ(a.phase, b.phase);
    EXPECT_NEAR(a.plate_height, b.plate_height, 1e-13);
    for (std::size_t i = 0; i < a.position.size(); ++i)
      largest = std::max({largest, (a.position[i] - b.position[i]).norm(), (a.spin[i] - b.spin[i]).norm()});
  }
  return largest;
}

// `simulate --contacts` stores the memory of the contacts, which a start in motion reads, with their forces.
TEST(InMotion, StoredContactsContainTheirMemory) {
  const TemporaryFolder folder;
  std::string text = cell("split", 20);
  text.replace(text.find("springs"), 7, "contacts");
  const MemoryTrajectory whole = film(read_scene_text(text, "whole"));
  EXPECT_TRUE(whole.info().columns.contacts && whole.info().columns.contact_forces);
  save(whole, folder / "whole.h5", true);
  const std::vector<std::string> start = {"start.kind=trajectory",
                                          "start.from=" + (folder / "whole.h5").string(),
                                          "start.frame=" + std::to_string(kFrom), "start.in_motion=true"};
  EXPECT_EQ(apart(whole, film(read_scene_text(text, "rest", start)), 18), 0);  // bit for bit
  const auto stores = [&](const std::vector<std::string>& set) {
    return Simulation(read_scene_text(text, "scene", set)).trajectory_info().columns.contacts;
  };
  EXPECT_FALSE(stores({"time.springs=false"}));
  EXPECT_FALSE(stores({"time.contacts=false"}));
  EXPECT_FALSE(stores({"time.integrator=verlet", "contact.tangential=dashpot"})) << "nothing is remembered";
}

TEST(InMotion, AFrameWithItsSpringsGoesOnAsTheRunDid) {
  for (const auto& [integrator, n] : {std::pair<std::string, double>{"verlet", 30}, {"split", 20}}) {
    const TemporaryFolder folder;
    const std::string text = cell(integrator, n);
    const MemoryTrajectory whole = film(read_scene_text(text, "whole"));
    ASSERT_GT(whole.frames().at(kFrom).contacts.size(), 20U) << "the bed must be in contact";
    save(whole, folder / "with.h5", true);
    save(whole, folder / "without.h5", false);
    ASSERT_TRUE(validate_h5md(folder / "with.h5").empty());
    const auto rest = [&](const char* file) {
      return read_scene_text(text, "rest",
                             {"start.kind=trajectory", "start.from=" + (folder / file).string(),
                              "start.frame=" + std::to_string(kFrom), "start.in_motion=true"});
    };
    Simulation run(rest("with.h5"));
    EXPECT_TRUE(run.warnings().empty());
    MemoryTrajectory with(run.trajectory_info());
    run.run(with);
    ASSERT_EQ(with.frames().size(), 59U);  // the rest of its cycle, and two more cycles
    EXPECT_EQ(with.info().tracer, whole.info().tracer);
    EXPECT_EQ(apart(whole, with, 18), 0) << integrator;  // bit for bit
    Simulation bare(rest("without.h5"));
    ASSERT_EQ(bare.warnings().size(), 1U);
    EXPECT_NE(bare.warnings().front().find("no contact springs"), std::string::npos);
    MemoryTrajectory without(bare.trajectory_info());
    bare.run(without);
    EXPECT_GE(apart(whole, without, 10), 1e-5) << integrator;
  }
}

// Sizes and masses of a file set the step of the run, and the run begins at the step of its drive phase.
TEST(InMotion, BeadsOfATableBeginAtTheStatedPhase) {
  const TemporaryFolder folder;
  std::ofstream(folder / "beads.csv") << "x,z,radius,mass\n2,5,0.5,0.05\n4,5,0.4,0.8\n";
  const Simulation run(read_scene_text(
      "[cell]\nwidth = 6.0\n[contact]\nk_n = 1e5\nrestitution = 0.6\nmu = 0.0\n[drive]\ngamma = 2.0\n"
      "omega = 2.0\nphase = 0.25\n[start]\nkind = \"table\"\nfrom = \"" +
          (folder / "beads.csv").string() +
          "\"\nin_motion = true\n[time]\ndiscard = 0\ncycles = 1\nphases = 40\n",
      "s"));
  EXPECT_GT(run.plan().steps_per_period, make_plan(run.scene()).steps_per_period);
  EXPECT_EQ(4 * run.system().step, run.plan().steps_per_period);
  EXPECT_NEAR(run.system().plate_height(), 0.5, 1e-15);  // A = Gamma/omega^2 at its top
}

TEST(InMotion, UnequalBeadsGoOnAsTheRunDid) {
  const TemporaryFolder folder;
  for (const std::string sizes : {"spread = \"uniform\"\nspread_width = 0.2\n", "mass = 0.7\n"}) {
    const std::string text =
        "[cell]\nwidth = 8.0\n[beads]\ncount = 24\n" + sizes +
        "[contact]\nk_n = 1e5\nrestitution = 0.6\nk_t = 3e4\n[drive]\ngamma = 2.0\nomega = 2.0\n[start]\n"
        "kind = \"random\"\n[time]\ndiscard = 0\ncycles = 4\nphases = 20\nsprings = true\n";
    const MemoryTrajectory whole = film(read_scene_text(text, "whole"));
    save(whole, folder / "whole.h5", true);
    const std::vector<std::string> start = {"start.kind=trajectory",
                                            "start.from=" + (folder / "whole.h5").string(),
                                            "start.frame=" + std::to_string(kFrom), "start.in_motion=true"};
    Simulation run(read_scene_text(text, "rest", start));
    EXPECT_TRUE(run.warnings().empty()) << run.warnings().front();
    MemoryTrajectory rest(run.trajectory_info());
    run.run(rest);
    EXPECT_EQ(apart(whole, rest, 18), 0) << sizes;
    // Other steps go on too, but a note says that they are others.
    std::vector<std::string> finer = start;
    finer.emplace_back("time.steps_per_contact=30");
    const std::vector<std::string> notes = Simulation(read_scene_text(text, "finer", finer)).warnings();
    ASSERT_EQ(notes.size(), 1U);
    EXPECT_NE(notes.front().find("not bit for bit"), std::string::npos) << notes.front();
  }
}

TEST(InMotion, WhatOtherLawsRememberIsRefused) {
  const TemporaryFolder folder;
  save(film(read_scene_text(cell("verlet", 30), "whole")), folder / "verlet.h5", true);
  const auto begin = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all{"start.kind=trajectory", "start.from=" + (folder / "verlet.h5").string(),
                                 "start.frame=" + std::to_string(kFrom), "start.in_motion=true"};
    all.insert(all.end(), more.begin(), more.end());
    Simulation run(read_scene_text(cell("verlet", 30), "rest", all));
  };
  begin({});
  expect_refusal<ConfigError>([&] { begin({"time.integrator=split"}); }, "start.in_motion",
                              "its contacts store 1 values", "select those that wrote the file");
  expect_refusal<ConfigError>([&] { begin({"drive.gamma=1.5"}); }, "has its plate at 0.40",
                              "this drive puts it at 0.46");
  expect_refusal<ConfigError>([&] { begin({"drive.phase=0.5"}); }, "has its plate at 0.40");
  begin({"drive.gamma=1.5", "start.frame=40"});  // phase 0
  expect_refusal<ConfigError>([&] { begin({"start.frame=60"}); }, "frame 60 was requested");
  expect_refusal<ConfigError>([&] { begin({"start.settle_limit=3"}); }, "start.settle_limit",
                              "keeps it moving");
}

// A wall that jumps by 0.03 sigma throws a bed at k_n = 1e6 up to 100 sigma high.
TEST(InMotion, WallsThatWouldJumpAreRefused) {
  const TemporaryFolder folder;
  const auto bed = [](const std::string& drive) {
    return "[cell]\nwidth = 5.0\n[beads]\ncount = 10\n[contact]\nk_n = 1e6\ngamma_n = 100.0\nk_t = "
           "1e4\ngamma_t = "
           "100.0\nmu = 0.6\n[time]\ndiscard = 1\ncycles = 1\nphases = 20\nsprings = "
           "true\n[drive]\namplitude = "
           "0.03\nomega = 5.0\n" +
           drive;
  };
  const auto begin = [&](const std::string& drive, int frame, const std::vector<std::string>& more) {
    std::vector<std::string> all{"start.kind=trajectory",
                                 "start.from=" + (folder / (drive.empty() ? "z.h5" : "x.h5")).string(),
                                 "start.frame=" + std::to_string(frame),
                                 "start.in_motion=true",
                                 "time.discard=0",
                                 "time.cycles=2"};
    all.insert(all.end(), more.begin(), more.end());
    Simulation run(read_scene_text(bed(drive), "rest", all));
  };
  const std::string sideways = "axis = \"x\"\n";
  for (const std::string& drive : {std::string(), sideways}) {
    const Scene scene = read_scene_text(bed(drive), "bed");
    MemoryTrajectory film_of_bed = film(scene);
    TrajectoryInfo info = film_of_bed.info();
    Provenance provenance;
    provenance.config = scene.resolved;
    info.provenance_json = provenance.to_json();
    info.columns.contacts = true;
    H5mdWriter writer(folder / (drive.empty() ? "z.h5" : "x.h5"), info);
    for (const Frame& frame : film_of_bed.frames()) writer.append(frame);
    writer.finish();
  }
  const std::string schedule = "drive.schedule=[[0.0,3.0],[1.0,1.0]]";
  begin("", 5, {});
  begin(sideways, 5, {});
  expect_refusal<ConfigError>([&] { begin("", 5, {schedule}); }, "has its plate at 0.03", "puts it at 0.075");
  expect_refusal<ConfigError>(
      [&] {
        begin("", 15, {"drive.start=ramp", "drive.ramp_cycles=1"});
      },
      "has its plate at -0.03", "puts it at -0.0225");
  expect_refusal<ConfigError>([&] { begin("", 5, {"drive.horizontal.amplitude=0.04"}); },
                              "has the left wall 0 sigma", "begins with it at 0.04");
  expect_refusal<ConfigError>([&] { begin("", 15, {"cell.bottom_motion=rest"}); }, "has its plate at -0.03",
                              "puts it at 0");
  expect_refusal<ConfigError>([&] { begin(sideways, 5, {"cell.side_walls=rest"}); },
                              "has the left wall 0.03 sigma", "begins with it at 0");
  // At phase 0 all of them agree.
  begin("", 0, {schedule});
  begin("", 0, {"cell.bottom_motion=rest"});
  begin(sideways, 0, {"cell.side_walls=rest"});
}

// I d(omega)/dt = R moment, with the angular velocities of the file.
TEST(InMotion, TheMomentsOfAFileTurnItsBeads) {
  const TemporaryFolder folder;
  put_file(folder / "mo.csv", "x,y,z,vx,vy,vz,spin_x,spin,spin_z\n5,5,.6,.7,.4,-.5,.3,-.2,.1\n");
  const MemoryTrajectory t = film(read_scene_text(
      "[cell]\ndimension = 3\nwidth = 20.0\ndepth = 20.0\n[beads]\ncount = 1\n[contact]\nnormal = "
      "\"linear\"\ntangential "
      "= \"dashpot\"\nk_n = 1e4\ngamma_n = 200.0\nc_t = 1.0\nmu = 0.4\n[drive]\namplitude = 0.0\nomega = "
      "3.14159265358979\n[start]\nkind = \"table\"\nfrom = \"" +
          (folder / "mo.csv").string() +
          "\"\nin_motion = true\n[time]\ndiscard = 0\ncycles = 1\nphases = 4000\nsprings = true\nstepping = "
          "\"steps\"\nsteps_per_contact = 200.0\n",
      "moment"));
  const double inertia = 0.1, radius = 0.5;
  const auto moment = [&](std::size_t f) {
    const Vec3& m = t.frames()[f].moment[0];
    return m.allFinite() ? m : Vec3(Vec3::Zero());  // not known before the first step
  };
  Vec3 turned = Vec3::Zero();  // by the torques of all contacts
  for (std::size_t f = 1; f < t.frames().size(); ++f)
    turned +=
        0.5 * (moment(f - 1) + moment(f)) * (t.frames()[f].time - t.frames()[f - 1].time) * radius / inertia;
  const Vec3 change = t.frames().back().spin[0] - t.frames().front().spin[0];
  for (const int axis : {0, 1}) {
    EXPECT_GT(std::abs(change[axis]), 0.05);
    EXPECT_NEAR(turned[axis] / change[axis], 1, 0.02);
  }
}

TEST(DrivePhase, ARunWithoutAFrameIsRefused) {
  const TemporaryFolder folder;
  put_file(folder / "one.csv", "x,z\n2,1\n");
  const auto begin = [&](double phase, int cycles) {
    Simulation run(read_scene_text(
        fmt::format(
            "[cell]\nwidth = 5.0\n[beads]\ncount = 1\n[contact]\nnormal = \"linear\"\ntangential = "
            "\"none\"\n[drive]\namplitude = 0.1\nomega = 1.0\nphase = {}\n[start]\nkind = \"table\"\nfrom "
            "= \"{}\"\nin_motion = true\n[time]\ndiscard = 0\ncycles = {}\nphases = 20\n",
            phase, (folder / "one.csv").string(), cycles),
        "one"));
    MemoryTrajectory out(run.trajectory_info());
    run.run(out);
    return out.frames().size();
  };
  EXPECT_EQ(begin(0.95, 1), 1U);
  EXPECT_EQ(begin(0.97, 2), 20U);
  expect_refusal<ConfigError>([&] { begin(0.97, 1); }, "time.cycles", "records no frame");
}

TEST(DrivePhase, TheDriveBeginsThere) {
  const std::string text =
      "preset = \"fortini-huang-2015\"\n[beads]\nlayers = 3\n[cell]\nwidth = 6.0\n[drive]\ngamma = "
      "0.8\n[time]\n"
      "discard = 0\ncycles = 2\nsteps_per_contact = 20\n";
  const MemoryTrajectory zero = film(read_scene_text(text, "zero")),
                         said = film(read_scene_text(text, "said", {"drive.phase=0"})),
                         quarter = film(read_scene_text(text, "quarter", {"drive.phase=0.25"}));
  ASSERT_EQ(zero.frames().size(), 40U);
  for (std::size_t f = 0; f < 40; ++f)
    for (std::size_t i = 0; i < zero.info().n_beads; ++i)
      ASSERT_EQ(zero.frames()[f].position[i], said.frames()[f].position[i]);
  ASSERT_EQ(quarter.frames().size(), 35U);
  const double amplitude = 0.8;
  for (std::size_t f = 0; f < 35; ++f) {
    const Frame& frame = quarter.frames()[f];
    EXPECT_EQ(frame.phase, static_cast<int>((f + 5) % 20));
    EXPECT_EQ(frame.cycle, static_cast<std::int64_t>((f + 5) / 20));
    EXPECT_NEAR(frame.plate_height,
                amplitude * std::sin(2 * std::numbers::pi * static_cast<double>(f + 5) / 20), 1e-12);
  }
  // At its highest point the plate reverses. The bed starts there at rest, at the height above the plate that
  // the settled bed had.
  for (std::size_t i = 0; i < quarter.info().n_beads; ++i) {
    EXPECT_NEAR(quarter.frames()[0].velocity[i].norm(), 0, 1e-5);
    EXPECT_NEAR(quarter.frames()[0].position[i].z() - amplitude, zero.frames()[0].position[i].z(), 1e-9);
  }
  expect_refusal<ConfigError>([&] { (void)read_scene_text(text, "one", {"drive.phase=1.0"}); }, "drive.phase",
                              "less than 1");
}

}  // namespace
}  // namespace twincell::sim::motion_test
