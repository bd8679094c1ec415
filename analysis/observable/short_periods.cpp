#include "analysis/observable/short_periods.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace twincell::analysis {

std::vector<std::string> short_periods(const TrajectoryInfo& info, const AnalysisOptions& options) {
  const Box& box = info.box;
  const bool planar = box.dimension == 2;
  const double cutoff = neighbour_cutoff(info, options),
               reach = planar ? std::max(cutoff, 2 * options.cell_radius) : cutoff;
  std::vector<std::string> sentences;
  for (const Axis axis : {Axis::x, Axis::y, Axis::z})
    if (const double period = box.size()[static_cast<int>(axis)];
        box.periodic(axis) && !(planar && axis == Axis::y) && period < 2 * reach)
      sentences.push_back(fmt::format(
          "the period along {}, {:g} sigma, is shorter than twice the reach of a neighbour, {:g} sigma; one "
          "image of each bead counts, so that order, contact numbers and Voronoi cells are not those of the "
          "periodic bed",
          "xyz"[static_cast<int>(axis)], period, reach));
  return sentences;
}

}  // namespace twincell::analysis
