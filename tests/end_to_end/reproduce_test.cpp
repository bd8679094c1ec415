// `reproduce` says at any budget what it wanted, what it measured, and what was cheaper.

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/support/program.hpp"

namespace twincell {
namespace {

namespace fs = std::filesystem;

TEST(Reproduce, ASmallBudgetEndsInTimeAndNamesEveryTarget) {
  const TemporaryFolder folder;
  const std::string out = folder / "fig3";
  const auto begin = std::chrono::steady_clock::now();
  const Ran ran =
      run_program({"reproduce", "p1-fig3", "--budget", "0.02", "--json", "-q", "--threads", "1", "-o", out});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_LT(std::chrono::steady_clock::now() - begin,
            std::chrono::minutes(4));  // the point that was begun is finished
  const auto document = nlohmann::json::parse(ran.out);
  EXPECT_FALSE(document["complete"]);
  int bouncing = 0, slips = 0;
  for (const auto& target : document["targets"]) {
    const std::string name = target["name"], verdict = target["verdict"];
    bouncing += name.find("onset of bouncing, ") == 0 ? 1 : 0;
    slips += name.find("slips") == 0 ? 1 : 0;
    EXPECT_TRUE(verdict == "met" || verdict == "MISSED" || verdict == "open" || verdict == "absent")
        << verdict;
    EXPECT_FALSE(target["wanted"].get<std::string>().empty());
    if (target["measured"].get<std::string>().empty()) {
      EXPECT_EQ(verdict, "absent") << name;
    }
  }
  EXPECT_EQ(bouncing, 2);
  EXPECT_EQ(slips, 1);
  EXPECT_FALSE(document["cheaper"].empty());
  for (const char* name : {"p1-fig3.svg", "p1-fig3.gp", "p1-fig3.dat", "p1-fig3.json", "p1-fig3.txt"})
    EXPECT_TRUE(fs::exists(fs::path(out) / name)) << name;
}

TEST(Reproduce, AnUnknownNameListsTheKnown) {
  const Ran ran = run_program({"reproduce", "p1-fig9"});
  EXPECT_EQ(ran.code, 2);
  EXPECT_NE(ran.err.find("p1-fig3"), std::string::npos) << ran.err;
}

}  // namespace
}  // namespace twincell
