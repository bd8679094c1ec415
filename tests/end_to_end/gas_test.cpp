// A gas measured as a user would measure it: until an error is reached, in the hard cases of the regime, and
// for the figures of the paper.

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "tests/support/program.hpp"

namespace twincell::gas_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* kQuick =
    "[time]\nintegrator = \"split\"\nsteps_per_contact = 6.37\ndiscard = 20\nphases = 10\ncycles = 60\n";

std::string scene(const TemporaryFolder& folder, const std::string& keys) {
  const std::string path = folder / "gas.toml";
  std::ofstream(path) << "preset = \"bhateja-2016-rough-2d\"\n" << keys << kQuick;
  return path;
}

json measured(const TemporaryFolder& folder, const std::string& keys, std::vector<std::string> more = {}) {
  std::vector<std::string> words = {"measure", scene(folder, keys), "--json", "-q", "--threads", "1"};
  words.insert(words.end(), more.begin(), more.end());
  const Ran ran = run_program(words);
  EXPECT_EQ(ran.code, 0) << ran.err;
  return ran.code == 0 ? json::parse(ran.out) : json::object();
}

TEST(Gas, IsMeasuredUntilItsErrorIsReached) {
  const TemporaryFolder folder;
  const json d =
      measured(folder, "[drive]\nk_m = 22.356\n",
               {"--set", "until.quantity=T_z", "--set", "until.relative_error=0.25", "--set",
                "time.cycles=2000", "--only", "T_z,T_z_eq5,T_bar_z,delta_h_cm", "-o", folder / "r.h5"});
  EXPECT_TRUE(d["until"]["reached"]) << d["until"];
  EXPECT_LT(d["cycles"], 2000);
  const json& t = d["results"]["T_z"];
  const double half = (t["interval"]["high"].get<double>() - t["interval"]["low"].get<double>()) / 2;
  EXPECT_LE(half, 0.25 * t["value"].get<double>());
  // Table III of the paper gives 0.357 at this W; the requested error is a quarter.
  EXPECT_NEAR(d["results"]["T_bar_z"]["value"].get<double>(), 0.357, 0.357 * 0.35);
  EXPECT_NEAR(d["results"]["T_z_eq5"]["value"].get<double>(), t["value"].get<double>() / 2, 1e-12);
  // Rest height of four rows of discs: 0.5 + 1.5 sqrt(3)/2 at closest packing, 2 if stacked vertically.
  EXPECT_GT(d["rest_height"], 1.79);
  EXPECT_LT(d["rest_height"], 2.0 + 0.2);
  EXPECT_TRUE(d["results"]["delta_h_cm"].contains("value"));
  EXPECT_EQ(d["provenance"]["run"]["until"], d["until"]);
  EXPECT_TRUE(fs::exists(folder / "r.h5"));
}

TEST(Gas, TheCapIsSaid) {
  const TemporaryFolder folder;
  const json d =
      measured(folder, "[drive]\nk_m = 50.0\n[until]\nquantity = \"T_z\"\nrelative_error = 0.001\n",
               {"--only", "T_z"});
  EXPECT_FALSE(d["until"]["reached"]);
  EXPECT_EQ(d["cycles"], 60);
  EXPECT_EQ(d["until"]["text"].get<std::string>().find("the cap of 60 cycles ended the run"), 0U)
      << d["until"];
}

TEST(Gas, ASolidBedHasNoTemperatureAndBothStartsAreCompared) {
  const TemporaryFolder folder;
  const json d =
      measured(folder, "[drive]\nk_m = 0.8943\n[until]\nquantity = \"T_bar_z\"\nabsolute_error = 1e-5\n",
               {"--only", "T_z,T_bar_z", "--both-starts"});
  EXPECT_LT(d["results"]["T_bar_z"]["value"], 1e-4);
  EXPECT_LT(d["other_start"]["results"]["T_bar_z"]["value"], 1e-4);
  EXPECT_FALSE(d["starts"].get<std::string>().empty());
}

TEST(Gas, HardCasesRun) {
  const TemporaryFolder folder;
  const std::string drive = "[drive]\nk_m = 22.356\n";
  // One bead does not fluctuate about its own centre of mass.
  const json one = measured(folder, drive + "[beads]\ncount = 1\n");
  EXPECT_EQ(one["results"]["T_z"]["value"], 0);
  EXPECT_TRUE(one["results"]["h_cm"].contains("value"));
  // Without beads, every result states why it is absent.
  const json none = measured(folder, drive + "[beads]\ncount = 0\n");
  EXPECT_TRUE(none["results"]["T_z"].contains("absent"));
  EXPECT_TRUE(none["results"]["phi_top"].contains("absent"));
  EXPECT_TRUE(none["results"]["T_z_z"].contains("absent"));
  // With e = 1 the bed keeps the energy from the plate and is hotter than at e = 0.9 (0.36); at e = 0.05 it
  // is colder than at e = 0.9.
  const json elastic = measured(folder, drive + "[contact]\nrestitution = 1.0\n", {"--only", "T_bar_z"});
  EXPECT_GT(elastic["results"]["T_bar_z"]["value"], 0.5);
  const json dead = measured(folder, drive + "[contact]\nrestitution = 0.05\n", {"--only", "T_bar_z"});
  EXPECT_LT(dead["results"]["T_bar_z"]["value"], 0.2);
  EXPECT_GT(dead["results"]["T_bar_z"]["value"], 0);
}

