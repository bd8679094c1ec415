// The study of the excess over Table III judges what was put in.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "reproduce/gas.hpp"

namespace twincell::reproduce::excess_test {
namespace {

/// Adds the points of one choice as the study stores them. \param excess of T_bar_z over Table III by W
template <class Excess>
void put(nlohmann::json& points, const std::string& choice, int dimension, const std::vector<int>& rpm,
         Excess excess) {
  for (const int at : rpm) {
    const double w = w_of_rpm(at), t = w * table_3(dimension, true, w) * excess(w);
    points.push_back({{"curve", fmt::format("{}D rough, {}", dimension, choice)},
                      {"key", "drive.k_m"},
                      {"at", w},
                      {"id", "x"},
                      {"cycles", 100},
                      {"contact_fraction", 0},
                      {"T_z", {{"value", t}, {"interval", {0.997 * t, 1.003 * t}}}}});
  }
}

const std::vector<int> kRpm = {1400, 3000, 4000};

Reproduction judged(const nlohmann::json& points) {
  const auto entry =
      std::ranges::find_if(list(), [](const Reproducible& r) { return r.name == "p2-excess"; });
  return entry->run({.stored = nlohmann::json{{"points", points}}.dump()});
}

const Target& target(const Reproduction& r, const std::string& name) {
  const auto found = std::ranges::find_if(r.targets, [&](const Target& t) { return t.name == name; });
  if (found == r.targets.end()) throw std::runtime_error("no target " + name);
  return *found;
}

TEST(Excess, AChoiceThatGivesTableIIIMeetsAllAndTheOthersAreNamed) {
  nlohmann::json points = nlohmann::json::array();
  const auto none = [](double) { return 1.0; };
  const auto rising = [](double w) { return w > 40 ? 1.15 : 1.0; };
  put(points, "as in Fig. 2", 2, kRpm, rising);
  put(points, "as in Fig. 2", 3, kRpm, none);
  put(points, "c_t = 1.25 c_n", 2, kRpm, none);
  put(points, "c_t = 1.25 c_n", 3, kRpm, none);
  // 2D is met, but falls too fast in the window of Table I, and 3D is a fifth too low.
  put(points, "k_n = 1e7", 2, kRpm, [](double w) { return w > 40 ? std::pow(w / 65, -0.2) : 1.0; });
  put(points, "k_n = 1e7", 3, kRpm, [](double) { return 0.8; });
  const Reproduction r = judged(points);

  const Target& excess = target(r, "as in Fig. 2: 2D rough over Table III");
  EXPECT_EQ(excess.verdict, Verdict::fail);
  EXPECT_EQ(excess.reason, "off at W = 50.3, 89.4");
  EXPECT_NE(excess.measured.find("1.15 [1.147, 1.153] at W = 89.4"), std::string::npos) << excess.measured;
  EXPECT_EQ(target(r, "as in Fig. 2: 3D rough over Table III").verdict, Verdict::pass);
  EXPECT_EQ(target(r, "c_t = 1.25 c_n: 2D rough over Table III").verdict, Verdict::pass);
  // The algebraic curve itself: T_z ~ W T_bar_z.
  const double w_1 = w_of_rpm(3000), w_2 = w_of_rpm(4000);
  const double alpha = 2 + 2 * std::log(table_3(2, true, w_2) / table_3(2, true, w_1)) / std::log(w_2 / w_1);
  const Target& met = target(r, "c_t = 1.25 c_n: alpha from W = 50.3 to 89.4, 2D rough");
  EXPECT_NEAR(std::stod(met.measured), alpha, 0.005) << met.measured;
  EXPECT_EQ(met.verdict, Verdict::pass) << met.measured;
  EXPECT_EQ(target(r, "k_n = 1e7: 2D rough over Table III").verdict, Verdict::pass);
  EXPECT_EQ(target(r, "k_n = 1e7: alpha from W = 50.3 to 89.4, 2D rough").verdict, Verdict::fail);

  const Target& any = r.targets.front();
  EXPECT_EQ(any.verdict, Verdict::pass);
  EXPECT_EQ(any.measured, "c_t = 1.25 c_n (pass)");
  EXPECT_NE(any.reason.find("k_n = 1e7 (spoils alpha 1."), std::string::npos) << any.reason;
  EXPECT_NE(any.reason.find("3D off at W = 11,"), std::string::npos) << any.reason;
  EXPECT_EQ(any.reason.find("Fig. 2"), std::string::npos) << any.reason;
  EXPECT_EQ(target(r, "k_n = 1e5: 2D rough over Table III").verdict, Verdict::absent);
}

// A definition is read from the runs of Fig. 2; without an interval of its own it has the relative one of
// T_z.
TEST(Excess, DefinitionsAndFirstCyclesAreJudgedFromTheirRuns) {
  nlohmann::json points = nlohmann::json::array();
  put(points, "as in Fig. 2", 2, kRpm, [](double) { return 1.0; });
  for (nlohmann::json& p : points) p["T_z_field"] = {{"value", 0.8 * p["T_z"]["value"].get<double>()}};
  const double w = w_of_rpm(3000), t = w * table_3(2, true, w);
  for (int seed = 1; seed <= 16; ++seed)
    points.push_back({{"curve", fmt::format("2D rough, first 100 cycles from rest, W = {:.3g}", w)},
                      {"key", "start.seed"},
                      {"at", seed},
                      {"id", "y"},
                      {"cycles", 100},
                      {"contact_fraction", 0},
                      {"T_z", {{"value", t * (seed % 2 == 0 ? 1.19 : 1.21)}}}});
  const Reproduction r = judged(points);
  const Target& field = target(r, "T_z about the velocity field: 2D rough over Table III");
  EXPECT_NE(field.measured.find("0.8 [0.7976, 0.8024] at W = 89.4"), std::string::npos) << field.measured;
  EXPECT_EQ(field.verdict, Verdict::fail);
  const Target& first = target(r, "first 100 cycles from rest: 2D rough over Table III");
  EXPECT_TRUE(first.measured.starts_with("1.2 [1.19")) << first.measured;
  EXPECT_EQ(first.verdict, Verdict::fail);
}

}  // namespace
}  // namespace twincell::reproduce::excess_test
