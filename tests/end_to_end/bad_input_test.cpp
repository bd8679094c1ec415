// Bad input as a user meets it: one sentence that names the cause, the documented exit code, and no partial
// output.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>

#include "tests/support/environment_variable.hpp"
#include "tests/support/pictures.hpp"
#include "tests/support/program.hpp"
#include "trajectory/formats/h5md_file.hpp"

namespace twincell::bad_input_test {
namespace {

namespace fs = std::filesystem;

constexpr int kUsage = 2, kInput = 3;

void write(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

/// Expects a refusal: the exit code, exactly one line on stderr that contains every word, and nothing on
/// stdout.
void expect_refusal(const std::vector<std::string>& words, int code,
                    const std::vector<std::string>& mentioned) {
  const Ran ran = run_program(words);
  EXPECT_EQ(ran.code, code) << ran.err;
  EXPECT_EQ(ran.out, "");
  EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
  for (const auto& word : mentioned)
    EXPECT_NE(ran.err.find(word), std::string::npos) << "'" << word << "' is not in: " << ran.err;
}

class BadInput : public ::testing::Test {
 protected:
  /// Expects the folder to contain these names and no others.
  void expect_only(const std::vector<std::string>& names) const {
    EXPECT_EQ(names_in(folder_.path()), names);
  }

  [[nodiscard]] std::string at(const std::string& name) const { return folder_ / name; }

  TemporaryFolder folder_;
};

TEST_F(BadInput, CommandLine) {
  expect_refusal({"anallyze", "x.h5"}, kUsage, {"anallyze", "did you mean 'analyze'"});
  expect_refusal({"info"}, kUsage, {"file"});
  expect_refusal({"info", "a.h5", "--sped"}, kUsage, {"--sped"});
  expect_refusal({"info", "a.h5", "--threads", "many"}, kUsage, {"--threads"});
}

TEST_F(BadInput, MissingFilesAreNamed) {
  expect_refusal({"info", at("no.h5")}, kInput, {"no.h5", "does not exist"});
  expect_refusal({"validate", at("no.h5")}, kInput, {"no.h5", "does not exist"});
  expect_refusal({"analyze", at("no.h5")}, kInput, {"no.h5", "does not exist"});
  expect_refusal({"simulate", at("no.toml"), "-o", at("o.h5")}, kInput, {"no.toml", "does not exist"});
  expect_refusal({"locate", at("no.png"), "--diameter", "15", "-o", at("o.csv")}, kInput,
                 {"no.png", "does not exist"});
  expect_refusal({"track", at("none"), "--diameter", "15", "--frames-per-cycle", "20", "-o", at("o.h5")},
                 kInput, {"none", "does not exist"});
  expect_refusal({"render", at("no.h5"), "-o", at("frames")}, kInput, {"no.h5", "does not exist"});
  expect_refusal({"compare", "--experiment", at("a.h5"), "--simulation", at("b.h5"), "-o", at("report")},
                 kInput, {"a.h5", "does not exist"});
  expect_only({});
}

TEST_F(BadInput, Images) {
  fs::create_directory(at("empty"));
  expect_refusal({"locate", at("empty"), "--diameter", "15", "-o", at("o.csv")}, kInput, {"empty"});
  write(at("text.png"), "this is not a picture");
  expect_refusal({"locate", at("text.png"), "--diameter", "15", "-o", at("o.csv")}, kInput, {"text.png"});
  write(at("cut.tif"), std::string("II*\0\x08\0\0\0", 8));
  expect_refusal({"locate", at("cut.tif"), "--diameter", "15", "-o", at("o.csv")}, kInput, {"cut.tif"});
  expect_only({"cut.tif", "empty", "text.png"});
}

// Images without content, or of hardly one pixel: a one-sentence message, or an empty table.
TEST_F(BadInput, PicturesWithoutAnything) {
  const auto picture = [&](int width, int height, int type, double value) {
    cv::Mat m(height, width, type, cv::Scalar(value));
    if (type == CV_8U && value == 1) cv::randu(m, 0, 255);
    write_picture(at("a.tif"), m);
  };
  const std::vector<std::pair<int, int>> sizes = {{1, 1},   {2, 2},   {1, 100}, {100, 1},  {5, 5},
                                                  {7, 700}, {2, 700}, {3, 80},  {200, 150}};
  const std::vector<std::pair<int, double>> values = {
      {CV_8U, 1}, {CV_8U, 0}, {CV_8U, 255}, {CV_16U, 65535}, {CV_32F, std::nan("")}, {CV_32F, 1e38}};
  for (const auto& [width, height] : sizes)
    for (const auto& [type, value] : values) {
      const bool all_values = width == 1 || width == 200;
      if (!all_values && !(type == CV_8U && value == 1)) continue;
      picture(width, height, type, value);
      for (const std::vector<std::string>& words : {std::vector<std::string>{"locate"},
                                                    {"locate", "--diameter", "5"},
                                                    {"locate", "--diameter", "400", "--dark"},
                                                    {"locate", "--diameter", "6", "--refine", "profile"},
                                                    {"locate", "--diameter", "90", "--refine", "edges"},
                                                    {"track"},
                                                    {"calibrate", "camera"},
                                                    {"calibrate", "beads"},
                                                    {"calibrate", "walls"}}) {
        std::vector<std::string> all = words;
        all.insert(all.begin() + (words[0] == "calibrate" ? 2 : 1), at("a.tif"));
        all.insert(all.end(), {"-q", "-o", at("o")});
        const Ran ran = run_program(all);
        SCOPED_TRACE(words[0] + " " + words.back() + " " + std::to_string(width) + " x " +
                     std::to_string(height) + ", " + std::to_string(type) + ", " + std::to_string(value));
        EXPECT_TRUE(ran.code == 0 || ran.code == 2 || ran.code == 3) << ran.code << ": " << ran.err;
        for (const char* raw : {"OpenCV", "std::", "internal error", "assert", ".cpp"})
          EXPECT_EQ(ran.err.find(raw), std::string::npos) << ran.err;
        EXPECT_LE(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
        fs::remove_all(at("o"));
      }
    }
  picture(1, 1, CV_8U, 0);
  expect_refusal({"locate", at("a.tif"), "-o", at("o.csv")}, kInput, {"a.tif", "--diameter"});
  expect_only({"a.tif"});
}

// A library's own messages, with their addresses and file names, are replaced by one sentence.
TEST_F(BadInput, NumbersThatNoFitCanHold) {
  write(at("huge.csv"), "x,y\n1,1e308\n2,1e308\n3,-1e308\n4,1e308\n");
  for (const char* law : {"line", "constant", "exponential"})
    expect_refusal({"fit", at("huge.csv"), "--law", law, "-o", at("fit")}, kInput,
                   {"huge.csv", "1e+308", "1e+150"});
  // Without a window no point is outside of it.
  write(at("far.csv"), "x,y\n1e308,1\n2e307,4\n3,6\n4,8\n");
  expect_refusal({"fit", at("far.csv"), "--law", "line", "-o", at("fit")}, kInput,
                 {"far.csv", "1e+308", "1e+150"});
  write(at("tiny.csv"), "x,y\n1,1e-200\n2,2.1e-200\n3,2.9e-200\n4,4e-200\n");
  expect_refusal({"fit", at("tiny.csv"), "--law", "line", "-o", at("fit")}, kInput,
                 {"tiny.csv", "no y is larger than 4e-200"});
  expect_only({"far.csv", "huge.csv", "tiny.csv"});
}

TEST_F(BadInput, Trajectories) {
  write(at("text.h5"), "this is not HDF5");
  for (const std::string verb : {"info", "validate", "analyze"})
    expect_refusal({verb, at("text.h5")}, kInput, {"text.h5", "not an HDF5 file"});
  expect_only({"text.h5"});
}

TEST_F(BadInput, Scenes) {
  const std::string good_end = "\n[time]\ncycles = 1\n";
  write(at("syntax.toml"), "[drive\ngamma = 1\n");
  expect_refusal({"simulate", at("syntax.toml"), "-o", at("o.h5")}, kUsage, {"syntax.toml:1"});
  write(at("key.toml"), "preset = \"fortini-huang-2015\"\n[drive]\nomega = 1.0\ngama = 1.5\n" + good_end);
  expect_refusal({"simulate", at("key.toml"), "-o", at("o.h5")}, kUsage, {"key.toml:4", "gama"});
  write(at("type.toml"),
        "preset = \"fortini-huang-2015\"\n[drive]\nomega = 1.0\ngamma = \"strong\"\n" + good_end);
  expect_refusal({"simulate", at("type.toml"), "-o", at("o.h5")}, kUsage, {"type.toml:4", "gamma"});
  write(at("twice.toml"),
        "preset = \"fortini-huang-2015\"\n[drive]\nomega = 1.0\ngamma = 1.5\namplitude = 3.0\n" + good_end);
  expect_refusal({"simulate", at("twice.toml"), "-o", at("o.h5")}, kUsage, {"twice.toml", "1.5"});
  expect_only({"key.toml", "syntax.toml", "twice.toml", "type.toml"});
}

TEST_F(BadInput, OtherProgramsDumps) {
  expect_refusal({"import", at("no.dump"), "-o", at("o.h5")}, kInput, {"no.dump", "does not exist"});
  write(at("text.dump"), "this is not a dump\n");
  expect_refusal({"import", at("text.dump"), "-o", at("o.h5")}, kInput, {"text.dump:1", "ITEM: TIMESTEP"});
  const std::string frame =
      "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS ff ff pp\n0 8\n0 9\n-1 1\nITEM: ATOMS "
      "id x y\n";
  write(at("cut.dump"), frame);
  expect_refusal({"import", at("cut.dump"), "-o", at("o.h5")}, kInput, {"cut.dump:9", "ends"});
  write(at("whole.dump"), frame + "1 1 1\n");
  write(at("minus.csv"), "frame,particle,x,y,sigma_x,sigma_y\n0,0,1,-1,-0.1,0.1\n1,0,1,-1,0,0.1\n");
  expect_refusal({"import", at("minus.csv"), "-o", at("o.h5"), "--timestep", "1"}, kInput,
                 {"minus.csv:2", "standard error is negative"});
  expect_refusal({"import", at("whole.dump"), "-o", at("o.h5")}, kUsage, {"--timestep", "whole.dump"});
  expect_only({"cut.dump", "minus.csv", "text.dump", "whole.dump"});
}

TEST_F(BadInput, RecordsOfTheDrive) {
  write(at("s.toml"),
        "preset = \"fortini-huang-2015\"\n[beads]\ncount = 10\n[drive]\nfile = \"trace.csv\"\n");
  std::string rows = "time_t0,position_sigma\n";
  for (int i = 0; i < 400; ++i) rows += fmt::format("{},{}\n", 0.2 * i, 1.5 * std::sin(0.2 * i));
  const auto refused = [&](const std::string& text, int code, const std::vector<std::string>& words) {
    fs::remove(at("trace.csv"));
    if (!text.empty()) write(at("trace.csv"), text);
    for (const char* verb : {"simulate", "explain"}) {
      std::vector<std::string> command = {verb, at("s.toml")};
      if (verb == std::string("simulate")) command.insert(command.end(), {"-o", at("o.h5")});
      expect_refusal(command, code, words);
    }
  };
  refused("", kInput, {"trace.csv", "does not exist"});
  refused(rows + "80.0,nan\n", kInput, {"trace.csv", "position_sigma", "row 401 has no number"});
  refused(rows + "79.0,0.1\n", kInput, {"trace.csv", "time_t0", "row 401 is not later"});
  refused(rows + "90.0,0.1\n", kInput, {"trace.csv", "rows are missing"});
  refused(rows + "80.0\n", kInput, {"trace.csv:402", "1 field"});
  refused(rows, kUsage, {"s.toml:5", "drive.file", "trace.csv lasts 12.7 cycles", "the run needs 210"});
  refused(std::string(100, '\0'), kInput, {"trace.csv", "zero bytes"});
  fs::remove(at("trace.csv"));
  write(at("trace.csv"), rows);
  expect_refusal({"export", at("s.toml"), "--to", "lammps", "-o", at("deck"), "--set", "time.cycles=5",
                  "--set", "time.discard=0"},
                 kUsage, {"s.toml:5", "drive.file", "not as a record"});
  fs::remove(at("trace.csv"));
  fs::create_directory(at("trace.csv"));
  expect_refusal({"explain", at("s.toml")}, kInput, {"trace.csv"});
  expect_only({"s.toml", "trace.csv"});
}

TEST_F(BadInput, ScenesThatLammpsHasNoWordsFor) {
  write(at("s.toml"), "preset = \"fortini-huang-2015\"\n[beads]\ncount = 10\n[drive]\ngamma = 1.5\n");
  const auto refused = [&](const std::string& assignment, const std::vector<std::string>& mentioned) {
    expect_refusal({"export", at("s.toml"), "--to", "lammps", "-o", at("deck"), "--set", assignment}, kUsage,
                   mentioned);
  };
  refused("contact.tangential=spring-limited", {"s.toml", "contact.tangential", "limit on the spring alone"});
  refused("contact.normal=velocity-dependent-restitution", {"contact.normal", "do not support the law"});
  refused("contact={rolling='spring',k_r=1.0,mu_r=0.1}", {"contact.rolling", "do not support the law"});
  refused("contact.bottom.k_t=0.0", {"contact.bottom.k_t", "divides"});
  refused("cell.side_tilt=5.0", {"cell.side_tilt", "along the axes"});
  refused("cell.plate_drag=0.1", {"cell.plate_drag"});
  refused("time.integrator=split", {"time.integrator", "split"});
  refused("drive.start=ramp", {"drive", "no ramp"});
  refused("drive.harmonics=[[0.1, 0.25]]", {"s.toml", "drive.harmonics", "without harmonics"});
  expect_refusal(
      {"export", at("s.toml"), "--to", "lammps", "-o", at("deck"), "--set", "contact.restitution=0.9",
       "--set", "beads.spread=uniform", "--set", "beads.spread_width=0.1"},
      kUsage, {"contact", "unequal masses", "rates"});
  refused("contact.mu=20000", {"contact.mu", "20000", "10000"});
  refused("time.phases=3", {"time.phases", "multiple of 4"});
  refused("time.cycles=200000", {"time.cycles", "200010", "2e+09"});
  refused("beads.count=0", {"beads.count", "without beads"});
  expect_refusal({"export", at("s.toml"), "--to", "yade", "-o", at("deck")}, kUsage, {"--to", "yade"});
  expect_refusal({"export", at("s.toml"), "--to", "lammps", "-o", at("deck"), "--from", at("no.h5")}, kInput,
                 {"no.h5", "does not exist"});
  expect_only({"s.toml"});
}

// A trajectory that does not belong to the scene, or from which a run cannot continue.
TEST_F(BadInput, FramesFromWhichLammpsCannotBegin) {
  write(at("s.toml"), "preset = \"fortini-huang-2015\"\n[beads]\ncount = 1\n[drive]\ngamma = 1.5\n");
  TrajectoryInfo info;
  info.n_beads = 1;
  info.phases_per_cycle = 20;
  info.radius = {0.5};
  const auto refused = [&](const std::vector<std::string>& more, const std::vector<std::string>& mentioned) {
    {
      H5mdWriter writer(at("t.h5"), info);
      Frame frame;
      frame.phase = info.columns.phase ? 5 : -1;
      frame.cycle = info.columns.phase ? 0 : -1;
      frame.plate_height = 1.5;
      frame.position = {Vec3(3, 0, 4)};
      if (info.columns.velocity) frame.velocity = {Vec3(0, 0, 0)};
      if (info.columns.spin) frame.spin = {Vec3(0, 0, 0)};
      writer.append(frame);
      writer.finish();
    }
    std::vector<std::string> words{"export", at("s.toml"), "--to",   "lammps",
                                   "-o",     at("deck"),   "--from", at("t.h5")};
    words.insert(words.end(), more.begin(), more.end());
    expect_refusal(words, kUsage, mentioned);
  };
  refused({}, {"frame 0 of", "t.h5", "no drive phase"});
  info.columns.phase = info.columns.plate_height = true;
  refused({}, {"no velocities"});
  info.columns.velocity = true;
  refused({}, {"no spins"});
  info.columns.spin = true;
  refused({"--frame", "1"}, {"frame 1", "has 1"});
  refused({"--set", "drive.gamma=1.6"}, {"drive", "1.5", "1.6"});
  refused({"--set", "beads.count=2"}, {"beads.count", "contains 1"});
  refused({"--set", "beads.radius=0.4"}, {"beads.radius", "0.4", "0.5"});
  expect_only({"s.toml", "t.h5"});
}

TEST_F(BadInput, UnwritableOutput) {
  const std::string scene =
      std::string(TWINCELL_SOURCE_DIR) + "/data_samples/fortini-huang-crystal/scene.toml";
  expect_refusal({"simulate", scene, "-o", at("no/such/place.h5")}, kUsage, {"no/such", "does not exist"});
  fs::create_directory(at("taken.h5"));
  expect_refusal({"simulate", scene, "-o", at("taken.h5")}, kUsage, {"taken.h5"});
  expect_only({"taken.h5"});
}

// Ctrl-C in the middle of a run: exit code 130, and neither the final file nor temporary files remain.
TEST_F(BadInput, InterruptLeavesNothing) {
  const std::string scene =
      std::string(TWINCELL_SOURCE_DIR) + "/data_samples/fortini-huang-crystal/scene.toml";
  const EnvironmentVariable often("TWINCELL_PROGRESS_S", "0");
  for (const auto& [signal, code] : {std::pair{SIGINT, 130}, {SIGTERM, 143}}) {
    RunningProgram program({"simulate", scene, "-o", at("o.h5"), "--set", "time.cycles=500"});
    ASSERT_TRUE(program.wait_for_a_line());
    program.signal(signal);
    const Ran ran = program.wait();
    EXPECT_EQ(ran.code, code) << ran.err;
    EXPECT_EQ(ran.out, "");
    expect_only({});
  }
}

}  // namespace
}  // namespace twincell::bad_input_test

TEST(MissingTmpdir, IsNoMatterForHelp) {
  const char* const given = std::getenv("TMPDIR");
  const std::string before = given != nullptr ? given : "";
  ASSERT_EQ(setenv("TMPDIR", "/nonexistent/folder", 1), 0);
  // The test program itself also keeps its output in a temporary folder, so only the child process may see
  // the new value.
  const std::string line = std::string(TWINCELL_PROGRAM) + " --help > /dev/null 2>&1";
  const int status = std::system(line.c_str());  // NOLINT: a fixed command of a test
  if (given != nullptr)
    setenv("TMPDIR", before.c_str(), 1);
  else
    unsetenv("TMPDIR");
  EXPECT_EQ(status, 0);
}
