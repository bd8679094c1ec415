// A stack that lost frames: the stated frames per cycle are checked against the plate, in `track`, `match`
// and `calibrate plate`, so that no later phase is wrong without a word.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "tests/support/program.hpp"

namespace twincell::lost_frames_test {
namespace {

namespace fs = std::filesystem;

const fs::path kDemo = fs::path(TWINCELL_SOURCE_DIR) / "data_samples/demo/gamma-1.6";

/// The shipped stack without some frames; those after them have smaller numbers, as a camera writes them.
fs::path stack_without(const TemporaryFolder& folder, const std::set<int>& lost) {
  const fs::path stack = folder.path() / ("lost_" + std::to_string(lost.empty() ? 0 : *lost.begin()));
  fs::create_directory(stack);
  int to = 0;
  for (int f = 0; f < 80; ++f) {
    if (lost.contains(f)) continue;
    fs::create_symlink(kDemo / fmt::format("frame_{:05}.png", f),
                       stack / fmt::format("frame_{:05}.png", to++));
  }
  return stack;
}

nlohmann::json s_b_of(const fs::path& trajectory) {
  const Ran ran = run_program({"analyze", trajectory, "--only", "s_b", "--json"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  return nlohmann::json::parse(ran.out)["results"]["s_b"];
}

}  // namespace

TEST(LostFrames, TrackPutsThePhasesRightAndSaysWhere) {
  const TemporaryFolder folder;
  const fs::path cell = kDemo / "CELL.toml";
  const auto track = [&](const fs::path& stack) {
    const fs::path to = stack.string() + ".h5";
    const Ran ran = run_program({"track", stack, "-o", to, "--cell", cell, "--json"});
    EXPECT_EQ(ran.code, 0) << ran.err;
    return std::pair{nlohmann::json::parse(ran.out), ran.err};
  };
  const auto [whole, whole_said] = track(stack_without(folder, {}));
  EXPECT_EQ(whole["phase_lock"]["checked_by"], "the plate");
  EXPECT_FALSE(whole["phase_lock"].contains("warning")) << whole["phase_lock"];
  const nlohmann::json full = s_b_of(whole["output"].get<std::string>());
  for (const std::set<int>& lost : {std::set<int>{30}, {24, 25, 26}, {45, 46}}) {
    const auto [document, said] = track(stack_without(folder, lost));
    const nlohmann::json lock = document["phase_lock"];
    EXPECT_EQ(lock["dropped"], lost.size());
    EXPECT_EQ(lock["dropped_before"], nlohmann::json::array({*lost.begin()}));
    EXPECT_NE(said.find(fmt::format("{} before frame {}", lost.size(), *lost.begin())), std::string::npos)
        << said;
    const nlohmann::json damaged = s_b_of(document["output"].get<std::string>());
    // Fewer whole cycles are left, and the cycles of a bouncing bed differ.
    const double value = full["value"];
    EXPECT_EQ(damaged["n"], 2);
    EXPECT_NEAR(damaged["value"].get<double>(), value, 0.1 * value) << *lost.begin();
  }
}

TEST(LostFrames, PhaseLockFoundReadsThePlate) {
  // A convecting bed, whose own cycles differ by two frames.
  const fs::path stack = kDemo.parent_path() / "gamma-2.8.tif";
  const TemporaryFolder folder;
  const Ran ran = run_program({"track", stack, "-o", folder.path() / "t.h5", "--cell",
                               kDemo.parent_path() / "gamma-2.8.toml", "--phase-lock", "found", "--json"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const nlohmann::json lock = nlohmann::json::parse(ran.out)["phase_lock"];
  EXPECT_EQ(lock["checked_by"], "the plate");
  EXPECT_EQ(lock["frames_per_cycle"], 40);
  EXPECT_EQ(lock["dropped"], 0);
  EXPECT_EQ(lock["doubled"], 0);
}

TEST(LostFrames, AFilmThatBeginsBeforeTheShakerIsAnalysedWhereItMoves) {
  const TemporaryFolder folder;
  const fs::path stack = folder.path() / "rest", cell = kDemo / "CELL.toml", list = folder.path() / "p.csv";
  fs::create_directory(stack);
  for (int f = 0; f < 120; ++f)
    fs::create_symlink(kDemo / fmt::format("frame_{:05}.png", std::max(0, f - 40)),
                       stack / fmt::format("frame_{:05}.png", f));
  const Ran calibrated = run_program({"calibrate", "plate", stack, "--cell", cell, "--phases", list});
  ASSERT_EQ(calibrated.code, 0) << calibrated.err;
  EXPECT_NE(calibrated.err.find("does not follow the drive in 40 of 120 frames (0 to 39)"), std::string::npos)
      << calibrated.err;
  const fs::path whole = folder.path() / "whole.h5", part = folder.path() / "part.h5";
  ASSERT_EQ(run_program({"track", kDemo, "-o", whole, "--cell", cell}).code, 0);
  const Ran tracked =
      run_program({"track", stack, "-o", part, "--cell", cell, "--phase-lock", list, "--json"});
  ASSERT_EQ(tracked.code, 0) << tracked.err;
  EXPECT_NE(tracked.err.find("40 of 120 frames (0 to 39)"), std::string::npos) << tracked.err;
  const nlohmann::json lock = nlohmann::json::parse(tracked.out)["phase_lock"];
  EXPECT_EQ(lock["dropped"], 0);
  EXPECT_EQ(lock["out_of_lock"], 40);
  const double value = s_b_of(whole)["value"];
  EXPECT_NEAR(s_b_of(part)["value"].get<double>(), value, 1e-3 * value);
  EXPECT_EQ(s_b_of(part)["n"], s_b_of(whole)["n"]);
}

TEST(LostFrames, APeriodThatIsNoWholeNumberOfFramesGivesTheSameBed) {
  const fs::path demo = kDemo.parent_path();
  const TemporaryFolder folder;
  // Every third of 40 frames per cycle: 13 1/3 frames per cycle, none missing.
  const fs::path whole = folder.path() / "whole.h5", part = folder.path() / "part.h5";
  const fs::path cell = demo / "gamma-2.8.toml";
  ASSERT_EQ(run_program({"track", demo / "gamma-2.8.tif", "-o", whole, "--cell", cell}).code, 0);
  const Ran ran = run_program({"track", demo / "gamma-2.8.tif", "-o", part, "--cell", cell, "--frames", "::3",
                               "--frames-per-cycle", "0", "--phase-lock", "found", "--json"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const nlohmann::json lock = nlohmann::json::parse(ran.out)["phase_lock"];
  EXPECT_EQ(lock["frames_per_cycle"], 13);
  EXPECT_EQ(lock["dropped"], 0);
  EXPECT_NEAR(lock["period_frames"].get<double>(), 40.0 / 3, 0.01);
  const double value = s_b_of(whole)["value"];
  EXPECT_NEAR(s_b_of(part)["value"].get<double>(), value, 0.02 * value);
}

TEST(LostFrames, AConversionOfTheFrameRateIsSeenAndUndone) {
  const TemporaryFolder folder;
  const fs::path stack = folder.path() / "converted", drafted = folder.path() / "c.toml",
                 list = folder.path() / "p.csv";
  fs::create_directory(stack);
  int to = 0;
  for (int f = 0; f < 80; ++f)
    for (int copy = 0; copy < (f % 5 == 4 ? 2 : 1); ++copy)
      fs::create_symlink(kDemo / fmt::format("frame_{:05}.png", f),
                         stack / fmt::format("frame_{:05}.png", to++));
  const std::string said = "16 of 96 frames equal the frame before them to the bit";
  const Ran surveyed = run_program({"new", stack, "-o", drafted, "--drive-gamma", "1.6", "--json"});
  ASSERT_EQ(surveyed.code, 0) << surveyed.err;
  EXPECT_EQ(nlohmann::json::parse(surveyed.out)["cells"][0]["frames_per_cycle"], 20) << surveyed.out;
  EXPECT_NE(surveyed.err.find(said), std::string::npos) << surveyed.err;
  const Ran described = run_program({"info", stack});
  EXPECT_NE(described.out.find(said), std::string::npos) << described.out << described.err;
  const fs::path beads = folder.path() / "beads.csv";
  const Ran located = run_program({"locate", stack, "-o", beads});
  EXPECT_NE(located.out.find(said), std::string::npos) << located.out << located.err;
  const Ran later = run_program({"locate", stack, "-o", beads, "--frames", "3:90", "--json"});
  ASSERT_EQ(later.code, 0) << later.err;
  EXPECT_NE(later.out.find("15 of 87 frames equal the frame before them to the bit, the first of them frame "
                           "5"),
            std::string::npos)
      << later.out;
  EXPECT_EQ(run_program({"info", kDemo}).out.find("to the bit"), std::string::npos);
  EXPECT_EQ(run_program({"locate", kDemo, "-o", beads, "--frames", "0:20"}).out.find("to the bit"),
            std::string::npos);
  const fs::path whole = folder.path() / "whole.h5", part = folder.path() / "part.h5";
  ASSERT_EQ(run_program({"track", kDemo, "-o", whole, "--cell", kDemo / "CELL.toml"}).code, 0);
  const double value = s_b_of(whole)["value"];
  ASSERT_EQ(run_program({"calibrate", "plate", stack, "--cell", drafted, "--phases", list}).code, 0);
  for (const std::string& lock : {std::string("20"), std::string("found"), list.string()}) {
    const Ran ran = run_program({"track", stack, "-o", part, "--cell", kDemo / "CELL.toml", "--phase-lock",
                                 lock, "--json", "--force"});
    ASSERT_EQ(ran.code, 0) << lock << ": " << ran.err;
    EXPECT_NE(ran.err.find(said), std::string::npos) << lock << ": " << ran.err;
    EXPECT_EQ(nlohmann::json::parse(ran.out)["phase_lock"]["doubled"], 16) << lock;
    EXPECT_NEAR(s_b_of(part)["value"].get<double>(), value, 1e-3 * value) << lock;
  }
  // The intact film, and one that begins at rest, raise no alarm.
  const Ran intact = run_program({"track", kDemo, "-o", part, "--cell", kDemo / "CELL.toml", "--force"});
  EXPECT_EQ(intact.err.find("to the bit"), std::string::npos) << intact.err;
}

TEST(LostFrames, CalibratePlateCountsThem) {
  const TemporaryFolder folder;
  const fs::path stack = stack_without(folder, {17, 40, 61});
  for (const bool known : {true, false}) {
    std::vector<std::string> words = {"calibrate", "plate", stack, "--json"};
    if (known) words.insert(words.end(), {"--cell", kDemo / "CELL.toml"});
    const Ran ran = run_program(words);
    ASSERT_EQ(ran.code, 0) << ran.err;
    const nlohmann::json d = nlohmann::json::parse(ran.out);
    EXPECT_EQ(d["frames"]["dropped"], 3);
    EXPECT_EQ(d["frames"]["doubled"], 0);
    EXPECT_LT(d["plate"]["rms_residual_px"].get<double>(), 0.05);
    EXPECT_NEAR(d["measured"]["camera.period"]["value"].get<double>(), 20, 0.002);
    EXPECT_FALSE(d["measured"].contains("camera.jitter")) << d["measured"];
  }
}

TEST(LostFrames, AWrongNumberOfFramesPerCycleIsRefused) {
  const TemporaryFolder folder;
  const fs::path cell = kDemo / "CELL.toml", to = folder.path() / "t.h5";
  const std::vector<std::string> words = {"track", kDemo, "-o", to, "--cell", cell, "--phase-lock", "24"};
  const Ran refused = run_program(words);
  EXPECT_EQ(refused.code, 2) << refused.err;
  EXPECT_NE(refused.err.find("repeats itself after 20"), std::string::npos) << refused.err;
  EXPECT_NE(refused.err.find("--phase-lock found"), std::string::npos) << refused.err;
  EXPECT_FALSE(fs::exists(to));
}

}  // namespace twincell::lost_frames_test
