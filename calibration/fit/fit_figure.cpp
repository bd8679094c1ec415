#include "calibration/fit/fit_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/report/figure_style.hpp"
#include "analysis/report/gnuplot_text.hpp"

namespace twincell::calibration {
namespace {

constexpr int kCurveSteps = 200;

double error_of(const DataPoint& p) {
  if (p.sigma > 0) return p.sigma;
  return p.trials > 0 ? std::sqrt(std::max(0.0, p.y * (1 - p.y)) / p.trials) : 0;
}

/// Inserts the name of the data file into the gnuplot commands.
std::string reading(const std::string& name, std::string plot) {
  static const std::string kFile = "'fit.dat'";
  for (std::size_t at = plot.find(kFile); at != std::string::npos; at = plot.find(kFile, at + name.size()))
    plot.replace(at, kFile.size(), "'" + name + ".dat'");
  return plot;
}

}  // namespace

analysis::Figure fit_figure(const CurveFit& fit, const std::vector<DataPoint>& points,
                            const std::string& x_name, const std::string& y_name, const std::string& name,
                            const std::string& title) {
  const Law& law = *fit.law;
  const auto drawn = [&](double x) { return law.axis == Law::Axis::reciprocal ? 1 / x : x; };
  analysis::Figure f{.name = name, .title = law.formula, .width = 560, .height = 640};

  double low = INFINITY, high = -INFINITY;
  std::string used, left_out, limits;
  const std::string x_label = law.axis == Law::Axis::reciprocal ? "1/" + analysis::gnuplot_symbol(x_name)
                                                                : analysis::gnuplot_symbol(x_name);
  analysis::figure_style::Axis x_axis{.label = x_label, .logarithmic = law.axis == Law::Axis::logarithmic},
      y_axis{.label = analysis::gnuplot_symbol(y_name), .logarithmic = law.logarithmic},
      off_axis{.label = fit.weighted      ? "residual/error"
                        : law.logarithmic ? "residual in ln y"
                                          : "residual"};
  off_axis.show(0);
  std::size_t limit = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const DataPoint& p = points[i];
    if (fit.use[i] != PointUse::invalid) x_axis.show(drawn(p.x));
    if (fit.use[i] == PointUse::used) {
      low = std::min(low, p.x);
      high = std::max(high, p.x);
      const double error = error_of(p), curve = fit.at(p.x);
      const double off = law.logarithmic ? std::log(p.y / curve) : p.y - curve;
      const double unit = !fit.weighted ? 1 : law.logarithmic ? error / p.y : error;
      const double least = law.logarithmic ? p.y * std::exp(-error / p.y) : p.y - error,
                   most = law.logarithmic ? p.y * std::exp(error / p.y) : p.y + error;
      used += fmt::format("{:.9g} {:.9g} {:.9g} {:.9g} {:.9g}\n", drawn(p.x), p.y, least, most, off / unit);
      for (const double y : {p.y, least, most}) y_axis.show(y);
      off_axis.show(off / unit);
    } else if (fit.use[i] == PointUse::zero && p.trials > 0) {
      y_axis.show(fit.upper_limits[limit]);
      limits += fmt::format("{:.9g} {:.9g}\n", drawn(p.x), fit.upper_limits[limit++]);
    } else if (fit.use[i] == PointUse::outside && (!law.logarithmic || p.y > 0)) {
      y_axis.show(p.y);
      left_out += fmt::format("{:.9g} {:.9g}\n", drawn(p.x), p.y);
    }
  }
  std::string curve;
  const double reach = fit.weighted
                           ? analysis::student_t_95(1e9)
                           : analysis::student_t_95(static_cast<double>(fit.n_used - fit.fit.values.size()));
  // A band as wide as the data on either side must not shrink the points.
  const double length = law.logarithmic ? y_axis.high / y_axis.low : y_axis.high - y_axis.low;
  const double floor = law.logarithmic ? y_axis.low / length : y_axis.low - length,
               ceiling = law.logarithmic ? y_axis.high * length : y_axis.high + length;
  const bool steps_in_ratio = law.axis == Law::Axis::logarithmic && low > 0;
  for (int s = 0; s <= kCurveSteps; ++s) {
    const double share = static_cast<double>(s) / kCurveSteps;
    const double x = steps_in_ratio ? low * std::pow(high / low, share) : low + (high - low) * share;
    const double y = fit.at(x), error = fit.error_at(x);
    const double half = std::isfinite(error) ? reach * error : 0;
    const double least = law.logarithmic ? y * std::exp(-half) : y - half,
                 most = law.logarithmic ? y * std::exp(half) : y + half;
    curve += fmt::format("{:.9g} {:.9g} {:.9g} {:.9g}\n", drawn(x), y, least, most);
    for (const double end : {least, y, most}) y_axis.show(std::max(floor, std::min(end, ceiling)));
  }
  f.data = "# points used: x, y, low, high, residual\n" + used + "\n\n# curve: x, y, 95 % band\n" + curve;
  std::string more;
  int index = 2;
  if (!left_out.empty()) {
    f.data += "\n\n# points outside the window: x, y\n" + left_out;
    more += fmt::format(
        ", 'fit.dat' index {} using 1:2 with points pt 6 ps 1.1 lw 1.5 lc rgb grey title "
        "'outside the window'",
        index++);
  }
  if (!limits.empty()) {
    f.data += "\n\n# zeros: x, 95 % upper limit\n" + limits;
    more += fmt::format(
        ", 'fit.dat' index {} using 1:2 with points pt 11 ps 1.3 lc rgb vermilion title "
        "'zero: 95 % upper limit'",
        index++);
  }
  std::string law_label = law.name;
  std::replace(law_label.begin(), law_label.end(), '_', ' ');
  // Both panels have the same x axis; the upper one leaves its numbers to the lower one.
  f.plot = fmt::format(
      "set multiplot\nset lmargin at screen 0.19\nset rmargin at screen 0.95\n"
      "{}set format x ''\nset xlabel ''\nset title '{}'\nset tmargin at screen 0.92\nset bmargin at screen "
      "0.44\n"
      "set key at screen 0.5,0.01 center bottom horizontal maxcols 3\n"
      "plot 'fit.dat' index 1 using 1:3:4 with filledcurves fc rgb sky fs transparent solid 0.35 noborder "
      "title '95 % band', 'fit.dat' index 1 using 1:2 with lines lw {} lc rgb blue title '{}', 'fit.dat' "
      "index 0 using 1:2:3:4 with yerrorbars pt {} lc rgb '#222222' title 'points'{}\n"
      "unset key\nunset title\n{}set tmargin at screen 0.40\nset bmargin at screen 0.21\n"
      "plot 0 with lines lw {} lc rgb blue, 'fit.dat' index 0 using 1:5 with impulses lw {} lc rgb grey, "
      "'fit.dat' index 0 using 1:5 with points pt {} lc rgb '#222222'\nunset multiplot\n",
      analysis::figure_style::axes(x_axis, y_axis),
      analysis::gnuplot_formula(title.empty() ? law.formula : title), analysis::figure_style::kCurve,
      analysis::gnuplot_text(law_label), analysis::figure_style::kCircle, more,
      analysis::figure_style::axes(x_axis, off_axis), analysis::figure_style::kLine,
      analysis::figure_style::kLine, analysis::figure_style::kCircle);
  f.plot = reading(name, f.plot);
  f.caption = law.formula + ", fitted to " + fmt::format("{} points", fit.n_used);
  return f;
}

}  // namespace twincell::calibration
