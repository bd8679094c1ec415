// --profile: its shares add up, its counts are those of the run, and it changes nothing else.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/datasets.hpp"
#include "tests/support/program.hpp"
#include "tests/support/put_file.hpp"

namespace twincell::profile_test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Words = std::vector<std::string>;

constexpr const char* kScene =
    "preset = \"fortini-huang-2015\"\n[cell]\nwidth = 10.0\n[beads]\ncount = 60\n[drive]\ngamma = 1.5\n"
    "[start]\nkind = \"crystal_a\"\nsettle_limit = 5.0\n[time]\nsteps_per_contact = 20\ndiscard = 1\n"
    "cycles = 2\nphases = 10\n";

std::string bytes_of(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Shares of the document add up to 1, those of the table to 100 % but for the rounding of each row.
void expect_whole(const Json& document, const std::string& text) {
  const Json& profile = document["profile"];
  double share = 0, seconds = 0;
  for (const Json& stage : profile["stages"]) {
    share += stage["share"].get<double>();
    seconds += stage["seconds"].get<double>();
  }
  EXPECT_NEAR(share, 1, 1e-9);
  EXPECT_NEAR(seconds, profile["seconds"].get<double>(), 1e-9 + 1e-9 * seconds);
  EXPECT_EQ(profile["stages"].back()["stage"], "other");

  const std::string table = text.substr(text.find("\nstage "));
  std::istringstream lines(table);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 100U) << line;
  const std::regex percent(R"([ mu]s +([\d.]+) %)");  // after the time; the others are shares of the bound
  double sum = 0;
  int rows = 0;
  for (std::sregex_iterator it(table.begin(), table.end(), percent), end; it != end; ++it, ++rows)
    sum += std::stod((*it)[1]);
  EXPECT_NEAR(sum, 100, 0.05 * rows + 1e-9) << table;
  EXPECT_EQ(rows, static_cast<int>(profile["stages"].size())) << table;
}

const Json& stage(const Json& document, const std::string& name) {
  for (const Json& one : document["profile"]["stages"])
    if (one["stage"] == name) return one;
  throw std::runtime_error("no stage " + name + " in " + document["profile"].dump());
}

/// The document without what differs from run to run.
Json lasting(Json document) {
  for (const char* key : {"profile", "provenance", "seconds", "particle_steps_per_second", "output"})
    document.erase(key);
  return document;
}

class ProfileTest : public ::testing::Test {
 protected:
  ProfileTest() {
    put_file(folder_ / "scene.toml", kScene);
    plain_ = json({"simulate", at("scene.toml"), "-o", at("plain.h5")});
    profiled_ = json({"simulate", at("scene.toml"), "-o", at("profiled.h5"), "--profile"});
  }
  [[nodiscard]] std::string at(const std::string& name) const { return (folder_ / name).string(); }
  static Json json(Words words) {
    words.insert(words.end(), {"--json", "-q"});
    const Ran ran = run_program(words);
    EXPECT_EQ(ran.code, 0) << ran.err;
    return Json::parse(ran.out);
  }
  static std::string text(const Words& words) {
    const Ran ran = run_program(words);
    EXPECT_EQ(ran.code, 0) << ran.err;
    return ran.out;
  }

  TemporaryFolder folder_;
  Json plain_, profiled_;
};

TEST_F(ProfileTest, OfASimulation) {
  expect_whole(profiled_, text({"simulate", at("scene.toml"), "-o", at("text.h5"), "--profile"}));
  EXPECT_FALSE(plain_.contains("profile"));
  EXPECT_EQ(lasting(plain_), lasting(profiled_));
  const auto before = datasets_of(at("plain.h5"));
  EXPECT_GT(before.size(), 4U);
  EXPECT_EQ(before, datasets_of(at("profiled.h5")));

  const double per_period = profiled_["steps_per_period"].get<double>(), beads = 60;
  EXPECT_EQ(stage(profiled_, "stepping")["count"], 3 * per_period * beads);
  EXPECT_EQ(stage(profiled_, "stepping")["unit"], "particle-steps");
  EXPECT_EQ(stage(profiled_, "writing")["count"], 20);
  EXPECT_EQ(stage(profiled_, "placing")["count"], beads);
  EXPECT_GT(stage(profiled_, "stepping")["bytes"], 100 * 3 * per_period * beads);  // the records of the beads
  const Json& counters = profiled_["profile"]["counters"];
  EXPECT_EQ(counters["list_builds"], profiled_["list_builds"]);
  EXPECT_EQ(counters["steps"].get<double>() * beads, stage(profiled_, "stepping")["count"].get<double>() +
                                                         stage(profiled_, "settling")["count"].get<double>());
  EXPECT_GT(counters["pair_visits"], 0);
}

