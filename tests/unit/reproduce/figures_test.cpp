// The figures of the papers, drawn from the stored runs in docs/reproduce, keep the rules of all figures.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "analysis/report/figure_style.hpp"
#include "reproduce/reproduction.hpp"
#include "tests/support/figure_rules.hpp"

namespace twincell::reproduce {
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

}  // namespace
}  // namespace twincell::reproduce
