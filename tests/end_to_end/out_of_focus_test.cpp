// Beads out of focus at walls and plate, filmed by the synthetic camera.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/program.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell::out_of_focus_test {
namespace {

// A blur of a fifth of the radius: the edges of walls and plate darken the pixels beside them, where beads
// touch. With these pixels in the fit the error was 0.012 px, three times the stated one at the side walls.
TEST(OutOfFocus, BeadsAtWallsAreAsGoodAsTheOthers) {
  const TemporaryFolder folder;
  const auto at = [&](const char* name) { return (folder / name).string(); };
  std::ofstream(at("s.toml"))
      << "preset = \"fortini-huang-2015\"\n[cell]\nwidth = 10.0\n[beads]\ncount = 60\n"
         "[drive]\ngamma = 2.2\n[time]\ncycles = 1\ndiscard = 2\nphases = 20\n";
  ASSERT_EQ(run_program({"simulate", at("s.toml"), "-o", at("s.h5"), "-q"}).code, 0);
  ASSERT_EQ(
      run_program({"render", at("s.h5"), "-o", at("film"), "--blur", "1.5", "--pixels-per-sigma", "15", "-q"})
          .code,
      0);
  const Ran located =
      run_program({"locate", at("film"), "-o", at("beads.csv"), "--truth", at("film/truth.csv"), "--json"});
  ASSERT_EQ(located.code, 0) << located.err;
  const nlohmann::json truth = nlohmann::json::parse(located.out)["truth"];
  EXPECT_EQ(truth["recall"], 1);
  EXPECT_EQ(truth["precision"], 1);
  EXPECT_GT(truth["rms_px"], 0.004);
  EXPECT_LT(truth["rms_px"], 0.008);
}

}  // namespace
}  // namespace twincell::out_of_focus_test
