// A camera that is bumped during a film: `track` names the frame and the shift.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <opencv2/imgproc.hpp>
#include <string>

#include "tests/support/pictures.hpp"
#include "tests/support/program.hpp"

namespace twincell::bumped_camera_test {
namespace {

constexpr int kFrames = 80, kBumped = 47;

/// The shipped film, whose picture is shifted by (right, down) px from frame 47 on.
void write_bumped(const std::filesystem::path& film, const std::filesystem::path& to, int right, int down) {
  const cv::Mat1d shift = (cv::Mat1d(2, 3) << 1, 0, right, 0, 1, down);
  std::filesystem::create_directory(to);
  for (int f = 0; f < kFrames; ++f) {
    const std::string name = fmt::format("frame_{:05}.png", f);
    if (f < kBumped) {
      std::filesystem::create_symlink(film / name, to / name);
      continue;
    }
    cv::Mat frame = read_picture(film / name);
    cv::warpAffine(frame, frame, shift, frame.size(), cv::INTER_NEAREST, cv::BORDER_REPLICATE);
    write_picture(to / name, frame);
  }
}

TEST(BumpedCamera, TrackNamesTheFrameAndTheShift) {
  const TemporaryFolder folder;
  const std::filesystem::path film = TWINCELL_SOURCE_DIR "/data_samples/demo/gamma-1.6";
  write_bumped(film, folder / "bumped", 5, -4);
  const auto said = [&](const std::filesystem::path& stack) {
    const Ran ran = run_program(
        {"track", stack, "-o", folder / (stack.filename().string() + ".h5"), "--cell", film / "CELL.toml"});
    EXPECT_EQ(ran.code, 0) << ran.err;
    return ran.err;
  };
  const std::string bumped = said(folder / "bumped"), still = said(film);
  EXPECT_NE(bumped.find("from frame 47 on, plate and beads are shifted by (5.0, -4.0) px"), std::string::npos)
      << bumped;
  EXPECT_NE(bumped.find("--frames 0:47 and --frames 47:80"), std::string::npos) << bumped;
  EXPECT_EQ(still.find("shifted"), std::string::npos) << still;
}

}  // namespace
}  // namespace twincell::bumped_camera_test
