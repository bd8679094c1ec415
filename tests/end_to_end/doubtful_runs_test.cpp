// Runs that are not what their user takes them for: other gravity, other walls, another bed, beads beneath
// the plate.
#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/program.hpp"
#include "tests/support/temporary_folder.hpp"
#include "trajectory/formats/h5md_file.hpp"

namespace twincell::doubtful_runs_test {

namespace {

class DoubtfulRuns : public ::testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(folder_ / "scene.toml")
        << "preset = \"fortini-huang-2015\"\n[cell]\nwidth_sigma = 6.0\n[beads]\ncount = 18\n[drive]\ngamma "
           "= "
           "0.75\n"
           "[time]\nsteps_per_contact = 20\ndiscard = 0\ncycles = 2\nphases = 20\n";
  }
  Ran simulate(const std::string& name, const std::vector<std::string>& set) {
    std::vector<std::string> words = {"simulate", folder_ / "scene.toml", "-o", folder_ / name};
    for (const std::string& one : set) words.insert(words.end(), {"--set", one});
    return run_program(words);
  }
  void refused(const std::vector<std::string>& words, const std::string& why) {
    const Ran ran = run_program(words);
    EXPECT_EQ(ran.code, 2) << ran.out;
    EXPECT_NE(ran.err.find(why), std::string::npos) << ran.err;
  }
  const TemporaryFolder folder_;
};

TEST_F(DoubtfulRuns, ASeedThatChangesNothingIsNoted) {
  const std::string said = "the seed has no effect";
  for (const char* verb : {"simulate", "measure"}) {
    const auto run = [&](const std::string& kind, const std::vector<std::string>& seed) {
      std::vector<std::string> words = {
          verb,    folder_ / "scene.toml",        "-o",     folder_ / (verb + kind + ".h5"),
          "--set", "start.kind=\"" + kind + "\"", "--force"};
      words.insert(words.end(), seed.begin(), seed.end());
      const Ran ran = run_program(words);
      EXPECT_EQ(ran.code, 0) << ran.err;
      return ran.err;
    };
    EXPECT_NE(run("crystal_a", {"--seed", "7"}).find(said), std::string::npos) << verb;
    EXPECT_NE(run("crystal_a", {"--set", "start.seed=7"}).find(said), std::string::npos) << verb;
    EXPECT_EQ(run("crystal_a", {}).find(said), std::string::npos) << verb;
    EXPECT_EQ(run("random", {"--seed", "7"}).find(said), std::string::npos) << verb;
  }
}

TEST_F(DoubtfulRuns, OtherGravityOrWallsAreNotPooled) {
  ASSERT_EQ(simulate("a.h5", {}).code, 0);
  ASSERT_EQ(simulate("half.h5", {"cell.gravity=0.5"}).code, 0);
  ASSERT_EQ(simulate("open.h5", {"cell.sides=\"periodic\""}).code, 0);
  // Gamma = A omega^2/g is 0.75 in both, with half the amplitude; K_m = Gamma A is then half as large.
  const Ran info = run_program({"info", folder_ / "half.h5"});
  EXPECT_NE(info.out.find("Gamma = 0.75, K_m = 0.28125"), std::string::npos) << info.out;
  refused({"analyze", folder_ / "a.h5", folder_ / "half.h5", "--only", "s_b"},
          "the gravity is 1 there, 0.5 here");
  refused({"analyze", folder_ / "a.h5", folder_ / "open.h5", "--only", "s_b"},
          "the sides are walls there, periodic here");
  // A ramp: the windows have the Gamma of this gravity too.
  ASSERT_EQ(simulate("ramp.h5", {"cell.gravity=0.5", "drive.ramp.gamma=1.5"}).code, 0);
  const Ran windows = run_program({"analyze", folder_ / "ramp.h5", "--window-cycles", "2", "--only", "s_b"});
  EXPECT_NE(windows.out.find("0.75 to 1.5"), std::string::npos) << windows.out << windows.err;
}

