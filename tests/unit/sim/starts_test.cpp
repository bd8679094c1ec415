// The table of starts: every row works.
#include "sim/scene/starts.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "core/error.hpp"
#include "sim/scene/read_scene.hpp"
#include "sim/start/start.hpp"
#include "tests/support/complaint.hpp"

namespace twincell::sim::starts_test {
namespace {

Scene scene_with(const StartRow& start, const std::string& more = "") {
  return read_scene_text("preset = \"fortini-huang-2015\"\nbeads.count = 40\ndrive.gamma = 1.0\n" + more +
                             fmt::format("[start]\nkind = \"{}\"\n", start.word) +
                             (start.from_file ? "from = \"beads.csv\"\n" : ""),
                         "scene.toml");
}

TEST(Starts, EveryWordSelectsItsRow) {
  std::set<std::string_view> words;
  for (const StartRow& start : kStarts) {
    EXPECT_TRUE(words.insert(start.word).second) << start.word;
    EXPECT_EQ(scene_with(start).start, start.value) << start.word;
    EXPECT_EQ(conditions_of(scene_with(start), 40).start, start.word);
    if (start.from_file) continue;
    EXPECT_EQ(make_start(scene_with(start)).beads.size(), 40U) << start.word;
  }
}

TEST(Starts, KeysOfAnotherStartAreRefusedWithTheStartsThatReadThem) {
  const auto read = [](const std::string& kind, const std::string& key) {
    (void)read_scene_text(
        "preset = \"fortini-huang-2015\"\nbeads.count = 40\ndrive.gamma = 1.0\n[start]\n"
        "kind = \"" +
            kind + "\"\n" + key + "\n",
        "scene.toml");
  };
  expect_refusal<ConfigError>([&] { read("random", "from = \"a.csv\""); }, "start.from",
                              "start.kind is not \"trajectory\" or \"table\"");
  expect_refusal<ConfigError>([&] { read("table", "from = \"a.csv\"\nframe = 3"); }, "start.frame",
                              "start.kind is not \"trajectory\"");
  expect_refusal<ConfigError>([&] { read("crystal_b", "velocity_scale = 2.0"); }, "start.velocity_scale",
                              "start.kind is not \"random\"");
  expect_refusal<ConfigError>([&] { read("table", "frame = 0"); }, "start.from", "a start from a table");
  expect_refusal<ConfigError>([&] { read("cystal_a", ""); }, "start.kind", "crystal_a");
}

// Gamma refers to the gravity of the scene; without gravity there is none.
TEST(Starts, ConditionsFollowTheScene) {
  const StartRow& crystal = kStarts.front();
  const RunConditions at = conditions_of(scene_with(crystal, "cell.width = 8.0\n"), 40);
  EXPECT_DOUBLE_EQ(at.n_l.value(), 5);
  EXPECT_DOUBLE_EQ(at.gamma.value(), 1);
  EXPECT_FALSE(conditions_of(scene_with(crystal), {}).n_l);
  const Scene weak = read_scene_text(
      "preset = \"fortini-huang-2015\"\nbeads.count = 40\ncell.gravity = 0.5\n[drive]\namplitude = "
      "1.0\nomega = 2.0\n",
      "scene.toml");
  EXPECT_DOUBLE_EQ(conditions_of(weak, 40).gamma.value(), 8);  // A omega^2/g = 1 * 4/0.5
}

}  // namespace
}  // namespace twincell::sim::starts_test
