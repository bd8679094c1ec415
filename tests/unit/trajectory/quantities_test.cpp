// Laboratory units in cells and scenes: the same values as in reduced units, and no unitless value together
// with a scale.
#include <gtest/gtest.h>

#include <array>

#include "core/atomic_file.hpp"
#include "imaging/cell/cell.hpp"
#include "sim/scene/read_scene.hpp"
#include "sim/scene/scene.hpp"
#include "tests/support/complaint.hpp"
#include "tests/support/put_file.hpp"
#include "tests/support/temporary_folder.hpp"
#include "trajectory/unit_keys.hpp"

namespace twincell::quantities_test {

namespace {

imaging::CellDescription cell_of(const std::string& text) {
  const TemporaryFolder folder;
  put_file(folder / "CELL.toml", text);
  return imaging::read_cell(folder / "CELL.toml");
}

std::string complaint_of_cell(const std::string& text) {
  try {
    (void)cell_of(text);
  } catch (const ConfigError& e) {
    EXPECT_EQ(e.exit_code(), ExitCode::usage);
    return e.what();
  }
  return "no complaint";
}

void expect_says(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << text;
}

// Beads of 2 mm, by hand: t0 = 14.2784 ms and v0 = 140.07 mm/s; 8 Hz corresponds to omega = 0.717713.
const std::string kScale = "[scale]\nsigma_mm = 2\ngravity_m_s2 = 9.81\n";

TEST(Quantities, LaboratoryUnitsGiveTheReducedNumbers) {
  const imaging::CellDescription cell = cell_of(
      "[cell]\nwidth_mm = 40\nheight_mm = 80.0\n[drive]\nfrequency_hz = 8\namplitude_mm = 3.2\n" + kScale);
  EXPECT_EQ(cell.scale.sigma_m, 0.002);
  EXPECT_DOUBLE_EQ(*cell.width, 20);
  EXPECT_DOUBLE_EQ(*cell.height, 40);
  EXPECT_DOUBLE_EQ(cell.drive()->amplitude, 1.6);
  EXPECT_NEAR(cell.drive()->omega, 0.717713, 1e-5);
  const imaging::CellDescription speed =
      cell_of("[drive]\npeak_velocity_mm_s = 140.071\nomega_rad_s = 70.0357\n" + kScale);
  EXPECT_NEAR(speed.drive()->peak_velocity(), 1, 1e-5);
  EXPECT_NEAR(speed.drive()->omega, 1, 1e-5);
  const imaging::CellDescription strength =
      cell_of("[drive]\npeak_acceleration_m_s2 = 19.62\nomega_per_t0 = 1.0\n" + kScale);
  EXPECT_NEAR(strength.drive()->gamma(), 2, 1e-12);
  EXPECT_EQ(cell_of("[drive]\npeak_acceleration_g = 2.0\nfrequency_hz = 8.0\n" + kScale).drive_spec.gamma,
            2.0);
}

TEST(Quantities, ABareNumberBesideAScaleIsRefusedWithBothSpellings) {
  const std::string f = complaint_of_cell("[drive]\nfrequency = 8\ngamma = 2.0\n" + kScale);
  expect_says(f, "CELL.toml:2:");
  expect_says(f, "drive.frequency: is 8 without a unit");
  expect_says(f, "drive.frequency_per_t0");
  expect_says(f, "drive.frequency_hz");
  for (const char* key : {"amplitude", "omega", "peak_velocity"}) {
    const std::string said =
        complaint_of_cell("[drive]\n" + std::string(key) + " = 1.0\n[scale]\nsigma_m = 0.002\n");
    expect_says(said, "without a unit");
    expect_says(said, std::string(key) + "_");
  }
  // Without a scale only reduced units are accepted.
  EXPECT_EQ(cell_of("[drive]\namplitude = 1.5\nomega = 1.0\n").drive()->amplitude, 1.5);
}

TEST(Quantities, WhatCannotBeConvertedOrContradictsIsNamed) {
  expect_says(complaint_of_cell("[drive]\namplitude_mm = 1.0\n"),
              "drive.amplitude_mm: is 1 in laboratory units");
  expect_says(complaint_of_cell("[drive]\nfrequency_hz = 8.0\n[scale]\nsigma_mm = 2.0\n"),
              "scale.gravity_m_s2");
  const std::string twice =
      complaint_of_cell("[drive]\namplitude_mm = 3.2\namplitude_sigma = 1.5\n" + kScale);
  expect_says(twice, "drive.amplitude_mm");
  expect_says(twice, "drive.amplitude_sigma");
  expect_says(complaint_of_cell("[scale]\nsigma_mm = 2.0\nsigma_m = 0.001\n"),
              "scale.sigma_m sets the same quantity");
  expect_says(complaint_of_cell("[drive]\nfrequency_hz = -8.0\n" + kScale), "CELL.toml:2:");
  // Refused even where the two agree: if the scale is corrected later, it is undefined which of them should
  // follow.
  expect_says(complaint_of_cell("[drive]\namplitude_mm = 3.2\namplitude_sigma = 1.6\n" + kScale),
              "amplitude_sigma sets the same quantity");
  // Three keys of a drive must agree.
  EXPECT_NO_THROW(
      (void)cell_of("[drive]\namplitude_mm = 4\nomega_per_t0 = 1.0\ngamma = 2.0\n" + kScale).drive());
  EXPECT_THROW((void)cell_of("[drive]\namplitude_mm = 4\nomega_per_t0 = 1.0\ngamma = 2.5\n" + kScale).drive(),
               ConfigError);
}

TEST(Quantities, ABareLengthBesideAScaleIsRefusedWithBothSpellings) {
  for (const char* key : {"width", "height"}) {
    const std::string said = complaint_of_cell("[cell]\n" + std::string(key) + " = 40\n" + kScale);
    expect_says(said, "CELL.toml:2:");
    expect_says(said, "cell." + std::string(key) + ": is 40 without a unit");
    expect_says(said, "cell." + std::string(key) + "_sigma");
    expect_says(said, "cell." + std::string(key) + "_mm");
  }
  EXPECT_EQ(cell_of("[cell]\nwidth = 20\n").width, 20);
}

TEST(Quantities, ACellIsOverlaidInAnySpelling) {
  const TemporaryFolder folder;
  put_file(folder / "CELL.toml", "[cell]\nwidth_mm = 30\n" + kScale);
  const auto width = [&](const std::vector<std::string>& assignments) {
    return imaging::read_cell(folder / "CELL.toml", assignments).width;
  };
  EXPECT_DOUBLE_EQ(*width({"cell.width_mm=40"}), 20);
  EXPECT_DOUBLE_EQ(*width({"cell.width_sigma=20"}), 20);
  expect_refusal<ConfigError>([&] { (void)width({"cell.width=20"}); }, "cell.width_sigma", "cell.width_mm");
  expect_refusal<ConfigError>(
      [&] {
        (void)width({"cell.width_mm=40", "cell.width_sigma=20"});
      },
      "give only one of the two");
  EXPECT_EQ(imaging::read_cell("", {"camera.frame_rate_hz=1000"}).frame_rate_hz, 1000);
  expect_refusal<ConfigError>([&] { (void)imaging::read_cell("", {"camera.frame_rate_hz=0"}); },
                              "camera.frame_rate_hz", "greater than 0");
}

const std::string kBeads = "preset = \"fortini-huang-2015\"\n[beads]\ncount = 100\n";

TEST(Quantities, AScenesUnitsDisplaceItsPresetAndSurviveTheirOwnText) {
  const sim::Scene scene = sim::read_scene_text(
      kBeads + "[cell]\nwidth_mm = 40.0\n[drive]\nfrequency_hz = 8.0\namplitude_mm = 3.2\n" + kScale,
      "s.toml");
  EXPECT_DOUBLE_EQ(scene.width, 20);
  EXPECT_DOUBLE_EQ(scene.drive.amplitude, 1.6);
  EXPECT_NEAR(scene.drive.omega, 0.717713, 1e-5);
  const sim::Scene again = sim::read_scene_text(scene.resolved, "again");
  EXPECT_EQ(again.drive.amplitude, scene.drive.amplitude);
  EXPECT_EQ(again.drive.omega, scene.drive.omega);
  EXPECT_EQ(again.resolved, scene.resolved);
}

const std::string kSlot =
    "preset = \"fortini-huang-2015\"\n[start]\nkind = \"random\"\n[drive]\ngamma = 1.5\n" + kScale;

TEST(Quantities, LengthsOfASceneInMillimetres) {
  const sim::Scene scene = sim::read_scene_text(
      kSlot +
          "[cell]\ndimension = 3\nwidth_mm = 40\ndepth_mm = 3\nheight_mm = 100\n[beads]\ncount = 100\n"
          "diameter_mm = 1.9\n[beads.intruder]\ndiameter_mm = 2.8\nx_mm = 10\ny_mm = 1.5\nz_mm = 4\n",
      "s.toml");
  EXPECT_DOUBLE_EQ(scene.width, 20);
  EXPECT_DOUBLE_EQ(scene.depth, 1.5);
  EXPECT_DOUBLE_EQ(*scene.height, 50);
  EXPECT_DOUBLE_EQ(scene.radius, 0.475);
  EXPECT_DOUBLE_EQ(scene.intruder->radius, 0.7);
  EXPECT_DOUBLE_EQ(scene.intruder->x, 5);
  EXPECT_DOUBLE_EQ(scene.intruder->y, 0.75);
  EXPECT_DOUBLE_EQ(scene.intruder->z, 2);
  const sim::Scene again = sim::read_scene_text(scene.resolved, "again");
  EXPECT_EQ(again.resolved, scene.resolved);
  EXPECT_EQ(again.radius, scene.radius);
  EXPECT_EQ(again.intruder->z, scene.intruder->z);
}

// Who states gravity in m/s^2 may well mean hertz.
TEST(Quantities, ABareFrequencyBesideGravityAloneIsRefused) {
  const std::string gravity = "[scale]\ngravity_m_s2 = 9.81\n";
  for (const auto& [key, reduced, physical] :
       {std::array{"frequency", "frequency_per_t0", "frequency_hz"},
        std::array{"omega", "omega_per_t0", "omega_rad_s"},
        std::array{"peak_velocity", "peak_velocity_v0", "peak_velocity_mm_s"}}) {
    const std::string said =
        complaint_of_cell("[drive]\namplitude = 1\n" + std::string(key) + " = 8\n" + gravity);
    expect_says(said, "drive." + std::string(key) + ": is 8 without a unit although scale.gravity_m_s2");
    expect_says(said, reduced);
    expect_says(said, physical);
  }
  // A length has no laboratory unit there, and what was read can be read again.
  const imaging::CellDescription cell = cell_of("[drive]\namplitude = 1\nomega_per_t0 = 2\n" + gravity);
  EXPECT_EQ(cell.drive()->omega, 2);
  expect_says(cell.text, "omega_per_t0 = 2");
  EXPECT_EQ(cell_of(cell.text).drive()->omega, 2);
}

TEST(Quantities, ABareLengthOfASceneBesideItsScaleIsRefused) {
  struct Case {
    const char *section, *key;
  };
  for (const Case& c :
       {Case{"cell", "width"}, Case{"cell", "height"}, Case{"cell", "depth"}, Case{"beads", "radius"},
        Case{"beads.intruder", "radius"}, Case{"beads.intruder", "x"}, Case{"beads.intruder", "z"}}) {
    const std::string path = std::string(c.section) + "." + c.key;
    expect_refusal<ConfigError>(
        [&] { (void)sim::read_scene_text(kSlot + "[" + c.section + "]\n" + c.key + " = 7\n", "s.toml"); },
        "s.toml:", path + ": is 7 without a unit", path + "_sigma", path + "_mm");
    expect_refusal<ConfigError>([&] { (void)sim::read_scene_text(kSlot, "s.toml", {path + "=7"}); },
                                "--set " + path, path + "_mm");
  }
  // Only one of diameter and radius may be given.
  expect_refusal<ConfigError>(
      [&] { (void)sim::read_scene_text(kSlot + "[beads]\nradius_mm = 1\ndiameter_mm = 2\n", "s.toml"); },
      "beads.diameter_mm", "beads.radius_mm", "give only one of the two");
  expect_refusal<ConfigError>(
      [&] { (void)sim::read_scene_text(kBeads + "[drive]\ngamma = 2\n", "s.toml", {"cell.width_mm=40"}); },
      "cell.width_mm: is 40 in laboratory units", "scale.sigma_mm");
  EXPECT_EQ(sim::read_scene_text(kSlot + "[beads]\ncount = 9\n[cell]\nwidth_mm = 30\n", "s.toml",
                                 {"cell.width_sigma=12"})
                .width,
            12);
}

TEST(Quantities, AnAssignmentDisplacesOtherSpellings) {
  const std::string text = kBeads + "[drive]\nfrequency_hz = 8.0\namplitude_mm = 3.2\n" + kScale;
  const sim::Scene slower =
      sim::read_scene_text(text, "s.toml", {"drive.omega_per_t0=0.5", "drive.amplitude_sigma=1"});
  EXPECT_EQ(slower.drive.omega, 0.5);
  EXPECT_EQ(slower.drive.amplitude, 1);
  const sim::Scene larger = sim::read_scene_text(text, "s.toml", {"scale.sigma_m=0.004"});
  EXPECT_DOUBLE_EQ(larger.drive.amplitude, 0.8);
  EXPECT_THROW((void)sim::read_scene_text(kBeads + "[drive]\nfrequency = 8.0\n" + kScale, "s.toml"),
               ConfigError);
  // An assignment is a user's value like one in the file, wherever the scale is given.
  expect_refusal<ConfigError>([&] { (void)sim::read_scene_text(text, "s.toml", {"drive.frequency=8"}); },
                              "drive.frequency: is 8 without a unit", "frequency_per_t0", "frequency_hz");
  expect_refusal<ConfigError>(
      [&] {
        (void)sim::read_scene_text(kBeads + "[drive]\namplitude = 1.6\nfrequency = 0.1\n", "s.toml",
                                   {"scale.sigma_mm=2", "scale.gravity_m_s2=9.81"});
      },
      "drive.amplitude: is 1.6 without a unit");
}

}  // namespace

}  // namespace twincell::quantities_test
