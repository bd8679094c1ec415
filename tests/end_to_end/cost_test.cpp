// `cost sim` as a user runs it, on a few settings.

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/support/program.hpp"

namespace twincell::cost_test {
namespace {

TEST(Cost, SaysWhatAccuracyCosts) {
  const TemporaryFolder folder;
  const Ran ran =
      run_program({"cost", "sim", "--quick", "--json", "-q", "--accuracy", "1e-3", "-o", folder / "cost"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(ran.err, "");
  const auto d = nlohmann::json::parse(ran.out);

  const auto& equal = d["equal_accuracy"];
  EXPECT_EQ(equal["verlet"]["integrator"], "verlet");
  EXPECT_NEAR(equal["verlet"]["n"], 50, 1);
  EXPECT_NEAR(equal["verlet"]["error"], 3.3e-3, 0.2e-3);  // V1's table has 3.2e-3 for two beads
  const double n = equal["split"]["n"];
  EXPECT_EQ(equal["split"]["integrator"], "split");
  EXPECT_GE(n, 6);
  EXPECT_LE(n, 11);
  EXPECT_LE(equal["split"]["error"], equal["verlet"]["error"]);
  EXPECT_NEAR(equal["step_ratio"], equal["verlet"]["n"].get<double>() / n, 1e-12);
  EXPECT_GE(d["equal_mean_accuracy"]["split"]["n"], n);

  double last = 0;
  for (const auto& w : d["front"]) {
    EXPECT_GT(w["seconds_per_bead"]["t0"], last);
    last = w["seconds_per_bead"]["t0"];
  }
  EXPECT_LE(d["cheapest"]["error"], 1e-3);
  for (const auto& w : d["settings"]) {
    const auto& seconds = w["seconds_per_bead"];
    EXPECT_NEAR(seconds["contact_time"].get<double>() / seconds["step"].get<double>(), w["n"], 0.03);
    EXPECT_NEAR(seconds["contact_time"].get<double>() / seconds["t0"].get<double>(), 2.222831e-3, 1e-8);
    EXPECT_LE(w["bed"]["floor_force"], 1e-8);
  }
  // Impacts of a bed with sliding and sticking contacts.
  ASSERT_EQ(d["sliding"].size(), d["settings"].size());
  for (const auto& w : d["sliding"]) {
    for (const char* key : {"restitution", "tangential", "spin"})
      EXPECT_LE(w[key]["rms"], w[key]["max"]) << key;
    EXPECT_NEAR(w["spin_change"], 0.072, 0.02);
    // For Verlet the error is a fifth of the effect of friction (22 %: k_n tau/(gamma_n m), where tau is the
    // age of the first position).
    if (w["integrator"] == "verlet" && w["n"] > 50) {
      EXPECT_NEAR(w["spin"]["rms"].get<double>() / w["spin_change"].get<double>(), 0.22, 0.05);
    }
    if (w["integrator"] == "split") {
      EXPECT_LT(w["spin"]["rms"].get<double>(), 0.06 * w["spin_change"].get<double>());
    }
  }
  const auto& impacts = d["equal_impacts"];
  EXPECT_NEAR(impacts["verlet"]["spin"]["rms"].get<double>() / impacts["verlet"]["spin_change"].get<double>(),
              impacts["spin_share"], 5e-4);
  // k_n tau/(gamma_n m) = 1 % requires about a thousand steps per contact; the spread of e and of the angles
  // varies it.
  EXPECT_GT(impacts["verlet"]["n"], 600);
  EXPECT_LT(impacts["verlet"]["n"], 2000);
  EXPECT_GT(impacts["step_ratio"], 40);
  EXPECT_EQ(d["gas"].size(), 3U);

  EXPECT_EQ(names_in(folder / "cost"),
            (std::vector<std::string>{"table.txt", "twincell-manifest.json", "work_precision.dat",
                                      "work_precision.gp", "work_precision.pdf", "work_precision.png",
                                      "work_precision.svg"}));
}

TEST(Cost, SaysWhatAGasCosts) {
  const TemporaryFolder folder;
  const Ran ran = run_program({"cost", "gas", "--quick", "--json", "-q", "-o", folder / "cost"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const auto d = nlohmann::json::parse(ran.out);
  ASSERT_EQ(d["gas"].size(), 3U);
  EXPECT_EQ(d["gas"][0]["stepping"], "steps");
  EXPECT_EQ(d["gas"][2]["stepping"], "event-driven");
  for (const auto& g : d["gas"]) {
    EXPECT_NEAR(g["t_z"], 0.36,
                0.15);  // Table III: 0.327 at W = 50; ours 0.36; six hundred periods leave a few per cent
    EXPECT_LT(std::abs(g["errors_from_first"].get<double>()), 5);
    const double share = g["standard_error"].get<double>() / g["t_z"].get<double>() / 0.01;
    EXPECT_NEAR(g["seconds_to_accuracy"].get<double>(), g["seconds"].get<double>() * share * share, 1e-9);
  }
  EXPECT_GE(d["gain"]["rough-2d"], 1);
  EXPECT_EQ(names_in(folder / "cost"),
            (std::vector<std::string>{"gas_cost.dat", "gas_cost.gp", "gas_cost.pdf", "gas_cost.png",
                                      "gas_cost.svg", "table.txt", "twincell-manifest.json"}));
}

TEST(Cost, SaysWhatLocatingCosts) {
  const TemporaryFolder folder;
  const Ran ran =
      run_program({"cost", "locate", "--quick", "--json", "-q", "--accuracy", "0.02", "-o", folder / "cost"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(ran.err, "");
  const auto d = nlohmann::json::parse(ran.out);
  double last = 0, worst = 1e9;
  ASSERT_GE(d["front"].size(), 2U);
  for (const auto& p : d["front"]) {
    EXPECT_GT(p["ms_per_frame"], last);
    EXPECT_LT(p["rms_px"], worst);
    last = p["ms_per_frame"];
    worst = p["rms_px"];
  }
  for (const auto& p : d["settings"]) {
    const double rms = p["rms_px"], diameter = p["diameter_px"];
    EXPECT_NEAR(p["s_b_noise"]["one_tracer"], rms / diameter * std::sqrt(0.95), 1e-12);
    if (p["sweeps"] == 30 && p["refine"] == "exact" && p["finder"] == "vote") {
      EXPECT_EQ(p["recall"], 1);
      EXPECT_EQ(p["precision"], 1);
      EXPECT_GE(p["rms_over_bound"], 0.8);  // 200 beads: scatter of 3.5 %
      EXPECT_LE(p["rms_over_bound"], 1.3);
    }
  }
  ASSERT_EQ(d["cheapest"].size(), 2U);
  for (const auto& c : d["cheapest"]) EXPECT_LE(c["setting"]["rms_px"], 0.02);
  EXPECT_EQ(names_in(folder / "cost"),
            (std::vector<std::string>{"locating.dat", "locating.gp", "locating.pdf", "locating.png",
                                      "locating.svg", "table.txt", "twincell-manifest.json"}));
}

TEST(Cost, RefusesBeforeItMeasures) {
  const TemporaryFolder folder;
  for (const std::vector<std::string>& words : {std::vector<std::string>{"cost"},
                                                {"cost", "imaging"},
                                                {"cost", "sim", "--accuracy", "0"},
                                                {"cost", "locate", "--accuracy", "-0.01"},
                                                {"cost", "locate", "--accuracy", "1e9"},
                                                {"cost", "sim", "--accuracy", "nan"},
                                                {"cost", "sim", "-o", folder / "no/such/place"}}) {
    const Ran ran = run_program(words);
    EXPECT_EQ(ran.code, 2) << ran.err;
    EXPECT_EQ(ran.out, "");
    EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
  }
  EXPECT_TRUE(names_in(folder.path()).empty());
}

}  // namespace
}  // namespace twincell::cost_test
