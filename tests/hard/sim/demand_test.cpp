// Resources of a run: the estimate against the memory that kernels use, and the refusals.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include "core/error.hpp"
#include "sim/scene/make_plan.hpp"
#include "sim/scene/read_scene.hpp"
#include "sim/scene/resource_demand.hpp"
#include "tests/support/complaint.hpp"
#include "tests/support/program.hpp"
#include "tests/support/put_file.hpp"
#include "tests/support/sanitized.hpp"

namespace twincell::sim::demand_test {
namespace {

const std::string kScene =
    "preset = \"fortini-huang-2015\"\n[drive]\ngamma = 1.3\nfrequency = 0.7\n[time]\ncycles = 1\nphases = "
    "1\ndiscard = 0\n";

/// Peak of the resident memory of `simulate`, in bytes.
double peak_of(const std::string& scene, const std::string& output) {
  const RunningProgram program({"simulate", scene, "-o", output, "--force", "-q"});
  rusage usage{};
  int status = 0;
  ::wait4(program.id(), &status, 0, &usage);
  EXPECT_EQ(status, 0) << scene;
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

// The program and its libraries take the same memory in a small and in a large bed, so that the difference of
// the peaks is that of the beads.
TEST(ResourceDemand, LiesAboveThePeakOfTheProgramAndNotFarAbove) {
  if (kSanitized) GTEST_SKIP() << "A sanitized program needs more memory.";
  const TemporaryFolder folder;
  const std::string file = folder / "s.toml";
  for (const bool flat : {true, false})
    for (const bool unlike : {false, true}) {
      double beads[2], peak[2], expected[2];
      for (const int large : {0, 1}) {
        const std::string text = fmt::format(
            "{}[start]\nsettle_limit = 0.3\n[contact]\nk_n = 1e4\nk_t = 5e3\n[cell]\n{}[beads]\n"
            "layers = {}\n{}",
            kScene, flat ? "width = 100\n" : "width = 30\ndimension = 3\ndepth = 30\n",
            flat ? (large ? 120 : 20) : (large ? 18 : 3),
            unlike ? "spread = \"uniform\"\nspread_width = 0.1\n" : "");
        put_file(file, text);
        const Scene scene = read_scene_text(text, file);
        beads[large] = static_cast<double>(scene.n_beads.value_or(0));
        expected[large] = resource_demand(scene, make_plan(scene), scene.n_beads.value_or(0)).memory;
        peak[large] = peak_of(file, folder / "o.h5");
      }
      const double per_bead = (peak[1] - peak[0]) / (beads[1] - beads[0]);
      RecordProperty(fmt::format("{}D{}", flat ? 2 : 3, unlike ? "_unlike" : ""), per_bead);
      EXPECT_LT(per_bead, expected[1] / beads[1]) << flat << unlike;
      EXPECT_GT(per_bead, 0.2 * expected[1] / beads[1]) << flat << unlike;
    }
}

TEST(ResourceDemand, MoreThanTheMachineHasIsRefusedByKey) {
  const Scene layers = read_scene_text(kScene + "[cell]\nwidth = 100\n[beads]\nlayers = 50\n", "scene.toml");
  const Plan plan = make_plan(layers);
  EXPECT_NO_THROW(require_memory(layers, plan, 5000, 5000 * 3000));
  expect_refusal<ConfigError>([&] { require_memory(layers, plan, 5000, 5000 * 3000 - 1); }, "scene.toml:12",
                              "beads.layers", "5000 beads", "15 MB");
  const Scene count = read_scene_text(kScene + "[beads]\ncount = 5000\n", "scene.toml");
  expect_refusal<ConfigError>([&] { require_memory(count, plan, 5000, 1e6); }, "scene.toml:10", "beads.count",
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
}  // namespace twincell::sim::demand_test
