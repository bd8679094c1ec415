#include "trajectory/bed_window.hpp"

#include <algorithm>
#include <limits>

namespace twincell {

double BedWindow::depth(const Vec3& r) const {
  double nearest = std::numeric_limits<double>::infinity();
  for (const int a : axes) nearest = std::min({nearest, r[a] - low[a], high[a] - r[a]});
  return nearest;
}

BedWindow bed_window(const std::vector<Vec3>& centres, const Box& box, double margin) {
  constexpr double kTail = 0.005;  // share of the beads beyond the window at each end
  BedWindow w;
  w.low = box.lower;
  w.high = box.upper;
  std::vector<double> along(centres.size());
  for (int a = 0; a < 3; ++a) {
    if (box.dimension == 2 && a == 1) continue;
    if (box.periodic(static_cast<Axis>(a))) {
      w.content *= box.size()[a];
      continue;
    }
    for (std::size_t i = 0; i < centres.size(); ++i) along[i] = centres[i][a];
    const auto tail = static_cast<std::ptrdiff_t>(kTail * static_cast<double>(along.size()));
    std::nth_element(along.begin(), along.begin() + tail, along.end());
    w.low[a] = along[static_cast<std::size_t>(tail)] - margin;
    std::nth_element(along.begin(), along.end() - 1 - tail, along.end());
    w.high[a] = *(along.end() - 1 - tail) + margin;
    w.content *= w.high[a] - w.low[a];
    w.axes.push_back(a);
  }
  for (const Vec3& r : centres) w.beads += w.depth(r) >= 0 ? 1 : 0;
  return w;
}

std::vector<Vec3> present_centres(const Frame& frame) {
  std::vector<Vec3> centres;
  for (std::size_t i = 0; i < frame.position.size(); ++i)
    if (frame.present(i) && frame.position[i].allFinite()) centres.push_back(frame.position[i]);
  return centres;
}

}  // namespace twincell