// The default cutoff is in sigma, the beads of this scene are larger: a crystal has no neighbours at all.
TEST_F(DoubtfulRuns, BeadsThatAreNotOfDiameterSigmaNeedAnotherCutoff) {
  ASSERT_EQ(simulate("large.h5", {"beads.diameter_sigma=1.5", "cell.width_sigma=9.0"}).code, 0);
  const Ran with_default = run_program({"analyze", folder_ / "large.h5", "--only", "q6"});
  EXPECT_NE(with_default.err.find("mean diameter of 1.5 sigma"), std::string::npos) << with_default.err;
  EXPECT_NE(with_default.err.find("--cutoff 1.8"), std::string::npos) << with_default.err;
  const Ran with_cutoff = run_program({"analyze", folder_ / "large.h5", "--only", "q6", "--cutoff", "1.8"});
  EXPECT_EQ(with_cutoff.err.find("cutoff"), std::string::npos) << with_cutoff.err;
  ASSERT_EQ(simulate("usual.h5", {}).code, 0);
  const Ran usual = run_program({"analyze", folder_ / "usual.h5", "--only", "q6"});
  EXPECT_EQ(usual.err.find("cutoff"), std::string::npos) << usual.err;
}

// A crystal that rides with its cell: along x its floor does not rise, and a floor at rest does not either.
TEST_F(DoubtfulRuns, AFloorThatDoesNotRiseThrowsNoBed) {
  const std::vector<std::string> gentle = {"drive.gamma=0.05", "drive.omega=0.5", "time.cycles=10"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.end(), gentle.begin(), gentle.end());
    return more;
  };
  ASSERT_EQ(simulate("x.h5", with({"drive.axis=\"x\""})).code, 0);
  ASSERT_EQ(simulate("rest.h5", with({"cell.bottom_motion=\"rest\""})).code, 0);
  ASSERT_EQ(simulate("z.h5", gentle).code, 0);
  for (const char* file : {"x.h5", "rest.h5", "z.h5"}) {
    const Ran ran = run_program({"analyze", folder_ / file, "--only", "s_b,phase", "--json"});
    ASSERT_EQ(ran.code, 0) << ran.err;
    const auto results = nlohmann::json::parse(ran.out).at("results");
    // A/sqrt(2) = 0.14 if the displacement of the drive is taken for a height. Beads that start with the
    // velocity 0.1 of the drive above a floor at rest hop by 0.005.
    EXPECT_NEAR(results.at("s_b").at("value").get<double>(), 0, 0.01) << file;
    EXPECT_NE(results.at("phase").dump().find("co-moving"), std::string::npos) << file;
  }
  refused({"analyze", folder_ / "x.h5", folder_ / "z.h5", "--only", "s_b"},
          "the drive is along x there, z here");
  refused({"render", folder_ / "x.h5", "-o", folder_ / "film"}, "the cell moves along x");
  refused({"render", folder_ / "rest.h5", "-o", folder_ / "film"}, "the plate rests");
  // The frames of a resting floor continue under the same drive.
  std::ofstream(folder_ / "go_on.toml")
      << "preset = \"fortini-huang-2015\"\n[cell]\nwidth_sigma = 6.0\nbottom_motion = "
         "\"rest\"\n[drive]\ngamma "
         "= 0.05\nomega = 0.5\n[start]\nkind = \"trajectory\"\nfrom = \"rest.h5\"\nframe = 5\nin_motion = "
         "true\n[time]\nsteps_per_contact = 20\ndiscard = 0\ncycles = 1\nphases = 20\n";
  EXPECT_EQ(run_program({"simulate", folder_ / "go_on.toml", "-o", folder_ / "on.h5"}).code, 0);
}

