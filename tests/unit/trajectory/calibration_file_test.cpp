// Calibration files: writing, reading, merging, inclusion; errors are reported with file and line.
#include "trajectory/calibration_file.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "core/atomic_file.hpp"
#include "imaging/cell/cell.hpp"
#include "sim/scene/read_scene.hpp"
#include "sim/scene/scene.hpp"
#include "tests/support/put_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell::calibration_file_test {

namespace {

Measurement number(const std::string& name, double value, double error) {
  return {
      .name = name, .value = {value}, .standard_error = {error}, .method = "by hand", .data = "sha256:00"};
}

Calibration some() {
  Calibration c;
  c.put(number("contact.restitution", 0.91, 0.004));
  c.put(number("drive.amplitude", 1.25, 0.002));
  c.put(number("camera.pixels_per_sigma", 15.5, 0.01));
  c.put({.name = "cell.side_tilt",
         .value = {0.4, -0.2},
         .standard_error = {0.03, 0.02},
         .method = "lines",
         .data = ""});
  c.put(number("camera.frames_per_cycle", 20, 0));
  return c;
}

std::string complaint_of(const std::string& text) {
  const TemporaryFolder folder;
  put_file(folder / "c.toml", text);
  try {
    (void)read_calibration(folder / "c.toml");
  } catch (const ConfigError& e) {
    return std::string(e.what()).substr(folder.path().string().size() + 1);
  }
  return "none";
}

}  // namespace

TEST(CalibrationFile, ReadsWhatItWrote) {
  const TemporaryFolder folder;
  Calibration c = some();
  c.camera = MeasuredCovariance{{"a", "b", "c", "d", "e"}, std::vector<double>(25, 0.5)};
  put_file(folder / "c.toml", calibration_text(c, "made by a test"));
  const Calibration back = read_calibration(folder / "c.toml");
  ASSERT_EQ(back.measured.size(), c.measured.size());
  for (std::size_t i = 0; i < c.measured.size(); ++i) {
    EXPECT_EQ(back.measured[i].name, c.measured[i].name);
    EXPECT_EQ(back.measured[i].value, c.measured[i].value);
    EXPECT_EQ(back.measured[i].standard_error, c.measured[i].standard_error);
    EXPECT_EQ(back.measured[i].method, c.measured[i].method);
  }
  ASSERT_TRUE(back.camera.has_value());
  EXPECT_EQ(back.camera->matrix, c.camera->matrix);
  EXPECT_EQ(back.find("drive.omega"), nullptr);
}

TEST(CalibrationFile, PutReplacesAndKeepsTheOrder) {
  Calibration c = some();
  c.put(number("drive.amplitude", 1.3, 0.1));
  EXPECT_EQ(c.measured.size(), 5U);
  EXPECT_EQ(c.find("drive.amplitude")->value[0], 1.3);
  EXPECT_EQ(c.measured.front().name, "camera.pixels_per_sigma");
  EXPECT_EQ(c.measured.back().name, "contact.restitution");
}

TEST(CalibrationFile, SaysWhatIsWrongAndWhere) {
  EXPECT_EQ(
      complaint_of("[drive.amplitude]\nvalue = \"much\"\n").rfind("c.toml:2:9: drive.amplitude.value", 0),
      0U);
  EXPECT_EQ(complaint_of("[drive.amplitude]\nvalue = 1.0\nstandard_error = -0.1\n").rfind("c.toml:3:18:", 0),
            0U);
  EXPECT_EQ(complaint_of("[drive.amplitud]\nvalue = 1.0\n").rfind("c.toml:1:", 0), 0U);
  EXPECT_NE(complaint_of("[drive.amplitud]\nvalue = 1.0\n").find("drive.amplitude"), std::string::npos);
  EXPECT_NE(complaint_of("[drive.amplitude]\nstandard_error = 0.1\n").find("has no value"),
            std::string::npos);
  EXPECT_NE(complaint_of("[drive.amplitude]\nvalue = 1.0\nunit = \"px\"\n").find("'sigma'"),
            std::string::npos);
  EXPECT_NE(complaint_of("[camera.frames_per_cycle]\nvalue = 20.5\n").find("whole"), std::string::npos);
  EXPECT_NE(complaint_of("[cell.side_tilt]\nvalue = [1.0]\n").find("2 numbers"), std::string::npos);
}

TEST(CalibrationFile, ACovarianceThatCannotBeIsRefused) {
  const auto with = [](std::vector<double> changes) {
    std::vector<double> m(25, 0.0);
    for (std::size_t k = 0; k < 5; ++k) m[6 * k] = 4;
    for (std::size_t k = 0; k + 1 < changes.size(); k += 2)
      m[static_cast<std::size_t>(changes[k])] = changes[k + 1];
    std::string text = "[covariance.camera]\nmatrix = [";
    for (const double x : m) text += std::to_string(x) + ", ";
    return text + "]\n";
  };
  EXPECT_EQ(complaint_of(with({})), "none");
  EXPECT_EQ(complaint_of(with({1, 2, 5, 2})), "none");
  const std::string negative = complaint_of(with({0, -1})), skew = complaint_of(with({1, 2})),
                    large = complaint_of(with({1, 5, 5, 5}));
  EXPECT_NE(negative.find("c.toml:2:"), std::string::npos) << negative;
  EXPECT_NE(negative.find("the variance -1 of pixels_per_sigma"), std::string::npos) << negative;
  EXPECT_NE(skew.find("is not symmetric"), std::string::npos) << skew;
  EXPECT_NE(large.find("the covariance 5 of origin_x_px and pixels_per_sigma"), std::string::npos) << large;
}