TEST_F(ProfileTest, OfAnAnalysis) {
  const Json plain = json({"analyze", at("plain.h5"), "-o", at("plain_results.h5")});
  const Json profiled = json({"analyze", at("plain.h5"), "-o", at("results.h5"), "--profile"});
  expect_whole(profiled, text({"analyze", at("plain.h5"), "-o", at("text_results.h5"), "--profile"}));
  EXPECT_EQ(lasting(plain), lasting(profiled));
  EXPECT_EQ(datasets_of(at("plain_results.h5")), datasets_of(at("results.h5")));
  EXPECT_GT(datasets_of(at("results.h5")).size(), 10U);
  for (const char* name : {"reading", "phase_thresholds", "bond_order", "pair_correlation", "stress"}) {
    EXPECT_EQ(stage(profiled, name)["count"], 20 * 60) << name;
    EXPECT_EQ(stage(profiled, name)["unit"], "bead-frames") << name;
    EXPECT_GE(stage(profiled, name)["bytes"], 20 * 60 * 24) << name;
  }
  const Json one = json({"analyze", at("plain.h5"), "--only", "g_r", "--profile"});
  EXPECT_EQ(one["profile"]["stages"].size(), 3U) << "reading, pair_correlation, other";
}

TEST_F(ProfileTest, OfAFilm) {
  ASSERT_EQ(run_program({"render", at("plain.h5"), "-o", at("frames"), "-q"}).code, 0);
  const auto track = [&](const std::string& name) {
    return Words{"track",  at("frames"),           "-o",    at(name + ".h5"),
                 "--cell", at("frames/CELL.toml"), "--csv", at(name + ".csv")};
  };
  Words with = track("with");
  with.emplace_back("--profile");
  const Json plain = json(track("without")), profiled = json(with);
  Words again = track("text");
  again.emplace_back("--profile");
  expect_whole(profiled, text(again));
  EXPECT_EQ(lasting(plain), lasting(profiled));
  EXPECT_EQ(datasets_of(at("without.h5")), datasets_of(at("with.h5")));
  EXPECT_FALSE(bytes_of(at("with.csv")).empty());
  EXPECT_EQ(bytes_of(at("without.csv")), bytes_of(at("with.csv")));
  EXPECT_EQ(stage(profiled, "reading")["count"], 20);
  EXPECT_EQ(stage(profiled, "reading")["bytes"], stage(profiled, "locating")["bytes"]);
  EXPECT_EQ(stage(profiled, "locating")["count"], profiled["beads_located"]);
  EXPECT_EQ(stage(profiled, "linking")["count"], 19 * 60);
}

constexpr const char* kPlan = "scene = \"scene.toml\"\n[axes]\nstart.kind = [\"crystal_a\", \"crystal_b\"]\n";

TEST_F(ProfileTest, OfASweep) {
  put_file(folder_ / "plan.toml", kPlan);
  const auto run = [&](const std::string& name) {
    return Words{"sweep", "run", at("plan.toml"), "--folder", at(name), "--threads", "2"};
  };
  Words with = run("with");
  with.emplace_back("--profile");
  const Json profiled = json(with);
  (void)json(run("without"));
  Words again = run("text");
  again.emplace_back("--profile");
  expect_whole(profiled, text(again));
  const Json& whole = profiled["profile"];
  EXPECT_EQ(whole["threads"], 2);
  EXPECT_EQ(stage(profiled, "storing")["count"], 2);
  EXPECT_EQ(stage(profiled, "placing")["count"], 2);
  EXPECT_EQ(stage(profiled, "stepping")["count"], 2 * 60 * 3 * plain_["steps_per_period"].get<double>());
  // The times are those of two threads that live from the beginning of the run to its end.
  EXPECT_LE(whole["seconds"].get<double>(), 2 * whole["elapsed_seconds"].get<double>());
  EXPECT_GE(whole["seconds"].get<double>(), stage(profiled, "stepping")["seconds"].get<double>());

  std::size_t points = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "with" / "points")) {
    if (entry.path().filename() != "result.json") continue;
    Json one = Json::parse(bytes_of(entry.path()));
    Json other = Json::parse(bytes_of(folder_ / "without" / fs::relative(entry.path(), folder_ / "with")));
    one.erase("computed"), other.erase("computed");
    EXPECT_EQ(one, other);
    ++points;
  }
  EXPECT_EQ(points, 2U);
}

}  // namespace
}  // namespace twincell::profile_test
