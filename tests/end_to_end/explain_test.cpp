// The `explain` report of a scene matches the run: the lists, the refusals, the columns and the provenance.

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "tests/support/program.hpp"
#include "trajectory/formats/h5md_file.hpp"

namespace twincell::explain_test {
namespace {

constexpr int kUsage = 2;

class Explain : public ::testing::Test {
 protected:
  Explain() {
    std::ofstream(scene_)
        << "preset = \"fortini-huang-2015\"\n[beads]\ncount = 40\n[cell]\nwidth = 8.0\n"
           "[drive]\ngamma = 1.5\n[time]\nsteps_per_contact = 10\ncycles = 1\ndiscard = 0\n";
  }
  [[nodiscard]] Ran run(const std::string& verb, const std::vector<std::string>& more) const {
    std::vector<std::string> words{verb, scene_};
    words.insert(words.end(), more.begin(), more.end());
    return run_program(words);
  }
  [[nodiscard]] nlohmann::json explained(std::vector<std::string> more) const {
    more.push_back("--json");
    const Ran ran = run("explain", more);
    EXPECT_EQ(ran.code, 0) << ran.err;
    return nlohmann::json::parse(ran.out);
  }
  static std::map<std::string, std::string> states(const nlohmann::json& plan) {
    std::map<std::string, std::string> all;
    for (const auto& e : plan["effects"]) {
      all[e["name"]] = e["state"];
      EXPECT_FALSE(e["reason"].get<std::string>().empty()) << e;
    }
    return all;
  }
  void expect_refusal(const std::vector<std::string>& more, const std::vector<std::string>& mentioned) const {
    const Ran ran = run("explain", more);
    EXPECT_EQ(ran.code, kUsage);
    EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
    for (const auto& word : mentioned) EXPECT_NE(ran.err.find(word), std::string::npos) << ran.err;
  }

