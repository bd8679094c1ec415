#include "analysis/order/voronoi_area.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "analysis/observable/ratio_density.hpp"

namespace twincell::analysis {
namespace {

/// Definition 1 left out cells beyond the radius also in a box that is periodic on all sides.
constexpr int kDefinition = 2;
constexpr NamedResult kResults[] = {
    {.name = "voronoi_area", .range = Range::not_negative, .definition = kDefinition},
    {.name = "voronoi_area_variance", .range = Range::not_negative, .definition = kDefinition},
    {.name = "voronoi_area_density", .definition = kDefinition},
    {.name = "voronoi_area_density_low", .definition = kDefinition},
    {.name = "voronoi_area_density_high", .definition = kDefinition},
    {.name = "voronoi_area_ratio", .range = Range::not_negative, .definition = kDefinition}};
const char* const kSource = "Starr et al. 2002";

/// Areas of the enclosed cells, sigma^2.
std::vector<double> enclosed_areas(const VoronoiCells& cells) {
  std::vector<double> areas;
  const Neighbours& n = cells.neighbours;
  for (std::size_t i = 0; i < cells.enclosed.size(); ++i) {
    if (cells.enclosed[i] == 0) continue;
    double area = 0;
    for (std::size_t e = n.first[i]; e < n.first[i + 1]; ++e)
      area += 0.25 * std::hypot(n.bond[e].x(), n.bond[e].z()) * cells.edge[e];
    areas.push_back(area);
  }
  return areas;
}

/// The beads that a frame has.
std::size_t present_beads(const Frame& frame) {
  std::size_t n = 0;
  for (std::size_t i = 0; i < frame.position.size(); ++i)
    if (frame.present(i) && frame.position[i].allFinite()) ++n;
  return n;
}

/// Areas of all cells of a box without edges: the radius doubles until every cell is enclosed, or the period
/// or the number of pairs allows no more.
/// \param[in,out] radius of `cells`, becomes the last one \param n number of beads
std::vector<double> areas_in_period(const Frame& frame, const Box& box, const VoronoiCells& cells,
                                    double& radius, std::size_t n) {
  constexpr double kMostPairs = 400;  // of a bead on average, so that memory remains bounded
  const Vec3 size = box.size();
  // voronoi_cells needs a period above four radii.
  const double widest = 0.2499 * std::min(size.x(), size.z()),
               densest = std::sqrt(kMostPairs * size.x() * size.z() /
                                   (4 * std::numbers::pi * static_cast<double>(std::max<std::size_t>(n, 1))));
  const double limit = std::min(widest, densest);
  std::vector<double> areas = enclosed_areas(cells);
  while (areas.size() < n && radius < limit) {
    radius = std::min(2 * radius, limit);
    areas = enclosed_areas(voronoi_cells(frame, box, radius));
  }
  return areas;
}

class VoronoiArea : public Observable {
 public:
  explicit VoronoiArea(const AnalysisContext& context)
      : box_(context.info.box),
        radius_(context.options.cell_radius),
        planar_(box_.dimension == 2),
        density_(kVoronoiAreaRange, kVoronoiAreaWidth) {}

  void add(const FrameView& view) override {
    if (!planar_) return;
    const std::size_t present = present_beads(view.frame());
    double radius = radius_;
    const std::vector<double> areas = has_no_edge()
                                          ? areas_in_period(view.frame(), box_, view.cells(), radius, present)
                                          : enclosed_areas(view.cells());
    reach_ = std::max(reach_, radius);
    beads_ += present;
    left_out_ += present - std::min(present, areas.size());
    if (areas.empty()) return;
    const auto n = static_cast<double>(areas.size());
    double mean = 0, squares = 0;
    for (const double a : areas) mean += a / n;
    for (const double a : areas) squares += (a - mean) * (a - mean);
    mean_.add(mean);
    if (areas.size() > 1) variance_.add(squares / (n - 1));
    density_.add(areas, mean);
  }

  [[nodiscard]] std::vector<Result> results() const override {
    const std::string none = planar_ ? "no bead is enclosed by its neighbours"
                                     : "the cell is three-dimensional: cells are those of a plane";
    const std::string which = which_cells() + "; mean over frames";
    std::vector<Result> all = {mean_of(mean_,
                                       {.name = "voronoi_area",
                                        .unit = "sigma^2",
                                        .n_of = "frames",
                                        .convention = which,
                                        .source = kSource},
                                       none),
                               mean_of(variance_,
                                       {.name = "voronoi_area_variance",
                                        .unit = "sigma^4",
                                        .n_of = "frames",
                                        .convention = "variance within a frame; " + which,
                                        .source = kSource},
                                       planar_ ? "no frame has two enclosed beads" : none)};
    for (Result& r : density_.results("voronoi_area", "area", which, kSource, none))
      all.push_back(std::move(r));
    return all;
  }

 private:
  /// Whether no cell is at a wall or a surface because of the box.
  [[nodiscard]] bool has_no_edge() const { return box_.periodic(Axis::x) && box_.periodic(Axis::z); }

  /// The cells that are used, and the share that is not.
  [[nodiscard]] std::string which_cells() const {
    if (left_out_ == 0) return "all cells";
    const double share = 100 * static_cast<double>(left_out_) / static_cast<double>(beads_);
    return fmt::format(
        "enclosed cells; {:.3g} % of the cells were left out, as they reach farther than {:.4g} sigma from "
        "their beads",
        share, reach_);
  }

  const Box& box_;
  double radius_, reach_ = 0;  ///< sigma, of the cells of the analysis; largest that was tried
  bool planar_;
  std::size_t beads_ = 0, left_out_ = 0;  ///< cells of all frames
  SeriesAverage mean_, variance_;
  RatioDensity density_;
};

}  // namespace

constinit const ObservableEntry voronoi_area_observable = {kResults, &make_observable<VoronoiArea>};

}  // namespace twincell::analysis
