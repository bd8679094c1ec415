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

/// Contents of the figure: the rows of the data file, and the axes that contain them.
struct DrawnFit {
  std::string used, left_out, limits, curve;  // rows of the data file
  analysis::figure_style::PlotAxis x, y, off;
  double low = INFINITY, high = -INFINITY;  // range of x of the points used
};

bool is_reciprocal(const Law& law) {
  return law.axis == Law::Axis::reciprocal;
}

/// The abscissa at which x is drawn.
double drawn(const Law& law, double x) {
  return is_reciprocal(law) ? 1 / x : x;
}

DrawnFit empty_axes(const CurveFit& fit, const std::string& x_name, const std::string& y_name) {
  const Law& law = *fit.law;
  DrawnFit out;
  out.x.label =
      is_reciprocal(law) ? "1/" + analysis::gnuplot_symbol(x_name) : analysis::gnuplot_symbol(x_name);
  out.x.logarithmic = law.axis == Law::Axis::logarithmic;
  out.y.label = analysis::gnuplot_symbol(y_name);
  out.y.logarithmic = law.logarithmic;
  out.off.label = fit.weighted ? "residual/error" : law.logarithmic ? "residual in ln y" : "residual";
  out.off.show(0);
  return out;
}

void add_used_point(DrawnFit& out, const CurveFit& fit, const DataPoint& p) {
  const Law& law = *fit.law;
  out.low = std::min(out.low, p.x);
  out.high = std::max(out.high, p.x);
  const double error = error_of(p), curve = fit.at(p.x);
  const double off = law.logarithmic ? std::log(p.y / curve) : p.y - curve;
  const double unit = !fit.weighted ? 1 : law.logarithmic ? error / p.y : error;
  const double least = law.logarithmic ? p.y * std::exp(-error / p.y) : p.y - error,
               most = law.logarithmic ? p.y * std::exp(error / p.y) : p.y + error;
  out.used +=
      fmt::format("{:.9g} {:.9g} {:.9g} {:.9g} {:.9g}\n", drawn(law, p.x), p.y, least, most, off / unit);
  for (const double y : {p.y, least, most}) out.y.show(y);
  out.off.show(off / unit);
}

void add_points(DrawnFit& out, const CurveFit& fit, const std::vector<DataPoint>& points) {
  const Law& law = *fit.law;
  std::size_t limit = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const DataPoint& p = points[i];
    if (fit.use[i] != PointUse::invalid) out.x.show(drawn(law, p.x));
    if (fit.use[i] == PointUse::used) {
      add_used_point(out, fit, p);
    } else if (fit.use[i] == PointUse::zero && p.trials > 0) {
      out.y.show(fit.upper_limits[limit]);
      out.limits += fmt::format("{:.9g} {:.9g}\n", drawn(law, p.x), fit.upper_limits[limit++]);
    } else if (fit.use[i] == PointUse::outside && (!law.logarithmic || p.y > 0)) {
      out.y.show(p.y);
      out.left_out += fmt::format("{:.9g} {:.9g}\n", drawn(law, p.x), p.y);
    }
  }
}

/// Adds the curve and its 95 % band over the range of the points used.
void add_curve(DrawnFit& out, const CurveFit& fit) {
  const Law& law = *fit.law;
  const double reach = fit.weighted
                           ? analysis::student_t_95(1e9)
                           : analysis::student_t_95(static_cast<double>(fit.n_used - fit.fit.values.size()));
  // A band as wide as the data on either side must not shrink the points.
  const double length = law.logarithmic ? out.y.high / out.y.low : out.y.high - out.y.low;
  const double floor = law.logarithmic ? out.y.low / length : out.y.low - length,
               ceiling = law.logarithmic ? out.y.high * length : out.y.high + length;
  const bool steps_in_ratio = law.axis == Law::Axis::logarithmic && out.low > 0;
  for (int s = 0; s <= kCurveSteps; ++s) {
    const double share = static_cast<double>(s) / kCurveSteps;
    const double x = steps_in_ratio ? out.low * std::pow(out.high / out.low, share)
                                    : out.low + (out.high - out.low) * share;
    const double y = fit.at(x), error = fit.error_at(x);
    const double half = std::isfinite(error) ? reach * error : 0;
    const double least = law.logarithmic ? y * std::exp(-half) : y - half,
                 most = law.logarithmic ? y * std::exp(half) : y + half;
    out.curve += fmt::format("{:.9g} {:.9g} {:.9g} {:.9g}\n", drawn(law, x), y, least, most);
    for (const double end : {least, y, most}) out.y.show(std::max(floor, std::min(end, ceiling)));
  }
}

/// Writes the data file. \returns the clauses of the plot command for the points that were not fitted
std::string write_data(const DrawnFit& out, analysis::Figure& f) {
  f.data =
      "# points used: x, y, low, high, residual\n" + out.used + "\n\n# curve: x, y, 95 % band\n" + out.curve;
  std::string clauses;
  int index = 2;
  if (!out.left_out.empty()) {
    f.data += "\n\n# points outside the window: x, y\n" + out.left_out;
    clauses += fmt::format(
        ", 'fit.dat' index {} using 1:2 with points pt 6 ps 1.1 lw 1.5 lc rgb grey title "
        "'outside the window'",
        index++);
  }
  if (!out.limits.empty()) {
    f.data += "\n\n# zeros: x, 95 % upper limit\n" + out.limits;
    clauses += fmt::format(
        ", 'fit.dat' index {} using 1:2 with points pt 11 ps 1.3 lc rgb vermilion title "
        "'zero: 95 % upper limit'",
        index++);
  }
  return clauses;
}

/// The two panels: points and curve above the residuals. Both have the same x axis; the upper one leaves its
/// numbers to the lower one. \param clauses of write_data
std::string plot_of(const DrawnFit& out, const Law& law, const std::string& title,
                    const std::string& clauses) {
  std::string law_label = law.name;
  std::replace(law_label.begin(), law_label.end(), '_', ' ');
  return fmt::format(
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
      analysis::figure_style::axes(out.x, out.y),
      analysis::gnuplot_formula(title.empty() ? law.formula : title), analysis::figure_style::kCurve,
      analysis::gnuplot_text(law_label), analysis::figure_style::kCircle, clauses,
      analysis::figure_style::axes(out.x, out.off), analysis::figure_style::kLine,
      analysis::figure_style::kLine, analysis::figure_style::kCircle);
}

}  // namespace

analysis::Figure fit_figure(const CurveFit& fit, const std::vector<DataPoint>& points,
                            const std::string& x_name, const std::string& y_name, const std::string& name,
                            const std::string& title) {
  const Law& law = *fit.law;
  analysis::Figure f{.name = name, .title = law.formula, .width = 560, .height = 640};
  DrawnFit out = empty_axes(fit, x_name, y_name);
  add_points(out, fit, points);
  add_curve(out, fit);
  const std::string clauses = write_data(out, f);
  f.plot = reading(name, plot_of(out, law, title, clauses));
  f.caption = law.formula + ", fitted to " + fmt::format("{} points", fit.n_used);
  return f;
}

}  // namespace twincell::calibration
