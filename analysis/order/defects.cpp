#include "analysis/order/defects.hpp"

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

namespace twincell::analysis {
namespace {

constexpr NamedResult kResults[] = {{.name = "disclinations_5", .range = Range::not_negative},
                                    {.name = "disclinations_7", .range = Range::not_negative},
                                    {.name = "disclinations_other", .range = Range::not_negative},
                                    {.name = "dislocations", .range = Range::not_negative, .main = true},
                                    {.name = "free_disclinations", .range = Range::not_negative},
                                    {.name = "holes", .range = Range::not_negative},
                                    {.name = "defect_fraction", .range = Range::share, .main = true},
                                    {"defect_fraction_j"},
                                    {"coordination_beads", Pooling::per_bead}};

constexpr std::size_t kNobody = static_cast<std::size_t>(-1);
const char* const kSource = "Fortini & Huang 2015, sec. III, after Nelson & Halperin 1979";

/// Maximum number of pairs of neighbours (5-fold, 7-fold) with no bead in two pairs, by augmenting paths.
std::size_t bound_pairs(const Neighbours& neighbours, const std::vector<std::size_t>& coordination) {
  const std::size_t n = coordination.size();
  std::vector<std::size_t> partner(n, kNobody), seen(n, kNobody);
  const std::function<bool(std::size_t, std::size_t)> find_partner = [&](std::size_t five,
                                                                         std::size_t round) {
    for (std::size_t e = neighbours.first[five]; e < neighbours.first[five + 1]; ++e) {
      const std::size_t seven = neighbours.index[e];
      if (coordination[seven] != 7 || seen[seven] == round) continue;
      seen[seven] = round;
      if (partner[seven] == kNobody || find_partner(partner[seven], round)) {
        partner[seven] = five;
        return true;
      }
    }
    return false;
  };
  std::size_t pairs = 0;
  for (std::size_t i = 0; i < n; ++i)
    if (coordination[i] == 5 && find_partner(i, i)) ++pairs;
  return pairs;
}

/// Counts the holes. Traverses every face with an open rim: a counter-clockwise loop encloses a hole, a
/// clockwise loop borders the outside.
std::size_t count_holes(const VoronoiCells& cells) {
  const Neighbours& graph = cells.neighbours;
  const auto direction = [&](std::size_t e) { return std::atan2(graph.bond[e].z(), graph.bond[e].x()); };
  // The next side of the face to the left of i -> j is the bond of j that follows j -> i clockwise.
  const auto next = [&](std::size_t i, std::size_t e) {
    const std::size_t j = graph.index[e];
    std::size_t back = graph.first[j];
    while (graph.index[back] != i) ++back;
    const double from = direction(back);
    std::size_t best = back;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t f = graph.first[j]; f < graph.first[j + 1]; ++f) {
      if (f == back) continue;
      double turn = from - direction(f);
      if (turn <= 0) turn += 2 * std::numbers::pi;
      if (turn < least) {
        least = turn;
        best = f;
      }
    }
    return best;
  };
  std::vector<std::uint8_t> walked(graph.index.size(), 0);
  std::size_t holes = 0;
  for (std::size_t i = 0; i + 1 < graph.first.size(); ++i)
    for (std::size_t e = graph.first[i]; e < graph.first[i + 1]; ++e) {
      if (cells.open_left[e] == 0 || walked[e] != 0) continue;
      double area = 0;
      Vec3 at = Vec3::Zero();
      std::size_t bead = i;
      for (std::size_t side = e; walked[side] == 0;) {
        walked[side] = 1;
        const Vec3 to = at + graph.bond[side];
        area += 0.5 * (at.x() * to.z() - at.z() * to.x());
        at = to;
        const std::size_t following = next(bead, side);
        bead = graph.index[side];
        side = following;
      }
      // A loop that ends one period away from its start winds around the periodic cell, not around a hole.
      if (area > 0 && at.squaredNorm() < 1e-12) ++holes;
    }
  return holes;
}

class DefectsObservable : public Observable {
 public:
  explicit DefectsObservable(const AnalysisContext& context)
      : dimension_(context.info.box.dimension),
        has_cycles_(context.info.columns.phase),
        radius_(context.options.cell_radius) {}

