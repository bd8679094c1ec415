// Scenes and starts that cannot be, and runs that go wrong: refused or stopped with one sentence.

#include <gtest/gtest.h>

#include "analysis/trajectory/error.hpp"
#include "analysis/trajectory/h5md_file.hpp"
#include "sim/simulation.hpp"
#include "tests/support/collision.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell::sim {
namespace {

const std::string kGood = "preset = \"fortini-huang-2015\"\n[beads]\ncount = 50\n[drive]\ngamma = 1.5\n";

std::string complaint(const std::string& text, const std::vector<std::string>& set = {}) {
  try {
    read_scene_text(text, "scene.toml", set);
  } catch (const ConfigError& e) {
    return e.what();
  }
  return "accepted";
}

void expect_complaint(const std::string& text, const std::string& wanted) {
  const std::string said = complaint(text);
  EXPECT_NE(said.find(wanted), std::string::npos) << "wanted: " << wanted << "\nsaid:   " << said;
}

TEST(Scene, GoodOnesPass) {
  EXPECT_EQ(complaint(kGood), "accepted");
  EXPECT_EQ(complaint("preset = \"bhateja-2016-rough-2d\"\n[drive]\nk_m = 5.0\n"), "accepted");
  const Scene s = read_scene_text(kGood, "scene.toml", {"drive.gamma=1.8", "start.kind=random"});
  EXPECT_DOUBLE_EQ(s.drive.gamma(), 1.8);
  EXPECT_EQ(s.start, StartKind::random);
}

TEST(Scene, ComplaintsNameLineKeyValueAndBound) {
  expect_complaint(kGood + "[contact]\nmu = -0.1\n",
                   "scene.toml:7:6: contact.mu: -0.1 is out of range; the value must be at least 0");
  expect_complaint(kGood + "[contact]\nmuu = 0.1\n",
                   "scene.toml:7:7: contact.muu: there is no such key; did you mean 'contact.mu'?");
  expect_complaint(kGood + "[contact]\nk_n = \"stiff\"\n",
                   "scene.toml:7:7: contact.k_n: a number is needed, not a string.");
  expect_complaint(kGood + "[contact]\nk_n = nan\n", "contact.k_n: a finite number is needed");
  expect_complaint(
      kGood + "[contact]\nrestitution = 1.1\n",
      "contact.restitution: 1.1 is out of range; the value must be greater than 0 and at most 1.");
  expect_complaint(kGood + "[contact]\nrestitution = 0.0\n",
                   "contact.restitution: 0 is out of range");  // H11: infinite damping
  expect_complaint(kGood + "[contact]\nc_n = 5.0\nrestitution = 0.9\n", "contradicts 'c_n'");
  expect_complaint(kGood + "[cell]\nwidth = 0.9\n", "does not fit into a cell 0.9 wide");
  expect_complaint(kGood + "[time]\nsteps_per_contact = 2\n",
                   "time.steps_per_contact: 2 is out of range; the value must be at least 8");
  expect_complaint(kGood + "[time]\ncycles = 1.5\n", "time.cycles: a whole number is needed");
  expect_complaint(kGood + "[start]\nkind = \"pile\"\n",
                   "'pile' is not one of crystal_a, crystal_b, random, trajectory");
  expect_complaint(kGood + "[start]\nkind = \"trajectory\"\n",
                   "start.from: a start from a trajectory needs the name of its file");
  expect_complaint("preset = \"fortini\"\n", "'fortini' is not one of fortini-huang-2015");
  expect_complaint("[drive]\nomega = 1.0\ngamma = 1.0\n", "beads.count: the number of beads is missing");
  expect_complaint(
      kGood + "amplitude = 9.0\n",
      "scene.toml:4:1: drive: gamma = 1.5 contradicts the other numbers, from which it would be 9");
  expect_complaint("[beads]\ncount = 1\n[drive]\ngama = 1.0\n",
                   "scene.toml:4:8: drive.gama: there is no such key; did you mean 'drive.gamma'?");
  expect_complaint("[beads]\ncount = 1\n[drive]\ngamma = 1.0\n",
                   "scene.toml:3:1: drive: two of amplitude, omega,");
  expect_complaint(kGood + "[cell]\ndimension = 3\n", "a 3D cell needs its depth");
}

TEST(Scene, RestitutionOneHasNoDamping) {  // H11
  const Plan plan = make_plan(read_scene_text(kGood + "[contact]\nrestitution = 1.0\n", "scene.toml"));
  EXPECT_EQ(std::get<LinearSpringDashpot>(plan.bead.normal).damping.eta(0.5), 0);
}

TEST(Plan, PaperOneStep) {
  const Plan plan = make_plan(read_scene_text(kGood + "[time]\nphases = 1\n", "scene.toml"));
  EXPECT_EQ(plan.steps_per_period, 141333);
  EXPECT_TRUE(plan.rotation && plan.history);
}

TEST(Plan, StepFollowsTheStiffestRate) {  // H7: a tangential dashpot that is faster than the contact
  const double usual = make_plan(read_scene_text(kGood, "s")).dt;
  const double fast = make_plan(read_scene_text(kGood + "[contact]\ngamma_t = 1e5\n", "s")).dt;
  EXPECT_LT(fast, usual / 10);
}

TEST(Plan, AbsurdScenesAreRefusedAtOnce) {  // H18
  auto refusal = [](const std::vector<std::string>& set) {
    try {
      make_plan(read_scene_text(kGood, "scene.toml", set));
    } catch (const ConfigError& e) {
      return std::string(e.what());
    }
    return std::string("accepted");
  };
  EXPECT_NE(refusal({"drive.omega=1e-9"}).find("scene.toml: drive: a cycle of 6.28e+09 t0 takes"),
            std::string::npos);
  EXPECT_NE(refusal({"drive.gamma=1e5"}).find("the plate moves 4.45 sigma in one step"), std::string::npos);
}

TEST(Start, NoBeadsAndOneBeadRun) {  // H21
  for (const char* count : {"0", "1"}) {
    const Scene scene = read_scene_text(
        "preset = \"fortini-huang-2015\"\n[beads]\ncount = " + std::string(count) +
            "\n[drive]\ngamma = 1.5\n[time]\nsteps_per_contact = 8\ndiscard = 0\ncycles = 1\n",
        "s");
    Simulation run(scene);
    MemoryTrajectory out(run.trajectory_info());
    run.run(out);
    EXPECT_EQ(out.n_frames(), 20U);
  }
}

TEST(Start, CrystalRowsOfPaperOne) {  // 20 and 19 beads alternately; 800 ends in a full row
  const auto beads =
      crystal_a(read_scene_text(
                    "preset = \"fortini-huang-2015\"\n[beads]\ncount = 800\n[drive]\ngamma = 1.0\n", "s"))
          .beads;
  ASSERT_EQ(beads.size(), 800U);
  EXPECT_EQ(std::count_if(beads.begin(), beads.end(), [](const Bead& b) { return b.z < 0.6; }), 20);
  EXPECT_EQ(std::count_if(beads.begin(), beads.end(), [](const Bead& b) { return b.z > 0.6 && b.z < 1.5; }),
            19);
  const double top =
      std::max_element(beads.begin(), beads.end(), [](const Bead& a, const Bead& b) { return a.z < b.z; })->z;
  EXPECT_EQ(std::count_if(beads.begin(), beads.end(), [&](const Bead& b) { return b.z > top - 0.1; }), 20);
}

TEST(Start, ImpossibleTrajectoriesAreRefused) {  // H1, H5
  const TemporaryFolder folder;
  auto scene_from = [&](const std::vector<Vec3>& positions) {
    TrajectoryInfo info;
    info.n_beads = positions.size();
    info.box.upper = Vec3(8, 1, 20);
    H5mdWriter writer(folder / "start.h5", info);
    Frame frame;
    frame.position = positions;
    writer.append(frame);
    writer.finish();
    return read_scene_text(
        "preset = \"fortini-huang-2015\"\n[cell]\nwidth = 8.0\n[drive]\ngamma = 1.5\n[start]\nkind = "
        "\"trajectory\"\nfrom = \"" +
            (folder / "start.h5").string() + "\"\n",
        "scene.toml");
  };
  EXPECT_THROW(make_start(scene_from({Vec3(2, 0, 0.5), Vec3(2, 0, 0.5)})), ConfigError);  // centres coincide
  EXPECT_THROW(make_start(scene_from({Vec3(2, 0, 0.5), Vec3(2.5, 0, 0.5)})), ConfigError);  // overlap 0.5
  EXPECT_THROW(make_start(scene_from({Vec3(9, 0, 0.5)})), ConfigError);                     // outside
  // A camera's noise is pushed apart, not refused, and nothing flies off.
  const Start start = make_start(scene_from({Vec3(2, 0, 0.49), Vec3(2.96, 0, 0.5), Vec3(3.9, 0, 0.52)}));
  EXPECT_GE(start.beads[1].x - start.beads[0].x, 1 - 1e-3);
  EXPECT_GE(start.beads[0].z, 0.5 - 1e-3);
}

TEST(Start, TwinContinuesFromAnyFrame) {
  const TemporaryFolder folder;
  const std::string small =
      "preset = \"fortini-huang-2015\"\n[cell]\nwidth = 8.0\n[drive]\ngamma = 1.5\n[time]\nsteps_per_contact "
      "= 10\ndiscard = 0\ncycles = 1\n";
  Simulation first(
      read_scene_text(small + "[beads]\ncount = 30\n[start]\nkind = \"random\"\nseed = 3\n", "s"));
  {
    H5mdWriter writer(folder / "first.h5", first.trajectory_info());
    first.run(writer);
    writer.finish();
  }
  const Simulation twin(read_scene_text(small + "[start]\nkind = \"trajectory\"\nframe = 7\nfrom = \"" +
                                            (folder / "first.h5").string() + "\"\n",
                                        "s"));
  EXPECT_EQ(twin.system().beads.size(), 30U);
  EXPECT_EQ(twin.trajectory_info().tracer, first.trajectory_info().tracer);
  EXPECT_TRUE(twin.settled().reached);
}

TEST(Run, StopsWithStepBeadAndCause) {  // H18, H20
  const Scene scene = read_scene_text(
      "preset = \"fortini-huang-2015\"\n[beads]\ncount = 10\n[contact]\nk_n = 1e3\ngamma_n = 1.0\ntangential "
      "= \"none\"\n"
      "[drive]\ngamma = 30.0\n[time]\ndiscard = 0\ncycles = 40\n",
      "s");
  Simulation run(scene);
  MemoryTrajectory out(run.trajectory_info());
  try {
    run.run(out);
    FAIL() << "a plate that drives soft beads into each other was accepted";
  } catch (const RunError& e) {
    EXPECT_NE(std::string(e.what()).find("step "), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("overlap"), std::string::npos) << e.what();
  }
  EXPECT_GT(out.n_frames(), 0U);  // the frames up to there were handed over
}

TEST(Run, ANumberThatIsNoneIsFoundInItsStep) {
  Bench b("[cell]\ngravity = 1.0\n");
  b.add(5, 3, 0, 0);
  b.add(9, 3, 0, 0);
  b.kernel->advance(b.system, 100);
  b.system.beads[1].vx = std::nan("");
  try {
    b.kernel->advance(b.system, 100000);
    FAIL() << "a speed that is not a number was accepted";
  } catch (const RunError& e) {
    EXPECT_NE(std::string(e.what()).find("step 100, "), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("bead 1 is no longer at a finite position"), std::string::npos)
        << e.what();
  }
}

TEST(Run, ABeadAtTheLidSaysSo) {
  const Scene scene = read_scene_text(
      "preset = \"fortini-huang-2015\"\n[beads]\ncount = 20\n[cell]\nheight = 2.0\n[drive]\ngamma = 4.0\n"
      "[time]\nsteps_per_contact = 10\ndiscard = 0\ncycles = 2\n",
      "s");
  Simulation run(scene);
  MemoryTrajectory out(run.trajectory_info());
  try {
    run.run(out);
    FAIL() << "the lid did not act and nothing was said";
  } catch (const RunError& e) {
    EXPECT_NE(std::string(e.what()).find("lid"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace twincell::sim
