// Resources of a run: the estimate against the memory that kernels use, and the refusals.

#include <gtest/gtest.h>

#include "core/error.hpp"
#include "sim/run/cost.hpp"
#include "sim/scene/resource_demand.hpp"
#include "tests/support/complaint.hpp"
#include "tests/support/program.hpp"
#include "tests/support/put_file.hpp"
#include "tests/support/sanitized.hpp"

namespace twincell::sim {
namespace {

const std::string kScene =
    "preset = \"fortini-huang-2015\"\n[drive]\ngamma = 1.8\n[time]\ncycles = 100\nphases = 20\n";

TEST(ResourceDemand, LiesAboveWhatTheKernelHoldsAndNotFarAbove) {
  const std::vector<std::string> scenes = {
      "[cell]\nwidth = 100\n[beads]\nlayers = 50\n",
      "[cell]\nwidth = 100\n[beads]\nlayers = 50\nspread = "
      "\"uniform\"\nspread_width = 0.1\n",
      "[cell]\nwidth = 30\ndimension = 3\ndepth = 30\n[beads]\nlayers = 10\n",
      "[cell]\nwidth = 30\ndimension = 3\ndepth = 30\n[beads]\nlayers = 10\nspread = \"uniform\"\n"
      "spread_width = 0.1\n"};
  for (const std::string& words : scenes) {
    const Scene scene = read_scene_text(kScene + words, "scene.toml");
    const Cost cost = measure_cost(scene, 0.05, 1);
    const double held =
        static_cast<double>(cost.beads) * (cost.bytes_per_bead + cost.pairs_per_bead * cost.bytes_per_pair);
    const ResourceDemand demand = resource_demand(scene, cost.plan, cost.beads);
    EXPECT_GT(demand.memory, held) << words;
    EXPECT_LT(demand.memory, 4 * held) << words;
  }
}

TEST(ResourceDemand, MoreThanTheMachineHasIsRefusedByKey) {
  const Scene layers = read_scene_text(kScene + "[cell]\nwidth = 100\n[beads]\nlayers = 50\n", "scene.toml");
  const Plan plan = make_plan(layers);
  EXPECT_NO_THROW(require_memory(layers, plan, 5000, 5000 * 746));
  expect_refusal<ConfigError>([&] { require_memory(layers, plan, 5000, 5000 * 746 - 1); }, "scene.toml:10",
                              "beads.layers", "5000 beads", "3.73 MB");
  const Scene count = read_scene_text(kScene + "[beads]\ncount = 5000\n", "scene.toml");
  expect_refusal<ConfigError>([&] { require_memory(count, plan, 5000, 1e6); }, "scene.toml:8", "beads.count",
                              "the machine has 1 MB");
}

// Under a shell limit, as a batch system sets one: the run is refused before a bead is placed.
TEST(ResourceDemand, TheProgramRefusesWhatItsLimitDoesNotAllow) {
  if (kSanitized) GTEST_SKIP() << "A sanitized program cannot start within a limit of memory.";
  const TemporaryFolder folder;
  const std::string scene = folder / "s.toml", err = folder / "err";
  put_file(scene, kScene + "[cell]\nwidth = 10000\n[beads]\nlayers = 900\n");
  for (const std::string verb : {"explain", "simulate"}) {
    const std::string out = verb == "simulate" ? " -o " + std::string(folder / "o.h5") : "";
    const std::string line = "ulimit -v 4000000; '" + std::string(TWINCELL_PROGRAM) + "' " + verb + " '" +
                             scene + "'" + out + " --set time.cycles=1 > /dev/null 2> '" + err + "'";
    const int status = std::system(line.c_str());  // NOLINT: a fixed command of a test
    EXPECT_EQ(WEXITSTATUS(status), 2) << verb;
    std::ifstream said(err);
    const std::string text(std::istreambuf_iterator<char>(said), {});
    EXPECT_NE(text.find("beads.layers: requests 9000000 beads"), std::string::npos) << text;
  }
}

TEST(ResourceDemand, MoreThanTheDiskHasIsRefusedByKey) {
  const TemporaryFolder folder;
  const std::string scene = folder / "s.toml";
  put_file(scene, kScene + "[beads]\ncount = 100000\n[cell]\nwidth = 1000\n");
  const Ran ran = run_program({"simulate", scene, "-o", folder / "o.h5", "--set", "time.cycles=100000000",
                               "--set", "time.phases=1000"});
  EXPECT_EQ(ran.code, 2);
  for (const char* word : {"time.cycles", "100000000 cycles of 1000 frames of 100000 beads", "PB", "free"})
    EXPECT_NE(ran.err.find(word), std::string::npos) << ran.err;
}

}  // namespace
}  // namespace twincell::sim
