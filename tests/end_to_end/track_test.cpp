// A bouncing and a rearranging cell: simulated, filmed and tracked as a user would; the simulation gives the
// true positions.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/pictures.hpp"
#include "tests/support/program.hpp"
#include "tests/support/temporary_folder.hpp"
#include "trajectory/formats/h5md_file.hpp"

namespace twincell::track_test {

namespace {

void write(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path) << text;
}

std::string scene(const std::string& start, double gamma) {
  return "preset = \"fortini-huang-2015\"\n[cell]\nwidth = 10.0\n[beads]\ncount = 100\n[drive]\ngamma = " +
         std::to_string(gamma) + "\n[start]\nkind = \"" + start +
         "\"\nsettle_limit = 20.0\n[time]\nsteps_per_contact = 20\ndiscard = 1\ncycles = 3\nphases = 20\n";
}

}  // namespace

TEST(Track, NoLinkIsWrongAtTwentyPhasesPerCycle) {
  for (const auto& [start, gamma] : {std::pair{"crystal_a", 1.5}, {"random", 1.8}}) {
    const TemporaryFolder folder;
    write(folder / "scene.toml", scene(start, gamma));
    ASSERT_EQ(run_program({"simulate", folder / "scene.toml", "-o", folder / "sim.h5", "-q"}).code, 0);
    ASSERT_EQ(run_program({"render", folder / "sim.h5", "-o", folder / "frames", "-q"}).code, 0);
    for (const std::string way : {"20", "found"}) {
      const Ran ran = run_program({"track", folder / "frames", "-o", folder / "exp.h5", "--cell",
                                   folder / "frames/CELL.toml", "--truth", folder / "frames/truth.csv",
                                   "--phase-lock", way, "--json", "-q"});
      ASSERT_EQ(ran.code, 0) << ran.err;
      const auto said = nlohmann::json::parse(ran.out);
      std::cout << start << ", Gamma " << gamma << ", phase lock " << way << ": " << said["truth"] << ' '
                << said["phase_lock"] << ' ' << said["links"] << '\n';
      EXPECT_GT(said["truth"]["links"], 5500);
      EXPECT_EQ(said["truth"]["wrong_links"], 0);
      EXPECT_EQ(said["phase_lock"]["frames_per_cycle"], 20);
      EXPECT_EQ(said["phase_lock"]["first_phase"], 0) << "found, it is placed by the drive";
      if (way != "found") continue;
      EXPECT_EQ(said["phase_lock"]["dropped"], 0);
      EXPECT_EQ(said["phase_lock"]["doubled"], 0);
    }
    EXPECT_TRUE(validate_h5md(folder / "exp.h5").empty());
  }
}

