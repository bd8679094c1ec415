// A stack that lost frames: the stated frames per cycle are checked against the plate, in `track`, `match`
// and `calibrate plate`, so that no later phase is wrong without a word.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "tests/support/program.hpp"

namespace twincell {
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

}  // namespace twincell
