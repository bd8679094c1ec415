#include "analysis/order/voronoi_area.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "analysis/observable/ratio_density.hpp"

namespace twincell::analysis {
namespace {

/// Definition 1 left out cells beyond the radius also in a box that is periodic on all sides, definition 2
/// those that reach farther than a quarter of the shorter period.
constexpr int kDefinition = 3;
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

using Polygon = std::vector<std::array<double, 2>>;

/// The part of a convex polygon, with corners relative to a bead, that is nearer to the bead than to a
/// neighbour at (x, z).
void clip(Polygon& polygon, double x, double z) {
  const double half = 0.5 * (x * x + z * z);
  const auto beyond = [&](const std::array<double, 2>& p) { return p[0] * x + p[1] * z - half; };
  if (half == 0 || std::none_of(polygon.begin(), polygon.end(), [&](const auto& p) { return beyond(p) > 0; }))
    return;
  Polygon kept;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const auto &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
    const double over_a = beyond(a), over_b = beyond(b);
    if (over_a <= 0) kept.push_back(a);
    if ((over_a <= 0) == (over_b <= 0)) continue;
    const double t = over_a / (over_a - over_b);
    kept.push_back({a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])});
  }
  polygon = std::move(kept);
}

/// Area of the cell of bead i in a box that is periodic along x and z, sigma^2. The bead's own images limit
/// the cell to one period, and a point of it is nearest to the nearest image of another bead or to one of the
/// eight images around that one: nine images of each bead are enough, whatever the cell.
double area_in_period(const std::vector<Vec3>& beads, std::size_t i, const Vec3& size) {
  const double x = size.x(), z = size.z();
  Polygon cell = {{-x / 2, -z / 2}, {x / 2, -z / 2}, {x / 2, z / 2}, {-x / 2, z / 2}};
  for (std::size_t j = 0; j < beads.size(); ++j) {
    if (j == i) continue;
    const Vec3 d = beads[j] - beads[i];
    const double near_x = std::remainder(d.x(), x), near_z = std::remainder(d.z(), z);
    for (int p = -1; p <= 1; ++p)
      for (int q = -1; q <= 1; ++q) clip(cell, near_x + p * x, near_z + q * z);
  }
  double twice = 0;
  for (std::size_t k = 0; k < cell.size(); ++k) {
    const auto &a = cell[k], &b = cell[(k + 1) % cell.size()];
    twice += a[0] * b[1] - a[1] * b[0];
  }
  return twice / 2;
}

/// Areas of all cells of a box without edges: the radius doubles until every cell is enclosed, or the period
/// or the number of pairs allows no more. The cells that remain are cut out of the period, one by one.
/// \param cells those of the default radius
/// \param[in,out] radius of `cells`, becomes the last one
std::vector<double> areas_in_period(const Frame& frame, const Box& box, VoronoiCells cells, double& radius) {
  constexpr double kMostPairs = 400;      // of a bead on average, so that memory remains bounded
  constexpr double kMostBisectors = 1e9;  // of a frame, some seconds
  const Vec3 size = box.size();
  std::vector<Vec3> beads;
  std::vector<std::size_t> slots;
  for (std::size_t i = 0; i < frame.position.size(); ++i)
    if (frame.present(i) && frame.position[i].allFinite()) {
      beads.push_back(frame.position[i]);
      slots.push_back(i);
    }
  const auto n = static_cast<double>(std::max<std::size_t>(beads.size(), 1));
  // voronoi_cells needs a period above four radii.
  const double widest = 0.2499 * std::min(size.x(), size.z()),
               densest = std::sqrt(kMostPairs * size.x() * size.z() / (4 * std::numbers::pi * n));
  const double limit = std::min(widest, densest);
  std::vector<double> areas = enclosed_areas(cells);
  while (areas.size() < beads.size() && radius < limit) {
    radius = std::min(2 * radius, limit);
    cells = voronoi_cells(frame, box, radius);
    areas = enclosed_areas(cells);
  }
  if (9 * n * static_cast<double>(beads.size() - areas.size()) > kMostBisectors) return areas;
  for (std::size_t k = 0; k < beads.size(); ++k)
    if (cells.enclosed[slots[k]] == 0) areas.push_back(area_in_period(beads, k, size));
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
                                          ? areas_in_period(view.frame(), box_, view.cells(), radius)
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

constinit const ObservableEntry voronoi_area_observable = {
    kResults, &make_observable<VoronoiArea>, {"cell_radius"}};

}  // namespace twincell::analysis