TEST(CalibrationFile, ACellTakesWhatItDoesNotState) {
  const TemporaryFolder folder;
  put_file(folder / "c.toml", calibration_text(some(), ""));
  put_file(folder / "CELL.toml",
           "[camera]\norigin_px = [1.0, 2.0]\n[drive]\nomega = 2.0\n[calibration]\nfrom = \"c.toml\"\n");
  const imaging::CellDescription cell = imaging::read_cell(folder / "CELL.toml");
  EXPECT_EQ(cell.pixels_per_sigma, 15.5);
  EXPECT_EQ(cell.phase_lock.frames_per_cycle, 20);
  EXPECT_EQ(cell.drive()->amplitude, 1.25);
  EXPECT_EQ(cell.drive()->omega, 2.0);
  EXPECT_EQ((*cell.side_tilt)[1], -0.2);
  EXPECT_TRUE(cell.included.overridden.empty());

  // Explicit values take precedence and are listed; a complete drive takes nothing from the calibration.
  put_file(folder / "CELL.toml",
           "[camera]\npixels_per_sigma = 12.0\n[drive]\nomega = 2.0\ngamma = 2.0\n[calibration]\nfrom = "
           "\"c.toml\"\n");
  const imaging::CellDescription stated = imaging::read_cell(folder / "CELL.toml");
  EXPECT_EQ(stated.pixels_per_sigma, 12.0);
  EXPECT_EQ(stated.drive()->amplitude, 0.5);
  EXPECT_EQ(stated.included.overridden,
            (std::vector<std::string>{"camera.pixels_per_sigma", "drive.amplitude"}));
}

// The covariance belongs to the four numbers of the camera's map, not to the phases of the frames.
TEST(CalibrationFile, TheCovarianceHoldsUntilANumberOfItsOwnIsReplaced) {
  const TemporaryFolder folder;
  Calibration c = some();
  c.put(
      {.name = "camera.origin_px", .value = {1, 2}, .standard_error = {0.1, 0.1}, .method = {}, .data = {}});
  c.put(number("camera.first_phase", 3, 0));
  c.put(number("camera.phase_offset", 0.25, 0.01));
  c.camera = MeasuredCovariance{{"a", "b", "c", "d", "e"}, std::vector<double>(25, 0.5)};
  put_file(folder / "c.toml", calibration_text(c, ""));
  const auto keeps = [&](const std::string& line) {
    put_file(folder / "CELL.toml", "[camera]\n" + line + "\n[calibration]\nfrom = \"c.toml\"\n");
    return imaging::read_cell(folder / "CELL.toml").included.camera.has_value();
  };
  for (const char* other :
       {"", "phase_offset = 0.1", "frames_per_cycle = 20", "first_phase = 1", "bright = true"})
    EXPECT_TRUE(keeps(other)) << other;
  for (const char* own : {"pixels_per_sigma = 12.0", "origin_px = [5.0, 6.0]", "distortion = 0.001",
                          "rotation_deg = 0.3"})  // the file measures no rotation, but its covariance has one
    EXPECT_FALSE(keeps(own)) << own;
}

TEST(CalibrationFile, ASceneTakesContactsOverItsPreset) {
  const TemporaryFolder folder;
  put_file(folder / "c.toml", calibration_text(some(), ""));
  const std::string scene =
      "preset = \"fortini-huang-2015\"\n[beads]\ncount = 100\n[calibration]\nfrom = \"c.toml\"\n";
  put_file(folder / "scene.toml", scene);
  const sim::Scene s = sim::read_scene(folder / "scene.toml");
  EXPECT_EQ(s.drive.amplitude, 1.25);
  EXPECT_EQ(s.drive.omega, 1);  // from the preset
  EXPECT_EQ(s.left_tilt, 0.4);
  EXPECT_EQ(s.right_tilt, -0.2);
  EXPECT_EQ(s.contact.bead.which_of(sim::normal_damping_keys()), "restitution");
  EXPECT_EQ(s.contact.bead.number("restitution"), 0.91);
  // The scene's own damping takes precedence, whichever key states it.
  put_file(folder / "scene.toml", scene + "[contact]\ngamma_n = 50.0\n");
  EXPECT_EQ(sim::read_scene(folder / "scene.toml").contact.bead.which_of(sim::normal_damping_keys()),
            "gamma_n");
  // The resolved scene is complete without other files.
  const sim::Scene again = sim::read_scene_text(s.resolved, "elsewhere.toml");
  EXPECT_EQ(again.drive.amplitude, 1.25);
}

TEST(CalibrationFile, BoundViolationsNameTheCalibrationFile) {
  const TemporaryFolder folder;
  put_file(folder / "c.toml", "[contact.restitution]\nvalue = 1.2\n");
  put_file(folder / "scene.toml",
           "[beads]\ncount = 4\n[drive]\namplitude = 1.0\nomega = 1.0\n[calibration]\nfrom = "
           "\"c.toml\"\n");
  try {
    (void)sim::read_scene(folder / "scene.toml");
    FAIL() << "a restitution above 1 was taken";
  } catch (const ConfigError& e) {
    EXPECT_NE(std::string(e.what()).find("c.toml:2:9: contact.restitution"), std::string::npos) << e.what();
  }
  put_file(folder / "scene.toml", "[calibration]\nfrom = \"no.toml\"\n");
  try {
    (void)sim::read_scene(folder / "scene.toml");
    FAIL() << "a missing file was taken";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("scene.toml:2:8: calibration.from"), std::string::npos) << e.what();
  }
}

}  // namespace twincell::calibration_file_test
