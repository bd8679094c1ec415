#include "analysis/report/figure_style.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

#include "analysis/report/colours.hpp"

namespace twincell::analysis::figure_style {
namespace {

struct SeriesStyle {
  const char* colour;
  int point;
};
/// Each colour has its own shape, so that a print without colours can be read.
constexpr std::array<SeriesStyle, 8> kSeries = {{{analysis::colours::kCurves[0], kCircle},
                                                 {analysis::colours::kCurves[1], kTriangle},
                                                 {analysis::colours::kCurves[2], kSquare},
                                                 {analysis::colours::kCurves[3], kDiamond},
                                                 {analysis::colours::kCurves[4], kDown},
                                                 {analysis::colours::kCurves[5], kPentagon},
                                                 {analysis::colours::kCurves[6], unfilled(kCircle)},
                                                 {analysis::colours::kGrey, unfilled(kSquare)}}};

constexpr double kMargin = 0.04;
/// Logarithmic axes shorter than this have tics at 1, 2, 5 times a power of ten.
constexpr double kMinLongRatio = 1e3;

constexpr const char* kBandColour = "#E3E3E3";
const std::string kBand = fmt::format("behind fs solid noborder fc rgb '{}'", kBandColour);

bool is_long(const PlotAxis& a) {
  return a.logarithmic && a.high / a.low >= kMinLongRatio;
}

/// Distance of the tics of a linear axis, 1, 2 or 5 times a power of ten: 4 to 9 tics.
double tic_step(const PlotAxis& a) {
  constexpr double kTics = 4;
  const double least = (a.high - a.low) / (2 * kTics), decade = std::pow(10, std::floor(std::log10(least)));
  for (const double step : {1.0, 2.0, 5.0})
    if (step * decade >= least) return step * decade;
  return 10 * decade;
}

/// Tics of a logarithmic axis at 1, 2, 5 times the powers of ten, the other multiples without a number. On an
/// axis so short that it may contain one of these only, the tics of a linear axis.
std::string plain_tics(const PlotAxis& a) {
  std::vector<std::string> tics;
  constexpr double kRatioWithTwoNumbers = 5;
  if (a.high / a.low < kRatioWithTwoNumbers) {
    const double step = tic_step(a);
    for (int k = static_cast<int>(std::ceil(a.low / step)); k * step <= a.high; ++k)
      tics.push_back(fmt::format("{:.6g}", k * step));
    return fmt::format("{}", fmt::join(tics, ", "));
  }
  const int from = static_cast<int>(std::floor(std::log10(a.low))),
            to = static_cast<int>(std::floor(std::log10(a.high)));
  for (int decade = from; decade <= to; ++decade)
    for (int m = 1; m <= 9; ++m) {
      const double at = m * std::pow(10, decade);
      if (at < a.low || at > a.high) continue;
      const bool numbered = m == 1 || m == 2 || m == 5;
      tics.push_back(numbered ? fmt::format("{:.6g}", at) : fmt::format("'' {:.6g} 1", at));
    }
  return fmt::format("{}", fmt::join(tics, ", "));
}

std::string one_axis(char name, const PlotAxis& a, bool powers) {
  std::string s =
      fmt::format("set {0}label '{1}'\nset {0}range [{2:.9g}:{3:.9g}]\n", name, a.label, a.low, a.high);
  if (!a.logarithmic)
    return s +
           fmt::format("unset logscale {0}\nset {0}tics {1:.6g}\nset format {0} '%g'\n", name, tic_step(a));
  s += fmt::format("set logscale {0}\n", name);
  return s + (powers ? fmt::format("set {0}tics autofreq\nset format {0} '10^{{%T}}'\n", name)
                     : fmt::format("set {0}tics ({1})\nset format {0} '%g'\n", name, plain_tics(a)));
}

}  // namespace

int series_point(std::size_t i) {
  return kSeries[i % kSeries.size()].point;
}

std::string ordered_colour(std::size_t i, std::size_t n) {
  static constexpr std::array<std::array<double, 3>, 5> stops = {
      {{68, 1, 84}, {59, 82, 139}, {33, 145, 140}, {94, 201, 98}, {222, 195, 30}}};
  const double x = n < 2 ? 0.25 : 4.0 * static_cast<double>(i) / static_cast<double>(n - 1);
  const auto low = std::min<std::size_t>(3, static_cast<std::size_t>(x));
  const double w = x - static_cast<double>(low);
  const auto mix = [&](std::size_t c) {
    return static_cast<int>(std::lround((1 - w) * stops[low][c] + w * stops[low + 1][c]));
  };
  return fmt::format("#{:02X}{:02X}{:02X}", mix(0), mix(1), mix(2));
}

std::string terminal(const std::string& kind, int width, int height) {
  if (kind == "svg")
    return fmt::format("set terminal svg size {},{} dynamic enhanced font 'Arial,15' background 'white'\n",
                       width, height);
  if (kind == "pdf")
    return fmt::format("set terminal pdfcairo size {}in,{}in enhanced font 'sans,9' background 'white'\n",
                       width / 90.0, height / 90.0);
  return fmt::format(
      "set terminal pngcairo size {},{} enhanced font 'sans,14' fontscale 1.25 linewidth 1.6 pointscale 1.6 "
      "background 'white'\n",
      width * 8 / 5, height * 8 / 5);
}

std::string head() {
  std::string s = analysis::colours::for_gnuplot();
  s += "set encoding utf8\n"
       "set border lw 1 lc rgb '#444444'\n"
       "set tics textcolor rgb '#222222'\n"
       "set grid lw 0.5 lc rgb '#DDDDDD'\n"
       "set datafile missing '?'\n"
       "set key outside below center horizontal Left reverse samplen 1.5 spacing 1.15 height 0.6\n"
       "set title offset 0,-0.3\n"
       "set xlabel offset 0,0.5\n"
       "set pointintervalbox 0\n"
       "set bars small\n"
       "set palette defined (0 '#F4F1E6', 0.35 sky, 0.7 blue, 1 '#3B0F70')\n";
  for (std::size_t i = 0; i < kSeries.size(); ++i)
    s += fmt::format("set linetype {} lc rgb '{}' pt {} ps 0.9 lw {}\n", i + 1, kSeries[i].colour,
                     kSeries[i].point, kLine);
  return s;
}

void PlotAxis::show(double v) {
  if (!std::isfinite(v) || (logarithmic && !(v > 0))) return;
  low = std::min(low, v);
  high = std::max(high, v);
}

PlotAxis PlotAxis::with_margin() const {
  PlotAxis a = *this;
  if (empty()) {
    a.low = logarithmic ? 1 : 0;
    a.high = logarithmic ? 10 : 1;
  } else if (logarithmic) {
    const double by = high > low ? std::pow(high / low, kMargin) : 2;
    a.low /= by;
    a.high *= by;
  } else {
    const double by = high > low ? kMargin * (high - low) : std::max(0.5, kMargin * std::abs(low));
    a.low -= by;
    a.high += by;
  }
  return a;
}

std::string axes(const PlotAxis& x, const PlotAxis& y) {
  const PlotAxis a = x.with_margin(), b = y.with_margin();
  const bool powers = is_long(a) || is_long(b);
  return one_axis('x', a, powers) + one_axis('y', b, powers);
}

std::string stated_x(double x) {
  return fmt::format("set arrow from first {0:.6g},graph 0 to first {0:.6g},graph 1 nohead {1}\n", x,
                     kStated);
}
std::string stated_y(double y) {
  return fmt::format("set arrow from graph 0,first {0:.6g} to graph 1,first {0:.6g} nohead {1}\n", y,
                     kStated);
}
std::string stated_band_x(double low, double high) {
  return fmt::format("set object rectangle from first {:.6g},graph 0 to first {:.6g},graph 1 {}\n", low, high,
                     kBand);
}
std::string stated_line_entry(const std::string& text) {
  return fmt::format("keyentry with lines {} title '{}'", kStated, text);
}
std::string stated_band_entry(const std::string& text) {
  return fmt::format("keyentry with boxes fs solid noborder fc rgb '{}' title '{}'", kBandColour, text);
}

std::string panel_title(char letter, const std::string& text) {
  // A string in single quotes cannot hold a newline.
  const std::size_t line = text.find('\n');
  return fmt::format(
      "set title '{}{}'{}\n", letter != 0 ? fmt::format("{{/:Bold ({})}} ", letter) : std::string(),
      text.substr(0, line),
      line == std::string::npos ? std::string() : fmt::format(".\"\\n\".'{}'", text.substr(line + 1)));
}

Panels::Panels(std::size_t rows, std::size_t columns, int width, int height, int key_rows)
    : rows_(rows), columns_(columns), width_(width), height_(height), key_(24.0 * key_rows + 8) {}

std::string Panels::begin() {
  return "set multiplot\nunset key\n";
}

std::string Panels::panel(std::size_t i) const {
  constexpr double kMarginLeft = 84, kMarginRight = 16, kMarginTop = 40,
                   kMarginBottom = 64;  // px around the frame of a panel
  const double wide = width_ / static_cast<double>(columns_),
               tall = (height_ - key_) / static_cast<double>(rows_);
  const std::size_t row = i / columns_, column = i % columns_;
  const double left = wide * static_cast<double>(column), top = tall * static_cast<double>(row);
  return fmt::format(
      "set lmargin at screen {:.4f}\nset rmargin at screen {:.4f}\nset tmargin at screen {:.4f}\n"
      "set bmargin at screen {:.4f}\n",
      (left + kMarginLeft) / width_, (left + wide - kMarginRight) / width_, 1 - (top + kMarginTop) / height_,
      1 - (top + tall - kMarginBottom) / height_);
}

std::string Panels::end(const std::vector<std::string>& entries) const {
  // An empty plot as wide as the figure: gnuplot fits the columns of a key to the width of its plot.
  return fmt::format(
      "set lmargin at screen 0\nset rmargin at screen 1\nset tmargin at screen {0:.4f}\nset bmargin at "
      "screen 0\n"
      "unset title\nunset xlabel\nunset ylabel\nunset arrow\nunset label\nunset object\nunset border\nunset "
      "tics\n"
      "unset grid\nunset logscale\nunset xzeroaxis\nset key at screen 0.5,{1:.4f} center bottom horizontal\n"
      "plot [0:1][0:1] NaN notitle, {2}\nunset multiplot\n",
      key_ / height_, 6 / height_, fmt::join(entries, ", \\\n     "));
}

}  // namespace twincell::analysis::figure_style