// Other seeds of one scene differ; one simulation does not tell by how much.
TEST_F(DoubtfulRuns, ComparisonsSayWhatTheyDoNotKnow) {
  const std::vector<std::string> shaken = {"drive.gamma=1.6", "start.kind=\"random\"", "time.cycles=40"};
  const auto seeded = [&](const std::string& name, const std::string& seed, const std::string& more = "") {
    std::vector<std::string> set = shaken;
    set.push_back("start.seed=" + seed);
    if (!more.empty()) set.push_back(more);
    ASSERT_EQ(simulate(name, set).code, 0);
  };
  seeded("one.h5", "1");
  // Beads without friction, which differ clearly.
  seeded("two.h5", "2", "contact.mu=0"), seeded("three.h5", "3", "contact.mu=0");
  seeded("shape.h5", "4", "drive.harmonics=[[0.1, 0.25]]");
  const auto compared = [&](const std::vector<std::string>& simulations) {
    std::vector<std::string> words = {"compare",          "--experiment", folder_ / "one.h5", "-o",
                                      folder_ / "report", "--no-film",    "--simulation"};
    for (const std::string& name : simulations) words.push_back(folder_ / name);
    const Ran ran = run_program(words);
    EXPECT_EQ(ran.code, 0) << ran.err;
    return ran.out + ran.err;
  };
  const std::string unknown = "contains no scatter between seeds, as there is one simulation of each start";
  const std::string one = compared({"two.h5"}), two = compared({"two.h5", "three.h5"});
  EXPECT_NE(one.find("really differ"), std::string::npos) << one;
  EXPECT_NE(one.find(unknown), std::string::npos) << one;
  EXPECT_EQ(two.find(unknown), std::string::npos) << two;
  const std::string shape = compared({"shape.h5"});
  EXPECT_NE(shape.find("these runs are compared, but their drives have another form."), std::string::npos)
      << shape;
  EXPECT_EQ(one.find("another form"), std::string::npos) << one;
}

TEST_F(DoubtfulRuns, TheBedAtRestIsThatOfTheRun) {
  ASSERT_EQ(simulate("run.h5", {}).code, 0);
  ASSERT_EQ(simulate("rest.h5", {"drive.gamma=0"}).code, 0);
  ASSERT_EQ(simulate("other.h5", {"drive.gamma=0", "beads.count=12"}).code, 0);
  const Ran ran = run_program(
      {"analyze", folder_ / "run.h5", "--only", "delta_h_cm", "--rest-height", folder_ / "rest.h5"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  refused({"analyze", folder_ / "run.h5", "--only", "delta_h_cm", "--rest-height", folder_ / "other.h5"},
          "is the bed of 12 beads in a width of 6");
}

TEST_F(DoubtfulRuns, ImportedBeadsBeneathThePlateAreNoted) {
  ASSERT_EQ(simulate("run.h5", {}).code, 0);
  ASSERT_EQ(run_program({"export", folder_ / "run.h5", "--to", "csv", "-o", folder_ / "run.csv"}).code, 0);
  const auto note = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = {"import",  folder_ / "run.csv", "-o", folder_ / "in.h5",
                                      "--force", "--drive-omega",     "1",  "--frames-per-cycle",
                                      "20"};
    words.insert(words.end(), more.begin(), more.end());
    const Ran ran = run_program(words);
    EXPECT_EQ(ran.code, 0) << ran.err;
    return ran.err;
  };
  const std::string beneath = "of the beads lie beneath the plate";
  EXPECT_EQ(note({"--drive-amplitude", "0.75"}).find(beneath), std::string::npos);
  EXPECT_NE(note({"--drive-amplitude", "0.75", "--y-up"}).find(beneath), std::string::npos);
  EXPECT_NE(note({"--drive-amplitude", "1.5"}).find(beneath), std::string::npos) << "peak to peak";
  EXPECT_NE(note({"--drive-amplitude", "0.75", "--phase-of-step-zero", "0.75"}).find(beneath),
            std::string::npos);
}

TEST_F(DoubtfulRuns, UnitsOfAScaleAreNoted) {
  const Ran si = simulate("si.h5", {"scale.sigma_mm=2", "scale.gravity_m_s2=9.81", "cell.gravity=9.81"});
  EXPECT_NE(si.err.find("cell.gravity = 9.81 is in units of scale.gravity_m_s2: gravity is 96.24 m/s^2"),
            std::string::npos)
      << si.err;
  for (const std::string verb : {"explain", "measure"}) {
    const Ran same = run_program(
        {verb, folder_ / "scene.toml", "--set", "scale.sigma_mm=2", "--set", "scale.gravity_m_s2=981"});
    EXPECT_NE(same.err.find("is it in m/s^2?"), std::string::npos) << verb << ": " << same.err;
  }
  const Ran metre = simulate("metre.h5", {"scale.sigma_m=2", "scale.gravity_m_s2=9.81"});
  EXPECT_NE(metre.err.find("the bead diameter is 2e+03 mm"), std::string::npos) << metre.err;
  EXPECT_EQ(simulate("right.h5", {"scale.sigma_mm=2", "scale.gravity_m_s2=9.81"}).err.find("note"),
            std::string::npos);
}

TEST_F(DoubtfulRuns, ImportOfAFileInMillimetresNeedsGravityInItsUnits) {
  ASSERT_EQ(simulate("run.h5", {"scale.sigma_mm=2", "scale.gravity_m_s2=9.81"}).code, 0);
  ASSERT_EQ(
      run_program({"export", folder_ / "run.h5", "--to", "xyz", "--units", "mm", "-o", folder_ / "mm.xyz"})
          .code,
      0);
  const auto import = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = {"import", folder_ / "mm.xyz", "-o", folder_ / "in.h5", "--force"};
    words.insert(words.end(), more.begin(), more.end());
    return run_program(words);
  };
  const Ran none = import({"--sigma", "2"});
  EXPECT_EQ(none.code, 2);
  EXPECT_NE(none.err.find("--gravity: is missing"), std::string::npos) << none.err;
  const Ran both = import({"--sigma", "2", "--gravity", "9810"});
  EXPECT_EQ(both.code, 0) << both.err;
  H5mdReader in(folder_ / "in.h5"), run(folder_ / "run.h5");
  Frame a, b;
  in.read(3, a), run.read(3, b);
  EXPECT_NEAR(a.time, b.time, 1e-3 * b.time + 1e-9);
  EXPECT_NEAR((a.velocity[5] - b.velocity[5]).norm(), 0, 1e-3);
}

