#include "calibration/camera/edge_map_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace twincell::calibration {

analysis::Figure edge_map_figure(const CellGeometry& geometry) {
  analysis::Figure f{.name = "edges", .title = "Residuals of walls and plate", .width = 640, .height = 520};
  constexpr std::size_t kDrawnPoints = 4000;  // approximate; fewer than twice as many are drawn
  const std::size_t stride = std::max<std::size_t>(1, geometry.residuals.size() / kDrawnPoints);
  f.data = "# x, y, residual, px\n";
  double squares = 0;
  for (std::size_t i = 0; i < geometry.residuals.size(); i += stride) {
    const EdgeResidual& r = geometry.residuals[i];
    squares += r.distance_px * r.distance_px * static_cast<double>(stride);
    f.data += fmt::format("{:.2f} {:.2f} {:.4f}\n", r.at.x_px, r.at.y_px, r.distance_px);
  }
  constexpr double kMinColourRange_px = 0.01;
  const double reach = std::max(
      kMinColourRange_px,
      3 * std::sqrt(squares / static_cast<double>(std::max<std::size_t>(1, geometry.residuals.size()))));
  f.plot = fmt::format(
      "set size ratio {:.5f}\nset xrange [0:{}]\nset yrange [{}:0]\nset xlabel 'x, px'\nset ylabel 'y, px'\n"
      "set cblabel 'residual, px'\nset cbrange [{:.3f}:{:.3f}]\n"
      "set palette defined (-1 blue, 0 '#DDDDDD', 1 vermilion)\n"
      "plot 'edges.dat' using 1:2:3 with points pt 7 ps 0.5 palette notitle\n",
      static_cast<double>(geometry.size.height) / geometry.size.width, geometry.size.width,
      geometry.size.height, -reach, reach);
  f.caption = fmt::format("{} points on walls and plate", geometry.residuals.size());
  return f;
}

}  // namespace twincell::calibration
