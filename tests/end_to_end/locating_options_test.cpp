// The options of the verbs that locate beads: the same for locate, track and match; the part of the picture
// and of the stack that is searched.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "tests/support/pictures.hpp"
#include "tests/support/program.hpp"

namespace twincell::locating_options_test {
namespace {

namespace fs = std::filesystem;

const fs::path kDemo = fs::path(TWINCELL_SOURCE_DIR) / "data_samples/demo/gamma-0.9";

/// Options of a verb with their help, from --help: name -> text.
std::map<std::string, std::string> options_of(const std::string& verb) {
  const Ran ran = run_program({verb, "--help"});
  EXPECT_EQ(ran.code, 0);
  std::map<std::string, std::string> options;
  std::istringstream lines(ran.out);
  std::string name;
  for (std::string line; std::getline(lines, line);) {
    const auto text = line.find_first_not_of(' ');
    if (text == std::string::npos) {
      name.clear();
      continue;
    }
    if (text <= 4 && line[text] == '-') {
      const auto dashes = line.find("--");
      name = line.substr(dashes, line.find_first_of(" ,", dashes) - dashes);
    }
    if (!name.empty()) options[name] += line;
  }
  return options;
}

/// x, y of the beads of a frame, from a table of locate.
std::vector<std::pair<double, double>> beads_of(const fs::path& table, int frame) {
  std::vector<std::pair<double, double>> beads;
  std::ifstream in(table);
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::istringstream cells(line);
    std::vector<std::string> values;
    for (std::string cell; std::getline(cells, cell, ',');) values.push_back(cell);
    if (std::stoi(values[8]) == frame) beads.emplace_back(std::stod(values[1]), std::stod(values[0]));
  }
  return beads;
}

double farthest_from(const std::vector<std::pair<double, double>>& part,
                     const std::vector<std::pair<double, double>>& whole) {
  double farthest = 0;
  for (const auto& [x, y] : part) {
    double nearest = 1e9;
    for (const auto& [u, v] : whole) nearest = std::min(nearest, std::hypot(x - u, y - v));
    farthest = std::max(farthest, nearest);
  }
  return farthest;
}

}  // namespace

TEST(LocatingOptions, LocateTrackAndMatchHaveTheSame) {
  const auto locate = options_of("locate"), track = options_of("track"), match = options_of("match");
  for (const char* name : {"--diameter", "--locator", "--min-score", "--min-explained", "--refine",
                           "--bright", "--dark", "--flat", "--background", "--roi", "--mask", "--frames"}) {
    ASSERT_TRUE(locate.contains(name)) << name;
    ASSERT_TRUE(track.contains(name)) << name;
    ASSERT_TRUE(match.contains(name)) << name;
    EXPECT_EQ(locate.at(name), track.at(name));
    EXPECT_EQ(locate.at(name), match.at(name));
  }
  for (const char* name : {"--phase-lock", "--drive-hz", "--range", "--memory"}) {
    ASSERT_TRUE(track.contains(name) && match.contains(name)) << name;
    EXPECT_EQ(track.at(name), match.at(name));
  }
}

TEST(LocatingOptions, NothingIsFoundOutsideTheRegionAndCoordinatesStay) {
  const TemporaryFolder folder;
  const auto locate = [&](const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> words = {"locate", kDemo,         "-q",         "--frames", "7:8",
                                      "-o",     folder / name, "--diameter", "12",       "--dark"};
    words.insert(words.end(), more.begin(), more.end());
    const Ran ran = run_program(words);
    EXPECT_EQ(ran.code, 0) << ran.err;
    return beads_of(folder / name, 7);
  };
  const auto whole = locate("whole.csv", {});
  ASSERT_EQ(whole.size(), 100U);
  const auto roi = locate("roi.csv", {"--roi", "50,100,60,110"});
  EXPECT_GE(roi.size(), 20U);
  EXPECT_LT(roi.size(), 70U);
  std::vector<std::pair<double, double>> well_inside;
  for (const auto& [x, y] : roi) {
    EXPECT_TRUE(x > 49.5 && x < 109.5 && y > 99.5) << x << ' ' << y;
    if (x > 62 && x < 98 && y > 112) well_inside.emplace_back(x, y);
  }
  EXPECT_GE(well_inside.size(), 12U);
  // The light is estimated from the region alone, which here is full of beads.
  EXPECT_LT(farthest_from(well_inside, whole), 0.1);
  cv::Mat1b mask(read_picture(kDemo / "frame_00007.png").size(), uchar{255});
  mask.colRange(0, 70) = 0;
  write_picture(folder / "mask.png", mask);
  const auto masked = locate("mask.csv", {"--mask", folder / "mask.png"});
  EXPECT_GE(masked.size(), 30U);
  for (const auto& [x, y] : masked) EXPECT_GT(x, 69.5 + 5) << y;
  // Beads that touch a disc cut by the mask lack the model of that disc.
  EXPECT_LT(farthest_from(masked, whole), 0.5);
}

