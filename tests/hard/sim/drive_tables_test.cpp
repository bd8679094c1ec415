#include "sim/scene/drive_tables.hpp"

#include <gtest/gtest.h>

#include "sim/scene/make_plan.hpp"
#include "sim/scene/read_scene.hpp"
#include "tests/support/complaint.hpp"

namespace twincell::sim::drive_tables_test {
namespace {

const std::string kBed =
    "[cell]\nwidth = 20.0\n[beads]\ncount = 40\n[time]\ncycles = 10\n[drive]\nomega = 1.0\n";

Scene scene_of(const std::string& drive, const std::vector<std::string>& set = {}) {
  return read_scene_text(kBed + drive, "s.toml", set);
}

TEST(DriveTables, ARampEndsWhereItSays) {
  const Scene s = scene_of("gamma = 1.2\n[drive.ramp]\ngamma = 2.4\n");
  ASSERT_TRUE(s.drive.ramp);
  EXPECT_EQ(s.drive.ramp->to.omega, 1);
  EXPECT_NEAR(s.drive.ramp->to.amplitude, 2.4, 1e-15);
  EXPECT_EQ(s.drive.ramp->first, 10);  // time.discard
  EXPECT_EQ(s.drive.ramp->cycles, 10);
  EXPECT_EQ(s.drive.ramp->power, 2);
  EXPECT_FALSE(conditions_of(s, 40).gamma);
  EXPECT_NEAR(*conditions_of(scene_of("gamma = 1.2\n"), 40).gamma, 1.2, 1e-15);
  // A schedule runs before the ramp.
  EXPECT_EQ(scene_of("gamma = 1.2\nschedule = [[0.0, 2.0], [5.0, 1.0]]\n[drive.ramp]\ngamma = 2.4\n")
                .drive.ramp->first,
            15);
}

// What [drive] states stays, if the ramp states only a frequency.
TEST(DriveTables, TheStatedStrengthStays) {
  const auto end = [](const std::string& drive) {
    const DriveRamp ramp = *scene_of(drive + "[drive.ramp]\nomega = 2.0\n").drive.ramp;
    return std::pair(ramp.to.amplitude, ramp.power);
  };
  EXPECT_EQ(end("amplitude = 1.2\n"), (std::pair{1.2, 0}));
  EXPECT_EQ(end("gamma = 1.2\n"), (std::pair{0.3, 2}));
  EXPECT_EQ(end("peak_velocity = 1.2\n"), (std::pair{0.6, 1}));
  EXPECT_EQ(end("k_m = 1.44\n").second, 1);
  EXPECT_NEAR(end("k_m = 1.44\n").first, 0.6, 1e-15);
}

TEST(DriveTables, LaboratoryUnitsAndAssignments) {
  const Scene s = read_scene_text(
      "[cell]\nwidth_sigma = 20.0\n[beads]\ncount = 40\n[scale]\nsigma_mm = 2.0\ngravity_m_s2 = "
      "9.81\n[drive]\n"
      "amplitude_mm = 1.0\nfrequency_hz = 20.0\n[drive.ramp]\namplitude_mm = 3.0\nfrequency_hz = 10.0\n",
      "s.toml");
  EXPECT_NEAR(s.drive.ramp->to.amplitude, 1.5, 1e-12);
  EXPECT_NEAR(s.drive.ramp->to.omega, s.drive.omega / 2, 1e-12);
  // The resolved text gives the same drive.
  const Scene again = read_scene_text(s.resolved, "again.toml");
  EXPECT_EQ(again.drive.ramp->to, s.drive.ramp->to);
  EXPECT_EQ(again.resolved, s.resolved);
  const Scene set = scene_of("gamma = 1.2\n[drive.ramp]\ngamma = 2.4\n", {"drive.ramp.k_m=4.0"});
  EXPECT_EQ(set.drive.ramp->power, 1);
  EXPECT_EQ(scene_of("gamma = 1.2\n", {"drive.ramp.gamma=3.0"}).drive.ramp->to.amplitude, 3);
}

TEST(DriveTables, WrongRampsAreRefused) {
  const std::pair<const char*, const char*> cases[] = {
      {"gamma = 1.2\n[drive.ramp]\n", "names nothing that changes"},
      {"gamma = 1.2\n[drive.ramp]\ngamma = 1.2\n", "ends with the drive with which it begins"},
      {"gamma = 1.2\n[drive.ramp]\ngamma = 2.0\nk_m = 4.0\n", "both state the strength at the end"},
      {"gamma = 1.2\n[drive.ramp]\nomega = 2.0\nfrequency = 4.0\n", "both state the frequency at the end"},
      {"gamma = 1.2\n[drive.ramp]\nomega = 200.0\n", "changes the frequency by a factor of 200"},
      {"gamma = 1.2\n[drive.ramp]\ngama = 2.0\n", "did you mean"},
      {"gamma = 1.2\n[drive.ramp]\ngamma = -2.0\n", "drive.ramp.gamma"},
      {"gamma = 1.2\namplitude = 1.2\n[drive.ramp]\nomega = 2.0\n", "states more than one of"},
      {"gamma = 1.2\n[drive.ramp]\ngamma = 2.0\nreturn = true\n[until]\nquantity = \"T_z\"\n",
       "contradicts [until]"},
      {"gamma = 1.2\n[drive.horizontal]\namplitude = 0.1\n[drive.ramp]\ngamma = 2.0\n",
       "contradicts drive.ramp"},
  };
  for (const auto& [drive, why] : cases) {
    const std::string said = complaint_of([&] { scene_of(drive); });
    EXPECT_NE(said.find(why), std::string::npos) << drive << said;
    EXPECT_NE(said.find("s.toml:"), std::string::npos) << said;
  }
  EXPECT_NE(complaint_of([] {
              scene_of("gamma = 1.2\n[drive.ramp]\ngamma = 2.0\nreturn = true\n", {"time.cycles=9"});
            }).find("needs an even number of cycles"),
            std::string::npos);
  EXPECT_NE(complaint_of([] {
              scene_of("gamma = 1.2\nphase = 0.25\n[drive.ramp]\nomega = 2.0\n", {"time.discard=0"});
            }).find("set time.discard to at least 1"),
            std::string::npos);
  EXPECT_NE(complaint_of([] {
              make_plan(scene_of("gamma = 1.2\n[drive.ramp]\ngamma = 2.0\n",
                                 {"time.stepping=event-driven", "contact.tangential=none"}));
            }).find("the drive changes during the run"),
            std::string::npos);
}

TEST(DriveTables, WrongHorizontalMotionsAreRefused) {
  const std::pair<const char*, const char*> cases[] = {
      {"gamma = 1.2\n[drive.horizontal]\n", "amplitude: is missing"},
      {"gamma = 1.2\n[drive.horizontal]\namplitude = 0.0\n", "drive.horizontal.amplitude"},
      {"gamma = 1.2\n[drive.horizontal]\namplitude = 0.1\nratio = 1.5\n", "drive.horizontal.ratio"},
      {"gamma = 1.2\n[drive.horizontal]\namplitude = 0.1\nratio = 32\n", "drive.horizontal.ratio"},
      {"gamma = 1.2\n[drive.horizontal]\namplitude = 0.1\nphase = 1.0\n", "must be less than 1"},
      {"gamma = 1.2\naxis = \"x\"\n[drive.horizontal]\namplitude = 0.1\n", "drive.axis is not \"z\""},
  };
  for (const auto& [drive, why] : cases) {
    const std::string said = complaint_of([&] { scene_of(drive); });
    EXPECT_NE(said.find(why), std::string::npos) << drive << said;
  }
  const std::string smooth = "gamma = 1.2\n[drive.horizontal]\namplitude = 0.1\n";
  EXPECT_NE(complaint_of([&] {
              make_plan(scene_of(smooth, {"cell.sides=periodic", "contact.tangential=none"}));
            }).find("moves no bead"),
            std::string::npos);
  EXPECT_EQ(complaint_of([&] { make_plan(scene_of(smooth, {"cell.sides=periodic"})); }), "");
  EXPECT_EQ(complaint_of([&] { make_plan(scene_of(smooth, {"contact.tangential=none"})); }), "");
  EXPECT_NE(complaint_of([&] {
              make_plan(scene_of(smooth, {"time.stepping=event-driven", "contact.tangential=none"}));
            }).find("the plate also moves along x"),
            std::string::npos);
}

}  // namespace
}  // namespace twincell::sim::drive_tables_test
