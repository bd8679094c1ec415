#include "analysis/order/pair_correlation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace twincell {
namespace {

constexpr NamedResult kResults[] = {{"g_r"}, {"g_r_distance"}, {"g_peak"}, {"g_peak_distance"}};
constexpr auto kBins = static_cast<std::size_t>(kPairCorrelationRange / kPairCorrelationWidth + 0.5);
const char* const kSource = "Ripley 1988, ch. 3";

/// The part of the cell in which the bed lies, along the axes that count.
struct Window {
  std::vector<int> axes;  ///< with edges
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();
  double content = 1;  ///< area or volume
  std::size_t beads = 0;

  /// Distance of a point from the nearest edge; negative outside.
  [[nodiscard]] double depth(const Vec3& r) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (const int a : axes) nearest = std::min({nearest, r[a] - low[a], high[a] - r[a]});
    return nearest;
  }
};

Window window_of(const std::vector<Vec3>& beads, const Box& box) {
  constexpr double kTail = 0.005, kMargin = 0.5;  // share beyond the window at each end; sigma
  Window w;
  std::vector<double> along(beads.size());
  for (int a = 0; a < 3; ++a) {
    if (box.dimension == 2 && a == 1) continue;
    if (box.periodic(static_cast<Axis>(a))) {
      w.content *= box.size()[a];
      continue;
    }
    for (std::size_t i = 0; i < beads.size(); ++i) along[i] = beads[i][a];
    const auto tail = static_cast<std::ptrdiff_t>(kTail * static_cast<double>(along.size()));
    std::nth_element(along.begin(), along.begin() + tail, along.end());
    w.low[a] = along[static_cast<std::size_t>(tail)] - kMargin;
    std::nth_element(along.begin(), along.end() - 1 - tail, along.end());
    w.high[a] = *(along.end() - 1 - tail) + kMargin;
    w.content *= w.high[a] - w.low[a];
    w.axes.push_back(a);
  }
  for (const Vec3& r : beads) w.beads += w.depth(r) >= 0 ? 1 : 0;
  return w;
}

class PairCorrelation : public Observable {
 public:
  explicit PairCorrelation(const AnalysisContext& context) : info_(context.info), g_(kBins) {}

  void add(const FrameView& view) override {
    const Frame& frame = view.frame();
    std::vector<Vec3> beads;
    for (std::size_t i = 0; i < frame.position.size(); ++i)
      if (frame.present(i) && frame.position[i].allFinite()) beads.push_back(frame.position[i]);
    if (beads.size() < 2) return;
    const Window window = window_of(beads, info_.box);
    if (window.beads == 0) return;
    const double density = static_cast<double>(window.beads) / window.content;
    // The farthest edge of a bin up to which each bead is a reference bead, and the pairs in those bins.
    const Neighbours pairs = find_neighbours(frame, info_.box, kPairCorrelationRange);
    std::vector<std::size_t> references(kBins, 0), found(kBins, 0);
    for (std::size_t i = 0; i < frame.position.size(); ++i) {
      if (!frame.present(i) || !frame.position[i].allFinite()) continue;
      const double depth = window.depth(frame.position[i]);
      if (!(depth >= kPairCorrelationWidth)) continue;
      const std::size_t bins =
          depth >= kPairCorrelationRange ? kBins : static_cast<std::size_t>(depth / kPairCorrelationWidth);
      for (std::size_t b = 0; b < bins; ++b) ++references[b];
      pairs.for_each(i, [&](std::size_t, const Vec3& bond) {
        const auto b = static_cast<std::size_t>(bond.norm() / kPairCorrelationWidth);
        if (b < bins) ++found[b];
      });
    }
    for (std::size_t b = 0; b < kBins; ++b)
      if (references[b] > 0)
        g_[b].add(static_cast<double>(found[b]) /
                  (static_cast<double>(references[b]) * density * content_of(b)));
  }

  [[nodiscard]] std::vector<Result> results() const override {
    constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
    std::vector<double> values(kBins, kNaN), centres(kBins);
    std::size_t peak = kBins;
    for (std::size_t b = 0; b < kBins; ++b) {
      centres[b] = (static_cast<double>(b) + 0.5) * kPairCorrelationWidth;
      if (g_[b].n() == 0) continue;
      values[b] = g_[b].mean();
      if (peak == kBins || values[b] > values[peak]) peak = b;
    }
    const std::string none = "no frame has a bead that is farther than a bin from the edges of the bed";
    const std::string rule =
        "beads farther than r from the edges of the bed, density of the bed between its 0.5 and 99.5 "
        "percentiles";
    const auto scalar = [&](const char* name, double value, const char* unit, const std::string& convention,
                            const char* why_no_interval) {
      if (peak == kBins) return absent_result(name, none, kSource);
      Result r{.name = name,
               .values = {value},
               .unit = unit,
               .n = g_[peak].n(),
               .n_of = "frames",
               .no_interval = why_no_interval,
               .convention = convention,
               .source = kSource};
      return r;
    };
    return {
        array_of(values, {.name = "g_r", .unit = "1", .n_of = "bins", .convention = rule, .source = kSource},
                 none),
        peak == kBins ? absent_result("g_r_distance", none, kSource)
                      : array_of(centres,
                                 {.name = "g_r_distance",
                                  .unit = "sigma",
                                  .n_of = "bins",
                                  .convention = "centres of the bins",
                                  .source = kSource},
                                 none),
        scalar("g_peak", peak == kBins ? kNaN : values[peak], "1", "largest bin of g_r; " + rule,
               "the bin is chosen from the same frames as the value"),
        scalar("g_peak_distance", peak == kBins ? kNaN : centres[peak], "sigma",
               "centre of the bin of g_peak",
               "the distance is known to half the width of a bin, 0.025 sigma")};
  }

 private:
  /// Area (3D: volume) of bin b.
  [[nodiscard]] double content_of(std::size_t b) const {
    const double inner = static_cast<double>(b) * kPairCorrelationWidth,
                 outer = inner + kPairCorrelationWidth;
    return info_.box.dimension == 2 ? std::numbers::pi * (outer * outer - inner * inner)
                                    : 4 * std::numbers::pi / 3 * (std::pow(outer, 3) - std::pow(inner, 3));
  }

  const TrajectoryInfo& info_;
  std::vector<BlockAverage> g_;
};

}  // namespace

constinit const ObservableEntry pair_correlation_observable = {kResults, &make_observable<PairCorrelation>};

}  // namespace twincell
