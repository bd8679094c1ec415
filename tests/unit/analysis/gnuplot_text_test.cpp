// User strings reach gnuplot as text, never as commands.
#include "analysis/report/gnuplot_text.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <vector>

#include "analysis/report/figure.hpp"
#include "core/error.hpp"
#include "tests/support/program.hpp"

namespace twincell::gnuplot_text_test {

using namespace analysis;

namespace {

const std::vector<std::string> kHostile = {"x'.system(\"touch PWNED\").'",
                                           "x`touch PWNED`",
                                           "x\nsystem 'touch PWNED'",
                                           "x'\n!touch PWNED\n'",
                                           "x\\'.system(\"touch PWNED\").\\'",
                                           "x@{~a^b_c&d}{",
                                           "x\"`touch PWNED`",
                                           "\xFF\xC0\xAF'\r!touch PWNED",
                                           "}\n}\nsystem('touch PWNED')"};

}  // namespace

TEST(GnuplotText, NoCharacterEndsTheString) {
  EXPECT_EQ(gnuplot_text("plain, σ/t0 (1)"), "plain, σ/t0 (1)");
  EXPECT_EQ(gnuplot_text("a_b^{c}@&~\\"), "a\\_b\\^\\{c\\}\\@\\&\\~\\\\");
  EXPECT_EQ(gnuplot_text("it's `x`\n\r\t!"), "it’s ‘x‘   !");
  EXPECT_EQ(gnuplot_text("\xFF\xC0\xAF\xED\xA0\x80"), "\uFFFD\uFFFD\uFFFD\uFFFD\uFFFD\uFFFD");
  EXPECT_EQ(gnuplot_plain_text("a_b{c}'"), "a_b{c}’");
  EXPECT_EQ(gnuplot_symbol("T_z_tau"), "T_{z\\_tau}");
  EXPECT_EQ(gnuplot_formula("ln y = ln_C + alpha ln x"), "ln y = ln C + α ln x");
  EXPECT_EQ(gnuplot_formula("ln y = c - E_b/x"), "ln y = c - E_{b}/x");
  EXPECT_EQ(gnuplot_formula("y = a (1 + c x^-b)"), "y = a (1 + c x^{-b})");
  EXPECT_EQ(gnuplot_formula("2D rough, alpha: x^2 '@'"), "2D rough, α: x^{2} ’\\@’");
  EXPECT_EQ(gnuplot_formula("x^"), "x^{}");
  for (const char* name : {"", "-e", "< cmd", "|cmd", "a'b", "../a", "a\nb", ".x"})
    EXPECT_FALSE(is_figure_name(name)) << name;
  EXPECT_TRUE(is_figure_name("s_b-1.25"));
}

TEST(GnuplotText, HostileTitlesAndLabelsAreDrawnNotRun) {
  for (const std::string& text : kHostile) {
    const TemporaryFolder folder;
    Figure f{.name = "f", .title = text};
    f.plot = "set xlabel '" + gnuplot_text(text) + "'\nset ylabel '" + gnuplot_symbol(text) +
             "'\nset title '" + gnuplot_plain_text(text) + "' noenhanced\nplot 'f.dat' using 1:2 title '" +
             gnuplot_text(text) + "'\n";
    f.data = "1 2\n2 3\n";
    draw(f, std::filesystem::path(folder / "f").parent_path());
    EXPECT_EQ(names_in(std::filesystem::path(folder / "f").parent_path()),
              (std::vector<std::string>{"f.dat", "f.gp", "f.pdf", "f.png", "f.svg"}))
        << text;
  }
  const TemporaryFolder folder;
  EXPECT_THROW(draw(Figure{.name = "< touch PWNED"}, std::filesystem::path(folder / "f").parent_path()),
               RunError);
}

TEST(GnuplotText, FitRunsNoCommandOfAColumnsName) {
  for (const std::string& name : kHostile) {
    if (name.find_first_of("\n\r\"") != std::string::npos && name != kHostile.front()) continue;
    const TemporaryFolder folder;
    std::ofstream(folder / "t.csv") << name << ",y\n1,2\n2,3.9\n3,6.1\n4,8.05\n5,9.9\n";
    const Ran ran = run_program(
        {"fit", folder / "t.csv", "--x", name, "--y", "y", "--law", "line", "-o", folder / "out"});
    ASSERT_EQ(ran.code, 0) << name << ran.err;
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(std::filesystem::path(folder / "t.csv").parent_path()))
      EXPECT_NE(entry.path().filename(), "PWNED") << name;
    EXPECT_TRUE(std::filesystem::exists(folder / "out/fit.svg"));
  }
}

}  // namespace twincell::gnuplot_text_test
