// At any budget, `reproduce` reports the expected value, the measured value, and where it used cheaper
// settings.

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/program.hpp"

namespace twincell::reproduce_test {
namespace {

namespace fs = std::filesystem;

bool is_verdict(const std::string& word) {
  return word == "pass" || word == "consistent" || word == "fail" || word == "inconclusive" ||
         word == "absent";
}

TEST(Reproduce, ASmallBudgetEndsInTimeAndNamesEveryTarget) {
  const TemporaryFolder folder;
  const std::string out = folder / "fig3";
  std::ofstream(folder / "own.csv") << "N_l,bouncing,convection\n60,1.2,2.9\n20,1.15,2.1\n40,1.18,\n";
  const Ran ran = run_program({"reproduce", "p1-fig3", "--budget", "0.02", "--json", "-q", "--threads", "1",
                               "-o", out, "--data", folder / "own.csv"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_LT(ran.cpu_s, 240);  // budget 1.2 s; a point that has started is completed
  const auto document = nlohmann::json::parse(ran.out);
  EXPECT_FALSE(document["complete"]);
  int bouncing = 0, slips = 0;
  for (const auto& target : document["targets"]) {
    const std::string name = target["name"], verdict = target["verdict"];
    bouncing += name.find("onset of bouncing, ") == 0 ? 1 : 0;
    slips += name.find("slips") == 0 ? 1 : 0;
    EXPECT_TRUE(is_verdict(verdict)) << verdict;
    EXPECT_FALSE(target["expected"].get<std::string>().empty());
    if (target["measured"].get<std::string>().empty()) {
      EXPECT_EQ(verdict, "absent") << name;
    }
  }
  EXPECT_EQ(bouncing, 2);
  EXPECT_EQ(slips, 1);
  EXPECT_FALSE(document["cheaper"].empty());
  for (const char* name : {"p1-fig3.svg", "p1-fig3.gp", "p1-fig3.dat", "p1-fig3.json", "p1-fig3.txt"})
    EXPECT_TRUE(fs::exists(fs::path(out) / name)) << name;
  // The onsets of the experiment, by height; an empty field is not a point.
  std::ostringstream data;
  data << std::ifstream(fs::path(out) / "p1-fig3.dat").rdbuf();
  EXPECT_NE(data.str().find("# convection, experiment\n20 2.1\n60 2.9\n"), std::string::npos) << data.str();
  EXPECT_NE(data.str().find("# bouncing, experiment\n20 1.15\n40 1.18\n60 1.2\n"), std::string::npos);
}

TEST(Reproduce, AnExperimentsTableNeedsItsColumns) {
  const TemporaryFolder folder;
  std::ofstream(folder / "bad.csv") << "N_l,gamma\n60,1.2\n";
  const Ran bad =
      run_program({"reproduce", "p1-fig3", "-q", "-o", folder / "bad", "--data", folder / "bad.csv"});
  EXPECT_EQ(bad.code, 2);
  EXPECT_NE(bad.err.find("bouncing"), std::string::npos) << bad.err;
}

TEST(Reproduce, AnExperimentsNumbersAreAboveZero) {
  const TemporaryFolder folder;
  struct Case {
    const char *name, *table, *said;
  };
  for (const auto& [name, table, said] :
       {Case{"p1-fig3", "N_l,bouncing,convection\n20,1.2,2\n60,-1.2,2.9\n", "bouncing: row 2 is -1.2"},
        Case{"p1-fig3", "N_l,bouncing,convection\n,1.2,2.9\n", "N_l: row 1 has no number"},
        Case{"p2-fig2", "W,T_bar_z\n3,0\n", "T_bar_z: row 1 is 0"},
        Case{"p2-table1", "W,T_bar_z\n-3,0.7\n", "W: row 1 is -3"}}) {
    std::ofstream(folder / "own.csv") << table;
    const Ran ran = run_program(
        {"reproduce", name, "-q", "--budget", "0.001", "-o", folder / "out", "--data", folder / "own.csv"});
    EXPECT_EQ(ran.code, 3) << ran.err;
    EXPECT_NE(ran.err.find(said), std::string::npos) << ran.err;
  }
}

/// Runs one name with the smallest budget and checks the properties common to all.
nlohmann::json reproduced(const std::string& name, const std::string& out,
                          const std::vector<std::string>& figures) {
  const Ran ran =
      run_program({"reproduce", name, "--budget", "0.01", "--json", "-q", "--threads", "1", "-o", out});
  EXPECT_EQ(ran.code, 0) << ran.err;
  if (ran.code != 0) return {};
  const auto document = nlohmann::json::parse(ran.out);
  EXPECT_FALSE(document["targets"].empty());
  for (const auto& target : document["targets"]) {
    const std::string verdict = target["verdict"];
    EXPECT_TRUE(is_verdict(verdict)) << verdict;
    EXPECT_FALSE(target["expected"].get<std::string>().empty());
    EXPECT_TRUE(verdict == "absent" || !target["measured"].get<std::string>().empty()) << target["name"];
  }
  EXPECT_NE(document["conditions"].dump().find("k_n = 1e+06"), std::string::npos);
  EXPECT_NE(document["conditions"].dump().find("slip rule"), std::string::npos);
  EXPECT_FALSE(document["measured"].empty());
  for (const std::string& figure : figures)
    for (const char* ending : {".svg", ".png", ".gp", ".dat"})
      EXPECT_TRUE(fs::exists(fs::path(out) / (figure + ending))) << figure << ending;
  for (const char* ending : {".json", ".txt"}) EXPECT_TRUE(fs::exists(fs::path(out) / (name + ending)));
  return document;
}

/// The target whose name begins with this text.
nlohmann::json target_of(const nlohmann::json& document, const std::string& name) {
  for (const auto& target : document["targets"])
    if (target["name"].get<std::string>().find(name) == 0) return target;
  ADD_FAILURE() << "no target '" << name << "'";
  return {};
}

TEST(Reproduce, TableOneHoldsWhatThePaperPrints) {
  const TemporaryFolder folder;
  const auto document = reproduced("p1-table1", folder / "t", {});
  for (const auto& target : document["targets"]) EXPECT_EQ(target["verdict"], "pass") << target["name"];
  EXPECT_EQ(target_of(document, "tangential stiffness, bead-wall")["measured"], "10000");
  EXPECT_EQ(target_of(document, "static friction, bead-bead")["measured"], "0.6");
}

TEST(Reproduce, TheAppendixMeetsItsClosedForms) {
  const TemporaryFolder folder;
  const auto document =
      reproduced("p1-appendix", folder / "a", {"p1-appendix-a", "p1-appendix-b", "p1-fig6"});
  for (const auto& target : document["targets"]) EXPECT_EQ(target["verdict"], "pass") << target["name"];
  EXPECT_EQ(target_of(document, "bead-wall, e_n by eq. A5")["measured"], "0.854468");
  EXPECT_EQ(target_of(document, "steps a period at n = 50")["measured"], "141333");
}

TEST(Reproduce, WhatTheStepDoesIsSaidForEveryQuantityAndStart) {
  const TemporaryFolder folder;
  const auto document = reproduced("p1-step", folder / "s", {"p1-step"});
  EXPECT_FALSE(document["complete"]);
  for (const char* quantity : {"T_g", "p_s", "s_b", "s_c"})
    for (const char* start : {"crystal", "random"})
      EXPECT_EQ(target_of(document, std::string(quantity) + " of " + start + " beds")["expected"]
                    .get<std::string>()
                    .find("that of split, n = 6.37, within 2 %"),
                0U);
}

TEST(Reproduce, InitialBedsAndTheirOrientations) {
  const TemporaryFolder folder;
  const auto beds = reproduced("p1-fig1", folder / "one", {"p1-fig1"});
  EXPECT_EQ(target_of(beds, "q6 inside the crystal")["verdict"], "pass");
  // The same beds again, with the second crystal, for which the first call had no time left.
  const auto again = reproduced("p1-fig2", folder / "two", {"p1-fig2"});
  EXPECT_EQ(target_of(again, "close-packed rows of the crystal in orientation A")["verdict"], "pass");
  EXPECT_TRUE(fs::exists(fs::path(folder / "p1-packings") / "points"));
}

TEST(Reproduce, TemperatureAndSlipsShareTheirRuns) {
  const TemporaryFolder folder;
  const auto fig4 = reproduced("p1-fig4", folder / "four", {"p1-fig4"});
  EXPECT_FALSE(fig4["complete"]);
  const auto fig5 = reproduced("p1-fig5", folder / "five", {"p1-fig5"});
  const auto points = [](const nlohmann::json& document) {
    std::size_t n = 0;
    for (const auto& sweep : document["measured"]) n += sweep["points"].size();
    return n;
  };
  EXPECT_GE(points(fig4), 1U);
  EXPECT_GT(points(fig5), points(fig4));  // it reused the points of Fig. 4 and had time for another
}

// The budget and the threads decide what is run, not what is read.
TEST(Reproduce, EveryStoredSettingIsJudgedOnOneThread) {
  const TemporaryFolder folder;
  const std::string stored = TWINCELL_SOURCE_DIR "/docs/reproduce/p2-fig6.json";
  const Ran again = run_program(
      {"reproduce", "p2-fig6", "--stored", stored, "--json", "-q", "--threads", "1", "-o", folder / "r"});
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(nlohmann::json::parse(again.out)["targets"].size(),
            nlohmann::json::parse(std::ifstream(stored))["targets"].size());
}

TEST(Reproduce, StoredRunsAreJudgedAgainWithoutASimulation) {
  const TemporaryFolder folder;
  const auto fig4 = reproduced("p1-fig4", folder / "four", {"p1-fig4"});
  const std::string stored = (fs::path(folder / "four") / "p1-fig4.json").string();
  const Ran again =
      run_program({"reproduce", "p1-fig4", "--stored", stored, "--json", "-q", "-o", folder / "again"});
  ASSERT_EQ(again.code, 0) << again.err;
  const auto document = nlohmann::json::parse(again.out);
  EXPECT_EQ(document["targets"], fig4["targets"]);
  EXPECT_EQ(document["measured"], fig4["measured"]);
  EXPECT_EQ(document["conditions"], fig4["conditions"]);
  // A document of another figure, a file that is no document, and a figure that cannot be judged again.
  EXPECT_EQ(run_program({"reproduce", "p2-fig2", "--stored", stored, "-q", "-o", folder / "x"}).code, 3);
  std::ofstream(folder / "bad.json") << "[1, 2";
  const Ran bad =
      run_program({"reproduce", "p1-fig4", "--stored", folder / "bad.json", "-q", "-o", folder / "y"});
  EXPECT_EQ(bad.code, 3) << bad.err;
  EXPECT_NE(bad.err.find("bad.json"), std::string::npos) << bad.err;
  EXPECT_EQ(run_program({"reproduce", "p1-table1", "--stored", stored, "-q", "-o", folder / "z"}).code, 2);
  // A key of another type is named.
  for (const char* key : {"conditions", "cheaper", "complete", "runs", "core_minutes"}) {
    nlohmann::json other = fig4;
    other[key] = {{"a", 1}};
    std::ofstream(folder / "other.json") << other.dump();
    const Ran named =
        run_program({"reproduce", "p1-fig4", "--stored", folder / "other.json", "-q", "-o", folder / "w"});
    EXPECT_EQ(named.code, 3) << key << ": " << named.err;
    EXPECT_NE(named.err.find(std::string("other.json: ") + key + ": "), std::string::npos) << named.err;
  }
}

TEST(Reproduce, AllOfAFolderBecomesThePageOnThePapers) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "in");
  reproduced("p1-table1", folder / "in/p1-table1", {});
  reproduced("p1-fig4", folder / "in/p1-fig4", {"p1-fig4"});
  const Ran ran =
      run_program({"reproduce", "--all", "--stored", folder / "in", "--json", "-q", "-o", folder / "out"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const auto document = nlohmann::json::parse(ran.out);
  EXPECT_EQ(document["figures"].size(), 2U);
  EXPECT_EQ(document["figures"]["p1-table1"]["pass"], 13);
  std::ostringstream page;
  page << std::ifstream(fs::path(folder / "out") / "papers.md").rdbuf();
  EXPECT_NE(page.str().find("### p1-fig4"), std::string::npos);
  EXPECT_NE(page.str().find("| `p1-table1`, not in the sum | 13 | 0 | 0 | 0 | 0 |"), std::string::npos)
      << page.str();
  EXPECT_NE(page.str().find("![p1-fig4](p1-fig4/p1-fig4.svg)"), std::string::npos) << page.str();
  EXPECT_TRUE(fs::exists(fs::path(folder / "out") / "p1-fig4/p1-fig4.svg"));
  EXPECT_EQ(run_program({"reproduce", "--all", "p1-fig4", "-q"}).code, 2);
  EXPECT_EQ(run_program({"reproduce", "-q"}).code, 2);
}

TEST(Reproduce, AnUnknownNameListsTheKnown) {
  const Ran ran = run_program({"reproduce", "p1-fig9"});
  EXPECT_EQ(ran.code, 2);
  EXPECT_NE(ran.err.find("p1-fig3"), std::string::npos) << ran.err;
}

}  // namespace
}  // namespace twincell::reproduce_test
