// The figures of the papers, drawn from the stored runs in docs/reproduce, keep the rules of all figures.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "analysis/report/figure_style.hpp"
#include "reproduce/reproduction.hpp"
#include "tests/support/figure_rules.hpp"

namespace twincell::reproduce::figures_test {
namespace {

const std::filesystem::path kStored = std::filesystem::path(TWINCELL_SOURCE_DIR) / "docs/reproduce";

std::string text_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

class StoredFigures : public testing::TestWithParam<Reproducible> {};

TEST_P(StoredFigures, KeepTheRulesOfFigures) {
  const Reproducible& what = GetParam();
  const auto document = nlohmann::json::parse(text_of(kStored / (what.name + ".json")));
  const Reproduction r = what.run({.stored = document.at("measured").dump()});
  ASSERT_FALSE(r.figures.empty());
  for (const analysis::Figure& f : r.figures) {
    EXPECT_LE(f.width, analysis::figure_style::kWidest) << f.name;
    EXPECT_FALSE(f.caption.empty()) << f.name;
    for (const std::string& broken : broken_figure_rules(f.plot)) ADD_FAILURE() << f.name << ": " << broken;
  }
}

std::vector<Reproducible> stored() {
  std::vector<Reproducible> all;
  for (const Reproducible& r : list())
    if (r.judges_stored && exists(kStored / (r.name + ".json"))) all.push_back(r);
  return all;
}
INSTANTIATE_TEST_SUITE_P(All, StoredFigures, testing::ValuesIn(stored()), [](const auto& tested) {
  std::string name = tested.param.name;
  std::erase(name, '-');
  return name;
});

TEST(CommittedFigures, KeepTheRulesOfFigures) {
  std::size_t n = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kStored)) {
    if (entry.path().extension() != ".gp") continue;
    ++n;
    const std::string commands = text_of(entry.path());
    for (const std::string& broken : broken_figure_rules(commands))
      ADD_FAILURE() << entry.path().filename() << ": " << broken;
    EXPECT_NE(commands.find(analysis::figure_style::head()), std::string::npos)
        << entry.path().filename() << " is of another style: reproduce NAME --stored draws it again";
  }
  EXPECT_GT(n, 50U);
}

/// A document of two gases at four drive strengths, one of them solid, as Gas::as_json writes it.
Reproduction drawn(const std::string& name, const std::string& measured) {
  for (const Reproducible& r : list())
    if (r.name == name) return r.run({.stored = measured});
  return {};
}

TEST(PaperFigures, SolidBedsAreDrawnApartFromTheGas) {
  nlohmann::json points = nlohmann::json::array();
  for (const auto& [w, t] : {std::pair{0.503, 1e-9}, std::pair{2.74, 0.6}, std::pair{10.95, 0.4}})
    points.push_back({{"curve", "2D rough"},
                      {"key", "drive.k_m"},
                      {"at", w},
                      {"id", "x"},
                      {"cycles", 100},
                      {"contact_fraction", 0},
                      {"T_bar_z", {{"value", t}, {"interval", {t / 2, 2 * t}}}}});
  const Reproduction r = drawn("p2-fig2", points.dump());
  ASSERT_EQ(r.figures.size(), 5U);  // the figure, and the foot of each of the four systems
  EXPECT_EQ(r.figures[1].name, "p2-fig2-foot-2d-rough");
  const analysis::Figure& f = r.figures.front();
  EXPECT_TRUE(
      f.data.starts_with("# 2D rough\n2.74 0.6 0.3 1.2\n10.95 0.4 0.2 0.8\n\n\n"
                         "# 2D rough, solid\n0.503 1e-09 5e-10 2e-09\n"))
      << f.data.substr(0, 200);
  // The open shape of the same line type, and an entry that says what it means.
  EXPECT_NE(f.plot.find("index 0 using 1:2:3:4 with yerrorbars lt 1 title '2D rough'"), std::string::npos)
      << f.plot;
  EXPECT_NE(f.plot.find("index 1 using 1:2 with points lt 1 pt 6 notitle"), std::string::npos) << f.plot;
  EXPECT_NE(f.plot.find("title 'open: solid"), std::string::npos);
  // The curve of Table III has the colour of its system.
  EXPECT_NE(f.plot.find("with lines lt 1 lw"), std::string::npos);
}

