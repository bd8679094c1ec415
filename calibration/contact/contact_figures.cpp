#include "calibration/contact/contact_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/report/figure_style.hpp"
#include "analysis/report/gnuplot_text.hpp"

namespace twincell::calibration {

analysis::Figure bounce_figure(const BounceFit& fit) {
  analysis::Figure f{.name = "bounce", .title = "Restitution of each impact", .width = 560, .height = 400};
  f.data = "# speed, e_n, error\n";
  analysis::figure_style::PlotAxis speed{.label = "impact speed"}, e_n{.label = "e_n"};
  for (const double side : {-1.96, 1.96}) e_n.show(fit.restitution + side * fit.restitution_error);
  for (const BounceImpact& i : fit.impacts) {
    speed.show(i.speed);
    e_n.show(i.restitution - i.error);
    e_n.show(i.restitution + i.error);
    f.data += fmt::format("{:.6g} {:.6g} {:.3g}\n", i.speed, i.restitution, i.error);
  }
  f.plot = fmt::format(
      "{}plot {:.8g} with lines lw 2 lc rgb blue title 'mean', {:.8g} with lines dt 2 lc rgb blue title '± "
      "95 %', {:.8g} with lines dt 2 lc rgb blue notitle, 'bounce.dat' using 1:2:3 with yerrorbars pt 7 lc "
      "rgb '#222222' title 'impacts'\n",
      analysis::figure_style::axes(speed, e_n), fit.restitution,
      fit.restitution + 1.96 * fit.restitution_error, fit.restitution - 1.96 * fit.restitution_error);
  f.caption = fmt::format("{} impacts between {} flights", fit.impacts.size(), fit.flights);
  return f;
}

analysis::Figure collisions_figure(const FoundCollisions& found, const WaltonFit& fit, double shape) {
  analysis::Figure f{.name = "collisions", .title = "Collisions of two beads", .width = 720, .height = 400};
  double largest = 0;
  analysis::figure_style::PlotAxis speed{.label = "impact speed, σ/t_0", .low = 0},
      e_n{.label = "e_n", .low = 0, .high = 1}, psi_1{.label = "Ψ_1", .low = 0}, psi_2{.label = "Ψ_2"};
  f.data = "# speed, e_n, psi_1, psi_2\n";
  for (const Impact& i : found.impacts) {
    f.data += fmt::format("{:.6g} {:.6g} {:.6g} {:.6g}\n", i.speed, i.restitution, i.psi_1, i.psi_2);
    speed.show(i.speed);
    e_n.show(i.restitution);
    if (std::isfinite(i.psi_1)) largest = std::max(largest, i.psi_1);
  }
  std::string curve;
  if (fit.has_tangential) {
    const double mu = fit.tangential.values[0], beta = fit.tangential.values[1],
                 reach = (1 + fit.restitution) * (1 + 1 / shape);
    curve = fmt::format(
        "(-({:.8g})*x > x-({:.8g})) ? -({:.8g})*x : x-({:.8g}) with lines lw 2 lc rgb blue notitle, ", beta,
        mu * reach, beta, mu * reach);
  }
  constexpr double kMaxDrawnPsi_1 = 8;
  psi_1.show(std::min(std::max(largest, 1.0), kMaxDrawnPsi_1));
  for (const Impact& i : found.impacts)
    if (i.psi_1 <= kMaxDrawnPsi_1) psi_2.show(i.psi_2);
  const analysis::figure_style::Panels panels(1, 2, f.width, f.height, 1);
  constexpr const char* kPoints = "with points pt 7 ps 0.4 lc rgb '#222222' notitle";
  f.plot = analysis::figure_style::Panels::begin() + panels.panel(0) +
           analysis::figure_style::axes(speed, e_n) +
           analysis::figure_style::panel_title('a', "restitution") +
           fmt::format("plot {:.8g} with lines lw 2 lc rgb blue notitle, 'collisions.dat' using 1:2 {}\n",
                       fit.restitution, kPoints) +
           panels.panel(1) + analysis::figure_style::axes(psi_1, psi_2) + "set samples 600\n" +
           analysis::figure_style::panel_title(
               'b', found.spins ? "tangential impact" : "tangential impact: no spins") +
           fmt::format("plot {}{}\n", curve,
                       found.spins ? fmt::format("'collisions.dat' using 3:4 {}", kPoints) : "NaN notitle") +
           panels.end({"keyentry with lines lw 2 lc rgb blue title 'mean, fit'",
                       "keyentry with points pt 7 ps 0.4 lc rgb '#222222' title 'collisions'"});
  f.caption = fmt::format("{} collisions", fit.impacts);
  return f;
}

analysis::Figure profile_figure(const Inference& inference) {
  const std::size_t n = inference.profiles.size();
  double highest = 0;
  for (const Profile& p : inference.profiles) highest = std::max(highest, p.drop);
  analysis::Figure f{.name = "profile",
                     .title = "Profiles of the parameters",
                     .width = static_cast<int>(420 * n),
                     .height = 400};
  f.plot = fmt::format(
      "set multiplot layout 1,{}\nset yrange [0:{:.6g}]\nset ylabel 'χ^2 above its minimum'\nunset key\n", n,
      3 * highest);
  for (std::size_t i = 0; i < n; ++i) {
    const Profile& p = inference.profiles[i];
    f.data += fmt::format("# {}, chi^2 above its least\n", analysis::gnuplot_plain_text(p.sought.name));
    for (std::size_t k = 0; k < p.at.size(); ++k)
      f.data += fmt::format("{:.6g} {:.6g}\n", p.at[k], p.chi2[k] - inference.chi2);
    f.data += "\n\n";
    std::string label = p.sought.name;
    std::replace(label.begin(), label.end(), '_', ' ');
    f.plot += fmt::format(
        "set xlabel '{}'\nset xrange [{:.6g}:{:.6g}]\nplot 'profile.dat' index {} using 1:2 with lines lw 2 "
        "lc rgb blue, {:.6g} with lines dt 2 lc rgb vermilion\n",
        analysis::gnuplot_text(label), p.sought.lower, p.sought.upper, i, p.drop);
  }
  f.plot += "unset multiplot\n";
  f.caption = "The dashed line marks the 95 % interval";
  return f;
}

analysis::Figure curve_figure(const std::string& name, const std::vector<double>& measured,
                              const std::vector<double>& predicted) {
  analysis::Figure f{.name = name, .title = name + ", measured and for the best parameters"};
  f.data = "# element, measured, of the best parameters\n";
  for (std::size_t k = 0; k < measured.size(); ++k)
    f.data += fmt::format("{} {:.8g} {:.8g}\n", k, measured[k], predicted[k]);
  std::string label = name;
  std::replace(label.begin(), label.end(), '_', ' ');
  f.plot = fmt::format(
      "set xlabel 'element'\nset ylabel '{0}'\n"
      "plot '{1}.dat' using 1:2 with points pt 7 lc rgb '#222222' title 'measured', '{1}.dat' using 1:3 with "
      "lines lw 2 lc rgb blue title 'best parameters'\n",
      analysis::gnuplot_text(label), name);
  f.caption =
      "The curve of the best parameters is composed of the principal components of the curves of the runs";
  return f;
}

}  // namespace twincell::calibration