TEST(Track, AConvectingCellAtTwentyPhasesKeepsItsCrystalTogether) {
  // The plate moves by up to one diameter between two frames. Single beads of the spray above the bed may get
  // wrong links; a crystal block shifted by a lattice vector would cost dozens of links at once.
  const TemporaryFolder folder;
  write(folder / "scene.toml", scene("crystal_a", 3.2));
  ASSERT_EQ(run_program({"simulate", folder / "scene.toml", "-o", folder / "sim.h5", "-q"}).code, 0);
  ASSERT_EQ(run_program({"render", folder / "sim.h5", "-o", folder / "frames", "-q"}).code, 0);
  const Ran ran =
      run_program({"track", folder / "frames", "-o", folder / "exp.h5", "--cell", folder / "frames/CELL.toml",
                   "--truth", folder / "frames/truth.csv", "--phase-lock", "20", "--json", "-q"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const auto said = nlohmann::json::parse(ran.out);
  std::cout << said["truth"] << ' ' << said["links"] << ' ' << said["tracers"] << '\n';
  EXPECT_GT(said["truth"]["links"], 5500);
  EXPECT_LE(said["truth"]["wrong_links"], 20);
  EXPECT_GT(said["links"]["rematched"], 0);
}

// Walls, plate, and gaps nearly as dark as the beads, in an image blurred by a third of a radius.
TEST(Track, ACellOutOfFocus) {
  const TemporaryFolder folder;
  write(folder / "scene.toml", scene("crystal_a", 1.8));
  ASSERT_EQ(run_program({"simulate", folder / "scene.toml", "-o", folder / "sim.h5", "-q"}).code, 0);
  ASSERT_EQ(run_program({"render", folder / "sim.h5", "-o", folder / "frames", "--blur", "2.5", "-q"}).code,
            0);
  const Ran ran =
      run_program({"track", folder / "frames", "-o", folder / "exp.h5", "--cell", folder / "frames/CELL.toml",
                   "--truth", folder / "frames/truth.csv", "--phase-lock", "20", "--json", "-q"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const auto said = nlohmann::json::parse(ran.out);
  std::cout << said["truth"] << '\n';
  EXPECT_GE(said["truth"]["recall"], 0.999);
  EXPECT_GE(said["truth"]["precision"], 0.999);
  EXPECT_LE(said["truth"]["rms_px"], 0.06);
  EXPECT_LE(said["truth"]["wrong_links"], 2);
}

// Radii spread by a quarter. The tolerance of the size in CELL.toml is that of the beads; with a size that is
// a third too large, beads are left out, and the output reports it; with two sizes, none is left out.
TEST(Track, BeadsOfSeveralSizes) {
  const TemporaryFolder folder;
  std::string mixed = scene("random", 1.8);
  mixed.replace(mixed.find("count = 100"), 11, "count = 100\nspread = \"uniform\"\nspread_width = 0.25");
  write(folder / "scene.toml", mixed);
  ASSERT_EQ(run_program({"simulate", folder / "scene.toml", "-o", folder / "sim.h5", "-q"}).code, 0);
  ASSERT_EQ(run_program({"render", folder / "sim.h5", "-o", folder / "frames", "-q"}).code, 0);
  std::vector<std::string> words = {"track",        folder / "frames",
                                    "-o",           folder / "exp.h5",
                                    "--cell",       folder / "frames/CELL.toml",
                                    "--truth",      folder / "frames/truth.csv",
                                    "--phase-lock", "20"};
  words.emplace_back("--force");
  const auto with = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all = words;
    all.insert(all.end(), more.begin(), more.end());
    return run_program(all);
  };
  const Ran one = with({"--json"});
  EXPECT_EQ(one.code, 0) << one.err;
  EXPECT_GE(nlohmann::json::parse(one.out)["truth"]["recall"], 0.995) << one.out;
  const Ran large = with({"--diameter", "20"});
  EXPECT_EQ(large.code, 0) << large.err;
  EXPECT_NE(large.out.find("--diameter D1 D2"), std::string::npos) << large.out;
  const Ran two = with({"--json", "--diameter", "13", "17"});
  ASSERT_EQ(two.code, 0) << two.err;
  const auto said = nlohmann::json::parse(two.out);
  std::cout << said["truth"] << ' ' << said["links"] << '\n';
  EXPECT_EQ(said["truth"]["recall"], 1);
  EXPECT_EQ(said["truth"]["precision"], 1);
  EXPECT_EQ(said["truth"]["links"], 5900);
  EXPECT_EQ(said["truth"]["wrong_links"], 0);
  EXPECT_LE(said["wrong_radius"], 10);
}

// The common profile, at the diameter of the rims, leaves out the ten tracers of the sixty beads.
TEST(Track, TracersThatAreLeftOutAreNoted) {
  const TemporaryFolder folder;
  const std::string six = TWINCELL_SOURCE_DIR "/data_samples/demo/six-layers/gamma-0.9";
  std::vector<std::string> words = {"track", six + ".tif", "--cell", six + ".toml", "-o", folder / "exp.h5"};
  const Ran plain = run_program(words);
  ASSERT_EQ(plain.code, 0) << plain.err;
  EXPECT_NE(plain.out.find("60 tracks"), std::string::npos) << plain.out;
  EXPECT_EQ(plain.err.find("paler discs"), std::string::npos) << plain.err;
  for (const char* word : {"--diameter", "12", "--refine", "profile", "--force"}) words.emplace_back(word);
  const Ran profile = run_program(words);
  ASSERT_EQ(profile.code, 0) << profile.err;
  EXPECT_NE(profile.err.find("paler discs in a frame were left out"), std::string::npos) << profile.err;
}

// A bubble on the window, as wide as a bead, above a bed that bounces.
TEST(Track, ADiscThatStandsStillInAMovingBedIsNamed) {
  const TemporaryFolder folder;
  const std::filesystem::path demo = TWINCELL_SOURCE_DIR "/data_samples/demo/gamma-1.6",
                              stack = folder / "stack";
  std::filesystem::create_directory(stack);
  for (const bool bubble : {false, true}) {
    for (int f = 0; f < 40; ++f) {
      const std::string name = fmt::format("frame_{:05}.png", f);
      cv::Mat frame = read_picture(demo / name);
      if (bubble) {
        cv::circle(frame, {80, 30}, 6, 20, -1, cv::LINE_AA);
        cv::GaussianBlur(frame(cv::Rect(65, 15, 31, 31)), frame(cv::Rect(65, 15, 31, 31)), {0, 0}, 0.7);
      }
      write_picture(stack / name, frame);
    }
    const Ran ran = run_program(
        {"track", stack, "-o", folder / "t.h5", "--cell", demo / "CELL.toml", "--force", "--json"});
    ASSERT_EQ(ran.code, 0) << ran.err;
    const std::string said = "one disc stands still in a bed that moves, at x, y = (80.0, 30.0) px";
    EXPECT_EQ(ran.err.find(said) != std::string::npos, bubble) << ran.err;
    EXPECT_EQ(nlohmann::json::parse(ran.out)["tracks"], bubble ? 101 : 100);
  }
}

// Without the frames per cycle a film has no phases; the note says what gives them.
TEST(Track, WithoutFramesPerCycleItIsSaidWhatGivesPhases) {
  const TemporaryFolder folder;
  const std::string demo = TWINCELL_SOURCE_DIR "/data_samples/demo/gamma-1.6";
  const auto said = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = {"track", demo, "-o", folder / "t.h5", "--force", "--frames", "0:20"};
    words.insert(words.end(), more.begin(), more.end());
    const Ran ran = run_program(words);
    EXPECT_EQ(ran.code, 0) << ran.err;
    return ran.err;
  };
  const std::string missing = "the frames per cycle are not stated", none = "leaves out the phases",
                    drive = "the drive is not stated";
  const std::string plain = said({"--drive-gamma", "1.6", "--drive-amplitude", "1.6"});
  for (const std::string& word : {missing, std::string("--phase-lock N"), std::string("--phase-lock found"),
                                  std::string("calibrate plate --phases LIST.csv")})
    EXPECT_NE(plain.find(word), std::string::npos) << plain;
  const std::string chosen = said({"--phase-lock", "none"}), locked = said({"--phase-lock", "20"});
  EXPECT_NE(chosen.find(none), std::string::npos) << chosen;
  EXPECT_EQ(chosen.find(missing), std::string::npos) << chosen;
  EXPECT_NE(locked.find(drive), std::string::npos) << locked;
  EXPECT_EQ(said({"--cell", demo + "/CELL.toml"}).find("is absent"), std::string::npos);
}

// The first two cycles of a shipped film, whose plate is at row 186.2.
class DemoFilm : public ::testing::Test {
 protected:
  Ran track(std::vector<std::string> more) {
    std::vector<std::string> words = {"track", stack_, "-o", folder_ / "exp.h5", "--json"};
    words.insert(words.end(), more.begin(), more.end());
    std::filesystem::remove(folder_ / "exp.h5");
    return run_program(words);
  }
  const std::string stack_ = TWINCELL_SOURCE_DIR "/data_samples/demo/gamma-0.9",
                    cell_ = stack_ + "/CELL.toml";
  const TemporaryFolder folder_;
};

TEST_F(DemoFilm, TheStatedDriveIsThatOfTheChosenFrames) {
  const std::string per_second =
      "[camera]\npixels_per_sigma = 12\norigin_px = [20, 186.2]\nframes_per_cycle = "
      "20\nframe_rate_hz = 222.94\n[cell]\nwidth_sigma = 10\n[drive]\n"
      "amplitude_sigma = 0.9\nfrequency_hz = 11.147\n[scale]\nsigma_mm = 2\n"
      "gravity_m_s2 = 9.81\n";
  write(folder_ / "CELL.toml", per_second);
  for (const std::string& cell : std::vector<std::string>{cell_, folder_ / "CELL.toml"})
    for (const std::string frames : {":40:2", ":40:5", "7:40"}) {
      const Ran ran = track({"--cell", cell, "--frames", frames});
      ASSERT_EQ(ran.code, 0) << ran.err;
      const auto said = nlohmann::json::parse(ran.out);
      EXPECT_FALSE(said.contains("drive_disagreement")) << frames << ": " << said["drive_disagreement"];
      EXPECT_EQ(said["drive_check"]["by"], "plate") << said["drive_check"];
      EXPECT_NEAR(said["drive_check"]["amplitude"], 0.9, 0.002);
    }
}

// 2 % are no reason to refuse a cell, but 60 errors of the measured amplitude.
TEST_F(DemoFilm, AnAmplitudeManyErrorsAwayIsNoted) {
  for (const auto& [set, noted] : {std::pair{"drive.amplitude=0.9", false},
                                   {"drive.amplitude=0.903", false},
                                   {"drive.amplitude=0.92", true},
                                   {"drive.amplitude=0.885", true},
                                   {"camera.pixels_per_sigma=12.3", true}}) {
    const Ran ran = track({"--cell", cell_, "--set", set});
    ASSERT_EQ(ran.code, 0) << ran.err;
    EXPECT_EQ(ran.err.find("which is") != std::string::npos &&
                  ran.err.find("errors away: correct drive.amplitude") != std::string::npos,
              noted)
        << set << ": " << ran.err;
    EXPECT_EQ(ran.err.find("does not fit the film"), std::string::npos) << ran.err;
  }
}

// The beads of `locate`, written to a table and linked, are those of the film.
TEST_F(DemoFilm, ATableOfBeadsIsTrackedAsItsFilm) {
  // Four cycles, which the bed needs to confirm the phases.
  const std::string stack = TWINCELL_SOURCE_DIR "/data_samples/demo/gamma-1.6", cell = stack + "/CELL.toml",
                    table = folder_ / "beads.csv";
  ASSERT_EQ(run_program({"locate", stack, "-o", table, "-q"}).code, 0);
  const Ran film = run_program({"track", stack, "-o", folder_ / "film.h5", "--json", "--cell", cell});
  ASSERT_EQ(film.code, 0) << film.err;
  const auto of_table = [&](std::vector<std::string> more) {
    std::vector<std::string> words = {"track", table, "-o", folder_ / "exp.h5", "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return run_program(words);
  };
  const Ran linked = of_table({"--cell", cell});
  ASSERT_EQ(linked.code, 0) << linked.err;
  const auto a = nlohmann::json::parse(film.out), b = nlohmann::json::parse(linked.out);
  for (const char* same : {"frames", "beads_located", "tracks", "slots", "outside_cell", "links", "tracers"})
    EXPECT_EQ(a[same], b[same]) << same;
  EXPECT_EQ(b["phase_lock"]["checked_by"], "the bed");
  EXPECT_TRUE(validate_h5md(folder_ / "exp.h5").empty());
  const H5mdReader one(folder_ / "film.h5"), two(folder_ / "exp.h5");
  Frame p, q;
  for (std::size_t f = 0; f < one.n_frames(); ++f) {
    one.read(f, p), two.read(f, q);
    ASSERT_EQ(p.position.size(), q.position.size());
    EXPECT_EQ(p.plate_height, q.plate_height);
    for (std::size_t i = 0; i < p.position.size(); ++i) {
      EXPECT_LT((p.position[i] - q.position[i]).cwiseAbs().maxCoeff(),
                5e-5);  // the diameter is found, there stated
      EXPECT_NEAR(p.position_sigma[i].x(), q.position_sigma[i].x(), 2e-5);
    }
  }
  const Ran bright = of_table({"--bright"});
  EXPECT_EQ(bright.code, 2);
  EXPECT_NE(bright.err.find("beads.csv: --bright: says how the beads of frames are located"),
            std::string::npos);
  const Ran columns = track({"--columns", "frame=t"});
  EXPECT_EQ(columns.code, 2);
  EXPECT_NE(columns.err.find("--columns: applies to a table of located beads (.csv)"), std::string::npos);
}

TEST_F(DemoFilm, TheReportIsPrintedAsItIsStored) {
  const Ran ran = track({"--cell", cell_, "--frames", ":40"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const auto printed = nlohmann::json::parse(ran.out),
             stored = nlohmann::json::parse(H5mdReader(folder_ / "exp.h5").info().tracking_json);
  for (const char* member : {"camera", "drive_check", "links", "phase_lock", "tracers"})
    EXPECT_TRUE(stored.contains(member)) << member;
  for (const auto& [member, value] : stored.items())
    EXPECT_EQ(printed.value(member, nlohmann::json()), value) << member;
}

// Another program counts from 1 and gives nothing but positions.
TEST_F(DemoFilm, ATableOfAnotherProgram) {
  ASSERT_EQ(run_program({"locate", stack_, "--frames", ":40", "-o", folder_ / "beads.csv", "-q"}).code, 0);
  std::ifstream in(folder_ / "beads.csv");
  std::ofstream out(folder_ / "own.csv");
  out << "Y,X,t\n";
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::vector<std::string> fields;
    std::istringstream words(line);
    for (std::string word; std::getline(words, word, ',');) fields.push_back(word);
    out << fields[0] << ',' << fields[1] << ',' << std::stoi(fields[8]) + 1 << '\n';
  }
  out.close();
  const Ran ran =
      run_program({"track", folder_ / "own.csv", "-o", folder_ / "exp.h5", "--cell", cell_, "--columns",
                   "frame=t", "x=X", "y=Y", "--diameter", "12", "--first-phase", "19", "--json"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_NE(ran.err.find("own.csv has the number 1; its phase is 0, as frames count from 0"),
            std::string::npos)
      << ran.err;
  const auto said = nlohmann::json::parse(ran.out);
  EXPECT_EQ(said["tracks"], 100);
  EXPECT_EQ(said["links"]["made"], 3900);
  EXPECT_FALSE(H5mdReader(folder_ / "exp.h5").info().columns.position_sigma);
}

TEST_F(DemoFilm, AWrongOriginIsNoticed) {
  const Ran above = track({"--cell", cell_, "--frames", ":20", "--set", "camera.origin_px=[20, 20]"});
  EXPECT_EQ(above.code, 2);
  EXPECT_NE(above.err.find("camera.origin_px: is 20, 20, but none of the 2000 located beads lies inside"),
            std::string::npos)
      << above.err;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "exp.h5"));
  for (const std::string row : {"216", "156"}) {
    const Ran ran =
        track({"--cell", cell_, "--frames", ":40", "--set", "camera.origin_px=[20, " + row + "]"});
    EXPECT_NE(ran.err.find("the plate in the frames is at row 186.2, but camera.origin_px states row " + row),
              std::string::npos)
        << ran.err;
  }
}

TEST_F(DemoFilm, AScaleThatTheBeadsContradictIsRefused) {
  for (const std::string scale : {"24", "18", "16", "14", "9", "7"}) {
    const Ran ran = track({"--frames", ":10", "--pixels-per-sigma", scale});
    EXPECT_EQ(ran.code, 2) << ran.err;
    EXPECT_NE(ran.err.find("camera.pixels_per_sigma: is " + scale + ", but the beads in the frames are 12"),
              std::string::npos)
        << ran.err;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "exp.h5"));
  }
  for (const std::string scale : {"11.5", "12.5"})
    EXPECT_EQ(track({"--frames", ":10", "--pixels-per-sigma", scale}).code, 0) << scale;
  const Ran other = track({"--frames", ":10", "--pixels-per-sigma", "24", "--diameter", "12"});
  EXPECT_EQ(other.code, 0) << other.err;
  EXPECT_NE(other.err.find("a bead of one sigma is 24 px wide (camera.pixels_per_sigma), but the discs are "
                           "12 px wide: 0.5 sigma"),
            std::string::npos)
      << other.err;
}

TEST_F(DemoFilm, TheOriginIsTwoNumbers) {
  const Ran ran = track({"--frames", ":3", "--pixels-per-sigma", "12", "--origin-px", "20", "186.2"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(nlohmann::json::parse(ran.out)["camera"]["origin_px"], (std::vector<double>{20, 186.2}));
}

TEST_F(DemoFilm, ScoringNoBeadsIsRefused) {
  const Ran ran =
      track({"--frames", ":3", "--truth", stack_ + "/truth.csv", "--scored-rows", "9000", "9001"});
  EXPECT_EQ(ran.code, 3);
  EXPECT_NE(ran.err.find("has no bead in the frames and rows that are scored"), std::string::npos) << ran.err;
}

TEST(Track, RefusesBadPhaseLocks) {
  const TemporaryFolder folder;
  const std::string stack = TWINCELL_SOURCE_DIR "/data_samples/demo/gamma-0.9";
  for (const auto& [way, code] :
       {std::pair<std::string, int>{"sometimes", 2}, {"-3", 2}, {folder / "none.csv", 3}}) {
    const Ran ran = run_program({"track", stack, "-o", folder / "x.h5", "--phase-lock=" + way, "-q"});
    EXPECT_EQ(ran.code, code) << way << ": " << ran.err;
    EXPECT_FALSE(std::filesystem::exists(folder / "x.h5"));
  }
}

// A camera that writes digits into the picture: where the plate is dark, the inside of a 0 is a dark disc in
// a bright ring.
TEST(Track, DigitsInADarkPlateAreNoBeads) {
  namespace fs = std::filesystem;
  const TemporaryFolder folder;
  const fs::path demo = fs::path(TWINCELL_SOURCE_DIR) / "data_samples/demo/gamma-1.6",
                 stack = folder / "frames";
  fs::create_directory(stack);
  constexpr int kFrames = 60, kCycle = 20;
  for (int f = 0; f < kFrames; ++f) {
    const std::string name = fmt::format("frame_{:05}.png", f);
    cv::Mat frame = read_picture(demo / name);
    // The plate's edge is at row 230.8 - 19.2 sin(2 pi f/20): here it is above the digit by 7 px or more.
    if (const int phase = f % kCycle; phase >= 3 && phase <= 7) {
      cv::circle(frame, {60, 231}, 8, cv::Scalar(200), cv::FILLED, cv::LINE_AA);
      cv::circle(frame, {60, 231}, 6, cv::Scalar(5), cv::FILLED, cv::LINE_AA);
    }
    write_picture(stack / name, frame);
  }
  const Ran ran =
      run_program({"track", stack, "--cell", demo / "CELL.toml", "-o", folder / "exp.h5", "--json"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const auto said = nlohmann::json::parse(ran.out);
  const int digits = said["tracks"].get<int>() - said["slots"].get<int>();
  EXPECT_GE(digits, 3);  // one or more in each cycle
  EXPECT_NE(ran.err.find(fmt::format(
                "{} tracks inside the plate are left out: marks, text or false discs, not beads.", digits)),
            std::string::npos)
      << ran.err;
  EXPECT_EQ(ran.err.find("beneath the plate"), std::string::npos) << ran.err;
  EXPECT_EQ(said["slots"], 100);
}

}  // namespace twincell::track_test
