// Impossible plans and failing runs: each is refused or stopped with one sentence.

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "analysis/observable/observable.hpp"
#include "core/error.hpp"
#include "sim/run/simulation.hpp"
#include "sim/scene/make_plan.hpp"
#include "sim/scene/read_scene.hpp"
#include "tests/support/collision.hpp"
#include "tests/support/complaint.hpp"
#include "tests/support/program.hpp"
#include "tests/support/rigid_bed.hpp"
#include "trajectory/formats/h5md_file.hpp"

namespace twincell::sim::run_test {
namespace {

const std::string kGood = "preset = \"fortini-huang-2015\"\n[beads]\ncount = 50\n[drive]\ngamma = 1.5\n";

TEST(Plan, PaperOneStep) {
  const Plan plan =
      make_plan(read_scene_text(kGood + "[time]\nphases = 1\nsteps_per_contact = 50\n", "scene.toml"));
  EXPECT_EQ(plan.steps_per_period, 141333);
  EXPECT_TRUE(plan.rotation && plan.history);
}

TEST(Run, NoBeadsAndOneBeadRun) {
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

TEST(Run, ErrorNamesStepBeadAndCause) {
  const Scene scene = read_scene_text(
      "preset = \"fortini-huang-2015\"\n[beads]\ncount = 10\n[contact]\nk_n = 1e3\ngamma_n = 1.0\ntangential "
      "= \"none\"\n"
      "[drive]\ngamma = 30.0\n[time]\nsteps_per_contact = 50\ndiscard = 0\ncycles = 40\n",
      "s");
  Simulation run(scene);
  MemoryTrajectory out(run.trajectory_info());
  try {
    run.run(out);
    FAIL() << "a plate that drives soft beads into each other was accepted";
  } catch (const RunError& e) {
    EXPECT_NE(std::string(e.what()).find("step "), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("overlap"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("raise contact.k_n"), std::string::npos) << e.what();
  }
  EXPECT_GT(out.n_frames(), 0U);  // the frames up to that step were delivered
}

TEST(Run, NaNStopsRunInSameStep) {
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
    EXPECT_NE(std::string(e.what()).find("bead 1 has a non-finite position"), std::string::npos) << e.what();
  }
}

TEST(Run, BeadAtTheCeilingIsReported) {
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

TEST(Run, OverlapBoundIsThatOfTheScene) {
  const std::string soft =
      "preset = \"fortini-huang-2015\"\n[beads]\ncount = 20\n[cell]\nwidth = 10.0\n[contact]\nk_n = 1e4\n"
      "[drive]\ngamma = 2.0\n[time]\nsteps_per_contact = 20\ndiscard = 0\ncycles = 2\n";
  const auto run_with = [&](const std::string& bound) {
    Simulation run(read_scene_text(soft, "s", {"contact.overlap_bound=" + bound}));
    MemoryTrajectory out(run.trajectory_info());
    run.run(out);
  };
  EXPECT_NO_THROW(run_with("0.3"));
  expect_refusal<RunError>([&] { run_with("0.005"); }, "overlap by 0.005", "the bound is 0.005");
}

/// A crystal of the first paper, driven for some cycles.
struct Crystal {
  Simulation run;
  MemoryTrajectory out;
  explicit Crystal(const std::vector<std::string>& set)
      : run(read_scene_text("preset = \"fortini-huang-2015\"\n[beads]\ncount = 400\n[time]\n"
                            "steps_per_contact = 20\ndiscard = 0\ncycles = 10\nphases = 1\n",
                            "crystal", set)),
        out(run.trajectory_info()) {
    run.run(out);
  }
  /// Largest change, a whole number of cycles later, of the distance between two beads that touched at the
  /// start and were deeper than 10 sigma.
  [[nodiscard]] double disorder(std::size_t cycle) const {
    const auto &first = out.frames()[0].position, &now = out.frames()[cycle].position;
    double top = 0, worst = 0;
    for (const Vec3& r : first) top = std::max(top, r.z());
    for (std::size_t i = 0; i < first.size(); ++i)
      for (std::size_t j = i + 1; j < first.size(); ++j)
        if (std::max(first[i].z(), first[j].z()) < top - 10 && (first[i] - first[j]).norm() < 1.01)
          worst = std::max(worst, std::abs((now[i] - now[j]).norm() - 1));
    return worst;
  }
};

TEST(Run, CoMovingCrystalHasZeroSlip) {  // region A1 of the first paper, below 10 sigma
  constexpr double kSlip = 0.5;          // sigma between neighbours, from cycle to cycle
  for (const char* gamma : {"0.9", "1.5", "2.2"}) {
    const Crystal bed({std::string("drive.gamma=") + gamma});
    int slips = 0;
    double worst = 0;
    for (std::size_t cycle = 1; cycle < bed.out.n_frames(); ++cycle) {
      worst = std::max(worst, bed.disorder(cycle));
      slips += bed.disorder(cycle) > kSlip;
    }
    std::printf("Gamma = %s: neighbours off their distance by %.2g at most\n", gamma, worst);
    EXPECT_EQ(slips, 0) << gamma;
  }
}

TEST(Run, AbruptStartGivesAWarningAndBreaksTheCrystal) {
  const auto warned = [](const Simulation& run) {
    for (const std::string& w : run.warnings())
      if (w.find("the drive starts abruptly: ") != std::string::npos) return true;
    return false;
  };
  const auto made = [](const std::vector<std::string>& set) {
    return Simulation(read_scene_text(kGood + "[time]\nsteps_per_contact = 20\n", "s", set));
  };
  EXPECT_TRUE(warned(made({"drive.start=abrupt"})));
  EXPECT_TRUE(warned(made({"drive.start=abrupt", "drive.axis=x"})));
  EXPECT_FALSE(warned(made({})));
  EXPECT_FALSE(warned(made({"drive.start=ramp"})));
  EXPECT_FALSE(warned(made({"drive.start=abrupt", "drive.gamma=0.009"})));  // A omega < 0.01
  // A bed that still falls meets the floor at its own speed, which the start of the drive does not cause.
  int blows = 0;
  for (const char* limit : {"3", "4", "5", "6"}) {
    const auto with = [&](const char* gamma) {
      return made({"start.kind=random", std::string("start.settle_limit=") + limit, "cell.width=6",
                   "drive.start=abrupt", std::string("drive.gamma=") + gamma});
    };
    EXPECT_FALSE(warned(with("0"))) << limit;
    blows += warned(with("0.5"));
  }
  EXPECT_GE(blows, 2) << "beads that fall must touch the floor at some of these times";
  const auto disorder = [](const char* start) {
    const Crystal bed({"drive.gamma=1.5", "time.cycles=4", std::string("drive.start=") + start});
    return bed.disorder(3);
  };
  const double comoving = disorder("comoving"), abrupt = disorder("abrupt");
  std::printf("neighbours are off their distance by %.2g co-moving, %.2g kicked\n", comoving, abrupt);
  EXPECT_LT(comoving, 0.2);
  EXPECT_GT(abrupt, 2 * comoving);
}

TEST(Run, SettlingEndsAndReportsTheRemainingEnergy) {
  // Beads without static friction, dropped from a tall column.
  Simulation run(read_scene_text("preset = \"bhateja-2016-rough-2d\"\n[drive]\nk_m = 2.0\n", "s",
                                 {"start.settle_limit=1"}));
  EXPECT_FALSE(run.settled().reached);
  EXPECT_NEAR(run.settled().time, 1, 0.05);
  EXPECT_GT(run.settled().energy_per_bead, 1e-3);
  ASSERT_FALSE(run.warnings().empty());
  EXPECT_NE(run.warnings()[0].find("when start.settle_limit = 1 ended its settling"), std::string::npos);
}

TEST(Run, PeriodTwoIsAveragedOverAnEvenNumberOfCycles) {
  // A rigid bed that is lifted by 1 at phase 5 of every other cycle. The mean lift over two of three cycles
  // is 1/2; over all three it would be 1/3.
  const MemoryTrajectory flat = test::rigid_bed({.gamma = 0.9, .cycles = 3});
  MemoryTrajectory lifted(flat.info());
  for (Frame frame : flat.frames()) {
    if (frame.phase == 5 && frame.cycle % 2 == 1)
      for (Vec3& r : frame.position) r.z() += 1;
    lifted.append(frame);
  }
  const auto results = analysis::analyze(lifted);
  const analysis::Result& s_k = analysis::find_result(results, "s_k");
  EXPECT_EQ(s_k.n, 2U);
  EXPECT_NEAR(s_k.values[5] - s_k.values[4], 0.5, 1e-12);
}

TEST(Run, ShareOfTimeInContactIsReported) {
  // One elastic bead between floor and lid: in each passage of the gap it is in contact for t_c of the wall.
  const auto fraction = [](const char* height, const char* count) {
    Simulation run(read_scene_text(
        "[cell]\ngravity = 0.0\nlid = \"wall\"\nwidth = 4.0\n[contact]\nk_n = 1e4\ntangential = \"none\"\n"
        "[drive]\namplitude = 0.0\nomega = 0.0123\n[start]\nkind = \"random\"\n[time]\ndiscard = 0\ncycles = "
        "1\n"
        "phases = 4000\n",
        "s",
        {std::string("cell.height=") + height, std::string("beads.count=") + count,
         "start.velocity_scale=0.3"}));
    MemoryTrajectory out(run.trajectory_info());
    run.run(out);
    const auto f = run.contact_fraction();
    const Bead& b = run.system().beads.at(0);
    // Fraction of time in contact with each wall, from the passage time gap/|v| and t_c = pi sqrt(m/k_n).
    const double t_c = std::numbers::pi * 1e-2;
    const double along_z = t_c / ((std::stod(height) - 1) / std::abs(b.vz) + t_c),
                 along_x = t_c / (3 / std::abs(b.vx) + t_c);
    return std::pair(f.value(), 1 - (1 - along_z) * (1 - along_x));
  };
  const auto [measured, exact] = fraction("1.1", "1");
  std::printf("in contact %.4f of the time, from t_c and the speeds %.4f\n", measured, exact);
  EXPECT_NEAR(measured, exact, 0.1 * exact);
  EXPECT_LT(fraction("9", "1").first, 0.1 * measured);
}

TEST(Run, ProgramReportsShareOfContactAndStart) {
  const TemporaryFolder folder;
  // Just above Gamma = 1, a bed of the second paper keeps its initial packing for a long time. The output
  // reports each of the two starts.
  for (const char* kind : {"random", "crystal_a"}) {
    std::ofstream(folder / "scene.toml")
        << "preset = \"bhateja-2016-smooth-2d\"\n[drive]\nk_m = 1.1\n[start]\nkind = \"" << kind
        << "\"\nsettle_limit = 1\n[time]\nsteps_per_contact = 10\ndiscard = 0\n"
        << "cycles = 1\n";
    const Ran ran = run_program({"simulate", (folder / "scene.toml").string(), "--json", "--seed", "7", "-o",
                                 (folder / "out.h5").string()});
    ASSERT_EQ(ran.code, 0) << ran.err;
    const auto d = nlohmann::json::parse(ran.out);
    EXPECT_EQ(d["start"]["kind"], kind);
    EXPECT_EQ(d["start"]["seed"], 7);
    EXPECT_EQ(d["start"]["drive"], "comoving");
    EXPECT_GT(d["contact_fraction"].get<double>(), 0);
    EXPECT_LE(d["contact_fraction"].get<double>(), 1);
    EXPECT_EQ(d["warnings"].size(), 2U) << d["warnings"];  // coarse steps, and settling cut short
    EXPECT_NE(ran.err.find("note: time.steps_per_contact = 10 is below 20"), std::string::npos) << ran.err;
  }
}

TEST(Run, FailedRunKeepsItsFrames) {
  const TemporaryFolder folder;
  std::ofstream(folder / "scene.toml")
      << "preset = \"fortini-huang-2015\"\n[beads]\ncount = 50\n[drive]\ngamma = "
         "1000\nstart = \"abrupt\"\n[time]\nsteps_per_contact = 50\ndiscard = 0\ncycles = 1\n";
  const Ran ran =
      run_program({"simulate", (folder / "scene.toml").string(), "-q", "-o", (folder / "x.h5").string()});
  EXPECT_EQ(ran.code, 1);
  EXPECT_NE(ran.err.find("The frames up to that point are in "), std::string::npos) << ran.err;
  EXPECT_EQ(names_in(folder.path()), (std::vector<std::string>{"scene.toml", "x.failed.h5"}));
  const H5mdReader kept(folder / "x.failed.h5");
  ASSERT_GT(kept.n_frames(), 0U);
  Frame frame;
  for (std::size_t f = 0; f < kept.n_frames(); ++f) {
    kept.read(f, frame);
    for (const Vec3& r : frame.position) EXPECT_TRUE(r.allFinite());
    for (const Vec3& v : frame.velocity) EXPECT_TRUE(v.allFinite());
  }
}

// The frames of a failed run replace only those of another failed run: neither a user's file nor a complete
// run that has their name. The reason of the failure is printed in each case.
TEST(Run, AFailedRunReplacesNothingButAFailedRun) {
  const TemporaryFolder folder;
  const auto put_scene = [&](const char* gamma) {
    std::ofstream(folder / "scene.toml")
        << "preset = \"fortini-huang-2015\"\n[beads]\ncount = 50\n[drive]\ngamma = " << gamma
        << "\nstart = \"abrupt\"\n[time]\nsteps_per_contact = 50\ndiscard = "
           "0\ncycles = 1\n";
  };
  const auto run = [&](const char* output) {
    return run_program(
        {"simulate", (folder / "scene.toml").string(), "-q", "-o", (folder / output).string()});
  };
  put_scene("1000");
  std::ofstream(folder / "x.failed.h5") << "mine";
  const Ran beside = run("x.h5");
  EXPECT_EQ(beside.code, 1);
  EXPECT_NE(beside.err.find("overlap"), std::string::npos) << beside.err;
  EXPECT_NE(beside.err.find("x.failed.h5.twincell-1."), std::string::npos) << beside.err;
  EXPECT_GT(H5mdReader(folder / "x.failed.h5.twincell-1").n_frames(), 0U);
  EXPECT_EQ(std::filesystem::file_size(folder / "x.failed.h5"), 4U);

  put_scene("1.5");
  ASSERT_EQ(run("y.failed.h5").code, 0);
  const std::size_t whole = H5mdReader(folder / "y.failed.h5").n_frames();
  put_scene("1000");
  EXPECT_EQ(run("y.h5").code, 1);
  EXPECT_EQ(H5mdReader(folder / "y.failed.h5").n_frames(), whole);
  EXPECT_TRUE(std::filesystem::exists(folder / "y.failed.h5.twincell-1"));

  EXPECT_EQ(run("z.h5").code, 1);
  EXPECT_EQ(run("z.h5").code, 1);
  EXPECT_TRUE(std::filesystem::exists(folder / "z.failed.h5"));
  EXPECT_FALSE(std::filesystem::exists(folder / "z.failed.h5.twincell-1"));
}

}  // namespace
}  // namespace twincell::sim::run_test