  void add(const FrameView& view) override {
    if (dimension_ != 2) return;
    const Defects d = find_defects(view.cells());
    double fraction = std::numeric_limits<double>::quiet_NaN();
    if (d.bulk > 0) {  // without an enclosed bead, zero defects is not a measurement
      const auto count = [](SeriesAverage& series, std::size_t number) {
        series.add(static_cast<double>(number));
      };
      count(five_, d.five);
      count(seven_, d.seven);
      count(other_, d.other);
      count(dislocations_, d.dislocations);
      count(free_, d.five + d.seven - 2 * d.dislocations);
      count(holes_, d.holes);
      fraction = static_cast<double>(d.five + d.seven + d.other) / static_cast<double>(d.bulk);
      fraction_.add(fraction);
    }
    if (!has_cycles_ || view.frame().phase == 0) evolution_.push_back(fraction);
    last_.clear();
    for (const std::size_t n : d.coordination)
      last_.push_back(n == 0 ? std::numeric_limits<double>::quiet_NaN() : static_cast<double>(n));
  }

  [[nodiscard]] std::vector<Result> results() const override {
    const std::string planar = dimension_ != 2 ? "the cell is not planar" : "";
    const std::string none = planar.empty() ? "every bead is at a surface" : planar;
    const std::string rule = fmt::format(
        "neighbours: Voronoi cells within {:.4g} sigma that share an edge; beads at walls, free surfaces and "
        "holes left out",
        radius_);
    const auto mean = [&](const char* name, const SeriesAverage& series, const std::string& of) {
      return mean_of(series,
                     {.name = name,
                      .unit = "1",
                      .n_of = "frames",
                      .convention = of + ", mean over frames; " + rule,
                      .source = kSource},
                     none);
    };
    const auto array = [&](const char* name, const std::vector<double>& values, const char* of,
                           const std::string& convention) {
      return array_of(
          values,
          {.name = name, .unit = "1", .n_of = of, .convention = convention + "; " + rule, .source = kSource},
          none);
    };
    return {
        mean("disclinations_5", five_, "beads with 5 neighbours"),
        mean("disclinations_7", seven_, "beads with 7 neighbours"),
        mean("disclinations_other", other_, "beads with neither 5, 6 nor 7 neighbours"),
        mean("dislocations", dislocations_,
             "neighbouring pairs of a 5- and a 7-fold bead, maximum number of disjoint pairs"),
        mean("free_disclinations", free_, "5- and 7-fold beads in no such pair"),
        mean("holes", holes_, "holes of the packing that reach farther than a cell's radius from every bead"),
        mean("defect_fraction", fraction_, "share of the beads that do not have 6 neighbours"),
        array("defect_fraction_j", evolution_, has_cycles_ ? "cycles" : "frames",
              has_cycles_ ? "share of the beads that do not have 6 neighbours at the beginning of each cycle"
                          : "share of the beads that do not have 6 neighbours in each frame"),
        array("coordination_beads", last_, "beads", "number of neighbours in the last frame")};
  }

 private:
  int dimension_;
  bool has_cycles_;
  double radius_;
  std::vector<double> evolution_, last_;
  SeriesAverage five_, seven_, other_, dislocations_, free_, holes_, fraction_;
};

}  // namespace

Defects find_defects(const VoronoiCells& cells) {
  Defects d;
  const std::size_t n = cells.enclosed.size();
  d.coordination.assign(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    if (cells.enclosed[i] == 0) continue;
    ++d.bulk;
    const std::size_t c = d.coordination[i] = cells.neighbours.count(i);
    d.five += c == 5 ? 1 : 0;
    d.seven += c == 7 ? 1 : 0;
    d.other += c < 5 || c > 7 ? 1 : 0;
  }
  d.dislocations = bound_pairs(cells.neighbours, d.coordination);
  d.holes = count_holes(cells);
  return d;
}

constinit const ObservableEntry defects_observable = {
    kResults, &make_observable<DefectsObservable>, {"cell_radius"}};

}  // namespace twincell::analysis
