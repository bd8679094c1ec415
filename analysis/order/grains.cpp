#include "analysis/order/grains.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>

namespace twincell::analysis {
namespace {

constexpr NamedResult kResults[] = {{.name = "grains", .range = Range::not_negative, .main = true},
                                    {.name = "largest_grain", .range = Range::share},
                                    {.name = "grain_boundary_fraction", .range = Range::share},
                                    {.name = "grain_boundary_angle", .range = Range::not_negative},
                                    {"grain_beads", Pooling::per_bead}};

const char* const kSource = "Fortini & Huang 2015, sec. III";

/// Disjoint sets of beads (union-find).
class Groups {
 public:
  explicit Groups(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), std::size_t{0}); }
  std::size_t of(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::size_t i, std::size_t j) {
    i = of(i);
    j = of(j);
    parent_[std::max(i, j)] = std::min(i, j);
  }

 private:
  std::vector<std::size_t> parent_;
};

/// Lets one layer of beads without a grain join the grains of their neighbours. Returns false if no bead
/// joined.
bool grow(Grains& grains, const VoronoiCells& cells) {
  std::vector<std::pair<std::size_t, std::size_t>> joining;
  for (std::size_t i = 0; i < grains.of_bead.size(); ++i) {
    if (grains.of_bead[i] != Grains::kNone) continue;
    std::map<std::size_t, double> shared;
    for (std::size_t e = cells.neighbours.first[i]; e < cells.neighbours.first[i + 1]; ++e)
      if (const std::size_t grain = grains.of_bead[cells.neighbours.index[e]]; grain != Grains::kNone)
        shared[grain] += cells.edge[e];
    if (shared.empty()) continue;
    const auto most = std::max_element(shared.begin(), shared.end(),
                                       [](const auto& a, const auto& b) { return a.second < b.second; });
    joining.emplace_back(i, most->first);
  }
  for (const auto& [bead, grain] : joining) {
    grains.of_bead[bead] = grain;
    ++grains.beads[grain];
  }
  return !joining.empty();
}

class GrainsObservable : public Observable {
 public:
  explicit GrainsObservable(const AnalysisContext& context)
      : rule_(neighbour_rule_text(context)), dimension_(context.info.box.dimension) {}

  void add(const FrameView& view) override {
    if (dimension_ != 2) return;
    const VoronoiCells& cells = view.cells();
    const Grains grains = find_grains(view.order(), cells);
    std::size_t beads = 0, boundary = 0, pairs = 0;
    double turn = 0;
    for (std::size_t i = 0; i < grains.of_bead.size(); ++i) {
      if (view.frame().present(i)) ++beads;
      if (grains.of_bead[i] == Grains::kNone) continue;
      std::size_t others = 0;
      cells.neighbours.for_each(i, [&](std::size_t j, const Vec3&) {
        if (grains.of_bead[j] == Grains::kNone || grains.of_bead[j] == grains.of_bead[i]) return;
        turn += misorientation(grains.angle[grains.of_bead[i]], grains.angle[grains.of_bead[j]]);
        ++others;
      });
      pairs += others;
      boundary += others > 0 ? 1 : 0;
    }
    if (beads == 0) return;
    number_.add(static_cast<double>(grains.beads.size()));
    largest_.add(grains.beads.empty() ? 0
                                      : static_cast<double>(grains.beads[0]) / static_cast<double>(beads));
    boundary_.add(static_cast<double>(boundary) / static_cast<double>(beads));
    if (pairs > 0) turn_.add(turn / static_cast<double>(pairs));
    last_.clear();
    for (const std::size_t grain : grains.of_bead)
      last_.push_back(grain == Grains::kNone ? std::numeric_limits<double>::quiet_NaN()
                                             : static_cast<double>(grain));
  }

  [[nodiscard]] std::vector<Result> results() const override {
    const std::string why = dimension_ != 2 ? "the cell is not planar" : "no frame holds a bead";
    const std::string definition = fmt::format(
        "grain: at least {} beads joined by Voronoi neighbours with psi6 > {} that are turned by at most {} "
        "degrees, and the beads between grains, which join the grain with which they share the "
        "greatest edge length; {}",
        kGrainBeads, kOrdered, kGrainTurn, rule_);
    const auto mean = [&](const char* name, const SeriesAverage& series, const char* unit,
                          const std::string& of, const std::string& absent) {
      return mean_of(series,
                     {.name = name,
                      .unit = unit,
                      .n_of = "frames",
                      .convention = of + ", mean over frames; " + definition,
                      .source = kSource},
                     absent);
    };
    return {mean("grains", number_, "1", "number of grains", why),
            mean("largest_grain", largest_, "1", "share of the beads in the largest grain", why),
            mean("grain_boundary_fraction", boundary_, "1",
                 "share of the beads with a neighbour in another grain", why),
            mean("grain_boundary_angle", turn_, "degrees", "misorientation across grain boundaries",
                 dimension_ != 2 ? why : "no two grains meet in any frame"),
            array_of(last_,
                     {.name = "grain_beads",
                      .unit = "1",
                      .n_of = "beads",
                      .convention = "last frame; 0 for the largest grain; NaN for a bead without a grain; " +
                                    definition,
                      .source = kSource},
                     dimension_ != 2 ? why : "the last frame has no grain")};
  }

 private:
  std::string rule_;
  int dimension_;
  std::vector<double> last_;
  SeriesAverage number_, largest_, boundary_, turn_;
};

}  // namespace

Grains find_grains(const BondOrder& order, const VoronoiCells& cells) {
  const std::size_t n = order.psi6.size();
  const auto ordered = [&](std::size_t i) { return order.psi6[i] > kOrdered; };  // false for NaN
  // Groups of ordered neighbours with similar lattice directions.
  Groups groups(n);
  for (std::size_t i = 0; i < n; ++i)
    if (ordered(i))
      cells.neighbours.for_each(i, [&](std::size_t j, const Vec3&) {
        if (j > i && ordered(j) && misorientation(order.angle[i], order.angle[j]) <= kGrainTurn)
          groups.join(i, j);
      });
  std::vector<std::size_t> members(n, 0);
  for (std::size_t i = 0; i < n; ++i)
    if (ordered(i)) ++members[groups.of(i)];

  // Grains are the groups that are large enough, numbered from the largest to the smallest.
  std::vector<std::size_t> roots;
  for (std::size_t i = 0; i < n; ++i)
    if (members[i] >= kGrainBeads) roots.push_back(i);
  std::stable_sort(roots.begin(), roots.end(),
                   [&](std::size_t a, std::size_t b) { return members[a] > members[b]; });
  std::vector<std::size_t> number(n, Grains::kNone);
  Grains grains;
  for (std::size_t g = 0; g < roots.size(); ++g) {
    number[roots[g]] = g;
    grains.beads.push_back(members[roots[g]]);
  }
  grains.of_bead.assign(n, Grains::kNone);
  std::vector<std::complex<double>> sum(roots.size(), 0);
  for (std::size_t i = 0; i < n; ++i) {
    if (!ordered(i)) continue;
    const std::size_t g = grains.of_bead[i] = number[groups.of(i)];
    if (g != Grains::kNone) sum[g] += std::polar(order.psi6[i], 6 * order.angle[i] * std::numbers::pi / 180);
  }
  for (const auto& s : sum) grains.angle.push_back(lattice_angle(s.real(), s.imag()));
  while (grow(grains, cells)) {
  }
  return grains;
}

constinit const ObservableEntry grains_observable = {
    kResults, &make_observable<GrainsObservable>, {"neighbours", "cell_radius"}};

}  // namespace twincell::analysis