/// Onsets of one height as p1-fig3 stores them: of the random beds, those between Gamma = 1.6 and 2 exceeded
/// sigma and came to rest.
std::string onsets_with_beds_at_rest() {
  nlohmann::json measured = nlohmann::json::array();
  for (const std::string start : {"random", "crystal"}) {
    nlohmann::json trials = nlohmann::json::array();
    const double from = start == "random" ? 1.6 : 2.6;
    for (const double gamma : {1.3, 1.4, 1.5, 1.7, 1.8, 1.9, 2.1, 2.2, 2.3, 2.4, 2.5, 2.7, 2.8, 2.9})
      for (int seed = 0; seed < 2; ++seed)
        trials.push_back({gamma, gamma > from, gamma > std::max(from, 2.0)});
    measured.push_back({{"layers", 40},
                        {"start", start},
                        {"verdict", "convecting"},
                        {"runs", trials.size()},
                        {"width", 0.2},
                        {"cycles", 200},
                        {"trials", trials}});
  }
  return measured.dump();
}

TEST(PaperFigures, TheOnsetWithoutBedsAtRestIsDrawnAndStated) {
  const Reproduction r = drawn("p1-fig3", onsets_with_beds_at_rest());
  const std::string& data = r.figures.at(0).data;
  EXPECT_NE(data.find("# convection, random\n39.5 1.58"), std::string::npos) << data;
  EXPECT_NE(data.find("# random, none at rest\n38.5 1.98"), std::string::npos) << data;
  EXPECT_EQ(data.find("crystal, none at rest"), std::string::npos) << data;
  EXPECT_NE(r.figures[0].plot.find("title 'random, none at rest'"), std::string::npos);
  const auto order = std::find_if(r.targets.begin(), r.targets.end(),
                                  [](const Target& t) { return t.name == "onset of convection, N_l = 40"; });
  ASSERT_NE(order, r.targets.end());
  EXPECT_NE(order->reason.find("6 of the 22 random beds"), std::string::npos) << order->reason;
  EXPECT_NE(order->reason.find("without them random 1.988 ["), std::string::npos) << order->reason;
}

// The paper does not state the system of Fig. 10: the page says which one decides each target, and how many
// of the points behind it the cap of cycles ended.
TEST(PaperFigures, Fig10NamesTheDecidingSystemAndCountsThePointsAtTheirCap) {
  nlohmann::json points = nlohmann::json::array();
  for (const std::string system : {"2D rough", "3D rough"})
    for (const int layers : {2, 4, 6, 8})
      for (const double w : {2.01, 2.74, 4.53, 8.05, 12.6, 22.4, 50.3, 89.4}) {
        // A maximum at 2.74, then a power law that ends at W = 22.4.
        const double t = w < 2.5 ? 0.5 : std::pow(std::min(w, 22.4), -0.05 * (layers + 2));
        points.push_back({{"curve", fmt::format("{}, N = {}", system, layers)},
                          {"key", "drive.k_m"},
                          {"at", w},
                          {"id", fmt::format("{} {} {}", system, layers, w)},
                          {"cycles", 100},
                          {"contact_fraction", 0},
                          {"until", {{"reached", w > 3 && (w < 80 || layers != 8)}, {"text", ""}}},
                          {"T_bar_z", {{"value", t}, {"interval", {t * 0.99, t * 1.01}}}},
                          {"T_z", {{"value", t * w}, {"interval", {t * w * 0.99, t * w * 1.01}}}}});
      }
  const Reproduction r = drawn("p2-fig10", points.dump());
  const auto target = [&](const std::string& name) {
    return *std::find_if(r.targets.begin(), r.targets.end(), [&](const Target& t) { return t.name == name; });
  };
  // Each window holds the points from 2.74 to 22.4 and the last one, which decides where it ends. The points
  // at 2.74 are at their cap, those at 2.01 too, but outside, and the last one of N = 8.
  const Target all = target("alpha with N"), deep = target("alpha for N >= 6");
  EXPECT_NE(all.measured.find("2D rough: N = 2: "), std::string::npos) << all.measured;
  EXPECT_NE(all.measured.find("; 5 of 24 points at their cap"), std::string::npos) << all.measured;
  EXPECT_NE(deep.measured.find("; 3 of 12 points at their cap"), std::string::npos) << deep.measured;
  EXPECT_NE(all.reason.find("2D rough decides"), std::string::npos) << all.reason;
  EXPECT_EQ(all.reason.find("comes closer"), std::string::npos) << all.reason;
}

}  // namespace
}  // namespace twincell::reproduce::figures_test
