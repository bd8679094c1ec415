// A signal ends every command within a second, at any stage, and no file remains.

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>
#include <random>

#include "tests/support/environment_variable.hpp"
#include "tests/support/pictures.hpp"
#include "tests/support/program.hpp"
#include "tests/support/put_file.hpp"

namespace twincell::stop_test {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

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
    for (const char* name : {"frames/a.png", "frames/b.png", "frames/c.png"}) write_picture(name, picture);
    fs::create_directory("out");
  }
  ~Stop() override { fs::current_path(old_); }

  TemporaryFolder folder_;

 private:
  fs::path old_;
};

/// A command, and the numbers of events in its folder (files opened, made, changed) after which it is
/// stopped: one while it reads, one in its long work.
struct Work {
  Words words;
  std::vector<std::size_t> stages;
};

TEST_F(Stop, EveryLongWorkEndsWithinASecond) {
  constexpr double kPatience_s = 2;  // of computing: a second, on two threads
  const std::vector<Work> all = {
      {{"locate", "frames", "--refine", "profile", "-o", "out/b.csv"}, {1, 6}},
      {{"locate", "frames", "--refine", "profile", "--diameter", "31", "-o", "out/b.csv"}, {1, 6}},
      {{"track", "frames", "-o", "out/t.h5"}, {1, 3}},
      {{"calibrate", "beads", "frames", "-o", "out/c.toml"}, {1, 3}},
      {{"reproduce", "p1-appendix", "-o", "out/r"}, {1, 2}},
      {{"sweep", "plan", "plan.toml", "--folder", "out/sweep"}, {1}},
      {{"explain", "s.toml", "--set", "beads.layers=300000"}, {1}},
      {{"simulate", "s.toml", "-o", "out/o.h5", "--set", "beads.layers=300000", "--set", "start.kind=random"},
       {1, 3}},
      {{"simulate", "s.toml", "-o", "out/o.h5", "--set", "time.cycles=20000"}, {1, 30}},
      {{"export", "s.toml", "--to", "lammps", "-o", "out/deck", "--set", "beads.layers=300000"}, {1, 4}},
      {{"cost", "sim", "-o", "out/cost"}, {1, 3}},
  };
  for (const auto& [words, stages] : all)
    for (const std::size_t stage : stages) {
      const int signal = stage == 1 ? SIGTERM : SIGINT;
      std::string said;
      for (const std::string& word : words) said += word + " ";
      SCOPED_TRACE(said + std::to_string(stage));
      FolderEvents events(".", FolderEvents::kChangesAndOpens);
      RunningProgram program(words);
      for (std::size_t seen = 0; seen < stage;) {
        const std::size_t more = events.wait(program.id());
        ASSERT_GT(more, 0U) << "it ended by itself: " << program.wait().err;
        seen += more;
      }
      const double before_s = program.cpu_s();
      program.signal(signal);
      const Ran ran = program.wait();
      EXPECT_EQ(ran.code, 128 + signal) << ran.err;
      EXPECT_NE(ran.err.find("Stopped by a signal"), std::string::npos) << ran.err;
      const bool shared = words[0] == "reproduce" || words[0] == "sweep";  // completed points remain
      if (!shared) {
        EXPECT_EQ(names_in("out"), Words{}) << ran.err;
      }
      for (const auto& entry : fs::recursive_directory_iterator("out"))
        EXPECT_FALSE(entry.path().filename().string().starts_with(".twincell-")) << entry.path();
      EXPECT_LT(ran.cpu_s - before_s, kPatience_s);
      fs::remove_all("out");
      fs::create_directory("out");
    }
}

TEST_F(Stop, TheSearchForSettingsIsStoppedInTheMiddle) {
  // The search takes seconds after the picture has been opened, so the program cannot finish before the
  // signal.
  FolderEvents opened("frames", IN_OPEN);
  RunningProgram program({"locate", "frames", "--refine", "profile", "-o", "out/b.csv"});
  ASSERT_GT(opened.wait(program.id()), 0U);
  program.signal(SIGTERM);
  const Ran ran = program.wait();
  EXPECT_EQ(ran.code, 143) << ran.err;
  EXPECT_NE(ran.err.find("Stopped by a signal"), std::string::npos) << ran.err;
  EXPECT_EQ(names_in("out"), Words{});
}

TEST_F(Stop, ARunThatIsSavedIsSavedFirst) {
  const EnvironmentVariable often("TWINCELL_PROGRESS_S", "0");
  RunningProgram program(
      {"simulate", "s.toml", "-o", "out/o.h5", "--checkpoint-every", "0", "--set", "time.cycles=20000"});
  ASSERT_TRUE(program.wait_for_a_line());
  program.signal(SIGTERM);
  const Ran ran = program.wait();
  EXPECT_EQ(ran.code, 143) << ran.err;
  EXPECT_NE(ran.err.find("--resume continues"), std::string::npos) << ran.err;
  EXPECT_TRUE(fs::exists("out/o.h5.checkpoint/state.h5"));
}

}  // namespace
}  // namespace twincell::stop_test
