// A signal ends every command within a second, at any stage, and no file remains.

#include <gtest/gtest.h>

#include <chrono>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <random>

#include "tests/support/program.hpp"
#include "tests/support/put_file.hpp"

namespace twincell {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;
using Clock = std::chrono::steady_clock;

constexpr const char* kScene =
    "preset = \"fortini-huang-2015\"\n[beads]\nlayers = 4\n[cell]\nwidth = 10\n[drive]\ngamma = 1.8\n"
    "[time]\ncycles = 2\ndiscard = 0\n";

/// An image large enough that the search for settings takes seconds.
cv::Mat many_discs() {
  std::mt19937 chance(1);
  std::uniform_real_distribution<double> off(-3, 3);
  cv::Mat picture(1600, 1600, CV_8U, cv::Scalar(230));
  for (int row = 0; row < 40; ++row)
    for (int column = 0; column < 40; ++column)
      cv::circle(picture, cv::Point2d(20 + 40 * column + off(chance), 20 + 40 * row + off(chance)), 16,
                 cv::Scalar(25), -1);
  return picture;
}

class Stop : public ::testing::Test {
 protected:
  Stop() : old_(fs::current_path()) {
    fs::current_path(folder_.path());
    put_file("s.toml", kScene);
    std::string seeds = "1";
    for (int k = 2; k <= 5000; ++k) seeds += ", " + std::to_string(k);
    put_file("plan.toml", "scene = \"s.toml\"\n[axes]\nstart.seed = [" + seeds + "]\n");
    fs::create_directory("frames");
    const cv::Mat picture = many_discs();
    for (const char* name : {"frames/a.png", "frames/b.png", "frames/c.png"}) cv::imwrite(name, picture);
    fs::create_directory("out");
  }
  ~Stop() override { fs::current_path(old_); }

  TemporaryFolder folder_;

 private:
  fs::path old_;
};

TEST_F(Stop, EveryLongWorkEndsWithinASecond) {
  constexpr double kPatience = 2;  // s: one second, plus one for a busy machine
  const std::vector<Words> all = {
      {"locate", "frames", "--refine", "profile", "-o", "out/b.csv"},
      {"locate", "frames", "--refine", "profile", "--diameter", "31", "-o", "out/b.csv"},
      {"track", "frames", "-o", "out/t.h5"},
      {"calibrate", "beads", "frames", "-o", "out/c.toml"},
      {"reproduce", "p1-appendix", "-o", "out/r"},
      {"sweep", "plan", "plan.toml", "--folder", "out/sweep"},
      {"explain", "s.toml", "--set", "beads.layers=300000"},
      {"simulate", "s.toml", "-o", "out/o.h5", "--set", "beads.layers=300000", "--set", "start.kind=random"},
      {"simulate", "s.toml", "-o", "out/o.h5", "--set", "time.cycles=20000"},
      {"export", "s.toml", "--to", "lammps", "-o", "out/deck", "--set", "beads.layers=300000"},
      {"cost", "sim", "-o", "out/cost"},
  };
  for (const Words& words : all)
    for (const auto& [wait_ms, signal] : {std::pair{300, SIGTERM}, {1200, SIGINT}}) {
      std::string said;
      for (const std::string& word : words) said += word + " ";
      SCOPED_TRACE(said + std::to_string(wait_ms));
      RunningProgram program(words);
      std::this_thread::sleep_for(std::chrono::milliseconds(wait_ms));
      const auto asked = Clock::now();
      program.signal(signal);
      const Ran ran = program.wait();
      const double took = std::chrono::duration<double>(Clock::now() - asked).count();
      if (ran.code != 0) {  // otherwise it finished before the signal
        EXPECT_EQ(ran.code, 128 + signal) << ran.err;
        const bool shared = words[0] == "reproduce" || words[0] == "sweep";  // completed points remain
        if (!shared) {
          EXPECT_EQ(names_in("out"), Words{}) << ran.err;
        }
        for (const auto& entry : fs::recursive_directory_iterator("out"))
          EXPECT_FALSE(entry.path().filename().string().starts_with(".twincell-")) << entry.path();
      }
      EXPECT_LT(took, kPatience);
      fs::remove_all("out");
      fs::create_directory("out");
    }
}

TEST_F(Stop, TheSearchForSettingsIsStoppedInTheMiddle) {
  // The search takes seconds, so the program cannot finish before the signal. A busy machine may need half a
  // second to load the program's libraries; until then no signal is handled.
  RunningProgram program({"locate", "frames", "--refine", "profile", "-o", "out/b.csv"});
  std::this_thread::sleep_for(std::chrono::milliseconds(900));
  program.signal(SIGTERM);
  const Ran ran = program.wait();
  EXPECT_EQ(ran.code, 143) << ran.err;
  EXPECT_NE(ran.err.find("Stopped by a signal"), std::string::npos) << ran.err;
  EXPECT_EQ(names_in("out"), Words{});
}

TEST_F(Stop, ARunThatIsSavedIsSavedFirst) {
  const Words words = {"simulate",           "s.toml", "-o",    "out/o.h5",
                       "--checkpoint-every", "0",      "--set", "time.cycles=20000"};
  RunningProgram program(words);
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  program.signal(SIGTERM);
  const Ran ran = program.wait();
  EXPECT_EQ(ran.code, 143) << ran.err;
  EXPECT_NE(ran.err.find("--resume continues"), std::string::npos) << ran.err;
  EXPECT_TRUE(fs::exists("out/o.h5.checkpoint/state.h5"));
}

}  // namespace
}  // namespace twincell
