#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "sweep/farm.hpp"
#include "sweep/store.hpp"
#include "tests/support/complaint.hpp"
#include "tests/support/put_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell::sweep::sweep_store_test {
namespace {

constexpr const char* kResult = R"({"id":"a","results":{"s_b":{"value":0.25}},"computed":{"seconds":1.5}})";

Point point() {
  Point p;
  p.id.push_back('a');
  return p;
}

TEST(SweepStore, ResultIsCheckedAgainstItsChecksum) {
  const TemporaryFolder folder;
  const Store store(folder / "sweep");
  ASSERT_TRUE(store.claim(point()));
  store.keep(point(), kResult);
  const auto kept = store.result(point());
  ASSERT_TRUE(kept);
  auto document = nlohmann::json::parse(*kept);
  EXPECT_EQ(document["results"]["s_b"]["value"], 0.25);
  EXPECT_EQ(document["sha256"].get<std::string>().size(), 64U);

  const std::filesystem::path file = store.of(point()) / "result.json";
  document["results"]["s_b"]["value"] = 0.26;
  put_file(file, document.dump());
  EXPECT_THROW((void)store.result(point()), InputError);
  for (const char* damaged :
       {R"({"id":"a"})", R"({"id":7})", R"({"id":"a","results":3,"computed":{}})", "[]", "",
        R"({"id":"b","results":{},"computed":{}})", R"({"id":"a","results":{},"computed":1})"}) {
    put_file(file, damaged);
    EXPECT_THROW((void)store.result(point()), InputError) << damaged;
  }
  // Written by a version without checksums.
  put_file(file, kResult);
  EXPECT_TRUE(store.result(point()));
}

TEST(SweepStore, OnlyASweepsFolderIsWrittenInto) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "thesis");
  put_file(folder / "thesis/a.tex", "mine");
  EXPECT_THROW(Store(folder / "thesis"), ConfigError);
  EXPECT_FALSE(std::filesystem::exists(folder / "thesis/points"));
  // A folder of that name is no sign of a sweep; a point in it is.
  std::filesystem::create_directory(folder / "thesis/points");
  EXPECT_THROW(Store(folder / "thesis"), ConfigError);
  EXPECT_FALSE(std::filesystem::exists(folder / "thesis/twincell-manifest.json"));
  std::filesystem::create_directories(folder / "former/points/a");
  put_file(folder / "former/points/a/point.json", "{}");
  EXPECT_NO_THROW(Store(folder / "former"));
  const Store first(folder / "sweep");
  EXPECT_NO_THROW(Store(folder / "sweep"));
  EXPECT_NO_THROW(Store(folder / "thesis", Store::Access::read));
}

// The first paper's beds take 3000 bytes per bead, so that the four points take 6, 6, 12 and 12 MB.
TEST(SweepMemory, PointsThatRunAtOnceMustFitTogether) {
  const TemporaryFolder folder;
  const std::string scene =
      "[scene]\npreset = \"fortini-huang-2015\"\ncell.width = 400.0\ntime.integrator = \"verlet\"\n";
  const Plan grid = read_plan_text(
      scene + "drive.gamma = 1.5\n[axes]\nbeads.count = [2000, 4000]\ndrive.start = [\"abrupt\", \"ramp\"]\n",
      "plan.toml");
  const Store store(folder / "grid");
  const Schedule schedule(grid, store);
  EXPECT_NO_THROW(require_memory_together(schedule, 1, "--threads", 12e6));
  EXPECT_NO_THROW(require_memory_together(schedule, 2, "--threads", 24e6));
  EXPECT_NO_THROW(require_memory_together(schedule, 16, "--threads", 36e6));
  expect_refusal<ConfigError>([&] { require_memory_together(schedule, 2, "--threads", 23.5e6); }, "plan.toml",
                              "beads.count", "4000 beads", "2 points that run at once", "24 MB",
                              "has 23.5 MB available", "with --threads 1");
  expect_refusal<ConfigError>([&] { require_memory_together(schedule, 16, "--threads", 35.5e6); },
                              "4 points that run at once", "with --threads 3");
  expect_refusal<ConfigError>([&] { require_memory_together(schedule, 2, "--threads", 11.5e6); },
                              "beads.count", "requires 4000 beads in one point", "12 MB");
  // Later rounds of a search may reach the ends of its range.
  const Plan search = read_plan_text(scene +
                                         "drive.gamma = 1.5\n[search]\nkey = \"beads.layers\"\nverdict = "
                                         "\"convecting\"\nrange = [1.0, 10.0]\n"
                                         "width = 1.0\nbatch = 3\n",
                                     "plan.toml");
  const Store searched(folder / "search");
  const Schedule rounds(search, searched);
  EXPECT_NO_THROW(require_memory_together(rounds, 3, "--threads", 36e6));
  expect_refusal<ConfigError>([&] { require_memory_together(rounds, 3, "--threads", 35.5e6); },
                              "beads.layers", "4000 beads", "with --threads 2");
}

TEST(SweepPlan, AValueIsNotNamedTwiceInOtherDigits) {
  for (const char* values : {"[1, 1.0]", "[1.5, 15e-1]", "[0.0, -0.0]"})
    expect_refusal<ConfigError>(
        [&] {
          (void)read_plan_text(
              "[scene]\npreset = \"fortini-huang-2015\"\n[axes]\nbeads.count = " + std::string(values) + "\n",
              "plan.toml");
        },
        "plan.toml:4:", "names a value twice");
}

}  // namespace
}  // namespace twincell::sweep::sweep_store_test