TEST(Gas, ABeadAtTenThousandDiametersMakesTwoSlabs) {
  const TemporaryFolder folder;
  std::ofstream(folder / "high.csv") << "x,z,vz\n5,10000,0\n2,0.5,0\n7,0.5,0\n";
  const json d = measured(
      folder,
      "[drive]\nk_m = 22.356\n[beads]\ncount = 3\n[start]\nkind = \"table\"\nsettle_limit = 0\nfrom = \"" +
          (folder / "high.csv").string() + "\"\n",
      {"--only", "profile_z,phi_z,h_cm", "--set", "time.cycles=5", "--set", "time.discard=0"});
  const auto& z = d["results"]["profile_z"]["value"];
  EXPECT_GT(z.back().get<double>(), 9900);
  EXPECT_LT(z.size(), 400U);
}

TEST(Gas, AnUnknownQuantityIsRefused) {
  const TemporaryFolder folder;
  const Ran ran =
      run_program({"measure", scene(folder, "[drive]\nk_m = 9.0\n[until]\nquantity = \"heat\"\n"), "-q"});
  EXPECT_EQ(ran.code, 2);
  EXPECT_NE(ran.err.find("gas.toml:5"), std::string::npos) << ran.err;
  EXPECT_NE(ran.err.find("T_bar_z"), std::string::npos) << ran.err;
}

TEST(GasFigures, ShareTheirRunsAndTakeTheUsersData) {
  const TemporaryFolder folder;
  // T_bar_z ~ W^(-1/4), so T_z ~ V_p^(3/2); a point of a solid bed is counted and excluded.
  std::ofstream own(folder / "own.csv");
  own.precision(17);
  own << "W,T_bar_z\n0.8,0\n";
  for (const double w : {3.0, 5.0, 9.0, 20.0, 50.0, 90.0}) own << w << "," << std::pow(w, -0.25) << "\n";
  own.close();
  const auto reproduce = [&](const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> words = {"reproduce", name,     "--budget", "0.01", "--threads",
                                      "1",         "--json", "-q",       "-o",   folder / name};
    words.insert(words.end(), more.begin(), more.end());
    const Ran ran = run_program(words);
    EXPECT_EQ(ran.code, 0) << ran.err;
    return ran.code == 0 ? json::parse(ran.out) : json::object();
  };
  const json table = reproduce("p2-table1", {"--data", folder / "own.csv", "--window", "0.5,60"});
  const auto& exponents = table["measured"]["exponents"];
  ASSERT_FALSE(exponents.empty());
  const json& yours = exponents.back();
  EXPECT_EQ(yours["name"], "your data");
  EXPECT_NEAR(yours["alpha"].get<double>(), 1.5, 1e-9);
  EXPECT_EQ(yours["points"], 5);
  EXPECT_EQ(yours["solid"], 1);
  std::set<std::string> first;
  for (const json& p : table["measured"]["points"]) first.insert(p["id"].get<std::string>());
  ASSERT_FALSE(first.empty());
  // The longest point starts first: 300 rpm, Gamma < 1, a bed that moves with its plate.
  EXPECT_LT(table["measured"]["points"][0]["T_bar_z"]["value"], 1e-4);
  const json figure = reproduce("p2-fig7", {});
  std::set<std::string> second;
  for (const json& p : figure["measured"]) second.insert(p["id"].get<std::string>());
  for (const std::string& id : first) EXPECT_TRUE(second.contains(id)) << "a point was not taken up";
  EXPECT_TRUE(fs::is_directory(folder / "p2-runs/points"));
  for (const json* d : {&table, &figure})
    for (const json& target : (*d)["targets"]) {
      EXPECT_FALSE(target.at("expected").get<std::string>().empty());
      if (target["measured"].get<std::string>().empty()) {
        EXPECT_EQ(target["verdict"], "absent") << target;
      }
    }
  EXPECT_TRUE(fs::exists(folder / "p2-fig7/p2-fig7.svg"));
}

TEST(GasFigures, OnlySomeTakeAWindow) {
  const Ran ran = run_program({"reproduce", "p2-fig6", "--window", "1,2"});
  EXPECT_EQ(ran.code, 2);
  EXPECT_NE(ran.err.find("p2-table1"), std::string::npos) << ran.err;
}

}  // namespace
}  // namespace twincell::gas_test