TEST_F(DoubtfulRuns, ImportedVelocitiesOfAnotherDirectionAreNoted) {
  ASSERT_EQ(simulate("run.h5", {}).code, 0);
  H5mdReader run(folder_ / "run.h5");
  const auto note = [&](const std::function<std::array<double, 2>(const Vec3&)>& velocity) {
    std::ofstream table(folder_ / "turned.csv");
    table << "frame,particle,time,x,y,vx,vy\n";
    Frame frame;
    for (std::size_t f = 0; f < run.n_frames(); ++f) {
      run.read(f, frame);
      for (std::size_t i = 0; i < frame.position.size(); ++i) {
        const auto [vx, vy] = velocity(frame.velocity[i]);
        table << f << ',' << i << ',' << frame.time << ',' << frame.position[i].x() << ','
              << frame.position[i].z() << ',' << vx << ',' << vy << '\n';
      }
    }
    table.close();
    return run_program({"import", folder_ / "turned.csv", "-o", folder_ / "in.h5", "--force", "--y-up"}).err;
  };
  const std::string turned = "velocities have another sign", exchanged = "of the velocities are exchanged";
  const std::string right = note([](const Vec3& v) { return std::array{v.x(), v.z()}; });
  EXPECT_EQ(right.find(turned), std::string::npos) << right;
  EXPECT_EQ(right.find(exchanged), std::string::npos) << right;
  EXPECT_NE(note([](const Vec3& v) { return std::array{v.x(), -v.z()}; }).find(turned), std::string::npos);
}

