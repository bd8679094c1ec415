#include "sim/system/system.hpp"

namespace twincell::sim {

namespace {
/// Index of the first point beyond `cycles`; at least 1, at most the last index.
std::size_t segment(const std::vector<std::pair<double, double>>& points, double cycles) {
  std::size_t k = 1;
  while (k + 1 < points.size() && points[k].first <= cycles) ++k;
  return k;
}
}  // namespace

double Envelope::at(double cycles) const {
  if (points.empty()) return 1;
  if (points.size() == 1 || cycles <= points.front().first) return points.front().second;
  if (cycles >= points.back().first) return points.back().second;
  const std::size_t k = segment(points, cycles);
  const auto& [c0, f0] = points[k - 1];
  const auto& [c1, f1] = points[k];
  return f0 + (f1 - f0) * (cycles - c0) / (c1 - c0);
}

double Envelope::slope(double cycles) const {
  if (points.size() < 2 || cycles < points.front().first || cycles >= points.back().first) return 0;
  const std::size_t k = segment(points, cycles);
  return (points[k].second - points[k - 1].second) / (points[k].first - points[k - 1].first);
}

}  // namespace twincell::sim
