#include "analysis/order/voronoi_area.hpp"

#include <cmath>

#include "analysis/observable/ratio_density.hpp"

namespace twincell::analysis {
namespace {

constexpr NamedResult kResults[] = {{.name = "voronoi_area", .range = Range::not_negative},
                                    {.name = "voronoi_area_variance", .range = Range::not_negative},
                                    {"voronoi_area_density"},
                                    {"voronoi_area_density_low"},
                                    {"voronoi_area_density_high"},
                                    {.name = "voronoi_area_ratio", .range = Range::not_negative}};
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

class VoronoiArea : public Observable {
 public:
  explicit VoronoiArea(const AnalysisContext& context)
      : planar_(context.info.box.dimension == 2), density_(kVoronoiAreaRange, kVoronoiAreaWidth) {}

  void add(const FrameView& view) override {
    if (!planar_) return;
    const std::vector<double> areas = enclosed_areas(view.cells());
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
    const std::string which = "enclosed cells; mean over frames";
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
  bool planar_;
  SeriesAverage mean_, variance_;
  RatioDensity density_;
};

}  // namespace

constinit const ObservableEntry voronoi_area_observable = {kResults, &make_observable<VoronoiArea>};

}  // namespace twincell::analysis
