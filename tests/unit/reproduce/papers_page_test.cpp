// The page on the papers, from documents as `reproduce` writes them.

#include "reproduce/papers_page.hpp"

#include <gtest/gtest.h>

namespace twincell::reproduce::papers_page_test {
namespace {

const std::string kOne = R"({"title": "Fortini & Huang 2015, Fig. 4", "complete": false, "core_minutes": 12.3,
  "targets": [
    {"name": "T_g* rises", "expected": "everywhere", "measured": "3 [2, 4]", "runs": "3 runs, 200 cycles",
     "verdict": "pass", "reason": ""},
    {"name": "|slope|", "expected": "2 +- 1", "measured": "", "runs": "", "verdict": "absent", "reason": "a < b"},
    {"name": "E_b", "expected": "7 +- 1", "measured": "8", "runs": "", "verdict": "consistent", "reason": ""}]})";
const std::string kTwo = R"({"title": "Bhateja et al. 2016, Fig. 2", "complete": true,
  "targets": [{"name": "W_f", "expected": "2 to 4.5", "measured": "3", "verdict": "fail"}]})";

TEST(PapersPage, HoldsEveryTargetOnceAndCountsTheVerdicts) {
  const std::string page =
      papers_page({{"p1-fig4", kOne}, {"p2-fig2", kTwo}}, "twincell reproduce --all --budget 2");
  const auto has = [&](const std::string& text) { return page.find(text) != std::string::npos; };
  EXPECT_TRUE(has("`twincell reproduce --all --budget 2`"));
  // Columns: pass, consistent, fail, inconclusive, absent, core-minutes.
  EXPECT_TRUE(has("| `p1-fig4` | 1 | 1 | 0 | 0 | 1 | 12 |\n")) << page;
  EXPECT_TRUE(has("| `p2-fig2` | 0 | 0 | 1 | 0 | 0 | – |\n")) << page;
  EXPECT_TRUE(has("| all | 1 | 1 | 1 | 0 | 1 |  |\n")) << page;
  EXPECT_TRUE(has("| T_g\\* rises | everywhere | 3 \\[2, 4\\] | 3 runs, 200 cycles | pass |  |\n")) << page;
  EXPECT_TRUE(has("| \\|slope\\| | 2 +- 1 | – |  | absent | a \\< b |\n")) << page;
  EXPECT_TRUE(has("Not all runs fitted into the time limit."));
  EXPECT_LT(page.find("## Fortini"), page.find("### p1-fig4"));
  EXPECT_LT(page.find("### p1-fig4"), page.find("## Bhateja"));
  EXPECT_LT(page.find("## Bhateja"), page.find("### p2-fig2"));
  // Every table has the columns of its head in every row.
  std::size_t columns = 0, begin = 0;
  for (std::size_t end; (end = page.find('\n', begin)) != std::string::npos; begin = end + 1) {
    const std::string line = page.substr(begin, end - begin);
    std::size_t bars = 0;
    for (std::size_t k = 0; k < line.size(); ++k)
      bars += line[k] == '|' && (k == 0 || line[k - 1] != '\\') ? 1 : 0;
    if (bars > 0 && columns > 0) {
      EXPECT_EQ(bars, columns) << line;
    }
    columns = bars;
  }
}

TEST(PapersPage, CountsNoTargetTwice) {
  const std::string page =
      papers_page({{"p1-fig4", kOne}, {"p1-truncate", kOne, true}}, "twincell reproduce --all");
  const auto has = [&](const std::string& text) { return page.find(text) != std::string::npos; };
  EXPECT_TRUE(has("| `p1-truncate`, not in the sum | 1 | 1 | 0 | 0 | 1 |")) << page;
  EXPECT_TRUE(has("| all | 1 | 1 | 0 | 0 | 1 |  |\n")) << page;
}

TEST(PapersPage, NamesTargetsThatAreNotInTheSum) {
  const std::string page = papers_page({{"p1-fig5",
                                         R"({"title": "Fig. 5", "targets": [
             {"name": "A1", "expected": "0", "measured": "0", "verdict": "pass", "not_counted": "counted in `p1-fig3`"},
             {"name": "A2", "expected": "130", "measured": "85", "verdict": "fail"}]})"}},
                                       "twincell reproduce --all");
  const auto has = [&](const std::string& text) { return page.find(text) != std::string::npos; };
  EXPECT_TRUE(has("| `p1-fig5` | 0 | 0 | 1 | 0 | 0 |")) << page;
  EXPECT_TRUE(has("| pass; not in the sum: counted in `p1-fig3` |")) << page;
}

TEST(PapersPage, ShowsFiguresAndConditionsBelowTheTable) {
  const std::string page = papers_page(
      {{"p1-fig4",
        R"({"title": "Fig. 4", "targets": [], "figures": [{"name": "p1-fig4", "caption": "T_g* [m g sigma]"}],
            "conditions": ["mu = 0.6", "n = 6.37"], "cheaper": ["three seeds"]})"}},
      "twincell reproduce --all");
  const auto has = [&](const std::string& text) { return page.find(text) != std::string::npos; };
  EXPECT_TRUE(has("\n![p1-fig4](p1-fig4/p1-fig4.svg)\n\n*p1-fig4*: T_g\\* \\[m g sigma\\]\n")) << page;
  EXPECT_TRUE(has("\nConditions: mu = 0.6; n = 6.37.\n")) << page;
  EXPECT_TRUE(has("\nSimplifications: three seeds.\n")) << page;
}

}  // namespace
}  // namespace twincell::reproduce::papers_page_test
