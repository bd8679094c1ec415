// Plans that cannot be, and runs that go wrong: refused or stopped with one sentence.

#include <gtest/gtest.h>

#include "analysis/trajectory/error.hpp"
#include "analysis/trajectory/h5md_file.hpp"
#include "sim/simulation.hpp"
#include "tests/support/collision.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell::sim {
namespace {

const std::string kGood = "preset = \"fortini-huang-2015\"\n[beads]\ncount = 50\n[drive]\ngamma = 1.5\n";

TEST(Plan, RestitutionOneHasNoDamping) {  // H11
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

TEST(Run, NoBeadsAndOneBeadRun) {  // H21
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

TEST(Run, TwinContinuesFromAnyFrame) {
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
