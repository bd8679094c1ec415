// The style of the figures: ranges, tics and labels of axes, panels, and what every script begins with.
#include "analysis/report/figure_style.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/support/figure_rules.hpp"

namespace twincell::analysis::figure_style::figure_style_test {
namespace {

PlotAxis axis(bool logarithmic, double low, double high) {
  PlotAxis a{.label = "x/σ", .logarithmic = logarithmic};
  a.show(low);
  a.show(high);
  return a;
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(FigureStyle, RangesHoldTheDataWithAMargin) {
  const PlotAxis a = axis(false, 10, 40).with_margin();
  EXPECT_NEAR(a.low, 10 - 0.04 * 30, 1e-12);
  EXPECT_NEAR(a.high, 40 + 0.04 * 30, 1e-12);
  const PlotAxis b = axis(true, 1e-2, 1e3).with_margin();
  EXPECT_NEAR(std::log10(b.low), -2.2, 1e-12);
  EXPECT_NEAR(std::log10(b.high), 3.2, 1e-12);
  const PlotAxis one = axis(false, 7, 7).with_margin();
  EXPECT_LT(one.low, 7);
  EXPECT_GT(one.high, 7);
}

TEST(FigureStyle, WhatCannotBeDrawnDoesNotChangeTheRange) {
  PlotAxis a{.label = "", .logarithmic = true};
  for (const double v : {0.0, -1.0, std::nan(""), HUGE_VAL}) a.show(v);
  EXPECT_TRUE(a.empty());
  EXPECT_LT(a.with_margin().low, a.with_margin().high);
  a.show(3);
  EXPECT_EQ(a.low, 3);
  EXPECT_EQ(a.high, 3);
}

TEST(FigureStyle, ALogarithmicPairHasOneFormat) {
  const PlotAxis brief = axis(true, 0.5, 90), wide = axis(true, 1e-7, 1), linear = axis(false, 0, 1);
  // Alone, a short axis has plain numbers at 1, 2, 5 times a power of ten, the rest without a number.
  const std::string alone = axes(brief, linear);
  EXPECT_TRUE(has(alone, "set xtics (0.5, '' 0.6 1, '' 0.7 1, '' 0.8 1, '' 0.9 1, 1, 2, '' 3 1, '' 4 1, 5,"))
      << alone;
  // An axis that contains 0.5 only of these has the tics of a linear one.
  EXPECT_TRUE(has(axes(axis(true, 0.33, 0.74), linear), "set xtics (0.4, 0.5, 0.6, 0.7)"));
  EXPECT_TRUE(has(alone, "set format x '%g'"));
  EXPECT_TRUE(has(alone, "unset logscale y\n"));
  // With a longer one, both have powers of ten.
  const std::string pair = axes(brief, wide);
  EXPECT_TRUE(has(pair, "set format x '10^{%T}'"));
  EXPECT_TRUE(has(pair, "set format y '10^{%T}'"));
  EXPECT_FALSE(has(pair, "%g"));
  EXPECT_TRUE(has(axes(brief, brief), "set format y '%g'"));
}

TEST(FigureStyle, SeriesDifferInColourAndInShape) {
  std::set<std::string> colours;
  std::set<int> shapes;
  const std::string definitions = head();
  for (std::size_t i = 0; i < 8; ++i) {
    const std::size_t line = definitions.find("set linetype " + std::to_string(i + 1) + " lc rgb '");
    ASSERT_NE(line, std::string::npos);
    const std::size_t colour = definitions.find('\'', line) + 1;
    colours.insert(definitions.substr(colour, definitions.find('\'', colour) - colour));
    shapes.insert(series_point(i));
  }
  EXPECT_EQ(colours.size(), 8U);
  EXPECT_EQ(shapes.size(), 8U);
  EXPECT_EQ(ordered_colour(0, 5), "#440154");  // the ends of viridis, the bright one darkened
  EXPECT_EQ(ordered_colour(4, 5), "#DEC31E");
}

TEST(FigureStyle, PanelsTileTheFigureAboveTheirKey) {
  const Panels panels(2, 2, 720, 900, 2);
  const std::string first = panels.panel(0), second = panels.panel(1), last = panels.panel(3);
  EXPECT_TRUE(has(first, "set lmargin at screen 0.1167\n"));   // 84/720
  EXPECT_TRUE(has(second, "set lmargin at screen 0.6167\n"));  // (360 + 84)/720
  EXPECT_TRUE(has(last, "set bmargin at screen 0.1333\n"));    // (56 + 64)/900: above the key
  const std::string key = panels.end({"keyentry with lines title 'law'"});
  EXPECT_TRUE(has(key, "set tmargin at screen 0.0622\n"));  // 56/900
  EXPECT_TRUE(has(key, "NaN notitle, keyentry with lines title 'law'"));
  EXPECT_EQ(panel_title('b', "random"), "set title '{/:Bold (b)} random'\n");
  EXPECT_EQ(panel_title(0, "one\ntwo"), "set title 'one'.\"\\n\".'two'\n");
}

TEST(FigureStyle, StyleChecksDetectViolations) {
  const std::string good = axes(axis(true, 1, 50), axis(false, 0, 1)) + panel_title('a', "2D");
  const auto complaint = [](const std::string& commands) {
    const auto all = broken_figure_rules(commands);
    return all.empty() ? std::string() : all.front();
  };
  EXPECT_EQ(complaint(good + "plot 'f.dat' using 1:2 title 'α'\n"), "");
  EXPECT_TRUE(has(complaint(good + "set ylabel ''\nplot 'f.dat'\n"), "no label"));
  EXPECT_TRUE(has(complaint(good + "set yrange [0:*]\nplot 'f.dat'\n"), "range"));
  EXPECT_TRUE(has(complaint(good + "set logscale y\nset format y '10^{%T}'\nplot 'f.dat'\n"), "format"));
  EXPECT_TRUE(has(complaint(good + "set key top right\nplot 'f.dat' title 'x'\n"), "key"));
  EXPECT_TRUE(has(complaint(good + "plot 'f.dat' title 'alpha = 2'\n"), "Greek"));
  EXPECT_TRUE(has(complaint(good + "plot 'f.dat'\nplot 'f.dat'\n"), "letter"));
}

}  // namespace
}  // namespace twincell::analysis::figure_style::figure_style_test
