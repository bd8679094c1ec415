#include "calibration/camera/size_statistics_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/plural.hpp"

namespace twincell::calibration {

analysis::Figure size_statistics_figure(const SizeStatistics& census, double unit_px) {
  analysis::Figure f{.name = "beads", .title = "Diameters of the beads", .width = 560, .height = 400};
  const bool px = std::isfinite(unit_px);
  const double unit = px ? unit_px : 1;
  const std::vector<double>& d = census.diameters;
  const double low = d.front() * unit, high = d.back() * unit;
  const auto bins = static_cast<std::size_t>(std::clamp(std::sqrt(static_cast<double>(d.size())), 8.0, 40.0));
  const double width = high > low ? (high - low) / static_cast<double>(bins) : 1e-6;
  std::vector<std::size_t> counts(bins, 0);
  for (const double x : d)
    ++counts[std::min(bins - 1, static_cast<std::size_t>(std::max(0.0, (x * unit - low) / width)))];
  f.data = "# diameter, discs\n";
  for (std::size_t b = 0; b < bins; ++b)
    f.data += fmt::format("{:.6g} {}\n", low + (static_cast<double>(b) + 0.5) * width, counts[b]);
  f.plot = fmt::format(
      "set xlabel 'diameter, {}'\nset ylabel 'discs'\nset yrange [0:*]\nset boxwidth {:.6g}\nset style fill "
      "solid 0.6 border\nset arrow from {:.6g}, graph 0 to {:.6g}, graph 1 nohead lw 2 lc rgb vermilion\n"
      "plot 'beads.dat' using 1:2 with boxes lc rgb blue notitle\n",
      px ? "px" : "σ", width, census.diameter.value * unit, census.diameter.value * unit);
  f.caption = fmt::format("{} in {}; the line is the mean", plural(census.sizes, "disc"),
                          plural(census.frames, "frame"));
  return f;
}

}  // namespace twincell::calibration
