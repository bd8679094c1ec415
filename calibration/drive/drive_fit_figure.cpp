#include "calibration/drive/drive_fit_figure.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "analysis/report/figure_style.hpp"
#include "core/plural.hpp"

namespace twincell::calibration {

analysis::Figure drive_fit_figure(const DriveFit& lock) {
  analysis::Figure f{.name = "plate", .title = "The plate's motion", .width = 640, .height = 520};
  const auto value = [&](double cycles) {
    const double theta = 2 * std::numbers::pi * cycles;
    double z = lock.z0 + lock.amplitude * std::sin(theta);
    if (lock.fit.values.size() == 6)
      z += lock.amplitude *
           (lock.fit.values[4] * std::sin(2 * theta) + lock.fit.values[5] * std::cos(2 * theta));
    return z;
  };
  analysis::figure_style::PlotAxis phases{.label = "phase of the drive, cycles", .low = 0, .high = 1},
      height{.label = "height, px"}, off{.label = "residual, px"};
  off.show(0);
  std::string kinds[2];
  for (const LockedFrame& frame : lock.frames) {
    if (frame.lock == FrameLock::unseen) continue;
    const double phase = frame.cycles - std::floor(frame.cycles);
    height.show(value(phase) + frame.residual);
    off.show(frame.residual);
    kinds[frame.lock == FrameLock::locked ? 0 : 1] +=
        fmt::format("{:.6f} {:.6f} {:.6f}\n", phase, value(phase) + frame.residual, frame.residual);
  }
  f.data = "# locked: phase, height, residual, px\n" + kinds[0] + "\n\n# fit: phase, height\n";
  for (int i = 0; i <= 200; ++i) f.data += fmt::format("{:.4f} {:.6f}\n", i / 200.0, value(i / 200.0));
  const bool others = !kinds[1].empty();
  if (others) f.data += "\n\n# out of lock\n" + kinds[1];
  f.plot = fmt::format(
      "set multiplot\nset lmargin at screen 0.14\nset rmargin at screen 0.96\n"
      "{}set format x ''\nset xlabel ''\nset tmargin at screen 0.95\nset bmargin at screen 0.47\n"
      "set key at screen 0.5,0.01 center bottom horizontal\n"
      "plot 'plate.dat' index 1 using 1:2 with lines lw {} lc rgb blue title 'fit', 'plate.dat' index 0 "
      "using 1:2 with points pt 7 ps 0.5 lc rgb '#222222' title 'frames'{}\n"
      "unset key\n{}set tmargin at screen 0.43\nset bmargin at screen 0.20\n"
      "plot 0 with lines lw {} lc rgb blue, 'plate.dat' index 0 using 1:3 with points pt 7 ps 0.5 lc rgb "
      "'#222222'\nunset multiplot\n",
      analysis::figure_style::axes(phases, height), analysis::figure_style::kCurve,
      others ? ", 'plate.dat' index 2 using 1:2 with points pt 2 ps 0.9 lc rgb vermilion title 'out of lock'"
             : "",
      analysis::figure_style::axes(phases, off), analysis::figure_style::kLine);
  f.caption = fmt::format("{} locked, {} out of lock", plural(lock.locked, "frame"), lock.out_of_lock);
  return f;
}

}  // namespace twincell::calibration