TEST(LocatingOptions, FramesKeepTheirNumbersAndPhases) {
  const TemporaryFolder folder;
  const Ran ran = run_program({"track", kDemo, "--cell", kDemo / "CELL.toml", "-o", folder / "t.h5", "--csv",
                               folder / "t.csv", "--frames", "5:35:2", "--json"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const auto d = nlohmann::json::parse(ran.out);
  EXPECT_EQ(d["frames"], 15);
  EXPECT_EQ(d["phase_lock"]["frames_per_cycle"], 10);
  EXPECT_EQ(d["phase_lock"]["first_phase"], 2);
  EXPECT_EQ(d["phase_lock"]["offset_frames"], 0.5);
  EXPECT_FALSE(d["phase_lock"].contains("warning")) << d["phase_lock"];
  EXPECT_EQ(d["restrictions"]["frames"], "5:35:2");
  std::ifstream in(folder / "t.csv");
  std::string line;
  std::getline(in, line);
  std::getline(in, line);
  EXPECT_NE(line.find(",5,"), std::string::npos) << line;
}

TEST(LocatingOptions, BadOnesAreRefusedInASentence) {
  const TemporaryFolder folder;
  write_picture(folder / "small.png", cv::Mat1b(10, 20, uchar{1}));
  for (const auto& [option, value, said] : std::vector<std::array<std::string, 3>>{
           {"--roi", "100,100,500,10", "reaches beyond the picture of"},
           {"--roi", "1,2,3", "left,top,width,height"},
           {"--roi", "-1,2,3,4", "left,top,width,height"},
           {"--mask", folder / "small.png", "has 20 x 10 px, but the frames have"},
           {"--mask", folder / "none.png", "none.png"},
           {"--mask", kDemo, "a mask is one picture"},
           {"--frames", "5:5", "must exceed"},
           {"--frames", "five", "A:B"},
           {"--frames", "400:", "the stack has 40 frames"},
           {"--background", folder / "small.png", "20 x 10 px"}}) {
    const Ran ran = run_program(
        {"locate", kDemo, "-q", "-o", folder / "x.csv", "--diameter", "12", "--dark", option + "=" + value});
    EXPECT_TRUE(ran.code == 2 || ran.code == 3) << option << ' ' << value << ' ' << ran.code;
    EXPECT_NE(ran.err.find(said), std::string::npos) << option << ' ' << value << ": " << ran.err;
    EXPECT_FALSE(fs::exists(folder / "x.csv"));
  }
}

TEST(LocatingOptions, ARangeBeyondTheStackIsNoted) {
  const TemporaryFolder folder;
  for (const auto& [frames, noted] : {std::pair{"38:50", true}, std::pair{"38:40", false}}) {
    const Ran ran = run_program({"locate", kDemo, "-o", folder / "x.csv", "--force", "--diameter", "12",
                                 "--dark", "--frames", frames});
    EXPECT_EQ(ran.code, 0) << ran.err;
    EXPECT_EQ(ran.err.find("--frames ends before frame 50, but") != std::string::npos, noted) << ran.err;
  }
}

TEST(LocatingOptions, AStretchedPictureIsNoMotion) {
  // A bed at rest, filmed through a lens that blurs along x only. One frame cannot tell this from motion.
  const TemporaryFolder folder;
  const fs::path stack = folder.path() / "blurred";
  fs::create_directory(stack);
  cv::Mat once = read_picture(kDemo / "frame_00007.png"), smeared;
  cv::blur(once, smeared, {5, 1});
  for (int f = 0; f < 3; ++f) write_picture(stack / fmt::format("f{}.png", f), smeared);
  const Ran ran = run_program({"locate", stack, "-o", folder / "x.csv", "--diameter", "12", "--dark"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(ran.out.find("moved by"), std::string::npos) << ran.out;
  EXPECT_NE(ran.out.find("no motion is concluded"), std::string::npos) << ran.out;
}

}  // namespace twincell::locating_options_test
