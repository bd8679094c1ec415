#include "sim/run/driven_work.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace twincell::sim {

namespace {

constexpr std::array kGamma = {1.0, 1.5, 2.0, 3.0, 5.0};
constexpr std::array kLayers = {10.0, 40.0, 80.0, 160.0};
/// [layers][gamma]
constexpr double kWork[kLayers.size()][kGamma.size()] = {{1, 0.656, 0.474, 0.263, 0.298},
                                                         {1, 0.768, 0.638, 0.447, 0.407},
                                                         {1, 0.867, 0.781, 0.564, 0.475},
                                                         {1, 0.993, 0.958, 0.866, 0.729}};

/// The interval of a grid that contains x, clamped to the grid, and the position in it, 0 to 1.
struct Place {
  std::size_t below;
  double share;
};

template <std::size_t n, class Scale>
Place place_in(const std::array<double, n>& grid, double x, Scale scale) {
  x = std::clamp(x, grid.front(), grid.back());
  std::size_t k = 0;
  while (k + 2 < n && x >= grid[k + 1]) ++k;
  return {k, (scale(x) - scale(grid[k])) / (scale(grid[k + 1]) - scale(grid[k]))};
}

}  // namespace

double driven_work(double gamma, double layers) {
  const Place g = place_in(kGamma, gamma, [](double x) { return x; });
  const Place l = place_in(kLayers, layers, [](double x) { return std::log(x); });
  const auto at = [&](std::size_t row) {
    return std::lerp(kWork[row][g.below], kWork[row][g.below + 1], g.share);
  };
  return std::lerp(at(l.below), at(l.below + 1), l.share);
}

}  // namespace twincell::sim
