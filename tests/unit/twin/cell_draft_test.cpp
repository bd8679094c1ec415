// Drafts of cell files from surveys with known numbers.
#include "twin/cell_draft.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/error.hpp"
#include "imaging/cell/cell.hpp"
#include "tests/support/complaint.hpp"
#include "tests/support/put_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell::twin::cell_draft_test {
namespace {

/// 12 px per bead, walls 120 px apart, plate at row 200 with A = 18 px, 20 frames per cycle.
CellSurvey survey() {
  CellSurvey s{.stack = "frames", .size = {160, 240}, .n_frames = 60};
  s.beads = calibration::SizeStatistics{.frames = 12, .sizes = 900, .diameter = {12, 0.006}};
  calibration::CellGeometry g{.size = s.size, .has_plate = true, .has_left = true, .has_right = true};
  g.fit.names = {"x_left", "tilt_left", "x_right", "tilt_right", "rotation"};
  g.fit.values = {20, 0, 140, 0, 0};
  g.fit.standard_errors = {0.002, 0.001, 0.002, 0.001, 0.001};
  g.fit.covariance = Eigen::MatrixXd::Zero(5, 5);
  for (int i = 0; i < 5; ++i)
    g.fit.covariance(i, i) = std::pow(g.fit.standard_errors[static_cast<std::size_t>(i)], 2);
  g.plate_row = 200;
  g.heights.assign(60, {});
  s.geometry = g;
  calibration::DriveFit d;
  d.amplitude = 18;
  d.amplitude_error = 0.004;
  d.period = 20;
  d.period_error = 0.001;
  d.frames_per_cycle = 20;
  d.first_phase = 3;
  d.phase_offset_error = 0.01;
  s.drive = d;
  s.plate_row = calibration::Estimate{200, 0.004};
  return s;
}

const DraftKey& key(const CellDraft& draft, const std::string& name) {
  const DraftKey* k = draft.find(name);
  EXPECT_NE(k, nullptr) << name;
  static const DraftKey none;
  return k != nullptr ? *k : none;
}

imaging::CellDescription read(const CellDraft& draft, const CellSurvey& s) {
  const TemporaryFolder folder;
  put_file(folder / "CELL.toml", cell_text(draft, s, "# test"));
  return imaging::read_cell(folder / "CELL.toml");
}

TEST(CellDraft, AWallIsTiltedOnlyIfItMatters) {
  CellSurvey s = survey();
  const CellAnswers answers{.sigma_mm = 2, .frequency_hz = 20};
  s.geometry->fit.values[1] = 0.08;  // 80 standard errors
  EXPECT_EQ(draft_cell(s, answers).find("cell.side_tilt"), nullptr);
  s.geometry->fit.values[1] = 0.3;
  EXPECT_NE(draft_cell(s, answers).find("cell.side_tilt"), nullptr);
}

TEST(CellDraft, TheScaleHasItsErrorAsAKey) {
  CellSurvey s = survey();
  const CellAnswers answers{.sigma_mm = 2, .frequency_hz = 20};
  EXPECT_EQ(read(draft_cell(s, answers), s).scale_error_px, 0.006);
  s.diameter_stated = true;
  s.beads->diameter.error = 0;
  EXPECT_EQ(draft_cell(s, answers).find("camera.scale_error_px"), nullptr);
}

TEST(CellDraft, AClearSecondHarmonicIsPartOfTheDrive) {
  CellSurvey s = survey();
  const CellAnswers answers{.sigma_mm = 2, .frequency_hz = 20};
  s.drive->second_harmonic = 0.005;
  s.drive->second_harmonic_error = 0.0002;
  s.drive->second_harmonic_phase = 0.25;
  EXPECT_EQ(draft_cell(s, answers).find("drive.harmonics"), nullptr) << "too small to matter";
  s.drive->second_harmonic = 0.2;
  s.drive->second_harmonic_error = 0.05;
  EXPECT_EQ(draft_cell(s, answers).find("drive.harmonics"), nullptr) << "not clear";
  s.drive->second_harmonic_error = 0.001;
  const imaging::CellDescription cell = read(draft_cell(s, answers), s);
  ASSERT_EQ(cell.harmonics.size(), 1U);
  EXPECT_NEAR(cell.harmonics[0].amplitude, 0.2, 1e-6);
  EXPECT_NEAR(cell.harmonics[0].phase, 0.25, 1e-6);
}

// Beads that are no plain discs look as large as the light makes them; where they touch they are one diameter
// apart.
TEST(CellDraft, TheScaleOfShadedBeadsIsTheDistanceOfTouchingOnes) {
  CellSurvey s = survey();
  s.beads->spacing = calibration::Estimate{12.01, 0.01};
  EXPECT_EQ(key(draft_cell(s, {}), "camera.pixels_per_sigma").value, "12.0000");
  EXPECT_TRUE(draft_cell(s, {}).notes.empty());
  s.beads->spacing = calibration::Estimate{12.8, 0.01};
  const CellDraft wide = draft_cell(s, {});
  EXPECT_EQ(key(wide, "camera.pixels_per_sigma").value, "12.800");
  EXPECT_EQ(key(wide, "camera.disc_width_px").value, "12.0000");
  EXPECT_EQ(draft_cell(survey(), {}).find("camera.disc_width_px"), nullptr);
  ASSERT_EQ(wide.notes.size(), 1U);
  EXPECT_NE(wide.notes[0].find("discs are 12.0000 +- 0.006 px wide, and touching ones 12.800"),
            std::string::npos)
      << wide.notes[0];
  EXPECT_EQ(draft_cell(s, {}).find("camera.refine"), nullptr);
  s.refine = "profile";
  EXPECT_EQ(read(draft_cell(s, {.gamma = 2}), s).refine, "profile");
  const CellDraft draft = draft_cell(s, {});
  EXPECT_EQ(key(draft, "camera.pixels_per_sigma").value, "12.800");
  EXPECT_NE(key(draft, "camera.pixels_per_sigma").comment.find("touching beads"), std::string::npos);
  EXPECT_EQ(key(draft, "cell.width_sigma").value, "9.3750");
  s.beads->spacing = calibration::Estimate{12.8, 0.03};  // too uncertain
  EXPECT_EQ(key(draft_cell(s, {}), "camera.pixels_per_sigma").value, "12.0000");
  s.beads->spacing.reset();
  EXPECT_EQ(key(draft_cell(s, {}), "camera.pixels_per_sigma").value, "12.0000");
  s.diameter_px = 12.5;
  s.diameter_stated = true;
  EXPECT_EQ(key(draft_cell(s, {}), "camera.pixels_per_sigma").value, "12.5");
}

TEST(CellDraft, ErrorsHaveTwoDigitsAndValuesAsManyDecimals) {
  EXPECT_EQ(value_text({12.34567, 0.0021}), "12.3457");
  EXPECT_EQ(value_text({12.34567, 0.21}), "12.35");
  EXPECT_EQ(value_text({1234.5, 30}), "1234");
  EXPECT_EQ(value_text({2, 0}), "2");
  EXPECT_EQ(error_text(0.0021), "0.0021");
  EXPECT_EQ(error_text(std::nan("")), "unknown");
}

// Gamma = A omega^2/g with A = 1.5 sigma of 2 mm and 20 Hz: 0.003 (40 pi)^2 / 9.81 = 4.829.
TEST(CellDraft, AFrequencyAndADiameterGiveGammaWithItsError) {
  const CellSurvey s = survey();
  const CellDraft draft = draft_cell(s, {.sigma_mm = 2, .frequency_hz = 20});
  const double gamma = 0.003 * std::pow(40 * std::numbers::pi, 2) / 9.81;
  ASSERT_TRUE(draft.gamma);
  EXPECT_NEAR(draft.gamma->value, gamma, 1e-9);
  // Relative errors: 0.004/18 of the plate and 0.006/12 of the scale.
  EXPECT_NEAR(draft.gamma->error / gamma, std::hypot(0.004 / 18, 0.006 / 12), 1e-9);
  const imaging::CellDescription cell = read(draft, s);
  EXPECT_NEAR(cell.drive()->gamma(), gamma, 1e-3 * gamma);
  EXPECT_DOUBLE_EQ(*cell.pixels_per_sigma, 12);
  EXPECT_DOUBLE_EQ(*cell.width, 10);
  EXPECT_DOUBLE_EQ(cell.origin->x_px, 20);
  EXPECT_DOUBLE_EQ(cell.origin->y_px, 200);
  EXPECT_EQ(cell.phase_lock.frames_per_cycle, 20);
  EXPECT_EQ(cell.phase_lock.first_phase, 3);
  EXPECT_EQ(cell.rotation_deg, 0);  // found to be 0 +- 0.001
}

TEST(CellDraft, AnswersThatNoShakerHasAreNoted) {
  const auto notes = [](const CellSurvey& s, CellAnswers answers) {
    std::string all;
    for (const std::string& note : draft_cell(s, answers).notes) all += note + '\n';
    return all;
  };
  CellSurvey s = survey();
  EXPECT_EQ(notes(s, {.sigma_mm = 2, .frequency_hz = 20}), "");
  EXPECT_NE(notes(s, {.sigma_mm = 2, .frequency_hz = 20, .gravity_m_s2 = 981}).find("gravity is 981 m/s^2"),
            std::string::npos);
  // The plate repeats itself after 20 frames.
  EXPECT_EQ(notes(s, {.sigma_mm = 2, .frequency_hz = 20, .frame_rate_hz = 400}), "");
  EXPECT_NE(
      notes(s, {.sigma_mm = 2, .frequency_hz = 20, .frame_rate_hz = 25})
          .find("25 frames per second and a period of 20 frames give a frequency of 1.25 Hz, but 20 Hz"),
      std::string::npos);
  s.frame_rate_hz = 500;  // of the camera's time stamps
  EXPECT_NE(notes(s, {.sigma_mm = 2, .frequency_hz = 20}).find("500 frames per second"), std::string::npos);
}

TEST(CellDraft, TheFrameRateGivesTheFrequency) {
  CellSurvey s = survey();
  s.frame_rate_hz = 400;
  const CellDraft draft = draft_cell(s, {.sigma_mm = 2});
  EXPECT_EQ(key(draft, "drive.frequency_hz").value, "20.0000");
  EXPECT_NEAR(key(draft, "drive.frequency_hz").measured.at(0).error, 20 * 0.001 / 20, 1e-12);
  EXPECT_NEAR(draft.gamma->value, 4.829, 1e-3);
}

TEST(CellDraft, APlaybackRateGivesNoFrequency) {
  CellSurvey s = survey();
  s.playback_hz = 25;
  EXPECT_TRUE(key(draft_cell(s, {.sigma_mm = 2}), "drive.frequency_hz").open);
  // A stated frequency puts the rate of the camera into the file: 20 Hz times 20 frames per cycle.
  EXPECT_EQ(key(draft_cell(s, {.sigma_mm = 2, .frequency_hz = 20}), "camera.frame_rate_hz").value, "400");
}

TEST(CellDraft, GammaAloneNeedsNoLaboratoryScale) {
  const CellSurvey s = survey();
  const CellDraft draft = draft_cell(s, {.gamma = 1.5});
  EXPECT_EQ(draft.find("scale.sigma_mm"), nullptr);
  const imaging::CellDescription cell = read(draft, s);
  EXPECT_DOUBLE_EQ(cell.drive()->amplitude, 1.5);
  EXPECT_NEAR(cell.drive()->omega, 1, 1e-12);  // Gamma = A omega^2
}

// 24 mm between walls that are 10 beads apart: beads of 2.4 mm.
TEST(CellDraft, AWidthInMillimetresMeasuresTheBead) {
  const CellSurvey s = survey();
  const CellDraft draft = draft_cell(s, {.width_mm = 24, .frequency_hz = 20});
  EXPECT_NEAR(key(draft, "scale.sigma_mm").measured.at(0).value, 2.4, 1e-12);
  EXPECT_NEAR(*read(draft, s).width, 10, 0.01);
}

// Beads of 2 mm in a cell of 20 mm, the walls 120 px apart: 12 px per bead.
TEST(CellDraft, WidthAndDiameterGiveTheScaleFromTheWalls) {
  const CellSurvey s = survey();
  const CellDraft draft = draft_cell(s, {.sigma_mm = 2, .width_mm = 20, .frequency_hz = 20});
  EXPECT_NEAR(*draft.pixels_per_sigma, 12, 1e-12);
  EXPECT_TRUE(draft.notes.empty());
  const CellDraft wrong = draft_cell(s, {.sigma_mm = 2, .width_mm = 22, .frequency_hz = 20});
  ASSERT_EQ(wrong.notes.size(), 1U);
  EXPECT_NE(wrong.notes[0].find("do not fit together"), std::string::npos);
}

TEST(CellDraft, AStatedGammaThatThePlateContradictsIsNoted) {
  const CellSurvey s = survey();
  EXPECT_TRUE(draft_cell(s, {.sigma_mm = 2, .frequency_hz = 20, .gamma = 4.83}).notes.empty());
  const CellDraft draft = draft_cell(s, {.sigma_mm = 2, .frequency_hz = 20, .gamma = 3});
  ASSERT_EQ(draft.notes.size(), 1U);
  EXPECT_NE(draft.notes[0].find("Gamma = 3 is stated"), std::string::npos);
}

// Metres for millimetres, kilohertz for hertz: Gamma = 1.5 sigma (2 pi f)^2/g by hand in both cases.
TEST(CellDraft, NumbersThatNoShakerReachesAreDoubted) {
  const CellSurvey s = survey();
  const CellDraft small = draft_cell(s, {.sigma_mm = 0.002, .frequency_hz = 20});
  ASSERT_EQ(small.notes.size(), 2U);
  EXPECT_NE(small.notes[0].find("bead diameter is 0.002 mm"), std::string::npos) << small.notes[0];
  EXPECT_NE(small.notes[1].find("is 0.00483,"), std::string::npos) << small.notes[1];
  const CellDraft fast = draft_cell(s, {.sigma_mm = 2, .frequency_hz = 20000});
  ASSERT_EQ(fast.notes.size(), 2U);
  EXPECT_NE(fast.notes[0].find("2e+04 Hz"), std::string::npos) << fast.notes[0];
  EXPECT_NE(fast.notes[1].find("is 4.83e+06,"), std::string::npos) << fast.notes[1];
  EXPECT_TRUE(draft_cell(s, {.sigma_mm = 2, .frequency_hz = 20}).notes.empty());
}

TEST(CellDraft, OpenKeysAreRefusedByName) {
  const CellSurvey s = survey();
  const CellDraft draft = draft_cell(s, {});
  EXPECT_TRUE(key(draft, "scale.sigma_mm").open);
  EXPECT_TRUE(key(draft, "drive.frequency_hz").open);
  expect_refusal<ConfigError>([&] { (void)read(draft, s); }, "scale.sigma_mm", "bead diameter in mm",
                              "drive.frequency_hz");
}

TEST(CellDraft, NothingMeasuredLeavesOnlyPlaceholders) {
  const CellSurvey s{.stack = "frames", .size = {160, 240}, .n_frames = 1};
  const CellDraft draft = draft_cell(s, {});
  for (const char* name :
       {"camera.pixels_per_sigma", "camera.origin_px", "camera.frames_per_cycle", "cell.width_sigma",
        "cell.sides", "drive.frequency_hz", "drive.gamma", "scale.sigma_mm"})
    EXPECT_TRUE(key(draft, name).open) << name;
}

TEST(CellDraft, ANewlineInANameStaysInItsComment) {
  CellSurvey s = survey();
  s.missing.push_back({"x", "the file a\n[cell]\nwidth = 3 is odd", "y"});
  EXPECT_DOUBLE_EQ(*read(draft_cell(s, {.gamma = 1.5}), s).width, 10);
}

}  // namespace
}  // namespace twincell::twin::cell_draft_test
