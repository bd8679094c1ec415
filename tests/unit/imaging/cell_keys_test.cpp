// The tables of the keys of CELL.toml and CAMERA.toml against their readers.
#include "imaging/cell/cell_keys.hpp"

#include "imaging/camera/camera_keys.hpp"
#include "imaging/cell/cell.hpp"
#include "tests/support/complaint.hpp"
#include "tests/support/key_table_checks.hpp"
#include "tests/support/put_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell::imaging::cell_keys_test {
namespace {

const auto kItself = [](const std::string& key) { return key; };

TEST(CellKeys, ExamplesAreReadAndWhatIsOutOfRangeIsRefused) {
  expect_examples_and_ranges(cell_keys());
}

TEST(CellKeys, EveryKeyThatIsReadHasARow) {
  expect_a_row_for_every_query(cell_keys(), kItself);
  expect_a_row_for_every_query_in({"imaging/cell/cell.cpp", "trajectory/drive.cpp"}, cell_keys());
}

TEST(CellKeys, AKeyWithoutARowIsRefused) {
  for (const char* key : {"camera.exposure_s", "cell.depth_mm", "drive.phase", "drive.cutoff_hz",
                          "scale.mass_kg", "beads.radius_sigma"})
    EXPECT_THROW((void)read_cell("", {"scale.sigma_mm=2.0", std::string(key) + "=1.0"}), ConfigError) << key;
}

// What is stated reaches the description, and the printed default changes nothing.
TEST(CellKeys, StatedDefaultsChangeNothing) {
  const auto told = [](const Assignments& assignments) {
    const CellDescription c = read_cell("", assignments);
    const auto tilt = c.side_tilt.value_or(std::array<double, 2>{0, 0});
    return fmt::format("{} {} {} {} {} {} {} {} {} {}", c.rotation_deg, c.distortion,
                       c.phase_lock.frames_per_cycle, c.phase_lock.first_phase, c.phase_lock.offset, c.bright,
                       c.refine.value_or("exact"), static_cast<int>(c.sides), tilt[0], tilt[1]);
  };
  EXPECT_GE(expect_defaults_change_nothing(cell_keys(), told), 8);
}

TEST(CellKeys, DiscsAreAboutAsWideAsTheirBeads) {
  const auto width = [](const char* px) {
    return read_cell("", {"camera.pixels_per_sigma=15.0", std::string("camera.disc_width_px=") + px})
        .disc_px();
  };
  EXPECT_EQ(read_cell("", {"camera.pixels_per_sigma=15.0"}).disc_px(), 15);
  EXPECT_EQ(width("15.2"), 15.2);
  for (const char* far : {"7.4", "30.1"})
    expect_refusal<ConfigError>([&] { (void)width(far); }, "camera.disc_width_px",
                                "between half and twice camera.pixels_per_sigma (15)");
}

TEST(CellKeys, TheErrorOfTheScaleIsThatOfTheStatedScale) {
  const TemporaryFolder folder;
  put_file(folder / "CELL.toml", "[camera]\npixels_per_sigma = 15.0\nscale_error_px = 0.002\n");
  EXPECT_EQ(read_cell(folder / "CELL.toml").scale_error_px, 0.002);
  EXPECT_FALSE(read_cell(folder / "CELL.toml", {"camera.pixels_per_sigma=14"}).scale_error_px);
  EXPECT_FALSE(read_cell("", {"camera.pixels_per_sigma=14"}).scale_error_px);
  expect_refusal<ConfigError>([] { (void)read_cell("", {"camera.scale_error_px=0.1"}); },
                              "is the error of camera.pixels_per_sigma, which is not stated");
}

// The scale of a calibration comes with its error, unless the cell states a scale of its own.
TEST(CellKeys, TheErrorOfTheScaleMayComeFromACalibration) {
  const TemporaryFolder folder;
  Calibration calibration;
  calibration.put({.name = "camera.pixels_per_sigma",
                   .value = {15},
                   .standard_error = {0.003},
                   .method = "by hand",
                   .data = "sha256:00"});
  put_file(folder / "a.calibration.toml", calibration_text(calibration, "test"));
  put_file(folder / "CELL.toml", "[calibration]\nfrom = \"a.calibration.toml\"\n");
  EXPECT_EQ(read_cell(folder / "CELL.toml").scale_error_px, 0.003);
  EXPECT_FALSE(read_cell(folder / "CELL.toml", {"camera.pixels_per_sigma=14"}).scale_error_px);
}

TEST(CellKeys, TheDriveHasItsHarmonics) {
  const Assignments sine = {"drive.gamma=2.0", "drive.omega=1.0"};
  Assignments shaken = sine;
  shaken.emplace_back("drive.harmonics=[[0.1, 0.25], [0.02, 0.0]]");
  EXPECT_TRUE(read_cell("", sine).drive()->harmonics.empty());
  const Drive drive = read_cell("", shaken).drive().value();
  EXPECT_EQ(drive.amplitude, 2);
  EXPECT_EQ(drive.formula(), "A (sin(omega t) + 0.1 sin(2 omega t + 2 pi 0.25) + 0.02 sin(3 omega t))");
}

TEST(CameraKeys, ExamplesAreReadAndWhatIsOutOfRangeIsRefused) {
  expect_examples_and_ranges(camera_keys());
}

TEST(CameraKeys, EveryKeyThatIsReadHasARow) {
  expect_a_row_for_every_query(camera_keys(), kItself);
}

TEST(CameraKeys, EveryDefaultIsAValueThatIsRead) {
  for (const KeyRow& row : camera_keys().rows) (void)context_of_default(camera_keys(), row);
}

}  // namespace
}  // namespace twincell::imaging::cell_keys_test