TEST_F(DoubtfulRuns, ComparedFrequenciesThatDifferAreNoted) {
  ASSERT_EQ(simulate("slow.h5", {}).code, 0);
  ASSERT_EQ(simulate("fast.h5", {"drive.omega=2.0"}).code, 0);
  const Ran ran = run_program({"compare", "--experiment", folder_ / "slow.h5", "--simulation",
                               folder_ / "fast.h5", "-o", folder_ / "report"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  // K_m = Gamma^2 g^2/(omega^2 sigma g)
  EXPECT_NE(ran.err.find("K_m is 0.5625 in slow.h5 and 0.1406 in fast.h5"), std::string::npos) << ran.err;
}

TEST_F(DoubtfulRuns, FilmsOfOneCellWithOtherNumbersOfBeadsAreNoted) {
  ASSERT_EQ(simulate("all.h5", {"start.kind=random", "beads.count=30", "start.seed=2"}).code, 0);
  ASSERT_EQ(simulate("missed.h5", {"start.kind=random", "beads.count=29"}).code, 0);
  ASSERT_EQ(simulate("other.h5", {"start.kind=random", "beads.count=20"}).code, 0);
  ASSERT_EQ(simulate("twin.h5", {"start.kind=random", "beads.count=30", "start.seed=3"}).code, 0);
  const auto said = [&](const std::string& second) {
    const Ran ran = run_program({"compare", "--experiment", folder_ / "all.h5", folder_ / second,
                                 "--simulation", folder_ / "twin.h5", "-o", folder_ / ("report-" + second)});
    EXPECT_EQ(ran.code, 0) << ran.err;
    return ran.err;
  };
  EXPECT_NE(said("missed.h5").find("shows 29 beads in its first frame and"), std::string::npos);
  EXPECT_EQ(said("other.h5").find("in its first frame"), std::string::npos);
}

TEST_F(DoubtfulRuns, TheOriginOfImportedBeadsMayBeStated) {
  ASSERT_EQ(simulate("run.h5", {}).code, 0);
  ASSERT_EQ(run_program({"export", folder_ / "run.h5", "--to", "xyz", "-o", folder_ / "run.xyz"}).code, 0);
  const auto source = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = {"import",          folder_ / "run.xyz", "-o",
                                      folder_ / "in.h5", "--force",           "--json"};
    words.insert(words.end(), more.begin(), more.end());
    const Ran ran = run_program(words);
    EXPECT_EQ(ran.code, 0) << ran.err;
    EXPECT_EQ(word_of(H5mdReader(folder_ / "in.h5").info().source), nlohmann::json::parse(ran.out)["source"]);
    return nlohmann::json::parse(ran.out)["source"].get<std::string>();
  };
  EXPECT_EQ(source({}), "simulation");
  EXPECT_EQ(source({"--source", "experiment"}), "experiment");
}

TEST_F(DoubtfulRuns, ImportedVelocitiesRadiiAndJumpsThatContradictThePositionsAreNoted) {
  // Four beads, side by side, move along x with unit velocity.
  const auto note = [&](double velocity, double radius, double jump) {
    std::ofstream table(folder_ / "beads.csv");
    table << "frame,particle,time,x,y,vx,vy,radius\n";
    for (int f = 0; f < 6; ++f)
      for (int i = 0; i < 4; ++i)
        table << f << ',' << i << ',' << 0.1 * f << ',' << 1 + i + 0.1 * f + (f == 3 && i == 2 ? jump : 0)
              << ",1," << velocity << ",0," << radius << '\n';
    table.close();
    const Ran ran =
        run_program({"import", folder_ / "beads.csv", "-o", folder_ / "in.h5", "--force", "--y-up"});
    EXPECT_EQ(ran.code, 0) << ran.err;
    return ran.err;
  };
  const std::string far = "times as far as their velocities say", wide = "the radii may be diameters",
                    jump = "moves by 1000 bead diameters between the frames",
                    twice =
                        "1 bead, the first in the frame of step 3, lies closer than 0.3 diameters to another";
  for (const std::string& said : {far, wide, jump, twice})
    EXPECT_EQ(note(1, 0.5, 0).find(said), std::string::npos) << said;
  EXPECT_NE(note(1, 0.5, -0.9).find(twice), std::string::npos);
  EXPECT_NE(note(0.001, 0.5, 0).find("move 1e+03 " + far), std::string::npos);
  EXPECT_NE(note(1, 1, 0).find(wide), std::string::npos);
  EXPECT_NE(note(1, 0.5, 1000).find(jump), std::string::npos);
}

}  // namespace

}  // namespace twincell::doubtful_runs_test
