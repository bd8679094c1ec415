// What is read back of the report that `track` stores, of this and of earlier versions, and damaged.

#include "trajectory/tracking_record.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/error.hpp"

namespace twincell::tracking_record_test {
namespace {

TrajectoryInfo tracked(const std::string& report) {
  TrajectoryInfo info;
  info.phases_per_cycle = 20;
  info.tracking_json = report;
  return info;
}

const std::string kCamera =
    R"("pixels_per_sigma": 12.5, "origin_px": [3.0, 250.5], "width_px": 640, "height_px": 480)";

TEST(TrackingRecord, TheCameraComesBack) {
  const auto full = tracked_camera(
      tracked(R"({"camera": {)" + kCamera +
              R"(, "scale_error_px": 0.1, "rotation_deg": 0.4, "distortion": 0.01, "bright": true}})"),
      "e.h5");
  ASSERT_TRUE(full);
  EXPECT_EQ(full->pixels_per_sigma, 12.5);
  EXPECT_EQ(full->origin_x_px, 3);
  EXPECT_EQ(full->origin_y_px, 250.5);
  EXPECT_EQ(full->width_px, 640);
  EXPECT_EQ(full->height_px, 480);
  EXPECT_EQ(full->scale_error_px, 0.1);
  EXPECT_EQ(full->rotation_deg, 0.4);
  EXPECT_EQ(full->distortion, 0.01);
  // Without a lens and a calibration the last three are not stored.
  const auto plain = tracked_camera(tracked(R"({"camera": {)" + kCamera + "}}"), "e.h5");
  ASSERT_TRUE(plain);
  EXPECT_EQ(plain->scale_error_px, std::nullopt);
  EXPECT_EQ(plain->rotation_deg, 0);
  EXPECT_EQ(plain->distortion, 0);
}

TEST(TrackingRecord, WhatIsNotStoredIsAbsent) {
  for (const char* report : {"", "{}", "[1]", "no JSON"}) {
    const TrajectoryInfo info = tracked(report);
    EXPECT_FALSE(tracked_as_bright(info)) << report;
    EXPECT_EQ(tracked_first_phase(info), std::nullopt) << report;
    EXPECT_EQ(tracked_amplitude_error(info), std::nullopt) << report;
    EXPECT_EQ(recorded_disagreement(info), std::nullopt) << report;
  }
  EXPECT_FALSE(tracked_camera(tracked(""), "e.h5"));
  EXPECT_FALSE(tracked_camera(tracked("{}"), "e.h5"));
  EXPECT_THROW(static_cast<void>(tracked_camera(tracked("no JSON"), "e.h5")), InputError);
}

TEST(TrackingRecord, TheErrorOfTheAmplitudeIsRelative) {
  const auto error = [](const std::string& amplitude, const std::string& its_error) {
    return tracked_amplitude_error(tracked(R"({"drive_check": {"amplitude": )" + amplitude +
                                           R"(, "amplitude_error": )" + its_error + "}}"));
  };
  EXPECT_DOUBLE_EQ(error("1.5", "0.003").value(), 0.002);
  EXPECT_EQ(error("0", "0.003"), std::nullopt);
  EXPECT_EQ(error("1.5", "-1"), std::nullopt);
  EXPECT_EQ(error("1.5", "\"small\""), std::nullopt);
}

TEST(TrackingRecord, ADamagedMemberIsNotBelieved) {
  const auto first_phase = [](const std::string& value) {
    return tracked_first_phase(tracked(R"({"phase_lock": {"first_phase": )" + value + "}}"));
  };
  EXPECT_EQ(first_phase("7"), 7);
  for (const char* damaged : {"\"seven\"", "null", "7.5", "-1", "20", "[7]", "1e300"})
    EXPECT_EQ(first_phase(damaged), std::nullopt) << damaged;
  EXPECT_TRUE(tracked_as_bright(tracked(R"({"camera": {"bright": true}})")));
  EXPECT_FALSE(tracked_as_bright(tracked(R"({"camera": {"bright": 1}})")));
  try {
    static_cast<void>(tracked_camera(tracked(R"({"camera": {"origin_px": [1]}})"), "e.h5"));
    FAIL() << "an origin of one number is accepted";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("camera.origin_px"), std::string::npos) << e.what();
  }
}

TEST(TrackingRecord, TheCheckOfTheDriveComesBack) {
  EXPECT_EQ(recorded_disagreement(tracked(R"({"drive_check": {"by": "plate"}})")), "");
  EXPECT_EQ(recorded_disagreement(
                tracked(R"({"drive_check": {"by": "plate"}, "drive_disagreement": "twice as fast"})")),
            "twice as fast");
  EXPECT_EQ(recorded_disagreement(tracked(R"({"drive_disagreement": 5})")),
            "the stated drive does not fit the film");
}

}  // namespace
}  // namespace twincell::tracking_record_test