  TemporaryFolder folder_;
  std::string scene_ = folder_ / "scene.toml";
};

TEST_F(Explain, EachEffectStandsInItsList) {
  auto all = states(explained({}));
  EXPECT_EQ(all["rotation"], "on");
  EXPECT_EQ(all["tangential history"], "on");
  EXPECT_EQ(all["rolling resistance"], "off (scene)");
  EXPECT_EQ(all["time integration"], "approximated");
  EXPECT_EQ(all.count("tension"), 0U);
  all = states(explained({"--set", "contact.mu=0.0", "--set", "contact.normal=linear-no-tension", "--set",
                          "cell.plate_drag=0.1"}));
  for (const char* name : {"friction", "rotation", "tangential history"})
    EXPECT_EQ(all[name], "off (proven)");
  EXPECT_EQ(all["tension"], "off (scene)");
  EXPECT_EQ(all["front and back plates"], "approximated");
  all = states(explained({"--set", "contact.k_t=0.0"}));
  EXPECT_EQ(all["friction"], "on");
  EXPECT_EQ(all["tangential history"], "off (proven)");
  const Ran text = run("explain", {});
  for (const char* heading :
       {"On, set by the scene", "Off, set by the scene", "Off, because the effect provably cannot act",
        "Approximated", "measured on this machine", "frames comes on top of this"})
    EXPECT_NE(text.out.find(heading), std::string::npos) << text.out;
}

TEST_F(Explain, WhatItCostsIsMeasured) {
  const auto plan = explained({}), smooth = explained({"--set", "contact.mu=0.0"});
  EXPECT_EQ(plan["particle_steps"].get<double>(), 40 * plan["steps"].get<double>());
  EXPECT_EQ(plan["steps"].get<long>(), plan["steps_per_period"].get<long>());  // one cycle
  EXPECT_EQ(plan["dt_set_by"], "bead-bead, normal contact");
  EXPECT_GT(plan["measured_steps"].get<long>(), 0);
  EXPECT_GT(plan["expected_seconds"].get<double>(), 0);
  EXPECT_NEAR(plan["expected_seconds"].get<double>() * plan["particle_steps_per_second"].get<double>(),
              plan["particle_steps"].get<double>(), 1e-9 * plan["particle_steps"].get<double>());
  // A bead stores at least position, velocity and force; a listed pair stores two indices and, with history,
  // a number.
  EXPECT_GE(plan["bytes_per_bead"].get<double>(), 48);
  EXPECT_LE(plan["bytes_per_bead"].get<double>(), 1024);
  EXPECT_GE(plan["bytes_per_pair"].get<double>(), smooth["bytes_per_pair"].get<double>() + 8);
  EXPECT_GE(smooth["bytes_per_pair"].get<double>(), 8);
}

// A bed of unlike beads in contact costs about as much as one of equal beads. A crystal of unlike beads,
// which do not touch, is three to four times as fast. A program on the other thread of the same core lowers
// the rate of processor time by up to a half: the best of alternating measurements counts.
TEST_F(Explain, ABedOfUnlikeBeadsIsMeasuredInContact) {
  const std::vector<std::string> bed = {"--set",          "beads.layers=50", "--set",
                                        "cell.width=100", "--set",           "time.cycles=100"};
  const auto speed = [&](std::vector<std::string> words) {
    words.insert(words.end(), bed.begin(), bed.end());
    return explained(words)["particle_steps_per_second"].get<double>();
  };
  double equal = 0, unlike = 0;
  for (int round = 0; round < 4; ++round) {
    equal = std::max(equal, speed({}));
    unlike = std::max(unlike, speed({"--set", "beads.spread=uniform", "--set", "beads.spread_width=0.1"}));
  }
  EXPECT_LT(unlike, 1.8 * equal);
  EXPECT_GT(unlike, 0.5 * equal);
}

TEST_F(Explain, WhatActsMayNotBeDropped) {
  expect_refusal({"--set", "effects.rotation=false"}, {"scene.toml", "effects.rotation", "mu = 0.6"});
  expect_refusal({"--set", "effects.history=false"}, {"effects.history", "spring", "k_t = 10000"});
  // Rough beads between smooth walls still have friction.
  expect_refusal({"--set", "effects.rotation=false", "--set", "contact.wall.mu=0.0"}, {"effects.rotation"});
  // Smooth beads between rough walls also rotate.
  expect_refusal(
      {"--set", "effects.rotation=false", "--set", "contact.mu=0.0", "--set", "contact.wall.mu=0.3"},
      {"effects.rotation"});
  for (const std::vector<std::string>& harmless :
       {std::vector<std::string>{"--set", "effects.rotation=false", "--set", "contact.mu=0.0"},
        {"--set", "effects.history=false", "--set", "contact.tangential=dashpot"},
        {"--set", "effects.history=false", "--set", "contact.k_t=0.0"}})
    EXPECT_NE(run("explain", harmless).out.find("= false drops nothing"), std::string::npos);
}

TEST_F(Explain, AKeyThatNoLawReadsIsRefusedAndAPresetsIsNamed) {
  expect_refusal({"--set", "contact.normal=hertz", "--set", "contact.youngs_modulus=1e7", "--set",
                  "contact.restitution=0.5"},
                 {"contact.restitution", "contact.normal = \"hertz\"", "\"linear\""});
  expect_refusal({"--set", "contact.tangential=none", "--set", "contact.mu=0.5"}, {"contact.mu", "\"none\""});
  const Ran ran = run_program(
      {"explain", scene_, "--set", "contact.normal=hertz", "--set", "contact.youngs_modulus=1e7"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  for (const std::string& text : {ran.out, ran.err})
    EXPECT_NE(
        text.find("contact.gamma_n of preset fortini-huang-2015 has no effect: the law contact.normal = "
                  "\"hertz\" does not read it"),
        std::string::npos)
        << text;
}

TEST_F(Explain, FilesWithoutAnEndAreRefused) {
  const std::string pipe = folder_ / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  for (const std::string& file : {std::string("/dev/zero"), pipe}) {
    const Ran ran = run_program({"explain", file});
    EXPECT_EQ(ran.code, 3);
    EXPECT_NE(ran.err.find("a regular file is needed"), std::string::npos) << ran.err;
  }
}

// A signal interrupts the placement of four million beads.
TEST_F(Explain, ASignalEndsThePlacingOfManyBeads) {
  FolderEvents opened(folder_.path(), IN_CLOSE_NOWRITE);  // the scene has been read; the beads come next
  RunningProgram program({"explain", scene_, "-q", "--set", "beads.count=4000000"});
  ASSERT_GT(opened.wait(program.id()), 0U);
  const double before_s = program.cpu_s();
  program.signal(SIGTERM);
  const Ran ran = program.wait();
  EXPECT_EQ(ran.code, 143);
  EXPECT_NE(ran.err.find("Stopped by a signal"), std::string::npos) << ran.err;
  EXPECT_LT(ran.cpu_s - before_s, 1);
}

TEST_F(Explain, ARefusalPointsToItsLine) {
  std::ofstream(scene_, std::ios::app) << "[effects]\nrotation = false\n";
  expect_refusal({}, {"scene.toml:13:12: effects.rotation: is false, but friction turns beads"});
}

TEST_F(Explain, TheErrorOfTheStepIsTheScenesOwn) {
  const auto reason = [&](const std::string& restitution) {
    const auto plan = explained({"--set", "contact.restitution=" + restitution});
    for (const auto& e : plan["effects"])
      if (e["name"] == "time integration") return e["reason"].get<std::string>();
    return std::string("absent");
  };
  for (const std::string e : {"0.9", "0.6"})
    EXPECT_NE(reason(e).find(" is " + e + " and errs by up to 0.0"), std::string::npos) << reason(e);
}

TEST_F(Explain, WhatIsOffHasNoColumnAndTheFileHoldsThePlan) {
  for (const std::string mu : {"0.0", "0.6"}) {
    const std::string output = folder_ / ("mu" + mu + ".h5");
    ASSERT_EQ(run("simulate", {"-o", output, "--set", "contact.mu=" + mu}).code, 0);
    const H5mdReader file(output);
    Frame frame;
    file.read(0, frame);
    EXPECT_EQ(file.info().columns.spin, mu != "0.0");
    EXPECT_EQ(frame.spin.size(), mu != "0.0" ? 40U : 0U);
    const auto provenance = nlohmann::json::parse(file.info().provenance_json);
    EXPECT_EQ(provenance["plan"]["effects"], explained({"--set", "contact.mu=" + mu})["effects"]);
  }
}

}  // namespace
}  // namespace twincell::explain_test
